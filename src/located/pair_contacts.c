/* SPDX-License-Identifier: MIT */
/*
 * Contact points of spheres with spheres, planes and rectangles in closed form, and times of touch:
 * linear, quadratic or quartic equations on parabolas, else conservative advancement with bounds on
 * acceleration and jerk (Mirtich 1996), which cannot miss a touch.
 */
#include "located/pair_contacts.h"

#include "base/error.h"
#include "located/approach.h"
#include "located/bounds.h"
#include "located/relative.h"
#include "geom/distance.h"
#include "math/decay.h"
#include "math/quartic.h"
#include "model/joints.h"

#include <float.h>

/*
 * TOUCHING_ULP: tolerance of contact, ulp of the size; STEPS_MAX: steps of a search before it is
 * continued in another event; LOAD_ULP: rounding of the difference of equal accelerations, ulp of
 * the accelerations that they are composed of.
 */
enum { TOUCHING_ULP = 8, STEPS_MAX = 48, LOAD_ULP = 64 };

bool rb_pair_can_touch(const struct rb_located *l, int a, int b)
{
	const struct rb_model *model = l->model;

	RB_ASSERT_COSTLY(rb_located_is_body(l, a) && rb_located_is_body(l, b));
	RB_ASSERT_COSTLY(a != b);
	if (a == b || (rb_located_fixed(l, a) && rb_located_fixed(l, b)))
		return false;
	if (rb_model_joined(model, a, b))
		return false;
	return !model->group_bit || ((model->group_bit[a] & model->collides[b]) != 0 &&
	                             (model->group_bit[b] & model->collides[a]) != 0);
}

/* ---- geometry at one time ---- */

/* Fills gap, normal from the sphere, its rate, and whether the contact is on an edge or corner. */
typedef void contact_function(const struct rb_located *l, struct rb_contact_point *m);

/*
 * From the centre of mass to the origin, m, computed from the orientation: no digits are lost far
 * away.
 */
static rb_vec3 origin_arm(const struct rb_located *l, int i, const struct rb_pose *pose)
{
	if (i >= l->n || !l->model->center_of_mass)
		return (rb_vec3){0, 0, 0};
	return rb_vec3_neg(rb_quat_rotate(pose->orientation, l->model->center_of_mass[i]));
}

/* Velocity of the body's origin. */
static rb_vec3 origin_velocity(const struct rb_located *l, int i, const struct rb_pose *pose)
{
	if (i >= l->n || !l->model->center_of_mass)
		return pose->velocity;
	return rb_vec3_add(pose->velocity, rb_vec3_cross(pose->spin, origin_arm(l, i, pose)));
}

/* From a's origin to b's. */
static rb_vec3 between_origins(const struct rb_located *l, const struct rb_contact_point *m)
{
	const rb_vec3 d = rb_pose_between(&m->pose_a, &m->pose_b);

	if (!l->model->center_of_mass)
		return d;
	return rb_vec3_add(
		d, rb_vec3_sub(origin_arm(l, m->b, &m->pose_b), origin_arm(l, m->a, &m->pose_a)));
}

/* gaps are computed relative to the sphere's centre */
static const rb_vec3 here = {0, 0, 0};

static void contact_of_spheres(const struct rb_located *l, struct rb_contact_point *m)
{
	const rb_vec3 w = rb_vec3_sub(origin_velocity(l, m->b, &m->pose_b),
	                              origin_velocity(l, m->a, &m->pose_a));
	const double sum = l->model->shape[m->a].radius + l->model->shape[m->b].radius;

	m->gap = rb_distance_sphere_sphere(here, l->model->shape[m->a].radius,
	                                   between_origins(l, m), l->model->shape[m->b].radius,
	                                   &m->normal);
	m->normal_rate = rb_vec3_scale(1 / (m->gap + sum), rb_vec3_reject(w, m->normal));
}

/* Normal of a plane or rectangle, at rest or driven. */
static rb_vec3 normal_of(const struct rb_located *l, int b, rb_quat orientation)
{
	return b >= l->n ? l->plane_normal[b - l->n] : rb_plane_normal(orientation);
}

static void contact_with_plane(const struct rb_located *l, struct rb_contact_point *m)
{
	m->gap = rb_distance_sphere_plane(here, l->model->shape[m->a].radius, between_origins(l, m),
	                                  normal_of(l, m->b, m->pose_b.orientation), &m->normal);
	m->normal_rate = rb_vec3_cross(m->pose_b.spin, m->normal);
}

/*
 * Signed distance beyond an edge; on the edge, to rounding, the motion decides: moving outwards
 * counts as beyond.
 */
static double beyond(double x, double half, double rate, double band)
{
	const double sign = x < 0 ? -1 : 1;
	const double out = sign * x - half;

	if (out > band || (out >= -band && sign * rate > 0))
		return sign * fmax(out, DBL_MIN);
	return 0;
}

/* The vector with the component along an edge that the other one has. */
static rb_vec3 along_edge(rb_vec3 v, rb_vec3 other, rb_vec3 edge)
{
	return rb_vec3_add_scaled(v, rb_vec3_dot(rb_vec3_sub(other, v), edge), edge);
}

static void contact_with_rectangle(const struct rb_located *l, struct rb_contact_point *m)
{
	const double radius = l->model->shape[m->a].radius;
	rb_rectangle sheet = rb_rectangle_of(between_origins(l, m), m->pose_b.orientation,
	                                     l->model->shape[m->b].size);
	const rb_vec3 face = normal_of(l, m->b, m->pose_b.orientation);
	rb_vec3 closest;

	sheet.normal = face;
	m->gap = rb_distance_sphere_rectangle(here, radius, &sheet, &m->normal, &closest);
	const rb_vec3 d = rb_vec3_neg(sheet.center);
	const rb_vec3 arm = rb_vec3_add(rb_vec3_sub(closest, sheet.center),
	                                origin_arm(l, m->b, &m->pose_b));
	const rb_vec3 w = rb_vec3_sub(
		rb_vec3_add(m->pose_b.velocity, rb_vec3_cross(m->pose_b.spin, arm)),
		origin_velocity(l, m->a, &m->pose_a));
	const double band = TOUCHING_ULP * DBL_EPSILON *
	                    fmax(rb_vec3_max_abs(m->pose_a.origin),
	                         fmax(sheet.half_x, sheet.half_y));
	const double out_x = beyond(rb_vec3_dot(d, sheet.axis_x), sheet.half_x,
	                            -rb_vec3_dot(w, sheet.axis_x), band);
	const double out_y = beyond(rb_vec3_dot(d, sheet.axis_y), sheet.half_y,
	                            -rb_vec3_dot(w, sheet.axis_y), band);

	m->on_rim = out_x != 0 || out_y != 0;
	m->normal_rate = rb_vec3_cross(m->pose_b.spin, m->normal);
	if (!m->on_rim)
		return;
	/*
	 * on an edge the normal turns about it, and with it as it turns; at a corner it follows any
	 * motion across
	 */
	const double reach = m->gap + radius;
	const rb_vec3 carried = rb_vec3_scale(reach, m->normal_rate);
	rb_vec3 turn = rb_vec3_reject(w, m->normal);
	if (out_x == 0)
		turn = along_edge(turn, carried, sheet.axis_x);
	if (out_y == 0)
		turn = along_edge(turn, carried, sheet.axis_y);
	m->normal_rate = rb_vec3_scale(1 / reach, turn);
}

static contact_function *const point_of_pair[RB_SHAPE_KIND_COUNT] = {
	[RB_SHAPE_SPHERE] = contact_of_spheres,
	[RB_SHAPE_PLANE] = contact_with_plane,
	[RB_SHAPE_RECTANGLE] = contact_with_rectangle,
};

/*
 * Fills arms, their rates and the relative velocity from gap, normal and its rate; a is the sphere.
 */
static void finish(const struct rb_located *l, struct rb_contact_point *m)
{
	const double radius = l->model->shape[m->a].radius;

	m->point = rb_vec3_add_scaled(m->pose_a.origin, radius, m->normal);
	const rb_vec3 point_rate = rb_vec3_add_scaled(origin_velocity(l, m->a, &m->pose_a), radius,
	                                              m->normal_rate);
	if (l->model->center_of_mass) {
		m->arm_a = rb_vec3_add_scaled(origin_arm(l, m->a, &m->pose_a), radius, m->normal);
		m->rate_a = rb_vec3_sub(point_rate, m->pose_a.velocity);
	} else {
		m->arm_a = rb_vec3_scale(radius, m->normal);
		m->rate_a = rb_vec3_scale(radius, m->normal_rate);
	}
	if (l->model->shape[m->b].kind == RB_SHAPE_SPHERE && !l->model->center_of_mass) {
		m->arm_b = rb_vec3_scale(-l->model->shape[m->b].radius, m->normal);
		m->rate_b = rb_vec3_scale(-l->model->shape[m->b].radius, m->normal_rate);
	} else {
		m->arm_b = rb_vec3_sub(m->arm_a, rb_pose_between(&m->pose_a, &m->pose_b));
		m->rate_b = rb_vec3_sub(point_rate, m->pose_b.velocity);
	}
	m->velocity = rb_vec3_sub(
		rb_vec3_add(m->pose_b.velocity, rb_vec3_cross(m->pose_b.spin, m->arm_b)),
		rb_vec3_add(m->pose_a.velocity, rb_vec3_cross(m->pose_a.spin, m->arm_a)));
}

/* Exchanges the bodies: a becomes b. */
static void swap(struct rb_contact_point *m)
{
	const struct rb_contact_point o = *m;

	m->a = o.b;
	m->b = o.a;
	m->pose_a = o.pose_b;
	m->pose_b = o.pose_a;
	m->arm_a = o.arm_b;
	m->arm_b = o.arm_a;
	m->rate_a = o.rate_b;
	m->rate_b = o.rate_a;
	m->normal = rb_vec3_neg(o.normal);
	m->normal_rate = rb_vec3_neg(o.normal_rate);
	m->velocity = rb_vec3_neg(o.velocity);
}

struct rb_contact_point rb_contact_point_at(const struct rb_located *l, int a, int b, double t)
{
	const struct rb_pose pose_a = rb_arc_pose(l, a, t), pose_b = rb_arc_pose(l, b, t);

	RB_ASSERT_COSTLY(rb_located_is_body(l, a) && rb_located_is_body(l, b));
	RB_ASSERT_COSTLY(a != b);
	return rb_contact_point_poses(l, a, b, &pose_a, &pose_b);
}

struct rb_contact_point rb_contact_point_poses(const struct rb_located *l, int a, int b,
                                               const struct rb_pose *pose_a,
                                               const struct rb_pose *pose_b)
{
	const bool swapped = l->model->shape[a].kind != RB_SHAPE_SPHERE;

	if (rb_pair_has_features(l, a, b))
		return rb_touch_nearest(l, a, b, pose_a, pose_b);
	struct rb_contact_point m = {.a = swapped ? b : a,
	                             .b = swapped ? a : b,
	                             .inside = (double)INFINITY,
	                             .pose_a = swapped ? *pose_b : *pose_a,
	                             .pose_b = swapped ? *pose_a : *pose_b};

	point_of_pair[l->model->shape[m.b].kind](l, &m);
	finish(l, &m);
	if (swapped)
		swap(&m);
	return m;
}

int rb_pair_contact_points(const struct rb_located *l, int a, int b, double t, double slack,
                           struct rb_contact_point all[RB_CONTACT_POINTS_MAX])
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, a) && rb_located_is_body(l, b));
	RB_ASSERT_COSTLY(a != b);
	RB_ASSERT_COSTLY(slack >= 0);
	if (rb_pair_has_features(l, a, b)) {
		const struct rb_touch_pair pair = {a, b, t, rb_arc_pose(l, a, t),
		                                   rb_arc_pose(l, b, t)};

		return rb_touch_all(l, &pair, slack, all);
	}
	all[0] = rb_contact_point_at(l, a, b, t);
	return all[0].gap <= rb_contact_point_band(l, &all[0], t) + slack ? 1 : 0;
}

struct rb_contact_point rb_contact_point_of(const struct rb_located *l,
                                            const struct rb_contact_name *name,
                                            const struct rb_pose *pose_a,
                                            const struct rb_pose *pose_b)
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, name->a) && rb_located_is_body(l, name->b));
	if (rb_pair_has_features(l, name->a, name->b))
		return rb_touch_of(l, name, pose_a, pose_b);
	return rb_contact_point_poses(l, name->a, name->b, pose_a, pose_b);
}

double rb_pair_extent(const struct rb_located *l, int i)
{
	const struct rb_shape *shape = &l->model->shape[i];
	const double aside = i < l->n && l->model->center_of_mass
	                             ? rb_vec3_length(l->model->center_of_mass[i])
	                             : 0;

	if (shape->kind == RB_SHAPE_SPHERE)
		return aside + shape->radius;
	if (rb_shape_has_parts(shape->kind))
		return aside + rb_model_reach(l->model, i);
	return shape->kind == RB_SHAPE_RECTANGLE ? aside + shape->size[0] + shape->size[1]
	                                         : (double)INFINITY;
}

/* True if the body stays above a plane at rest over the interval. */
static bool is_above(const struct rb_located *l, int i, int plane, double from, double until)
{
	const double h = until - from, ball = rb_pair_extent(l, i);

	if (plane < l->n || !isfinite(ball) ||
	    (l->model->shape[plane].kind != RB_SHAPE_PLANE &&
	     l->model->shape[plane].kind != RB_SHAPE_RECTANGLE))
		return false;
	const rb_vec3 x = rb_arc_position(l, i, from);
	const rb_vec3 d = rb_vec3_sub(x, l->model->position[plane]);
	rb_vec3 n = l->plane_normal[plane - l->n];
	double reach = ball;
	if (l->model->shape[plane].kind == RB_SHAPE_RECTANGLE && rb_vec3_dot(n, d) < 0)
		n = rb_vec3_neg(n);
	if (h > 0)
		reach += h * (fmax(-rb_vec3_dot(n, rb_arc_velocity(l, i, from)), 0) +
		              0.5 * h * rb_arc_acceleration_max(l, i));
	return rb_vec3_dot(n, d) >
	       1.001 * reach + 1e-12 * (rb_vec3_max_abs(x) + rb_vec3_max_abs(d));
}

bool rb_pair_remains_separated(const struct rb_located *l, int a, int b,
                               const struct rb_parabola *at_a, double from, double until)
{
	const double reach_a = rb_pair_extent(l, a), reach_b = rb_pair_extent(l, b);

	if (isfinite(reach_a) && isfinite(reach_b)) {
		const struct rb_parabola at_b = rb_relative_parabola(l, b, from);

		return rb_relative_stay_separated(at_a, &at_b, until - from, reach_a + reach_b);
	}
	return b >= l->n && isfinite(reach_a) && l->model->shape[b].kind == RB_SHAPE_PLANE &&
	       rb_relative_remain_above(at_a, l->model->position[b], l->plane_normal[b - l->n],
	                                until - from, reach_a);
}

/* rb_pair_remains_separated for bodies in any order; statics come last. */
static bool keeps_off(const struct rb_located *l, int a, int b, double from, double until)
{
	const int first = a < b ? a : b, second = a < b ? b : a;
	const struct rb_parabola at_first = rb_relative_parabola(l, first, from);

	return rb_pair_remains_separated(l, first, second, &at_first, from, until);
}

bool rb_pair_is_far(const struct rb_located *l, int a, int b, double from, double until)
{
	const double sum = rb_pair_extent(l, a) + rb_pair_extent(l, b), h = until - from;
	const bool on_pieces = rb_located_on_piece(l, a) || rb_located_on_piece(l, b);

	RB_ASSERT_COSTLY(rb_located_is_body(l, a) && rb_located_is_body(l, b));
	RB_ASSERT_COSTLY(a != b);
	RB_ASSERT_COSTLY(until >= from);
	if (on_pieces && keeps_off(l, a, b, from, until))
		return true;
	if (!isfinite(sum))
		return is_above(l, a, b, from, until) || is_above(l, b, a, from, until);
	if (is_above(l, a, b, from, until) || is_above(l, b, a, from, until))
		return true;
	if (b < l->n && rb_relative_is(l, a, b) && rb_relative_began_far(l, a, b, until, sum))
		return true;
	/* the search itself costs only a few evaluations of the same polynomials */
	if (on_pieces && h > 0 && !rb_pair_has_features(l, a, b))
		return false;
	const rb_vec3 x = rb_arc_position(l, a, from), y = rb_arc_position(l, b, from);
	double reach = sum;
	if (h > 0)
		reach += h *
		         (rb_vec3_length(rb_vec3_sub(rb_arc_velocity(l, b, from),
		                                     rb_arc_velocity(l, a, from))) +
		          0.5 * h *
		                  (rb_arc_acceleration_max(l, a) + rb_arc_acceleration_max(l, b)));
	/* 1e-12 is far above the rounding of positions, speeds and time */
	return rb_vec3_length(rb_vec3_sub(y, x)) >
	       1.001 * reach + 1e-12 * (rb_vec3_max_abs(x) + rb_vec3_max_abs(y));
}

bool rb_contact_point_approaches(const struct rb_located *l, int a, int b, double t)
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, a) && rb_located_is_body(l, b));
	RB_ASSERT_COSTLY(a != b);
	if (rb_pair_has_features(l, a, b))
		return rb_approach_now(l, a, b, t);
	const struct rb_contact_point m = rb_contact_point_at(l, a < b ? a : b, a < b ? b : a, t);

	return rb_vec3_dot(m.velocity, m.normal) < -rb_contact_point_noise(l, &m);
}

/* ---- times of touch ---- */

static bool same_vector(rb_vec3 a, rb_vec3 b)
{
	return a.x == b.x && a.y == b.y && a.z == b.z;
}

/*
 * Seconds until |d + w s| = sum while closing (quadratic); INFINITY: never.
 */
static double linear_touch(rb_vec3 d, rb_vec3 w, double sum, double noise)
{
	const double b = rb_vec3_dot(d, w);

	if (!(b < 0))
		return HUGE_VAL;
	const double c = rb_vec3_dot(d, d) - sum * sum;
	const double square = rb_vec3_dot(w, w);
	if (c <= 0)
		return -b > noise * sum ? 0 : HUGE_VAL;
	if (!rb_squares_hold(b * b))
		return rb_touch_time(d, w, sum);
	double discriminant = b * b - square * c;
	if (fabs(discriminant) < 1e-4 * b * b) {
		/* grazing: without the cancellation */
		const double speed = sqrt(square);
		const double offset = rb_vec3_length(rb_vec3_cross(d, w));

		discriminant = (speed * sum - offset) * (speed * sum + offset);
	}
	if (discriminant < 0)
		return HUGE_VAL;
	const double s = c / (sqrt(discriminant) - b);
	/* an approach within rounding is none */
	return s * square < noise * sum && -b <= noise * sum ? HUGE_VAL : s;
}

/* Rounding of the difference of two accelerations, m/s^2. */
static double rounding_of(const struct rb_located *l, rb_vec3 a, rb_vec3 b)
{
	return LOAD_ULP * DBL_EPSILON * (l->weight + rb_vec3_length(a) + rb_vec3_length(b));
}

/*
 * Seconds until bodies in contact, with a relative velocity of rounding, approach. If they move
 * alike and do not press, their accelerations differ by rounding only: they touch once they
 * approach faster than noise, or events would repeat without end at one time.
 */
static double resting_touch(double rate, double acceleration, double noise, double rounding)
{
	if (!(acceleration < 0))
		return HUGE_VAL;
	return acceleration < -rounding ? 0 : (rate + 2 * noise) / -acceleration;
}

/* Seconds until gap + rate s + acceleration s^2 / 2 = 0 while falling; INFINITY: never. */
static double quadratic_touch(double gap, double rate, double acceleration, double band,
                              double noise, double rounding)
{
	const bool touching = gap <= band;

	if (touching && rate < -noise)
		return 0;
	if (touching && rate <= noise) /* only acceleration can make them approach */
		return resting_touch(rate, acceleration, noise, rounding);
	if (touching) /* the gap within the band is no height to fall from */
		return acceleration < 0 ? -2 * rate / acceleration : HUGE_VAL;
	const double discriminant = rate * rate - 2 * acceleration * gap;
	if (rate < 0)
		return discriminant < 0 ? HUGE_VAL : 2 * gap / (sqrt(discriminant) - rate);
	if (!(acceleration < 0))
		return HUGE_VAL;
	return (rate + sqrt(discriminant)) / -acceleration;
}

/*
 * Seconds until two spheres under different accelerations touch, the root of the quartic |d + w s +
 * a s^2/2|^2 - sum^2. For a pair in contact that neither approaches nor separates beyond rounding,
 * the low coefficients are set to exact zeros, so that only higher terms count.
 */
static double parabolic_touch(const rb_vec3 motion[3], double sum, double band, double noise,
                              double rounding, double max)
{
	const rb_vec3 d = motion[0], w = motion[1], a = motion[2];
	const double length = rb_vec3_length(d), rate = rb_vec3_dot(d, w) / length;
	const bool touching = length - sum <= band;
	double c[5] = {(length - sum) * (length + sum), 2 * rb_vec3_dot(d, w),
	               rb_vec3_dot(w, w) + rb_vec3_dot(d, a), rb_vec3_dot(w, a),
	               0.25 * rb_vec3_dot(a, a)};
	const double scale = rb_vec3_dot(w, w) + length * rb_vec3_length(a);

	if (touching && rate < -noise)
		return 0;
	if (touching)
		c[0] = 0;
	if (touching && rate <= noise)
		c[1] = 0;
	if (touching && c[1] == 0 && fabs(c[2]) <= 64 * DBL_EPSILON * scale)
		c[2] = 0;
	if (touching && c[1] == 0 && c[2] < 0)
		return resting_touch(rate, c[2] / length, noise, rounding);
	return rb_quartic_falls(c, max);
}

/* Relative motion of a pair, with bounds. */
struct relative_motion {
	/* of the gap: m, m/s, m/s^2; without the curvature of surfaces, which only separates */
	double gap, rate, acceleration;
	double external, jerk; /* bounds: of the relative acceleration, of its rate */
	double speed,
		radius; /* m/s, of the centres; m, lower bound of the normal's radius of turning */
};

/*
 * True if the gap stays above `least` for h seconds. Its lower bound is gap + rate s + acceleration
 * s^2 / 2 - K s^3 / 6 for s <= h.
 */
static bool keeps_above(const struct relative_motion *c, double h, double least)
{
	/* K bounds the rate of a.n: jerk and the turning of the normal */
	const double k = c->jerk + c->external * (c->speed + c->external * h) / c->radius;
	const double end = c->gap + h * (c->rate + h * (0.5 * c->acceleration - k * h / 6));

	if (!(end >= least))
		return false;
	if (!(c->rate < 0) || !(c->acceleration > 0))
		return true; /* it rises, or is concave: the minimum is at an end */
	const double low = -2 * c->rate /
	                   (c->acceleration +
	                    sqrt(fmax(c->acceleration * c->acceleration + 2 * k * c->rate, 0)));
	return low >= h ||
	       c->gap + low * (c->rate + low * (0.5 * c->acceleration - k * low / 6)) >= least;
}

/* Safe time, s: h, doubled while the cubic bound allows. */
static double extended(const struct relative_motion *c, double h, double max, double least)
{
	if (!isfinite(c->jerk))
		return h;
	while (h < max && keeps_above(c, fmin(2 * h, max), least))
		h *= 2;
	return h;
}

/* Relative motion at t. */
static struct relative_motion relative_motion_of(const struct rb_located *l,
                                                 const struct rb_contact_point *m,
                                                 const struct rb_bounds *a,
                                                 const struct rb_bounds *b, double t)
{
	const bool flat_a = l->model->shape[m->a].kind != RB_SHAPE_SPHERE;
	const bool flat_b = l->model->shape[m->b].kind != RB_SHAPE_SPHERE;
	const double span = rb_vec3_length(between_origins(l, m));
	const rb_vec3 w = rb_vec3_sub(rb_contact_point_velocity(&m->pose_b, m->pose_b.origin),
	                              rb_contact_point_velocity(&m->pose_a, m->pose_a.origin));
	const rb_vec3 external = rb_vec3_sub(
		rb_contact_point_acceleration(l, m->b, &m->pose_b, m->pose_b.origin, t),
		rb_contact_point_acceleration(l, m->a, &m->pose_a, m->pose_a.origin, t));
	struct relative_motion c = {.gap = m->gap,
	                            .rate = rb_vec3_dot(m->velocity, m->normal),
	                            .acceleration = rb_vec3_dot(external, m->normal),
	                            .external = a->external + b->external,
	                            .jerk = a->jerk + b->jerk,
	                            .speed = rb_vec3_length(w),
	                            .radius = span};
	const struct rb_bounds *const flat = flat_a ? a : b;

	if (!flat_a && !flat_b)
		return c;
	/* a face's normal is constant, an edge's turns about the edge */
	c.radius = l->model->shape[flat_a ? m->a : m->b].kind == RB_SHAPE_PLANE
	                   ? (double)INFINITY
	                   : rb_contact_point_size(l, m);
	if (flat->turn > 0) { /* points of a rotating face move with their distance */
		c.external += 2 * flat->turn * flat->turn * span + 2 * flat->turn * flat->external;
		c.jerk = (double)INFINITY;
	}
	return c;
}

/*
 * Safe time of two spheres on one piece, s: at least h. The other bounds neglect the curvature of
 * surfaces, and so treat bodies that orbit each other as falling together.
 */
static double extended_on_piece(const struct rb_located *l, const struct rb_contact_point *m,
                                double t, double h, double until, double band)
{
	enum { FACTOR = 8 };
	const double least = rb_pair_extent(l, m->a) + rb_pair_extent(l, m->b) + band;
	bool more = true;

	while (more && h < until - t) {
		const double longer_s = fmin(FACTOR * h, until - t);

		more = rb_relative_is_separated(l, m->a, m->b, t, t + longer_s, least);
		if (more && longer_s >= until - t)
			return HUGE_VAL;
		if (more)
			h = longer_s;
	}
	return h;
}

/*
 * Conservative advancement from `from` to `until`; INFINITY: no touch. Sets `unfinished` if that is
 * not yet decided at the time returned.
 */
static double advance(const struct rb_located *l, int a, int b, double from, double until,
                      struct rb_approach *found)
{
	struct rb_bounds of_a = {0}, of_b = {0};
	double t = from, nearest = HUGE_VAL;
	bool is_relative = false;

	found->unfinished = false;
	for (int step = 0; step < STEPS_MAX; step++) {
		const struct rb_contact_point m = rb_contact_point_at(l, a, b, t);
		const double band = rb_contact_point_band(l, &m, t),
			     noise = rb_contact_point_noise(l, &m);

		found->products += RB_LOCATED_SEARCH;
		if (step == 0) {
			of_a = rb_bounds_of(l, m.a);
			of_b = rb_bounds_of(l, m.b);
			is_relative = m.b < l->n && rb_relative_is(l, m.a, m.b);
			if (is_relative) {
				rb_relative_bounds(l, m.a, m.b, &of_a.external, &of_a.jerk);
				of_b.external = of_b.jerk = 0;
			}
		}
		struct relative_motion c = relative_motion_of(l, &m, &of_a, &of_b, t);
		const double rate = c.rate, max = c.external;
		const bool touches = m.gap <= band;
		double h, least = 0;

		if (touches && rate < -noise) {
			/* reached by steps: continue from the band to the root */
			const double more = 2 * m.gap /
			                    (sqrt(rate * rate + 2 * max * m.gap) - rate);

			if (!(t > from && m.gap > 0 && m.gap < 0.5 * nearest && t + more <= until))
				return t;
			nearest = m.gap;
			t += more;
			continue;
		}
		if (touches && rate <= noise) {
			const double acceleration = rb_contact_point_gap_acceleration(l, &m, t);

			if (acceleration < -64 * DBL_EPSILON * max && t > from)
				return t;
			if (!(max > 0))
				return HUGE_VAL;
			h = sqrt(band / max);
			/* within half of the band, rates that are rounding count as zero */
			c.gap = c.rate = 0;
			c.acceleration = fabs(c.acceleration) <= 64 * DBL_EPSILON * max
			                         ? 0
			                         : c.acceleration;
			least = -0.5 * band;
		} else {
			const double gap = touches ? 0 : m.gap;
			const double root = sqrt(rate * rate + 2 * max * gap);

			/*
			 * the root of gap + rate h - max h^2 / 2, in the form without cancellation
			 */
			if (rate > 0)
				h = max > 0 ? (rate + root) / max : HUGE_VAL;
			else
				h = root > rate ? 2 * gap / (root - rate) : HUGE_VAL;
			c.gap = gap;
		}
		/* separating after contact: by the present acceleration, not the bound */
		if (touches && rate > noise && max > 0) {
			const double turns = rate /
			                     fmax(-rb_contact_point_gap_acceleration(l, &m, t),
			                          DBL_MIN);

			h = fmax(h, fmin(turns, sqrt(band / max)));
		}
		h = fmax(extended(&c, h, until - t, least), 2 * DBL_EPSILON * t);
		if (is_relative && !touches)
			h = extended_on_piece(l, &m, t, h, until, band);
		if (!(t + h <= until))
			return HUGE_VAL;
		t += h;
	}
	found->unfinished = true;
	return t;
}

/*
 * Seconds until spheres with equal linear drag touch: they move as in linear_touch in the
 * transformed time tau of math/decay.
 */
static double slowed_touch(double decay, rb_vec3 d, rb_vec3 w, double sum, double noise)
{
	const double tau = linear_touch(d, w, sum, noise);

	return decay > 0 && isfinite(tau) ? rb_decay_time(decay, tau) : tau;
}

/*
 * quadratic_touch for a sphere with linear drag; `motion` holds gap, rate and the acceleration by
 * constant forces. Drag alone does not reverse a motion.
 */
static double slowed_fall(double decay, const double motion[3], double band, double noise,
                          double rounding, double max)
{
	const double gap = motion[0], rate = motion[1], external = motion[2];
	const bool touching = gap <= band;

	if (!(decay > 0))
		return quadratic_touch(gap, rate, external, band, noise, rounding);
	if (touching && rate < -noise)
		return 0;
	if (touching && (rate <= noise || !(external < 0)))
		return resting_touch(rate, external, noise, rounding);
	return rb_decay_falls(decay, touching ? 0 : gap, rate, external, max);
}

/* True if the bodies, of which the second may be fixed, differ in drag. */
static bool decay_differently(const struct rb_located *l, int a, int b)
{
	const double decay_a = rb_arc_decay(l, a), decay_b = rb_arc_decay(l, b);

	return b < l->n &&
	       (decay_a != decay_b ||
	        (decay_a > 0 && !same_vector(l->arc[a].acceleration, l->arc[b].acceleration)));
}

/* True if the body is on an arc whose centre of mass is its origin. */
static bool in_flight(const struct rb_located *l, int i)
{
	return !rb_located_on_piece(l, i) && !l->model->center_of_mass;
}

double rb_pair_contact_time(const struct rb_located *l, int a, int b, double from, double until,
                            struct rb_approach *found)
{
	const struct rb_model *model = l->model;
	double s;

	RB_ASSERT_COSTLY(rb_located_is_body(l, a) && rb_located_is_body(l, b));
	RB_ASSERT_COSTLY(a != b);
	RB_ASSERT_COSTLY(until >= from);
	found->unfinished = false;
	if (rb_pair_has_features(l, a, b)) {
		*found = rb_approach_find(l, a, b, from, until);
		return found->touch_s;
	}
	/* the sphere of lower index comes first, so that impact and prediction round alike */
	if (model->shape[a].kind != RB_SHAPE_SPHERE ||
	    (a > b && model->shape[b].kind == RB_SHAPE_SPHERE)) {
		const int other = a;

		a = b;
		b = other;
	}
	if (!in_flight(l, a) || (b < l->n && !in_flight(l, b)) || decay_differently(l, a, b))
		return advance(l, a, b, from, until, found);
	const rb_vec3 none = {0, 0, 0};
	const double decay = rb_arc_decay(l, a);
	const rb_vec3 acceleration_b = b < l->n ? l->arc[b].acceleration : none;
	const rb_vec3 va = rb_arc_velocity(l, a, from), vb = rb_arc_velocity(l, b, from);
	if (model->shape[b].kind == RB_SHAPE_SPHERE &&
	    !same_vector(l->arc[a].acceleration, acceleration_b)) {
		const struct rb_contact_point m = rb_contact_point_at(l, a, b, from);
		const rb_vec3 motion[3] = {between_origins(l, &m), rb_vec3_sub(vb, va),
		                           rb_vec3_sub(acceleration_b, l->arc[a].acceleration)};

		s = parabolic_touch(
			motion, model->shape[a].radius + model->shape[b].radius,
			rb_contact_point_band(l, &m, from), rb_contact_point_noise(l, &m),
			rounding_of(l, l->arc[a].acceleration, acceleration_b), until - from);
	} else if (model->shape[b].kind == RB_SHAPE_SPHERE) {
		s = slowed_touch(
			decay,
			rb_vec3_sub(rb_arc_position(l, b, from), rb_arc_position(l, a, from)),
			rb_vec3_sub(vb, va), model->shape[a].radius + model->shape[b].radius,
			8 * DBL_EPSILON * (rb_vec3_max_abs(va) + rb_vec3_max_abs(vb)));
		if (s == 0 && !rb_contact_point_approaches(l, a, b, from))
			return HUGE_VAL;
	} else if (model->shape[b].kind == RB_SHAPE_PLANE && b >= l->n) {
		const rb_vec3 n = l->plane_normal[b - l->n];
		const rb_vec3 x = rb_arc_position(l, a, from), v = rb_arc_velocity(l, a, from);
		const double rate = rb_vec3_dot(v, n);
		const double band = DBL_EPSILON * (TOUCHING_ULP * fmax(model->shape[a].radius,
		                                                       rb_vec3_max_abs(x)) +
		                                   2 * from * fabs(rate));

		const double gap = rb_vec3_dot(rb_vec3_sub(x, model->position[b]), n) -
		                   model->shape[a].radius;
		const struct rb_contact_point m = gap <= band ? rb_contact_point_at(l, a, b, from)
		                                              : (struct rb_contact_point){0};

		const double motion[3] = {gap, rate, rb_vec3_dot(l->arc[a].acceleration, n)};

		s = slowed_fall(decay, motion, band,
		                gap <= band ? rb_contact_point_noise(l, &m) : 0,
		                rounding_of(l, l->arc[a].acceleration, none), until - from);
	} else {
		return advance(l, a, b, from, until, found);
	}
	return from + s <= until ? from + s : HUGE_VAL;
}
