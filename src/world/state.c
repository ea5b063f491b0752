/* SPDX-License-Identifier: MIT */
/*
 * All columns lie in one block, so that copy, rollback and hash are one memcpy or one pass over it.
 * Which columns exist follows from RB_STATE_FIELDS by X-macros; adding one there suffices.
 */
#include "world/state.h"

#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"

#include <string.h>

static const struct rb_state_column column_rows[] = {
#define X(name, columns, feature, unit, what) {#name, unit, what, columns, feature},
	RB_STATE_FIELDS(X)
#undef X
};

const struct rb_state_column *rb_state_columns(int *count)
{
	*count = (int)(sizeof column_rows / sizeof column_rows[0]);
	return column_rows;
}

/* Doubles that a column takes: padded to whole cache lines, so that columns are aligned. */
static size_t column_numbers(int body_count, int columns)
{
	return ((size_t)body_count * (size_t)columns + 7) & ~(size_t)7;
}

enum rb_status rb_state_init(struct rb_state *state, int body_count, rb_features features,
                             struct rb_error *err)
{
	size_t numbers = 0;

	*state = (struct rb_state){.body_count = body_count};
#define X(name, columns, feature, unit, what)                \
	if ((feature) == 0u || (features & (feature)) != 0u) \
		numbers += column_numbers(body_count, columns);
	RB_STATE_FIELDS(X)
#undef X
	state->block = rb_memory_take(numbers, sizeof(double));
	if (!state->block)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the state of %d bodies",
		               body_count);
	state->size_bytes = numbers * sizeof(double);

	double *next = state->block;
#define X(name, columns, feature, unit, what)                  \
	if ((feature) == 0u || (features & (feature)) != 0u) { \
		state->name = next;                            \
		next += column_numbers(body_count, columns);   \
	}
	RB_STATE_FIELDS(X)
#undef X
	RB_ASSERT((size_t)(next - state->block) == numbers);
	return RB_OK;
}

void rb_state_release(struct rb_state *state)
{
	rb_memory_free(state->block);
	*state = (struct rb_state){0};
}

void rb_state_copy(struct rb_state *to, const struct rb_state *from)
{
	RB_ASSERT(to->body_count == from->body_count && to->size_bytes == from->size_bytes);

	to->frame = from->frame;
	to->time_s = from->time_s;
	memcpy(to->block, from->block, from->size_bytes);
}

void rb_state_copy_rows(struct rb_state *to, const struct rb_state *from, const int *member,
                        int count)
{
	RB_ASSERT_COSTLY(to->size_bytes == from->size_bytes && count >= 0);

#define X(name, columns, feature, unit, what)                                                    \
	if (from->name)                                                                          \
		for (int k = 0; k < count; k++)                                                  \
			memcpy(to->name + (columns)*member[k], from->name + (columns)*member[k], \
			       (columns) * sizeof(double));
	RB_STATE_FIELDS(X)
#undef X
}

int rb_state_row_size(const struct rb_state *state)
{
	int size = 0;

#define X(name, columns, feature, unit, what) size += state->name ? (columns) : 0;
	RB_STATE_FIELDS(X)
#undef X
	return size;
}

void rb_state_save_rows(const struct rb_state *state, const int *member, int count, double *buffer)
{
	RB_ASSERT_COSTLY(count >= 0 && count <= state->body_count);

#define X(name, columns, feature, unit, what)                             \
	if (state->name)                                                  \
		for (int k = 0; k < count; k++, buffer += (columns))      \
			memcpy(buffer, state->name + (columns)*member[k], \
			       (columns) * sizeof(double));
	RB_STATE_FIELDS(X)
#undef X
}

void rb_state_load_rows(struct rb_state *state, const int *member, int count, const double *buffer)
{
	RB_ASSERT_COSTLY(count >= 0 && count <= state->body_count);

#define X(name, columns, feature, unit, what)                             \
	if (state->name)                                                  \
		for (int k = 0; k < count; k++, buffer += (columns))      \
			memcpy(state->name + (columns)*member[k], buffer, \
			       (columns) * sizeof(double));
	RB_STATE_FIELDS(X)
#undef X
}

/*
 * Bytes of the block that count for the hash: without the columns of callback forces, which come
 * last, if these are zero. A scene whose callbacks apply nothing then has the hash of one without
 * callbacks.
 */
static size_t hashed_bytes(const struct rb_state *state)
{
	const size_t pushes = state->push ? (size_t)(state->push - state->block) : 0;
	const size_t all = state->size_bytes / sizeof(double);

	if (!state->push)
		return state->size_bytes;
	for (size_t i = pushes; i < all; i++)
		if (state->block[i] != 0)
			return state->size_bytes;
	return pushes * sizeof(double);
}

uint64_t rb_state_hash(const struct rb_state *state)
{
	uint64_t hash = rb_hash_bytes(&state->frame, sizeof state->frame, 0);

	hash = rb_hash_bytes(&state->time_s, sizeof state->time_s, hash);
	return rb_hash_bytes(state->block, hashed_bytes(state), hash);
}
