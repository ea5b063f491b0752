/* SPDX-License-Identifier: MIT */
/*
 * The governor of scenes/verify/J15_governor.lua and tests/bench/iftomm.sh (A05). It stays symmetric
 * and keeps its angular momentum about the shaft, which leaves two coordinates: the rods' angle
 * below the horizontal and the slider's height. Lagrange's equations, Runge and Kutta's method with
 * steps of equal length and numbers of 64 binary digits (x87). Half as many steps differ by 3e-17.
 *
 *     cc -O2 governor.c -lm && ./a.out 10 4000000
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef long double real;

static const real g = 9.81L, stiffness = 8e5L, damping = 4e4L, rest = 0.5L;
static const real half = 0.05L; /* of the slider, and from the axis to the rods' hinges */
static const real rod = 0.3L, ball = 5, slider = 3, shaft = 0.3L;
static const real side2 = 1e-4L; /* of rods and shaft, squared */
static real momentum;            /* about the shaft */

/* Moment of inertia about the shaft, and its slope with the rods' angle. */
static real about_shaft(real angle, real *slope)
{
	const real c = cosl(angle), s = sinl(angle);
	const real across = rod * (1 + side2) / 12, along = rod * side2 / 6;
	const real r = half + c / 2, R = half + c;
	const real one = rod * r * r + ball * R * R + across * c * c + along * s * s;

	*slope = 2 * (-rod * r * s - 2 * ball * R * s - 2 * (across - along) * c * s);
	return 2 * one + slider * 0.01L / 6 + shaft * side2 / 6;
}

/* q: angle, height, their speeds */
static void rates(const real *q, real *f)
{
	const real c = cosl(q[0]), s = sinl(q[0]);
	const real across = rod * (1 + side2) / 12;
	const real inertia = 2 * (rod / 4 + ball + across);
	real slope;
	const real J = about_shaft(q[0], &slope), spin = momentum / J;
	/* from the slider's side to the rod's middle */
	const real x = c / 2, z = 1 - s / 2 - q[1];
	const real vx = -s / 2 * q[2], vz = -c / 2 * q[2] - q[3];
	const real length = sqrtl(x * x + z * z);
	const real pull = stiffness * (length - rest) + damping * (x * vx + z * vz) / length;

	f[0] = q[2];
	f[1] = q[3];
	/* two springs, two rods and balls */
	f[2] = (spin * spin * slope / 2 + 2 * (rod / 2 + ball) * g * c -
	        2 * pull * (x * -s / 2 + z * -c / 2) / length) /
	       inertia;
	f[3] = 2 * pull * z / length / slider - g;
}

int main(int count, char **argument)
{
	const real end = count > 1 ? strtold(argument[1], NULL) : 10;
	const long steps = count > 2 ? strtol(argument[2], NULL, 10) : 4000000;
	const real h = end / (real)steps, pi = acosl(-1);
	real q[4] = {pi / 6, 0.5L, 0, 0}, unused;

	momentum = 2 * pi * about_shaft(q[0], &unused);
	for (long k = 0; k < steps; k++) {
		real a[4][4], p[4];

		rates(q, a[0]);
		for (int stage = 1; stage < 4; stage++) {
			for (int i = 0; i < 4; i++)
				p[i] = q[i] + (stage == 3 ? h : h / 2) * a[stage - 1][i];
			rates(p, a[stage]);
		}
		for (int i = 0; i < 4; i++)
			q[i] += h / 6 * (a[0][i] + 2 * a[1][i] + 2 * a[2][i] + a[3][i]);
	}
	printf("angle %.18Lg rad, height %.18Lg m, spin %.18Lg rad/s\n", q[0], q[1],
	       momentum / about_shaft(q[0], &unused));
	return 0;
}
