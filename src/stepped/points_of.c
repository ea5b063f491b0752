/* SPDX-License-Identifier: MIT */
/*
 * Contact points by body, as compressed rows: counts are stored two entries further on, so that
 * filling moves each start to its place. Also the choice of points with impulses, and sorting by
 * pair.
 */
#include "stepped/points_of.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/sort.h"

/* Bodies of a point; b -1: not dynamic. */
struct ends {
	int a, b;
};

struct pass {
	const struct rb_world *world;
	const struct rb_step_points *points;
	struct ends *ends;
	unsigned char *held;
};

enum { POINTS_PER_BLOCK = 512 };

static void hold(unsigned char *held, int i)
{
	if (!__atomic_load_n(&held[i], __ATOMIC_RELAXED))
		__atomic_store_n(&held[i], 1, __ATOMIC_RELAXED);
}

static void find_ends(void *user, size_t first, size_t end)
{
	const struct pass *pass = user;

	for (size_t k = first; k < end; k++) {
		const struct rb_step_point *p = &pass->points->row[k];

		pass->ends[k] = (struct ends){p->a,
		                              rb_stepped_is_dynamic(pass->world, p->b) ? p->b : -1};
		if (p->from == 0)
			continue;
		hold(pass->held, p->a);
		if (p->b < pass->world->model->body_count)
			hold(pass->held, p->b);
	}
}

bool rb_points_of_bodies(const struct rb_world *world, const struct rb_step_points *points,
                         size_t *first, size_t *of, unsigned char *held)
{
	const size_t n = (size_t)world->model->body_count;
	struct pass pass = {world, points,
	                    rb_arena_take(&world->arena[0], points->count, sizeof *pass.ends),
	                    held};

	if (!pass.ends)
		return false;
	memset(first, 0, (n + 2) * sizeof *first);
	memset(held, 0, n + 1);
	rb_team_share(world->team, points->count, POINTS_PER_BLOCK, find_ends, &pass);
	for (size_t k = 0; k < points->count; k++) {
		first[pass.ends[k].a + 2]++;
		if (pass.ends[k].b >= 0)
			first[pass.ends[k].b + 2]++;
	}
	for (size_t i = 2; i < n + 2; i++)
		first[i] += first[i - 1];
	for (size_t k = 0; k < points->count; k++) {
		of[first[pass.ends[k].a + 1]++] = k;
		if (pass.ends[k].b >= 0)
			of[first[pass.ends[k].b + 1]++] = k;
	}
	return true;
}

/* ---- choice and order ---- */

struct choice {
	const struct rb_step_points *points;
	double approach;
	/* by block: number of chosen points, which begin at its first point in `chosen` */
	int *count;
};

static void choose(void *user, size_t first, size_t end)
{
	const struct choice *choice = user;
	const struct rb_step_points *points = choice->points;
	int *const chosen = points->chosen + first, count = 0;

	for (size_t k = first; k < end; k++) {
		const struct rb_step_point *point = &points->row[k];

		chosen[count] = (int)k;
		count += point->normal_impulse > 0 && !(point->approach <= choice->approach);
	}
	choice->count[first / POINTS_PER_BLOCK] = count;
}

enum rb_status rb_step_points_choose(struct rb_step_points *points, struct rb_world *world,
                                     double approach, struct rb_error *err)
{
	struct rb_arena *const arena = &world->arena[0];
	const rb_arena_mark here = rb_arena_here(arena);
	const size_t blocks = points->count / POINTS_PER_BLOCK + 1;
	struct choice choice = {points, approach,
	                        rb_arena_take(arena, blocks, sizeof *choice.count)};

	points->chosen_count = 0;
	if (!choice.count || !rb_memory_reserve(&points->chosen, &points->chosen_capacity,
	                                        points->count + 1, sizeof *points->chosen))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts", points->count);
	rb_team_share(world->team, points->count, POINTS_PER_BLOCK, choose, &choice);
	for (size_t b = 0; b * POINTS_PER_BLOCK < points->count; b++) {
		if (b > 0)
			memmove(points->chosen + points->chosen_count,
			        points->chosen + b * POINTS_PER_BLOCK,
			        (size_t)choice.count[b] * sizeof *points->chosen);
		points->chosen_count += (size_t)choice.count[b];
	}
	rb_arena_back(arena, here);
	return RB_OK;
}

/*
 * In place, cycle by cycle of the permutation: a second list of all points would be the largest
 * array there is.
 */
enum rb_status rb_step_points_sort(struct rb_step_points *points, struct rb_arena *arena,
                                   struct rb_error *err)
{
	const size_t n = points->count;
	const rb_arena_mark here = rb_arena_here(arena);
	struct rb_sort_item *item = rb_arena_take(arena, 2 * n + 1, sizeof *item);

	if (!item)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts", n);
	for (size_t k = 0; k < n; k++)
		item[k] = (struct rb_sort_item){points->row[k].pair, k};
	rb_sort_by_key(item, item + n, n);
	for (size_t k = 0; k < n; k++) {
		const struct rb_step_point first = points->row[k];
		size_t to = k;

		while (item[to].value != k) {
			const size_t from = item[to].value;

			points->row[to] = points->row[from];
			item[to].value = to;
			to = from;
		}
		if (to == k)
			continue;
		points->row[to] = first;
		item[to].value = to;
	}
	rb_arena_back(arena, here);
	return RB_OK;
}
