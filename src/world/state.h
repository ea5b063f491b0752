/* SPDX-License-Identifier: MIT */
/*
 * All that a step changes and the future depends on, in one block.
 *
 * The columns are listed once, here; allocation, copy, hash and rollback follow the list. A column
 * that the scene's features do not need is NULL and takes no room. Owned by the world; rows are by
 * body index, moving bodies only. During a step a row belongs to the worker that runs the body's
 * group.
 */
#ifndef RB_WORLD_STATE_H
#define RB_WORLD_STATE_H

#include <stddef.h>
#include <stdint.h>

#include <rbsim/model.h>

/* X(name, columns, needs any of these features (0: always), unit, what) */
#define RB_STATE_FIELDS(X)                                                       \
	X(position, 3, 0u, "m", "centre of mass, world axes")                    \
	X(velocity, 3, 0u, "m/s", "of the centre of mass")                       \
	X(orientation, 4, RB_FEATURE_ROTATION, "1", "unit quaternion, w first")  \
	X(spin, 3, RB_FEATURE_ROTATION, "rad/s", "angular velocity, world axes") \
	X(push, 3, RB_FEATURE_PUSHES, "N", "force from callbacks, for one step") \
	X(twist, 3, RB_FEATURE_PUSHES, "N m", "torque of it about the centre of mass")

struct rb_state {
	uint64_t frame; /* k: the frame reached */
	double time_s;
	int body_count;
	size_t size_bytes;
	double *block; /* owned; the columns below point into it */
#define X(name, columns, feature, unit, what) double *name;
	RB_STATE_FIELDS(X)
#undef X
};

RB_CHECKED enum rb_status rb_state_init(struct rb_state *state, int body_count,
                                        rb_features features, struct rb_error *err);
void rb_state_release(struct rb_state *state);

/* Both of the same model. */
void rb_state_copy(struct rb_state *to, const struct rb_state *from);

/* Copies the rows of `count` bodies. */
void rb_state_copy_rows(struct rb_state *to, const struct rb_state *from, const int *member,
                        int count);

/* Doubles that a row takes over all columns. */
int rb_state_row_size(const struct rb_state *state);
/* Rows of `count` bodies to and from a plain buffer of count * row_size doubles. */
void rb_state_save_rows(const struct rb_state *state, const int *member, int count, double *buffer);
void rb_state_load_rows(struct rb_state *state, const int *member, int count, const double *buffer);

/* Pushes that are zero are left out. */
uint64_t rb_state_hash(const struct rb_state *state);

/* One row a column, for `rbsim check`. */
struct rb_state_column {
	const char *name, *unit, *what;
	int columns;
	rb_features feature; /* needed, any of; 0: always there */
};
const struct rb_state_column *rb_state_columns(int *count);

#endif
