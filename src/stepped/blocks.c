/* SPDX-License-Identifier: MIT */
#include "stepped/blocks.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/error.h"

enum { WORD = 64 };

/* ---- order of elimination ---- */

struct graph {
	int count, words;
	uint64_t *bit; /* [count][words]: neighbours that are left, and the body itself */
	int *degree;   /* -1: eliminated */
	int *order;    /* [count]: body at each place */
};

static uint64_t *row_of(const struct graph *graph, int i)
{
	return graph->bit + (size_t)i * (size_t)graph->words;
}

static int count_bits(const uint64_t *row, int words)
{
	int count = 0;

	for (int w = 0; w < words; w++)
		count += __builtin_popcountll(row[w]);
	return count;
}

static void set_bit(uint64_t *row, int i)
{
	RB_ASSERT_COSTLY(i >= 0);
	row[i / WORD] |= (uint64_t)1 << (i % WORD);
}

static void clear_bit(uint64_t *row, int i)
{
	row[i / WORD] &= ~((uint64_t)1 << (i % WORD));
}

/* Joins the neighbours of `k` to each other and takes k out. */
static void eliminate(struct graph *graph, int k)
{
	const uint64_t *mine = row_of(graph, k);

	RB_ASSERT_COSTLY(k >= 0 && k < graph->count);
	for (int w = 0; w < graph->words; w++)
		for (uint64_t left = mine[w]; left; left &= left - 1) {
			const int i = w * WORD + __builtin_ctzll(left);
			uint64_t *other = row_of(graph, i);

			if (i == k)
				continue;
			for (int x = 0; x < graph->words; x++)
				other[x] |= mine[x];
			clear_bit(other, k);
			graph->degree[i] = count_bits(other, graph->words);
		}
	graph->degree[k] = -1;
}

static int least_degree(const struct graph *graph)
{
	int best = -1;

	for (int i = 0; i < graph->count; i++)
		if (graph->degree[i] >= 0 && (best < 0 || graph->degree[i] < graph->degree[best]))
			best = i;
	return best;
}

/*
 * Orders all; the rows of eliminated bodies keep what was left of their neighbours then. Returns
 * blocks, 0: too much.
 */
static int order_all(struct graph *graph, struct rb_blocks *blocks, double max)
{
	const double cube = RB_BLOCK * RB_BLOCK * RB_BLOCK;
	int total = 0;

	blocks->work = 0;
	for (int place = 0; place < graph->count; place++) {
		const int k = least_degree(graph);
		const double degree = graph->degree[k];

		blocks->work += 0.5 * cube * degree * (degree + 1);
		if (blocks->work > max)
			return 0;
		total += graph->degree[k];
		graph->order[place] = k;
		blocks->place[k] = place;
		eliminate(graph, k);
	}
	return total;
}

static void sort_places(int *row, int count)
{
	for (int i = 1; i < count; i++) {
		const int at = row[i];
		int k = i;

		for (; k > 0 && row[k - 1] > at; k--)
			row[k] = row[k - 1];
		row[k] = at;
	}
}

static void fill_columns(const struct graph *graph, struct rb_blocks *blocks)
{
	int at = 0;

	for (int place = 0; place < graph->count; place++) {
		const uint64_t *mine = row_of(graph, graph->order[place]);
		const int begin = at;

		blocks->first[place] = at;
		for (int w = 0; w < graph->words; w++)
			for (uint64_t left = mine[w]; left; left &= left - 1)
				blocks->row[at++] = blocks->place[w * WORD + __builtin_ctzll(left)];
		sort_places(blocks->row + begin, at - begin);
	}
	blocks->first[graph->count] = at;
}

bool rb_blocks_plan(struct rb_blocks *blocks, int count, const int (*pair)[2], int pair_count,
                    double max, struct rb_arena *arena)
{
	struct graph graph = {.count = count, .words = (count + WORD - 1) / WORD};
	const size_t n = (size_t)count, words = n * (size_t)graph.words;

	RB_ASSERT(count > 0 && pair_count >= 0 && max > 0);
	*blocks = (struct rb_blocks){.count = count};
	blocks->place = rb_arena_take(arena, n, sizeof *blocks->place);
	blocks->first = rb_arena_take(arena, n + 1, sizeof *blocks->first);
	graph.bit = rb_arena_take(arena, words, sizeof *graph.bit);
	graph.degree = rb_arena_take(arena, n, sizeof *graph.degree);
	graph.order = rb_arena_take(arena, n, sizeof *graph.order);
	if (!blocks->place || !blocks->first || !graph.bit || !graph.degree || !graph.order)
		return false;
	memset(graph.bit, 0, words * sizeof *graph.bit);
	for (int i = 0; i < count; i++)
		set_bit(row_of(&graph, i), i);
	for (int p = 0; p < pair_count; p++) {
		set_bit(row_of(&graph, pair[p][0]), pair[p][1]);
		set_bit(row_of(&graph, pair[p][1]), pair[p][0]);
	}
	for (int i = 0; i < count; i++)
		graph.degree[i] = count_bits(row_of(&graph, i), graph.words);
	const int total = order_all(&graph, blocks, max);
	if (total == 0)
		return false;
	blocks->row = rb_arena_take(arena, (size_t)total, sizeof *blocks->row);
	blocks->value = rb_arena_take(arena, (size_t)total, sizeof *blocks->value);
	if (!blocks->row || !blocks->value)
		return false;
	fill_columns(&graph, blocks);
	return true;
}

/* ---- numbers ---- */

void rb_blocks_clear(struct rb_blocks *blocks)
{
	memset(blocks->value, 0, (size_t)blocks->first[blocks->count] * sizeof *blocks->value);
}

rb_block *rb_blocks_at(struct rb_blocks *blocks, int a, int b, bool *turned)
{
	int column = blocks->place[a], row = blocks->place[b];

	*turned = column <= row; /* kept as (row, column) = (b, a) */
	if (column > row) {
		column = blocks->place[b];
		row = blocks->place[a];
	}
	int low = blocks->first[column], high = blocks->first[column + 1] - 1;
	while (low < high) {
		const int middle = low + (high - low) / 2;

		if (blocks->row[middle] < row)
			low = middle + 1;
		else
			high = middle;
	}
	return &blocks->value[low];
}

/* A pivot that leaves nothing of an unknown, with room for its square. */
static const double dropped_root = 1e150;

/* Cholesky's factor of a diagonal block, in its lower half. */
static bool factor_diagonal(rb_block *d, double *least)
{
	for (int j = 0; j < RB_BLOCK; j++) {
		double sum = d->m[j][j];

		for (int k = 0; k < j; k++)
			sum -= d->m[j][k] * d->m[j][k];
		const bool depends = least && sum <= least[j];

		if (!(sum > 0) && !depends)
			return false;
		const double root = depends ? dropped_root : sqrt(sum);
		if (depends)
			least[j] = (double)INFINITY;
		d->m[j][j] = root;
		for (int i = j + 1; i < RB_BLOCK; i++) {
			double s = d->m[i][j];

			for (int k = 0; k < j; k++)
				s -= d->m[i][k] * d->m[j][k];
			d->m[i][j] = s / root;
		}
	}
	return true;
}

/* b := b d^-T */
static void divide(rb_block *b, const rb_block *d)
{
	for (int i = 0; i < RB_BLOCK; i++)
		for (int j = 0; j < RB_BLOCK; j++) {
			double s = b->m[i][j];

			for (int k = 0; k < j; k++)
				s -= b->m[i][k] * d->m[j][k];
			b->m[i][j] = s / d->m[j][j];
		}
}

/* c -= a b^T */
static void subtract(rb_block *c, const rb_block *a, const rb_block *b)
{
	rb_block t;

	for (int i = 0; i < RB_BLOCK; i++)
		for (int j = 0; j < RB_BLOCK; j++)
			t.m[j][i] = b->m[i][j];
	for (int i = 0; i < RB_BLOCK; i++)
		for (int k = 0; k < RB_BLOCK; k++) {
			const double x = a->m[i][k];

			for (int j = 0; j < RB_BLOCK; j++)
				c->m[i][j] -= x * t.m[k][j];
		}
}

bool rb_blocks_factor(struct rb_blocks *blocks)
{
	for (int c = 0; c < blocks->count; c++) {
		const int first = blocks->first[c], end = blocks->first[c + 1];

		if (!factor_diagonal(&blocks->value[first],
		                     blocks->least ? blocks->least + RB_BLOCK * c : NULL))
			return false;
		for (int i = first + 1; i < end; i++)
			divide(&blocks->value[i], &blocks->value[first]);
		for (int j = first + 1; j < end; j++) {
			int at = blocks->first[blocks->row[j]];

			for (int i = j; i < end; i++) {
				while (blocks->row[at] != blocks->row[i])
					at++;
				subtract(&blocks->value[at], &blocks->value[i], &blocks->value[j]);
			}
		}
	}
	return true;
}

void rb_blocks_solve(const struct rb_blocks *blocks, double *x, double *scratch)
{
	double *const y = scratch;

	for (int i = 0; i < blocks->count; i++)
		memcpy(y + RB_BLOCK * blocks->place[i], x + RB_BLOCK * i, RB_BLOCK * sizeof *x);
	for (int c = 0; c < blocks->count; c++) {
		const rb_block *d = &blocks->value[blocks->first[c]];
		double *const at = y + RB_BLOCK * c;

		for (int i = 0; i < RB_BLOCK; i++) {
			for (int k = 0; k < i; k++)
				at[i] -= d->m[i][k] * at[k];
			at[i] /= d->m[i][i];
		}
		for (int e = blocks->first[c] + 1; e < blocks->first[c + 1]; e++)
			for (int i = 0; i < RB_BLOCK; i++)
				for (int k = 0; k < RB_BLOCK; k++)
					y[RB_BLOCK * blocks->row[e] + i] -=
						blocks->value[e].m[i][k] * at[k];
	}
	for (int c = blocks->count; c-- > 0;) {
		const rb_block *d = &blocks->value[blocks->first[c]];
		double *const at = y + RB_BLOCK * c;

		for (int e = blocks->first[c] + 1; e < blocks->first[c + 1]; e++)
			for (int i = 0; i < RB_BLOCK; i++)
				for (int k = 0; k < RB_BLOCK; k++)
					at[k] -= blocks->value[e].m[i][k] *
					         y[RB_BLOCK * blocks->row[e] + i];
		for (int i = RB_BLOCK; i-- > 0;) {
			for (int k = i + 1; k < RB_BLOCK; k++)
				at[i] -= d->m[k][i] * at[k];
			at[i] /= d->m[i][i];
		}
	}
	for (int i = 0; i < blocks->count; i++)
		memcpy(x + RB_BLOCK * i, y + RB_BLOCK * blocks->place[i], RB_BLOCK * sizeof *x);
}
