/* SPDX-License-Identifier: MIT */
/*
 * One step of a net: bodies that springs connect, of which the step does not resolve all, and that
 * nothing else holds. With d the way from one end of a spring to the other and l its length, 0 and
 * 1 for the beginning and the end of the step, v' a velocity at its end:
 *
 *     m (v' - v - c) = sum of p          I' w' - I w = sum of arms x p
 *     x1 = x0 + h (v + v') / 2           bodies turn by 2 atan(h |w + w'| / 4)
 *     p  = -h T (d0 + d1) / (l0 + l1)    T = k (l - rest) + c (l1 - l0) / h
 *
 * with arms the mean of those of the beginning and the end, and l that of the end; where the step
 * resolves the spring, the mean of both. Then T (l1 - l0) is at least what the spring stores, and
 * momenta are right: energy does not grow, however stiff springs are and however far they turn
 * (J. C. Simo, N. Tarnow, ZAMP 43 (1992) 757; O. Gonzalez, J. Nonlinear Sci. 6 (1996) 449), and
 * what turns under tension keeps its spin. What moves to and fro within the step would do so
 * for ever: dampers of h k / 2 at its end stop it, which make the whole as damping as implicit
 * Euler. Springs of no rest length have p = -h (k d1 + ...), which is linear.
 *
 * The system that is factored (stepped/blocks) is symmetric and positive: the true one but for how
 * directions turn, and without what compressed springs have across. Bodies at whose centres
 * springs act have three unknowns, two of them a block.
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
	bool turns;          /* a spring acts beside its centre of mass */
	double mass, scalar; /* kg; kg m^2: of equal moments, else NAN and `tensor`, in body axes */
	const rb_mat3 *tensor;
	rb_quat from, to;        /* as the step begins, and ends */
	rb_vec3 linear, angular; /* m/s, rad/s: without springs and constant forces */
	rb_vec3 constant;        /* m/s: what constant forces change of it */
	rb_vec3 mean[2];         /* m/s, rad/s: over the step */
	rb_vec3 end[2];          /* as solved */
	rb_vec3 damped[2];       /* and after the dampers of the end */
	/* scratch: sums of impulses, the first unknown, momentum */
	rb_vec3 impulse, turn, spin_momentum, kept[2];
	int block, offset;
};

struct rb_net_spring {
	int body[2]; /* of the net; -1: it stands still, or is driven */
	int number;  /* among springs */
	bool resolved;
	double stiffness, damping, rest;
	rb_vec3 arm[2];            /* m, as the step begins */
	rb_vec3 way[2];            /* m: of ends that are not the net's */
	rb_vec3 from;              /* m: from end to end, as the step begins */
	double length;             /* m: of that */
	rb_vec3 impulse, stopping; /* N s, on the second end: of the spring, of the damper */
	double damped;             /* J: that the spring's own damper has taken */
	rb_vec3 alone;             /* as if nobody else pulled its bodies */
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
	bool solved, released; /* it holds; it has been taken back */
	double gain;           /* J: more than it has had and constant forces have given */
	int factors, solves;
};

/* Vectors of the space in which corrections are sought, and tries learnt from, at most. */
enum { RB_NET_SPACE = 12, RB_NET_PAST = 12 };

struct rb_net_system {
	struct rb_net *net;
	double h;
	struct rb_blocks blocks;
	/* [6 blocks]: right sides and corrections for them, here and at a try; the way to that */
	double *rest, *x, *trial_rest, *trial, *step, *scratch;
	/*
	 * Of GMRES: vectors, each with the system times it; or of tries: ways, how corrections and
	 * right sides have changed on them.
	 */
	double *space;
	int past_count;
	size_t size;
	double size_m; /* of springs and arms */
};

/* Memory and order of elimination; false: none, or too much work. */
bool rb_net_plan(struct rb_net_system *s, struct rb_arena *arena);
/* Three of its unknowns, or six. */
double *rb_net_unknown(double *x, const struct rb_net_body *body);

/* Impulses at the means of velocities; `x`: what equations lack, negative. */
void rb_net_evaluate(struct rb_net_system *s, double *x);
/* Factors of the system there; false: it is not positive. */
bool rb_net_factor(struct rb_net_system *s);

/* `scale` times masses, at poses of the beginning or the end; then springs: J^T stiff J. */
void rb_net_add_masses(struct rb_net_system *s, double scale, bool at_end);
void rb_net_add_spring(struct rb_net_system *s, const struct rb_net_spring *spring, double scale,
                       const rb_mat3 *stiff, const rb_vec3 arm[2]);
/* along n n^T + across (1 - n n^T / n.n) */
rb_mat3 rb_net_stiffness(rb_vec3 n, double along, double across);
/* kg m^2: world axes. */
rb_mat3 rb_net_inertia(const struct rb_net_body *body, rb_quat q);

/* Where ends are as bodies move with their means. */
void rb_net_place_ends(const struct rb_net *net, struct rb_net_spring *spring, double h_s);
rb_quat rb_net_turned(const struct rb_net_body *body, double h_s);
/* kg m^2/s about the centre of mass. */
rb_vec3 rb_net_momentum(const struct rb_net_body *body, rb_quat q, rb_vec3 spin);

/* Sums of impulses on bodies. */
void rb_net_clear_sums(struct rb_net *net);
void rb_net_add_impulse(struct rb_net *net, const struct rb_net_spring *spring, rb_vec3 p,
                        const rb_vec3 arm[2]);

void rb_net_move_means(struct rb_net *net, double part, double *x);
/* m/s: what ends part with where bodies move by x. */
rb_vec3 rb_net_parting(const struct rb_net *net, const struct rb_net_spring *spring, double *x,
                       const rb_vec3 arm[2]);

#endif
