/* SPDX-License-Identifier: MIT */
#include "geom/mass.h"

/* Relative; what a tensor that was computed elsewhere and written down may be off by. */
static const double rounding = 1e-12;

double rb_shape_volume(const struct rb_shape *shape)
{
	const double r = shape->radius;

	return shape->kind == RB_SHAPE_SPHERE ? 4.0 / 3.0 * 3.14159265358979323846 * r * r * r : 0;
}

rb_mat3 rb_shape_inertia(const struct rb_shape *shape, double mass)
{
	const double i = shape->kind == RB_SHAPE_SPHERE ? 0.4 * mass * shape->radius * shape->radius
	                                                : 0;

	return rb_mat3_diagonal(i, i, i);
}

static double largest_entry(const rb_mat3 *a)
{
	double largest = 0;

	for (int i = 0; i < 9; i++)
		largest = fmax(largest, fabs(a->m[i / 3][i % 3]));
	return largest;
}

/* One Jacobi rotation that makes a[p][q] zero (Golub and Van Loan, Matrix Computations, 8.5). */
static void rotate_away(double a[3][3], int p, int q)
{
	if (a[p][q] == 0)
		return;
	const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
	const double t = copysign(1, theta) / (fabs(theta) + hypot(theta, 1));
	const double c = 1 / sqrt(t * t + 1), s = t * c;
	const int r = 3 - p - q;
	const double rp = a[r][p], rq = a[r][q];

	a[p][p] -= t * a[p][q];
	a[q][q] += t * a[p][q];
	a[p][q] = a[q][p] = 0;
	a[r][p] = a[p][r] = c * rp - s * rq;
	a[r][q] = a[q][r] = s * rp + c * rq;
}

void rb_inertia_principal(const rb_mat3 *inertia, double moments[3])
{
	const double scale = largest_entry(inertia);
	double a[3][3];

	moments[0] = moments[1] = moments[2] = 0;
	if (!(scale > 0) || !isfinite(scale))
		return;
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++)
			a[i][j] = a[j][i] = inertia->m[i][j] / scale;
	/* Converges quadratically: a handful of sweeps leaves nothing beside the diagonal. */
	for (int sweep = 0; sweep < 12; sweep++) {
		rotate_away(a, 0, 1);
		rotate_away(a, 0, 2);
		rotate_away(a, 1, 2);
	}
	const double x = a[0][0], y = a[1][1], z = a[2][2];
	moments[0] = scale * fmin(x, fmin(y, z));
	moments[2] = scale * fmax(x, fmax(y, z));
	moments[1] = scale * fmax(fmin(x, y), fmin(fmax(x, y), z));
}

bool rb_inertia_is_scalar(const rb_mat3 *inertia)
{
	const double limit = rounding * largest_entry(inertia);

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			if (fabs(inertia->m[i][j] - (i == j ? inertia->m[0][0] : 0)) > limit)
				return false;
	return true;
}

const char *rb_inertia_fault(const rb_mat3 *inertia)
{
	const double largest = largest_entry(inertia);
	double moments[3];

	for (int i = 0; i < 9; i++)
		if (!isfinite(inertia->m[i / 3][i % 3]))
			return "has an entry that is not finite";
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < i; j++)
			if (fabs(inertia->m[i][j] - inertia->m[j][i]) > rounding * largest)
				return "is not symmetric";
	rb_inertia_principal(inertia, moments);
	if (!(moments[0] > 0))
		return "is not positive";
	if (moments[2] - moments[1] > moments[0] + rounding * largest)
		return "has a principal moment above the sum of the other two, which no body has";
	return NULL;
}
