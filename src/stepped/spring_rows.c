/* SPDX-License-Identifier: MIT */
#include "stepped/spring_rows.h"

#include "base/error.h"
#include "constraint/effective_mass.h"

/* A body that is not dynamic is the second of a row. */
static bool is_turned_round(const struct rb_spring_query *query,
                            const struct rb_step_spring *spring)
{
	return rb_step_spring_owner(spring, query->bodies, query->fixed) != spring->end[0];
}

static struct rb_constraint row_of(const struct rb_spring_query *query,
                                   const struct rb_step_spring *spring, rb_vec3 normal)
{
	const bool round = is_turned_round(query, spring);
	const int a = round, b = !round;

	return (struct rb_constraint){
		.set = RB_CONSTRAINT_INTERVAL,
		.a = spring->end[a],
		.b = spring->end[b] < query->fixed ? spring->end[b] : query->fixed,
		.normal = round ? rb_vec3_neg(normal) : normal,
		.arm_a = spring->arm[a],
		.arm_b = spring->arm[b],
		.low = -(double)INFINITY,
		.high = (double)INFINITY,
	};
}

void rb_step_spring_fill(const struct rb_spring_query *query, const struct rb_step_spring *spring,
                         struct rb_constraint *row)
{
	const double lasts = query->lasts_s, ahead = query->ahead_s;
	const rb_vec3 n = spring->along, t = rb_vec3_across(n);
	const rb_vec3 normal[3] = {n, t, rb_vec3_cross(n, t)};

	RB_ASSERT_COSTLY(lasts > 0 && ahead > 0);
	for (int r = 0; r < rb_step_spring_row_count(spring); r++) {
		const double gone = rb_vec3_dot(rb_vec3_add(query->shift, spring->bend), normal[r]);

		row[r] = row_of(query, spring, normal[r]);
		row[r].softness = 1 / (lasts * (r == 0 ? ahead * spring->stiffness + spring->damping
		                                       : ahead * spring->across));
		row[r].target.n = -gone / ahead;
		if (r == 0)
			row[r].target.n -= row[r].softness * lasts * spring->stiffness *
			                   spring->stretch;
		row[r].impulse.n = rb_vec3_dot(spring->impulse, normal[r]);
		rb_effective_mass_fill(query->bodies, &row[r]);
	}
}

void rb_step_spring_add(struct rb_step_spring *spring, rb_vec3 impulse)
{
	for (int e = 0; e < 2; e++) {
		const rb_vec3 p = e == 0 ? rb_vec3_neg(impulse) : impulse;
		const rb_vec3 lever = rb_vec3_add(spring->way[e], spring->arm[e]);

		spring->on[e].force = rb_vec3_add(spring->on[e].force, p);
		spring->on[e].torque = rb_vec3_add(spring->on[e].torque, rb_vec3_cross(lever, p));
	}
}

void rb_step_spring_store(const struct rb_spring_query *query, struct rb_step_spring *spring,
                          const struct rb_constraint *row)
{
	const double sign = is_turned_round(query, spring) ? -1 : 1;

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
	const rb_vec3 gone = rb_vec3_add_scaled(d, -length, n);
	/* a spring without a length pulls in proportion, whichever way its ends have parted */
	const double longer = spring->rest > 0 ? rb_vec3_length(d) - length : rb_vec3_dot(gone, n);

	if (!(spring->across > 0))
		return rb_vec3_scale(longer, n);
	return rb_vec3_add_scaled(rb_vec3_reject(gone, n), longer, n);
}

void rb_step_spring_turn(struct rb_step_spring *spring, const struct rb_pose pose[2],
                         const rb_vec3 way[2])
{
	const rb_vec3 d = between(spring, pose);

	spring->stretch = rb_vec3_length(d) - spring->rest;
	spring->along = rb_vec3_unit(d, spring->along);
	spring->bend = (rb_vec3){0, 0, 0};
	for (int e = 0; e < 2; e++) {
		spring->arm[e] = rb_quat_rotate(pose[e].orientation, spring->local[e]);
		spring->way[e] = way[e];
	}
}
