/* SPDX-License-Identifier: MIT */
/*
 * The next change of a cluster on parabolas, in closed form: the end of a slip, a body leaving a
 * rectangle, drift out of the touching band. Clusters on pieces change at the end of their piece,
 * where mode_checks has cut it.
 */
#include "located/transition.h"

#include "base/error.h"
#include "located/event_set.h"
#include "geom/distance.h"

/* Seconds until x + v s + a s^2 / 2 leaves [-half, half], outward; INFINITY: never. */
static double leaves(double x, double v, double a, double half)
{
	double first = HUGE_VAL;

	for (int side = -1; side <= 1; side += 2) {
		const double clearance = half - side * x; /* >= 0 inside */
		const double speed = side * v, external = side * a;
		const double root = speed * speed + 2 * external * clearance;

		/*
		 * outward through the edge: clearance = speed s + external s^2 / 2 with speed +
		 * external s > 0
		 */
		if (clearance <= 0 && (speed > 0 || (speed == 0 && external > 0)))
			return 0;
		if (root < 0 || (speed <= 0 && external <= 0))
			continue;
		const double s = speed >= 0 ? 2 * clearance / (speed + sqrt(root))
		                            : (sqrt(root) - speed) / external;
		first = fmin(first, s);
	}
	return first;
}

/* Seconds until the body leaves the rectangle it lies on. */
static double leaves_face(const struct rb_located *l, const struct rb_held *held)
{
	const struct rb_arc *arc = &l->arc[held->a];
	const rb_rectangle sheet = rb_rectangle_of(l->model->position[held->b],
	                                           l->model->orientation[held->b],
	                                           l->model->shape[held->b].size);
	const rb_vec3 d = rb_vec3_sub(arc->position, sheet.center);

	return fmin(leaves(rb_vec3_dot(d, sheet.axis_x), rb_vec3_dot(arc->velocity, sheet.axis_x),
	                   rb_vec3_dot(arc->acceleration, sheet.axis_x), sheet.half_x),
	            leaves(rb_vec3_dot(d, sheet.axis_y), rb_vec3_dot(arc->velocity, sheet.axis_y),
	                   rb_vec3_dot(arc->acceleration, sheet.axis_y), sheet.half_y));
}

/* Seconds in which rounding may take a body out of a plane's touching band. */
static double keeps_in_band(const struct rb_located *l, const struct rb_held *held, double t)
{
	const struct rb_contact_point m = rb_event_set_contact_point(l, held, t);
	const rb_vec3 a = l->arc[held->a].acceleration, v = l->arc[held->a].velocity;
	const double band = 0.5 * rb_contact_point_band(l, &m, t);
	const double drift = fabs(rb_vec3_dot(v, m.normal)),
		     external = fabs(rb_vec3_dot(a, m.normal));

	if (drift == 0 && external == 0)
		return HUGE_VAL;
	return 2 * band / (drift + sqrt(drift * drift + 2 * external * band));
}

/* Seconds until the slip ends under constant accelerations. */
static double slip_ends(const struct rb_located *l, const struct rb_held *held, double t)
{
	const struct rb_contact_point m = rb_event_set_contact_point(l, held, t);
	const struct rb_arc *arc = &l->arc[held->a];
	const rb_vec3 turning = l->top ? l->top[held->a].acceleration : (rb_vec3){0, 0, 0};
	const rb_vec3 rate = rb_vec3_neg(
		rb_vec3_add(arc->acceleration, rb_vec3_cross(turning, m.arm_a)));
	const double along = rb_vec3_dot(rate, held->slip);

	return along < 0 ? rb_vec3_dot(m.velocity, held->slip) / -along : HUGE_VAL;
}

double rb_transition_next(const struct rb_located *l, int cluster)
{
	const struct rb_cluster *c = &l->cluster[cluster];
	double next = HUGE_VAL;

	RB_ASSERT(cluster >= 0 && cluster < l->cluster_count && l->cluster[cluster].used);
	if (c->has_jumped)
		return c->anchor_s;
	for (int k = 0; k < c->held_count; k++)
		if (c->held[k].recorded_s > c->anchor_s)
			next = fmin(next, c->held[k].recorded_s);
	if (c->integrated) /* no memory for pieces: l->status */
		return l->piece ? fmin(next, l->piece[c->member[0]].until_s) : next;
	for (int k = 0; k < c->held_count && !c->at_rest; k++) {
		const struct rb_held *held = &c->held[k];
		double s = keeps_in_band(l, held, c->anchor_s);

		if (held->slipping && held->friction > 0)
			s = fmin(s, slip_ends(l, held, c->anchor_s));
		if (l->model->shape[held->b].kind == RB_SHAPE_RECTANGLE)
			s = fmin(s, leaves_face(l, held));
		next = fmin(next, c->anchor_s + s);
	}
	return next;
}
