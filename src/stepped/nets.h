/* SPDX-License-Identifier: MIT */
/*
 * Nets: which springs of a try are solved together (stepped/net_solve), and what becomes of it. A
 * net has all springs that connect its bodies, if the step does not resolve one of them, and no
 * joint holds any of the bodies. If contacts or impacts turn out to hold one, the net is taken
 * back: its springs act each alone, as forces, and those that the step does not resolve may become
 * rows (stepped/spring_steps).
 *
 * Owned by the method's state; of the try under way, in the arena of the step; simulator thread.
 * Where the step resolves all springs there are none.
 */
#ifndef RB_STEPPED_NETS_H
#define RB_STEPPED_NETS_H

#include "stepped/stepped_state.h"
#include "stepped/net_solve.h"

struct rb_nets {
	struct rb_net *net;
	int count;
	int *of;           /* [bodies]: net; -1 */
	int *at;           /* [bodies]: where in its net */
	int *of_spring;    /* [springs]: net; -1 */
	int *at_spring;    /* [springs] */
	int first_element; /* of springs, among elements between bodies */
};

/*
 * Springs that the step does not resolve are known. `here`: bodies of the cohort; `stiff`: springs
 * that the whole step would not resolve, of which this one may be a part.
 */
RB_CHECKED enum rb_status rb_nets_find(struct rb_world *world, const unsigned char *here,
                                       const unsigned char *stiff, double h_s,
                                       struct rb_error *err);
/* What a spring of a net would give alone, N s on its second end. False: it is of none. */
bool rb_nets_take(struct rb_stepped *s, int spring, rb_vec3 alone);
/* All other forces have acted: velocities of what is in nets. */
void rb_nets_solve(struct rb_world *world, double h_s);

/* Something holds a body of it: takes back what has been solved. */
void rb_nets_release(struct rb_world *world, int net);
/* The net of a body that still holds; -1. */
static inline int rb_nets_of(const struct rb_stepped *s, int i)
{
	const int net = s->nets && s->nets->count > 0 ? s->nets->of[i] : -1;

	return net < 0 || s->nets->net[net].released ? -1 : net;
}
/* Bodies move: where springs have turned this one; false: they have not. */
bool rb_nets_turn(struct rb_world *world, int i);
/* Bodies have moved for the last time: what moves to and fro within the step stops. */
void rb_nets_end(struct rb_world *world);
/* Blames bodies of nets that are not solved. */
void rb_nets_blame(struct rb_world *world);

#endif
