/* SPDX-License-Identifier: MIT */
/*
 * External impulses of a step. Constant forces are those of the classic method. Springs are
 * semi-implicit where the step resolves them and fully implicit where it does not (see impulse_of),
 * so that stiff springs stay stable with the frame's step; drag is implicit, a scalar quadratic
 * equation per body. Elements are evaluated for the state at the beginning (Jacobi, not
 * Gauss-Seidel), so their order does not matter.
 *
 * Here each spring is solved alone, for bodies lighter by the number of their springs
 * (add_inverse_mass). Where a spring is not resolved that does not bound the energy: bodies that
 * such springs connect are solved together (stepped/nets), unless joints or contacts hold them:
 * then springs are rows of their groups (stepped/spring_steps).
 */
#include "stepped/force.h"

#include <string.h>

#include "base/error.h"
#include "force/drag.h"
#include "force/spring.h"
#include "step/force_stages.h"
#include "stepped/nets.h"
#include "stepped/tally.h"

/* ---- forces shared with the classic method ---- */

struct flow {
	struct rb_world *world;
	const struct rb_cohort *cohort;
	double start_s, h_s;
	/* [springs] not resolved by the whole step, of which this may be a part */
	unsigned char *stiff;
	bool any_stiff;
	bool all_listed; /* list resolved springs too */
};

/* Runs the classic method's stages of forces for one block of bodies. */
static void run_stages(void *user, int block, int worker)
{
	static const struct rb_stage *const stages[] = {&rb_stage_gravity, &rb_stage_gravity_force,
	                                                &rb_stage_applied, &rb_stage_pushes};
	const struct flow *flow = user;
	const int first = block * RB_BODIES_PER_BLOCK;
	const int rest = flow->cohort->member_count - first;
	struct rb_pass pass = {.world = flow->world,
	                       .arena = &flow->world->arena[worker],
	                       .member = flow->cohort->body + first,
	                       .member_count = rest < RB_BODIES_PER_BLOCK ? rest
	                                                                  : RB_BODIES_PER_BLOCK,
	                       .start_s = flow->start_s,
	                       .dt_s = flow->h_s,
	                       .h_s = flow->h_s};

	for (size_t k = 0; k < sizeof stages / sizeof stages[0]; k++)
		if (rb_stage_is_needed(stages[k], flow->world->model->features))
			stages[k]->run(&pass);
}

/* ---- force elements between bodies ---- */

/* State of a spring's end; a body that is not dynamic has infinite mass. */
struct end {
	int i;
	rb_vec3 arm, at, velocity;
};

/* In world axes: lever arm from the centre of mass, point, and its velocity. */
static struct end end_of(const struct rb_world *world, int i, rb_vec3 point)
{
	const struct rb_pose pose = rb_world_pose(world, &world->state, i);
	struct end end = {.i = i, .velocity = pose.velocity};

	end.arm = rb_element_arm(world->model, i, pose.orientation, point);
	end.at = rb_vec3_add(pose.position, end.arm);
	if (i < world->model->body_count && world->state.spin)
		end.velocity = rb_vec3_add(end.velocity, rb_vec3_cross(pose.spin, end.arm));
	return end;
}

/*
 * Adds the inverse mass matrix of the body at that end, 1/kg, times the number of its springs: each
 * spring then sees a body lighter by that factor, and all of them together are as stable as each
 * alone.
 */
static void add_inverse_mass(const struct rb_world *world, const struct rb_elements *springs,
                             const struct end *end, rb_mat3 *inverse_effective_mass)
{
	RB_ASSERT_COSTLY(springs->first[end->i + 1] > springs->first[end->i]);
	if (!rb_stepped_is_dynamic(world, end->i))
		return;
	const double count = springs->first[end->i + 1] - springs->first[end->i];

	for (int c = 0; c < 3; c++) {
		const rb_vec3 unit = {c == 0, c == 1, c == 2};
		rb_vec3 v = rb_vec3_scale(world->model->inverse_mass[end->i], unit);

		if (world->state.spin)
			v = rb_vec3_add(v,
			                rb_vec3_cross(rb_world_turn(world, &world->state, end->i,
			                                            rb_vec3_cross(end->arm, unit)),
			                              end->arm));
		inverse_effective_mass->m[0][c] += count * v.x;
		inverse_effective_mass->m[1][c] += count * v.y;
		inverse_effective_mass->m[2][c] += count * v.z;
	}
}

/* h^2 k |Y| up to which semi-implicit Euler is stable. */
static const double stable_max = 4;

/* Frobenius norm, an upper bound of the largest eigenvalue. */
static double size_of(const rb_mat3 *a)
{
	double square = 0;

	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			square += a->m[r][c] * a->m[r][c];
	return sqrt(square);
}

/* Sets a spring's state at the beginning of the step; false: its direction is undefined. */
static bool measure(const struct rb_spring_def *spring, const struct end end[2],
                    struct rb_step_spring *of)
{
	const rb_vec3 d = rb_vec3_sub(end[1].at, end[0].at);
	const double length = rb_vec3_length(d);

	*of = (struct rb_step_spring){.end = {end[0].i, end[1].i},
	                              .arm = {end[0].arm, end[1].arm},
	                              .stiffness = spring->stiffness,
	                              .damping = length > 0 ? spring->damping : 0,
	                              .rest = spring->rest_length_m,
	                              .stretch = length - spring->rest_length_m,
	                              .missed = {(double)INFINITY, 0, 0},
	                              .first_row = -1};
	/* coincident ends of a spring without rest length separate in any direction */
	of->along = rb_vec3_unit(d, (rb_vec3){0, 0, 1});
	of->across = spring->stiffness * (length > 0 ? fmax(0, of->stretch / length) : 1);
	return length > 0 || spring->rest_length_m == 0;
}

/*
 * Impulse of a spring on its end b, N s, if bodies are free. With f the present force, Y the
 * inverse effective mass and A = h (h K + C), where K = -df/dx (without the negative stiffness
 * across a compressed spring) and C = -df/dv: implicit Euler gives (1 + A Y) p = h f - h^2 K v. A
 * spring with (h^2 k + h c) |Y| <= 1 is resolved and acts explicitly: semi-implicit Euler, stable
 * up to h^2 k |Y| = 4, keeps its oscillation. Joints or contacts reduce Y, so that it stays
 * resolved. One that is not resolved is listed for its net or group; in scenes with joints all are,
 * for mechanisms.
 */
static rb_vec3 impulse_of(struct flow *flow, const struct rb_elements *springs, int number,
                          const struct end end[2], int element)
{
	struct rb_world *world = flow->world;
	const struct rb_spring_def *spring = rb_elements_row(springs, number);
	struct rb_solver *solver = &world->stepped->solver;
	const double h = flow->h_s, whole = fmax(h, solver->whole_s);
	const rb_vec3 v = rb_vec3_sub(end[1].velocity, end[0].velocity);
	struct rb_step_spring of;
	rb_mat3 inverse_effective_mass = {{{0}}}, stiff, system, inverse;

	if (!measure(spring, end, &of))
		return (rb_vec3){0, 0, 0};
	const rb_vec3 n = of.along;
	const double across = h * h * of.across, along = h * (h * of.stiffness + of.damping);
	const double tension = h * of.stiffness * of.stretch;
	const double external = tension + h * of.damping * rb_vec3_dot(v, n);
	add_inverse_mass(world, springs, &end[0], &inverse_effective_mass);
	add_inverse_mass(world, springs, &end[1], &inverse_effective_mass);
	const double size = size_of(&inverse_effective_mass);
	of.tension = external / h;
	of.resolved = along * size <= 1;
	of.row = number;
	of.number = element;
	flow->stiff[number] = whole * (whole * of.stiffness + of.damping) * size > 1;
	flow->any_stiff = flow->any_stiff || flow->stiff[number];
	if (of.resolved) {
		of.impulse = rb_vec3_scale(-external, n);
		of.across = spring->rest_length_m == 0 ? spring->stiffness : 0;
		if (flow->all_listed && along > 0)
			solver->spring[solver->spring_count++] = of;
		return of.impulse;
	}
	const double x[3] = {n.x, n.y, n.z};
	for (int r = 0; r < 3; r++)
		for (int s = 0; s < 3; s++)
			stiff.m[r][s] = (along - across) * (x[r] * x[s]) + (r == s ? across : 0);
	system = rb_mat3_multiply(&stiff, &inverse_effective_mass);
	for (int r = 0; r < 3; r++)
		system.m[r][r] += 1;
	const rb_vec3 right = rb_vec3_add_scaled(rb_mat3_apply(&stiff, v), tension, n);
	if (!rb_mat3_inverse(&system, &inverse))
		return rb_vec3_scale(-external, n);
	of.impulse = rb_vec3_neg(rb_mat3_apply(&inverse, right));
	/*
	 * a spring without rest length that the step resolves thanks to joints acts in all
	 * directions
	 */
	if (across * size <= stable_max && !(flow->all_listed && spring->rest_length_m == 0))
		of.across = 0;
	solver->spring[solver->spring_count++] = of;
	return of.impulse;
}

/* Impulses of an element on the bodies at its ends, N s and N m s. */
struct external {
	struct rb_wrench on[2];
	bool acts;
};

static void spring_impulses(struct flow *flow, const struct rb_elements *springs, int k,
                            int element, struct rb_wrench on[2])
{
	const struct rb_world *world = flow->world;
	const struct rb_spring_def *spring = rb_elements_row(springs, k);
	const struct end end[2] = {end_of(world, springs->end[k][0], spring->at_a),
	                           end_of(world, springs->end[k][1], spring->at_b)};
	const rb_vec3 p = impulse_of(flow, springs, k, end, element);

	on[0].force = rb_vec3_neg(p);
	on[1].force = p;
	for (int e = 0; e < 2; e++)
		on[e].torque = rb_vec3_cross(end[e].arm, on[e].force);
}

static struct rb_pose begin_pose(const struct rb_element_query *query, int index)
{
	const struct rb_world *world = query->user;

	return rb_world_pose(world, &world->mark, index);
}

/* Wrench at the beginning of the step times h. */
static struct rb_wrench explicit_impulse(const struct rb_world *world,
                                         const struct rb_elements *elements, int k, int index,
                                         const struct flow *flow)
{
	const struct rb_element_query query = {
		.model = world->model, .time_s = flow->start_s, .pose = begin_pose, .user = world};
	const struct rb_pose pose = begin_pose(&query, index);
	struct rb_wrench on;

	if (!elements->kind->act(&query, rb_elements_row(elements, k), index, &pose, &on))
		return (struct rb_wrench){0};
	return (struct rb_wrench){rb_vec3_scale(flow->h_s, on.force),
	                          rb_vec3_scale(flow->h_s, on.torque)};
}

/* Springs may be implicit; every other kind acts with its wrench at the beginning. */
static struct external impulses_of(struct flow *flow, const struct rb_elements *elements, int k,
                                   int number)
{
	struct rb_world *world = flow->world;
	const int *const end = elements->end[k];
	struct external external = {.acts = true};

	if (elements->kind == &rb_force_spring)
		spring_impulses(flow, elements, k, number, external.on);
	else
		for (int e = 0; e < 2; e++)
			external.on[e] = explicit_impulse(world, elements, k, end[e], flow);
	return external;
}

/* Applies an impulse to a dynamic body. */
static void apply(struct rb_world *world, int i, const struct rb_wrench *impulse)
{
	if (!rb_stepped_is_dynamic(world, i))
		return;
	const size_t row = 3 * (size_t)i;

	rb_vec3_to(world->state.velocity + row,
	           rb_vec3_add_scaled(rb_vec3_from(world->state.velocity + row),
	                              world->model->inverse_mass[i], impulse->force));
	if (world->state.spin)
		rb_vec3_to(world->state.spin + row,
		           rb_vec3_add(rb_vec3_from(world->state.spin + row),
		                       rb_world_turn(world, &world->state, i, impulse->torque)));
}

static bool is_here(const struct rb_world *world, const unsigned char *here, int i)
{
	return rb_stepped_is_dynamic(world, i) && here[i];
}

/*
 * Adds elements with two ends: all impulses first, then all changes of velocities, so that the
 * order affects only the rounding of sums.
 */
static enum rb_status add_between(struct flow *flow, const unsigned char *here,
                                  struct rb_error *err)
{
	struct rb_world *world = flow->world;
	const struct rb_model *model = world->model;
	const int count = rb_elements_between(model);
	struct external *external = rb_arena_take(&world->arena[0], (size_t)count,
	                                          sizeof *external);
	struct rb_tally_element *tally = world->stepped->tally ? world->stepped->tally->element
	                                                       : NULL;
	int n = 0;

	flow->stiff = rb_arena_take(&world->arena[0], (size_t)count, 1);
	flow->all_listed = model->joints && !rb_islands_forces_vary(world);
	if (!external || !flow->stiff)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %d springs", count);
	memset(flow->stiff, 0, (size_t)count);
	for (int list = 0; list < model->element_list_count; list++) {
		const struct rb_elements *elements = &model->elements[list];

		for (int k = 0; elements->end && k < elements->count; k++, n++) {
			const int *const end = elements->end[k];

			external[n] = (struct external){0};
			if (is_here(world, here, end[0]) || is_here(world, here, end[1]))
				external[n] = impulses_of(flow, elements, k, n);
		}
	}
	const enum rb_status status = flow->any_stiff ? rb_nets_find(world, here, flow->stiff,
	                                                             flow->h_s, err)
	                                              : RB_OK;
	if (status != RB_OK)
		return status;
	n = 0;
	for (int list = 0; list < model->element_list_count; list++) {
		const struct rb_elements *elements = &model->elements[list];
		const bool springs = elements->kind == &rb_force_spring;

		for (int k = 0; elements->end && k < elements->count; k++, n++) {
			if (!external[n].acts ||
			    (springs && rb_nets_record(world->stepped, k, external[n].on[1].force)))
				continue;
			for (int e = 0; e < 2; e++) {
				apply(world, elements->end[k][e], &external[n].on[e]);
				if (tally)
					tally[n].on[e] = external[n].on[e];
			}
			if (tally)
				tally[n].damped = (double)NAN;
		}
	}
	return RB_OK;
}

/* ---- force elements on every body, fields and drag ---- */

/* Adds elements with one end, evaluated at the beginning of the step. */
static void add_explicit(const struct flow *flow, const struct rb_elements *elements)
{
	struct rb_world *world = flow->world;

	for (int m = 0; m < flow->cohort->member_count; m++) {
		const int i = flow->cohort->body[m];

		for (int k = 0; k < elements->count; k++) {
			const struct rb_wrench on = explicit_impulse(world, elements, k, i, flow);

			apply(world, i, &on);
			if (!world->stepped->tally)
				continue;
			struct rb_tally_body *body = &world->stepped->tally->body[i];
			struct rb_wrench *sum = elements->kind->energy ? &body->stored
			                                               : &body->varied;
			if (elements->kind->is_drag) {
				body->drag = rb_vec3_add(body->drag, on.force);
				continue;
			}
			sum->force = rb_vec3_add(sum->force, on.force);
			sum->torque = rb_vec3_add(sum->torque, on.torque);
		}
	}
}

/* Records the change of a time-dependent potential over the step at the body's initial position. */
static enum rb_status note_potential(struct rb_world *world, int i, double start, double h,
                                     struct rb_error *err)
{
	const struct rb_world_hooks *hooks = &world->hooks;
	const int id = world->model->id_of[i];
	const rb_vec3 at = rb_world_row3(world->mark.position, i);
	double before = 0, after = 0;
	enum rb_status status = hooks->potential(hooks->user, id, start, at, &before, err);

	if (status == RB_OK)
		status = hooks->potential(hooks->user, id, start + h, at, &after, err);
	world->stepped->tally->body[i].potential_change = after - before;
	return status;
}

/* Adds force fields, which are callbacks: one after the other, in the simulator's thread. */
static enum rb_status add_fields(struct rb_world *world, const struct rb_cohort *cohort,
                                 double start, double h, struct rb_error *err)
{
	const struct rb_world_hooks *hooks = &world->hooks;
	enum rb_status status = RB_OK;

	for (int k = 0; hooks->field && k < cohort->member_count && status == RB_OK; k++) {
		const int i = cohort->body[k];
		double *const v = world->state.velocity + 3 * (size_t)i;
		rb_vec3 force[2] = {{0, 0, 0}, {0, 0, 0}};

		const rb_vec3 at[2] = {rb_world_row3(world->mark.position, i),
		                       rb_world_row3(world->mark.velocity, i)};

		status = hooks->field(hooks->user, world->model->id_of[i], start, at, force, err);
		rb_vec3_to(v, rb_vec3_add_scaled(rb_vec3_from(v), h * world->model->inverse_mass[i],
		                                 hooks->potential ? rb_vec3_add(force[0], force[1])
		                                                  : force[0]));
		if (!world->stepped->tally)
			continue;
		struct rb_tally_body *const body = &world->stepped->tally->body[i];

		body->varied.force = rb_vec3_add(body->varied.force, rb_vec3_scale(h, force[0]));
		body->stored.force = rb_vec3_add(body->stored.force, rb_vec3_scale(h, force[1]));
		if (hooks->potential && status == RB_OK)
			status = note_potential(world, i, start, h, err);
	}
	return status;
}

static const rb_vec3 none = {0, 0, 0};

/*
 * Implicit drag: m (v - u) = -h (l + q |v|) v. v is parallel to u, and |v| is the root of a
 * quadratic, written without cancellation; s = |v| / |u|. The body moves by s times the parabola
 * plus 1 - s times the end velocity: with the displacement h (v - s (v - v0) / 2) gravity and drag
 * together never add energy, however large drag is.
 */
static void add_drag(struct rb_world *world, const struct rb_cohort *cohort, double h)
{
	const struct rb_drag_def drag = rb_drag_of_all(world->model);

	for (int k = 0; k < cohort->member_count; k++) {
		const int i = cohort->body[k];
		double *const v = world->state.velocity + 3 * (size_t)i;
		const double share = h * world->model->inverse_mass[i];
		const double b = 1 + share * drag.linear;
		const double speed = rb_vec3_length(rb_vec3_from(v));

		const double left = 2 / (b + sqrt(b * b + 4 * share * drag.quadratic * speed));
		double *const varied = world->stepped->varied + 3 * (size_t)i;
		const rb_vec3 others = rb_vec3_add(rb_world_row3(world->mark.velocity, i),
		                                   rb_vec3_from(varied));

		const bool of_net = rb_nets_of(world->stepped, i) >= 0;

		/* springs of a net act after drag */
		world->stepped->undragged[i] = of_net ? 1 : left;
		if (world->stepped->tally) {
			struct rb_tally_body *body = &world->stepped->tally->body[i];

			body->drag = rb_vec3_add_scaled(
				body->drag, (left - 1) * world->model->mass[i], rb_vec3_from(v));
			body->carry = rb_vec3_scale(0.5 * h * left * left, others);
		}
		rb_vec3_to(v, rb_vec3_scale(left, rb_vec3_from(v)));
		/* a net starts from the velocity that drag leaves, of constant forces too */
		const rb_vec3 to = of_net ? none : rb_vec3_from(v);

		rb_vec3_to(varied, rb_vec3_add_scaled(rb_vec3_from(varied), 1 - left,
		                                      rb_vec3_sub(to, others)));
	}
}

/* Gravitation at the beginning of the step. */
static void add_gravitation(struct rb_world *world, const struct rb_cohort *cohort)
{
	for (int k = 0; k < cohort->member_count; k++) {
		double *const v = world->state.velocity + 3 * (size_t)cohort->body[k];

		rb_vec3_to(v, rb_vec3_add_scaled(
				      rb_vec3_from(v), cohort->gravitation_s,
				      rb_gravitation_found(world->gravitation, cohort->body[k])));
	}
}

/* ---- top level ---- */

/* Marks dynamic bodies of the cohort; NULL: no memory. */
static unsigned char *marks_of(struct rb_world *world, const struct rb_cohort *cohort)
{
	const size_t n = (size_t)world->model->body_count;
	unsigned char *here = rb_arena_take(&world->arena[0], n, 1);

	if (here) {
		memset(here, 0, n);
		for (int k = 0; k < cohort->member_count; k++)
			here[cohort->body[k]] = 1;
	}
	return here;
}

/*
 * Called before (sign -1) and after (+1) the varying forces: `varied` becomes the change of
 * velocity between.
 */
static void note_varied(struct rb_world *world, const struct rb_cohort *cohort, double sign)
{
	double *const varied = world->stepped->varied;

	for (int k = 0; k < cohort->member_count; k++) {
		const size_t row = 3 * (size_t)cohort->body[k];
		const rb_vec3 v = rb_vec3_from(world->state.velocity + row);

		rb_vec3_to(varied + row,
		           sign < 0 ? rb_vec3_neg(v) : rb_vec3_add(v, rb_vec3_from(varied + row)));
	}
}

/*
 * For the ledger: displacement of a free body at which constant forces do their work, half of that
 * by the varying ones alone.
 */
static void note_carry(struct rb_world *world, const struct rb_cohort *cohort, double h)
{
	for (int k = 0; k < cohort->member_count; k++) {
		const int i = cohort->body[k];

		world->stepped->tally->body[i].carry = rb_vec3_scale(
			0.5 * h, rb_vec3_add(rb_world_row3(world->mark.velocity, i),
		                             rb_world_row3(world->stepped->varied, i)));
	}
}

enum rb_status rb_force_add(struct rb_world *world, const struct rb_cohort *cohort, double start,
                            double h, struct rb_error *err)
{
	const rb_features features = world->model->features;
	struct flow flow = {.world = world, .cohort = cohort, .start_s = start, .h_s = h};
	enum rb_status status = RB_OK;

	RB_ASSERT(h > 0);
	world->stepped->solver.spring_count = world->stepped->solver.sprung_count = 0;
	world->stepped->nets = NULL;
	rb_team_run(world->team,
	            (cohort->member_count + RB_BODIES_PER_BLOCK - 1) / RB_BODIES_PER_BLOCK,
	            run_stages, &flow);
	if (!world->stepped->varied)
		return RB_OK;
	if (world->stepped->tally)
		rb_tally_begin(world, cohort);
	note_varied(world, cohort, -1);
	if (rb_elements_between(world->model) > 0) {
		const unsigned char *here = marks_of(world, cohort);

		status = here ? add_between(&flow, here, err)
		              : RB_FAIL(err, RB_ERR_MEMORY, "no memory for springs");
	}
	for (int list = 0; list < world->model->element_list_count; list++) {
		const struct rb_elements *elements = &world->model->elements[list];

		if (!elements->end && elements->kind != &rb_force_drag)
			add_explicit(&flow, elements);
	}
	if (features & RB_FEATURE_GRAVITATION)
		add_gravitation(world, cohort);
	if (status == RB_OK && (features & RB_FEATURE_FIELD))
		status = add_fields(world, cohort, start, h, err);
	note_varied(world, cohort, 1);
	if (world->stepped->tally)
		note_carry(world, cohort, h);
	if (status == RB_OK && (features & RB_FEATURE_DRAG))
		add_drag(world, cohort, h);
	if (status == RB_OK)
		rb_nets_solve(world, h);
	return status;
}
