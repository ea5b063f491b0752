/* SPDX-License-Identifier: MIT */
/*
 * The gap comes from geom/separation; the touching points are those that the outermost patches of
 * both bodies share, at the depth of the gap's own rounding. All work is done relative to a's
 * origin: differences of positions are formed once, so a pair far from the world's origin loses no
 * more digits than its positions have.
 */
#include "geom/convex.h"

#include <float.h>

#include "base/error.h"

/*
 * Mean of the shared points: symmetric bodies then touch on their plane of symmetry, and not at
 * whichever corner comes first.
 */
static void middle(const rb_overlay_point *point, int count, rb_vec3 *on_a, rb_vec3 *on_b)
{
	rb_vec3 a = {0, 0, 0}, b = {0, 0, 0};

	for (int i = 0; i < count; i++) {
		a = rb_vec3_add(a, point[i].on_a);
		b = rb_vec3_add(b, point[i].on_b);
	}
	*on_a = rb_vec3_scale(1.0 / count, a);
	*on_b = rb_vec3_scale(1.0 / count, b);
}

rb_convex_touch rb_convex_gap(const rb_placed *a, const rb_placed *b)
{
	RB_ASSERT_COSTLY(a->core->kind != RB_CORE_HALF_SPACE ||
	                 b->core->kind != RB_CORE_HALF_SPACE);

	const rb_placed near_a = {a->core, {0, 0, 0}, a->turn};
	const rb_placed near_b = {b->core, rb_vec3_sub(b->at, a->at), b->turn};
	const rb_separation s = rb_separation_of(&near_a, &near_b);
	RB_ASSERT_COSTLY(!(fabs(rb_vec3_dot(s.normal, s.normal) - 1) > 64 * DBL_EPSILON));
	const double ra = a->core->radius, rb = b->core->radius;
	rb_patch pa, pb;
	rb_overlay_point point[RB_OVERLAY_MAX];
	rb_vec3 on_a, on_b;

	rb_patch_of(&pa, &near_a, s.normal, s.noise, 0);
	rb_patch_of(&pb, &near_b, rb_vec3_neg(s.normal), s.noise, 0);
	const rb_overlay_def def = {s.normal, s.noise, s.noise, s.noise};
	const int count = rb_overlay(&pa, &pb, &def, point);
	/* patches that miss each other by rounding: the support point of one, and its foot */
	if (count > 0) {
		middle(point, count, &on_a, &on_b);
	} else if (b->core->kind != RB_CORE_HALF_SPACE) {
		on_b = rb_placed_support(&near_b, rb_vec3_neg(s.normal));
		on_a = rb_vec3_add_scaled(on_b, -s.gap, s.normal);
	} else {
		on_a = rb_placed_support(&near_a, s.normal);
		on_b = rb_vec3_add_scaled(on_a, s.gap, s.normal);
	}
	return (rb_convex_touch){
		.gap = s.gap - (ra + rb),
		.normal = s.normal,
		.on_a = rb_vec3_add(a->at, rb_vec3_add_scaled(on_a, ra, s.normal)),
		.on_b = rb_vec3_add(a->at, rb_vec3_add_scaled(on_b, -rb, s.normal)),
		.a = pa.feature,
		.b = pb.feature,
	};
}

double rb_convex_safe_time(double gap, double closing, double turning, double bend)
{
	const double speed = closing + fmax(turning, 0), tension = fmax(bend, 0);

	if (!(gap > 0))
		return 0;
	/* gap = speed t + tension t^2 / 2, the positive root written without cancellation */
	if (speed >= 0) {
		const double whole = speed + sqrt(speed * speed + 2 * tension * gap);
		return whole > 0 ? 2 * gap / whole : (double)INFINITY;
	}
	if (!(tension > 0))
		return isnan(speed) ? 0 : (double)INFINITY;
	return (sqrt(speed * speed + 2 * tension * gap) - speed) / tension;
}

double rb_convex_reach(const rb_core *core)
{
	if (core->kind == RB_CORE_HALF_SPACE)
		return (double)INFINITY;
	return core->reach + core->radius;
}

/*
 * Rounding of coordinates and of rotation, added outward, m: the box must contain the body. Two
 * products and two sums round a coordinate of a rotated vertex, hence 4 ulp.
 */
static double padding(const rb_placed *p, rb_vec3 at)
{
	return 4 * DBL_EPSILON * (rb_vec3_max_abs(at) + rb_convex_reach(p->core));
}

rb_aabb rb_convex_bounds(const rb_placed *p)
{
	const double huge = (double)INFINITY;
	const double r = p->core->radius;

	if (p->core->kind == RB_CORE_HALF_SPACE)
		return (rb_aabb){{-huge, -huge, -huge}, {huge, huge, huge}};
	const double pad = padding(p, p->at);
	const rb_vec3 up = {r + pad + rb_placed_height(p, (rb_vec3){1, 0, 0}),
	                    r + pad + rb_placed_height(p, (rb_vec3){0, 1, 0}),
	                    r + pad + rb_placed_height(p, (rb_vec3){0, 0, 1})};
	const rb_vec3 down = {r + pad + rb_placed_height(p, (rb_vec3){-1, 0, 0}),
	                      r + pad + rb_placed_height(p, (rb_vec3){0, -1, 0}),
	                      r + pad + rb_placed_height(p, (rb_vec3){0, 0, -1})};
	return (rb_aabb){rb_vec3_sub(p->at, down), rb_vec3_add(p->at, up)};
}

/* Extent along one axis: its present value grown by rotation, but never beyond the reach. */
static double grown(double now, double by, double reach)
{
	return fmin(now + by, fmax(reach, now));
}

rb_aabb rb_convex_swept_bounds(const rb_placed *p, rb_vec3 to, double angle)
{
	const rb_aabb box = rb_convex_bounds(p);

	if (p->core->kind == RB_CORE_HALF_SPACE)
		return box;
	/* The chord of the angle at the farthest point; pi and NaN give the full diameter. */
	const double by = 2 * p->core->reach * (angle < 3.1 ? sin(0.5 * fmax(angle, 0)) : 1);
	const double reach = rb_convex_reach(p->core) + padding(p, p->at) + padding(p, to);
	const rb_vec3 l = rb_vec3_sub(p->at, box.low), h = rb_vec3_sub(box.high, p->at);
	const rb_vec3 low = {grown(l.x, by, reach), grown(l.y, by, reach), grown(l.z, by, reach)};
	const rb_vec3 high = {grown(h.x, by, reach), grown(h.y, by, reach), grown(h.z, by, reach)};
	RB_ASSERT_COSTLY(!(low.x < 0 || low.y < 0 || low.z < 0));
	return (rb_aabb){{fmin(p->at.x, to.x) - low.x, fmin(p->at.y, to.y) - low.y,
	                  fmin(p->at.z, to.z) - low.z},
	                 {fmax(p->at.x, to.x) + high.x, fmax(p->at.y, to.y) + high.y,
	                  fmax(p->at.z, to.z) + high.z}};
}
