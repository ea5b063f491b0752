/* SPDX-License-Identifier: MIT */
/*
 * How the best direction is found. All faces first: mostly the best of them is seen to be the best
 * of all. Else GJK's distance, where there is one, says which features can matter: those in a thin
 * slab across its direction. Their closed forms then give the answer, which has their digits and no
 * trace of the way that led to them.
 *
 * Near a touch the direction of a distance loses its digits (an ulp of the size over the gap).
 * There the best of the faces bounds where else to look: with n its normal, s its gap, and U a
 * bound on the size of the true gap g (U >= |g|, g >= s), the touching points p and p + g m have
 * n.p + g n.m >= h + s, h the height of a's outermost point, hence n.p >= h + s - U; likewise for
 * b. Edges and corners below that are left out.
 */
#include "geom/separation.h"

#include <float.h>
#include <stddef.h>

#include "base/error.h"
#include "geom/boxes.h"
#include "geom/gjk.h"
#include "geom/patch_overlap.h"
#include "geom/rims.h"

/*
 * Share of the sizes beyond which the direction of a distance has 12 correct digits (an ulp over
 * 1e-4), enough to tell which features it lies on.
 */
static const double far_share = 1e-4;
/*
 * Rounding of a gap in ulp of sizes and distance: two transformed vertices, each of some five
 * operations, and a dot product. Faces of equal gap that are examined: a box has three at a corner.
 */
enum { NOISE_ULP = 16, TIES_MAX = 6 };
/*
 * With more faces, only those along GJK's direction are tried if there is one; affects the cost
 * only.
 */
enum { FEW_FACES = 32 };
/*
 * Pairs of edges, and of corners with edges, that cost no more to try than a distance costs to
 * find; affects the cost only.
 */
enum { FEW_PAIRS = 96 };

/* Closed form: the height of the body's lowest point above the plane. */
static rb_separation of_half_space(const rb_placed *a, const rb_placed *b, double noise)
{
	const bool b_is = b->core->kind == RB_CORE_HALF_SPACE;
	const rb_placed *plane = b_is ? b : a, *body = b_is ? a : b;
	const rb_vec3 up = rb_placed_axis(plane), down = rb_vec3_neg(up);
	const double height = rb_vec3_dot(up, rb_vec3_sub(body->at, plane->at));

	return (rb_separation){b_is ? down : up, height - rb_placed_height(body, down), noise,
	                       (double)INFINITY};
}

static int face_count(const rb_placed *p)
{
	return p->core->kind == RB_CORE_CYLINDER ? 2 : p->core->polytope->face_count;
}

static bool has_faces(const rb_placed *p)
{
	return face_count(p) > 0;
}

/* Tries directions across the body's only edge, for overlapping cores without faces. */
static void try_across(rb_axis *axis, const rb_placed *p)
{
	const struct rb_polytope *polytope = p->core->polytope;
	rb_vec3 z = {0, 0, 1};

	if (polytope->edge_count > 0)
		z = rb_vec3_across(rb_placed_axis(p));
	rb_axis_try(axis, z);
	rb_axis_try(axis, rb_vec3_neg(z));
}

/* Deeply overlapping round cores have several local maxima: starts from the eight octants. */
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

static rb_vec3 middle_of(const rb_patch *patch)
{
	rb_vec3 sum = patch->point[0];

	for (int i = 1; i < patch->count; i++)
		sum = rb_vec3_add(sum, patch->point[i]);
	return rb_vec3_scale(1.0 / patch->count, sum);
}

/*
 * Depth within a border, m, of a point that both patches share along n: the middle of either patch
 * or of their intersection. Negative where none is found.
 */
static double shared_margin(const rb_axis *axis, const rb_patch *a, const rb_patch *b)
{
	const rb_vec3 n = axis->normal;
	const rb_overlay_def def = {n, axis->noise, axis->noise, axis->noise};
	rb_overlay_point point[RB_OVERLAY_MAX];
	rb_vec3 sum = {0, 0, 0};
	double margin = rb_overlay_margin(a, middle_of(b), n);

	if (margin < 0)
		margin = rb_overlay_margin(b, middle_of(a), n);
	if (margin >= 0 || a->kind == RB_PATCH_POINT || b->kind == RB_PATCH_POINT)
		return margin;
	const int count = rb_overlay(a, b, &def, point);
	const rb_vec3 way = rb_vec3_sub(point[0].on_b, point[0].on_a);
	/* shared points must be as far apart as the gap: else the patches only pass each other */
	if (count == 0 || rb_vec3_length(way) > fabs(axis->gap) + 12 * axis->noise)
		return -1;
	for (int i = 0; i < count; i++)
		sum = rb_vec3_add(sum, point[i].on_b);
	sum = rb_vec3_scale(1.0 / count, sum);
	margin = fmax(rb_overlay_margin(a, sum, n), rb_overlay_margin(b, sum, n));
	/* it may lie on a border to rounding */
	return fmax(margin, 0);
}

/* m: from a point to a patch that is a point or a segment. */
static double way_to(rb_vec3 point, const rb_patch *patch)
{
	const rb_vec3 first = patch->point[0], way = rb_vec3_sub(point, first);

	if (patch->kind == RB_PATCH_POINT)
		return rb_vec3_length(way);
	const rb_vec3 along = rb_vec3_sub(patch->point[1], first);
	const double whole = rb_vec3_dot(along, along), t = rb_vec3_dot(way, along);
	const double share = whole > 0 ? fmin(fmax(t / whole, 0), 1) : 0;

	return rb_vec3_length(rb_vec3_add_scaled(way, -share, along));
}

/* Whether two segments lie over each other across both: they are as far apart as their lines. */
static bool crosses(const rb_patch *a, const rb_patch *b)
{
	const rb_vec3 d = rb_vec3_sub(a->point[1], a->point[0]);
	const rb_vec3 e = rb_vec3_sub(b->point[1], b->point[0]);
	const rb_vec3 r = rb_vec3_sub(b->point[0], a->point[0]), n = rb_vec3_cross(d, e);
	const double whole = rb_vec3_dot(n, n);
	const double s = rb_vec3_dot(rb_vec3_cross(r, e), n);
	const double t = rb_vec3_dot(rb_vec3_cross(r, d), n);

	return whole > 0 && s >= 0 && s <= whole && t >= 0 && t <= whole;
}

/*
 * Whether a point of what is outermost of one body is no farther from that of the other than the
 * gap: no direction proves more. False where that is not seen.
 */
static bool is_proved(const rb_axis *axis)
{
	const double depth = 4 * axis->noise, max = axis->gap + 12 * axis->noise;
	rb_patch a, b;

	rb_patch_of(&a, axis->a, axis->normal, depth, 0);
	rb_patch_of(&b, axis->b, rb_vec3_neg(axis->normal), depth, 0);
	if (a.kind > RB_PATCH_SEGMENT || b.kind > RB_PATCH_SEGMENT)
		return false;
	if (a.kind == RB_PATCH_SEGMENT && b.kind == RB_PATCH_SEGMENT && crosses(&a, &b))
		return true;
	for (int i = 0; i < a.count; i++)
		if (way_to(a.point[i], &b) <= max)
			return true;
	for (int i = 0; i < b.count; i++)
		if (way_to(b.point[i], &a) <= max)
			return true;
	return false;
}

typedef enum { NOTHING_SHARED, SHARED, BEST } proof;

/*
 * Decides whether any direction can prove more than the best face so far. Apart: none can if points
 * lie over each other along it. Overlapping by d: the Minkowski difference b - a has, across the
 * normal n, a disc of radius r at depth d, where r is how far a point of one body lies within the
 * border of the other's face; and a point higher by D, the extent of both bodies along n, and aside
 * by at most S. Along cos(t) n + sin(t) w the disc proves no more than -d cos(t) - r sin(t), which
 * is at most -d while d tan(t / 2) <= r; for the rest, within 2 d / r of -n, the other point proves
 * no more than -(D - d) cos(2 d / r) + S 2 d / r.
 */
static proof proof_of(const rb_axis *axis)
{
	const double depth = 4 * axis->noise, d = -axis->gap;
	const rb_vec3 n = axis->normal, m = rb_vec3_neg(n);
	rb_patch a, b;

	rb_patch_of(&a, axis->a, n, depth, 0);
	rb_patch_of(&b, axis->b, m, depth, 0);
	const double margin = shared_margin(axis, &a, &b);
	if (margin < 0)
		return NOTHING_SHARED;
	if (d <= depth)
		return BEST;
	/* the bound below needs 2 d / r <= 1/2, where the cosine is above 0.87 */
	if (!(margin >= 4 * d))
		return SHARED;
	const double extent = rb_placed_height(axis->a, n) + rb_placed_height(axis->a, m) +
	                      rb_placed_height(axis->b, n) + rb_placed_height(axis->b, m);
	const double aside = 2 * (axis->a->core->reach + axis->b->core->reach);
	return extent >= 4 * d + 4 * aside * (d / margin) ? BEST : SHARED;
}

/*
 * Tries all faces; true if the best of them is proven to be the best direction. Faces that prove as
 * much to rounding are examined too, because only along one of them the bodies may lie over each
 * other: of two that are nearly flush, a corner of one may be past the face of the other.
 */
static bool best_face_decides(rb_axis *axis)
{
	rb_vec3 tie[TIES_MAX];

	rb_facets_faces(axis, NULL);
	if (!axis->found)
		return false;
	proof max = proof_of(axis);
	if (max == BEST || axis->second < axis->gap - 4 * axis->noise)
		return max == BEST;
	rb_axis best = *axis;
	const int ties = rb_facets_ties(axis, best.gap - 4 * axis->noise, tie, TIES_MAX);
	for (int k = 0; k < ties && ties > 1; k++) {
		axis->normal = tie[k];
		axis->gap = rb_axis_gap(axis, tie[k]);
		const proof this = proof_of(axis);
		if (this == BEST)
			return true;
		if (this > max) {
			best = *axis;
			max = this;
		}
	}
	*axis = best;
	return false;
}

static bool both_round(const rb_placed *a, const rb_placed *b)
{
	return a->core->kind == RB_CORE_CYLINDER && b->core->kind == RB_CORE_CYLINDER;
}

/*
 * The same where one is a cylinder. Of an overlap GJK's direction may be none: the best so far is
 * another, and of two cylinders both are tried, as ends and mantles have maxima of their own.
 */
static void search_rims(rb_axis *axis, const rb_gjk *gjk, const rb_slab *slab, double scale)
{
	if (both_round(axis->a, axis->b)) {
		rb_rims(axis, slab, gjk->normal);
		if (!gjk->is_separate)
			rb_rims(axis, slab, axis->normal);
	} else {
		const bool face = axis->found && axis->gap > gjk->least;

		rb_rims(axis, slab, face ? axis->normal : gjk->normal);
		if (axis->gap < -far_share * scale) {
			rb_rims(axis, slab, gjk->normal);
			rb_rims(axis, slab, axis->normal);
		}
	}
	if (axis->gap < -far_share * scale)
		search_deep(axis, slab);
}

/*
 * Close or overlapping: GJK's direction has lost digits, so features are limited by the slab of the
 * best face (see the head of this file).
 */
static void search_near(rb_axis *axis, const rb_gjk *gjk, bool round, double scale)
{
	rb_slab slab = {gjk->normal, (double)INFINITY, (double)INFINITY};

	if (axis->found) {
		/*
		 * A distance above far_share would have been proven; if it was not, GJK ended in an
		 * overlap and its `upper` is a value from before.
		 */
		const double doubt = fabs(gjk->upper - gjk->least);
		const double distance = gjk->upper <= far_share * scale
		                                ? fmax(gjk->upper, gjk->least) + doubt
		                                : 0;
		slab.distance = distance;
		rb_slab_tighten(&slab, axis);
	}
	if (round) {
		search_rims(axis, gjk, &slab, scale);
		return;
	}
	rb_facets_edges(axis, &slab);
	if (gjk->is_separate || axis->gap > 0)
		rb_facets_corners(axis, &slab);
	if (!has_faces(axis->a) && !has_faces(axis->b) && !gjk->is_separate) {
		try_across(axis, axis->a);
		try_across(axis, axis->b);
	}
}

/* Well apart: features in a thin slab across GJK's direction. */
static void search_far(rb_axis *axis, const rb_gjk *gjk, bool round)
{
	/*
	 * the upper bound of thin simplices on round cores has lost digits and may lie below the
	 * lower one
	 */
	const double doubt = fabs(gjk->upper - gjk->least) + 8 * axis->noise;
	const rb_slab slab = {gjk->normal, doubt, round ? gjk->upper + doubt : (double)INFINITY};

	if (round) {
		rb_rims(axis, &slab, gjk->normal);
		return;
	}
	rb_facets_edges(axis, &slab);
	rb_facets_corners(axis, &slab);
}

static bool is_point(const rb_placed *p)
{
	return p->core->kind == RB_CORE_POLYTOPE && p->core->polytope->vertex_count == 1;
}

/* Two spheres: their distance needs no search. */
static bool both_points(const rb_placed *a, const rb_placed *b)
{
	return is_point(a) && is_point(b);
}

/* Whether it costs less to try all pairs of their features than to find out which matter. */
static bool has_few_pairs(const rb_placed *a, const rb_placed *b)
{
	const struct rb_polytope *const p = a->core->polytope, *const q = b->core->polytope;

	if (a->core->kind == RB_CORE_CYLINDER || b->core->kind == RB_CORE_CYLINDER)
		return is_point(a) || is_point(b);
	return p->arc_count * q->arc_count + p->vertex_count * (q->edge_count + 1) +
	               q->vertex_count * (p->edge_count + 1) <=
	       FEW_PAIRS;
}

/*
 * Of cores with few features all of these are tried, after the faces: that needs no distance to
 * tell which can matter. False where that does not decide.
 */
static bool all_decide(rb_axis *axis)
{
	const rb_vec3 up = {0, 0, 1};
	const rb_slab all = {up, (double)INFINITY, (double)INFINITY};
	const bool point = is_point(axis->a) || is_point(axis->b);
	const bool faces = axis->found;
	const double rounding = 4 * axis->noise;

	if (axis->a->core->kind == RB_CORE_CYLINDER || axis->b->core->kind == RB_CORE_CYLINDER) {
		rb_rims(axis, &all, up);
		return true;
	}
	/* a point within a solid is nearest to one of its faces */
	if (point && faces && axis->gap < -rounding)
		return true;
	if (!point)
		rb_facets_edges(axis, &all);
	/* flat ones that lie in one plane are apart within it */
	if (!axis->found || axis->gap > -rounding)
		rb_facets_corners(axis, &all);
	return axis->found && (faces || axis->gap > rounding);
}

/* m: of both. */
static double scale_of(const rb_placed *a, const rb_placed *b)
{
	return rb_vec3_length(rb_vec3_sub(b->at, a->at)) + a->core->reach + b->core->reach;
}

double rb_separation_noise(const rb_placed *a, const rb_placed *b)
{
	return NOISE_ULP * DBL_EPSILON * scale_of(a, b);
}

static rb_separation found(const rb_axis *axis)
{
	return (rb_separation){axis->normal, axis->gap, 4 * axis->noise, (double)INFINITY};
}

static bool is_far(const rb_gjk *gjk, double scale)
{
	return gjk->is_separate && gjk->upper > far_share * scale;
}

/* Faces, too, where these have not been tried. */
static void search(rb_axis *axis, const rb_gjk *gjk, bool faces, double scale)
{
	const bool round = axis->a->core->kind == RB_CORE_CYLINDER ||
	                   axis->b->core->kind == RB_CORE_CYLINDER;

	if (!is_far(gjk, scale)) {
		search_near(axis, gjk, round, scale);
		return;
	}
	if (!faces)
		rb_facets_faces(axis, &gjk->normal);
	search_far(axis, gjk, round);
}

rb_separation rb_separation_of(const rb_placed *a, const rb_placed *b)
{
	RB_ASSERT_COSTLY(a->core->kind != RB_CORE_HALF_SPACE ||
	                 b->core->kind != RB_CORE_HALF_SPACE);

	const double scale = scale_of(a, b), noise = NOISE_ULP * DBL_EPSILON * scale;
	const bool round = a->core->kind == RB_CORE_CYLINDER || b->core->kind == RB_CORE_CYLINDER;

	if (a->core->kind == RB_CORE_HALF_SPACE || b->core->kind == RB_CORE_HALF_SPACE)
		return of_half_space(a, b, noise);
	if (both_points(a, b)) {
		const rb_vec3 d = rb_vec3_sub(b->at, a->at);

		return (rb_separation){rb_vec3_unit(d, (rb_vec3){0, 0, 1}), rb_vec3_length(d),
		                       noise, (double)INFINITY};
	}
	const double none = -(double)INFINITY;
	rb_axis axis = {.a = a, .b = b, .noise = 0.25 * noise, .gap = none, .second = none};
	if (rb_box_is(a) && rb_box_is(b)) {
		rb_box_pair pair;

		rb_box_pair_set(&pair, a, b);
		if (rb_boxes_decide(&axis, &pair))
			return (rb_separation){axis.normal, axis.gap, noise, axis.second};
	}
	const bool few = face_count(a) + face_count(b) <= FEW_FACES;
	if (few && best_face_decides(&axis))
		return found(&axis);
	if (few && has_few_pairs(a, b) && all_decide(&axis))
		return found(&axis);
	/* round cores: a direction that is not far off mostly leads there, and more takes long */
	const bool coarse = round && few && !both_round(a, b);
	if (coarse) {
		const rb_gjk gjk = rb_gjk_run(a, b, scale, far_share * scale);

		search(&axis, &gjk, few, scale);
		/* of an overlap nothing else is known either */
		if (axis.found && (axis.gap <= 0 || is_proved(&axis)))
			return found(&axis);
	}
	const rb_gjk gjk = rb_gjk_run(a, b, scale, 0);
	if (!few && !is_far(&gjk, scale) && best_face_decides(&axis))
		return found(&axis);
	search(&axis, &gjk, few, scale);
	if (gjk.least > -(double)INFINITY)
		rb_axis_try(&axis, gjk.normal);
	RB_ASSERT_COSTLY(axis.found || isnan(scale));
	return found(&axis);
}

double rb_separation_beyond(const rb_placed *a, const rb_placed *b, double limit, int rounds,
                            rb_vec3 *axis)
{
	const rb_vec3 d = rb_vec3_sub(b->at, a->at);
	/* the 1-norm is no less than the length, and needs no root */
	const double scale = fabs(d.x) + fabs(d.y) + fabs(d.z) + a->core->reach + b->core->reach;
	const double noise = NOISE_ULP * DBL_EPSILON * scale;

	if (a->core->kind == RB_CORE_HALF_SPACE || b->core->kind == RB_CORE_HALF_SPACE ||
	    both_points(a, b)) {
		const double gap = both_points(a, b) ? rb_vec3_length(d)
		                                     : of_half_space(a, b, noise).gap;

		return gap > limit + noise ? gap - noise : -(double)INFINITY;
	}
	if (rb_box_is(a) && rb_box_is(b)) {
		const rb_axis boxes = {.a = a, .b = b, .noise = 0.25 * noise};

		return rb_boxes_beyond(&boxes, limit + 2 * noise, rounds > 1, axis) - 2 * noise;
	}
	return rb_gjk_beyond(a, b, limit + 2 * noise, rounds, axis) - 2 * noise;
}
