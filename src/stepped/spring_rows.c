/* SPDX-License-Identifier: MIT */
#include "stepped/spring_rows.h"

#include "base/error.h"
#include "constraint/effective_mass.h"

/* A row is redundant if elimination leaves this fraction of its diagonal: rounding and drift. */
static const double redundant_share = 1e-10;

/* A body that is not dynamic is the second of a row. */
static bool is_swapped(const struct rb_spring_query *query, const struct rb_step_spring *spring)
{
	return rb_step_spring_owner(spring, query->bodies, query->fixed) != spring->end[0];
}

static struct rb_constraint row_of(const struct rb_spring_query *query,
                                   const struct rb_step_spring *spring, rb_vec3 normal)
{
	const bool swapped = is_swapped(query, spring);
	const int a = swapped, b = !swapped;

	return (struct rb_constraint){
		.set = RB_CONSTRAINT_INTERVAL,
		.a = spring->end[a],
		.b = spring->end[b] < query->fixed ? spring->end[b] : query->fixed,
		.normal = swapped ? rb_vec3_neg(normal) : normal,
		.arm_a = spring->arm[a],
		.arm_b = spring->arm[b],
		.low = -(double)INFINITY,
		.high = (double)INFINITY,
	};
}

/* Fixes the impulse of a row. */
static void fix(struct rb_constraint *row, double impulse)
{
	row->low = row->high = row->impulse.n = impulse;
}

void rb_step_spring_fill(const struct rb_spring_query *query, const struct rb_step_spring *spring,
                         struct rb_constraint *row)
{
	const double lasts = query->lasts_s, ahead = query->ahead_s;
	const rb_vec3 n = spring->along, t = rb_vec3_across(n);
	const rb_vec3 normal[3] = {n, t, rb_vec3_cross(n, t)};
	const bool fixed = query->repeats || spring->time == RB_SPRING_AT_BEGIN;
	const double act = spring->time == RB_SPRING_AT_MEAN ? 0.5 * ahead : ahead;

	RB_ASSERT_COSTLY(lasts > 0 && ahead > 0);
	for (int r = 0; r < rb_step_spring_row_count(spring); r++) {
		const double displacement = rb_vec3_dot(rb_vec3_add(query->shift, spring->bend),
		                                        normal[r]);

		row[r] = row_of(query, spring, normal[r]);
		row[r].impulse.n = rb_vec3_dot(spring->impulse, normal[r]);
		rb_effective_mass_fill(query->bodies, &row[r]);
		/*
		 * a spring resolved along its direction has tension across it only if its rest
		 * length is 0
		 */
		if (fixed || (r > 0 && spring->time == RB_SPRING_AT_MEAN && spring->rest > 0)) {
			fix(&row[r], fixed ? row[r].impulse.n : 0);
			continue;
		}
		row[r].softness = 1 / (lasts * (r == 0 ? act * spring->stiffness + spring->damping
		                                       : act * spring->across));
		row[r].target.n = -displacement / ahead;
		if (r == 0)
			row[r].target.n -= row[r].softness * lasts * spring->stiffness *
			                   spring->stretch;
	}
}

/* ---- effective mass ---- */

/* Most rows taken into account: still a bound if some are left out. */
enum { HELD_MAX = 24 };

/* Unit impulse of a row: force and torque on its two bodies, and change of spin. */
struct unit {
	int body[2];
	rb_vec3 force[2], torque[2], turn[2];
};

static struct unit unit_of(const struct rb_spring_query *query, const struct rb_constraint *row,
                           rb_vec3 along)
{
	struct unit unit = {.body = {row->a, row->b}};

	for (int e = 0; e < 2; e++) {
		const rb_vec3 on = e == 0 ? rb_vec3_neg(along) : along;
		const rb_vec3 arm = e == 0 ? rb_constraint_arm_a(row) : rb_constraint_arm_b(row);
		const struct rb_solver_body *body = &query->bodies->body[unit.body[e]];

		unit.force[e] = row->couple ? (rb_vec3){0, 0, 0} : on;
		unit.torque[e] = row->couple ? rb_vec3_scale(row->arm_a.x, on)
		                             : rb_vec3_cross(arm, on);
		if (body->inverse_inertia != 0)
			unit.turn[e] = rb_solver_turn(query->bodies, unit.body[e], unit.torque[e]);
	}
	return unit;
}

/* 1/kg: velocity along one per unit impulse of the other. */
static double response(const struct rb_spring_query *query, const struct unit *x,
                       const struct unit *y)
{
	double sum = 0;

	for (int e = 0; e < 2; e++)
		for (int f = 0; f < 2; f++)
			if (x->body[e] == y->body[f])
				sum += query->bodies->body[x->body[e]].inverse_mass *
				               rb_vec3_dot(x->force[e], y->force[f]) +
				       rb_vec3_dot(x->turn[e], y->torque[f]);
	return sum;
}

double rb_step_spring_inverse_mass(const struct rb_spring_query *query,
                                   const struct rb_step_spring *spring,
                                   const struct rb_constraint *const *held, int held_count)
{
	static const rb_vec3 axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	const struct rb_constraint own_row = row_of(query, spring, spring->along);
	struct unit unit[HELD_MAX + 1];
	double g[HELD_MAX + 1][HELD_MAX + 1], own[HELD_MAX + 1];
	int count = 0;

	for (int k = 0; k < held_count; k++) {
		const int size = held[k]->set == RB_CONSTRAINT_FREE ? 3 : 1;

		for (int c = 0; c < size && count < HELD_MAX; c++)
			unit[count++] = unit_of(query, held[k],
			                        size == 3 ? axis[c] : held[k]->normal);
	}
	unit[count] = unit_of(query, &own_row, own_row.normal);
	for (int i = 0; i <= count; i++) {
		for (int j = 0; j <= i; j++)
			g[i][j] = response(query, &unit[i], &unit[j]);
		own[i] = g[i][i];
	}
	for (int k = 0; k < count; k++)
		for (int i = k + 1; i <= count && g[k][k] > redundant_share * own[k]; i++)
			for (int j = k + 1; j <= i; j++)
				g[i][j] -= g[i][k] * g[j][k] / g[k][k];
	return fmax(0, g[count][count]);
}

void rb_step_spring_add(struct rb_step_spring *spring, rb_vec3 impulse)
{
	for (int e = 0; e < 2; e++) {
		const rb_vec3 p = e == 0 ? rb_vec3_neg(impulse) : impulse;
		const rb_vec3 lever = rb_vec3_add(spring->displacement[e], spring->arm[e]);

		spring->on[e].force = rb_vec3_add(spring->on[e].force, p);
		spring->on[e].torque = rb_vec3_add(spring->on[e].torque, rb_vec3_cross(lever, p));
	}
}

void rb_step_spring_store(const struct rb_spring_query *query, struct rb_step_spring *spring,
                          const struct rb_constraint *row)
{
	const double sign = is_swapped(query, spring) ? -1 : 1;

	spring->impulse = (rb_vec3){0, 0, 0};
	for (int r = 0; r < rb_step_spring_row_count(spring); r++)
		spring->impulse = rb_vec3_add_scaled(spring->impulse, sign,
		                                     rb_constraint_impulse(&row[r]));
	rb_step_spring_add(spring, spring->impulse);
}

/* m: from the first end to the second. */
static rb_vec3 between(const struct rb_step_spring *spring, const struct rb_pose pose[2])
{
	const rb_vec3 a = rb_quat_rotate(pose[0].orientation, spring->local[0]);
	const rb_vec3 b = rb_quat_rotate(pose[1].orientation, spring->local[1]);

	return rb_vec3_add(rb_pose_between(&pose[0], &pose[1]), rb_vec3_sub(b, a));
}

rb_vec3 rb_step_spring_straight(const struct rb_step_spring *spring, rb_vec3 u, double h)
{
	const rb_vec3 n = spring->along;

	return rb_vec3_scale(h, spring->across > 0 ? u : rb_vec3_scale(rb_vec3_dot(u, n), n));
}

rb_vec3 rb_step_spring_way(const struct rb_step_spring *spring, const struct rb_pose pose[2])
{
	const rb_vec3 d = between(spring, pose), n = spring->along;
	const double length = spring->rest + spring->stretch;
	const rb_vec3 displacement = rb_vec3_add_scaled(d, -length, n);
	/*
	 * a spring of rest length 0 has a force proportional to the displacement in any direction
	 */
	const double longer = spring->rest > 0 ? rb_vec3_length(d) - length
	                                       : rb_vec3_dot(displacement, n);

	if (!(spring->across > 0))
		return rb_vec3_scale(longer, n);
	return rb_vec3_add_scaled(rb_vec3_reject(displacement, n), longer, n);
}

void rb_step_spring_turn(struct rb_step_spring *spring, const struct rb_pose pose[2],
                         const rb_vec3 displacement[2])
{
	const rb_vec3 d = between(spring, pose);

	spring->stretch = rb_vec3_length(d) - spring->rest;
	spring->along = rb_vec3_unit(d, spring->along);
	spring->bend = (rb_vec3){0, 0, 0};
	for (int e = 0; e < 2; e++) {
		spring->arm[e] = rb_quat_rotate(pose[e].orientation, spring->local[e]);
		spring->displacement[e] = displacement[e];
	}
}
