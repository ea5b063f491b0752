/* SPDX-License-Identifier: MIT */
/*
 * Points are sorted along Morton's curve; cells are ranges of it, in order of their level, with
 * their children in succession. Coordinates are in units of a power of two near the cube's edge:
 * scaling is exact, and no power of a distance leaves the range of doubles.
 */
#include "math/tree.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/sort.h"
#include "math/lanes.h"
#include "math/multipole.h"

/*
 * Bits of a key on each axis. Leaves have at most LEAF points, unless they share a key: from 24 to
 * 64 the time is the same within a tenth, since what leaves do less of pairs they do more of
 * moments.
 */
enum { BITS = 21, LEAF = 48, TERMS = RB_MULTIPOLE_TERMS, CELLS_PER_BLOCK = 64 };

/* Of cells: points `first` .. `first + count` - 1, children `child` .. `child + children` - 1. */
struct cell {
	int first, count, child, children;
	double radius; /* about its centre: all points are within it */
	double spread; /* 5/4 of the root mean square of their distances to it */
};

struct pair {
	int a, b;
};

/* Pairs that act on each other, and for every cell its partners: list[begin[k]] .. begin[k + 1]. */
struct partners {
	struct pair *pair;
	size_t count, capacity;
	int *list, *begin;
	size_t list_capacity, begin_capacity;
};

struct rb_tree {
	/* points in the order of their keys */
	struct rb_sort_item *item, *scratch;
	double (*x)[3], *mu;
	size_t item_capacity, scratch_capacity, x_capacity, mu_capacity;
	/* cells */
	struct cell *cell;
	double (*center)[3], (*moment)[TERMS], (*field)[TERMS];
	size_t cell_count, cell_capacity, center_capacity, moment_capacity, field_capacity;
	struct partners far, near; /* by moments, point by point */
	struct pair *stack;
	size_t stack_capacity;
	/* of the call under way */
	const struct rb_attract *all;
	double middle[3]; /* m, of the cube */
	double unit;      /* 1/m, a power of two */
	double soft2;     /* in these units */
	double *const *result;
};

enum rb_status rb_tree_create(struct rb_tree **tree, struct rb_error *err)
{
	*tree = rb_memory_take(1, sizeof **tree);
	return *tree ? RB_OK : RB_FAIL(err, RB_ERR_MEMORY, "no memory for a tree");
}

static void release(struct partners *partners)
{
	rb_memory_free(partners->pair);
	rb_memory_free(partners->list);
	rb_memory_free(partners->begin);
}

void rb_tree_destroy(struct rb_tree *tree)
{
	if (!tree)
		return;
	rb_memory_free(tree->item);
	rb_memory_free(tree->scratch);
	rb_memory_free(tree->x);
	rb_memory_free(tree->mu);
	rb_memory_free(tree->cell);
	rb_memory_free(tree->center);
	rb_memory_free(tree->moment);
	rb_memory_free(tree->field);
	release(&tree->far);
	release(&tree->near);
	rb_memory_free(tree->stack);
	rb_memory_free(tree);
}

/* ---- cells ---- */

static double coordinate(const struct rb_attract *all, int m, int i)
{
	return all->x[m][i] + all->rest[m][i];
}

/* The cube about all points. */
static void bound(struct rb_tree *tree)
{
	const struct rb_attract *const all = tree->all;
	double edge = 0;

	for (int m = 0; m < 3; m++) {
		double low = coordinate(all, m, 0), high = low;

		for (int i = 1; i < all->count; i++) {
			low = fmin(low, coordinate(all, m, i));
			high = fmax(high, coordinate(all, m, i));
		}
		tree->middle[m] = 0.5 * low + 0.5 * high;
		edge = fmax(edge, high - low);
	}
	int exponent = 0;
	frexp(edge, &exponent);
	/* all at one place, or so far apart that their distances have no inverse */
	tree->unit = edge > 0 && exponent > -1000 && exponent < 1000 ? ldexp(1, -exponent) : 1;
	tree->soft2 = all->softening2 * tree->unit * tree->unit;
}

/* Every third bit of the result is one of the lowest 21. */
static uint64_t spread(uint64_t x)
{
	x = (x | x << 32) & 0x1f00000000ffffu;
	x = (x | x << 16) & 0x1f0000ff0000ffu;
	x = (x | x << 8) & 0x100f00f00f00f00fu;
	x = (x | x << 4) & 0x10c30c30c30c30c3u;
	return (x | x << 2) & 0x1249249249249249u;
}

static void sort_points(struct rb_tree *tree)
{
	const struct rb_attract *const all = tree->all;
	const int n = all->count;

	for (int i = 0; i < n; i++) {
		uint64_t key = 0;

		for (int m = 0; m < 3; m++) {
			const double x = (coordinate(all, m, i) - tree->middle[m]) * tree->unit;
			const double step = (x + 0.5) * (1 << BITS);
			/* the last step has both its ends; NaN goes to the first */
			const uint64_t digit = step > 0 ? (uint64_t)fmin(step, (1 << BITS) - 1) : 0;

			key |= spread(digit) << (2 - m);
		}
		tree->item[i] = (struct rb_sort_item){key, (uint64_t)i};
	}
	rb_sort_by_key(tree->item, tree->scratch, (size_t)n);
	for (int k = 0; k < n; k++) {
		const int i = (int)tree->item[k].value;

		for (int m = 0; m < 3; m++)
			tree->x[k][m] = ((all->x[m][i] - tree->middle[m]) + all->rest[m][i]) *
			                tree->unit;
		tree->mu[k] = all->mu[i];
	}
}

static bool reserve_cells(struct rb_tree *tree, size_t count)
{
	return rb_memory_reserve(&tree->cell, &tree->cell_capacity, count, sizeof *tree->cell);
}

/* Splits a cell of a level into those octants that have points; false: no memory. */
static bool split(struct rb_tree *tree, size_t k, int level)
{
	const int shift = 3 * (BITS - 1 - level);
	const int end = tree->cell[k].first + tree->cell[k].count;

	if (!reserve_cells(tree, tree->cell_count + 8))
		return false;
	tree->cell[k].child = (int)tree->cell_count;
	for (int first = tree->cell[k].first; first < end;) {
		const uint64_t octant = tree->item[first].key >> shift;
		int next = first + 1;

		while (next < end && tree->item[next].key >> shift == octant)
			next++;
		tree->cell[tree->cell_count++] = (struct cell){.first = first,
		                                               .count = next - first};
		tree->cell[k].children++;
		first = next;
	}
	return true;
}

/* Level by level. */
static bool make_cells(struct rb_tree *tree)
{
	if (!reserve_cells(tree, 1))
		return false;
	tree->cell[0] = (struct cell){.count = tree->all->count};
	tree->cell_count = 1;
	size_t first = 0;
	for (int level = 0; level < BITS; level++) {
		const size_t end = tree->cell_count;

		for (size_t k = first; k < end; k++)
			if (tree->cell[k].count > LEAF && !split(tree, k, level))
				return false;
		first = end;
	}
	return rb_memory_reserve(&tree->center, &tree->center_capacity, tree->cell_count,
	                         sizeof *tree->center) &&
	       rb_memory_reserve(&tree->moment, &tree->moment_capacity, tree->cell_count,
	                         sizeof *tree->moment) &&
	       rb_memory_reserve(&tree->field, &tree->field_capacity, tree->cell_count,
	                         sizeof *tree->field);
}

/* From `to` to `from`. */
static rb_vec3 between(const double from[3], const double to[3])
{
	return (rb_vec3){from[0] - to[0], from[1] - to[1], from[2] - to[2]};
}

/* Centre and moments of a leaf from its points. */
static void fill_leaf(struct rb_tree *tree, size_t k)
{
	struct cell *const cell = &tree->cell[k];
	const int end = cell->first + cell->count;
	double sum = 0, *const center = tree->center[k];

	for (int i = cell->first; i < end; i++)
		sum += tree->mu[i];
	for (int m = 0; m < 3; m++) {
		center[m] = 0;
		for (int i = cell->first; i < end; i++)
			center[m] += (sum > 0 ? tree->mu[i] : 1) * tree->x[i][m];
		center[m] /= sum > 0 ? sum : cell->count;
	}
	for (int i = cell->first; i < end; i++)
		if (tree->mu[i] > 0)
			rb_multipole_add(tree->moment[k], tree->mu[i], between(center, tree->x[i]));
}

/* ... of a cell from its children. */
static void fill_from_children(struct rb_tree *tree, size_t k)
{
	struct cell *const cell = &tree->cell[k];
	const int end = cell->child + cell->children;
	double sum = 0, *const center = tree->center[k];

	for (int i = cell->child; i < end; i++)
		sum += tree->moment[i][0];
	for (int m = 0; m < 3; m++) {
		double weight = 0;

		center[m] = 0;
		for (int i = cell->child; i < end; i++) {
			const double w = sum > 0 ? tree->moment[i][0] : 1;

			weight += w;
			center[m] += w * tree->center[i][m];
		}
		center[m] /= weight;
	}
	for (int i = cell->child; i < end; i++)
		if (tree->moment[i][0] > 0)
			rb_multipole_lift(tree->moment[k], tree->moment[i],
			                  between(center, tree->center[i]));
}

/* How far its points are from its centre. */
static void measure(struct rb_tree *tree, size_t k)
{
	struct cell *const cell = &tree->cell[k];
	double largest = 0, sum = 0;

	for (int i = cell->first; i < cell->first + cell->count; i++) {
		const rb_vec3 d = between(tree->center[k], tree->x[i]);
		const double square = rb_vec3_dot(d, d);

		largest = fmax(largest, square);
		sum += square;
	}
	cell->radius = sqrt(largest);
	cell->spread = 1.25 * sqrt(sum / cell->count);
}

/* Children come behind their parents. */
static void fill_cells(struct rb_tree *tree)
{
	memset(tree->moment, 0, tree->cell_count * sizeof *tree->moment);
	memset(tree->field, 0, tree->cell_count * sizeof *tree->field);
	for (size_t k = tree->cell_count; k-- > 0;) {
		if (tree->cell[k].children == 0)
			fill_leaf(tree, k);
		else
			fill_from_children(tree, k);
		measure(tree, k);
	}
}

/* ---- who acts on whom ---- */

static bool note(struct partners *partners, int a, int b)
{
	if (!rb_memory_reserve(&partners->pair, &partners->capacity, partners->count + 1,
	                       sizeof *partners->pair))
		return false;
	partners->pair[partners->count++] = (struct pair){a, b};
	return true;
}

/* A cell with itself: all pairs of its children; two cells: the children of one with the other. */
static bool push_parts(struct rb_tree *tree, size_t *depth, struct pair p)
{
	const struct cell *const a = &tree->cell[p.a], *const b = &tree->cell[p.b];

	if (!rb_memory_reserve(&tree->stack, &tree->stack_capacity, *depth + 64,
	                       sizeof *tree->stack))
		return false;
	if (p.a == p.b) {
		for (int i = 0; i < a->children; i++)
			for (int j = i; j < a->children; j++)
				tree->stack[(*depth)++] = (struct pair){a->child + i, a->child + j};
		return true;
	}
	/* the larger one is split, if it can be */
	const bool first = a->children > 0 && (b->children == 0 || a->radius >= b->radius);
	const struct cell *const parts = first ? a : b;
	for (int i = 0; i < parts->children; i++)
		tree->stack[(*depth)++] = first ? (struct pair){parts->child + i, p.b}
		                                : (struct pair){p.a, parts->child + i};
	return true;
}

/* Which pairs of cells act by moments, which point by point; false: no memory. */
static bool walk(struct rb_tree *tree, double opening)
{
	size_t depth = 0;

	tree->far.count = tree->near.count = 0;
	if (!rb_memory_reserve(&tree->stack, &tree->stack_capacity, 64, sizeof *tree->stack))
		return false;
	tree->stack[depth++] = (struct pair){0, 0};
	while (depth > 0) {
		const struct pair p = tree->stack[--depth];
		const struct cell *const a = &tree->cell[p.a], *const b = &tree->cell[p.b];
		const rb_vec3 d = between(tree->center[p.a], tree->center[p.b]);
		const double square = rb_vec3_dot(d, d);
		const double size = a->radius + b->radius, spread = a->spread + b->spread;
		const bool far = p.a != p.b && square > size * size &&
		                 opening * opening * square > spread * spread;
		bool ok = true;

		if (far)
			ok = note(&tree->far, p.a, p.b);
		else if (a->children == 0 && b->children == 0)
			ok = note(&tree->near, p.a, p.b);
		else
			ok = push_parts(tree, &depth, p);
		if (!ok)
			return false;
	}
	return true;
}

/* From pairs to lists of every cell. */
static bool list_partners(const struct rb_tree *tree, struct partners *partners)
{
	const size_t n = tree->cell_count;

	if (!rb_memory_reserve(&partners->list, &partners->list_capacity, 2 * partners->count + 1,
	                       sizeof *partners->list) ||
	    !rb_memory_reserve(&partners->begin, &partners->begin_capacity, n + 2,
	                       sizeof *partners->begin))
		return false;
	int *const begin = partners->begin;
	memset(begin, 0, (n + 2) * sizeof *begin);
	for (size_t k = 0; k < partners->count; k++) {
		const struct pair p = partners->pair[k];

		begin[p.a + 2]++;
		begin[p.b + 2] += p.a != p.b;
	}
	for (size_t k = 2; k < n + 2; k++)
		begin[k] += begin[k - 1];
	for (size_t k = 0; k < partners->count; k++) {
		const struct pair p = partners->pair[k];

		partners->list[begin[p.a + 1]++] = p.b;
		if (p.a != p.b)
			partners->list[begin[p.b + 1]++] = p.a;
	}
	return true;
}

/* ---- sums ---- */

/* Fields of a block of cells by those far from them. */
static void far_block(void *user, int block, int worker)
{
	struct rb_tree *const tree = user;
	const struct partners *const far = &tree->far;
	const struct rb_multipole_sources sources = {(const double(*)[3])tree->center,
	                                             (const double(*)[TERMS])tree->moment};
	const size_t first = (size_t)block * CELLS_PER_BLOCK;

	(void)worker;
	for (size_t k = first; k < first + CELLS_PER_BLOCK && k < tree->cell_count; k++)
		rb_multipole_field(&sources, far->list + far->begin[k],
		                   far->begin[k + 1] - far->begin[k], tree->soft2, tree->center[k],
		                   tree->field[k]);
}

/* Fields of cells to their children, from the whole down. */
static void lower_fields(struct rb_tree *tree)
{
	for (size_t k = 0; k < tree->cell_count; k++)
		for (int i = 0; i < tree->cell[k].children; i++) {
			const int child = tree->cell[k].child + i;

			rb_multipole_lower(tree->field[child], tree->field[k],
			                   between(tree->center[child], tree->center[k]));
		}
}

/* Points that act, in eights: coordinates and strengths, the last eight filled up by nothing. */
enum { NEAR_MAX = 1024, EIGHT = 8 };
struct near_points {
	int count;
	bool own; /* of the leaf that they act on: else none is where one of these is */
	_Alignas(64) double x[NEAR_MAX];
	double y[NEAR_MAX], z[NEAR_MAX], mu[NEAR_MAX];
};

typedef double eight __attribute__((vector_size(EIGHT * sizeof(double)), aligned(8)));
typedef long long eight_mask __attribute__((vector_size(EIGHT * sizeof(long long)), aligned(8)));
typedef float eight_floats __attribute__((vector_size(EIGHT * sizeof(float))));

/*
 * 1/sqrt(x) to some roundings: that of floats, which takes a third of the time, and a step of third
 * order (A. Householder, The numerical treatment of a single nonlinear equation, 1970) from there.
 * `miss`: the square of what the floats were off by, which is much or NaN where x is none that a
 * float can hold.
 */
RB_LANES_INLINE void inverse_root(const eight *x, eight *y, eight *miss)
{
	const eight_floats rough = __builtin_convertvector(*x, eight_floats);
	eight_floats root;

#ifdef __SSE2__
	const __m128 low = _mm_sqrt_ps((__m128){rough[0], rough[1], rough[2], rough[3]});
	const __m128 high = _mm_sqrt_ps((__m128){rough[4], rough[5], rough[6], rough[7]});

	root = (eight_floats){low[0], low[1], low[2], low[3], high[0], high[1], high[2], high[3]};
#else
	for (int i = 0; i < EIGHT; i++)
		root[i] = sqrtf(rough[i]);
#endif
	const eight first = __builtin_convertvector(1 / root, eight);
	const eight off = 1 - *x * (first * first);

	*y = first + first * (off * (0.5 + 0.375 * off));
	*miss = off * off;
}

/*
 * Adds what the near points do at `x`: acceleration and potential. False: some are too close.
 * `own`: the point itself may be among them, and others at its place: they do nothing.
 */
RB_LANES_INLINE bool sum_near(const struct near_points *near, const bool own, double soft2,
                              const double x[3], double sum[4])
{
	eight ax = {0}, ay = {0}, az = {0}, psi = {0};
	eight misses = {0};
	double all_misses = 0;

	for (int k = 0; k < near->count; k += EIGHT) {
		const eight dx = *(const eight *)(near->x + k) - x[0];
		const eight dy = *(const eight *)(near->y + k) - x[1];
		const eight dz = *(const eight *)(near->z + k) - x[2];
		const eight square = dx * dx + dy * dy + dz * dz, soft = square + soft2;
		eight inverse, miss;

		inverse_root(&soft, &inverse, &miss);
		eight all = *(const eight *)(near->mu + k) * inverse;
		eight factor = all * (inverse * inverse);
		if (own) {
			const eight_mask distinct = (eight_mask)(square > 0);

			miss = (eight)((eight_mask)miss & distinct);
			all = (eight)((eight_mask)all & distinct);
			factor = (eight)((eight_mask)factor & distinct);
		}
		misses += miss;
		ax += factor * dx;
		ay += factor * dy;
		az += factor * dz;
		psi += all;
	}
	for (int i = 0; i < EIGHT; i++) {
		sum[0] += ax[i];
		sum[1] += ay[i];
		sum[2] += az[i];
		sum[3] += psi[i];
		all_misses += misses[i];
	}
	/* each time the square of a few roundings of floats, of which the third power is left */
	return all_misses <= 0x1p-30;
}

/* The same of points that may be as close as doubles can be. */
static void sum_close(const struct near_points *near, double soft2, const double x[3],
                      double sum[4])
{
	for (int k = 0; k < near->count; k++) {
		const rb_vec3 d = {near->x[k] - x[0], near->y[k] - x[1], near->z[k] - x[2]};
		const double square = rb_vec3_dot(d, d), soft = square + soft2;
		const double mu = near->mu[k];
		/* of what fills up eights, too, the cube of a distance may come to 0 */
		const double factor = square > 0 && fabs(mu) > 0 ? mu / (soft * sqrt(soft)) : 0;

		sum[0] += factor * d.x;
		sum[1] += factor * d.y;
		sum[2] += factor * d.z;
		sum[3] += factor * soft;
	}
}

RB_LANES_INLINE void sum_on(const struct near_points *near, const bool own, double soft2,
                            double (*const x)[3], int count, double (*const sum)[4])
{
	for (int i = 0; i < count; i++) {
		double added[4] = {0};

		if (!sum_near(near, own, soft2, x[i], added)) {
			memset(added, 0, sizeof added);
			sum_close(near, soft2, x[i], added);
		}
		for (int m = 0; m < 4; m++)
			sum[i][m] += added[m];
	}
}

RB_LANES_INLINE void sum_all_near(const struct near_points *near, double soft2,
                                  double (*const x)[3], int count, double (*const sum)[4])
{
	if (near->own)
		sum_on(near, true, soft2, x, count, sum);
	else
		sum_on(near, false, soft2, x, count, sum);
}

RB_LANES_AVX2 static void sum_all_near_avx2(const struct near_points *near, double soft2,
                                            double (*const x)[3], int count, double (*const sum)[4])
{
	sum_all_near(near, soft2, x, count, sum);
}

RB_LANES_AVX512 static void sum_all_near_avx512(const struct near_points *near, double soft2,
                                                double (*const x)[3], int count,
                                                double (*const sum)[4])
{
	sum_all_near(near, soft2, x, count, sum);
}

/*
 * What near points that have been gathered do on those of a leaf; then there are none. Eights are
 * filled up outside of the cube, where no point is.
 */
static void apply_near(struct rb_tree *tree, struct near_points *near, const struct cell *leaf,
                       double (*const sum)[4])
{
	for (; near->count % EIGHT; near->count++) {
		near->x[near->count] = near->y[near->count] = near->z[near->count] = 2;
		near->mu[near->count] = 0;
	}
	if (rb_lanes_avx512())
		sum_all_near_avx512(near, tree->soft2, tree->x + leaf->first, leaf->count, sum);
	else if (rb_lanes_avx2())
		sum_all_near_avx2(near, tree->soft2, tree->x + leaf->first, leaf->count, sum);
	else
		sum_all_near(near, tree->soft2, tree->x + leaf->first, leaf->count, sum);
	near->count = 0;
}

/* Gathers the points of a leaf that act on `some`, and applies them where there is no more room. */
static void gather_near(struct rb_tree *tree, struct near_points *near, const struct cell *leaf,
                        const struct cell *some, double (*const sum)[4])
{
	for (int j = leaf->first; j < leaf->first + leaf->count; j++) {
		if (!(tree->mu[j] > 0))
			continue;
		near->x[near->count] = tree->x[j][0];
		near->y[near->count] = tree->x[j][1];
		near->z[near->count] = tree->x[j][2];
		near->mu[near->count++] = tree->mu[j];
		if (near->count == NEAR_MAX)
			apply_near(tree, near, some, sum);
	}
}

/* Near points and the field of all others on the points `first` .. of a leaf. */
static void finish_leaf(struct rb_tree *tree, size_t k, const struct cell *some)
{
	const struct partners *const partners = &tree->near;
	struct near_points near = {.count = 0};
	double sum[LEAF][4] = {{0}};

	near.own = true;
	gather_near(tree, &near, &tree->cell[k], some, sum);
	apply_near(tree, &near, some, sum);
	near.own = false;
	for (int p = partners->begin[k]; p < partners->begin[k + 1]; p++)
		if (partners->list[p] != (int)k)
			gather_near(tree, &near, &tree->cell[partners->list[p]], some, sum);
	apply_near(tree, &near, some, sum);
	for (int n = 0; n < some->count; n++) {
		const int i = (int)tree->item[some->first + n].value;
		double potential;
		const rb_vec3 a = rb_multipole_at(
			tree->field[k], between(tree->x[some->first + n], tree->center[k]),
			&potential);

		tree->result[0][i] = (a.x + sum[n][0]) * tree->unit * tree->unit;
		tree->result[1][i] = (a.y + sum[n][1]) * tree->unit * tree->unit;
		tree->result[2][i] = (a.z + sum[n][2]) * tree->unit * tree->unit;
		tree->result[3][i] = (potential + sum[n][3]) * tree->unit;
	}
}

static void leaf_block(void *user, int block, int worker)
{
	struct rb_tree *const tree = user;
	const size_t first = (size_t)block * CELLS_PER_BLOCK;

	(void)worker;
	for (size_t k = first; k < first + CELLS_PER_BLOCK && k < tree->cell_count; k++) {
		const struct cell *const cell = &tree->cell[k];
		const int end = cell->first + cell->count;

		/* those that share a key may be more than a leaf takes */
		for (int i = cell->first; cell->children == 0 && i < end; i += LEAF)
			finish_leaf(tree, k,
			            &(struct cell){.first = i,
			                           .count = end - i < LEAF ? end - i : LEAF});
	}
}

static void run(struct rb_tree *tree, struct rb_team *team, rb_team_work *work)
{
	const int blocks = (int)((tree->cell_count + CELLS_PER_BLOCK - 1) / CELLS_PER_BLOCK);

	if (team)
		rb_team_run(team, blocks, work, tree);
	for (int block = 0; !team && block < blocks; block++)
		work(tree, block, 0);
}

static bool reserve_points(struct rb_tree *tree, size_t n)
{
	return rb_memory_reserve(&tree->item, &tree->item_capacity, n, sizeof *tree->item) &&
	       rb_memory_reserve(&tree->scratch, &tree->scratch_capacity, n,
	                         sizeof *tree->scratch) &&
	       rb_memory_reserve(&tree->x, &tree->x_capacity, n, sizeof *tree->x) &&
	       rb_memory_reserve(&tree->mu, &tree->mu_capacity, n, sizeof *tree->mu);
}

enum rb_status rb_tree_attract(struct rb_tree *tree, const struct rb_attract *all, double opening,
                               struct rb_team *team, double *const result[4], struct rb_error *err)
{
	RB_ASSERT(all->count > 0 && opening > 0 && opening <= 1);
	tree->all = all;
	tree->result = result;
	if (!reserve_points(tree, (size_t)all->count))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for a tree of %d points", all->count);
	bound(tree);
	sort_points(tree);
	bool ok = make_cells(tree);
	if (ok) {
		fill_cells(tree);
		ok = walk(tree, opening) && list_partners(tree, &tree->far) &&
		     list_partners(tree, &tree->near);
	}
	if (!ok)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for a tree of %d points", all->count);
	run(tree, team, far_block);
	lower_fields(tree);
	run(tree, team, leaf_block);
	return RB_OK;
}
