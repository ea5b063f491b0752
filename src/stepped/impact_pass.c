/* SPDX-License-Identifier: MIT */
/*
 * Event-driven impacts inside a step: times of impact (flight.c) in a priority queue; each event
 * gathers all contacts that touch at that moment, up to RB_IMPACT_CONTACTS, and solves the
 * simultaneous impact law; bodies get a kick (change of velocity, and the shift that makes the
 * parabola continuous), and their other points are predicted again. Larger groups rebound at the
 * end of the step and are counted as crowded. So that sequences of accumulating impacts end, what
 * is left after EVENTS_MAX rebounds at the end too. So do jointed bodies, by the same law
 * (stepped/joined_rebound).
 */
#include "stepped/impact_pass.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "constraint/effective_mass.h"
#include "constraint/simultaneous.h"
#include "stepped/flight.h"
#include "stepped/points_of.h"
#include "stepped/tally.h"

/* Stale predictions that may stay queued, in addition to twice the number of points. */
enum { STALE_MAX = 64 };
/* Limit of events in a step: after 64 + 4 per point, the rest rebounds at the end. */
enum { EVENTS_MAX = 64, EVENTS_PER_POINT = 4, EVENT_WORK = 1 << 13 /* as multiplications */ };
/*
 * Limit of dynamic bodies in an impact without restitution that is resolved at its time, if they
 * touch no further one. Larger ones are left to the step's solution, which has the same law and
 * costs less where much is solved anyway.
 */
enum { PLASTIC_BODIES = 2 };
/*
 * Limit of an impact's cost: products with the contact matrix times contacts, several times the
 * largest seen to converge (a break of 136 contacts: 1.4e4); without restitution the step's own
 * solution is the alternative.
 */
static const long work_max = 200000, work_max_plastic = 20000;
/* Tolerance of the solution of an impact, over its approach. */
static const double fine_share = 1e-9;
/* Rounding of an approach after an impact, in ulp of the largest speed in the group. */
static const double noise_ulp = 32;

enum crowd { CROWD_NONE, CROWD_LARGE, CROWD_JOINED };

/* Working data of one attempt. */
struct impacts {
	struct rb_world *world;
	struct rb_stepped *s;
	struct rb_cohort *cohort;
	struct rb_step_points *points;
	struct rb_flight flight;
	unsigned char *held;
	size_t *first, *of;     /* points of each dynamic body */
	double *next_s;         /* [points] time of its next impact; INFINITY: none */
	unsigned char *touched; /* [points] took part in an impact */
	/* [points] may take part in an impact: its gap is updated at the end */
	unsigned char *seen;
	int *place;                        /* [bodies] index in `body`, or -1 */
	struct rb_flight_turning *turning; /* [bodies_max] orientation and spin of `body` at t_s */
	rb_vec3 (*initial_arm)[2];         /* [points] m: lever arms at the beginning of the step */
	unsigned char *crowded; /* [bodies] enum crowd: why its group rebounds at the end */

	/* contacts that touch at one moment */
	int *body;
	int body_count, bodies_max;
	size_t *contact;
	int contact_count;
	enum crowd crowd; /* why they are not resolved at t_s */
	double t_s, start_s;
	double noise; /* m/s: rounding of approaches among these */
	int unit;     /* masses are in units of 2^unit kg during the solution, else 0 */
};

enum rb_status rb_impacts_create(struct rb_stepped *s, const struct rb_model *model,
                                 struct rb_error *err)
{
	const size_t n = (size_t)model->body_count + 1;

	s->kicks.row = rb_memory_take(n + 1, sizeof *s->kicks.row);
	s->kicks.place = rb_memory_take(n, sizeof *s->kicks.place);
	return s->kicks.row && s->kicks.place
	               ? RB_OK
	               : RB_FAIL(err, RB_ERR_MEMORY, "no memory for impacts of %zu bodies", n - 1);
}

void rb_impacts_release(struct rb_stepped *s)
{
	rb_memory_free(s->kicks.row);
	rb_memory_free(s->kicks.place);
	rb_memory_free(s->impact_queue.row);
}

/* ---- the queue ---- */

/* Queues the next impact of a point, from `now` on. */
static enum rb_status predict(struct impacts *pass, size_t point, double now, struct rb_error *err)
{
	RB_ASSERT_COSTLY(point < pass->points->count && now >= 0 && now <= pass->flight.h_s);
	struct rb_impact_queue *const queue = &pass->s->impact_queue;
	const double t = rb_flight_touches(&pass->flight, &pass->points->row[point], now);

	if (t == pass->next_s[point]) /* it is queued already, or never due */
		return RB_OK;
	pass->next_s[point] = t;
	if (!(t <= pass->flight.h_s))
		return RB_OK;
	/* in a crowd most predictions are replaced before their time */
	if (queue->count >= STALE_MAX + 2 * pass->points->count)
		rb_impact_queue_keep(queue, pass->next_s);
	return rb_impact_queue_add(queue, (struct rb_queued_impact){t, point}, err);
}

/* ---- the search ---- */

/* Leaves jointed bodies to the end of the step. */
static void mark_joined(struct impacts *pass)
{
	const struct rb_joints *joints = pass->world->model->joints;

	for (int k = 0; joints && k < joints->count; k++) {
		if (pass->world->joint[k].released)
			continue;
		pass->crowded[joints->joint[k].a] = CROWD_JOINED;
		if (joints->joint[k].b >= 0)
			pass->crowded[joints->joint[k].b] = CROWD_JOINED;
	}
}

static enum rb_status begin(struct impacts *pass, struct rb_error *err)
{
	struct rb_arena *arena = &pass->world->arena[0];
	const struct rb_model *model = pass->world->model;
	const size_t n = (size_t)model->body_count + 2, count = pass->points->count;

	pass->bodies_max = RB_IMPACT_CONTACTS + 1;
	pass->held = rb_arena_take(arena, n, 1);
	pass->first = rb_arena_take(arena, n + 1, sizeof *pass->first);
	pass->of = rb_arena_take(arena, 2 * count, sizeof *pass->of);
	pass->next_s = rb_arena_take(arena, count, sizeof *pass->next_s);
	pass->touched = rb_arena_take(arena, count, 1);
	pass->initial_arm = rb_arena_take(arena, count, sizeof *pass->initial_arm);
	pass->place = rb_arena_take(arena, n, sizeof *pass->place);
	pass->crowded = rb_arena_take(arena, n + (size_t)model->static_count, 1);
	pass->body = rb_arena_take(arena, (size_t)pass->bodies_max + 1, sizeof *pass->body);
	pass->turning = rb_arena_take(arena, (size_t)pass->bodies_max + 1, sizeof *pass->turning);
	pass->contact = rb_arena_take(arena, RB_IMPACT_CONTACTS + 1, sizeof *pass->contact);
	if (!pass->held || !pass->first || !pass->of || !pass->next_s || !pass->touched ||
	    !pass->initial_arm || !pass->place || !pass->crowded || !pass->body || !pass->turning ||
	    !pass->contact)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	pass->flight.held = pass->held;
	memset(pass->touched, 0, count);
	memset(pass->crowded, 0, n + (size_t)model->static_count);
	for (size_t i = 0; i < n; i++)
		pass->place[i] = -1;
	if (!rb_points_of_bodies(pass->world, pass->points, pass->first, pass->of, pass->held))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	mark_joined(pass);
	enum rb_status status = RB_OK;
	for (size_t k = 0; k < count && status == RB_OK; k++) {
		pass->next_s[k] = (double)INFINITY;
		pass->initial_arm[k][0] = pass->points->row[k].arm_a;
		pass->initial_arm[k][1] = pass->points->row[k].arm_b;
		if (pass->seen[k])
			status = predict(pass, k, 0, err);
	}
	return status;
}

/* ---- contacts that touch at one moment ---- */

static bool take_body(struct impacts *pass, int i)
{
	RB_ASSERT_COSTLY(i >= 0 && pass->body_count <= pass->bodies_max);
	if (!rb_stepped_is_dynamic(pass->world, i) || pass->place[i] >= 0)
		return true;
	if (pass->body_count == pass->bodies_max || pass->crowded[i]) {
		pass->crowd = pass->crowded[i] ? pass->crowded[i] : CROWD_LARGE;
		return false;
	}
	if (pass->world->state.spin)
		pass->turning[pass->body_count] = rb_flight_turning(&pass->flight, i, pass->t_s);
	pass->place[i] = pass->body_count;
	pass->body[pass->body_count++] = i;
	return true;
}

/* Whether an impact may be left to the step's solution: it has no restitution. */
static bool may_be_left(const struct impacts *pass, size_t due)
{
	return !(pass->points->row[due].material->restitution > 0) && !pass->flight.mixed;
}

/*
 * Breadth-first over touching contacts from the due point. False: more than the limit, or a body of
 * a crowded group.
 */
static bool gather(struct impacts *pass, size_t due)
{
	const struct rb_step_point *row = pass->points->row;
	const int max = may_be_left(pass, due) ? PLASTIC_BODIES : pass->bodies_max;
	const double touching = pass->world->model->stepped_tolerance_m;
	bool fits;

	pass->body_count = pass->contact_count = 0;
	pass->crowd = CROWD_LARGE;
	fits = take_body(pass, row[due].a) && take_body(pass, row[due].b);
	for (int k = 0; k < pass->body_count && fits; k++) {
		const int i = pass->body[k];

		for (size_t at = pass->first[i]; at < pass->first[i + 1] && fits; at++) {
			const size_t p = pass->of[at];
			rb_vec3 normal;

			/* a point of two bodies in the set is added by the first */
			const int other = row[p].a == i ? row[p].b : row[p].a;
			if (rb_stepped_is_dynamic(pass->world, other) && pass->place[other] >= 0 &&
			    pass->place[other] < k)
				continue;
			if (p != due && !(rb_flight_gap(&pass->flight, &row[p], pass->t_s,
			                                &normal) <= touching))
				continue;
			fits = pass->contact_count < RB_IMPACT_CONTACTS && take_body(pass, other) &&
			       pass->body_count <= max;
			if (fits)
				pass->contact[pass->contact_count++] = p;
		}
	}
	return fits;
}

static void forget_set(struct impacts *pass)
{
	for (int k = 0; k < pass->body_count; k++)
		pass->place[pass->body[k]] = -1;
}

/* ---- the law ---- */

static struct rb_flight_turning turning_of(const struct impacts *pass, int i)
{
	return rb_stepped_is_dynamic(pass->world, i) && pass->place[i] >= 0
	               ? pass->turning[pass->place[i]]
	               : rb_flight_turning(&pass->flight, i, pass->t_s);
}

/* Velocity of a body at the moment, with its inverse mass and inertia. */
static struct rb_solver_body body_at_impact(const struct impacts *pass, int i)
{
	const struct rb_world *world = pass->world;
	const rb_vec3 none = {0, 0, 0};
	const struct rb_flight_motion motion = rb_flight_of(&pass->flight, i, none);
	struct rb_solver_body body = {.linear = rb_flight_velocity(&motion, pass->t_s)};

	if (i >= world->model->body_count)
		return body;
	if (world->state.spin) {
		const struct rb_flight_turning turning = turning_of(pass, i);

		body.angular = turning.spin;
		if (!pass->held[i])
			body.angular = rb_vec3_add_scaled(
				body.angular, pass->t_s / pass->flight.h_s,
				rb_flight_forced_spin(&pass->flight, i, turning.orientation));
	}
	if (!rb_stepped_is_dynamic(world, i))
		return body;
	body.inverse_mass = ldexp(world->model->inverse_mass[i], pass->unit);
	if (world->state.spin)
		body.inverse_inertia = ldexp(world->model->inverse_inertia_scalar[i], pass->unit);
	return body;
}

/* Square root of the inverse inertia; zero where this is a scalar. */
static rb_mat3 root_of(const struct impacts *pass, int i)
{
	const struct rb_world *world = pass->world;

	if (!world->state.spin || !isnan(world->model->inverse_inertia_scalar[i]))
		return (rb_mat3){{{0}}};
	struct rb_top_body top = pass->s->top[i];
	rb_mat3 inertia = *rb_model_inertia(world->model, i);
	const double less = ldexp(1, -pass->unit);

	top.moments = rb_vec3_scale(less, top.moments);
	for (int k = 0; k < 3; k++)
		for (int x = 0; x < 3; x++)
			inertia.m[k][x] *= less;
	return rb_top_inverse_root(&top, &inertia, turning_of(pass, i).orientation);
}

/* Index of a body in the problem; each contact has its own copy of a body that is not dynamic. */
static int problem_index(const struct impacts *pass, struct rb_simultaneous *problem, int i)
{
	if (rb_stepped_is_dynamic(pass->world, i))
		return pass->place[i];
	problem->body[problem->body_count] = body_at_impact(pass, i);
	return problem->body_count++;
}

/*
 * Fills a contact of the simultaneous problem; `noise` is the approach below which it is lasting
 * contact.
 */
static void fill_contact(const struct impacts *pass, struct rb_simultaneous *problem, int k)
{
	struct rb_step_point *point = &pass->points->row[pass->contact[k]];
	struct rb_solver_contact *c = &problem->contact[k];
	rb_vec3 arm[2];

	rb_flight_move_point(&pass->flight, point, pass->t_s, pass->initial_arm[pass->contact[k]],
	                     arm);
	const double least = rb_flight_approach_min(&pass->flight, point, point->normal);
	*c = (struct rb_solver_contact){
		.a = problem_index(pass, problem, point->a),
		.b = problem_index(pass, problem, point->b),
		.pair = {point->a, point->b},
		.normal = point->normal,
		.arm_a = arm[0],
		.arm_b = arm[1],
		.friction = pass->world->state.spin ? point->material->friction : 0,
		.restitution = point->material->restitution,
	};
	/* a lasting contact approaches within the residual of its solution: no impact */
	c->noise = point->from > 0 ? fmax(least, pass->noise) : pass->noise;
}

/* Rounding of approaches in this group, m/s: of speeds, and of positions over the step. */
static double noise_of(const struct impacts *pass, const struct rb_simultaneous *problem)
{
	double max = 0;

	for (int k = 0; k < pass->body_count; k++) {
		const int i = pass->body[k];
		const double turning = rb_vec3_length(problem->body[k].angular) *
		                       pass->s->solver.reach[i];

		max = fmax(max, DBL_EPSILON * (rb_vec3_length(problem->body[k].linear) + turning) +
		                        rb_flight_rounding(&pass->flight, i));
	}
	for (int k = 0; k < pass->contact_count; k++) {
		const struct rb_step_point *point = &pass->points->row[pass->contact[k]];

		if (!rb_stepped_is_dynamic(pass->world, point->b))
			max = fmax(max,
			           DBL_EPSILON * rb_vec3_length(rb_flight_of(&pass->flight,
			                                                     point->b, point->arm_b)
			                                                .velocity));
	}
	return noise_ulp * max;
}

/* Whether no approaching contact has restitution. */
static bool is_plastic(const struct impacts *pass)
{
	for (int k = 0; k < pass->contact_count; k++) {
		const struct rb_step_point *point = &pass->points->row[pass->contact[k]];

		if (point->material->restitution > 0 &&
		    rb_flight_approach(&pass->flight, point, point->normal) > 0)
			return false;
	}
	return true;
}

static long work_max_of(const struct impacts *pass)
{
	return is_plastic(pass) ? work_max_plastic : work_max;
}

/* Masses times a power of two must give the same bits: roots of odd powers round otherwise. */
static int unit_of(const struct impacts *pass)
{
	double max = 0;
	int unit = 0;

	for (int k = 0; k < pass->body_count; k++)
		max = fmax(max, pass->world->model->mass[pass->body[k]]);
	(void)frexp(max, &unit);
	return unit;
}

/* False: no memory. */
static bool build_problem(struct impacts *pass, double approach, struct rb_simultaneous *problem)
{
	struct rb_arena *arena = &pass->world->arena[0];
	const size_t contacts = (size_t)pass->contact_count;

	*problem = (struct rb_simultaneous){.body_count = pass->body_count,
	                                    .contact_count = pass->contact_count,
	                                    .arena = arena,
	                                    .tolerance = fine_share * approach,
	                                    .interrupt = &pass->world->interrupt,
	                                    .products_max = work_max_of(pass) / (long)contacts};
	problem->body = rb_arena_take(arena, (size_t)pass->body_count + 2 * contacts,
	                              sizeof *problem->body);
	problem->contact = rb_arena_take(arena, contacts, sizeof *problem->contact);
	rb_mat3 *const root = rb_arena_take(arena, (size_t)pass->body_count + 1, sizeof *root);
	if (!problem->body || !problem->contact || !root)
		return false;
	problem->root = root;
	pass->unit = unit_of(pass);
	for (int k = 0; k < pass->body_count; k++) {
		problem->body[k] = body_at_impact(pass, pass->body[k]);
		root[k] = root_of(pass, pass->body[k]);
	}
	pass->noise = fmax(noise_of(pass, problem), problem->tolerance);
	for (int k = 0; k < pass->contact_count; k++)
		fill_contact(pass, problem, k);
	return true;
}

static void kick(struct impacts *pass, int i, const struct rb_solver_body *after)
{
	const struct rb_solver_body before = body_at_impact(pass, i);
	const struct rb_flight_turning turning = turning_of(pass, i);
	const struct rb_solver_body more = {.linear = rb_vec3_sub(after->linear, before.linear),
	                                    .angular = rb_vec3_sub(after->angular, before.angular)};

	RB_ASSERT_COSTLY(rb_stepped_is_dynamic(pass->world, i));
	rb_flight_kick(&pass->flight, i, pass->t_s, &turning, &more);
}

/* ---- records ---- */

/* Time of the event; strictly after the end of the last step, so that events are in order. */
static double time_of(const struct impacts *pass)
{
	return fmax(pass->start_s + pass->t_s, nextafter(pass->start_s, (double)INFINITY));
}

/* The record of a pair at this moment, common to its points; NULL: none yet. */
static struct rb_step_impact *find_impact(const struct impacts *pass,
                                          const struct rb_step_point *point)
{
	struct rb_cohort *cohort = pass->cohort;
	const double time = time_of(pass);

	for (size_t k = cohort->impact_count; k-- > 0 && cohort->impact[k].time_s == time;)
		if (cohort->impact[k].a == point->a && cohort->impact[k].b == point->b &&
		    !cohort->impact[k].crowded)
			return &cohort->impact[k];
	return NULL;
}

static struct rb_step_impact *add_impact(struct impacts *pass, const struct rb_step_point *point)
{
	struct rb_cohort *cohort = pass->cohort;

	if (!rb_memory_reserve(&cohort->impact, &cohort->impact_capacity, cohort->impact_count + 1,
	                       sizeof *cohort->impact))
		return NULL;
	struct rb_step_impact *impact = &cohort->impact[cohort->impact_count++];
	*impact = (struct rb_step_impact){.a = point->a,
	                                  .b = point->b,
	                                  .time_s = time_of(pass),
	                                  .point = rb_flight_place(&pass->flight, point, pass->t_s),
	                                  .normal = point->normal};
	return impact;
}

/* Adds a contact's impulse; the pair's acts at the mean of its points, weighted by impulse. */
static void add_impulse(const struct impacts *pass, struct rb_step_impact *impact,
                        const struct rb_step_point *point, const struct rb_solver_contact *c)
{
	const double normal_impulse = rb_vec3_dot(c->impulse, c->normal);

	RB_ASSERT_COSTLY(!(normal_impulse < 0));
	impact->impulse = rb_vec3_add(impact->impulse, c->impulse);
	if (!(normal_impulse > 0))
		return;
	impact->normal_impulse += normal_impulse;
	impact->point = rb_vec3_add_scaled(
		impact->point, normal_impulse / impact->normal_impulse,
		rb_vec3_sub(rb_flight_place(&pass->flight, point, pass->t_s), impact->point));
}

/*
 * Records a contact that was touching and transmitted an impact: not an impact of its own; its
 * impulse enters the mean force of the step.
 */
static bool pass_on(struct impacts *pass, const struct rb_step_point *point,
                    const struct rb_solver_contact *c)
{
	struct rb_contacts *passed = &pass->cohort->transmitted;
	const double normal_impulse = rb_vec3_dot(c->impulse, c->normal);

	if (rb_vec3_max_abs(c->impulse) == 0)
		return true;
	if (rb_contacts_reserve(passed, passed->count + 1, NULL) != RB_OK)
		return false;
	passed->row[passed->count++] = (struct rb_contact){
		.a = point->a,
		.b = point->b,
		.point = rb_flight_place(&pass->flight, point, pass->t_s),
		.normal = c->normal,
		.gap = point->gap,
		.normal_force = normal_impulse,
		.tangent_force = rb_vec3_add_scaled(c->impulse, -normal_impulse, c->normal),
		.parts = point->parts,
		.key = point->key,
	};
	return true;
}

static bool report(struct impacts *pass, const struct rb_simultaneous *problem, bool converged)
{
	bool first = true;

	for (int k = 0; k < pass->contact_count; k++) {
		const struct rb_solver_contact *c = &problem->contact[k];

		const struct rb_step_point *point = &pass->points->row[pass->contact[k]];

		if (!(c->approach > 0) && !pass_on(pass, point, c))
			return false;
		if (!(c->approach > 0))
			continue;
		struct rb_step_impact *impact = find_impact(pass, point);
		if (!impact)
			impact = add_impact(pass, point);
		if (!impact)
			return false;
		if (c->approach > impact->approach) { /* the fastest point represents the pair */
			impact->approach = c->approach;
			impact->normal = c->normal;
		}
		add_impulse(pass, impact, point, c);
		impact->plastic = impact->plastic || (first && !converged);
		first = false;
	}
	return true;
}

/* Inverse effective mass of a body along the normal, 1/kg. */
static double inverse_effective_mass_of(const struct impacts *pass, int i, rb_vec3 arm,
                                        rb_vec3 normal)
{
	struct rb_solver_body body = body_at_impact(pass, i);
	const rb_mat3 root = root_of(pass, i);
	const struct rb_solver_bodies alone = {.body = &body, .root = &root};

	return rb_effective_mass_along(&alone, 0, rb_vec3_cross(arm, normal));
}

/* Leaves the whole group to the end of the step. */
static bool defer_to_end(struct impacts *pass, size_t due)
{
	if (may_be_left(pass, due))
		return true;
	for (int k = 0; k < pass->body_count; k++)
		pass->crowded[pass->body[k]] = (unsigned char)pass->crowd;
	if (pass->crowd == CROWD_JOINED)
		return true;
	const struct rb_step_point *point = &pass->points->row[due];
	struct rb_step_impact *impact = add_impact(pass, point);
	const rb_vec3 none = {0, 0, 0};

	if (!impact)
		return false;
	impact->crowded = true;
	impact->approach = rb_flight_approach(&pass->flight, point, point->normal);
	const double inverse_effective_mass =
		inverse_effective_mass_of(pass, point->a, point->central ? none : point->arm_a,
	                                  point->normal) +
		inverse_effective_mass_of(pass, point->b, point->central ? none : point->arm_b,
	                                  point->normal);
	impact->energy = 0.5 * impact->approach * impact->approach / inverse_effective_mass;
	return true;
}

/* ---- for the ledger ---- */

/* Records work and impulse of each contact, before bodies get their kicks; false: no memory. */
static bool record_ledger(struct impacts *pass, const struct rb_simultaneous *problem)
{
	struct rb_cohort *cohort = pass->cohort;

	if (!rb_memory_reserve(&cohort->ledger_impact, &cohort->ledger_impact_capacity,
	                       cohort->ledger_impact_count + (size_t)problem->contact_count,
	                       sizeof *cohort->ledger_impact))
		return false;
	for (int k = 0; k < problem->contact_count; k++) {
		const struct rb_solver_contact *c = &problem->contact[k];
		const struct rb_step_point *point = &pass->points->row[pass->contact[k]];
		const struct rb_solver_body a = body_at_impact(pass, point->a);
		const struct rb_solver_body b = body_at_impact(pass, point->b);
		const rb_vec3 on_b = rb_solver_point_velocity(&b, c->arm_b);
		const rb_vec3 before = rb_vec3_sub(on_b, rb_solver_point_velocity(&a, c->arm_a));
		const rb_vec3 after = rb_vec3_sub(
			rb_solver_point_velocity(&problem->body[c->b], c->arm_b),
			rb_solver_point_velocity(&problem->body[c->a], c->arm_a));
		const rb_vec3 mean = rb_vec3_scale(0.5, rb_vec3_add(before, after));
		const double work = rb_vec3_dot(c->impulse, mean);
		const double along = rb_vec3_dot(c->impulse, c->normal) *
		                     rb_vec3_dot(mean, c->normal);

		if (rb_vec3_max_abs(c->impulse) == 0)
			continue;
		cohort->ledger_impact[cohort->ledger_impact_count++] = (struct rb_ledger_impact){
			.a = point->a,
			.b = point->b,
			.t_s = pass->t_s,
			.impulse = c->impulse,
			.arm_a = c->arm_a,
			.along = -along,
			.across = along - work,
			.driven = -rb_vec3_dot(c->impulse, on_b)};
	}
	return true;
}

/* ---- one event ---- */

/* False: no memory. */
static bool collide(struct impacts *pass, size_t due, bool *done)
{
	struct rb_simultaneous problem;
	const rb_arena_mark here = rb_arena_here(&pass->world->arena[0]);
	const struct rb_step_point *point = &pass->points->row[due];
	rb_vec3 normal;

	(void)rb_flight_gap(&pass->flight, point, pass->t_s, &normal);
	bool good = build_problem(pass, rb_flight_approach(&pass->flight, point, normal), &problem);

	*done = false;
	if (good) {
		const bool converged = rb_simultaneous_impact(&problem, NULL);

		for (int k = 0; k < problem.contact_count; k++)
			problem.contact[k].impulse = rb_vec3_scale(ldexp(1, pass->unit),
			                                           problem.contact[k].impulse);
		pass->unit = 0;
		*done = !rb_simultaneous_is_over(&problem) && !problem.blocked;
		if (!*done)
			pass->crowd = CROWD_LARGE;
		good = *done ? report(pass, &problem, converged) : defer_to_end(pass, due);
	}
	if (good && *done && pass->s->tally)
		good = record_ledger(pass, &problem);
	for (int k = 0; k < pass->body_count && good && *done; k++)
		kick(pass, pass->body[k], &problem.body[k]);
	rb_arena_back(&pass->world->arena[0], here);
	return good;
}

/* Predicts a point again after an event; one that was hit is due again if it approaches. */
static enum rb_status predict_again(struct impacts *pass, size_t point, struct rb_error *err)
{
	const struct rb_step_point *of = &pass->points->row[point];

	pass->seen[point] = 1;
	if (pass->touched[point] && rb_flight_is_done(&pass->flight, of, pass->t_s, pass->noise)) {
		pass->next_s[point] = (double)INFINITY;
		return RB_OK;
	}
	return predict(pass, point, pass->t_s, err);
}

static enum rb_status run_event(struct impacts *pass, struct rb_queued_impact due,
                                struct rb_error *err)
{
	enum rb_status status = RB_OK;
	bool done = false, good;

	RB_ASSERT(due.t_s >= 0 && due.t_s <= pass->flight.h_s);
	if (rb_interrupt_after(&pass->world->interrupt, EVENT_WORK))
		return RB_FAIL(err, RB_ERR_INTERRUPT, "interrupted");
	pass->t_s = due.t_s;
	pass->next_s[due.point] = (double)INFINITY;
	good = gather(pass, due.point) ? collide(pass, due.point, &done)
	                               : defer_to_end(pass, due.point);
	for (int k = 0; k < pass->contact_count && done; k++)
		pass->touched[pass->contact[k]] = 1;
	for (int k = 0; k < pass->body_count && done && status == RB_OK; k++) {
		const int i = pass->body[k];

		for (size_t at = pass->first[i]; at < pass->first[i + 1] && status == RB_OK; at++)
			status = predict_again(pass, pass->of[at], err);
	}
	forget_set(pass);
	return good ? status : RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
}

/*
 * Change of a velocity by impacts at the end of the step. Drag reduces it for the rest of the step:
 * its impulse on the velocity before would otherwise push a body whose velocity is reversed.
 */
static rb_vec3 kick_at_end(const struct impacts *pass, int i, const struct rb_kick *of)
{
	struct rb_stepped *s = pass->s;

	if (!s->undragged)
		return of->linear;
	const rb_vec3 taken = rb_vec3_scale(
		s->undragged[i] - 1,
		rb_vec3_add_scaled(of->linear, 1 / pass->flight.h_s, of->shift));
	if (s->tally)
		s->tally->body[i].drag = rb_vec3_add_scaled(s->tally->body[i].drag,
		                                            pass->world->model->mass[i], taken);
	return rb_vec3_add(of->linear, taken);
}

/* Applies the impacts: the step is solved from the velocities after them. */
static void end(struct impacts *pass)
{
	struct rb_stepped *s = pass->s;
	struct rb_state *state = &pass->world->state;

	for (size_t k = 0; k < pass->points->count; k++) {
		struct rb_step_point *point = &pass->points->row[k];

		if (pass->seen[k])
			rb_flight_update_point(&pass->flight, point, pass->touched[k]);
	}
	for (int k = 1; k <= s->kicks.count; k++) {
		const struct rb_kick *of = &s->kicks.row[k];
		double *const v = state->velocity + 3 * (size_t)of->body;

		rb_vec3_to(v, rb_vec3_add(rb_vec3_from(v), kick_at_end(pass, of->body, of)));
		if (of->turns)
			rb_flight_turn_from(&pass->flight, state, of->body);
	}
}

enum rb_status rb_impacts_resolve(struct rb_world *world, struct rb_cohort *cohort, double start,
                                  double h, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct impacts pass = {.world = world,
	                       .s = s,
	                       .cohort = cohort,
	                       .points = &cohort->points,
	                       .start_s = start,
	                       .flight = {.world = world,
	                                  .h_s = h,
	                                  .tolerance = rb_solver_tolerance(world->model, h),
	                                  .mixed = s->solver.mixed}};
	const rb_arena_mark here = rb_arena_here(&world->arena[0]);

	RB_ASSERT(h > 0 && cohort->body_count <= world->model->body_count);
	cohort->impact_count = cohort->ledger_impact_count = cohort->transmitted.count = 0;
	for (int k = 1; k <= s->kicks.count; k++)
		s->kicks.place[s->kicks.row[k].body] = 0;
	s->kicks.count = 0;
	bool any = false;
	pass.seen = rb_arena_take(&world->arena[0], pass.points->count, 1);
	if (!pass.seen)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	if (s->kicks.place)
		any = rb_flight_find_possible(&pass.flight, pass.points, pass.seen);
	if (!any) {
		rb_arena_back(&world->arena[0], here);
		return RB_OK;
	}
	s->impact_queue.count = 0;
	enum rb_status status = begin(&pass, err);
	size_t left = EVENTS_MAX + EVENTS_PER_POINT * pass.points->count;
	while (status == RB_OK && s->impact_queue.count > 0 && left > 0) {
		const struct rb_queued_impact due = rb_impact_queue_next(&s->impact_queue);

		if (due.t_s != pass.next_s[due.point]) /* stale */
			continue;
		left--;
		status = run_event(&pass, due, err);
	}
	if (status == RB_OK)
		end(&pass);
	rb_arena_back(&world->arena[0], here);
	return status;
}

void rb_impacts_update_approach(const struct rb_stepped *s, struct rb_step_point *point)
{
	const int ends[2] = {point->a, point->b};

	for (int e = 0; e < 2; e++) {
		if (ends[e] >= s->solver.body_count || !rb_kicks_have(&s->kicks, ends[e]))
			continue;
		const struct rb_kick *kick = rb_kick_of(&s->kicks, ends[e]);
		const rb_vec3 none = {0, 0, 0}, arm = point->central ? none
		                                      : e == 0       ? point->arm_a
		                                                     : point->arm_b;
		const double more = rb_vec3_dot(
			point->normal,
			rb_vec3_add(kick->linear, rb_vec3_cross(kick->angular, arm)));

		point->approach += e == 0 ? more : -more;
	}
}
