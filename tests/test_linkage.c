/* SPDX-License-Identifier: MIT */
/* src/geom/linkage.c: rows of joints against differences of their errors along a motion. */
#include "support.h"

#include <math.h>

#include "geom/linkage.h"
#include "math/quat.h"
#include "model/joint_type.h"

enum { POSES = 20 };

static double some(int k)
{
	return sin(12.9898 * k + 0.37) + 0.5 * cos(4.1414 * k);
}

static rb_vec3 vector(int k)
{
	return (rb_vec3){some(3 * k), some(3 * k + 1), some(3 * k + 2)};
}

/* A motion of constant acceleration and angular acceleration, to second order in t. */
struct motion {
	struct rb_pose start;
	rb_vec3 acceleration, angular;
};

static struct motion motion_of(int k)
{
	return (struct motion){
		.start = {.position = vector(k),
	                  .orientation = rb_quat_from_turn(vector(k + 1)),
	                  .velocity = vector(k + 2),
	                  .spin = vector(k + 3)},
		.acceleration = vector(k + 4),
		.angular = vector(k + 5),
	};
}

/*
 * The pose at t. The turn w t + w' t^2 / 2, taken as one rotation vector, has the right first and
 * second derivative: its own correction w x w' t^3 / 12 is of third order.
 */
static struct rb_pose at(const struct motion *m, double t)
{
	struct rb_pose pose = m->start;
	const rb_vec3 turn = rb_vec3_add(rb_vec3_scale(t, m->start.spin),
	                                 rb_vec3_scale(0.5 * t * t, m->angular));

	pose.position = rb_vec3_add(rb_vec3_add(pose.position, rb_vec3_scale(t, pose.velocity)),
	                            rb_vec3_scale(0.5 * t * t, m->acceleration));
	pose.orientation = rb_quat_multiply(rb_quat_from_turn(turn), pose.orientation);
	pose.velocity = rb_vec3_add(pose.velocity, rb_vec3_scale(t, m->acceleration));
	pose.spin = rb_vec3_add(pose.spin, rb_vec3_scale(t, m->angular));
	return pose;
}

static struct rb_linkage link_of(enum rb_joint_kind kind, int k)
{
	return (struct rb_linkage){
		.type = &rb_joint_type((int)kind)->linkage,
		.at_a = vector(k + 50),
		.at_b = vector(k + 51),
		.frame_a = rb_quat_from_turn(vector(k + 52)),
		.frame_b = rb_quat_from_turn(vector(k + 53)),
		.length = 0.7,
	};
}

static void errors_at(const struct rb_linkage *link, const struct motion m[2], double t,
                      double error[RB_LINKAGE_ROWS_MAX])
{
	const struct rb_pose a = at(&m[0], t), b = at(&m[1], t);
	struct rb_linkage_row row[RB_LINKAGE_ROWS_MAX];
	const int count = rb_linkage_rows(link, &a, &b, row);

	assert_int_equal(count, rb_linkage_row_count(link));
	for (int r = 0; r < count; r++)
		error[r] = row[r].error;
}

static double acceleration_of(const struct rb_linkage_row *row, const struct motion m[2])
{
	return rb_vec3_dot(row->linear, rb_vec3_sub(m[1].acceleration, m[0].acceleration)) +
	       rb_vec3_dot(row->angular_a, m[0].angular) +
	       rb_vec3_dot(row->angular_b, m[1].angular) + row->bias;
}

static void rows_are_derivatives_of_errors(void **state)
{
	const double h = 1e-3;

	(void)state;
	for (int kind = 0; kind < RB_JOINT_KIND_COUNT; kind++) {
		for (int k = 0; k < POSES; k++) {
			const struct rb_linkage link = link_of((enum rb_joint_kind)kind, 7 * k);
			const struct motion m[2] = {motion_of(11 * k), motion_of(11 * k + 100)};
			double e[5][RB_LINKAGE_ROWS_MAX];
			struct rb_linkage_row row[RB_LINKAGE_ROWS_MAX];
			const int count = rb_linkage_rows(&link, &m[0].start, &m[1].start, row);

			for (int s = 0; s < 5; s++)
				errors_at(&link, m, (s - 2) * h, e[s]);
			for (int r = 0; r < count; r++) {
				/* of fourth order; the motion's own third order has no part */
				const double first = (e[0][r] - 8 * e[1][r] + 8 * e[3][r] -
				                      e[4][r]) /
				                     (12 * h);
				const double second = (-e[0][r] + 16 * e[1][r] - 30 * e[2][r] +
				                       16 * e[3][r] - e[4][r]) /
				                      (12 * h * h);

				assert_near(
					rb_linkage_row_velocity(&row[r], &m[0].start, &m[1].start),
					first, 1e-6);
				assert_near(acceleration_of(&row[r], m), second, 1e-6);
				assert_true(rb_linkage_row_is_couple(&link, r) ==
				            (rb_vec3_length(row[r].linear) == 0));
			}
		}
	}
}

/* b where a joint of that kind that closes puts it, turned by `angle` and moved by `way`. */
static struct rb_pose closed(const struct rb_linkage *link, const struct rb_pose *a, double angle,
                             double way)
{
	struct rb_pose b = {.velocity = a->velocity, .spin = a->spin};
	const rb_quat axes = rb_quat_multiply(
		rb_quat_multiply(a->orientation, link->frame_a),
		rb_quat_from_turn((rb_vec3){0, 0, rb_linkage_turns(link) ? angle : 0}));
	const rb_quat f = link->frame_b;

	b.orientation = rb_quat_multiply(axes, (rb_quat){f.w, -f.x, -f.y, -f.z});
	b.position = rb_vec3_sub(
		rb_vec3_add_scaled(rb_linkage_point_a(link, a), way, rb_linkage_axis(link, a)),
		rb_quat_rotate(b.orientation, link->at_b));
	return b;
}

/* A motion that the joint allows has neither errors nor their rates, at any angle or way. */
static void what_a_joint_allows_has_no_error(void **state)
{
	static const enum rb_joint_kind kinds[] = {RB_JOINT_FIXED, RB_JOINT_BALL, RB_JOINT_HINGE,
	                                           RB_JOINT_SLIDER, RB_JOINT_CYLINDRICAL};

	(void)state;
	for (size_t c = 0; c < sizeof kinds / sizeof kinds[0]; c++) {
		for (int k = 0; k < POSES; k++) {
			const struct rb_linkage link = link_of(kinds[c], 5 * k);
			const struct motion m = motion_of(3 * k);
			const struct rb_pose a = m.start;
			const double rate = 1.3;
			const bool turns = kinds[c] == RB_JOINT_HINGE;
			const bool slides = kinds[c] == RB_JOINT_SLIDER ||
			                    kinds[c] == RB_JOINT_CYLINDRICAL;
			const double angle = turns ? 3 * some(k) / 1.5 : 0;
			const double way = slides ? some(k + 9) : 0;
			struct rb_pose b = closed(&link, &a, angle, way);
			struct rb_linkage_row row[RB_LINKAGE_ROWS_MAX];
			const rb_vec3 axis = rb_linkage_axis(&link, &a);

			/* as one body with a, and along or about the axis */
			if (turns)
				b.spin = rb_vec3_add_scaled(b.spin, rate, axis);
			const rb_vec3 point = rb_linkage_point_b(&link, &b);
			const rb_vec3 arm = rb_vec3_sub(point, b.position);
			rb_vec3 speed = rb_vec3_add(
				a.velocity, rb_vec3_cross(a.spin, rb_vec3_sub(point, a.position)));

			if (slides)
				speed = rb_vec3_add_scaled(speed, rate, axis);
			b.velocity = rb_vec3_sub(speed, rb_vec3_cross(b.spin, arm));
			const int count = rb_linkage_rows(&link, &a, &b, row);

			for (int r = 0; r < count; r++) {
				assert_near(row[r].error, 0, 1e-14);
				assert_near(rb_linkage_row_velocity(&row[r], &a, &b), 0, 3e-14);
			}
			if (!rb_linkage_has_free(&link))
				continue;
			const struct rb_linkage_free free = rb_linkage_free(&link, &a, &b);

			assert_near(free.rate, rate, 3e-14);
			assert_near(free.value, turns ? angle : way, 3e-14);
		}
	}
}

/* Bias of the free coordinate: of its rate along any motion of both. */
static void the_free_coordinate_has_its_own_bias(void **state)
{
	const double h = 1e-3;

	(void)state;
	for (int k = 0; k < POSES; k++) {
		for (int kind = RB_JOINT_HINGE; kind <= RB_JOINT_CYLINDRICAL; kind++) {
			const struct rb_linkage link = link_of((enum rb_joint_kind)kind, 7 * k);
			const struct motion m[2] = {motion_of(11 * k), motion_of(11 * k + 100)};
			const struct rb_linkage_free here = rb_linkage_free(&link, &m[0].start,
			                                                    &m[1].start);
			double rate[2];

			for (int s = 0; s < 2; s++) {
				const struct rb_pose a = at(&m[0], (2 * s - 1) * h);
				const struct rb_pose b = at(&m[1], (2 * s - 1) * h);

				rate[s] = rb_linkage_free(&link, &a, &b).rate;
			}
			assert_near(acceleration_of(&here.row, m), (rate[1] - rate[0]) / (2 * h),
			            2e-4);
		}
	}
}

/* Forces of a row have no sum, and no moment about any point. */
static void rows_keep_momentum(void **state)
{
	(void)state;
	for (int kind = 0; kind < RB_JOINT_KIND_COUNT; kind++) {
		for (int k = 0; k < POSES; k++) {
			const struct rb_linkage link = link_of((enum rb_joint_kind)kind, 7 * k);
			const struct motion m[2] = {motion_of(11 * k), motion_of(11 * k + 100)};
			struct rb_linkage_row row[RB_LINKAGE_ROWS_MAX];
			const int count = rb_linkage_rows(&link, &m[0].start, &m[1].start, row);
			/*
			 * the world's axes act at both points: only where these meet have their
			 * forces no moment
			 */
			const bool apart = kind != RB_JOINT_SLIDER &&
			                   kind != RB_JOINT_CYLINDRICAL && kind < RB_JOINT_ROD;

			for (int r = 0; r < count; r++) {
				const rb_vec3 across = rb_vec3_cross(
					rb_vec3_sub(rb_linkage_point_b(&link, &m[1].start),
				                    rb_linkage_point_a(&link, &m[0].start)),
					row[r].linear);
				const rb_vec3 moment = rb_vec3_add(
					rb_vec3_add(row[r].angular_a, row[r].angular_b),
					rb_vec3_cross(rb_vec3_sub(m[1].start.position,
				                                  m[0].start.position),
				                      row[r].linear));

				assert_near(rb_vec3_length(rb_vec3_sub(
						    moment, apart ? across : (rb_vec3){0})),
				            0, 2e-14);
			}
		}
	}
}

/* Between its points; what is beyond it counts, and of a rope nothing that is within. */
static void a_gap_is_how_far_points_are_off(void **state)
{
	struct rb_pose a = rb_linkage_world(), b = rb_linkage_world();

	(void)state;
	b.position = (rb_vec3){0.3, 0, 0.4};
	for (int kind = 0; kind < RB_JOINT_KIND_COUNT; kind++) {
		const struct rb_linkage link = {.type = &rb_joint_type((int)kind)->linkage,
		                                .frame_a = rb_quat_identity,
		                                .frame_b = rb_quat_identity,
		                                .length = 0.7};
		const bool slides = link.type->condition[0] == &rb_linkage_on_axis;
		const double gap = kind == RB_JOINT_ROPE  ? 0
		                   : kind == RB_JOINT_ROD ? 0.2
		                   : slides               ? 0.3
		                                          : 0.5;

		/* turning is no gap */
		b.orientation = rb_quat_from_turn((rb_vec3){0.4, 0.1, 0});
		assert_near(rb_linkage_gap(&link, &a, &b), gap, 1e-15);
	}
}

static void turns_are_counted_by_the_nearest(void **state)
{
	const double turn = 2 * acos(-1);

	(void)state;
	assert_near(rb_linkage_angle_near(0.1, 0), 0.1, 0);
	assert_near(rb_linkage_angle_near(-3, 3.2), turn - 3, 1e-15);
	assert_near(rb_linkage_angle_near(0.5, 100 * turn), 100 * turn + 0.5, 1e-12);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rows_are_derivatives_of_errors),
		cmocka_unit_test(what_a_joint_allows_has_no_error),
		cmocka_unit_test(the_free_coordinate_has_its_own_bias),
		cmocka_unit_test(rows_keep_momentum),
		cmocka_unit_test(a_gap_is_how_far_points_are_off),
		cmocka_unit_test(turns_are_counted_by_the_nearest),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
