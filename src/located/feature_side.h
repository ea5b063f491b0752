/* SPDX-License-Identifier: MIT */
/*
 * A part of a body in motion, and a moving contact point: arguments and results of located/feature.
 * Values.
 */
#ifndef RB_LOCATED_FEATURE_SIDE_H
#define RB_LOCATED_FEATURE_SIDE_H

#include <stdint.h>

#include "geom/core.h"
#include "math/quat.h"

/* A part in motion; positions relative to a reference point, m; velocities in the world's frame. */
struct rb_feature_side {
	const rb_core *core;
	rb_vec3 at; /* position of the core's origin */
	rb_mat3 turn;
	rb_vec3 velocity; /* m/s, of that origin */
	rb_vec3 spin;     /* rad/s */
	/* direction of the half of its rims that is meant, see rb_feature_half; 0: the lower one */
	rb_vec3 half;
};

struct rb_feature_point {
	double gap;                  /* m, between the surfaces */
	rb_vec3 normal, normal_rate; /* from a to b; 1/s */
	rb_vec3 point, point_rate;   /* m, m/s, relative to the reference; of two edges, half way */
	double inside,
		/* m, m/s: distance from the end of the features; INFINITY, 0: they have none */
		inside_rate;
	uint32_t next;  /* an rb_part: the feature beyond that end; 0: unknown */
	bool next_is_b; /* it replaces b's feature, else a's */
};

/* The rim of a cylinder's end that lies flat on a surface. */
struct rb_feature_flat_rim {
	rb_vec3 centre; /* m, relative to the reference */
	rb_mat3 turn;   /* of its cylinder */
	double radius;  /* m */
	uint64_t key;   /* of its point in the direction of the side's `half` */
};

/* The part s seconds later, at constant velocities. */
static inline struct rb_feature_side rb_feature_later(const struct rb_feature_side *side, double s)
{
	const rb_mat3 turn = rb_quat_to_mat3(
		rb_quat_unit(rb_quat_from_turn(rb_vec3_scale(s, side->spin))));
	struct rb_feature_side later = *side;

	later.at = rb_vec3_add_scaled(side->at, s, side->velocity);
	later.turn = rb_mat3_multiply(&turn, &side->turn);
	return later;
}

static inline rb_placed rb_feature_placed(const struct rb_feature_side *side)
{
	return (rb_placed){side->core, side->at, side->turn};
}

#endif
