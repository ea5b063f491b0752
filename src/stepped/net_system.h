/* SPDX-License-Identifier: MIT */
/*
 * One step of a net: bodies connected by springs, some of which the step does not resolve, without
 * any other constraint. With d the vector from one end of a spring to the other and l its length, 0
 * and 1 for the beginning and the end of the step, v' a velocity at its end, c the change by
 * constant forces:
 *
 *     m (v' - v - c) = sum of p          I' w' - I w = sum of arms x p
 *     x1 = x0 + h (v + v') / 2           bodies turn by 2 atan(h |w + w'| / 4)
 *     p  = -h T (d0 + d1) / (l0 + l1)    T = k (l - rest) + c (l1 - l0) / h
 *
 * with arms the mean of those of the beginning and the end, and l that of the end; if the step
 * resolves the spring, the mean of both. Then T (l1 - l0) is at least the change of the spring's
 * energy, and momenta are exact: energy does not grow, however stiff springs are and however far
 * they turn (J. C. Simo, N. Tarnow, ZAMP 43 (1992) 757; O. Gonzalez, J. Nonlinear Sci. 6 (1996)
 * 449), and bodies rotating under tension keep their spin. Oscillations faster than the step would
 * persist: dampers of h k / 2 at its end stop them, which makes the whole as damping as implicit
 * Euler. Springs of no rest length have p = -h (k d1 + ...), which is linear.
 *
 * The factored system (stepped/blocks) is symmetric and positive: the Jacobian without the terms of
 * turning directions, and without the transverse stiffness of compressed springs. Bodies on which
 * springs act at their centres alone have three unknowns, two of them a block.
 *
 * Memory is the caller's; any thread.
 */
#ifndef RB_STEPPED_NET_SYSTEM_H
#define RB_STEPPED_NET_SYSTEM_H

#include "math/mat3.h"
#include "math/quat.h"
#include "stepped/blocks.h"

struct rb_net_body {
	int index;           /* of the model */
	bool turns;          /* a spring acts off its centre of mass */
	double mass, scalar; /* kg; kg m^2: of equal moments, else NAN and `tensor`, in body axes */
	const rb_mat3 *tensor;
	rb_quat from, to;        /* as the step begins, and ends */
	rb_vec3 linear, angular; /* m/s, rad/s: without springs and constant forces */
	rb_vec3 constant;        /* m/s: change by constant forces */
	rb_vec3 mean[2];         /* m/s, rad/s: over the step */
	rb_vec3 end[2];          /* as solved */
	rb_vec3 damped[2];       /* and after the dampers of the end */
	/* scratch: sums of impulses, the first unknown, momentum */
	rb_vec3 impulse, turn, spin_momentum, kept[2];
	int block, offset;
};

struct rb_net_spring {
	int body[2]; /* of the net; -1: static or driven */
	int number;  /* among springs */
	bool resolved;
	double stiffness, damping, rest;
	rb_vec3 arm[2];            /* m, as the step begins */
	rb_vec3 displacement[2];   /* m: displacement of ends that are not in the net */
	rb_vec3 from;              /* m: from end to end, as the step begins */
	double length;             /* m: length of that */
	rb_vec3 impulse, stopping; /* N s, on the second end: of the spring, of the damper */
	double damped;             /* J: dissipated by the spring's own damper */
	rb_vec3 alone;             /* as if no other spring acted on its bodies */
	/* scratch: m: as the step ends; of both; N/m */
	rb_vec3 arm_to[2], arm_mean[2], to;
	double length_to;
	rb_mat3 stiff;
	rb_vec3 stiff_arm[2];
};

struct rb_net {
	struct rb_net_body *body;
	struct rb_net_spring *spring;
	int body_count, spring_count;
	bool solved, released; /* `released`: its solution has been undone */
	double gain;           /* J: energy gain beyond the work of constant forces */
	int factors, solves;
};

/* Largest number of Krylov vectors, and of steps kept for acceleration. */
enum { RB_NET_SPACE = 12, RB_NET_PAST = 12 };

struct rb_net_system {
	struct rb_net *net;
	double h;
	struct rb_blocks blocks;
	/*
	 * [6 blocks]: right-hand sides and corrections, here and at a trial point; the step to that
	 */
	double *rest, *x, *trial_rest, *trial, *step, *scratch;
	/*
	 * Of GMRES: vectors, each with its product with the system; or of earlier steps: changes of
	 * right-hand sides and of corrections.
	 */
	double *space;
	int past_count;
	size_t size;
	double size_m; /* largest length of springs */
};

/* Takes memory and finds the order of elimination; false: no memory, or too much work. */
bool rb_net_plan(struct rb_net_system *s, struct rb_arena *arena);
/* Unknowns of a body: three or six. */
double *rb_net_unknown(double *x, const struct rb_net_body *body);

/* Computes impulses at the mean velocities; `x`: negative residuals of the equations. */
void rb_net_evaluate(struct rb_net_system *s, double *x);
/* Factors the system there; false: not positive definite. */
bool rb_net_factor(struct rb_net_system *s);

/*
 * Sets the system to `scale` times masses, at poses of the beginning or the end; then adds springs:
 * J^T stiff J.
 */
void rb_net_add_masses(struct rb_net_system *s, double scale, bool at_end);
void rb_net_add_spring(struct rb_net_system *s, const struct rb_net_spring *spring, double scale,
                       const rb_mat3 *stiff, const rb_vec3 arm[2]);
/* along n n^T + across (1 - n n^T / n.n) */
rb_mat3 rb_net_stiffness(rb_vec3 n, double along, double across);
/* kg m^2: world axes. */
rb_mat3 rb_net_inertia(const struct rb_net_body *body, rb_quat q);

/* Places the ends of a spring as bodies move with their mean velocities. */
void rb_net_place_ends(const struct rb_net *net, struct rb_net_spring *spring, double h_s);
rb_quat rb_net_turned(const struct rb_net_body *body, double h_s);
/* kg m^2/s about the centre of mass. */
rb_vec3 rb_net_momentum(const struct rb_net_body *body, rb_quat q, rb_vec3 spin);

/* Sums of impulses on bodies. */
void rb_net_clear_sums(struct rb_net *net);
void rb_net_add_impulse(struct rb_net *net, const struct rb_net_spring *spring, rb_vec3 p,
                        const rb_vec3 arm[2]);

void rb_net_move_means(struct rb_net *net, double part, double *x);
/* m/s: relative velocity of the ends if bodies move by x. */
rb_vec3 rb_net_relative_velocity(const struct rb_net *net, const struct rb_net_spring *spring,
                                 double *x, const rb_vec3 arm[2]);

#endif
