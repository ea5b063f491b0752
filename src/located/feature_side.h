/* SPDX-License-Identifier: MIT */
/*
 * A part of a body in motion, and a contact point that moves: what located/feature takes and gives.
 * Values.
 */
#ifndef RB_LOCATED_FEATURE_SIDE_H
#define RB_LOCATED_FEATURE_SIDE_H

#include <stdint.h>

#include "geom/core.h"
#include "math/quat.h"

/* A part in motion; places from a point of reference, m; velocities in the world's frame. */
struct rb_feature_side {
	const rb_core *core;
	rb_vec3 at; /* of the core's origin */
	rb_mat3 turn;
	rb_vec3 velocity; /* m/s, of that origin */
	rb_vec3 spin;     /* rad/s */
	/* which half of its rims is meant, see rb_feature_half; 0: whichever is lower */
	rb_vec3 half;
};

struct rb_feature_point {
	double gap;                  /* m, between the surfaces */
	rb_vec3 normal, normal_rate; /* from a to b; 1/s */
	rb_vec3 point, point_rate; /* m, m/s, from the reference; of an edge on an edge, half way */
	double inside,
		/* m, m/s: how far from the end of the features; INFINITY, 0: they have none */
		inside_rate;
	uint32_t next;  /* a rb_part: what takes over beyond that end; 0: not known */
	bool next_is_b; /* ... of b's features, else of a's */
};

/* The rim of a cylinder's end that lies flat on a surface. */
struct rb_feature_flat_rim {
	rb_vec3 centre; /* m, from the reference */
	rb_mat3 turn;   /* of its cylinder */
	double radius;  /* m */
	uint64_t key;   /* of the point of it that the side's `half` points to */
};

/* Where a part will be in a moment, s, if it goes straight on. */
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
