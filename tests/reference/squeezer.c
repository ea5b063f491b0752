/* SPDX-License-Identifier: MIT */
/*
 * The angles of scenes/verify/J04_squeezer.lua after 0.03 s: Newton's equations of seven bodies in
 * a plane and ten pins, multipliers by elimination, Runge and Kutta's method with 160,000 steps of
 * equal length and numbers of 64 binary digits (x87). Half as many steps differ by 1e-14.
 *
 *     cc -O2 squeezer.c -lm && ./a.out 160000
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef long double real;

enum { BODIES = 7, N = 3 * BODIES, PINS = 10, ROWS = 2 * PINS };

static const real mass[BODIES] = {0.04325L, 0.00365L, 0.02373L, 0.00706L,
                                  0.07050L, 0.00706L, 0.05498L};
static const real inertia[BODIES] = {2.194e-6L, 4.410e-7L, 5.255e-6L, 5.667e-7L,
                                     1.169e-5L, 5.667e-7L, 1.912e-5L};
static const real xa = -0.06934L, ya = -0.00227L, xb = -0.03635L, yb = 0.03273L;
static const real xc = 0.014L, yc = 0.072L, stiffness = 4530, rest = 0.07785L, torque = 0.033L;

/* Point of a body's own axes; of the ground, body -1, a place. */
struct point {
	int body;
	real x, y;
};

static real start[N]; /* x, y and angle turned of each body */
static struct point pin[PINS][2], spring;
static int pins;

static struct point point_of(int body, real x, real y)
{
	if (body < 0)
		return (struct point){body, x, y};
	return (struct point){body, x - start[3 * body], y - start[3 * body + 1]};
}

static void add_pin(int a, int b, real x, real y)
{
	pin[pins][0] = point_of(a, x, y);
	pin[pins++][1] = point_of(b, x, y);
}

static void arm_of(const struct point *p, const real *q, real arm[2])
{
	const real c = cosl(q[3 * p->body + 2]), s = sinl(q[3 * p->body + 2]);

	arm[0] = c * p->x - s * p->y;
	arm[1] = s * p->x + c * p->y;
}

static void forces(const real *q, real *f)
{
	real arm[2];

	memset(f, 0, N * sizeof *f);
	f[2] = torque;
	arm_of(&spring, q, arm);
	const real dx = xc - q[3 * spring.body] - arm[0], dy = yc - q[3 * spring.body + 1] - arm[1];
	const real length = sqrtl(dx * dx + dy * dy), pull = stiffness * (length - rest) / length;
	f[3 * spring.body] = pull * dx;
	f[3 * spring.body + 1] = pull * dy;
	f[3 * spring.body + 2] = pull * (arm[0] * dy - arm[1] * dx);
}

/* Gaussian elimination with row pivots; x: the last column's solution. */
static void solve(real m[ROWS][ROWS + 1], real *x)
{
	for (int k = 0; k < ROWS; k++) {
		int best = k;

		for (int r = k + 1; r < ROWS; r++)
			if (fabsl(m[r][k]) > fabsl(m[best][k]))
				best = r;
		for (int c = k; c <= ROWS; c++) {
			const real kept = m[k][c];

			m[k][c] = m[best][c];
			m[best][c] = kept;
		}
		for (int r = k + 1; r < ROWS; r++) {
			const real share = m[r][k] / m[k][k];

			for (int c = k; c <= ROWS; c++)
				m[r][c] -= share * m[k][c];
		}
	}
	for (int k = ROWS; k-- > 0;) {
		x[k] = m[k][ROWS];
		for (int c = k + 1; c < ROWS; c++)
			x[k] -= m[k][c] * x[c];
		x[k] /= m[k][k];
	}
}

static void accelerations(const real *q, const real *v, real *a)
{
	real jacobian[ROWS][N] = {{0}}, bias[ROWS] = {0}, m[ROWS][ROWS + 1], f[N], inverse[N];
	real multiplier[ROWS];

	for (int i = 0; i < N; i++)
		inverse[i] = 1 / (i % 3 == 2 ? inertia[i / 3] : mass[i / 3]);
	for (int k = 0; k < PINS; k++)
		for (int e = 0; e < 2; e++) {
			const struct point *const p = &pin[k][e];
			const real sign = e == 0 ? 1 : -1;
			real arm[2];

			if (p->body < 0)
				continue;
			arm_of(p, q, arm);
			const int i = 3 * p->body;
			jacobian[2 * k][i] = jacobian[2 * k + 1][i + 1] = sign;
			jacobian[2 * k][i + 2] = -sign * arm[1];
			jacobian[2 * k + 1][i + 2] = sign * arm[0];
			bias[2 * k] -= sign * v[i + 2] * v[i + 2] * arm[0];
			bias[2 * k + 1] -= sign * v[i + 2] * v[i + 2] * arm[1];
		}
	forces(q, f);
	for (int r = 0; r < ROWS; r++) {
		memset(m[r], 0, sizeof m[r]);
		for (int c = 0; c < ROWS; c++)
			for (int i = 0; i < N; i++)
				m[r][c] += jacobian[r][i] * inverse[i] * jacobian[c][i];
		m[r][ROWS] = -bias[r];
		for (int i = 0; i < N; i++)
			m[r][ROWS] -= jacobian[r][i] * inverse[i] * f[i];
	}
	solve(m, multiplier);
	for (int i = 0; i < N; i++) {
		a[i] = f[i];
		for (int r = 0; r < ROWS; r++)
			a[i] += jacobian[r][i] * multiplier[r];
		a[i] *= inverse[i];
	}
}

static void step(real *q, real *v, real h)
{
	static const real part[4] = {0, 0.5L, 0.5L, 1}, weight[4] = {1, 2, 2, 1};
	real speed[4][N], rate[4][N], place[N];

	for (int k = 0; k < 4; k++) {
		for (int i = 0; i < N; i++) {
			place[i] = q[i] + (k ? part[k] * h * speed[k - 1][i] : 0);
			speed[k][i] = v[i] + (k ? part[k] * h * rate[k - 1][i] : 0);
		}
		accelerations(place, speed[k], rate[k]);
	}
	for (int k = 0; k < 4; k++)
		for (int i = 0; i < N; i++) {
			q[i] += h / 6 * weight[k] * speed[k][i];
			v[i] += h / 6 * weight[k] * rate[k][i];
		}
}

int main(int argc, char **argv)
{
	const long steps = argc > 1 ? strtol(argv[1], NULL, 10) : 160000;
	const real d = 0.028L, da = 0.0115L, e = 0.02L, ea = 0.01421L, rr = 0.007L, ra = 0.00092L;
	const real sa = 0.01874L, sb = 0.01043L, sc = 0.018L, sd = 0.02L, ta = 0.02308L;
	const real tb = 0.00916L, u = 0.04L, ua = 0.01228L, ub = 0.00449L, zf = 0.02L, zt = 0.04L;
	const real fa = 0.01421L;
	const real beta = -0.0617138900142764496L, gamma = 0.455279819163070380L;
	const real phi = 0.222668390165885885L, delta = 0.487364979543842550L;
	const real omega = -phi, epsilon = 1.23054744454982119L;
	const real p = phi + delta, f = omega + epsilon, cb = cosl(beta), sb_ = sinl(beta);
	const real x[BODIES] = {ra * cb,
	                        rr * cb - da * cb,
	                        xb + sa * sinl(gamma) + sb * cosl(gamma),
	                        xa + zt * cosl(delta) + (e - ea) * sinl(p),
	                        xa + ta * cosl(delta) - tb * sinl(delta),
	                        xa + u * sinl(epsilon) + (zf - fa) * cosl(f),
	                        xa + ua * sinl(epsilon) - ub * cosl(epsilon)};
	const real y[BODIES] = {ra * sb_,
	                        rr * sb_ - da * sb_,
	                        yb - sa * cosl(gamma) + sb * sinl(gamma),
	                        ya + zt * sinl(delta) - (e - ea) * cosl(p),
	                        ya + ta * sinl(delta) + tb * cosl(delta),
	                        ya - u * cosl(epsilon) + (zf - fa) * sinl(f),
	                        ya - ua * cosl(epsilon) - ub * sinl(epsilon)};
	const real at[2] = {rr * cb - d * cb, rr * sb_ - d * sb_};
	real q[N], v[N] = {0};

	for (int k = 0; k < BODIES; k++) {
		start[3 * k] = x[k];
		start[3 * k + 1] = y[k];
	}
	add_pin(0, -1, 0, 0);
	add_pin(0, 1, rr * cb, rr * sb_);
	add_pin(2, -1, xb, yb);
	add_pin(4, -1, xa, ya);
	add_pin(6, -1, xa, ya);
	add_pin(4, 3, xa + zt * cosl(delta), ya + zt * sinl(delta));
	add_pin(6, 5, xa + u * sinl(epsilon), ya - u * cosl(epsilon));
	for (int k = 2; k < 6; k++)
		if (k != 4)
			add_pin(1, k, at[0], at[1]);
	spring = point_of(2, xb + sd * cosl(gamma) + sc * sinl(gamma),
	                  yb + sd * sinl(gamma) - sc * cosl(gamma));
	memcpy(q, start, sizeof q);
	for (long k = 0; k < steps; k++)
		step(q, v, 0.03L / steps);
	printf("beta %.16Lg, beta + Theta %.16Lg, gamma %.16Lg, Phi + delta %.16Lg, delta %.16Lg, "
	       "Omega + epsilon %.16Lg, epsilon %.16Lg\n",
	       beta + q[2], beta + q[5], gamma + q[8], p + q[11], delta + q[14], f + q[17],
	       epsilon + q[20]);
	return 0;
}
