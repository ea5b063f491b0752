/* SPDX-License-Identifier: MIT */
/*
 * The manifold is the intersection of the outermost patches of both bodies, seen along the normal:
 * no clipping against a reference face, which would depend on which body comes first. Of too many
 * points the extreme ones in equally spaced directions stay, since these support any wrench that
 * all of them support, nearly.
 *
 * With `fine`, the nearest points are added to those of a wide band: a disc that tilts touches on
 * its rim between the corners that the band has.
 */
#include "geom/manifold.h"

#include <stddef.h>

#include "base/error.h"
#include "geom/box_overlay.h"
#include "geom/boxes.h"

/*
 * Share of its reach by which a face may tilt and still be taken whole (about 1 mrad): the
 * outermost edge of a body nearly flush with another may lie past the other's border, and the
 * corners next to it then count.
 */
static const double tilt_share = 0x1p-10;
/* Places kept for the nearest points. */
enum { NEAREST_MAX = 4 };

/*
 * Keeps the farthest point in each of `max` equally spaced directions across n, the first one of
 * ties, in their order; returns their number.
 */
static int thin_out(rb_overlay_point *point, int count, int max, rb_vec3 n)
{
	const rb_vec3 x = rb_vec3_across(n), y = rb_vec3_cross(n, x);
	bool keep[RB_OVERLAY_MAX] = {false};
	int kept = 0;

	RB_ASSERT(count > 0 && count <= RB_OVERLAY_MAX && max > 0);
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

/* Keeps the points within `band` of the lowest, in their order. */
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

/* Working state: both bodies relative to a's origin, their separation, and the points found. */
typedef struct {
	rb_placed a, b;
	rb_separation s;
	double tilt; /* shares of their reaches by which faces may tilt and still be taken whole */
	double fine; /* m: of a gap */
	rb_overlay_point point[RB_OVERLAY_MAX];
	int count;
	bool boxes; /* both */
} find;

/* `known`: their separation; NULL: it is to be found. */
static void start(find *f, const rb_placed *a, const rb_placed *b, const rb_separation *known)
{
	f->a = (rb_placed){a->core, {0, 0, 0}, a->turn};
	f->b = (rb_placed){b->core, rb_vec3_sub(b->at, a->at), b->turn};
	f->s = known ? *known : rb_separation_of(&f->a, &f->b);
	f->tilt = 0;
	f->fine = (double)INFINITY;
	f->count = 0;
	f->boxes = rb_box_is(a) && rb_box_is(b) && a->core->radius == 0 && b->core->radius == 0;
}

/*
 * Points that both patches share: those no farther apart across the normal than the band, or, with
 * `round`, than a round surface may be past a border while the gap grows by no more than the band.
 */
static int corners_within(const find *f, double depth, double band, bool round,
                          rb_overlay_point point[RB_OVERLAY_MAX])
{
	const double tilt_a = f->tilt * f->a.core->reach, tilt_b = f->tilt * f->b.core->reach;
	/* as below, where nothing is round */
	const double gap = fmax(f->s.gap, 0);
	const rb_overlay_def sharp = {f->s.normal, band, sqrt(band * band + 2 * gap * band),
	                              fmax(f->fine, f->s.noise)};
	rb_patch pa, pb;

	if (f->boxes) {
		const int count = rb_box_overlay(&f->a, &f->b, depth,
		                                 (const double[2]){tilt_a, tilt_b}, &sharp, point);
		if (count >= 0)
			return count;
	}
	rb_patch_of(&pa, &f->a, f->s.normal, depth, tilt_a);
	rb_patch_of(&pb, &f->b, rb_vec3_neg(f->s.normal), depth, tilt_b);
	/*
	 * Two parallel lines whose centres of curvature are a distance d apart are x^2 / 2d farther
	 * apart when displaced by x.
	 */
	const double curve = fmax(f->s.gap, 0) + pa.curve + pb.curve;
	const double along = sqrt(band * band + 2 * curve * band);
	/* sharp edges have no such tolerance: radii are those of curvature alone */
	const double radii = pa.curve + pb.curve + f->a.core->radius + f->b.core->radius;
	double aside = round ? sqrt(band * band + 2 * radii * band) : band;
	/*
	 * beside the line of a round side the gap is larger than it looks from there, and wide
	 * bands are wider than the side: corners count that are as good as on the line
	 */
	if (!round && radii > 0 && (pa.kind == RB_PATCH_SEGMENT || pb.kind == RB_PATCH_SEGMENT))
		aside = fmin(aside, fmax(sqrt(2 * radii * f->fine), f->s.noise));
	const rb_overlay_def def = {f->s.normal, aside, along, fmax(f->fine, f->s.noise)};
	return rb_overlay(&pa, &pb, &def, point);
}

/*
 * Corners within the band. Several directions may prove the gap to rounding, and the one chosen
 * need not be the one along which the bodies lie over each other; the patches then meet at larger
 * depths, which are tried in powers of 16 up to the bodies' sizes.
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

/* Appends the points of the patches at the depth of rounding. */
static void add_nearest(find *f)
{
	rb_overlay_point point[RB_OVERLAY_MAX];
	const int count = corners(f, f->s.noise, point);

	for (int i = 0; i < count && f->count < RB_MANIFOLD_MAX; i++)
		f->point[f->count++] = point[i];
}

/* Smallest gap of the points found, between the cores, m. */
static double least_gap(const find *f)
{
	double least = (double)INFINITY;

	for (int i = 0; i < f->count; i++)
		least = fmin(least, f->point[i].gap);
	return least;
}

/*
 * Finds the points within `depth`; with a finite `fine` also the nearest ones, if none of the
 * corners is as low as the gap.
 */
static void search(find *f, double depth, double fine)
{
	const bool only_corners = isinf(fine);
	const int max = RB_MANIFOLD_MAX - (only_corners ? 0 : NEAREST_MAX);

	f->tilt = only_corners ? 0 : tilt_share;
	f->fine = fine;
	f->count = corners(f, depth, f->point);
	if (f->count > max)
		f->count = thin_out(f->point, f->count, max, f->s.normal);
	if (!only_corners && least_gap(f) > f->s.gap + fmax(fine, f->s.noise))
		add_nearest(f);
	RB_ASSERT(f->count <= RB_MANIFOLD_MAX);
}

/* Points of what is found to be their separation, in f. */
static void take(rb_manifold *manifold, find *f, const rb_placed *a, const rb_placed *b)
{
	const double ra = a->core->radius, rb = b->core->radius;

	manifold->count = f->count;
	for (int i = 0; i < f->count; i++) {
		const rb_overlay_point *p = &f->point[i];
		const rb_vec3 on_a = rb_vec3_add_scaled(p->on_a, ra, f->s.normal);
		const rb_vec3 on_b = rb_vec3_add_scaled(p->on_b, -rb, f->s.normal);

		manifold->point[i] = (rb_manifold_point){
			rb_vec3_add(a->at, on_a), rb_vec3_add(a->at, on_b), p->gap - (ra + rb),
			(uint64_t)p->a << 32 | p->b};
	}
}

static void find_points(rb_manifold *manifold, find *f, const rb_placed *a, const rb_placed *b,
                        double band, double fine)
{
	manifold->normal = f->s.normal;
	manifold->gap = f->s.gap - (a->core->radius + b->core->radius);
	manifold->faces = f->s.faces + f->s.noise - (a->core->radius + b->core->radius);
	search(f, fmax(band, f->s.noise), fine);
	take(manifold, f, a, b);
	if (f->count > 0)
		return;
	/* The patches miss each other by rounding: the gap's own points. */
	const rb_convex_touch touch = rb_convex_gap(a, b);
	manifold->count = 1;
	manifold->point[0] = (rb_manifold_point){touch.on_a, touch.on_b, touch.gap,
	                                         (uint64_t)touch.a << 32 | touch.b};
}

void rb_manifold_from(rb_manifold *manifold, const rb_placed *a, const rb_placed *b,
                      const rb_separation *separation, double band, double fine)
{
	RB_ASSERT_COSTLY(!(band < 0) && !(fine < 0));

	/* not initialised: clearing the points would cost more than all else here */
	find f;

	start(&f, a, b, separation);
	find_points(manifold, &f, a, b, band, fine);
}

void rb_manifold_with_nearest(rb_manifold *manifold, const rb_placed *a, const rb_placed *b,
                              double band, double fine, double max)
{
	RB_ASSERT_COSTLY(!(band < 0) && !(fine < 0));

	find f;

	start(&f, a, b, NULL);
	manifold->normal = f.s.normal;
	manifold->gap = f.s.gap - (a->core->radius + b->core->radius);
	manifold->faces = f.s.faces + f.s.noise - (a->core->radius + b->core->radius);
	manifold->count = 0;
	if (!(manifold->gap > max))
		find_points(manifold, &f, a, b, band, fine);
}

void rb_manifold_along(rb_manifold *manifold, const rb_placed *a, const rb_placed *b,
                       rb_vec3 normal, double band)
{
	find f;

	start(&f, a, b, NULL);
	f.s.normal = normal;
	f.s.gap = rb_vec3_dot(normal, f.b.at) - rb_placed_height(&f.a, normal) -
	          rb_placed_height(&f.b, rb_vec3_neg(normal));
	manifold->normal = normal;
	manifold->gap = f.s.gap - (a->core->radius + b->core->radius);
	manifold->faces = (double)INFINITY;
	search(&f, fmax(band, f.s.noise), (double)INFINITY);
	take(manifold, &f, a, b);
}

void rb_manifold_of(rb_manifold *manifold, const rb_placed *a, const rb_placed *b, double band)
{
	rb_manifold_with_nearest(manifold, a, b, band, (double)INFINITY, (double)INFINITY);
}
