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

int rb_box_outermost(const struct rb_polytope *box, rb_vec3 local, double depth, double tilt,
                     int vertex[4], int *face)
{
	const rb_vec3 up = {fabs(local.x), fabs(local.y), fabs(local.z)};
	const double x = up.x * box->half.x, y = up.y * box->half.y, z = up.z * box->half.z;
	const double height = x + y + z;
	/* of the other end of the edge along each axis, and of the face's across it */
	const double end[3] = {y - x + z, x - y + z, x + y - z};
	const double far[3] = {x - y - z, y - x - z, z - (x + y)};
	const double low = height - depth;
	const int top = rb_polytope_support(box, local);
	const int k = up.z > up.x && up.z > up.y ? 2 : up.y > up.x;
	const int k1 = next_of[k], k2 = last_of[k];
	const bool of_k = end[k] >= low, of_k1 = end[k1] >= low, of_k2 = end[k2] >= low;
	const bool whole = tilt > depth && far[k] >= height - tilt;

	*face = 2 * k + (top >> k & 1);
	if (of_k && (of_k1 || of_k2 || tilt > depth))
		return 0;
	if ((of_k1 && of_k2) || whole) {
		const int *const loop = &box->loop[box->faces[*face].first];
		const int beyond = far[k] >= low || whole ? -1 : top ^ 1 << k1 ^ 1 << k2;
		int count = 0;

		for (int i = 0; i < 4; i++) {
			vertex[count] = loop[i];
			count += loop[i] != beyond;
		}
		return count;
	}
	const int other = top ^ (of_k << k | of_k1 << k1 | of_k2 << k2);

	vertex[0] = top < other ? top : other;
	vertex[1] = top < other ? other : top;
	return top == other ? 1 : 2;
}

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

void rb_box_pair_set(rb_box_pair *p, const rb_placed *a, const rb_placed *b)
{
	const rb_vec3 d = rb_vec3_sub(b->at, a->at);

	numbers_of(a->core->polytope->half, p->half_a);
	numbers_of(b->core->polytope->half, p->half_b);
	numbers_of(rb_mat3_apply_transposed(&a->turn, d), p->from_a);
	numbers_of(rb_mat3_apply_transposed(&b->turn, d), p->from_b);
	for (int k = 0; k < 3; k++) {
		numbers_of(rb_mat3_apply_transposed(&b->turn, axis_of(a, k)), p->turn[k]);
		for (int l = 0; l < 3; l++)
			p->size[k][l] = fabs(p->turn[k][l]);
	}
	for (int k = 0; k < 3; k++) {
		p->face[k] = fabs(p->from_a[k]) - p->half_a[k] - p->half_b[0] * p->size[k][0] -
		             p->half_b[1] * p->size[k][1] - p->half_b[2] * p->size[k][2];
		p->face[3 + k] = fabs(p->from_b[k]) - p->half_b[k] - p->half_a[0] * p->size[0][k] -
		                 p->half_a[1] * p->size[1][k] - p->half_a[2] * p->size[2][k];
	}
}

/* The way from a to b along the cross product of edges k of a and l of b, m times its length. */
static inline __attribute__((always_inline)) double along_edges(const rb_box_pair *p, int k, int l)
{
	const int k1 = next_of[k], k2 = last_of[k];

	return p->from_a[k2] * p->turn[k1][l] - p->from_a[k1] * p->turn[k2][l];
}

/* What it proves, in the same units. */
static inline __attribute__((always_inline)) double edges_prove(const rb_box_pair *p, int k, int l)
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

/*
 * One pair of edges, which has to be clearly better than the best so far, or clearly worse. Inlined
 * for each, so that no index is looked up.
 */
static inline __attribute__((always_inline)) bool try_edges(const rb_box_pair *p, int k, int l,
                                                            double noise, double clear,
                                                            best_of *best)
{
	const double parallel = 16 * DBL_EPSILON; /* as in geom/facets: faces cover these */
	const double proof = edges_prove(p, k, l), least = best->gap - clear;

	/* no cross product is longer than 1: no root is needed to see this */
	if (proof + noise <= (least < 0 ? least : 0))
		return true;
	const double x = p->turn[next_of[k]][l], y = p->turn[last_of[k]][l];
	const double length = sqrt(x * x + y * y);
	if (!(length > parallel) || proof + noise <= least * length)
		return true;
	/* written so that NaN is not clear */
	if (!(proof - noise > (best->gap + clear) * length))
		return false;
	*best = (best_of){6 + 3 * k + l, proof / length, along_edges(p, k, l)};
	return true;
}

static bool best_edges(const rb_box_pair *p, double noise, double clear, best_of *best)
{
	return try_edges(p, 0, 0, noise, clear, best) && try_edges(p, 0, 1, noise, clear, best) &&
	       try_edges(p, 0, 2, noise, clear, best) && try_edges(p, 1, 0, noise, clear, best) &&
	       try_edges(p, 1, 1, noise, clear, best) && try_edges(p, 1, 2, noise, clear, best) &&
	       try_edges(p, 2, 0, noise, clear, best) && try_edges(p, 2, 1, noise, clear, best) &&
	       try_edges(p, 2, 2, noise, clear, best);
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

/* The unit normal that a direction of the fifteen stands for, from a to b. */
static rb_vec3 normal_of(const rb_axis *axis, int which, double sense)
{
	const int k = (which - 6) / 3, l = (which - 6) % 3;
	rb_vec3 n = which < 3   ? axis_of(axis->a, which)
	            : which < 6 ? axis_of(axis->b, which - 3)
	                        : rb_vec3_cross(axis_of(axis->a, k), axis_of(axis->b, l));

	if (which >= 6)
		n = rb_vec3_unit(n, n);
	return rb_vec3_scale(sense, n);
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
	axis->found = true;
	axis->normal = normal_of(axis, best.which, sense);
	axis->gap = rb_axis_gap(axis, axis->normal);
	axis->second = -(double)INFINITY;
	for (int i = 0; i < 6; i++)
		if (i != best.which && p->face[i] > axis->second)
			axis->second = p->face[i];
	return true;
}

/* What edges prove, surely, if it is more than `limit`; else -INFINITY. */
static inline __attribute__((always_inline)) double edges_beyond(const rb_box_pair *p, int k, int l,
                                                                 double limit, double noise)
{
	const double proof = edges_prove(p, k, l) - noise;

	/* no cross product is longer than 1: no root is needed to see this */
	if (!(proof > (limit < 0 ? limit : 0)))
		return -(double)INFINITY;
	const double x = p->turn[next_of[k]][l], y = p->turn[last_of[k]][l];
	const double length = sqrt(x * x + y * y);
	return proof > limit * length && length > 0 ? proof / length : -(double)INFINITY;
}

double rb_boxes_beyond(const rb_axis *axis, double limit, bool all, rb_vec3 *normal)
{
	const bool is_known = rb_vec3_dot(*normal, *normal) > 0;
	const double known = is_known ? rb_axis_gap(axis, *normal) : -(double)INFINITY;

	if (known > limit)
		return known;
	if (is_known && !all)
		return -(double)INFINITY;
	rb_box_pair pair;
	int best = 0;

	rb_box_pair_set(&pair, axis->a, axis->b);
	for (int k = 1; k < 6; k++)
		if (pair.face[k] > pair.face[best])
			best = k;
	double along = best < 3 ? pair.from_a[best] : pair.from_b[best - 3], gap = pair.face[best];
	for (int k = 0; k < 3 && !(gap > limit); k++)
		for (int l = 0; l < 3; l++) {
			const double proof = edges_beyond(&pair, k, l, limit, axis->noise);

			if (!(proof > gap))
				continue;
			gap = proof;
			best = 6 + 3 * k + l;
			along = along_edges(&pair, k, l);
		}
	*normal = normal_of(axis, best, along < 0 ? -1 : 1);
	return gap > limit ? gap : -(double)INFINITY;
}
