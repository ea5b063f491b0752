/* SPDX-License-Identifier: MIT */
/*
 * Energy balance of position projection. Moving a body against gravity adds potential energy that
 * no contact force has given; it is taken from the kinetic energy of the same group, in the order
 * of rb_projection_energy_pay: spin about the contacts, motion along the displacements of the
 * projection, all motion. A body whose group cannot pay is marked bad, and the step is halved.
 *
 * Sums are kept per group at its root (union-find of islands, joined where projection connects
 * them). For a change of velocities by -s d the kinetic energy changes by -s <v, d>_M + s^2 <d,
 * d>_M / 2; `share_of` solves that for s.
 */
#include "stepped/projection_energy.h"

#include <string.h>

#include "base/error.h"
#include "base/forest.h"
#include "base/memory.h"
#include "base/team.h"
#include "stepped/energy.h"
#include "stepped/tally.h"

/*
 * Sums of a group, J: potential energy gained, kinetic energy, and <v, d> and <d, d> in the mass
 * metric for d = torque of the projection (TURN_*) and d = its displacement.
 */
enum { RISE, KINETIC, TURN_MIXED, TURN_SQUARE, MIXED, SQUARE, SUMS };

enum { BODIES_PER_BLOCK = 128 };

/*
 * Energy that contacts with an initial overlap have not given: gap times force. Rising again by
 * that much is not a gain.
 */
static void add_sunk(struct rb_projection_energy *lift, const struct rb_step_points *points,
                     double h)
{
	RB_ASSERT(h > 0);
	for (size_t k = 0; k < points->count; k++) {
		const struct rb_step_point *point = &points->row[k];

		if (point->gap < 0 && point->normal_impulse > 0)
			lift->sunk[rb_forest_root(lift->parent, point->a)] -=
				point->gap * point->normal_impulse / h;
	}
}

/*
 * Joins bodies that touch. A group of the solution contains all that is near; bodies that nothing
 * touches have no part in its rotation.
 */
static void join_touching(struct rb_projection_energy *lift, const struct rb_world *world,
                          const struct rb_step_points *points)
{
	const struct rb_joints *const joints = world->model->joints;

	for (size_t k = 0; k < points->count; k++)
		if (points->row[k].normal_impulse > 0 &&
		    rb_stepped_is_dynamic(world, points->row[k].b))
			rb_forest_join(lift->joined, points->row[k].a, points->row[k].b, false);
	for (int k = 0; joints && k < joints->count; k++) {
		const int a = joints->joint[k].a, b = joints->joint[k].b;

		if (!world->joint[k].released && b >= 0 && rb_stepped_is_dynamic(world, a) &&
		    rb_stepped_is_dynamic(world, b))
			rb_forest_join(lift->joined, a, b, false);
	}
}

enum rb_status rb_projection_energy_begin(struct rb_projection_energy *lift, struct rb_world *world,
                                          const struct rb_step_points *points, double h,
                                          struct rb_error *err)
{
	const struct rb_solver *solver = &world->stepped->solver;
	struct rb_arena *arena = &world->arena[0];
	const size_t n = (size_t)world->model->body_count;

	*lift = (struct rb_projection_energy){
		.parent = rb_arena_take(arena, n, sizeof *lift->parent),
		.joined = rb_arena_take(arena, n, sizeof *lift->joined),
		.energy_budget = rb_arena_take(arena, n, sizeof *lift->energy_budget),
		.sunk = rb_arena_take(arena, n, sizeof *lift->sunk),
		.displacement = rb_arena_take(arena, 6 * n, sizeof *lift->displacement),
		.turn = rb_arena_take(arena, 3 * n, sizeof *lift->turn),
		.swept = rb_arena_take(arena, 3 * n, sizeof *lift->swept),
		.moved = rb_arena_take(arena, n, 1),
		.has_driven = rb_arena_take(arena, n, 1),
		.has_static = rb_arena_take(arena, n, 1),
		.momentum_change = rb_arena_take(arena, n, sizeof *lift->momentum_change),
		.sum = rb_arena_take(arena, SUMS * n, sizeof *lift->sum)};
	if (!lift->parent || !lift->joined || !lift->energy_budget || !lift->sunk ||
	    !lift->displacement || !lift->turn || !lift->swept || !lift->moved ||
	    !lift->has_driven || !lift->has_static || !lift->momentum_change || !lift->sum)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the overlaps of a step");
	memset(lift->turn, 0, 3 * n * sizeof *lift->turn);
	memset(lift->swept, 0, 3 * n * sizeof *lift->swept);
	memset(lift->moved, 0, n);
	memset(lift->has_driven, 0, n);
	memset(lift->has_static, 0, n);
	memset(lift->momentum_change, 0, n * sizeof *lift->momentum_change);
	for (size_t i = 0; i < n; i++) {
		lift->parent[i] = lift->joined[i] = (int)i;
		lift->energy_budget[i] = lift->sunk[i] = 0;
	}
	for (size_t g = 0; g < solver->island_count; g++) {
		const struct rb_island *island = &solver->island[g];
		const int *member = solver->member + island->first_member;

		lift->energy_budget[member[0]] = island->rests ? 0 : island->energy_budget;
		for (int k = 1; k < island->member_count; k++)
			lift->parent[member[k]] = member[0];
	}
	add_sunk(lift, points, h);
	join_touching(lift, world, points);
	return RB_OK;
}

void rb_projection_energy_join(struct rb_projection_energy *lift, const struct rb_world *world,
                               int a, int b)
{
	const int root = rb_forest_root(lift->parent, a);

	RB_ASSERT_COSTLY(rb_stepped_is_dynamic(world, a));
	if (!rb_stepped_is_dynamic(world, b)) {
		const bool is_static = b >= world->model->body_count;

		lift->has_driven[root] = lift->has_driven[root] || !is_static;
		lift->has_static[root] = lift->has_static[root] || is_static;
		return;
	}
	rb_forest_join(lift->joined, a, b, false);
	const int other = rb_forest_root(lift->parent, b);
	if (root == other)
		return;
	const int first = root < other ? root : other, second = root < other ? other : root;
	lift->parent[second] = first;
	lift->energy_budget[first] += lift->energy_budget[second];
	lift->sunk[first] += lift->sunk[second];
	lift->has_driven[first] = lift->has_driven[first] || lift->has_driven[second];
	lift->has_static[first] = lift->has_static[first] || lift->has_static[second];
}

void rb_projection_energy_turn(struct rb_projection_energy *lift, const struct rb_world *world,
                               const struct rb_step_points *closing)
{
	for (size_t k = 0; world->state.spin && k < closing->count; k++) {
		const struct rb_step_point *point = &closing->row[k];
		const int ends[2] = {point->a, point->b};

		/* points of balls about their centres of mass do not move with the rotation */
		for (int e = 0; e < 2 && point->normal_impulse > 0 && !point->central; e++) {
			const int i = ends[e];
			if (!rb_stepped_is_dynamic(world, i))
				continue;
			double *const turn = lift->turn + 3 * (size_t)i;
			const rb_vec3 spin = rb_vec3_from(world->stepped->saved_velocity +
			                                  6 * (size_t)i + 3);
			const rb_vec3 along = rb_vec3_cross(spin, e ? point->arm_b : point->arm_a);

			rb_vec3_to(turn, rb_vec3_add_scaled(rb_vec3_from(turn),
			                                    e ? point->normal_impulse
			                                      : -point->normal_impulse,
			                                    rb_vec3_cross(along, point->normal)));
		}
	}
}

void rb_projection_energy_add(struct rb_projection_energy *lift, struct rb_world *world, int i)
{
	const struct rb_solver *solver = &world->stepped->solver;
	const struct rb_solver_body *body = &solver->dense.bodies.body[i];
	const struct rb_solver_body momentum = rb_energy_momentum_of(solver, i, body);
	double *const displacement = lift->displacement + 6 * (size_t)i;
	double *const aside = world->stepped->saved_velocity + 6 * (size_t)i;

	RB_ASSERT_COSTLY(rb_stepped_is_dynamic(world, i));
	if (world->stepped->tally) {
		const rb_vec3 motion[2] = {rb_vec3_from(aside), world->state.spin
		                                                        ? rb_vec3_from(aside + 3)
		                                                        : (rb_vec3){0, 0, 0}};

		rb_tally_projection_begin(world, i, motion);
	}
	if (!lift->moved[i])
		memset(displacement, 0, 6 * sizeof *displacement);
	lift->moved[i] = 1;
	rb_vec3_to(displacement, rb_vec3_add(rb_vec3_from(displacement), body->linear));
	rb_vec3_to(displacement + 3, rb_vec3_add(rb_vec3_from(displacement + 3), momentum.angular));
	double *const swept = lift->swept + 3 * (size_t)i;
	const rb_vec3 p = rb_vec3_scale(world->model->mass[i], rb_vec3_from(aside));
	rb_vec3 more = rb_vec3_cross(body->linear, p);

	if (isnan(body->inverse_inertia)) {
		const struct rb_solver_body spin = {.angular = rb_vec3_from(aside + 3)};
		const rb_vec3 turning = rb_energy_momentum_of(solver, i, &spin).angular;
		const rb_quat turn = rb_quat_from_turn(body->angular);

		more = rb_vec3_add(more, rb_vec3_sub(rb_quat_rotate(turn, turning), turning));
		rb_vec3_to(aside + 3, rb_quat_rotate(turn, spin.angular));
	}
	rb_vec3_to(swept, rb_vec3_add(rb_vec3_from(swept), more));
}

/* ---- angular momentum ---- */

/* Whether the group of this root in `parent` must conserve its momenta. */
static bool is_free(const struct rb_projection_energy *lift, const struct rb_world *world, int root)
{
	return world->stepped->solver.joins_arms && !lift->has_static[root] &&
	       !lift->has_driven[root];
}

/* Sums of joined bodies, by root in `joined`. */
struct turning {
	double mass;
	rb_vec3 moment, momentum, swept; /* kg m, kg m/s; kg m^2/s */
	rb_mat3 inertia;                 /* kg m^2, about the centre of mass */
	rb_vec3 turn;                    /* rad/s: rotation that restores angular momentum */
	bool moved;
	double gain; /* J: energy gained by that rotation */
};

/*
 * Share of the trace of inertia added to all moments, so that two points, which have none about
 * their line, have an inverse. Twelve digits of the correction are right.
 */
static const double least_inertia = 1e-12;

static void add_inertia(const struct rb_world *world, int i, struct turning *group)
{
	const rb_vec3 center = rb_vec3_scale(1 / group->mass, group->moment);
	const rb_vec3 r = rb_vec3_sub(rb_world_row3(world->state.position, i), center);
	const double mass = world->model->mass[i];

	for (int c = 0; c < 3; c++) {
		const rb_vec3 unit = {c == 0, c == 1, c == 2};
		rb_vec3 of = rb_vec3_scale(mass, rb_vec3_cross(r, rb_vec3_cross(unit, r)));

		if (world->state.spin)
			of = rb_vec3_add(of, rb_tally_spin(world, &world->state, i, unit));
		group->inertia.m[0][c] += of.x;
		group->inertia.m[1][c] += of.y;
		group->inertia.m[2][c] += of.z;
	}
}

static void find_group_rotation(struct turning *group)
{
	rb_mat3 inverse, *const inertia = &group->inertia;
	const double regularization = least_inertia *
	                              (inertia->m[0][0] + inertia->m[1][1] + inertia->m[2][2]);

	for (int c = 0; c < 3; c++)
		inertia->m[c][c] += regularization;
	if (regularization > 0 && rb_mat3_inverse(inertia, &inverse))
		group->turn = rb_vec3_neg(rb_mat3_apply(&inverse, group->swept));
}

static void mark_moved(struct rb_projection_energy *lift, struct rb_world *world, int i,
                       const rb_vec3 motion[2])
{
	if (world->stepped->tally)
		rb_tally_projection_begin(world, i, motion);
	if (!lift->moved[i])
		memset(lift->displacement + 6 * (size_t)i, 0, 6 * sizeof *lift->displacement);
	lift->moved[i] = 1;
}

static void add_momentum_change(struct rb_projection_energy *lift, int i, rb_vec3 momentum)
{
	lift->momentum_change[i] = rb_vec3_add(lift->momentum_change[i], momentum);
	lift->has_momentum_change = lift->has_momentum_change || rb_vec3_max_abs(momentum) > 0;
}

/* Rotates a body with its group. */
static void rotate_body(struct rb_projection_energy *lift, struct rb_world *world, int i,
                        struct turning *group)
{
	double *const v = world->state.velocity + 3 * (size_t)i;
	double *const w = world->state.spin ? world->state.spin + 3 * (size_t)i : NULL;
	const rb_vec3 center = rb_vec3_scale(1 / group->mass, group->moment);
	const rb_vec3 r = rb_vec3_sub(rb_world_row3(world->state.position, i), center);
	const rb_vec3 motion[2] = {rb_vec3_from(v), w ? rb_vec3_from(w) : (rb_vec3){0, 0, 0}};

	mark_moved(lift, world, i, motion);
	group->gain -= rb_world_kinetic_energy(world, world->model->id_of[i]);
	rb_vec3_to(v, rb_vec3_add(motion[0], rb_vec3_cross(group->turn, r)));
	add_momentum_change(lift, i,
	                    rb_vec3_scale(world->model->mass[i], rb_vec3_cross(group->turn, r)));
	if (w)
		rb_vec3_to(w, rb_vec3_add(motion[1], group->turn));
	group->gain += rb_world_kinetic_energy(world, world->model->id_of[i]);
}

static void add_groups(struct rb_projection_energy *lift, const struct rb_world *world,
                       struct turning *all)
{
	const struct rb_stepped *s = world->stepped;

	for (int k = 0; k < s->member_count; k++)
		all[s->body[k]] = (struct turning){.mass = 0};
	for (int k = 0; k < s->member_count; k++) {
		const int i = s->body[k];
		struct turning *group = &all[rb_forest_root(lift->joined, i)];
		const double mass = world->model->mass[i];
		double *const swept = lift->swept + 3 * (size_t)i;

		group->mass += mass;
		group->moment = rb_vec3_add_scaled(group->moment, mass,
		                                   rb_world_row3(world->state.position, i));
		group->moved = group->moved || lift->moved[i];
		group->swept = rb_vec3_add(group->swept, rb_vec3_from(swept));
		rb_vec3_to(swept, (rb_vec3){0, 0, 0});
	}
	for (int k = 0; k < s->member_count; k++) {
		const int i = s->body[k], first = rb_forest_root(lift->joined, i);

		if (all[first].moved && is_free(lift, world, rb_forest_root(lift->parent, i)))
			add_inertia(world, i, &all[first]);
	}
}

/*
 * Restores the angular momentum of free groups that projection has changed, by rotation as a whole,
 * which closes no gap and causes no slip. The energy that this adds must be paid. False: no memory.
 */
static bool restore_angular_momentum(struct rb_projection_energy *lift, struct rb_world *world)
{
	struct rb_stepped *s = world->stepped;
	const size_t n = (size_t)world->model->body_count;
	struct turning *const all = rb_arena_take(&world->arena[0], n, sizeof *all);

	if (!all)
		return false;
	add_groups(lift, world, all);
	for (int k = 0; k < s->member_count; k++)
		if (rb_vec3_max_abs(all[s->body[k]].swept) > 0)
			find_group_rotation(&all[s->body[k]]);
	for (int k = 0; k < s->member_count; k++) {
		struct turning *group = &all[rb_forest_root(lift->joined, s->body[k])];

		if (rb_vec3_max_abs(group->turn) > 0)
			rotate_body(lift, world, s->body[k], group);
	}
	for (int k = 0; k < s->member_count; k++) {
		const int i = s->body[k];

		lift->sum[SUMS * (size_t)rb_forest_root(lift->parent, i) + RISE] += fmax(
			0, all[i].gain);
		if (s->tally)
			s->tally->body[i].turned += fmax(0, -all[i].gain);
	}
	return true;
}

/* Spin in rad/s for an angular momentum about the centre of mass. */
static rb_vec3 spin_of(const struct rb_world *world, int i, const double *momentum)
{
	return world->state.spin ? rb_world_turn(world, &world->state, i, rb_vec3_from(momentum))
	                         : (rb_vec3){0, 0, 0};
}

/* Adds <w, L> and <L, I^-1 L> for the angular momentum L. */
static void add_turn(const struct rb_world *world, int i, const double *momentum, double *mixed,
                     double *square)
{
	const rb_vec3 turn = rb_vec3_from(momentum);

	if (!world->state.spin)
		return;
	*mixed += rb_vec3_dot(rb_world_row3(world->state.spin, i), turn);
	*square += rb_vec3_dot(turn, spin_of(world, i, momentum));
}

/* Potential energy that a body gains by a displacement, J. */
static double rise_of(const struct rb_world *world, int i, rb_vec3 displacement)
{
	const struct rb_world_def *of = &world->model->scene->world;
	const double mass = world->model->mass[i];
	const double rise = -mass * rb_vec3_dot(of->gravity, displacement) -
	                    rb_vec3_dot(of->gravity_force, displacement);

	if (!(world->model->features & RB_FEATURE_GRAVITATION))
		return rise;
	return rise - mass * rb_vec3_dot(rb_gravitation_found(world->gravitation, i), displacement);
}

/* Terms of one body in the sums of its group: by displacement, then by rotation. */
struct addend {
	double displacement[SUMS], turn[SUMS];
};

/* Number of bodies whose terms are stored at a time: enough for threads, little memory. */
enum { ADDENDS_MAX = 8192 };

struct addends {
	const struct rb_projection_energy *lift;
	const struct rb_world *world;
	const int *body;
	struct addend *of; /* by body */
};

static struct addend addend_of(const struct rb_projection_energy *lift,
                               const struct rb_world *world, int i)
{
	const rb_vec3 displacement = rb_vec3_from(lift->displacement + 6 * (size_t)i);
	const double mass = world->model->mass[i];
	struct addend more = {.displacement = {0}};

	more.displacement[KINETIC] = rb_world_kinetic_energy(world, world->model->id_of[i]);
	if (!lift->moved[i])
		return more;
	more.displacement[RISE] = rise_of(world, i, displacement);
	more.displacement[MIXED] = mass * rb_vec3_dot(rb_world_row3(world->state.velocity, i),
	                                              displacement);
	more.displacement[SQUARE] = mass * rb_vec3_dot(displacement, displacement);
	add_turn(world, i, lift->displacement + 6 * (size_t)i + 3, &more.turn[MIXED],
	         &more.turn[SQUARE]);
	add_turn(world, i, lift->turn + 3 * (size_t)i, &more.turn[TURN_MIXED],
	         &more.turn[TURN_SQUARE]);
	return more;
}

static void find_addends(void *user, size_t first, size_t end)
{
	const struct addends *addends = user;

	for (size_t k = first; k < end; k++)
		addends->of[k] = addend_of(addends->lift, addends->world, addends->body[k]);
}

static void add_to(double *sum, const struct addend *more)
{
	for (int j = 0; j < SUMS; j++) {
		sum[j] += more->displacement[j];
		sum[j] += more->turn[j];
	}
}

/* Adds up the sums of groups, in order of their bodies; false: no memory. */
static bool sum_groups(struct rb_projection_energy *lift, const struct rb_world *world,
                       struct rb_arena *arena)
{
	const struct rb_stepped *s = world->stepped;
	const size_t all = (size_t)s->member_count;
	const rb_arena_mark here = rb_arena_here(arena);
	struct addends addends = {.lift = lift, .world = world};

	addends.of = rb_arena_take(arena, all < ADDENDS_MAX ? all : ADDENDS_MAX,
	                           sizeof *addends.of);
	if (!addends.of)
		return false;
	for (size_t first = 0; first < all; first += ADDENDS_MAX) {
		const size_t left = all - first, count = left < ADDENDS_MAX ? left : ADDENDS_MAX;

		addends.body = s->body + first;
		rb_team_share(world->team, count, BODIES_PER_BLOCK, find_addends, &addends);
		for (size_t k = 0; k < count; k++)
			add_to(lift->sum +
			               SUMS * (size_t)rb_forest_root(lift->parent, addends.body[k]),
			       &addends.of[k]);
	}
	rb_arena_back(arena, here);
	return true;
}

/*
 * Change of a group's velocities: v (1 - slowed) - pace * displacement of the projection - twist *
 * its torque. NAN: the group does not have the energy.
 */
struct payment {
	double twist, pace, slowed;
};

static const struct payment nothing = {0, 0, 0}, impossible = {(double)NAN, 0, 0};

/*
 * The smaller root s of s mixed - s^2 square / 2 = need, without cancellation. NAN: the parabola
 * does not reach `need`.
 */
static double share_of(double need, double mixed, double square)
{
	const double left = mixed * mixed - 2 * need * square;

	return left >= 0 ? 2 * need / (mixed + copysign(sqrt(left), mixed)) : (double)NAN;
}

/* Means of payment of a group. */
struct means {
	bool held; /* a static body holds it */
	bool free; /* no static or driven body: motion along the displacements conserves momenta */
	bool may_change_momentum; /* linear momentum may change */
};

/* The first means that suffices to pay `need` J. */
static struct payment payment_of(const double *sum, double need, struct means means)
{
	if (!(need > 0))
		return nothing;
	const double twist = share_of(need, sum[TURN_MIXED], sum[TURN_SQUARE]);
	const double pace = means.may_change_momentum || means.free
	                            ? share_of(need, sum[MIXED], sum[SQUARE])
	                            : (double)NAN;
	if (isfinite(twist) && !(means.free && isfinite(pace)))
		return (struct payment){.twist = twist};
	if (isfinite(pace))
		return (struct payment){.pace = pace};
	if (means.may_change_momentum && means.held && sum[KINETIC] >= need)
		return (struct payment){.slowed = need / sum[KINETIC] /
		                                  (1 + sqrt(1 - need / sum[KINETIC]))};
	return impossible;
}

/* Changes the velocities of one body by its group's payment. */
static void pay(struct rb_projection_energy *lift, struct rb_world *world, int i,
                struct payment payment)
{
	double *const v = world->state.velocity + 3 * (size_t)i;
	double *const w = world->state.spin ? world->state.spin + 3 * (size_t)i : NULL;
	const double *displacement = lift->displacement + 6 * (size_t)i;
	const double kept = 1 - payment.slowed;
	rb_vec3 linear = rb_vec3_from(v), spin = w ? rb_vec3_from(w) : (rb_vec3){0, 0, 0};
	const rb_vec3 before[2] = {linear, spin};

	if (world->stepped->tally)
		rb_tally_projection_begin(world, i, (const rb_vec3[2]){linear, spin});
	if (lift->moved[i]) {
		linear = rb_vec3_add_scaled(linear, -payment.pace, rb_vec3_from(displacement));
		spin = rb_vec3_add_scaled(spin, -payment.pace, spin_of(world, i, displacement + 3));
		spin = rb_vec3_add_scaled(spin, -payment.twist,
		                          spin_of(world, i, lift->turn + 3 * (size_t)i));
	}
	rb_vec3_to(v, rb_vec3_scale(kept, linear));
	if (w)
		rb_vec3_to(w, rb_vec3_scale(kept, spin));
	const rb_vec3 more = rb_vec3_sub(rb_vec3_from(v), before[0]);
	const rb_vec3 p = rb_vec3_scale(world->model->mass[i], more);
	const rb_vec3 twist = w ? rb_vec3_sub(rb_vec3_from(w), before[1]) : more;

	add_momentum_change(lift, i, p);

	rb_vec3_to(lift->swept + 3 * (size_t)i,
	           rb_vec3_add(rb_vec3_cross(rb_world_row3(world->state.position, i), p),
	                       rb_tally_spin(world, &world->state, i, twist)));
}

/*
 * Ledger entry of the projection: by a driven body, a static one, or other dynamic bodies of the
 * group.
 */
static void record_closed(const struct rb_projection_energy *lift, struct rb_world *world, int i)
{
	const int root = rb_forest_root(lift->parent, i);
	const rb_vec3 displacement = rb_vec3_from(lift->displacement + 6 * (size_t)i);
	const double lifted = lift->moved[i] ? rise_of(world, i, displacement) : 0;

	rb_tally_projection_end(world, i,
	                        lift->has_driven[root]   ? RB_MOMENTUM_DRIVEN
	                        : lift->has_static[root] ? RB_MOMENTUM_STATIC
	                                                 : RB_MOMENTUM_CAUSES,
	                        lifted);
}

enum rb_status rb_projection_energy_pay(struct rb_projection_energy *lift, struct rb_world *world,
                                        bool may_change_momentum, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	const size_t n = (size_t)world->model->body_count;

	for (int k = 0; k < s->member_count; k++)
		memset(lift->sum + SUMS * (size_t)s->body[k], 0, SUMS * sizeof *lift->sum);
	if (s->solver.joins_arms && !restore_angular_momentum(lift, world))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the overlaps of a step");
	unsigned char *const paid = rb_arena_take(&world->arena[0], n, 1);
	bool any = false;

	if (!paid)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the overlaps of a step");
	if (!sum_groups(lift, world, &world->arena[0]))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the overlaps of a step");
	for (int k = 0; k < s->member_count; k++) {
		const int i = s->body[k];
		const int root = rb_forest_root(lift->parent, i);
		const double *sum = lift->sum + SUMS * (size_t)root;
		const double need = lift->has_driven[root]
		                            ? 0
		                            : sum[RISE] - 0.5 * lift->energy_budget[root];
		const struct means means = {.held = lift->has_static[root],
		                            .free = is_free(lift, world, root),
		                            .may_change_momentum = may_change_momentum};
		struct payment payment = payment_of(sum, need, means);

		if (isnan(payment.twist) && need <= lift->sunk[root])
			payment = nothing;

		if (isnan(payment.twist))
			rb_stepped_blame(s, i);
		else if (need > 0)
			pay(lift, world, i, payment);
		paid[i] = need > 0 && !isnan(payment.twist);
		any = any || paid[i];
	}
	if (s->solver.joins_arms && any && !restore_angular_momentum(lift, world))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the overlaps of a step");
	for (int k = 0; s->tally && k < s->member_count; k++)
		if (lift->moved[s->body[k]] || paid[s->body[k]])
			record_closed(lift, world, s->body[k]);
	return RB_OK;
}
