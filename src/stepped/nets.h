/* SPDX-License-Identifier: MIT */
/*
 * Nets: sets of springs that are solved together (stepped/net_solve) in an attempt, and their
 * results. A net has all springs that connect its bodies, if the step does not resolve one of them,
 * and no joint is attached to any of the bodies. If contacts or impacts turn out to act on one, the
 * net is released: its springs act each alone, as forces, and those that the step does not resolve
 * may become rows (stepped/spring_steps).
 *
 * Owned by the method's state; of the present attempt, in the arena of the step; simulator thread.
 * Where the step resolves all springs there are no nets.
 */
#ifndef RB_STEPPED_NETS_H
#define RB_STEPPED_NETS_H

#include "stepped/stepped_state.h"
#include "stepped/net_solve.h"

struct rb_nets {
	struct rb_net *net;
	int count;
	int *of;           /* [bodies]: net; -1 */
	int *at;           /* [bodies]: index in its net */
	int *of_spring;    /* [springs]: net; -1 */
	int *at_spring;    /* [springs] */
	int first_element; /* of springs, among elements between bodies */
};

/*
 * Finds nets, once springs that the step does not resolve are known. `here`: bodies of the cohort;
 * `stiff`: springs that the whole step, of which this one may be a part, would not resolve.
 */
RB_CHECKED enum rb_status rb_nets_find(struct rb_world *world, const unsigned char *here,
                                       const unsigned char *stiff, double h_s,
                                       struct rb_error *err);
/*
 * Records the impulse of a net's spring acting alone, N s on its second end. False: it is in no
 * net.
 */
bool rb_nets_record(struct rb_stepped *s, int spring, rb_vec3 alone);
/* Solves the velocities of nets, after all other forces have acted. */
void rb_nets_solve(struct rb_world *world, double h_s);

/* Undoes the solution of a net, one of whose bodies has contacts or impacts. */
void rb_nets_release(struct rb_world *world, int net);
/* The net of a body, if not released; -1: none. */
static inline int rb_nets_of(const struct rb_stepped *s, int i)
{
	const int net = s->nets && s->nets->count > 0 ? s->nets->of[i] : -1;

	return net < 0 || s->nets->net[net].released ? -1 : net;
}
/* As bodies move: sets a body's orientation by its net; false: it has none. */
bool rb_nets_turn(struct rb_world *world, int i);
/* After bodies have moved for the last time: stops unresolved oscillations. */
void rb_nets_end(struct rb_world *world);
/* Blames the bodies of unsolved nets for the failure of the step. */
void rb_nets_blame(struct rb_world *world);

#endif
