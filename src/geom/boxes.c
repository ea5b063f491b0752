/* SPDX-License-Identifier: MIT */
/*
 * Overlapping, the best of fifteen directions is the best of all (separating axis theorem). Apart
 * it is, too, where two points lie over each other along it, for these are as far apart as it
 * proves: the lowest corner over a face, or the nearest points of two edges.
 */
#include "geom/boxes.h"

#include <float.h>

/*
 * Another direction counts as clearly worse by so many noises of the axis test: its own rounding,
 * that of the closed form, and the four by which geom/separation tells ties.
 */
static const double clear_noises = 16;

/* The axes after k, cyclic: e_k x e_next = e_last. */
static const int next_of[3] = {1, 2, 0}, last_of[3] = {2, 0, 1};

/* Column k of a turn: an axis of the box in the world. */
static rb_vec3 axis_of(const rb_placed *p, int k)
{
	return (rb_vec3){p->turn.m[0][k], p->turn.m[1][k], p->turn.m[2][k]};
}

static void numbers_of(rb_vec3 v, double number[3])
{
	number[0] = v.x;
	number[1] = v.y;
	number[2] = v.z;
}

rb_box_pair rb_box_pair_of(const rb_placed *a, const rb_placed *b)
{
	const rb_vec3 d = rb_vec3_sub(b->at, a->at);
	rb_box_pair p;

	numbers_of(a->core->polytope->half, p.half_a);
	numbers_of(b->core->polytope->half, p.half_b);
	numbers_of(rb_mat3_apply_transposed(&a->turn, d), p.from_a);
	numbers_of(rb_mat3_apply_transposed(&b->turn, d), p.from_b);
	for (int k = 0; k < 3; k++) {
		numbers_of(rb_mat3_apply_transposed(&b->turn, axis_of(a, k)), p.turn[k]);
		for (int l = 0; l < 3; l++)
			p.size[k][l] = fabs(p.turn[k][l]);
	}
	for (int k = 0; k < 3; k++) {
		p.face[k] = fabs(p.from_a[k]) - p.half_a[k] - p.half_b[0] * p.size[k][0] -
		            p.half_b[1] * p.size[k][1] - p.half_b[2] * p.size[k][2];
		p.face[3 + k] = fabs(p.from_b[k]) - p.half_b[k] - p.half_a[0] * p.size[0][k] -
		                p.half_a[1] * p.size[1][k] - p.half_a[2] * p.size[2][k];
	}
	return p;
}

/* The way from a to b along the cross product of edges k of a and l of b, m times its length. */
static double along_edges(const rb_box_pair *p, int k, int l)
{
	const int k1 = next_of[k], k2 = last_of[k];

	return p->from_a[k2] * p->turn[k1][l] - p->from_a[k1] * p->turn[k2][l];
}

/* What it proves, in the same units. */
static double edges_prove(const rb_box_pair *p, int k, int l)
{
	const int k1 = next_of[k], k2 = last_of[k], l1 = next_of[l], l2 = last_of[l];

	return fabs(along_edges(p, k, l)) - p->half_a[k1] * p->size[k2][l] -
	       p->half_a[k2] * p->size[k1][l] - p->half_b[l1] * p->size[k][l2] -
	       p->half_b[l2] * p->size[k][l1];
}

/* The best of the fifteen: 0 to 5 a face, 6 + 3 k + l edges; its gap and that way. */
typedef struct {
	int which;
	double gap, along;
} best_of;

/* False: two of them prove as much, to rounding. */
static bool best_face(const rb_box_pair *p, double clear, best_of *best)
{
	int close = 0;

	best->which = 0;
	for (int k = 1; k < 6; k++)
		if (p->face[k] > p->face[best->which])
			best->which = k;
	best->gap = p->face[best->which];
	best->along = best->which < 3 ? p->from_a[best->which] : p->from_b[best->which - 3];
	for (int k = 0; k < 6; k++)
		close += !(p->face[k] < best->gap - clear);
	return close == 1;
}

/* The same of edges; each has to be clearly better than the best so far, or clearly worse. */
static bool best_edges(const rb_box_pair *p, double noise, double clear, best_of *best)
{
	const double parallel = 16 * DBL_EPSILON; /* as in geom/facets: faces cover these */

	for (int k = 0; k < 3; k++) {
		for (int l = 0; l < 3; l++) {
			const double proof = edges_prove(p, k, l), least = best->gap - clear;

			/* no cross product is longer than 1: no root is needed to see this */
			if (proof + noise <= fmin(least, 0))
				continue;
			const double x = p->turn[next_of[k]][l], y = p->turn[last_of[k]][l];
			const double length = sqrt(x * x + y * y);
			if (!(length > parallel) || proof + noise <= least * length)
				continue;
			/* written so that NaN is not clear */
			if (!(proof - noise > (best->gap + clear) * length))
				return false;
			*best = (best_of){6 + 3 * k + l, proof / length, along_edges(p, k, l)};
		}
	}
	return true;
}

static double with_sign(double size, double sign)
{
	return sign < 0 ? -size : size;
}

/* Does the lowest corner of the other box lie over the face? */
static bool corner_is_over(const rb_box_pair *p, int which, double sense)
{
	const bool of_a = which < 3;
	const int k = of_a ? which : which - 3;
	const double *half = of_a ? p->half_a : p->half_b;
	const double *other = of_a ? p->half_b : p->half_a;
	double at[3];

	/* in the axes of the box whose face it is; the way goes from a to b */
	for (int i = 0; i < 3; i++)
		at[i] = of_a ? p->from_a[i] : -p->from_b[i];
	for (int l = 0; l < 3; l++) {
		const double up = sense * (of_a ? p->turn[k][l] : p->turn[l][k]);
		const double corner = with_sign(other[l], of_a ? -up : up);

		for (int i = 0; i < 3; i++)
			at[i] += corner * (of_a ? p->turn[i][l] : p->turn[l][i]);
	}
	return fabs(at[next_of[k]]) <= half[next_of[k]] && fabs(at[last_of[k]]) <= half[last_of[k]];
}

/* Are the nearest points of the lines of two edges points of the edges? */
static bool edges_cross(const rb_box_pair *p, int k, int l, double sense)
{
	const int k1 = next_of[k], k2 = last_of[k], l1 = next_of[l], l2 = last_of[l];
	const double c = p->turn[k][l];
	/* components of the cross product along the axes across each edge: which edge it is */
	const double a1 = with_sign(p->half_a[k1], -sense * p->turn[k2][l]);
	const double a2 = with_sign(p->half_a[k2], sense * p->turn[k1][l]);
	const double b1 = with_sign(p->half_b[l1], -sense * p->turn[k][l2]);
	const double b2 = with_sign(p->half_b[l2], sense * p->turn[k][l1]);
	double way[3];

	for (int i = 0; i < 3; i++)
		way[i] = p->from_a[i] + b1 * p->turn[i][l1] + b2 * p->turn[i][l2];
	way[k1] -= a1;
	way[k2] -= a2;
	const double along = way[0] * p->turn[0][l] + way[1] * p->turn[1][l] +
	                     way[2] * p->turn[2][l];
	const double square = p->turn[k1][l] * p->turn[k1][l] + p->turn[k2][l] * p->turn[k2][l];
	const double on_b = (way[k] * c - along) / square, on_a = way[k] + on_b * c;

	return fabs(on_a) <= p->half_a[k] && fabs(on_b) <= p->half_b[l];
}

bool rb_boxes_decide(rb_axis *axis, const rb_box_pair *p)
{
	const double clear = clear_noises * axis->noise;
	best_of best;

	if (!best_face(p, clear, &best) || !best_edges(p, axis->noise, clear, &best))
		return false;
	/* concentric along it: it proves as much either way */
	if (!(fabs(best.along) > clear))
		return false;
	const double sense = best.along < 0 ? -1 : 1;
	const int k = (best.which - 6) / 3, l = (best.which - 6) % 3;
	if (best.gap > 0 &&
	    !(best.which < 6 ? corner_is_over(p, best.which, sense) : edges_cross(p, k, l, sense)))
		return false;
	rb_vec3 n = best.which < 3   ? axis_of(axis->a, best.which)
	            : best.which < 6 ? axis_of(axis->b, best.which - 3)
	                             : rb_vec3_cross(axis_of(axis->a, k), axis_of(axis->b, l));
	if (best.which >= 6)
		n = rb_vec3_unit(n, n);
	axis->found = true;
	axis->normal = rb_vec3_scale(sense, n);
	axis->gap = rb_axis_gap(axis, axis->normal);
	return true;
}
