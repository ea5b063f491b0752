/* SPDX-License-Identifier: MIT */
#include "located/piece_warm_start.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"

_Static_assert(RB_PIECE_SPIN + 3 == RB_PIECE_WARM_START_ROWS, "all rows of a body");

bool rb_piece_warm_start_reserve(struct rb_located *l)
{
	if (!l->piece)
		l->piece = rb_memory_take((size_t)l->n, sizeof *l->piece);
	if (!l->warm_start)
		l->warm_start = rb_memory_take((size_t)l->n, sizeof *l->warm_start);
	return l->piece && l->warm_start;
}

void rb_piece_warm_start_release(struct rb_located *l)
{
	rb_memory_free(l->warm_start);
	l->warm_start = NULL;
}

void rb_piece_warm_start_keep(const struct rb_located *l, int i, double t)
{
	const int rows = rb_located_row(l);

	if (!l->warm_start || !rb_located_on_piece(l, i) || rb_located_driven(l, i) ||
	    rb_piece_warm_start_at(l, i, t))
		return;
	const struct rb_piece_of *p = &l->piece[i];
	struct rb_piece_warm_start *const past = &l->warm_start[i];
	const double s = t - p->origin_s;

	RB_ASSERT_COSTLY(rows <= RB_PIECE_WARM_START_ROWS);
	past->moment = l->moment;
	past->origin_s = p->origin_s;
	past->length_s = p->piece.length_s;
	past->left_s = t;
	int rate_row[RB_PIECE_WARM_START_ROWS];

	for (int m = 0; m < rows; m++)
		rate_row[m] = m < RB_PIECE_VELOCITY ? p->first + RB_PIECE_VELOCITY + m : -1;
	rb_gauss_some(&p->piece, p->first, rows, s, past->value);
	rb_gauss_rests(&p->piece, p->first, rows, rate_row, s, past->rest);
	const rb_vec3 way = rb_vec3_from(past->value + RB_PIECE_POSITION);
	past->position = rb_vec3_add(p->base, way);
	past->left_out = rb_vec3_lost(p->base, way, past->position);
	for (int k = 0; k < RB_GAUSS_NODES; k++)
		memcpy(past->coefficient[k],
		       p->piece.coefficient + (size_t)k * (size_t)p->piece.n + p->first,
		       (size_t)rows * sizeof(double));
}

const struct rb_piece_warm_start *rb_piece_warm_start_at(const struct rb_located *l, int i,
                                                         double t)
{
	const struct rb_piece_warm_start *const past = l->warm_start ? &l->warm_start[i] : NULL;

	return past && l->moment > 0 && past->moment == l->moment && past->left_s == t ? past
	                                                                               : NULL;
}
