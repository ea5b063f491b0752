/* SPDX-License-Identifier: MIT */
#include "located/joint_problem.h"

#include "base/error.h"

/* Number of our rows in one of the problem's: three along the world's axes are one FREE row. */
static int rows_of(const struct rb_joint_rows *rows, int k)
{
	const struct rb_joint_row *row = &rows->row[k];
	const struct rb_linkage *link = &rows->l->model->joints->joint[row->joint].link;

	return rb_linkage_has_point(link) && row->drive < 0 && row->row == 0 ? 3 : 1;
}

/* The part of u that is not due to dynamic bodies. */
static double bias_of(const struct rb_joint_rows *rows, const struct rb_joint_row *row, bool forces)
{
	const struct rb_joint *joint = &rows->l->model->joints->joint[row->joint];
	const int fixed = row->a < 0 ? joint->a : row->b < 0 ? joint->b : -1;
	double sum = row->velocity;

	if (forces)
		return row->bias;
	if (!(row->impulse_max > 0) && (fixed < 0 || fixed >= rows->l->n))
		return 0;
	if (row->a >= 0)
		sum -= rb_vec3_dot(row->wrench.angular_a, rows->pose[row->a].spin) -
		       rb_vec3_dot(row->wrench.linear, rows->pose[row->a].velocity);
	if (row->b >= 0)
		sum -= rb_vec3_dot(row->wrench.linear, rows->pose[row->b].velocity) +
		       rb_vec3_dot(row->wrench.angular_b, rows->pose[row->b].spin);
	return sum;
}

/* Is the row left out? A bounded force gives no impulse, unless that is significant. */
static bool is_left_out(const struct rb_joint_row *row, bool forces)
{
	return !forces && row->drive >= 0 && !rb_joint_rows_is_stop(row) && !(row->impulse_max > 0);
}

static int place_or_copy(int place, struct rb_solver_body *body, int *bodies)
{
	if (place >= 0)
		return place;
	body[*bodies] = (struct rb_solver_body){.inverse_mass = 0};
	return (*bodies)++;
}

/*
 * An arm at which the force l has the moment m, perpendicular to l: the component along l is
 * arbitrary.
 */
static rb_vec3 arm_of(rb_vec3 linear, rb_vec3 moment)
{
	return rb_vec3_cross(linear, moment);
}

/* The arm, from the moments of forces along x, y, z: m_x = (0, z, -y), m_y = (-z, 0, x). */
static rb_vec3 point_arm(const struct rb_joint_row *row, bool is_b)
{
	const rb_vec3 x = is_b ? row[0].wrench.angular_b : rb_vec3_neg(row[0].wrench.angular_a);
	const rb_vec3 y = is_b ? row[1].wrench.angular_b : rb_vec3_neg(row[1].wrench.angular_a);

	return (rb_vec3){y.z, -x.z, x.y};
}

int rb_joint_rows_pose_problem(const struct rb_joint_rows *rows, bool forces,
                               struct rb_cone_row *to, struct rb_solver_body *body, int *bodies)
{
	int count = 0;

	for (int k = 0, used; k < rows->count; k += used) {
		const struct rb_joint_row *row = &rows->row[k];
		const struct rb_coupled_wrench *w = &row->wrench;

		used = rows_of(rows, k);
		if (is_left_out(row, forces))
			continue;
		struct rb_cone_row *const out = &to[count++];
		struct rb_constraint *const base = &out->base;

		*out = (struct rb_cone_row){.bias = {0, 0, 0}};
		base->a = place_or_copy(row->a, body, bodies);
		base->b = place_or_copy(row->b, body, bodies);
		base->set = RB_CONSTRAINT_INTERVAL;
		base->low = -(double)INFINITY;
		base->high = (double)INFINITY;
		if (row->drive >= 0) {
			base->high = forces || !(row->impulse_max > 0)
			                     ? rb_joint_rows_bound(rows, row)
			                     : row->impulse_max;
			base->low = rb_joint_rows_is_stop(row) ? 0 : -base->high;
		}
		if (rb_joint_rows_is_stop(row)) {
			out->restitution = row->restitution;
			out->noise = row->noise;
		}
		if (used == 3) {
			base->set = RB_CONSTRAINT_FREE;
			base->normal = (rb_vec3){1, 0, 0};
			base->arm_a = point_arm(row, false);
			base->arm_b = point_arm(row, true);
			out->bias = (rb_vec3){bias_of(rows, &row[0], forces),
			                      bias_of(rows, &row[1], forces),
			                      bias_of(rows, &row[2], forces)};
			continue;
		}
		if (rb_vec3_max_abs(w->linear) > 0) {
			base->normal = w->linear;
			base->arm_a = arm_of(w->linear, rb_vec3_neg(w->angular_a));
			base->arm_b = arm_of(w->linear, w->angular_b);
		} else {
			const double lever = rb_vec3_length(w->angular_b);

			base->couple = true;
			base->normal = rb_vec3_unit(w->angular_b, (rb_vec3){1, 0, 0});
			base->arm_a = (rb_vec3){lever, 0, 0};
		}
		out->bias = rb_vec3_scale(bias_of(rows, row, forces), base->normal);
	}
	return count;
}

void rb_joint_rows_read_problem(const struct rb_joint_rows *rows, bool forces,
                                const struct rb_cone_row *from, double *multiplier)
{
	int count = 0;

	for (int k = 0, used; k < rows->count; k += used) {
		used = rows_of(rows, k);
		multiplier[k] = 0;
		if (is_left_out(&rows->row[k], forces))
			continue;
		const struct rb_constraint *base = &from[count++].base;
		const rb_vec3 impulse = rb_constraint_impulse(base);

		multiplier[k] = base->impulse.n;
		if (used < 3)
			continue;
		multiplier[k] = impulse.x;
		multiplier[k + 1] = impulse.y;
		multiplier[k + 2] = impulse.z;
	}
}

void rb_joint_rows_guess(const struct rb_joint_rows *rows, bool forces, const double *multiplier,
                         struct rb_cone_row *to)
{
	int count = 0;

	for (int k = 0, used; k < rows->count; k += used) {
		used = rows_of(rows, k);
		if (is_left_out(&rows->row[k], forces))
			continue;
		to[count++].base.impulse = (rb_along_across){
			multiplier[k],
			{0, used < 3 ? 0 : multiplier[k + 1], used < 3 ? 0 : multiplier[k + 2]}};
	}
}
