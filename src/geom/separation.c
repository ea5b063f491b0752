/* SPDX-License-Identifier: MIT */
/*
 * How the best direction is found. GJK's distance, where there is one, says which features can matter: those in a thin
 * slab across its direction. Their closed forms then give the answer, which has their digits and no trace of the way
 * that led to them.
 *
 * Near a touch the direction of a distance loses its digits (an ulp of the size over the gap), so there all faces
 * are tried first. Their best direction bounds where else to look: with n its normal, s its gap, and U a bound on the
 * size of the true gap g (U >= |g|, g >= s), the touching points p and p + g m have n.p + g n.m >= h + s, h the
 * height of a's outermost point, hence n.p >= h + s - U; likewise for b. Edges and corners below that are left out.
 */
#include "geom/separation.h"

#include <float.h>
#include <stddef.h>

#include "geom/gjk.h"
#include "geom/overlay.h"
#include "geom/rims.h"

/* Apart by more than this share of the sizes, the direction of a distance has 12 digits, enough to tell features. */
static const double far_share = 1e-4;
enum { NOISE_ULP = 16 };

static rb_separation of_half_space(const rb_placed *a, const rb_placed *b, double noise)
{
	const bool b_is = b->core->kind == RB_CORE_HALF_SPACE;
	const rb_placed *plane = b_is ? b : a, *body = b_is ? a : b;
	const rb_vec3 up = rb_placed_axis(plane), down = rb_vec3_neg(up);
	const double height = rb_vec3_dot(up, rb_vec3_sub(body->at, plane->at));

	return (rb_separation){b_is ? down : up, height - rb_placed_height(body, down), noise};
}

static bool has_faces(const rb_placed *p)
{
	return p->core->kind == RB_CORE_CYLINDER || p->core->polytope->face_count > 0;
}

/* What crosses the body's only edge, for cores without faces that lie in each other. */
static void try_across(rb_axis *axis, const rb_placed *p)
{
	const struct rb_polytope *polytope = p->core->polytope;
	rb_vec3 z = {0, 0, 1};

	if (polytope->edge_count > 0)
		z = rb_vec3_across(rb_placed_axis(p));
	rb_axis_try(axis, z);
	rb_axis_try(axis, rb_vec3_neg(z));
}

/* Deep in each other round cores have several best directions nearby; look from all sides. */
static void search_deep(rb_axis *axis, const rb_slab *slab)
{
	const double third = sqrt(1.0 / 3);
	const bool a_is = axis->a->core->kind == RB_CORE_CYLINDER;
	const rb_mat3 *turn = a_is ? &axis->a->turn : &axis->b->turn;

	for (int i = 0; i < 8; i++) {
		const rb_vec3 side = {i & 1 ? -third : third, i & 2 ? -third : third,
		                      i & 4 ? -third : third};
		rb_rims(axis, slab, rb_mat3_apply(turn, side));
	}
}

/*
 * Points that lie over each other along the best direction so far, apart by what it proves, leave nothing to be gained.
 * (Where they overlap by more than rounding, another direction may be better.)
 */
static bool settled(const rb_axis *axis)
{
	const double noise = 4 * axis->noise;
	const rb_overlay_def def = {axis->normal, axis->noise, axis->noise};
	rb_overlay_point point[RB_OVERLAY_MAX];
	rb_patch a, b;

	if (!(axis->gap >= -noise))
		return false;
	rb_patch_of(&a, axis->a, axis->normal, noise);
	rb_patch_of(&b, axis->b, rb_vec3_neg(axis->normal), noise);
	/* a point is taken to lie over whatever the other has, and segments to have a point */
	if (a.kind == RB_PATCH_POINT || b.kind == RB_PATCH_POINT ||
	    rb_overlay(&a, &b, &def, point) == 0)
		return false;
	const rb_vec3 way = rb_vec3_sub(point[0].on_b, point[0].on_a);
	return rb_vec3_length(way) <= axis->gap + 3 * noise;
}

static void search_near(rb_axis *axis, const rb_gjk *gjk, bool round, double scale)
{
	rb_slab slab = {gjk->normal, (double)INFINITY};

	rb_facets_faces(axis, NULL);
	if (axis->found && settled(axis))
		return;
	if (axis->found) {
		/* What lies far apart has been proved to; else a long distance is one from before they overlapped. */
		const double doubt = fabs(gjk->most - gjk->least);
		const double distance = gjk->most <= far_share * scale
		                                ? fmax(gjk->most, gjk->least) + doubt
		                                : 0;
		const double most = fmax(distance, fabs(axis->gap));
		slab = (rb_slab){axis->normal, most - axis->gap + 8 * axis->noise};
	}
	if (round) {
		rb_rims(axis, &slab, gjk->normal);
		if (!gjk->apart)
			rb_rims(axis, &slab, axis->normal);
		if (axis->gap < -far_share * scale)
			search_deep(axis, &slab);
		return;
	}
	rb_facets_edges(axis, &slab);
	if (gjk->apart || axis->gap > 0)
		rb_facets_corners(axis, &slab);
	if (!has_faces(axis->a) && !has_faces(axis->b) && !gjk->apart) {
		try_across(axis, axis->a);
		try_across(axis, axis->b);
	}
}

static void search_far(rb_axis *axis, const rb_gjk *gjk, bool round)
{
	/* of thin simplices on round cores the distance has lost digits: it may even lie below what is proved */
	const rb_slab slab = {gjk->normal, fabs(gjk->most - gjk->least) + 8 * axis->noise};

	rb_facets_faces(axis, &gjk->normal);
	if (round) {
		rb_rims(axis, &slab, gjk->normal);
		return;
	}
	rb_facets_edges(axis, &slab);
	rb_facets_corners(axis, &slab);
}

/* Two points: their distance needs no search. */
static bool both_points(const rb_placed *a, const rb_placed *b)
{
	return a->core->kind == RB_CORE_POLYTOPE && b->core->kind == RB_CORE_POLYTOPE &&
	       a->core->polytope->vertex_count == 1 && b->core->polytope->vertex_count == 1;
}

rb_separation rb_separation_of(const rb_placed *a, const rb_placed *b)
{
	const rb_vec3 d = rb_vec3_sub(b->at, a->at);
	const double distance = rb_vec3_length(d);
	const double scale = distance + a->core->reach + b->core->reach;
	const double noise = NOISE_ULP * DBL_EPSILON * scale;
	const bool round = a->core->kind == RB_CORE_CYLINDER || b->core->kind == RB_CORE_CYLINDER;

	if (a->core->kind == RB_CORE_HALF_SPACE || b->core->kind == RB_CORE_HALF_SPACE)
		return of_half_space(a, b, noise);
	if (both_points(a, b))
		return (rb_separation){rb_vec3_unit(d, (rb_vec3){0, 0, 1}), distance, noise};
	rb_axis axis = {.a = a, .b = b, .noise = 0.25 * noise, .gap = -(double)INFINITY};
	const rb_gjk gjk = rb_gjk_run(a, b, scale);
	if (gjk.apart && gjk.most > far_share * scale)
		search_far(&axis, &gjk, round);
	else
		search_near(&axis, &gjk, round, scale);
	if (gjk.least > -(double)INFINITY)
		rb_axis_try(&axis, gjk.normal);
	return (rb_separation){axis.normal, axis.gap, noise};
}

bool rb_separation_beyond(const rb_placed *a, const rb_placed *b, double limit, rb_vec3 *axis)
{
	const rb_vec3 d = rb_vec3_sub(b->at, a->at);
	/* the sum of the parts is no less than the length, and needs no root */
	const double scale = fabs(d.x) + fabs(d.y) + fabs(d.z) + a->core->reach + b->core->reach;
	const double noise = NOISE_ULP * DBL_EPSILON * scale;

	if (a->core->kind == RB_CORE_HALF_SPACE || b->core->kind == RB_CORE_HALF_SPACE)
		return of_half_space(a, b, noise).gap > limit + noise;
	return rb_gjk_beyond(a, b, limit + 2 * noise, axis);
}
