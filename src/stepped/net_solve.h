/* SPDX-License-Identifier: MIT */
/*
 * The step of a net (stepped/net_system), by Newton's method: corrections with the factors and with
 * what tries have shown of how these err (D. G. Anderson, J. ACM 12 (1965) 547), else GMRES with
 * the true system, as far as the next correction gets shorter. The last one enters impulses
 * linearly, so that velocities, positions and impulses agree.
 *
 * Memory is the caller's; any thread.
 */
#ifndef RB_STEPPED_NET_SOLVE_H
#define RB_STEPPED_NET_SOLVE_H

#include "base/arena.h"
#include "stepped/net_system.h"

/* False: it is not solved, or it would have gained. */
bool rb_net_solve(struct rb_net *net, double h_s, struct rb_arena *arena);

#endif
