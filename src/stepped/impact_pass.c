/* SPDX-License-Identifier: MIT */
/*
 * Event-driven impacts inside a step: times of impact (flight.c) in a priority queue; each event
 * gathers all contacts that touch at that moment, up to RB_IMPACT_CONTACTS, and solves the
 * simultaneous impact law; bodies get a kick (change of velocity, and the shift that makes the
 * parabola continuous), and their other points are predicted again. Larger groups rebound at the
 * end of the step and are counted as crowded; so that accumulating impacts end, what is left after
 * EVENTS_MAX rebounds there too. So do joined bodies, by the same law (stepped/joined_rebound).
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

/* Of what is foreseen anew, so many and twice as many as there are points stay queued. */
enum { STALE_MAX = 64 };
/* Limit of events in a step: after 64 + 4 per point what is left rebounds at the end. */
enum { EVENTS_MAX = 64, EVENTS_PER_POINT = 4, EVENT_WORK = 1 << 13 /* as multiplications */ };
/*
 * What gives nothing back is resolved in its time between two bodies that touch no third one that
 * yields. More of them are left to the step's solution, which has the same law, and costs less
 * where much is to be solved anyway.
 */
enum { PLASTIC_BODIES = 2 };
/*
 * Products with the matrix of a group's contacts, times these, that one impact may cost: several
 * times what those took that were seen to end (a break of 136 contacts 1.4e4); where nothing is
 * given back, the step's own solution is the other way.
 */
static const long work_max = 200000, work_max_plastic = 20000;
/* Of the approach of an impact: speeds to which what follows from it is resolved. */
static const double fine_share = 1e-9;
/* Rounding of an approach after an impact, in ulp of the largest speed of the group. */
static const double noise_ulp = 32;

enum crowd { CROWD_NONE, CROWD_LARGE, CROWD_JOINED };

/* Working data of one try. */
struct impacts {
	struct rb_world *world;
	struct rb_stepped *s;
	struct rb_cohort *cohort;
	struct rb_step_points *points;
	struct rb_flight flight;
	unsigned char *held;
	size_t *first, *of;     /* points of each body that yields */
	double *due_s;          /* [points] when it is an impact next; INFINITY */
	unsigned char *touched; /* [points] it was part of an impact */
	unsigned char *seen;    /* [points] its gap is looked at when all is done, or in the set */
	int *place;             /* [bodies] in the set, or -1 */
	struct rb_flight_turning *turning; /* [bodies_max] of those in the set, at the moment */
	rb_vec3 (*began)[2];               /* [points] m: arms as the step began */
	unsigned char *crowded; /* [bodies] enum crowd: why its group is left to the end */

	/* what touches at one moment */
	int *body;
	int body_count, bodies_max;
	size_t *contact;
	int contact_count;
	enum crowd crowd; /* why they are not resolved now */
	double t_s, start_s;
	double noise; /* m/s: of approaches among these */
	int unit;     /* 2^unit kg is that of masses while they are solved for, else 0 */
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
	rb_memory_free(s->due.row);
}

/* ---- the queue ---- */

/* Queues the next impact of a point, from `now` on. */
static enum rb_status predict(struct impacts *all, size_t point, double now, struct rb_error *err)
{
	RB_ASSERT_COSTLY(point < all->points->count && now >= 0 && now <= all->flight.h_s);
	struct rb_impact_queue *const queue = &all->s->due;
	const double t = rb_flight_touches(&all->flight, &all->points->row[point], now);

	if (t == all->due_s[point]) /* it is in the queue, or never due */
		return RB_OK;
	all->due_s[point] = t;
	if (!(t <= all->flight.h_s))
		return RB_OK;
	/* in a crowd most of what was foreseen is foreseen anew before its time */
	if (queue->count >= STALE_MAX + 2 * all->points->count)
		rb_impact_queue_keep(queue, all->due_s);
	return rb_impact_queue_add(queue, (struct rb_due_impact){t, point}, err);
}

/* ---- the search ---- */

/* Who is joined rebounds at the end of the step. */
static void mark_joined(struct impacts *all)
{
	const struct rb_joints *joints = all->world->model->joints;

	for (int k = 0; joints && k < joints->count; k++) {
		if (all->world->joint[k].released)
			continue;
		all->crowded[joints->joint[k].a] = CROWD_JOINED;
		if (joints->joint[k].b >= 0)
			all->crowded[joints->joint[k].b] = CROWD_JOINED;
	}
}

static enum rb_status begin(struct impacts *all, struct rb_error *err)
{
	struct rb_arena *arena = &all->world->arena[0];
	const struct rb_model *model = all->world->model;
	const size_t n = (size_t)model->body_count + 2, count = all->points->count;

	all->bodies_max = RB_IMPACT_CONTACTS + 1;
	all->held = rb_arena_take(arena, n, 1);
	all->first = rb_arena_take(arena, n + 1, sizeof *all->first);
	all->of = rb_arena_take(arena, 2 * count, sizeof *all->of);
	all->due_s = rb_arena_take(arena, count, sizeof *all->due_s);
	all->touched = rb_arena_take(arena, count, 1);
	all->began = rb_arena_take(arena, count, sizeof *all->began);
	all->place = rb_arena_take(arena, n, sizeof *all->place);
	all->crowded = rb_arena_take(arena, n + (size_t)model->static_count, 1);
	all->body = rb_arena_take(arena, (size_t)all->bodies_max + 1, sizeof *all->body);
	all->turning = rb_arena_take(arena, (size_t)all->bodies_max + 1, sizeof *all->turning);
	all->contact = rb_arena_take(arena, RB_IMPACT_CONTACTS + 1, sizeof *all->contact);
	if (!all->held || !all->first || !all->of || !all->due_s || !all->touched || !all->began ||
	    !all->place || !all->crowded || !all->body || !all->turning || !all->contact)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	all->flight.held = all->held;
	memset(all->touched, 0, count);
	memset(all->crowded, 0, n + (size_t)model->static_count);
	for (size_t i = 0; i < n; i++)
		all->place[i] = -1;
	if (!rb_points_of_bodies(all->world, all->points, all->first, all->of, all->held))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	mark_joined(all);
	enum rb_status status = RB_OK;
	for (size_t k = 0; k < count && status == RB_OK; k++) {
		all->due_s[k] = (double)INFINITY;
		all->began[k][0] = all->points->row[k].arm_a;
		all->began[k][1] = all->points->row[k].arm_b;
		if (all->seen[k])
			status = predict(all, k, 0, err);
	}
	return status;
}

/* ---- what touches at one moment ---- */

static bool take_body(struct impacts *all, int i)
{
	RB_ASSERT_COSTLY(i >= 0 && all->body_count <= all->bodies_max);
	if (!rb_stepped_is_dynamic(all->world, i) || all->place[i] >= 0)
		return true;
	if (all->body_count == all->bodies_max || all->crowded[i]) {
		all->crowd = all->crowded[i] ? all->crowded[i] : CROWD_LARGE;
		return false;
	}
	if (all->world->state.spin)
		all->turning[all->body_count] = rb_flight_turning(&all->flight, i, all->t_s);
	all->place[i] = all->body_count;
	all->body[all->body_count++] = i;
	return true;
}

/* Whether an impact may be left to the step's solution: it gives nothing back. */
static bool may_be_left(const struct impacts *all, size_t due)
{
	return !(all->points->row[due].material->restitution > 0) && !all->flight.mixed;
}

/*
 * Breadth-first over touching contacts from the due point. False: more than the limit, or a body of
 * a crowded group.
 */
static bool gather(struct impacts *all, size_t due)
{
	const struct rb_step_point *row = all->points->row;
	const int max = may_be_left(all, due) ? PLASTIC_BODIES : all->bodies_max;
	const double touching = all->world->model->stepped_tolerance_m;
	bool fits;

	all->body_count = all->contact_count = 0;
	all->crowd = CROWD_LARGE;
	fits = take_body(all, row[due].a) && take_body(all, row[due].b);
	for (int k = 0; k < all->body_count && fits; k++) {
		const int i = all->body[k];

		for (size_t at = all->first[i]; at < all->first[i + 1] && fits; at++) {
			const size_t p = all->of[at];
			rb_vec3 normal;

			/* of two bodies in the set, the first to come brings it */
			const int other = row[p].a == i ? row[p].b : row[p].a;
			if (rb_stepped_is_dynamic(all->world, other) && all->place[other] >= 0 &&
			    all->place[other] < k)
				continue;
			if (p != due &&
			    !(rb_flight_gap(&all->flight, &row[p], all->t_s, &normal) <= touching))
				continue;
			fits = all->contact_count < RB_IMPACT_CONTACTS && take_body(all, other) &&
			       all->body_count <= max;
			if (fits)
				all->contact[all->contact_count++] = p;
		}
	}
	return fits;
}

static void forget_set(struct impacts *all)
{
	for (int k = 0; k < all->body_count; k++)
		all->place[all->body[k]] = -1;
}

/* ---- the law ---- */

static struct rb_flight_turning turning_of(const struct impacts *all, int i)
{
	return rb_stepped_is_dynamic(all->world, i) && all->place[i] >= 0
	               ? all->turning[all->place[i]]
	               : rb_flight_turning(&all->flight, i, all->t_s);
}

/* Velocity of a body at the moment, with its inverse mass and inertia. */
static struct rb_solver_body joint_body(const struct impacts *all, int i)
{
	const struct rb_world *world = all->world;
	const rb_vec3 none = {0, 0, 0};
	const struct rb_flight_motion motion = rb_flight_of(&all->flight, i, none);
	struct rb_solver_body body = {.linear = rb_flight_velocity(&motion, all->t_s)};

	if (i >= world->model->body_count)
		return body;
	if (world->state.spin) {
		const struct rb_flight_turning turning = turning_of(all, i);

		body.angular = turning.spin;
		if (!all->held[i])
			body.angular = rb_vec3_add_scaled(
				body.angular, all->t_s / all->flight.h_s,
				rb_flight_forced_spin(&all->flight, i, turning.orientation));
	}
	if (!rb_stepped_is_dynamic(world, i))
		return body;
	body.inverse_mass = ldexp(world->model->inverse_mass[i], all->unit);
	if (world->state.spin)
		body.inverse_inertia = ldexp(world->model->inverse_inertia_scalar[i], all->unit);
	return body;
}

/* Of its inverse inertia; zero where that is a multiple of one. */
static rb_mat3 root_of(const struct impacts *all, int i)
{
	const struct rb_world *world = all->world;

	if (!world->state.spin || !isnan(world->model->inverse_inertia_scalar[i]))
		return (rb_mat3){{{0}}};
	struct rb_top_body top = all->s->top[i];
	rb_mat3 inertia = *rb_model_inertia(world->model, i);
	const double less = ldexp(1, -all->unit);

	top.moments = rb_vec3_scale(less, top.moments);
	for (int k = 0; k < 3; k++)
		for (int x = 0; x < 3; x++)
			inertia.m[k][x] *= less;
	return rb_top_inverse_root(&top, &inertia, turning_of(all, i).orientation);
}

/* A body of the problem; of what does not yield each contact has its own. */
static int joint_place(const struct impacts *all, struct rb_simultaneous *joint, int i)
{
	if (rb_stepped_is_dynamic(all->world, i))
		return all->place[i];
	joint->body[joint->body_count] = joint_body(all, i);
	return joint->body_count++;
}

/*
 * Contact of the simultaneous problem; `noise` is the approach below which it is lasting contact.
 */
static void fill_contact(const struct impacts *all, struct rb_simultaneous *joint, int k)
{
	struct rb_step_point *point = &all->points->row[all->contact[k]];
	struct rb_solver_contact *c = &joint->contact[k];
	rb_vec3 arm[2];

	rb_flight_turn(&all->flight, point, all->t_s, all->began[all->contact[k]], arm);
	const double least = rb_flight_least(&all->flight, point, point->normal);
	*c = (struct rb_solver_contact){
		.a = joint_place(all, joint, point->a),
		.b = joint_place(all, joint, point->b),
		.normal = point->normal,
		.arm_a = arm[0],
		.arm_b = arm[1],
		.friction = all->world->state.spin ? point->material->friction : 0,
		.restitution = point->material->restitution,
	};
	/* what lasts has an approach within what was left of it: no impact */
	c->noise = point->from > 0 ? fmax(least, all->noise) : all->noise;
}

/* Rounding of approaches in this group, m/s: of speeds, and of positions over the step. */
static double noise_of(const struct impacts *all, const struct rb_simultaneous *joint)
{
	double max = 0;

	for (int k = 0; k < all->body_count; k++) {
		const int i = all->body[k];
		const double turning = rb_vec3_length(joint->body[k].angular) *
		                       all->s->solver.reach[i];

		max = fmax(max, DBL_EPSILON * (rb_vec3_length(joint->body[k].linear) + turning) +
		                        rb_flight_rounding(&all->flight, i));
	}
	for (int k = 0; k < all->contact_count; k++) {
		const struct rb_step_point *point = &all->points->row[all->contact[k]];

		if (!rb_stepped_is_dynamic(all->world, point->b))
			max = fmax(max,
			           DBL_EPSILON * rb_vec3_length(rb_flight_of(&all->flight, point->b,
			                                                     point->arm_b)
			                                                .velocity));
	}
	return noise_ulp * max;
}

/* Whether no approaching contact has restitution. */
static bool is_plastic(const struct impacts *all)
{
	for (int k = 0; k < all->contact_count; k++) {
		const struct rb_step_point *point = &all->points->row[all->contact[k]];

		if (point->material->restitution > 0 &&
		    rb_flight_approach(&all->flight, point, point->normal) > 0)
			return false;
	}
	return true;
}

static long work_max_of(const struct impacts *all)
{
	return is_plastic(all) ? work_max_plastic : work_max;
}

/* All masses times two are to come to the same bits: roots of odd powers round otherwise. */
static int unit_of(const struct impacts *all)
{
	double max = 0;
	int unit = 0;

	for (int k = 0; k < all->body_count; k++)
		max = fmax(max, all->world->model->mass[all->body[k]]);
	(void)frexp(max, &unit);
	return unit;
}

/* False: no memory. */
static bool build(struct impacts *all, double approach, struct rb_simultaneous *joint)
{
	struct rb_arena *arena = &all->world->arena[0];
	const size_t contacts = (size_t)all->contact_count;

	*joint = (struct rb_simultaneous){.body_count = all->body_count,
	                                  .contact_count = all->contact_count,
	                                  .arena = arena,
	                                  .tolerance = fine_share * approach,
	                                  .interrupt = &all->world->interrupt,
	                                  .products_max = work_max_of(all) / (long)contacts};
	joint->body = rb_arena_take(arena, (size_t)all->body_count + 2 * contacts,
	                            sizeof *joint->body);
	joint->contact = rb_arena_take(arena, contacts, sizeof *joint->contact);
	rb_mat3 *const root = rb_arena_take(arena, (size_t)all->body_count + 1, sizeof *root);
	if (!joint->body || !joint->contact || !root)
		return false;
	joint->root = root;
	all->unit = unit_of(all);
	for (int k = 0; k < all->body_count; k++) {
		joint->body[k] = joint_body(all, all->body[k]);
		root[k] = root_of(all, all->body[k]);
	}
	all->noise = fmax(noise_of(all, joint), joint->tolerance);
	for (int k = 0; k < all->contact_count; k++)
		fill_contact(all, joint, k);
	return true;
}

static void kick(struct impacts *all, int i, const struct rb_solver_body *after)
{
	const struct rb_solver_body before = joint_body(all, i);
	const struct rb_flight_turning turning = turning_of(all, i);
	const struct rb_solver_body more = {.linear = rb_vec3_sub(after->linear, before.linear),
	                                    .angular = rb_vec3_sub(after->angular, before.angular)};

	RB_ASSERT_COSTLY(rb_stepped_is_dynamic(all->world, i));
	rb_flight_kick(&all->flight, i, all->t_s, &turning, &more);
}

/* ---- what is told ---- */

/* Time of the event; strictly after the end of the last step, so that events are in order. */
static double time_of(const struct impacts *all)
{
	return fmax(all->start_s + all->t_s, nextafter(all->start_s, (double)INFINITY));
}

/* One for all points and impacts of a pair at one moment. */
static struct rb_step_impact *find_hit(const struct impacts *all, const struct rb_step_point *point)
{
	struct rb_cohort *cohort = all->cohort;
	const double time = time_of(all);

	for (size_t k = cohort->hit_count; k-- > 0 && cohort->hit[k].time_s == time;)
		if (cohort->hit[k].a == point->a && cohort->hit[k].b == point->b &&
		    !cohort->hit[k].crowded)
			return &cohort->hit[k];
	return NULL;
}

static struct rb_step_impact *add_hit(struct impacts *all, const struct rb_step_point *point)
{
	struct rb_cohort *cohort = all->cohort;

	if (!rb_memory_reserve(&cohort->hit, &cohort->hit_capacity, cohort->hit_count + 1,
	                       sizeof *cohort->hit))
		return NULL;
	struct rb_step_impact *hit = &cohort->hit[cohort->hit_count++];
	*hit = (struct rb_step_impact){.a = point->a,
	                               .b = point->b,
	                               .time_s = time_of(all),
	                               .point = rb_flight_place(&all->flight, point, all->t_s),
	                               .normal = point->normal};
	return hit;
}

/* The pair's impulse acts in the middle of its points, each with the weight of its own. */
static void add_impulse(const struct impacts *all, struct rb_step_impact *hit,
                        const struct rb_step_point *point, const struct rb_solver_contact *c)
{
	const double normal_impulse = rb_vec3_dot(c->impulse, c->normal);

	RB_ASSERT_COSTLY(!(normal_impulse < 0));
	hit->impulse = rb_vec3_add(hit->impulse, c->impulse);
	if (!(normal_impulse > 0))
		return;
	hit->normal_impulse += normal_impulse;
	hit->point = rb_vec3_add_scaled(
		hit->point, normal_impulse / hit->normal_impulse,
		rb_vec3_sub(rb_flight_place(&all->flight, point, all->t_s), hit->point));
}

/*
 * A contact that touched and has passed an impact on is none of its own: its impulse is in the mean
 * force of the step.
 */
static bool pass(struct impacts *all, const struct rb_step_point *point,
                 const struct rb_solver_contact *c)
{
	struct rb_contacts *passed = &all->cohort->passed;
	const double normal_impulse = rb_vec3_dot(c->impulse, c->normal);

	if (rb_vec3_max_abs(c->impulse) == 0)
		return true;
	if (rb_contacts_reserve(passed, passed->count + 1, NULL) != RB_OK)
		return false;
	passed->row[passed->count++] = (struct rb_contact){
		.a = point->a,
		.b = point->b,
		.point = rb_flight_place(&all->flight, point, all->t_s),
		.normal = c->normal,
		.gap = point->gap,
		.normal_force = normal_impulse,
		.tangent_force = rb_vec3_add_scaled(c->impulse, -normal_impulse, c->normal),
		.parts = point->parts,
		.key = point->key,
	};
	return true;
}

static bool report(struct impacts *all, const struct rb_simultaneous *joint, bool converged)
{
	bool first = true;

	for (int k = 0; k < all->contact_count; k++) {
		const struct rb_solver_contact *c = &joint->contact[k];

		const struct rb_step_point *point = &all->points->row[all->contact[k]];

		if (!(c->approach > 0) && !pass(all, point, c))
			return false;
		if (!(c->approach > 0))
			continue;
		struct rb_step_impact *hit = find_hit(all, point);
		if (!hit)
			hit = add_hit(all, point);
		if (!hit)
			return false;
		if (c->approach > hit->approach) { /* the fastest of its points stands for it */
			hit->approach = c->approach;
			hit->normal = c->normal;
		}
		add_impulse(all, hit, point, c);
		hit->plastic = hit->plastic || (first && !converged);
		first = false;
	}
	return true;
}

/* 1/kg: what a body yields along the normal. */
static double inverse_effective_mass_of(const struct impacts *all, int i, rb_vec3 arm,
                                        rb_vec3 normal)
{
	struct rb_solver_body body = joint_body(all, i);
	const rb_mat3 root = root_of(all, i);
	const struct rb_solver_bodies alone = {.body = &body, .root = &root};

	return rb_effective_mass_along(&alone, 0, rb_vec3_cross(arm, normal));
}

/* The whole group is left to the end of the step. */
static bool target_velocity(struct impacts *all, size_t due)
{
	if (may_be_left(all, due))
		return true;
	for (int k = 0; k < all->body_count; k++)
		all->crowded[all->body[k]] = (unsigned char)all->crowd;
	if (all->crowd == CROWD_JOINED)
		return true;
	const struct rb_step_point *point = &all->points->row[due];
	struct rb_step_impact *hit = add_hit(all, point);
	const rb_vec3 none = {0, 0, 0};

	if (!hit)
		return false;
	hit->crowded = true;
	hit->approach = rb_flight_approach(&all->flight, point, point->normal);
	const double inverse_effective_mass =
		inverse_effective_mass_of(all, point->a, point->central ? none : point->arm_a,
	                                  point->normal) +
		inverse_effective_mass_of(all, point->b, point->central ? none : point->arm_b,
	                                  point->normal);
	hit->energy = 0.5 * hit->approach * hit->approach / inverse_effective_mass;
	return true;
}

/* ---- for the ledger ---- */

/* What each contact has done, while bodies have not been kicked yet; false: no memory. */
static bool note_blows(struct impacts *all, const struct rb_simultaneous *joint)
{
	struct rb_cohort *cohort = all->cohort;

	if (!rb_memory_reserve(&cohort->blow, &cohort->blow_capacity,
	                       cohort->blow_count + (size_t)joint->contact_count,
	                       sizeof *cohort->blow))
		return false;
	for (int k = 0; k < joint->contact_count; k++) {
		const struct rb_solver_contact *c = &joint->contact[k];
		const struct rb_step_point *point = &all->points->row[all->contact[k]];
		const struct rb_solver_body a = joint_body(all, point->a);
		const struct rb_solver_body b = joint_body(all, point->b);
		const rb_vec3 on_b = rb_solver_point_velocity(&b, c->arm_b);
		const rb_vec3 before = rb_vec3_sub(on_b, rb_solver_point_velocity(&a, c->arm_a));
		const rb_vec3 after = rb_vec3_sub(
			rb_solver_point_velocity(&joint->body[c->b], c->arm_b),
			rb_solver_point_velocity(&joint->body[c->a], c->arm_a));
		const rb_vec3 mean = rb_vec3_scale(0.5, rb_vec3_add(before, after));
		const double work = rb_vec3_dot(c->impulse, mean);
		const double along = rb_vec3_dot(c->impulse, c->normal) *
		                     rb_vec3_dot(mean, c->normal);

		if (rb_vec3_max_abs(c->impulse) == 0)
			continue;
		cohort->blow[cohort->blow_count++] = (struct rb_ledger_impact){
			.a = point->a,
			.b = point->b,
			.t_s = all->t_s,
			.impulse = c->impulse,
			.arm_a = c->arm_a,
			.along = -along,
			.across = along - work,
			.driven = -rb_vec3_dot(c->impulse, on_b)};
	}
	return true;
}

/* ---- one moment ---- */

/* False: no memory. */
static bool collide(struct impacts *all, size_t due, bool *done)
{
	struct rb_simultaneous joint;
	const rb_arena_mark here = rb_arena_here(&all->world->arena[0]);
	const struct rb_step_point *point = &all->points->row[due];
	rb_vec3 normal;

	(void)rb_flight_gap(&all->flight, point, all->t_s, &normal);
	bool fine = build(all, rb_flight_approach(&all->flight, point, normal), &joint);

	*done = false;
	if (fine) {
		const bool converged = rb_simultaneous_impact(&joint, NULL);

		for (int k = 0; k < joint.contact_count; k++)
			joint.contact[k].impulse = rb_vec3_scale(ldexp(1, all->unit),
			                                         joint.contact[k].impulse);
		all->unit = 0;
		*done = !rb_simultaneous_is_over(&joint);
		if (!*done)
			all->crowd = CROWD_LARGE;
		fine = *done ? report(all, &joint, converged) : target_velocity(all, due);
	}
	if (fine && *done && all->s->tally)
		fine = note_blows(all, &joint);
	for (int k = 0; k < all->body_count && fine && *done; k++)
		kick(all, all->body[k], &joint.body[k]);
	rb_arena_back(&all->world->arena[0], here);
	return fine;
}

/* What touches has just been dealt with: it is due again if it approaches. */
static enum rb_status predict_again(struct impacts *all, size_t point, struct rb_error *err)
{
	const struct rb_step_point *of = &all->points->row[point];

	all->seen[point] = 1;
	if (all->touched[point] && rb_flight_is_done(&all->flight, of, all->t_s, all->noise)) {
		all->due_s[point] = (double)INFINITY;
		return RB_OK;
	}
	return predict(all, point, all->t_s, err);
}

static enum rb_status run_event(struct impacts *all, struct rb_due_impact due, struct rb_error *err)
{
	enum rb_status status = RB_OK;
	bool done = false, fine;

	RB_ASSERT(due.t_s >= 0 && due.t_s <= all->flight.h_s);
	if (rb_interrupt_after(&all->world->interrupt, EVENT_WORK))
		return RB_FAIL(err, RB_ERR_INTERRUPT, "interrupted");
	all->t_s = due.t_s;
	all->due_s[due.point] = (double)INFINITY;
	fine = gather(all, due.point) ? collide(all, due.point, &done)
	                              : target_velocity(all, due.point);
	for (int k = 0; k < all->contact_count && done; k++)
		all->touched[all->contact[k]] = 1;
	for (int k = 0; k < all->body_count && done && status == RB_OK; k++) {
		const int i = all->body[k];

		for (size_t at = all->first[i]; at < all->first[i + 1] && status == RB_OK; at++)
			status = predict_again(all, all->of[at], err);
	}
	forget_set(all);
	return fine ? status : RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
}

/*
 * What impacts add to a velocity by the step's end. Drag takes of it for the rest of the step: what
 * it has taken of the velocity before would else push a body that has turned round.
 */
static rb_vec3 left_of_kick(const struct impacts *all, int i, const struct rb_kick *of)
{
	struct rb_stepped *s = all->s;

	if (!s->undragged)
		return of->linear;
	const rb_vec3 taken = rb_vec3_scale(
		s->undragged[i] - 1,
		rb_vec3_add_scaled(of->linear, 1 / all->flight.h_s, of->shift));
	if (s->tally)
		s->tally->body[i].drag = rb_vec3_add_scaled(s->tally->body[i].drag,
		                                            all->world->model->mass[i], taken);
	return rb_vec3_add(of->linear, taken);
}

/* The step is solved from velocities after the impacts, for the ways that are left. */
static void end(struct impacts *all)
{
	struct rb_stepped *s = all->s;
	struct rb_state *state = &all->world->state;

	for (size_t k = 0; k < all->points->count; k++) {
		struct rb_step_point *point = &all->points->row[k];

		if (all->seen[k])
			rb_flight_see(&all->flight, point, all->touched[k]);
	}
	for (int k = 1; k <= s->kicks.count; k++) {
		const struct rb_kick *of = &s->kicks.row[k];
		double *const v = state->velocity + 3 * (size_t)of->body;

		rb_vec3_to(v, rb_vec3_add(rb_vec3_from(v), left_of_kick(all, of->body, of)));
		if (of->turns)
			rb_flight_turn_from(&all->flight, state, of->body);
	}
}

enum rb_status rb_impacts_resolve(struct rb_world *world, struct rb_cohort *cohort, double start,
                                  double h, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct impacts all = {.world = world,
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
	cohort->hit_count = cohort->blow_count = cohort->passed.count = 0;
	for (int k = 1; k <= s->kicks.count; k++)
		s->kicks.place[s->kicks.row[k].body] = 0;
	s->kicks.count = 0;
	bool any = false;
	all.seen = rb_arena_take(&world->arena[0], all.points->count, 1);
	if (!all.seen)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the impacts of a step");
	if (s->kicks.place)
		any = rb_flight_find_possible(&all.flight, all.points, all.seen);
	if (!any) {
		rb_arena_back(&world->arena[0], here);
		return RB_OK;
	}
	s->due.count = 0;
	enum rb_status status = begin(&all, err);
	size_t left = EVENTS_MAX + EVENTS_PER_POINT * all.points->count;
	while (status == RB_OK && s->due.count > 0 && left > 0) {
		const struct rb_due_impact due = rb_impact_queue_next(&s->due);

		if (due.t_s != all.due_s[due.point]) /* it has been foreseen anew */
			continue;
		left--;
		status = run_event(&all, due, err);
	}
	if (status == RB_OK)
		end(&all);
	rb_arena_back(&world->arena[0], here);
	return status;
}

void rb_impacts_seen(const struct rb_stepped *s, struct rb_step_point *point)
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
