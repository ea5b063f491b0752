/* SPDX-License-Identifier: MIT */
/*
 * Ordinary differential equations that tests solve on their own, to compare with: the classical Runge-Kutta method
 * (Hairer, Norsett, Wanner, "Solving Ordinary Differential Equations I", II.1) with steps so small that rounding rules.
 */
#ifndef RB_TESTS_RUNGE_H
#define RB_TESTS_RUNGE_H

enum { RUNGE_MOST = 16 };
typedef void runge_rates(const void *user, double t, const double *y, double *rate);

static inline void runge_solve(runge_rates *rates, const void *user, int n, double *y, double from,
                               double to, int steps)
{
	const double h = (to - from) / steps;
	double k[4][RUNGE_MOST], x[RUNGE_MOST];

	for (int s = 0; s < steps; s++) {
		const double t = from + (to - from) * s / steps;

		rates(user, t, y, k[0]);
		for (int i = 0; i < n; i++)
			x[i] = y[i] + 0.5 * h * k[0][i];
		rates(user, t + 0.5 * h, x, k[1]);
		for (int i = 0; i < n; i++)
			x[i] = y[i] + 0.5 * h * k[1][i];
		rates(user, t + 0.5 * h, x, k[2]);
		for (int i = 0; i < n; i++)
			x[i] = y[i] + h * k[2][i];
		rates(user, t + h, x, k[3]);
		for (int i = 0; i < n; i++)
			y[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
	}
}

#endif
