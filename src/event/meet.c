/* SPDX-License-Identifier: MIT */
#include "event/meet.h"

#include "geom/distance.h"
#include "math/quartic.h"

#include <float.h>

enum { TOUCHING_ULP = 8, STEPS_MOST = 48 };

bool rb_meet_can(const struct rb_located *l, int a, int b)
{
	const struct rb_model *model = l->model;

	if (a == b || (rb_located_fixed(l, a) && rb_located_fixed(l, b)))
		return false;
	if (model->shape[a].kind != RB_SHAPE_SPHERE && model->shape[b].kind != RB_SHAPE_SPHERE)
		return false;
	return !model->group_bit || ((model->group_bit[a] & model->collides[b]) != 0 &&
	                             (model->group_bit[b] & model->collides[a]) != 0);
}

/* ---- geometry of a moment ---- */

/* What a shape of kind b makes of a sphere: gap, normal from the sphere, its rate, whether at a rim. */
typedef void meet_function(const struct rb_located *l, struct rb_meet *m);

static rb_vec3 origin_velocity(const struct rb_pose *pose)
{
	return rb_vec3_add(pose->velocity,
	                   rb_vec3_cross(pose->spin, rb_vec3_sub(pose->origin, pose->position)));
}

static void meet_sphere(const struct rb_located *l, struct rb_meet *m)
{
	const rb_vec3 w = rb_vec3_sub(origin_velocity(&m->pose_b), origin_velocity(&m->pose_a));
	const double sum = l->model->shape[m->a].radius + l->model->shape[m->b].radius;

	m->gap = rb_distance_sphere_sphere(m->pose_a.origin, l->model->shape[m->a].radius,
	                                   m->pose_b.origin, l->model->shape[m->b].radius,
	                                   &m->normal);
	m->normal_rate = rb_vec3_scale(1 / (m->gap + sum), rb_vec3_reject(w, m->normal));
}

static rb_vec3 normal_of(const struct rb_located *l, int b, rb_quat orientation)
{
	return b >= l->n ? l->plane_normal[b - l->n] : rb_plane_normal(orientation);
}

static void meet_plane(const struct rb_located *l, struct rb_meet *m)
{
	m->gap = rb_distance_sphere_plane(m->pose_a.origin, l->model->shape[m->a].radius,
	                                  m->pose_b.origin,
	                                  normal_of(l, m->b, m->pose_b.orientation), &m->normal);
	m->normal_rate = rb_vec3_cross(m->pose_b.spin, m->normal);
}

/* On a boundary to rounding, the way it moves decides: outwards it is at the rim already. */
static double beyond(double x, double half, double rate, double band)
{
	const double sign = x < 0 ? -1 : 1;
	const double out = sign * x - half;

	if (out > band || (out >= -band && sign * rate > 0))
		return sign * fmax(out, DBL_MIN);
	return 0;
}

static void meet_rectangle(const struct rb_located *l, struct rb_meet *m)
{
	const double radius = l->model->shape[m->a].radius;
	rb_rectangle sheet = rb_rectangle_of(m->pose_b.origin, m->pose_b.orientation,
	                                     l->model->shape[m->b].size);
	const rb_vec3 face = normal_of(l, m->b, m->pose_b.orientation);
	rb_vec3 closest;

	sheet.normal = face;
	m->gap = rb_distance_sphere_rectangle(m->pose_a.origin, radius, &sheet, &m->normal,
	                                      &closest);
	const rb_vec3 d = rb_vec3_sub(m->pose_a.origin, sheet.center);
	const rb_vec3 w = rb_vec3_sub(
		rb_vec3_add(
			m->pose_b.velocity,
			rb_vec3_cross(m->pose_b.spin, rb_vec3_sub(closest, m->pose_b.position))),
		origin_velocity(&m->pose_a));
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
	/* along an edge the normal does not turn; at a corner it follows every way across */
	rb_vec3 turn = rb_vec3_reject(w, m->normal);
	if (out_x == 0)
		turn = rb_vec3_add_scaled(turn, -rb_vec3_dot(turn, sheet.axis_x), sheet.axis_x);
	if (out_y == 0)
		turn = rb_vec3_add_scaled(turn, -rb_vec3_dot(turn, sheet.axis_y), sheet.axis_y);
	m->normal_rate = rb_vec3_scale(1 / (m->gap + radius), turn);
}

static meet_function *const meet_of[RB_SHAPE_KIND_COUNT] = {
	[RB_SHAPE_SPHERE] = meet_sphere,
	[RB_SHAPE_PLANE] = meet_plane,
	[RB_SHAPE_RECTANGLE] = meet_rectangle,
};

/* Arms, their rates and the velocity at the point, from gap, normal and its rate; a is the sphere. */
static void finish(const struct rb_located *l, struct rb_meet *m)
{
	const double radius = l->model->shape[m->a].radius;

	m->point = rb_vec3_add_scaled(m->pose_a.origin, radius, m->normal);
	const rb_vec3 point_rate = rb_vec3_add_scaled(origin_velocity(&m->pose_a), radius,
	                                              m->normal_rate);
	if (l->model->center_of_mass) {
		m->arm_a = rb_vec3_sub(m->point, m->pose_a.position);
		m->rate_a = rb_vec3_sub(point_rate, m->pose_a.velocity);
	} else {
		m->arm_a = rb_vec3_scale(radius, m->normal);
		m->rate_a = rb_vec3_scale(radius, m->normal_rate);
	}
	if (l->model->shape[m->b].kind == RB_SHAPE_SPHERE && !l->model->center_of_mass) {
		m->arm_b = rb_vec3_scale(-l->model->shape[m->b].radius, m->normal);
		m->rate_b = rb_vec3_scale(-l->model->shape[m->b].radius, m->normal_rate);
	} else {
		m->arm_b = rb_vec3_sub(m->point, m->pose_b.position);
		m->rate_b = rb_vec3_sub(point_rate, m->pose_b.velocity);
	}
	m->velocity = rb_vec3_sub(
		rb_vec3_add(m->pose_b.velocity, rb_vec3_cross(m->pose_b.spin, m->arm_b)),
		rb_vec3_add(m->pose_a.velocity, rb_vec3_cross(m->pose_a.spin, m->arm_a)));
}

static void swap(struct rb_meet *m)
{
	const struct rb_meet o = *m;

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

struct rb_meet rb_meet_at(const struct rb_located *l, int a, int b, double t)
{
	const struct rb_pose pose_a = rb_arc_pose(l, a, t), pose_b = rb_arc_pose(l, b, t);

	return rb_meet_poses(l, a, b, &pose_a, &pose_b);
}

struct rb_meet rb_meet_poses(const struct rb_located *l, int a, int b, const struct rb_pose *pose_a,
                             const struct rb_pose *pose_b)
{
	const bool swapped = l->model->shape[a].kind != RB_SHAPE_SPHERE;
	struct rb_meet m = {.a = swapped ? b : a,
	                    .b = swapped ? a : b,
	                    .pose_a = swapped ? *pose_b : *pose_a,
	                    .pose_b = swapped ? *pose_a : *pose_b};

	meet_of[l->model->shape[m.b].kind](l, &m);
	finish(l, &m);
	if (swapped)
		swap(&m);
	return m;
}

static double size_of(const struct rb_located *l, int i)
{
	return l->model->shape[i].kind == RB_SHAPE_SPHERE ? l->model->shape[i].radius : 0;
}

double rb_meet_size(const struct rb_located *l, const struct rb_meet *m)
{
	return fmax(size_of(l, m->a), size_of(l, m->b));
}

double rb_meet_band(const struct rb_located *l, const struct rb_meet *m, double t)
{
	double largest = rb_meet_size(l, m);

	/* of an infinite plane only the sphere's place matters: its own point may be anywhere */
	if (l->model->shape[m->a].kind == RB_SHAPE_SPHERE)
		largest = fmax(largest, rb_vec3_max_abs(m->pose_a.origin));
	if (l->model->shape[m->b].kind == RB_SHAPE_SPHERE)
		largest = fmax(largest, rb_vec3_max_abs(m->pose_b.origin));
	/* and the way that they make in the rounding of the time */
	return DBL_EPSILON *
	       (TOUCHING_ULP * largest + 2 * t * fabs(rb_vec3_dot(m->velocity, m->normal)));
}

double rb_meet_noise(const struct rb_located *l, const struct rb_meet *m)
{
	const double size = rb_meet_size(l, m);

	return 8 * DBL_EPSILON *
	       (rb_vec3_max_abs(m->pose_a.velocity) + rb_vec3_max_abs(m->pose_b.velocity) +
	        rb_vec3_max_abs(m->pose_a.spin) * rb_vec3_max_abs(m->arm_a) +
	        rb_vec3_max_abs(m->pose_b.spin) * rb_vec3_max_abs(m->arm_b) +
	        sqrt(2 * l->weight * size));
}

/* ---- when ---- */

static bool same_vector(rb_vec3 a, rb_vec3 b)
{
	return a.x == b.x && a.y == b.y && a.z == b.z;
}

/* Seconds until |d + w s| = sum while closing; INFINITY: never. */
static double linear_touch(rb_vec3 d, rb_vec3 w, double sum, double noise)
{
	const double b = rb_vec3_dot(d, w);

	if (!(b < 0))
		return HUGE_VAL;
	const double c = rb_vec3_dot(d, d) - sum * sum;
	const double square = rb_vec3_dot(w, w);
	if (c <= 0)
		return -b > noise * sum ? 0 : HUGE_VAL;
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
	/* what only rounding closes is no approach */
	return s * square < noise * sum && -b <= noise * sum ? HUGE_VAL : s;
}

/* Seconds until gap + rate s + acceleration s^2 / 2 = 0 while falling; INFINITY: never. */
static double quadratic_touch(double gap, double rate, double acceleration, double band,
                              double noise)
{
	const bool touching = gap <= band;

	if (touching && rate < -noise)
		return 0;
	if (touching && rate <= noise) { /* only the acceleration can bring them together */
		return acceleration < 0 ? 0 : HUGE_VAL;
	}
	if (touching) /* what rounding has left of its gap is no height to fall from */
		return acceleration < 0 ? -2 * rate / acceleration : HUGE_VAL;
	const double discriminant = rate * rate - 2 * acceleration * gap;
	if (rate < 0)
		return discriminant < 0 ? HUGE_VAL : 2 * gap / (sqrt(discriminant) - rate);
	if (!(acceleration < 0))
		return HUGE_VAL;
	return (rate + sqrt(discriminant)) / -acceleration;
}

/*
 * Seconds until two spheres touch that fly under different accelerations: |d + w s + a s^2/2|^2 - sum^2 is a quartic.
 * What is touching and neither closes nor opens beyond rounding starts from zero, so that only what follows counts.
 */
static double parabolic_touch(const rb_vec3 motion[3], double sum, double band, double noise,
                              double most)
{
	const rb_vec3 d = motion[0], w = motion[1], a = motion[2];
	const double length = rb_vec3_length(d), rate = rb_vec3_dot(d, w) / length;
	const bool touching = length - sum <= band;
	double c[5] = {(length - sum) * (length + sum), 2 * rb_vec3_dot(d, w),
	               rb_vec3_dot(w, w) + rb_vec3_dot(d, a), rb_vec3_dot(w, a),
	               0.25 * rb_vec3_dot(a, a)};
	const double bend = rb_vec3_dot(w, w) + length * rb_vec3_length(a);

	if (touching && rate < -noise)
		return 0;
	if (touching)
		c[0] = 0;
	if (touching && rate <= noise)
		c[1] = 0;
	if (touching && c[1] == 0 && fabs(c[2]) <= 64 * DBL_EPSILON * bend)
		c[2] = 0;
	if (touching && c[1] == 0 && c[2] < 0)
		return 0;
	return rb_quartic_falls(c, most);
}

/* Bound on the second derivative of a gap by the motion of this body, m/s^2. */
static double acceleration_most(const struct rb_located *l, int i, double distance)
{
	if (i >= l->n)
		return 0;
	double most;
	double turn = 0;

	if (rb_located_on_piece(l, i)) {
		const struct rb_piece_of *p = &l->piece[i];

		most = p->acceleration_most;
		if (l->top)
			for (int k = 0; k < 3; k++)
				turn += fabs(p->piece.start[p->first + RB_ROW_SPIN + k]) +
				        p->piece.length_s *
				                rb_gauss_rate_bound(&p->piece,
				                                    p->first + RB_ROW_SPIN + k);
	} else {
		most = rb_vec3_length(l->arc[i].acceleration);
		if (l->top) {
			/* a free top's spin is bounded through its angular momentum and the moments */
			const struct rb_top_body *body = &l->top_body[i];
			const double low = fmin(body->moments.x,
			                        fmin(body->moments.y, body->moments.z));
			const double high = rb_vec3_max_abs(body->moments);

			turn = rb_vec3_length(l->top[i].spin);
			if (body->kind != RB_TOP_CONSTANT && low > 0)
				turn *= high / low;
		}
	}
	const bool eccentric = l->model->center_of_mass != NULL;
	const bool flat = l->model->shape[i].kind != RB_SHAPE_SPHERE;
	if (eccentric && !flat)
		most += turn * turn * rb_vec3_length(l->model->center_of_mass[i]);
	if (flat && turn > 0) /* a face that turns sweeps with the distance */
		most += 2 * turn * turn * distance + 2 * turn * most;
	return most;
}

/* Second derivative of the gap now, for bodies that turn about their centres, m/s^2. */
static double bending(const struct rb_located *l, const struct rb_meet *m, double t)
{
	const rb_vec3 pull = rb_vec3_sub(rb_arc_acceleration(l, m->b, t),
	                                 rb_arc_acceleration(l, m->a, t));

	return rb_vec3_dot(pull, m->normal) + rb_vec3_dot(m->velocity, m->normal_rate);
}

static double advance(const struct rb_located *l, int a, int b, double from, double until,
                      bool *again)
{
	double t = from;

	*again = false;
	for (int step = 0; step < STEPS_MOST; step++) {
		const struct rb_meet m = rb_meet_at(l, a, b, t);
		const double band = rb_meet_band(l, &m, t), noise = rb_meet_noise(l, &m);
		const double rate = rb_vec3_dot(m.velocity, m.normal);
		const double apart = rb_vec3_length(rb_vec3_sub(m.pose_a.origin, m.pose_b.origin));
		const double most = acceleration_most(l, a, apart) + acceleration_most(l, b, apart);
		double h;

		if (m.gap <= band && rate < -noise)
			return t;
		if (m.gap <= band && rate <= noise) {
			if (bending(l, &m, t) < -64 * DBL_EPSILON * most && t > from)
				return t;
			if (!(most > 0))
				return HUGE_VAL;
			h = sqrt(band / most);
		} else {
			const double gap = m.gap <= band ? 0 : m.gap;
			const double root = sqrt(rate * rate + 2 * most * gap);

			/* the root of gap + rate h - most h^2 / 2, in the form that does not cancel */
			if (rate > 0)
				h = most > 0 ? (rate + root) / most : HUGE_VAL;
			else
				h = root > rate ? 2 * gap / (root - rate) : HUGE_VAL;
		}
		/* leaving a touch, until it turns back: not by the bound but by what pulls now */
		if (m.gap <= band && rate > noise && most > 0) {
			const double turns = rate / fmax(-bending(l, &m, t), DBL_MIN);

			h = fmax(h, fmin(turns, sqrt(band / most)));
		}
		h = fmax(h, 2 * DBL_EPSILON * t);
		if (!(t + h <= until))
			return HUGE_VAL;
		t += h;
	}
	*again = true;
	return t;
}

/* Of bodies in flight, in closed form. */
static bool in_flight(const struct rb_located *l, int i)
{
	return !rb_located_on_piece(l, i) && !l->model->center_of_mass;
}

double rb_meet_time(const struct rb_located *l, int a, int b, double from, double until,
                    bool *again)
{
	const struct rb_model *model = l->model;
	double s;

	*again = false;
	if (model->shape[a].kind != RB_SHAPE_SPHERE) {
		const int other = a;

		a = b;
		b = other;
	}
	if (!in_flight(l, a) || (b < l->n && !in_flight(l, b)))
		return advance(l, a, b, from, until, again);
	const rb_vec3 none = {0, 0, 0};
	const rb_vec3 acceleration_b = b < l->n ? l->arc[b].acceleration : none;
	const rb_vec3 va = rb_arc_velocity(l, a, from), vb = rb_arc_velocity(l, b, from);
	if (model->shape[b].kind == RB_SHAPE_SPHERE &&
	    !same_vector(l->arc[a].acceleration, acceleration_b)) {
		const struct rb_meet m = rb_meet_at(l, a, b, from);
		const rb_vec3 motion[3] = {rb_vec3_sub(m.pose_b.origin, m.pose_a.origin),
		                           rb_vec3_sub(vb, va),
		                           rb_vec3_sub(acceleration_b, l->arc[a].acceleration)};

		s = parabolic_touch(motion, model->shape[a].radius + model->shape[b].radius,
		                    rb_meet_band(l, &m, from), rb_meet_noise(l, &m), until - from);
	} else if (model->shape[b].kind == RB_SHAPE_SPHERE) {
		s = linear_touch(
			rb_vec3_sub(rb_arc_position(l, b, from), rb_arc_position(l, a, from)),
			rb_vec3_sub(vb, va), model->shape[a].radius + model->shape[b].radius,
			8 * DBL_EPSILON * (rb_vec3_max_abs(va) + rb_vec3_max_abs(vb)));
	} else if (model->shape[b].kind == RB_SHAPE_PLANE && b >= l->n) {
		const rb_vec3 n = l->plane_normal[b - l->n];
		const rb_vec3 x = rb_arc_position(l, a, from), v = rb_arc_velocity(l, a, from);
		const double rate = rb_vec3_dot(v, n);
		const double band = DBL_EPSILON * (TOUCHING_ULP * fmax(model->shape[a].radius,
		                                                       rb_vec3_max_abs(x)) +
		                                   2 * from * fabs(rate));

		s = quadratic_touch(rb_vec3_dot(rb_vec3_sub(x, model->position[b]), n) -
		                            model->shape[a].radius,
		                    rate, rb_vec3_dot(l->arc[a].acceleration, n), band,
		                    8 * DBL_EPSILON * rb_vec3_max_abs(v));
	} else {
		return advance(l, a, b, from, until, again);
	}
	return from + s <= until ? from + s : HUGE_VAL;
}
