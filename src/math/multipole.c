/* SPDX-License-Identifier: MIT */
/*
 * Loops over exponents have constant bounds and are unrolled by the compiler, so that indices are
 * constants. Derivatives by d/dx g_m = x g_(m+1), g_m being the m-th derivative of g by r^2/2 (L.
 * McMurchie and E. Davidson, J. Comput. Phys. 26 (1978) 218).
 */
#include "math/multipole.h"

#include "base/error.h"

enum { P = RB_MULTIPOLE_ORDER, TERMS = RB_MULTIPOLE_TERMS };
#define UNROLLED _Pragma("GCC unroll 8")

/* Place of x^(k-j) y^(j-c) z^c. */
RB_LANES_INLINE int at(int k, int j, int c)
{
	return k * (k + 1) * (k + 2) / 6 + j * (j + 1) / 2 + c;
}

/* d^m/m! of all triples. */
static void powers(rb_vec3 d, double power[TERMS])
{
	static const double inverse[] = {1, 1, 1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5, 1.0 / 6};
	double x[3][P + 1];
	const double of[3] = {d.x, d.y, d.z};

	for (int m = 0; m < 3; m++) {
		x[m][0] = 1;
		for (int k = 1; k <= P; k++)
			x[m][k] = x[m][k - 1] * of[m] * inverse[k];
	}
	for (int k = 0; k <= P; k++)
		for (int j = 0; j <= k; j++)
			for (int c = 0; c <= j; c++)
				power[at(k, j, c)] = x[0][k - j] * x[1][j - c] * x[2][c];
}

void rb_multipole_add(double moment[TERMS], double mu, rb_vec3 d)
{
	double power[TERMS];

	powers(d, power);
	for (int n = 0; n < TERMS; n++)
		moment[n] += mu * power[n];
}

/*
 * sum over |m| = `order` of weight[m] of[n + m], n = (k, j, c): the inner sum of every contraction.
 */
#define CONTRACT(sum, order, weight, of, k, j, c) \
	UNROLLED                                  \
	for (int i = 0; i <= (order); i++)        \
		UNROLLED                          \
	for (int e = 0; e <= i; e++)              \
	(sum) += (weight)[at(order, i, e)] * (of)[at((k) + (order), (j) + i, (c) + e)]

void rb_multipole_lift(double moment[TERMS], const double part[TERMS], rb_vec3 d)
{
	double power[TERMS];

	powers(d, power);
	for (int k = 0; k <= P; k++)
		for (int j = 0; j <= k; j++)
			for (int c = 0; c <= j; c++)
				for (int q = 0; q + k <= P; q++)
					for (int i = 0; i <= q; i++)
						for (int e = 0; e <= i; e++)
							moment[at(k + q, j + i, c + e)] +=
								power[at(k, j, c)] *
								part[at(q, i, e)];
}

void rb_multipole_lower(double field[TERMS], const double whole[TERMS], rb_vec3 d)
{
	double power[TERMS];

	powers(d, power);
	for (int k = 0; k <= P; k++)
		for (int j = 0; j <= k; j++)
			for (int c = 0; c <= j; c++)
				for (int q = 0; q + k <= P; q++)
					CONTRACT(field[at(k, j, c)], q, power, whole, k, j, c);
}

rb_vec3 rb_multipole_at(const double field[TERMS], rb_vec3 d, double *potential)
{
	double power[TERMS], sum[4] = {0, 0, 0, 0};

	powers(d, power);
	for (int k = 0; k <= P; k++)
		CONTRACT(sum[0], k, power, field, 0, 0, 0);
	for (int k = 0; k < P; k++) {
		CONTRACT(sum[1], k, power, field, 1, 0, 0);
		CONTRACT(sum[2], k, power, field, 1, 1, 0);
		CONTRACT(sum[3], k, power, field, 1, 1, 1);
	}
	*potential = sum[0];
	return (rb_vec3){sum[1], sum[2], sum[3]};
}

/* ---- four sources at a time ---- */

/*
 * Derivatives of order up to P at `d`, in place: with those of g_(m+1) up to order k - 1 there,
 * those of g_m up to order k follow from the highest down.
 */
RB_LANES_INLINE void derive(const rb_lanes d[3], double soft2, rb_lanes of[TERMS])
{
	const rb_lanes square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + soft2;
	rb_lanes root, g[P + 1];

	rb_lanes_root(&square, &root);
	const rb_lanes inverse2 = 1 / square;
	g[0] = root * inverse2;
	UNROLLED
	for (int m = 1; m <= P; m++)
		g[m] = -(2 * m - 1) * inverse2 * g[m - 1];
	of[0] = g[P];
	UNROLLED
	for (int m = P - 1; m >= 0; m--) {
		UNROLLED
		for (int k = P - m; k >= 1; k--) {
			UNROLLED
			for (int j = 0; j <= k; j++) {
				UNROLLED
				for (int c = 0; c <= j; c++) {
					/* along the axis that has an exponent */
					const int a = k - j, b = j - c;
					const int axis = a > 0 ? 0 : b > 0 ? 1 : 2;
					const int less = axis == 0   ? a - 1
					                 : axis == 1 ? b - 1
					                             : c - 1;
					const int dj = axis > 0, dc = axis > 1;

					of[at(k, j, c)] = d[axis] * of[at(k - 1, j - dj, c - dc)];
					if (less > 0)
						of[at(k, j, c)] +=
							less *
							of[at(k - 2, j - 2 * dj, c - 2 * dc)];
				}
			}
		}
		of[0] = g[m];
	}
}

/* Four sources, of which those from `count` on have no moments. */
RB_LANES_INLINE void act_four(const struct rb_multipole_sources *sources, const int *list,
                              int count, double soft2, const double center[3],
                              rb_lanes field[TERMS])
{
	rb_lanes d[3], of[TERMS], moment[TERMS];

	for (int m = 0; m < 3; m++)
		for (int lane = 0; lane < RB_LANES; lane++)
			d[m][lane] = center[m] - sources->center[list[lane < count ? lane : 0]][m];
	const double *const part[4] = {sources->moment[list[0]], sources->moment[list[count > 1]],
	                               sources->moment[list[count > 2 ? 2 : 0]],
	                               sources->moment[list[count > 3 ? 3 : 0]]};
	const rb_lanes share = {1, count > 1, count > 2, count > 3};
	for (int n = 0; n < TERMS; n++)
		moment[n] = share * (rb_lanes){part[0][n], part[1][n], part[2][n], part[3][n]};
	derive(d, soft2, of);
	UNROLLED
	for (int k = 0; k <= P; k++) {
		UNROLLED
		for (int j = 0; j <= k; j++) {
			UNROLLED
			for (int c = 0; c <= j; c++) {
				rb_lanes sum = moment[0] * of[at(k, j, c)];

				UNROLLED
				for (int q = 2; q <= P - k; q++)
					CONTRACT(sum, q, moment, of, k, j, c);
				field[at(k, j, c)] += sum;
			}
		}
	}
}

RB_LANES_INLINE void act(const struct rb_multipole_sources *sources, const int *list, int count,
                         double soft2, const double center[3], double field[TERMS])
{
	rb_lanes sum[TERMS] = {{0}};

	for (int k = 0; k < count; k += RB_LANES)
		act_four(sources, list + k, count - k, soft2, center, sum);
	for (int n = 0; n < TERMS; n++)
		field[n] += rb_lanes_sum(&sum[n]);
}

RB_LANES_AVX2 static void act_avx2(const struct rb_multipole_sources *sources, const int *list,
                                   int count, double soft2, const double center[3],
                                   double field[TERMS])
{
	act(sources, list, count, soft2, center, field);
}

void rb_multipole_field(const struct rb_multipole_sources *sources, const int *list, int count,
                        double soft2, const double center[3], double field[TERMS])
{
	if (rb_lanes_avx2())
		act_avx2(sources, list, count, soft2, center, field);
	else
		act(sources, list, count, soft2, center, field);
}
