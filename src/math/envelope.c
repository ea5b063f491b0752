/* SPDX-License-Identifier: MIT */
/*
 * Loops over the rows of a block are compiled for each pitch (FOR_EACH_PITCH), with pairs of rows
 * in a register.
 */
#include "math/envelope.h"

#include "base/error.h"

#define INLINE static inline __attribute__((always_inline))

/* Calls `what` with the pitch as a constant. */
#define FOR_EACH_PITCH(what, pitch, ...) \
	switch (pitch) {                 \
	case 2:                          \
		what(2, __VA_ARGS__);    \
		break;                   \
	case 4:                          \
		what(4, __VA_ARGS__);    \
		break;                   \
	default:                         \
		what(6, __VA_ARGS__);    \
		break;                   \
	}

typedef double pair __attribute__((vector_size(2 * sizeof(double)), aligned(8)));

/* A column of a block: two rows each. */
struct column {
	pair pair[RB_ENVELOPE_BLOCK / 2];
};

size_t rb_envelope_lay_out(struct rb_envelope *e)
{
	size_t count = 0;

	for (int i = 0; i < e->block_count; i++) {
		struct rb_envelope_block *const b = &e->block[i];
		const int end = b->begin + b->count;

		RB_ASSERT_COSTLY(b->count > 0 && b->count <= RB_ENVELOPE_BLOCK);
		RB_ASSERT_COSTLY(b->first >= 0 && b->first <= b->begin && end <= e->n);
		b->at = count;
		b->pitch = b->count + b->count % 2;
		count += (size_t)(end - b->first) * (size_t)b->pitch;
		for (int r = b->begin; r < end; r++)
			e->of[r] = i;
	}
	return count;
}

INLINE void load(int pitch, struct column *to, const double *from)
{
	for (int p = 0; p < pitch / 2; p++)
		to->pair[p] = *(const pair *)(from + 2 * p);
}

INLINE void store(int pitch, double *to, const struct column *from)
{
	for (int p = 0; p < pitch / 2; p++)
		*(pair *)(to + 2 * p) = from->pair[p];
}

INLINE void subtract(int pitch, struct column *to, const double *from, double share)
{
	const pair shares = {share, share};

	for (int p = 0; p < pitch / 2; p++)
		to->pair[p] -= shares * *(const pair *)(from + 2 * p);
}

/* Turns the columns of a block before its own rows into those of L D. */
INLINE void factor_before(int pitch, const struct rb_envelope *e, const struct rb_envelope_block *b,
                          double *panel)
{
	for (int c = b->first; c < b->begin; c++) {
		const struct rb_envelope_block *const other = &e->block[e->of[c]];
		const int from = b->first > other->first ? b->first : other->first;
		double *const at = panel + (c - b->first) * pitch;
		const double *before = panel + (from - b->first) * pitch;
		size_t stride;
		const double *share = rb_envelope_row(e, c, &stride) +
		                      (size_t)(from - other->first) * stride;
		struct column sum;

		load(pitch, &sum, at);
		for (; before < at; before += pitch, share += stride)
			subtract(pitch, &sum, before, *share);
		store(pitch, at, &sum);
	}
}

/* Factors its own columns, and D; then turns all into those of L. */
INLINE void factor_own(int pitch, struct rb_envelope *e, const struct rb_envelope_block *b,
                       double *panel, double least, bool *good)
{
	const int before = b->begin - b->first;
	double *const pivot = e->pivot + b->first;

	for (int c = 0; c < b->count; c++) {
		double *const at = panel + (before + c) * pitch;
		const double whole = at[c], *of = pivot;
		struct column sum;

		load(pitch, &sum, at);
		for (const double *from = panel; from < at; from += pitch)
			subtract(pitch, &sum, from, from[c] / *of++);
		store(pitch, at, &sum);
		*good = *good && at[c] > least * whole;
		pivot[before + c] = at[c];
	}
	for (int k = 0; k < before + b->count; k++)
		for (int r = 0; r < pitch; r++)
			panel[k * pitch + r] /= pivot[k];
}

INLINE void factor_block(int pitch, struct rb_envelope *e, const struct rb_envelope_block *b,
                         double least, bool *good)
{
	factor_before(pitch, e, b, e->value + b->at);
	factor_own(pitch, e, b, e->value + b->at, least, good);
}

bool rb_envelope_factor(struct rb_envelope *e, double least)
{
	bool good = true;

	for (int i = 0; i < e->block_count && good; i++) {
		const struct rb_envelope_block *const b = &e->block[i];

		FOR_EACH_PITCH(factor_block, b->pitch, e, b, least, &good)
	}
	return good;
}

/* Forward substitution of the block's x. */
INLINE void forward(int pitch, const struct rb_envelope_block *b, const double *panel, double *x)
{
	struct column sum = {{{0, 0}, {0, 0}, {0, 0}}};
	double of[RB_ENVELOPE_BLOCK];

	for (int k = b->first; k < b->begin; k++, panel += pitch)
		subtract(pitch, &sum, panel, x[k]);
	store(pitch, of, &sum);
	for (int c = 0; c < b->count; c++, panel += pitch) {
		x[b->begin + c] += of[c];
		for (int r = c + 1; r < b->count; r++)
			of[r] -= panel[r] * x[b->begin + c];
	}
}

/* Back substitution of the block's x, subtracted from the rows before. */
INLINE void backward(int pitch, const struct rb_envelope_block *b, const double *panel, double *x)
{
	const double *const own = panel + (b->begin - b->first) * pitch;
	double at[RB_ENVELOPE_BLOCK] = {0};

	for (int c = b->count; c-- > 0;) {
		at[c] = x[b->begin + c];
		for (int r = c + 1; r < b->count; r++)
			at[c] -= own[c * pitch + r] * at[r];
		x[b->begin + c] = at[c];
	}
	for (int k = b->first; k < b->begin; k++, panel += pitch) {
		double sum = panel[0] * at[0];

		for (int r = 1; r < pitch; r++)
			sum += panel[r] * at[r];
		x[k] -= sum;
	}
}

void rb_envelope_solve(const struct rb_envelope *e, double *x)
{
	for (int i = 0; i < e->block_count; i++) {
		const struct rb_envelope_block *const b = &e->block[i];

		FOR_EACH_PITCH(forward, b->pitch, b, e->value + b->at, x)
	}
	for (int r = 0; r < e->n; r++)
		x[r] /= e->pivot[r];
	for (int i = e->block_count; i-- > 0;) {
		const struct rb_envelope_block *const b = &e->block[i];

		FOR_EACH_PITCH(backward, b->pitch, b, e->value + b->at, x)
	}
}
