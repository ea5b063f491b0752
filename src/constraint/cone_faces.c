/* SPDX-License-Identifier: MIT */
#include "constraint/cone_faces.h"

#include <math.h>
#include <string.h>

#include "constraint/joint_factor.h"

enum {
	WINDOW_SYMMETRIC = 3, /* conjugate residuals need one; the others mend rounding */
	ROUNDS_GENERAL = 60,  /* where the window is too small; the next Newton step goes on */
	PATIENCE = 64         /* rounds, before what joints hold is eliminated */
};

/* Multiplications of a row in a product of two vectors and a sum, for each of the window, about. */
enum { ROW_WORK = 32 };
/* And in a product of the matrix with one: its sums are exact. */
enum { PRODUCT_WORK = 1 << 10 };

/* Square of the share of a direction's length by which an image of it is more than rounding. */
static const double felt_share = 1e-26;

/*
 * What the linearized function does to a change x of the impulses; what follows in x from its
 * unknowns is completed.
 */
static void image_of(struct rb_cone *cone, rb_along_across *x, rb_along_across *y)
{
	for (int k = 0; k < cone->row_count; k++) {
		const struct rb_cone_row *row = &cone->row[k];

		if (row->friction_impulse == RB_CONE_FOLLOW)
			x[k].t = rb_vec3_scale(-row->base.friction * x[k].n, row->slip);
		else /* rounding that grows when small directions are made unit ones */
			x[k].t = rb_vec3_add_scaled(x[k].t, -rb_vec3_dot(x[k].t, row->base.normal),
			                            row->base.normal);
	}
	rb_cone_respond(cone, x);
	for (int k = 0; k < cone->row_count; k++) {
		const struct rb_cone_row *row = &cone->row[k];

		y[k] = (rb_along_across){0, {0, 0, 0}};
		if (!row->closed && row->friction_impulse == RB_CONE_KNOWN)
			continue;
		const rb_along_across du = rb_cone_felt(cone, row);
		if (row->closed)
			y[k].n = du.n / row->bound_n;
		if (row->friction_impulse == RB_CONE_STICK)
			y[k].t = rb_vec3_scale(1 / row->bound_t, du.t);
		if (row->friction_impulse != RB_CONE_SLIP)
			continue;
		const double normal_impulse = row->closed && !cone->held ? x[k].n - y[k].n : 0;
		const rb_vec3 wanted = rb_vec3_add_scaled(x[k].t, -1 / row->bound_t, du.t);
		const rb_vec3 across = rb_vec3_add_scaled(wanted, -rb_vec3_dot(wanted, row->along),
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

/* What is open on the present faces. */
struct faces {
	int dimension;
	bool slips;  /* the matrix is not symmetric */
	bool joints; /* some hold from both sides */
};

/* Leaves out of the residual and of `x` what is not open. */
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
 * Factors of what joints hold, once for all faces, where they cost no more than `products` with the
 * matrix do; false: there are none.
 */
static bool eliminate_joints(struct rb_cone *cone, int products)
{
	const size_t n = (size_t)cone->row_count;

	if (!cone->joints.tried &&
	    rb_joint_factor(cone, (double)products * PRODUCT_WORK * (double)n)) {
		cone->undone = rb_arena_take(cone->arena, n, sizeof *cone->undone);
		cone->weighed = rb_arena_take(cone->arena, (size_t)cone->window * n,
		                              sizeof *cone->weighed);
	}
	return cone->joints.ready && cone->undone && cone->weighed;
}

/* What undoes residuals, as far as joints alone do: to `to`, or r itself where none are known. */
static rb_along_across *undo(const struct rb_cone *cone, bool joints, rb_along_across *r,
                             rb_along_across *to)
{
	if (!joints)
		return r;
	rb_joint_factor_solve(cone, r, to);
	return to;
}

/* What has to do with one direction: itself, its image, and what undoes that (or the image). */
struct direction {
	rb_along_across *p, *q, *undone;
};

static struct direction direction_at(const struct rb_cone *cone, bool joints, int round, int window)
{
	const size_t at = (size_t)(round % window) * (size_t)cone->row_count;

	return (struct direction){cone->direction + at, cone->image + at,
	                          (joints ? cone->weighed : cone->image) + at};
}

static void add_direction(int count, struct direction *to, double s, const struct direction *from)
{
	add_scaled(count, to->q, s, from->q);
	add_scaled(count, to->p, s, from->p);
	if (to->undone != to->q)
		add_scaled(count, to->undone, s, from->undone);
}

static void divide(int count, rb_along_across *a, double size)
{
	for (int k = 0; k < count; k++)
		a[k] = (rb_along_across){a[k].n / size, rb_vec3_scale(1 / size, a[k].t)};
}

/*
 * The next direction from `d->p`, of unit length and conjugate to those before it. False: it leads
 * nowhere.
 */
static bool open_direction(struct rb_cone *cone, bool joints, int round, int window,
                           struct direction *d)
{
	const int n = cone->row_count;

	image_of(cone, d->p, d->q);
	(void)undo(cone, joints, d->q, d->undone);
	const double whole = rb_cone_weighted(cone, d->q, d->undone);
	for (int back = 1; back < window && back <= round; back++) {
		const struct direction of = direction_at(cone, joints, round - back, window);

		add_direction(n, d, -rb_cone_weighted(cone, d->q, of.undone), &of);
	}
	const double square = rb_cone_weighted(cone, d->q, d->undone);
	const double length = rb_cone_weighted(cone, d->p, d->p);
	if (!(square > 1e-22 * whole) || !(square > felt_share * length) || !isfinite(square))
		return false;
	divide(n, d->p, sqrt(square));
	divide(n, d->q, sqrt(square));
	if (joints)
		divide(n, d->undone, sqrt(square));
	return true;
}

/*
 * From x and its residual on, until the square of that is `target`: generalized conjugate residuals
 * with a window (Eisenstat, Elman, Schultz, SIAM J. Numer. Anal. 20 (1983) 345), which are
 * conjugate residuals where no contact slips, because the matrix is then symmetric in the weighted
 * product. `joints`: what these hold is eliminated, and the product is the one that belongs to it.
 * False: they did not end.
 */
static bool search(struct rb_cone *cone, rb_along_across *x, bool joints, int window, int rounds,
                   double target)
{
	const int n = cone->row_count;
	rb_along_across *const r = cone->residual;
	rb_along_across *const z = undo(cone, joints, r, cone->undone); /* what leads on */
	double square = rb_cone_weighted(cone, r, r);
	bool poor = false;
	int round = 0;

	for (; round < rounds && square > target; round++) {
		if (rb_interrupt_after(cone->interrupt, ROW_WORK * (uint64_t)n * (uint64_t)window))
			break;
		struct direction d = direction_at(cone, joints, round, window);
		const struct direction last = direction_at(cone, joints, round + window - 1,
		                                           window);

		/*
		 * where the residual alone leads nowhere (the matrix need not be definite), the
		 * last image does
		 */
		memcpy(d.p, poor ? last.undone : z, (size_t)n * sizeof *d.p);
		if (!open_direction(cone, joints, round, window, &d))
			break;
		const double share = rb_cone_weighted(cone, r, d.undone);
		add_scaled(n, x, share, d.p);
		add_scaled(n, r, -share, d.q);
		if (joints)
			add_scaled(n, z, -share, d.undone);
		const double next = rb_cone_weighted(cone, r, r);
		poor = next > 0.8 * square;
		square = next;
	}
	return round < rounds;
}

/* Can all directions be kept that a matrix has which is not symmetric? */
static bool is_direct(int dimension, int window)
{
	return dimension < window && window > WINDOW_SYMMETRIC;
}

/* Rounds after which so many unknowns are found, or will not be. */
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
	const bool waits = faces.joints && !general && !cone->joints.tried;
	bool joints = faces.joints && !waits &&
	              (cone->joints.ready || !is_direct(faces.dimension, window)) &&
	              eliminate_joints(cone, whole);
	bool ended = waits && search(cone, x, false, window, PATIENCE, 1e-33 * start);

	joints = joints || (waits && !ended && eliminate_joints(cone, whole));
	const int dimension = faces.dimension - (joints ? cone->joints.count : 0);
	const bool direct = is_direct(dimension, window);
	if (!ended)
		ended = search(cone, x, joints, window, rounds_of(dimension, window),
		               (general && !direct ? 1e-16 : 1e-33) * start) ||
		        direct || (joints && !general);
	/*
	 * directions in which next to nothing changes are long, and so is what rounding adds to
	 * them
	 */
	for (int k = 0; k < n; k++)
		x[k].t = rb_vec3_reject(x[k].t, cone->row[k].base.normal);
	return ended;
}
