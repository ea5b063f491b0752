/* SPDX-License-Identifier: MIT */
#include "stepped/blocks.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"

/* ---- order of elimination ---- */

/*
 * Lists, not a bit matrix: for a heap of 20,000 bodies that took 50 MB, for 200,000 it would be 5
 * GB, for an order that is given up after the first few thousand.
 */
struct graph {
	int count;
	int **list;             /* [count]: remaining neighbours and the body itself, ascending */
	int *length, *capacity; /* [count]: length and capacity of each list */
	/* [2 count]: tournament tree: each node has the lesser of its two children */
	uint64_t *tree;
	int *order;  /* [count]: body at each position */
	int *merged; /* [count]: scratch */
	struct rb_arena *arena;
};

static void update_node(struct graph *graph, size_t at)
{
	const uint64_t left = graph->tree[2 * at], right = graph->tree[2 * at + 1];

	graph->tree[at] = left < right ? left : right;
}

/* Keys compare degrees first, then bodies; eliminated bodies come last. */
static void update_degree(struct graph *graph, int i, bool remains)
{
	size_t at = (size_t)graph->count + (size_t)i;

	graph->tree[at] = remains ? (uint64_t)graph->length[i] << 32 | (uint64_t)i : UINT64_MAX;
	for (at /= 2; at > 0; at /= 2)
		update_node(graph, at);
}

static int least_degree(const struct graph *graph)
{
	RB_ASSERT_COSTLY(graph->tree[1] != UINT64_MAX);
	return (int)(graph->tree[1] & UINT32_MAX);
}

/* Merges the lists of i and k, without k, into `merged`; returns its length. */
static int merge_lists(const struct graph *graph, int i, int k)
{
	const int *x = graph->list[i], *y = graph->list[k];
	const int *const x_end = x + graph->length[i], *const y_end = y + graph->length[k];
	int count = 0;

	while (x < x_end || y < y_end) {
		const int next = y == y_end || (x < x_end && *x <= *y) ? *x : *y;

		x += x < x_end && *x == next;
		y += y < y_end && *y == next;
		if (next != k)
			graph->merged[count++] = next;
	}
	return count;
}

/* Connects the neighbours of `k` with each other and eliminates k; false: no memory. */
static bool eliminate(struct graph *graph, int k)
{
	RB_ASSERT_COSTLY(k >= 0 && k < graph->count);
	for (int n = 0; n < graph->length[k]; n++) {
		const int i = graph->list[k][n];

		if (i == k)
			continue;
		const int count = merge_lists(graph, i, k);
		if (count > graph->capacity[i]) {
			graph->capacity[i] = 2 * count;
			graph->list[i] = rb_arena_take(graph->arena, 2 * (size_t)count,
			                               sizeof(int));
			if (!graph->list[i])
				return false;
		}
		memcpy(graph->list[i], graph->merged, (size_t)count * sizeof(int));
		graph->length[i] = count;
		update_degree(graph, i, true);
	}
	update_degree(graph, k, false);
	return true;
}

/*
 * Orders all bodies; the list of an eliminated body keeps its neighbours that remained then.
 * Returns the number of blocks; 0: too many multiplications, or no memory.
 */
static int order_all(struct graph *graph, struct rb_blocks *blocks, double max)
{
	const double cube = RB_BLOCK * RB_BLOCK * RB_BLOCK;
	int total = 0;

	blocks->work = 0;
	for (int place = 0; place < graph->count; place++) {
		const int k = least_degree(graph);
		const double degree = graph->length[k];

		blocks->work += 0.5 * cube * degree * (degree + 1);
		if (blocks->work > max)
			return 0;
		total += graph->length[k];
		graph->order[place] = k;
		blocks->place[k] = place;
		if (!eliminate(graph, k))
			return 0;
	}
	return total;
}

static int by_number(const void *x, const void *y)
{
	const int a = *(const int *)x, b = *(const int *)y;

	return (a > b) - (a < b);
}

/* Builds the graph from the pairs, each neighbour once; false: no memory. */
static bool make_graph(struct graph *graph, const int (*pair)[2], int pair_count)
{
	const size_t n = (size_t)graph->count;
	int *all = rb_arena_take(graph->arena, n + 2 * (size_t)pair_count, sizeof *all);

	graph->list = rb_arena_take(graph->arena, n, sizeof *graph->list);
	graph->length = rb_arena_take(graph->arena, 4 * n, sizeof *graph->length);
	graph->tree = rb_arena_take(graph->arena, 2 * n, sizeof *graph->tree);
	if (!all || !graph->list || !graph->length || !graph->tree)
		return false;
	graph->capacity = graph->length + n;
	graph->order = graph->capacity + n;
	graph->merged = graph->order + n;
	for (int i = 0; i < graph->count; i++)
		graph->capacity[i] = 1;
	for (int p = 0; p < 2 * pair_count; p++)
		graph->capacity[pair[p / 2][p % 2]]++;
	for (int i = 0; i < graph->count; i++) {
		graph->list[i] = all;
		graph->list[i][0] = i;
		graph->length[i] = 1;
		all += graph->capacity[i];
	}
	for (int p = 0; p < 2 * pair_count; p++) {
		const int i = pair[p / 2][p % 2];

		graph->list[i][graph->length[i]++] = pair[p / 2][1 - p % 2];
	}
	for (int i = 0; i < graph->count; i++) {
		int *list = graph->list[i], kept = 0;

		qsort(list, (size_t)graph->length[i], sizeof *list, by_number);
		for (int k = 0; k < graph->length[i]; k++)
			if (kept == 0 || list[kept - 1] != list[k])
				list[kept++] = list[k];
		graph->length[i] = kept;
		graph->tree[n + (size_t)i] = (uint64_t)kept << 32 | (uint64_t)i;
	}
	for (size_t at = n; at-- > 1;)
		update_node(graph, at);
	return true;
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
		const int k = graph->order[place], begin = at;

		blocks->first[place] = at;
		for (int n = 0; n < graph->length[k]; n++)
			blocks->row[at++] = blocks->place[graph->list[k][n]];
		sort_places(blocks->row + begin, at - begin);
	}
	blocks->first[graph->count] = at;
}

bool rb_blocks_plan(struct rb_blocks *blocks, int count, const int (*pair)[2], int pair_count,
                    double max, struct rb_arena *arena)
{
	struct graph graph = {.count = count, .arena = arena};
	const size_t n = (size_t)count;

	RB_ASSERT(count > 0 && pair_count >= 0 && max > 0);
	*blocks = (struct rb_blocks){.count = count};
	blocks->place = rb_arena_take(arena, n, sizeof *blocks->place);
	blocks->first = rb_arena_take(arena, n + 1, sizeof *blocks->first);
	if (!blocks->place || !blocks->first || !make_graph(&graph, pair, pair_count))
		return false;
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

rb_block *rb_blocks_at(struct rb_blocks *blocks, int a, int b, bool *transposed)
{
	int column = blocks->place[a], row = blocks->place[b];

	*transposed = column <= row; /* stored as (row, column) = (b, a) */
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

/* Root of the pivot of a dependent unknown: makes it zero. */
static const double dropped_root = (double)INFINITY;

/*
 * Scale of a system before it is factored, so that roots of pivots scale exactly with any power of
 * two, and with all masses: the root of 2x has other digits than that of x, the root of 4x has the
 * same.
 */
static double even_scale(const struct rb_blocks *blocks)
{
	int exponent;

	(void)frexp(blocks->value[blocks->first[0]].m[0][0], &exponent);
	return exponent % 2 != 0 ? 0.5 : 1;
}

static void scale_all(struct rb_blocks *blocks, double scale)
{
	double *const value = &blocks->value[0].m[0][0];
	const size_t count = RB_BLOCK * RB_BLOCK * (size_t)blocks->first[blocks->count];

	for (size_t i = 0; i < count; i++)
		value[i] *= scale;
	for (int i = 0; blocks->pivot_min && i < RB_BLOCK * blocks->count; i++)
		blocks->pivot_min[i] *= scale;
}

/* Cholesky's factor of a diagonal block, in its lower half. */
static bool factor_diagonal(rb_block *d, double *pivot_min)
{
	for (int j = 0; j < RB_BLOCK; j++) {
		double sum = d->m[j][j];

		for (int k = 0; k < j; k++)
			sum -= d->m[j][k] * d->m[j][k];
		const bool depends = pivot_min && sum <= pivot_min[j];

		if (!(sum > 0) && !depends)
			return false;
		const double root = depends ? dropped_root : sqrt(sum);
		if (depends)
			pivot_min[j] = (double)INFINITY;
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

/* Two numbers side by side, each computed as it would be alone: with the same bits. */
typedef double pair __attribute__((vector_size(2 * sizeof(double)), aligned(8), may_alias));

struct six {
	pair a, b, c;
};

static inline struct six six_from(const double *x)
{
	const pair *const p = (const pair *)x;

	return (struct six){p[0], p[1], p[2]};
}

static inline void six_to(double *x, struct six s)
{
	pair *const p = (pair *)x;

	p[0] = s.a;
	p[1] = s.b;
	p[2] = s.c;
}

static inline struct six minus(struct six s, double x, const double *row)
{
	const pair both = {x, x}, *const p = (const pair *)row;

	return (struct six){s.a - both * p[0], s.b - both * p[1], s.c - both * p[2]};
}

/* s - x^T b */
static inline struct six minus_product(struct six s, const double *x, const rb_block *b)
{
	s = minus(s, x[0], b->m[0]);
	s = minus(s, x[1], b->m[1]);
	s = minus(s, x[2], b->m[2]);
	s = minus(s, x[3], b->m[3]);
	s = minus(s, x[4], b->m[4]);
	return minus(s, x[5], b->m[5]);
}

static inline void transpose(rb_block *t, const rb_block *b)
{
	for (int i = 0; i < RB_BLOCK; i++)
		six_to(t->m[i], (struct six){{b->m[0][i], b->m[1][i]},
		                             {b->m[2][i], b->m[3][i]},
		                             {b->m[4][i], b->m[5][i]}});
}

/* b := b d^-T */
static void divide(rb_block *b, const rb_block *d)
{
	rb_block t;

	transpose(&t, b);
	for (int j = 0; j < RB_BLOCK; j++) {
		const pair root = {d->m[j][j], d->m[j][j]};
		struct six s = six_from(t.m[j]);

		for (int k = 0; k < j; k++)
			s = minus(s, d->m[j][k], t.m[k]);
		six_to(t.m[j], (struct six){s.a / root, s.b / root, s.c / root});
	}
	transpose(b, &t);
}

/* c -= a t */
static void subtract(rb_block *c, const rb_block *a, const rb_block *t)
{
	for (int i = 0; i < RB_BLOCK; i++)
		six_to(c->m[i], minus_product(six_from(c->m[i]), a->m[i], t));
}

bool rb_blocks_factor(struct rb_blocks *blocks)
{
	blocks->scale = even_scale(blocks);
	if (blocks->scale != 1)
		scale_all(blocks, blocks->scale);
	for (int c = 0; c < blocks->count; c++) {
		const int first = blocks->first[c], end = blocks->first[c + 1];

		if (!factor_diagonal(&blocks->value[first],
		                     blocks->pivot_min ? blocks->pivot_min + RB_BLOCK * c : NULL))
			return false;
		for (int i = first + 1; i < end; i++)
			divide(&blocks->value[i], &blocks->value[first]);
		for (int j = first + 1; j < end; j++) {
			int at = blocks->first[blocks->row[j]];
			rb_block t;

			transpose(&t, &blocks->value[j]);
			for (int i = j; i < end; i++) {
				while (blocks->row[at] != blocks->row[i])
					at++;
				subtract(&blocks->value[at], &blocks->value[i], &t);
			}
		}
	}
	return true;
}

/* y -= b x */
static inline void subtract_product(double *y, const rb_block *b, const pair x[RB_BLOCK])
{
	for (int i = 0; i < RB_BLOCK; i += 2) {
		const double *const p = b->m[i], *const q = b->m[i + 1];
		pair *const to = (pair *)(y + i);

		*to = *to - (pair){p[0], q[0]} * x[0] - (pair){p[1], q[1]} * x[1] -
		      (pair){p[2], q[2]} * x[2] - (pair){p[3], q[3]} * x[3] -
		      (pair){p[4], q[4]} * x[4] - (pair){p[5], q[5]} * x[5];
	}
}

static void solve_forward(const struct rb_blocks *blocks, double *y)
{
	for (int c = 0; c < blocks->count; c++) {
		const int first = blocks->first[c], end = blocks->first[c + 1];
		const rb_block *d = &blocks->value[first];
		double *const at = y + RB_BLOCK * c;
		pair x[RB_BLOCK];

		for (int i = 0; i < RB_BLOCK; i++) {
			double s = at[i];

			for (int k = 0; k < i; k++)
				s -= d->m[i][k] * at[k];
			at[i] = s / d->m[i][i];
			x[i] = (pair){at[i], at[i]};
		}
		for (int e = first + 1; e < end; e++)
			subtract_product(y + RB_BLOCK * blocks->row[e], &blocks->value[e], x);
	}
}

static void solve_back(const struct rb_blocks *blocks, double *y)
{
	for (int c = blocks->count; c-- > 0;) {
		const int first = blocks->first[c], end = blocks->first[c + 1];
		const rb_block *d = &blocks->value[first];
		double *const at = y + RB_BLOCK * c;
		struct six sum = six_from(at);

		for (int e = first + 1; e < end; e++)
			sum = minus_product(sum, y + RB_BLOCK * blocks->row[e], &blocks->value[e]);
		six_to(at, sum);
		for (int i = RB_BLOCK; i-- > 0;) {
			double s = at[i];

			for (int k = i + 1; k < RB_BLOCK; k++)
				s -= d->m[k][i] * at[k];
			at[i] = s / d->m[i][i];
		}
	}
}

void rb_blocks_solve(const struct rb_blocks *blocks, double *x, double *scratch)
{
	double *const y = scratch;

	for (int i = 0; i < blocks->count; i++)
		memcpy(y + RB_BLOCK * blocks->place[i], x + RB_BLOCK * i, RB_BLOCK * sizeof *x);
	solve_forward(blocks, y);
	solve_back(blocks, y);
	for (int i = 0; blocks->scale != 1 && i < RB_BLOCK * blocks->count; i++)
		y[i] *= blocks->scale;
	for (int i = 0; i < blocks->count; i++)
		memcpy(x + RB_BLOCK * i, y + RB_BLOCK * blocks->place[i], RB_BLOCK * sizeof *x);
}
