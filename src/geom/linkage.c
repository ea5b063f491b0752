/* SPDX-License-Identifier: MIT */
/*
 * Rows of joints, each with its exact derivative along motions of both bodies. Directions that turn
 * with a body contribute terms of their own: those of u' = w_a x u and u'' = w_a' x u +
 * w_a x (w_a x u), of which w_a' belongs to J A and the rest to the bias.
 */
#include "geom/linkage.h"

#include "base/error.h"
#include "math/quat.h"

struct rb_pose rb_linkage_world(void)
{
	return (struct rb_pose){.orientation = {1, 0, 0, 0}};
}

static rb_vec3 twice_cross(rb_vec3 w, rb_vec3 r)
{
	return rb_vec3_cross(w, rb_vec3_cross(w, r));
}

static struct rb_linkage_parts parts_of(const struct rb_linkage *link, const struct rb_pose *a,
                                        const struct rb_pose *b)
{
	struct rb_linkage_parts p = {.a = a, .b = b};

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

static rb_vec3 axis_of(rb_quat turn, int k)
{
	return rb_quat_rotate(turn, (rb_vec3){k == 0, k == 1, k == 2});
}

rb_vec3 rb_linkage_axis_a(const struct rb_linkage_parts *p, int k)
{
	return axis_of(p->turn_a, k);
}

rb_vec3 rb_linkage_axis_b(const struct rb_linkage *link, const struct rb_linkage_parts *p, int k)
{
	return axis_of(rb_quat_multiply(p->b->orientation, link->frame_b), k);
}

struct rb_linkage_row rb_linkage_along(const struct rb_linkage_parts *p, rb_vec3 u)
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
static struct rb_linkage_row couple_row(const struct rb_linkage_parts *p, rb_vec3 m, rb_vec3 rate,
                                        double error)
{
	return (struct rb_linkage_row){
		.angular_a = rb_vec3_neg(m),
		.angular_b = m,
		.error = error,
		.bias = rb_vec3_dot(rate, p->spin),
	};
}

/* Its derivative is (w x u).(w_b - w_a). */
struct rb_linkage_row rb_linkage_across(const struct rb_linkage_parts *p, rb_vec3 u, rb_vec3 w)
{
	const rb_vec3 rate = rb_vec3_add(rb_vec3_cross(rb_vec3_cross(p->b->spin, w), u),
	                                 rb_vec3_cross(w, rb_vec3_cross(p->a->spin, u)));

	return couple_row(p, rb_vec3_cross(w, u), rate, rb_vec3_dot(u, w));
}

/* ---- conditions ---- */

/* d along the world's axes: nothing in it turns. */
static void fill_point(const struct rb_linkage *link, const struct rb_linkage_parts *p,
                       struct rb_linkage_row *row)
{
	static const rb_vec3 axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

	(void)link;
	for (int k = 0; k < 3; k++)
		row[k] = (struct rb_linkage_row){
			.linear = axis[k],
			.angular_a = rb_vec3_neg(rb_vec3_cross(p->arm_a, axis[k])),
			.angular_b = rb_vec3_cross(p->arm_b, axis[k]),
			.error = rb_vec3_dot(axis[k], p->d),
			.bias = rb_vec3_dot(axis[k], p->centripetal),
		};
}

static void fill_on_axis(const struct rb_linkage *link, const struct rb_linkage_parts *p,
                         struct rb_linkage_row *row)
{
	(void)link;
	for (int k = 0; k < 2; k++)
		row[k] = rb_linkage_along(p, rb_linkage_axis_a(p, k));
}

static void fill_same_axis(const struct rb_linkage *link, const struct rb_linkage_parts *p,
                           struct rb_linkage_row *row)
{
	const rb_vec3 w3 = rb_linkage_axis_b(link, p, 2);

	for (int k = 0; k < 2; k++)
		row[k] = rb_linkage_across(p, rb_linkage_axis_a(p, k), w3);
}

/*
 * 2 v of the rotation (s, v) from a's axes to b's, in a's axes; of both signs the one with s >= 0.
 * q' = (0, w) q / 2 with w the spin of b against a in a's axes: 2 v' = s w + w x v, so that row k
 * is the couple about s e_k + v x e_k.
 */
static void fill_same_turn(const struct rb_linkage *link, const struct rb_linkage_parts *p,
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
}

/* |d| - L. */
static void fill_length(const struct rb_linkage *link, const struct rb_linkage_parts *p,
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
}

const struct rb_linkage_condition rb_linkage_same_point = {.count = 3, .fill = fill_point};
const struct rb_linkage_condition rb_linkage_on_axis = {.count = 2, .fill = fill_on_axis};
const struct rb_linkage_condition rb_linkage_same_axis = {
	.count = 2, .couples = true, .fill = fill_same_axis};
const struct rb_linkage_condition rb_linkage_same_turn = {
	.count = 3, .couples = true, .fill = fill_same_turn};
const struct rb_linkage_condition rb_linkage_length = {.count = 1, .fill = fill_length};

/* ---- the rows of a joint ---- */

int rb_linkage_rows(const struct rb_linkage *link, const struct rb_pose *a, const struct rb_pose *b,
                    struct rb_linkage_row row[RB_LINKAGE_ROWS_MAX])
{
	const struct rb_linkage_parts p = parts_of(link, a, b);
	const struct rb_linkage_condition *const *condition = link->type->condition;

	condition[0]->fill(link, &p, row);
	if (condition[1])
		condition[1]->fill(link, &p, row + condition[0]->count);
	return rb_linkage_row_count(link);
}

double rb_linkage_gap(const struct rb_linkage *link, const struct rb_pose *a,
                      const struct rb_pose *b)
{
	struct rb_linkage_row row[RB_LINKAGE_ROWS_MAX];
	const int count = rb_linkage_rows(link, a, b, row);
	double square = 0;

	for (int k = 0; k < count; k++) {
		const double error = link->type->one_sided ? fmax(0, row[k].error) : row[k].error;

		if (!rb_linkage_row_is_couple(link, k))
			square += error * error;
	}
	return sqrt(square);
}

double rb_linkage_row_velocity(const struct rb_linkage_row *row, const struct rb_pose *a,
                               const struct rb_pose *b)
{
	return rb_vec3_dot(row->linear, rb_vec3_sub(b->velocity, a->velocity)) +
	       rb_vec3_dot(row->angular_a, a->spin) + rb_vec3_dot(row->angular_b, b->spin);
}

/* The angle of the rotation from a's axes to b's about z, [-pi, pi]. */
static double twist(const struct rb_linkage *link, const struct rb_linkage_parts *p)
{
	const rb_quat turn_b = rb_quat_multiply(p->b->orientation, link->frame_b);
	const rb_quat back = {p->turn_a.w, -p->turn_a.x, -p->turn_a.y, -p->turn_a.z};
	const rb_quat q = rb_quat_multiply(back, turn_b);

	return 2 * (q.w < 0 ? atan2(-q.z, -q.w) : atan2(q.z, q.w));
}

struct rb_linkage_free rb_linkage_free(const struct rb_linkage *link, const struct rb_pose *a,
                                       const struct rb_pose *b)
{
	const struct rb_linkage_parts p = parts_of(link, a, b);
	const rb_vec3 axis = axis_of(p.turn_a, 2);
	struct rb_linkage_free free;

	RB_ASSERT(rb_linkage_has_free(link));
	if (rb_linkage_turns(link)) {
		free.row = couple_row(&p, axis, rb_vec3_cross(a->spin, axis), 0);
		free.value = twist(link, &p);
	} else {
		free.row = rb_linkage_along(&p, axis);
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
