/* SPDX-License-Identifier: MIT */
/*
 * Rows of joints, each with its exact derivative along motions of both bodies. Directions that turn
 * with a body contribute terms of their own: those of u' = w_a x u and u'' = w_a' x u +
 * w_a x (w_a x u), of which w_a' belongs to J A and the rest to the bias.
 */
#include "geom/linkage.h"

#include "base/error.h"
#include "math/quat.h"

/* What all rows are made of. */
struct parts {
	const struct rb_pose *a, *b;
	rb_vec3 arm_a, arm_b; /* m, world axes */
	rb_vec3 d;            /* m, from a's point to b's */
	rb_vec3 rate;         /* m/s, of d */
	rb_vec3 centripetal;  /* m/s^2, of d, without accelerations: centripetal */
	rb_quat turn_a;       /* from the joint's axes of a to the world */
	rb_vec3 spin;         /* rad/s, of b against a */
};

struct rb_pose rb_linkage_world(void)
{
	return (struct rb_pose){.orientation = {1, 0, 0, 0}};
}

int rb_linkage_row_count(enum rb_joint_kind kind)
{
	static const int count[RB_JOINT_KIND_COUNT] = {6, 3, 5, 5, 4, 4, 1, 1};

	RB_ASSERT((int)kind >= 0 && (int)kind < RB_JOINT_KIND_COUNT);
	return count[kind];
}

bool rb_linkage_row_is_couple(enum rb_joint_kind kind, int row)
{
	static const int first[RB_JOINT_KIND_COUNT] = {3, 3, 3, 2, 2, 3, 1, 1};

	RB_ASSERT(row >= 0 && row < rb_linkage_row_count(kind));
	return row >= first[kind];
}

static rb_vec3 twice_cross(rb_vec3 w, rb_vec3 r)
{
	return rb_vec3_cross(w, rb_vec3_cross(w, r));
}

static struct parts parts_of(const struct rb_linkage *link, const struct rb_pose *a,
                             const struct rb_pose *b)
{
	struct parts p = {.a = a, .b = b};

	p.arm_a = rb_quat_rotate(a->orientation, link->at_a);
	p.arm_b = rb_quat_rotate(b->orientation, link->at_b);
	p.d = rb_vec3_add(rb_pose_between(a, b), rb_vec3_sub(p.arm_b, p.arm_a));
	p.rate = rb_vec3_add(
		rb_vec3_sub(b->velocity, a->velocity),
		rb_vec3_sub(rb_vec3_cross(b->spin, p.arm_b), rb_vec3_cross(a->spin, p.arm_a)));
	p.centripetal = rb_vec3_sub(twice_cross(b->spin, p.arm_b), twice_cross(a->spin, p.arm_a));
	p.turn_a = rb_quat_multiply(a->orientation, link->frame_a);
	p.spin = rb_vec3_sub(b->spin, a->spin);
	return p;
}

/* d along the world's axes: nothing in it turns. */
static int point_rows(const struct parts *p, struct rb_linkage_row *row)
{
	static const rb_vec3 axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

	for (int k = 0; k < 3; k++)
		row[k] = (struct rb_linkage_row){
			.linear = axis[k],
			.angular_a = rb_vec3_neg(rb_vec3_cross(p->arm_a, axis[k])),
			.angular_b = rb_vec3_cross(p->arm_b, axis[k]),
			.error = rb_vec3_dot(axis[k], p->d),
			.bias = rb_vec3_dot(axis[k], p->centripetal),
		};
	return 3;
}

/* u.d for u that turns with a. */
static struct rb_linkage_row along_row(const struct parts *p, rb_vec3 u)
{
	const rb_vec3 turned = rb_vec3_cross(p->a->spin, u);

	return (struct rb_linkage_row){
		.linear = u,
		.angular_a = rb_vec3_neg(rb_vec3_cross(rb_vec3_add(p->arm_a, p->d), u)),
		.angular_b = rb_vec3_cross(p->arm_b, u),
		.error = rb_vec3_dot(u, p->d),
		.bias = rb_vec3_dot(u, p->centripetal) + 2 * rb_vec3_dot(turned, p->rate) +
	                rb_vec3_dot(rb_vec3_cross(p->a->spin, turned), p->d),
	};
}

/* A couple about m, which changes at the rate m'. */
static struct rb_linkage_row couple_row(const struct parts *p, rb_vec3 m, rb_vec3 rate,
                                        double error)
{
	return (struct rb_linkage_row){
		.angular_a = rb_vec3_neg(m),
		.angular_b = m,
		.error = error,
		.bias = rb_vec3_dot(rate, p->spin),
	};
}

/* u.w for u that turns with a, w with b: its derivative is (w x u).(w_b - w_a). */
static struct rb_linkage_row across_row(const struct parts *p, rb_vec3 u, rb_vec3 w)
{
	const rb_vec3 rate = rb_vec3_add(rb_vec3_cross(rb_vec3_cross(p->b->spin, w), u),
	                                 rb_vec3_cross(w, rb_vec3_cross(p->a->spin, u)));

	return couple_row(p, rb_vec3_cross(w, u), rate, rb_vec3_dot(u, w));
}

/*
 * 2 v of the rotation (s, v) from a's axes to b's, in a's axes; of both signs the one with s >= 0.
 * q' = (0, w) q / 2 with w the spin of b against a in a's axes: 2 v' = s w + w x v, so that row k
 * is the couple about s e_k + v x e_k.
 */
static int orientation_rows(const struct rb_linkage *link, const struct parts *p,
                            struct rb_linkage_row *row)
{
	static const rb_vec3 axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	const rb_quat turn_b = rb_quat_multiply(p->b->orientation, link->frame_b);
	const rb_quat back = {p->turn_a.w, -p->turn_a.x, -p->turn_a.y, -p->turn_a.z};
	const rb_quat q = rb_quat_multiply(back, turn_b);
	const double sign = q.w < 0 ? -1 : 1;
	const double s = sign * q.w;
	const rb_vec3 v = {sign * q.x, sign * q.y, sign * q.z};
	const rb_vec3 w = rb_quat_rotate(back, p->spin);
	const double s_rate = -0.5 * rb_vec3_dot(w, v);
	const rb_vec3 v_rate = rb_vec3_scale(0.5,
	                                     rb_vec3_add(rb_vec3_scale(s, w), rb_vec3_cross(w, v)));
	const double error[3] = {2 * v.x, 2 * v.y, 2 * v.z};

	for (int k = 0; k < 3; k++) {
		const rb_vec3 local = rb_vec3_add(rb_vec3_scale(s, axis[k]),
		                                  rb_vec3_cross(v, axis[k]));
		const rb_vec3 local_rate = rb_vec3_add(rb_vec3_scale(s_rate, axis[k]),
		                                       rb_vec3_cross(v_rate, axis[k]));
		const rb_vec3 m = rb_quat_rotate(p->turn_a, local);
		const rb_vec3 rate = rb_vec3_add(rb_vec3_cross(p->a->spin, m),
		                                 rb_quat_rotate(p->turn_a, local_rate));

		row[k] = couple_row(p, m, rate, error[k]);
	}
	return 3;
}

/* |d| - L. */
static int length_row(const struct rb_linkage *link, const struct parts *p,
                      struct rb_linkage_row *row)
{
	const double length = rb_vec3_length(p->d);
	const rb_vec3 n = rb_vec3_unit(p->d, (rb_vec3){0, 0, 1});
	const rb_vec3 across = rb_vec3_reject(p->rate, n);

	*row = (struct rb_linkage_row){
		.linear = n,
		.angular_a = rb_vec3_neg(rb_vec3_cross(p->arm_a, n)),
		.angular_b = rb_vec3_cross(p->arm_b, n),
		.error = length - link->length,
		.bias = rb_vec3_dot(n, p->centripetal) +
	                (length > 0 ? rb_vec3_dot(across, across) / length : 0),
	};
	return 1;
}

static rb_vec3 axis_of(rb_quat turn, int k)
{
	return rb_quat_rotate(turn, (rb_vec3){k == 0, k == 1, k == 2});
}

int rb_linkage_rows(const struct rb_linkage *link, const struct rb_pose *a, const struct rb_pose *b,
                    struct rb_linkage_row row[RB_LINKAGE_ROWS_MAX])
{
	const struct parts p = parts_of(link, a, b);
	const rb_vec3 w3 = rb_quat_rotate(rb_quat_multiply(b->orientation, link->frame_b),
	                                  (rb_vec3){0, 0, 1});
	int count = 0;

	switch (link->kind) {
	case RB_JOINT_ROD:
	case RB_JOINT_ROPE:
		return length_row(link, &p, row);
	case RB_JOINT_SLIDER:
	case RB_JOINT_CYLINDRICAL:
		for (int k = 0; k < 2; k++)
			row[count++] = along_row(&p, axis_of(p.turn_a, k));
		break;
	default:
		count = point_rows(&p, row);
	}
	switch (link->kind) {
	case RB_JOINT_HINGE:
	case RB_JOINT_CYLINDRICAL:
		for (int k = 0; k < 2; k++)
			row[count++] = across_row(&p, axis_of(p.turn_a, k), w3);
		break;
	case RB_JOINT_UNIVERSAL:
		row[count++] = across_row(&p, axis_of(p.turn_a, 2), w3);
		break;
	case RB_JOINT_FIXED:
	case RB_JOINT_SLIDER:
		count += orientation_rows(link, &p, row + count);
		break;
	default:
		break;
	}
	RB_ASSERT_COSTLY(count == rb_linkage_row_count(link->kind));
	return count;
}

double rb_linkage_row_velocity(const struct rb_linkage_row *row, const struct rb_pose *a,
                               const struct rb_pose *b)
{
	return rb_vec3_dot(row->linear, rb_vec3_sub(b->velocity, a->velocity)) +
	       rb_vec3_dot(row->angular_a, a->spin) + rb_vec3_dot(row->angular_b, b->spin);
}

/* The angle of the rotation from a's axes to b's about z, [-pi, pi]. */
static double twist(const struct rb_linkage *link, const struct parts *p)
{
	const rb_quat turn_b = rb_quat_multiply(p->b->orientation, link->frame_b);
	const rb_quat back = {p->turn_a.w, -p->turn_a.x, -p->turn_a.y, -p->turn_a.z};
	const rb_quat q = rb_quat_multiply(back, turn_b);

	return 2 * (q.w < 0 ? atan2(-q.z, -q.w) : atan2(q.z, q.w));
}

struct rb_linkage_free rb_linkage_free(const struct rb_linkage *link, const struct rb_pose *a,
                                       const struct rb_pose *b)
{
	const struct parts p = parts_of(link, a, b);
	const rb_vec3 axis = axis_of(p.turn_a, 2);
	struct rb_linkage_free free;

	RB_ASSERT(rb_linkage_has_free(link->kind));
	if (link->kind == RB_JOINT_HINGE) {
		free.row = couple_row(&p, axis, rb_vec3_cross(a->spin, axis), 0);
		free.value = twist(link, &p);
	} else {
		free.row = along_row(&p, axis);
		free.value = free.row.error;
		free.row.error = 0;
	}
	free.rate = rb_linkage_row_velocity(&free.row, a, b);
	return free;
}

double rb_linkage_angle_near(double angle, double near)
{
	static const double turn = 6.283185307179586477;

	return angle + turn * rint((near - angle) / turn);
}

rb_vec3 rb_linkage_point_a(const struct rb_linkage *link, const struct rb_pose *a)
{
	return rb_vec3_add(a->position, rb_quat_rotate(a->orientation, link->at_a));
}

rb_vec3 rb_linkage_point_b(const struct rb_linkage *link, const struct rb_pose *b)
{
	return rb_linkage_point_a(&(struct rb_linkage){.at_a = link->at_b}, b);
}

rb_vec3 rb_linkage_axis(const struct rb_linkage *link, const struct rb_pose *a)
{
	return axis_of(rb_quat_multiply(a->orientation, link->frame_a), 2);
}
