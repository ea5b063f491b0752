/* SPDX-License-Identifier: MIT */
#include "geom/manifold.h"

/* Of many points, the farthest in each of sixteen directions of the plane across n; the first of several. */
static int thin_out(rb_overlay_point *point, int count, rb_vec3 n)
{
	const rb_vec3 x = rb_vec3_across(n), y = rb_vec3_cross(n, x);
	bool keep[RB_OVERLAY_MAX] = {false};
	int kept = 0;

	for (int k = 0; k < RB_MANIFOLD_MAX; k++) {
		const double angle = 6.283185307179586 * k / RB_MANIFOLD_MAX;
		const rb_vec3 way = rb_vec3_add_scaled(rb_vec3_scale(cos(angle), x), sin(angle), y);
		int best = 0;
		for (int i = 1; i < count; i++)
			if (rb_vec3_dot(way, point[i].on_a) > rb_vec3_dot(way, point[best].on_a))
				best = i;
		keep[best] = true;
	}
	for (int i = 0; i < count; i++)
		if (keep[i])
			point[kept++] = point[i];
	return kept;
}

/* Only those within the band of the lowest. */
static int lowest(rb_overlay_point *point, int count, double band)
{
	double least = (double)INFINITY;
	int kept = 0;

	for (int i = 0; i < count; i++)
		least = fmin(least, point[i].gap);
	for (int i = 0; i < count; i++)
		if (point[i].gap <= least + band)
			point[kept++] = point[i];
	return kept;
}

void rb_manifold_of(rb_manifold *manifold, const rb_placed *a, const rb_placed *b, double band)
{
	const rb_placed near_a = {a->core, {0, 0, 0}, a->turn};
	const rb_placed near_b = {b->core, rb_vec3_sub(b->at, a->at), b->turn};
	const rb_separation s = rb_separation_of(&near_a, &near_b);
	const double ra = a->core->radius, rb = b->core->radius;
	const double depth = fmax(band, s.noise);
	rb_overlay_point point[RB_OVERLAY_MAX];
	rb_patch pa, pb;

	rb_patch_of(&pa, &near_a, s.normal, depth);
	rb_patch_of(&pb, &near_b, rb_vec3_neg(s.normal), depth);
	/* two lines a distance d of their centres of curvature apart are farther by x^2 / 2d where they are off by x */
	const double curve = fmax(s.gap, 0) + pa.curve + pb.curve;
	const rb_overlay_def def = {s.normal, depth, sqrt(depth * depth + 2 * curve * depth)};
	int count = lowest(point, rb_overlay(&pa, &pb, &def, point), depth);
	if (count > RB_MANIFOLD_MAX)
		count = thin_out(point, count, s.normal);
	manifold->normal = s.normal;
	manifold->gap = s.gap - (ra + rb);
	manifold->count = count;
	for (int i = 0; i < count; i++) {
		const rb_vec3 on_a = rb_vec3_add_scaled(point[i].on_a, ra, s.normal);
		const rb_vec3 on_b = rb_vec3_add_scaled(point[i].on_b, -rb, s.normal);
		manifold->point[i] = (rb_manifold_point){
			rb_vec3_add(a->at, on_a), rb_vec3_add(a->at, on_b),
			point[i].gap - (ra + rb), (uint64_t)point[i].a << 32 | point[i].b};
	}
	if (count > 0)
		return;
	/* The patches miss each other by rounding. */
	const rb_convex_touch touch = rb_convex_gap(a, b);
	manifold->count = 1;
	manifold->point[0] = (rb_manifold_point){touch.on_a, touch.on_b, touch.gap,
	                                         (uint64_t)touch.a << 32 | touch.b};
}
