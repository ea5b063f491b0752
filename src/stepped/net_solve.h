/* SPDX-License-Identifier: MIT */
/*
 * The step of a net (stepped/net_system), by Newton's method: corrections with the factors,
 * accelerated by those of earlier trial steps (D. G. Anderson, J. ACM 12 (1965) 547), else by GMRES
 * with the true Jacobian, with a line search until the next correction is shorter. The last one
 * updates impulses linearly, so that velocities, positions and impulses are consistent.
 *
 * Memory is the caller's; any thread.
 */
#ifndef RB_STEPPED_NET_SOLVE_H
#define RB_STEPPED_NET_SOLVE_H

#include "base/arena.h"
#include "stepped/net_system.h"

/* False: not converged, or it would have gained energy. */
bool rb_net_solve(struct rb_net *net, double h_s, struct rb_arena *arena);

#endif
