/* SPDX-License-Identifier: MIT */
#include "geom/manifold.h"

/*
 * Of its reach, by which a face may tilt and still be taken whole: of bodies that are nearly flush,
 * the outermost edge of one may lie past the border of the other, and the corners next to it on
 * their borders count.
 */
static const double tilt_share = 0x1p-10;
/* Room for the nearest points. */
enum { NEAREST_MAX = 4 };

/*
 * Of many points, the farthest in each of so many directions of the plane across n; the first of
 * several.
 */
static int thin_out(rb_overlay_point *point, int count, int max, rb_vec3 n)
{
	const rb_vec3 x = rb_vec3_across(n), y = rb_vec3_cross(n, x);
	bool keep[RB_OVERLAY_MAX] = {false};
	int kept = 0;

	for (int k = 0; k < max; k++) {
		const double angle = 6.283185307179586 * k / max;
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

/* Two bodies near the origin, how they stand, and what has been found. */
typedef struct {
	rb_placed a, b;
	rb_separation s;
	double tilt; /* shares of their reaches by which faces may tilt and still be taken whole */
	rb_overlay_point point[RB_OVERLAY_MAX];
	int count;
} find;

static void start(find *f, const rb_placed *a, const rb_placed *b)
{
	f->a = (rb_placed){a->core, {0, 0, 0}, a->turn};
	f->b = (rb_placed){b->core, rb_vec3_sub(b->at, a->at), b->turn};
	f->s = rb_separation_of(&f->a, &f->b);
	f->tilt = 0;
	f->count = 0;
}

/*
 * Points lie over each other that are no farther apart across the normal than the band; or,
 * `round`, than what is round may be past a border without the gap's being larger by more than
 * that.
 */
static int corners_within(const find *f, double depth, double band, bool round,
                          rb_overlay_point point[RB_OVERLAY_MAX])
{
	const double tilt_a = f->tilt * f->a.core->reach, tilt_b = f->tilt * f->b.core->reach;
	rb_patch pa, pb;

	rb_patch_of(&pa, &f->a, f->s.normal, depth, tilt_a);
	rb_patch_of(&pb, &f->b, rb_vec3_neg(f->s.normal), depth, tilt_b);
	/*
	 * two lines a distance d of their centres of curvature apart are farther by x^2 / 2d where
	 * they are off by x
	 */
	const double curve = fmax(f->s.gap, 0) + pa.curve + pb.curve;
	const double along = sqrt(band * band + 2 * curve * band);
	/* what is sharp ends where it ends */
	const double radii = pa.curve + pb.curve + f->a.core->radius + f->b.core->radius;
	const double aside = round ? sqrt(band * band + 2 * radii * band) : band;
	const rb_overlay_def def = {f->s.normal, aside, along};
	return rb_overlay(&pa, &pb, &def, point);
}

/*
 * Directions that prove as much to rounding may be off from the one along which the bodies lie over
 * each other; then what they share lies deeper.
 */
static int corners(const find *f, double band, rb_overlay_point point[RB_OVERLAY_MAX])
{
	const double max = f->a.core->reach + f->b.core->reach;
	int count = corners_within(f, band, band, false, point);

	if (count == 0)
		count = corners_within(f, band, band, true, point);
	for (double depth = 16 * band; count == 0 && depth < max; depth *= 16)
		count = corners_within(f, depth, band, false, point);
	return lowest(point, count, band);
}

/* Of what lies no deeper than rounding, after the others. */
static void add_nearest(find *f)
{
	rb_overlay_point point[RB_OVERLAY_MAX];
	const int count = corners(f, f->s.noise, point);

	for (int i = 0; i < count && f->count < RB_MANIFOLD_MAX; i++)
		f->point[f->count++] = point[i];
}

static double least_gap(const find *f)
{
	double least = (double)INFINITY;

	for (int i = 0; i < f->count; i++)
		least = fmin(least, f->point[i].gap);
	return least;
}

static void search(find *f, double depth, double fine)
{
	const bool only_corners = isinf(fine);
	const int max = RB_MANIFOLD_MAX - (only_corners ? 0 : NEAREST_MAX);

	f->tilt = only_corners ? 0 : tilt_share;
	f->count = corners(f, depth, f->point);
	if (f->count > max)
		f->count = thin_out(f->point, f->count, max, f->s.normal);
	if (!only_corners && least_gap(f) > f->s.gap + fmax(fine, f->s.noise))
		add_nearest(f);
}

void rb_manifold_with_nearest(rb_manifold *manifold, const rb_placed *a, const rb_placed *b,
                              double band, double fine)
{
	/*
	 * its points as far as `count` says: the rest would cost more to clear than all else here
	 */
	find f;
	const double ra = a->core->radius, rb = b->core->radius;

	start(&f, a, b);
	search(&f, fmax(band, f.s.noise), fine);
	manifold->normal = f.s.normal;
	manifold->gap = f.s.gap - (ra + rb);
	manifold->count = f.count;
	for (int i = 0; i < f.count; i++) {
		const rb_overlay_point *p = &f.point[i];
		const rb_vec3 on_a = rb_vec3_add_scaled(p->on_a, ra, f.s.normal);
		const rb_vec3 on_b = rb_vec3_add_scaled(p->on_b, -rb, f.s.normal);

		manifold->point[i] = (rb_manifold_point){
			rb_vec3_add(a->at, on_a), rb_vec3_add(a->at, on_b), p->gap - (ra + rb),
			(uint64_t)p->a << 32 | p->b};
	}
	if (f.count > 0)
		return;
	/* The patches miss each other by rounding. */
	const rb_convex_touch touch = rb_convex_gap(a, b);
	manifold->count = 1;
	manifold->point[0] = (rb_manifold_point){touch.on_a, touch.on_b, touch.gap,
	                                         (uint64_t)touch.a << 32 | touch.b};
}

void rb_manifold_of(rb_manifold *manifold, const rb_placed *a, const rb_placed *b, double band)
{
	rb_manifold_with_nearest(manifold, a, b, band, (double)INFINITY);
}
