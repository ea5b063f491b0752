/* SPDX-License-Identifier: MIT */
#include "stepped/lift.h"

#include <string.h>

#include "base/forest.h"
#include "base/memory.h"
#include "stepped/energy.h"
#include "stepped/tally.h"

/* Of the sums of a group. */
enum { RISE, MIXED, SQUARE, KINETIC, SUMS };

enum rb_status rb_lift_begin(struct rb_lift *lift, struct rb_world *world, struct rb_error *err)
{
	const struct rb_solver *solver = &world->stepped->solver;
	struct rb_arena *arena = &world->arena[0];
	const size_t n = (size_t)world->model->body_count;

	*lift = (struct rb_lift){.parent = rb_arena_take(arena, n, sizeof *lift->parent),
	                         .room = rb_arena_take(arena, n, sizeof *lift->room),
	                         .way = rb_arena_take(arena, 6 * n, sizeof *lift->way),
	                         .moved = rb_arena_take(arena, n, 1),
	                         .given = rb_arena_take(arena, n, 1),
	                         .held = rb_arena_take(arena, n, 1),
	                         .sum = rb_arena_take(arena, SUMS * n, sizeof *lift->sum)};
	if (!lift->parent || !lift->room || !lift->way || !lift->moved || !lift->given ||
	    !lift->held || !lift->sum)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the overlaps of a step");
	memset(lift->moved, 0, n);
	memset(lift->given, 0, n);
	memset(lift->held, 0, n);
	for (size_t i = 0; i < n; i++) {
		lift->parent[i] = (int)i;
		lift->room[i] = 0;
	}
	for (size_t g = 0; g < solver->island_count; g++) {
		const struct rb_island *island = &solver->island[g];
		const int *member = solver->member + island->first_member;

		lift->room[member[0]] = island->rests ? 0 : island->room;
		for (int k = 1; k < island->member_count; k++)
			lift->parent[member[k]] = member[0];
	}
	return RB_OK;
}

void rb_lift_join(struct rb_lift *lift, const struct rb_world *world, int a, int b)
{
	const int root = rb_forest_root(lift->parent, a);

	if (!rb_stepped_yields(world, b)) {
		const bool is_static = b >= world->model->body_count;

		lift->given[root] = lift->given[root] || !is_static;
		lift->held[root] = lift->held[root] || is_static;
		return;
	}
	const int other = rb_forest_root(lift->parent, b);
	if (root == other)
		return;
	const int first = root < other ? root : other, second = root < other ? other : root;
	lift->parent[second] = first;
	lift->room[first] += lift->room[second];
	lift->given[first] = lift->given[first] || lift->given[second];
	lift->held[first] = lift->held[first] || lift->held[second];
}

void rb_lift_add(struct rb_lift *lift, struct rb_world *world, int i)
{
	const struct rb_solver *solver = &world->stepped->solver;
	const struct rb_dense_body *body = &solver->dense.body[i];
	const struct rb_dense_body momentum = rb_energy_weigh(solver, i, body);
	double *const way = lift->way + 6 * (size_t)i;
	double *const aside = world->stepped->aside + 6 * (size_t)i;

	if (world->stepped->tally) {
		const rb_vec3 motion[2] = {rb_vec3_from(aside), world->state.spin
		                                                        ? rb_vec3_from(aside + 3)
		                                                        : (rb_vec3){0, 0, 0}};

		rb_tally_close(world, i, motion);
	}
	if (!lift->moved[i])
		memset(way, 0, 6 * sizeof *way);
	lift->moved[i] = 1;
	rb_vec3_to(way, rb_vec3_add(rb_vec3_from(way), body->linear));
	rb_vec3_to(way + 3, rb_vec3_add(rb_vec3_from(way + 3), momentum.angular));
	if (!isnan(body->inverse_inertia))
		return;
	rb_vec3_to(aside + 3,
	           rb_quat_rotate(rb_quat_from_turn(body->angular), rb_vec3_from(aside + 3)));
}

/* rad/s per unit of the payment. */
static rb_vec3 turn_of(const struct rb_lift *lift, const struct rb_world *world, int i)
{
	return world->state.spin ? rb_world_turn(world, &world->state, i,
	                                         rb_vec3_from(lift->way + 6 * (size_t)i + 3))
	                         : (rb_vec3){0, 0, 0};
}

static void add_up(struct rb_lift *lift, const struct rb_world *world, int i)
{
	const struct rb_world_def *of = &world->model->scene->world;
	const rb_vec3 way = rb_vec3_from(lift->way + 6 * (size_t)i);
	const rb_vec3 turn = rb_vec3_from(lift->way + 6 * (size_t)i + 3);
	const double mass = world->model->mass[i];
	double *const sum = lift->sum + SUMS * (size_t)rb_forest_root(lift->parent, i);

	sum[KINETIC] += rb_world_kinetic_energy(world, world->model->id_of[i]);
	if (!lift->moved[i])
		return;
	sum[RISE] -= mass * rb_vec3_dot(of->gravity, way) + rb_vec3_dot(of->gravity_force, way);
	sum[MIXED] += mass * rb_vec3_dot(rb_world_row3(world->state.velocity, i), way);
	sum[SQUARE] += mass * rb_vec3_dot(way, way);
	if (!world->state.spin)
		return;
	sum[MIXED] += rb_vec3_dot(rb_world_row3(world->state.spin, i), turn);
	sum[SQUARE] += rb_vec3_dot(turn, turn_of(lift, world, i));
}

/* How velocities change: v (1 - slowed) - pace way. NAN: there is not as much. */
struct payment {
	double pace, slowed;
};

/*
 * Kinetic energy falls by `need`: that along the ways first, which is how contacts would push or hold back; else, with what
 * stands still below, that of all motion, which is how a body slows down that slides or rolls over a bump.
 */
static struct payment payment_of(const double *sum, double need, bool held)
{
	const double left = sum[MIXED] * sum[MIXED] - 2 * need * sum[SQUARE];

	if (!(need > 0))
		return (struct payment){0, 0};
	if (left >= 0)
		return (struct payment){2 * need / (sum[MIXED] + copysign(sqrt(left), sum[MIXED])),
		                        0};
	if (held && sum[KINETIC] >= need)
		return (struct payment){0,
		                        need / sum[KINETIC] / (1 + sqrt(1 - need / sum[KINETIC]))};
	return (struct payment){(double)NAN, 0};
}

static void pay(struct rb_lift *lift, struct rb_world *world, int i, struct payment payment)
{
	double *const v = world->state.velocity + 3 * (size_t)i;
	double *const w = world->state.spin ? world->state.spin + 3 * (size_t)i : NULL;
	const double kept = 1 - payment.slowed;

	if (world->stepped->tally) {
		const rb_vec3 motion[2] = {rb_vec3_from(v),
		                           w ? rb_vec3_from(w) : (rb_vec3){0, 0, 0}};

		rb_tally_close(world, i, motion);
	}
	if (lift->moved[i]) {
		rb_vec3_to(v, rb_vec3_add_scaled(rb_vec3_from(v), -payment.pace,
		                                 rb_vec3_from(lift->way + 6 * (size_t)i)));
		if (w)
			rb_vec3_to(w, rb_vec3_add_scaled(rb_vec3_from(w), -payment.pace,
			                                 turn_of(lift, world, i)));
	}
	rb_vec3_to(v, rb_vec3_scale(kept, rb_vec3_from(v)));
	if (w)
		rb_vec3_to(w, rb_vec3_scale(kept, rb_vec3_from(w)));
}

/* Whom the ledger names for what closing has done to a body: the fixed one that its group has been closed against. */
static void tell_closed(const struct rb_lift *lift, struct rb_world *world, int i)
{
	const struct rb_world_def *of = &world->model->scene->world;
	const int root = rb_forest_root(lift->parent, i);
	const rb_vec3 way = rb_vec3_from(lift->way + 6 * (size_t)i);
	const double lifted = lift->moved[i]
	                              ? -world->model->mass[i] * rb_vec3_dot(of->gravity, way) -
	                                        rb_vec3_dot(of->gravity_force, way)
	                              : 0;

	rb_tally_closed(world, i,
	                lift->given[root]  ? RB_MOMENTUM_DRIVEN
	                : lift->held[root] ? RB_MOMENTUM_STATIC
	                                   : RB_MOMENTUM_CAUSES,
	                lifted);
}

void rb_lift_pay(struct rb_lift *lift, struct rb_world *world)
{
	struct rb_stepped *s = world->stepped;

	for (int k = 0; k < s->member_count; k++)
		memset(lift->sum + SUMS * (size_t)s->body[k], 0, SUMS * sizeof *lift->sum);
	for (int k = 0; k < s->member_count; k++)
		add_up(lift, world, s->body[k]);
	for (int k = 0; k < s->member_count; k++) {
		const int i = s->body[k];
		const int root = rb_forest_root(lift->parent, i);
		const double *sum = lift->sum + SUMS * (size_t)root;
		const double need = lift->given[root] ? 0 : sum[RISE] - 0.5 * lift->room[root];
		const struct payment payment = payment_of(sum, need, lift->held[root]);

		if (isnan(payment.pace))
			rb_stepped_blame(s, i);
		else if (need > 0)
			pay(lift, world, i, payment);
		if (s->tally && (lift->moved[i] || (need > 0 && !isnan(payment.pace))))
			tell_closed(lift, world, i);
	}
}
