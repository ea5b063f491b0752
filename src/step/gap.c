/* SPDX-License-Identifier: MIT */
/*
 * Closed-form gaps of a sphere against sphere, plane and rectangle, by a table of the other's kind,
 * and the smallest gap along the straight path of a substep (continuous collision detection), so
 * that nothing tunnels. The worst violation of a group decides whether its substep is repeated with
 * a shorter one.
 */
#include "step/gap.h"

#include "base/error.h"
#include "geom/distance.h"

#include <float.h>

/* Gap of the sphere `a` at `center` against body b. */
typedef struct rb_gap gap_function(const struct rb_model *model, int a, rb_vec3 center, int b,
                                   rb_vec3 origin_b, rb_quat turn_b);
/* Smallest gap, m, while the sphere's centre moves straight from `from` to `to`, relative to b. */
typedef double swept_function(const struct rb_model *model, int a, rb_vec3 from, rb_vec3 to, int b,
                              rb_vec3 origin_b);

static struct rb_gap sphere_sphere(const struct rb_model *model, int a, rb_vec3 center, int b,
                                   rb_vec3 origin_b, rb_quat turn_b)
{
	const double radius = model->shape[a].radius;
	struct rb_gap g;

	(void)turn_b;
	g.gap = rb_distance_sphere_sphere(center, radius, origin_b, model->shape[b].radius,
	                                  &g.normal);
	g.point = rb_vec3_add_scaled(center, radius + 0.5 * g.gap, g.normal);
	return g;
}

static struct rb_gap sphere_plane(const struct rb_model *model, int a, rb_vec3 center, int b,
                                  rb_vec3 origin_b, rb_quat turn_b)
{
	const double radius = model->shape[a].radius;
	struct rb_gap g;

	(void)b;
	g.gap = rb_distance_sphere_plane(center, radius, origin_b, rb_plane_normal(turn_b),
	                                 &g.normal);
	g.point = rb_vec3_add_scaled(center, radius + 0.5 * g.gap, g.normal);
	return g;
}

static struct rb_gap sphere_rectangle(const struct rb_model *model, int a, rb_vec3 center, int b,
                                      rb_vec3 origin_b, rb_quat turn_b)
{
	const double radius = model->shape[a].radius;
	const rb_rectangle sheet = rb_rectangle_of(origin_b, turn_b, model->shape[b].size);
	struct rb_gap g;

	g.gap = rb_distance_sphere_rectangle(center, radius, &sheet, &g.normal, NULL);
	g.point = rb_vec3_add_scaled(center, radius + 0.5 * g.gap, g.normal);
	return g;
}

static gap_function *const gap_of[RB_SHAPE_KIND_COUNT] = {
	[RB_SHAPE_SPHERE] = sphere_sphere,
	[RB_SHAPE_PLANE] = sphere_plane,
	[RB_SHAPE_RECTANGLE] = sphere_rectangle,
};

/* Distance of a point to a segment, m. */
static double point_to_segment(rb_vec3 p, rb_vec3 from, rb_vec3 to)
{
	const rb_vec3 along = rb_vec3_sub(to, from);
	const double square = rb_vec3_dot(along, along);
	const double s = square > 0 ? rb_vec3_dot(rb_vec3_sub(p, from), along) / square : 0;

	return rb_vec3_length(rb_vec3_sub(p, rb_vec3_add_scaled(from, fmin(fmax(s, 0), 1), along)));
}

static double swept_sphere(const struct rb_model *model, int a, rb_vec3 from, rb_vec3 to, int b,
                           rb_vec3 origin_b)
{
	return point_to_segment(origin_b, from, to) -
	       (model->shape[a].radius + model->shape[b].radius);
}

/* A half space is deepest at an end of a straight path, and both ends are measured anyway. */
static double swept_plane(const struct rb_model *model, int a, rb_vec3 from, rb_vec3 to, int b,
                          rb_vec3 origin_b)
{
	(void)model, (void)a, (void)from, (void)to, (void)b, (void)origin_b;
	return HUGE_VAL;
}

/*
 * Distance of the path to the sheet. The distance to a convex set is convex along a line, so golden
 * section search finds its minimum; a path through the sheet is detected by the change of side.
 */
static double swept_rectangle(const struct rb_model *model, int a, rb_vec3 from, rb_vec3 to, int b,
                              rb_vec3 origin_b)
{
	const double radius = model->shape[a].radius;
	const rb_rectangle sheet = rb_rectangle_of(origin_b, model->orientation[b],
	                                           model->shape[b].size);
	const rb_vec3 along = rb_vec3_sub(to, from);
	const double side_from = rb_vec3_dot(rb_vec3_sub(from, sheet.center), sheet.normal);
	const double side_to = rb_vec3_dot(rb_vec3_sub(to, sheet.center), sheet.normal);
	rb_vec3 normal;
	double low = 0, high = 1;

	if ((side_from < 0) != (side_to < 0)) {
		const rb_vec3 through = rb_vec3_add_scaled(from, side_from / (side_from - side_to),
		                                           along);
		const rb_vec3 d = rb_vec3_sub(through, sheet.center);

		if (fabs(rb_vec3_dot(d, sheet.axis_x)) <= sheet.half_x &&
		    fabs(rb_vec3_dot(d, sheet.axis_y)) <= sheet.half_y)
			return -radius;
	} else if (fmin(fabs(side_from), fabs(side_to)) >= radius) {
		return fmin(fabs(side_from), fabs(side_to)) - radius;
	}
	/* 0.618^48 = 1e-10 of the path; 0.382 = 2 - golden ratio */
	for (int round = 0; round < 48; round++) {
		const double s = low + 0.381966011250105 * (high - low),
			     t = high - 0.381966011250105 * (high - low);
		const double at_s = rb_distance_sphere_rectangle(rb_vec3_add_scaled(from, s, along),
		                                                 radius, &sheet, &normal, NULL);
		const double at_t = rb_distance_sphere_rectangle(rb_vec3_add_scaled(from, t, along),
		                                                 radius, &sheet, &normal, NULL);
		if (at_s < at_t)
			high = t;
		else
			low = s;
	}
	return rb_distance_sphere_rectangle(rb_vec3_add_scaled(from, 0.5 * (low + high), along),
	                                    radius, &sheet, &normal, NULL);
}

static swept_function *const swept_of[RB_SHAPE_KIND_COUNT] = {
	[RB_SHAPE_SPHERE] = swept_sphere,
	[RB_SHAPE_PLANE] = swept_plane,
	[RB_SHAPE_RECTANGLE] = swept_rectangle,
};

struct rb_gap rb_gap_at(const struct rb_world *world, const struct rb_state *state, int a,
                        rb_vec3 center, int b)
{
	RB_ASSERT_COSTLY(gap_of[world->model->shape[b].kind]);
	RB_ASSERT_COSTLY(world->model->shape[a].kind == RB_SHAPE_SPHERE);

	return gap_of[world->model->shape[b].kind](world->model, a, center, b,
	                                           rb_world_origin_at(world, state, b),
	                                           rb_world_orientation_at(world, state, b));
}

struct rb_gap rb_gap_of(const struct rb_world *world, const struct rb_state *state, int a, int b)
{
	return rb_gap_at(world, state, a, rb_world_origin_at(world, state, a), b);
}

double rb_gap_band(const struct rb_world *world, const struct rb_state *state, int a, int b)
{
	const struct rb_model *model = world->model;
	double largest = fmax(model->shape[a].radius,
	                      rb_vec3_max_abs(rb_world_row3(state->position, a)));

	if (b < model->body_count || model->shape[b].kind == RB_SHAPE_SPHERE)
		largest = fmax(largest, model->shape[b].radius);
	return RB_TOUCHING_ULP * DBL_EPSILON *
	       fmax(largest, rb_vec3_max_abs(rb_world_origin_at(world, state, b)));
}

double rb_gap_radius(const struct rb_model *model, int a, int b)
{
	return model->shape[b].kind == RB_SHAPE_SPHERE
	               ? model->shape[a].radius + model->shape[b].radius
	               : HUGE_VAL;
}

/* Smallest gap allowed for this pair at the end of the substep, m (see step/gap.h). */
static double allowed(const struct rb_pass *pass, const struct rb_touch *touch, double gap_now)
{
	const double tolerance = pass->world->model->tolerance_m;

	if (touch->lasting)
		return -tolerance;
	return fmax(-tolerance, fmin(-0.5 * tolerance, gap_now - touch->band));
}

/* Turn in a substep, rad, beyond which the path of an eccentric body is too far from straight. */
static const double turn_max = 1;

/*
 * True if the bodies may have met on their arcs where the straight path shows nothing: a large turn
 * and a gap within reach of the arms between shape centre and centre of mass.
 */
static bool turns_too_far(const struct rb_pass *pass, const struct rb_touch *touch, double gap)
{
	const struct rb_world *world = pass->world;
	const struct rb_model *model = world->model;
	const int body[2] = {touch->a, touch->b};
	double arms = 0, turn = 0;

	if (!model->center_of_mass)
		return false;
	for (int k = 0; k < 2; k++) {
		if (body[k] >= model->body_count)
			continue;
		const double arm = rb_vec3_length(model->center_of_mass[body[k]]);

		if (!(arm > model->tolerance_m))
			continue;
		arms += arm;
		turn = fmax(turn,
		            pass->h_s * rb_vec3_length(rb_world_row3(world->state.spin, body[k])));
	}
	return turn > turn_max && gap < 2 * arms;
}

/* Gaps at the end of the substep and along it; the pair that violates its limit most. */
static void measure(struct rb_pass *pass)
{
	const struct rb_world *world = pass->world;
	double worst_excess = 0;

	for (int k = 0; k < pass->touch_count; k++) {
		const struct rb_touch *touch = &pass->touch[k];
		RB_ASSERT_COSTLY(touch->a >= 0 && touch->a < world->model->body_count);
		const double floor = allowed(pass, touch, pass->now[k].gap);
		double gap;

		pass->next[k] = rb_gap_of(world, &world->state, touch->a, touch->b);
		gap = pass->next[k].gap;
		if (gap >= floor && !touch->lasting) {
			/* relative to b at its final place */
			const rb_vec3 b_to = rb_world_origin_at(world, &world->state, touch->b);
			const rb_vec3 b_moved = rb_vec3_sub(
				b_to, rb_world_origin_at(world, &world->mark, touch->b));
			const rb_vec3 from = rb_vec3_add(
				rb_world_origin_at(world, &world->mark, touch->a), b_moved);
			const rb_vec3 to = rb_world_origin_at(world, &world->state, touch->a);

			gap = fmin(gap, swept_of[world->model->shape[touch->b].kind](
						world->model, touch->a, from, to, touch->b, b_to));
			if (turns_too_far(pass, touch, gap))
				gap = 2 * floor; /* try again with a smaller rotation */
		}
		/* NaN counts as the worst */
		if (!(floor - gap <= worst_excess)) {
			worst_excess = isnan(gap) ? HUGE_VAL : floor - gap;
			pass->worst = k;
			pass->worst_gap = gap;
		}
	}
}

const struct rb_stage rb_stage_gap = {"gap", "signed gaps of the pairs that may touch",
                                      RB_FEATURE_CONTACT, measure};
