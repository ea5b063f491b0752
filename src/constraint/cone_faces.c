/* SPDX-License-Identifier: MIT */
#include "constraint/cone_faces.h"

#include <math.h>
#include <string.h>

#include "constraint/joint_factor.h"

enum {
	WINDOW_SYMMETRIC = 3, /* conjugate residuals need one; the others correct rounding */
	ROUNDS_GENERAL = 60,  /* if the window is too small; the next Newton step continues */
	PATIENCE = 64         /* rounds before joints are eliminated */
};

/*
 * Work per row for each direction of the window (a scalar product and an update), in
 * multiplications, about.
 */
enum { ROW_WORK = 32 };
/* And of a product with the matrix: its sums are exact. */
enum { PRODUCT_WORK = 1 << 10 };

/*
 * Square of an image's length, relative to the direction's, above which it is more than rounding.
 */
static const double resolved_share = 1e-26;

/*
 * Applies the linearized function to a change x of the impulses; fills the components of x that
 * follow from its unknowns.
 */
static void image_of(struct rb_cone *cone, rb_along_across *x, rb_along_across *y)
{
	for (int k = 0; k < cone->row_count; k++) {
		const struct rb_cone_row *row = &cone->row[k];

		if (row->friction_impulse == RB_CONE_FOLLOW)
			x[k].t = rb_vec3_scale(-row->base.friction * x[k].n, row->slip);
		else /* removes rounding, which normalising small directions amplifies */
			x[k].t = rb_vec3_add_scaled(x[k].t, -rb_vec3_dot(x[k].t, row->base.normal),
			                            row->base.normal);
	}
	rb_cone_respond(cone, x);
	for (int k = 0; k < cone->row_count; k++) {
		const struct rb_cone_row *row = &cone->row[k];

		y[k] = (rb_along_across){0, {0, 0, 0}};
		if (!row->closed && row->friction_impulse == RB_CONE_KNOWN)
			continue;
		const rb_along_across du = rb_cone_row_change(cone, row);
		if (row->closed)
			y[k].n = du.n / row->bound_n;
		if (row->friction_impulse == RB_CONE_STICK)
			y[k].t = rb_vec3_scale(1 / row->bound_t, du.t);
		if (row->friction_impulse != RB_CONE_SLIP)
			continue;
		const double normal_impulse = row->closed && !cone->held ? x[k].n - y[k].n : 0;
		const rb_vec3 trial = rb_vec3_add_scaled(x[k].t, -1 / row->bound_t, du.t);
		const rb_vec3 across = rb_vec3_add_scaled(trial, -rb_vec3_dot(trial, row->along),
		                                          row->along);
		y[k].t = rb_vec3_add_scaled(x[k].t, -row->base.friction * normal_impulse,
		                            row->along);
		y[k].t = rb_vec3_add_scaled(y[k].t, -row->share, across);
	}
}

static void add_scaled(int count, rb_along_across *a, double s, const rb_along_across *b)
{
	for (int k = 0; k < count; k++) {
		a[k].n += s * b[k].n;
		a[k].t = rb_vec3_add_scaled(a[k].t, s, b[k].t);
	}
}

/* Unknowns on the present faces. */
struct faces {
	int dimension;
	bool slips;  /* the matrix is not symmetric */
	bool joints; /* some rows are bilateral */
};

/* Zeroes x, and the components of the residual that are not unknowns. */
static struct faces begin_faces(struct rb_cone *cone, rb_along_across *x)
{
	struct faces faces = {.dimension = 0};

	for (int k = 0; k < cone->row_count; k++) {
		const struct rb_cone_row *row = &cone->row[k];
		const bool across = row->friction_impulse == RB_CONE_STICK ||
		                    row->friction_impulse == RB_CONE_SLIP;

		x[k] = (rb_along_across){0, {0, 0, 0}};
		if (!row->closed)
			cone->residual[k].n = 0;
		if (!across)
			cone->residual[k].t = (rb_vec3){0, 0, 0};
		faces.slips = faces.slips || row->friction_impulse == RB_CONE_SLIP ||
		              row->friction_impulse == RB_CONE_FOLLOW;
		faces.joints = faces.joints || rb_joint_factor_width(row) > 0;
		faces.dimension += row->closed + 2 * across;
	}
	return faces;
}

/*
 * Factors the joints, once for all faces, if that costs at most as much as `products` with the
 * matrix; false: not available.
 */
static bool eliminate_joints(struct rb_cone *cone, int products)
{
	const size_t n = (size_t)cone->row_count;

	if (!cone->joints.attempted &&
	    rb_joint_factor(cone, (double)products * PRODUCT_WORK * (double)n)) {
		cone->preconditioned = rb_arena_take(cone->arena, n, sizeof *cone->preconditioned);
		cone->preconditioned_image = rb_arena_take(cone->arena, (size_t)cone->window * n,
		                                           sizeof *cone->preconditioned_image);
	}
	return cone->joints.ready && cone->preconditioned && cone->preconditioned_image;
}

/*
 * Applies the preconditioner, the inverse for the joints, to r: into `to`; returns r itself without
 * one.
 */
static rb_along_across *precondition(const struct rb_cone *cone, bool joints, rb_along_across *r,
                                     rb_along_across *to)
{
	if (!joints)
		return r;
	rb_joint_factor_solve(cone, r, to);
	return to;
}

/* A search direction, its image, and the preconditioned image (or the image itself). */
struct direction {
	rb_along_across *p, *q, *preconditioned;
};

static struct direction direction_at(const struct rb_cone *cone, bool joints, int round, int window)
{
	const size_t at = (size_t)(round % window) * (size_t)cone->row_count;

	return (struct direction){cone->direction + at, cone->image + at,
	                          (joints ? cone->preconditioned_image : cone->image) + at};
}

static void add_direction(int count, struct direction *to, double s, const struct direction *from)
{
	add_scaled(count, to->q, s, from->q);
	add_scaled(count, to->p, s, from->p);
	if (to->preconditioned != to->q)
		add_scaled(count, to->preconditioned, s, from->preconditioned);
}

static void divide(int count, rb_along_across *a, double size)
{
	for (int k = 0; k < count; k++)
		a[k] = (rb_along_across){a[k].n / size, rb_vec3_scale(1 / size, a[k].t)};
}

/*
 * Makes d->p the next direction: conjugate to those before it, with an image of unit length. False:
 * its image vanishes.
 */
static bool open_direction(struct rb_cone *cone, bool joints, int round, int window,
                           struct direction *d)
{
	const int n = cone->row_count;

	image_of(cone, d->p, d->q);
	(void)precondition(cone, joints, d->q, d->preconditioned);
	const double whole = rb_cone_weighted(cone, d->q, d->preconditioned);
	for (int back = 1; back < window && back <= round; back++) {
		const struct direction of = direction_at(cone, joints, round - back, window);

		add_direction(n, d, -rb_cone_weighted(cone, d->q, of.preconditioned), &of);
	}
	const double square = rb_cone_weighted(cone, d->q, d->preconditioned);
	const double length = rb_cone_weighted(cone, d->p, d->p);
	if (!(square > 1e-22 * whole) || !(square > resolved_share * length) || !isfinite(square))
		return false;
	divide(n, d->p, sqrt(square));
	divide(n, d->q, sqrt(square));
	if (joints)
		divide(n, d->preconditioned, sqrt(square));
	return true;
}

/*
 * Continues from x and its residual until the square of the latter is `target`: generalized
 * conjugate residuals with a window (Eisenstat, Elman, Schultz, SIAM J. Numer. Anal. 20 (1983)
 * 345), which are conjugate residuals if no contact slips, because the matrix is then symmetric in
 * the weighted product. `joints`: with the joints' inverse as preconditioner, and the product that
 * belongs to it. False: not converged.
 */
static bool search(struct rb_cone *cone, rb_along_across *x, bool joints, int window, int rounds,
                   double target)
{
	const int n = cone->row_count;
	rb_along_across *const r = cone->residual;
	rb_along_across *const z = precondition(cone, joints, r,
	                                        cone->preconditioned); /* next direction */
	double square = rb_cone_weighted(cone, r, r);
	bool stalls = false;
	int round = 0;

	for (; round < rounds && square > target; round++) {
		if (rb_interrupt_after(cone->interrupt, ROW_WORK * (uint64_t)n * (uint64_t)window))
			break;
		struct direction d = direction_at(cone, joints, round, window);
		const struct direction last = direction_at(cone, joints, round + window - 1,
		                                           window);

		/*
		 * if the residual alone makes no progress (the matrix need not be definite), the
		 * last image does
		 */
		memcpy(d.p, stalls ? last.preconditioned : z, (size_t)n * sizeof *d.p);
		if (!open_direction(cone, joints, round, window, &d))
			break;
		const double share = rb_cone_weighted(cone, r, d.preconditioned);
		add_scaled(n, x, share, d.p);
		add_scaled(n, r, -share, d.q);
		if (joints)
			add_scaled(n, z, -share, d.preconditioned);
		const double next = rb_cone_weighted(cone, r, r);
		stalls = next > 0.8 * square;
		square = next;
	}
	return round < rounds;
}

/* Does the window hold all directions of a matrix that is not symmetric? */
static bool is_direct(int dimension, int window)
{
	return dimension < window && window > WINDOW_SYMMETRIC;
}

/* Rounds after which this many unknowns are found, or will not be. */
static int rounds_of(int dimension, int window)
{
	if (is_direct(dimension, window))
		return dimension + 4;
	if (window > WINDOW_SYMMETRIC)
		return ROUNDS_GENERAL;
	return dimension < 500 ? 2 * dimension + 4 : 1000;
}

bool rb_cone_faces_solve(struct rb_cone *cone, rb_along_across *x)
{
	const int n = cone->row_count;
	const struct faces faces = begin_faces(cone, x);
	const int widest = faces.slips ? cone->window : WINDOW_SYMMETRIC;
	const int window = widest < cone->window ? widest : cone->window;
	const int whole = rounds_of(faces.dimension, window);
	const double start = rb_cone_weighted(cone, cone->residual, cone->residual);
	const bool general = window > WINDOW_SYMMETRIC;
	const bool postpones_joints = faces.joints && !general && !cone->joints.attempted;
	bool joints = faces.joints && !postpones_joints &&
	              (cone->joints.ready || !is_direct(faces.dimension, window)) &&
	              eliminate_joints(cone, whole);
	bool ended = postpones_joints && search(cone, x, false, window, PATIENCE, 1e-33 * start);

	joints = joints || (postpones_joints && !ended && eliminate_joints(cone, whole));
	const int dimension = faces.dimension - (joints ? cone->joints.count : 0);
	const bool direct = is_direct(dimension, window);
	if (!ended)
		ended = search(cone, x, joints, window, rounds_of(dimension, window),
		               (general && !direct ? 1e-16 : 1e-33) * start) ||
		        direct || (joints && !general);
	/* directions with nearly vanishing images are long, and so are their rounding errors */
	for (int k = 0; k < n; k++)
		x[k].t = rb_vec3_reject(x[k].t, cone->row[k].base.normal);
	return ended;
}
