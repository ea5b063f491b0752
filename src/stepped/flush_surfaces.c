/* SPDX-License-Identifier: MIT */
#include "stepped/flush_surfaces.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/sort.h"
#include "stepped/clearance.h"
#include "stepped/flush_points.h"
#include "stepped/pair_motion.h"
#include "stepped/step_closing.h"

/* A manifold: points of two parts with a common normal. */
struct touch {
	size_t first, count, least; /* points; the nearest one */
	size_t index;               /* in the order of points */
	const struct touch *group;  /* those of its first body */
	int group_count;
	bool hidden;
	int side;       /* hidden: of the points' bodies, that whose part goes on elsewhere */
	rb_vec3 normal; /* that its points are to have instead */
};

/* Whether two bodies do not move relative to each other. */
static bool move_alike(const struct rb_world *world, int x, int y)
{
	const rb_vec3 none = {0, 0, 0};

	if (x == y)
		return true;
	if (!rb_inspection_is_fixed(world->model, x) || !rb_inspection_is_fixed(world->model, y))
		return false;
	return rb_vec3_max_abs(
		       rb_vec3_sub(rb_pair_motion_velocity(world, &world->state, x, none),
	                           rb_pair_motion_velocity(world, &world->state, y, none))) == 0 &&
	       rb_vec3_max_abs(rb_pair_motion_spin(world, x)) == 0 &&
	       rb_vec3_max_abs(rb_pair_motion_spin(world, y)) == 0;
}

/* Where the part at one side of a point is: kept, or made from its finite plane. */
static const rb_placed *placed_of(const struct rb_inspection *inspection,
                                  const struct rb_step_point *point, int side,
                                  struct rb_flush_rectangle *rectangle)
{
	const struct rb_candidates *const candidates = inspection->candidates;
	const struct rb_world *const world = inspection->world;
	const int i = side == 0 ? point->a : point->b;
	static const rb_core half_space = {.kind = RB_CORE_HALF_SPACE};

	if (candidates->placed)
		return &candidates->placed[candidates->first_part[i] +
		                           rb_step_point_part(point, side)];
	const rb_quat turn = i < world->model->body_count
	                             ? rb_quat_from(world->state.orientation + 4 * (size_t)i)
	                             : world->model->orientation[i];
	rb_flush_rectangle_set(rectangle, world->model->shape[i].size,
	                       rb_world_origin_at(world, &world->state, i), turn);
	if (world->model->shape[i].kind == RB_SHAPE_PLANE)
		rectangle->placed.core = &half_space;
	else if (world->model->shape[i].kind != RB_SHAPE_RECTANGLE)
		rectangle->core.radius = world->model->shape[i].radius;
	return &rectangle->placed;
}

static struct rb_flush_point flush_point(const struct rb_inspection *inspection,
                                         const struct rb_step_point *point, int side,
                                         struct rb_flush_rectangle *rectangle)
{
	const struct rb_world *const world = inspection->world;
	rb_vec3 at;

	if (point->central)
		at = rb_vec3_add_scaled(rb_pair_motion_center(world, point->a),
		                        point->arm_a.x + (side == 0 ? 0 : point->gap),
		                        point->normal);
	else if (side == 0)
		at = rb_vec3_add(rb_pair_motion_center(world, point->a), point->arm_a);
	else
		at = rb_vec3_add_scaled(
			rb_vec3_add(rb_pair_motion_center(world, point->a), point->arm_a),
			point->gap, point->normal);
	return (struct rb_flush_point){placed_of(inspection, point, side, rectangle), at,
	                               rb_vec3_scale(side == 0 ? 1 : -1, point->normal),
	                               point->gap};
}

/* Whether two points belong to one manifold. */
static bool is_same_touch(const struct rb_step_point *x, const struct rb_step_point *y)
{
	return x->pair == y->pair && x->parts == y->parts;
}

/* Whether two points are of one part of the body at the other side, with parts that move alike. */
static bool share_part(const struct rb_world *world, const struct rb_step_point *x,
                       const struct rb_step_point *y, int side)
{
	const int of_x[2] = {x->a, x->b}, of_y[2] = {y->a, y->b};

	return of_x[1 - side] == of_y[1 - side] &&
	       rb_step_point_part(x, 1 - side) == rb_step_point_part(y, 1 - side) &&
	       move_alike(world, of_x[side], of_y[side]);
}

/* Finds the touches of a body, and which are hidden; false: no memory. */
static bool find_hidden(const struct rb_inspection *inspection, struct touch *touch, int count,
                        bool *any)
{
	const struct rb_step_point *const row = inspection->points->row;
	const double tolerance = inspection->world->model->stepped_tolerance_m;
	const rb_arena_mark here = rb_arena_here(inspection->arena);
	struct rb_flush_point *const flush = rb_arena_take(inspection->arena, (size_t)count,
	                                                   sizeof *flush);
	struct rb_flush_rectangle *const rectangle = rb_arena_take(inspection->arena, (size_t)count,
	                                                           sizeof *rectangle);

	for (int k = 0; k < count && flush && rectangle; k++) {
		const struct rb_step_point *const point = &row[touch[k].least];

		for (int side = 0; side < 2 && !touch[k].hidden; side++) {
			const struct rb_flush_point own = flush_point(inspection, point, side,
			                                              rectangle);
			int near = 0, of = 0;

			if (!rb_inspection_may_go_on(inspection->world->model,
			                             side == 0 ? point->a : point->b) ||
			    !rb_flush_is_border(own.part, own.outward))
				continue;
			for (int o = 0; o < count; o++) {
				const struct rb_step_point *const other = &row[touch[o].least];

				if (!share_part(inspection->world, point, other, side))
					continue;
				if (o == k)
					of = near;
				flush[near] = flush_point(inspection, other, side,
				                          &rectangle[near]);
				near++;
			}
			const int by = rb_flush_hidden_by(flush, near, of, tolerance);
			if (by < 0)
				continue;
			touch[k].hidden = *any = true;
			touch[k].side = side;
			touch[k].normal = rb_vec3_scale(side == 0 ? 1 : -1, flush[by].outward);
		}
	}
	rb_arena_back(inspection->arena, here);
	return flush && rectangle;
}

/* Fills the touches of all points from `first` on, in their order; returns their number. */
static size_t find_touches(const struct rb_step_points *points, size_t first, struct touch *touch)
{
	size_t count = 0;

	for (size_t k = first; k < points->count; k++) {
		if (k > first && is_same_touch(&points->row[k - 1], &points->row[k])) {
			struct touch *const last = &touch[count - 1];

			last->count++;
			if (points->row[k].gap < points->row[last->least].gap)
				last->least = k;
			continue;
		}
		touch[count] = (struct touch){.first = k, .count = 1, .least = k, .index = count};
		count++;
	}
	return count;
}

/* Whether another part goes on where a point of a hidden touch is. */
static bool is_inner(const struct rb_inspection *inspection, const struct touch *touch,
                     const struct rb_step_point *point)
{
	const struct rb_step_point *const row = inspection->points->row;
	const struct rb_step_point *const own = &row[touch->least];
	const double tolerance = inspection->world->model->stepped_tolerance_m;
	const int side = touch->side;
	const rb_vec3 outward = rb_vec3_scale(side == 0 ? 1 : -1, touch->normal);
	struct rb_flush_rectangle rectangle;
	const rb_vec3 at = flush_point(inspection, point, side, &rectangle).at;

	for (int o = 0; o < touch->group_count; o++) {
		const struct rb_step_point *const near = &row[touch->group[o].least];

		if (!is_same_touch(near, own) && share_part(inspection->world, own, near, side) &&
		    rb_flush_goes_on(placed_of(inspection, near, side, &rectangle), outward, at,
		                     tolerance))
			return true;
	}
	return false;
}

/*
 * Removes those of the last points of the inspection, of a hidden touch, that are corners of the
 * other part, which have been added before, or where the common face goes on.
 */
static void keep_borders(struct rb_inspection *inspection, const struct touch *touch, size_t from)
{
	const struct rb_step_point *const own = &inspection->points->row[touch->least];
	const int side = touch->side;
	struct rb_flush_rectangle rectangle;
	const rb_placed *const other = placed_of(inspection, own, 1 - side, &rectangle);
	size_t count = from;

	for (size_t k = from; k < inspection->count; k++) {
		const struct rb_step_point *const point = &inspection->out[k];
		const uint32_t feature = rb_step_point_feature(point, 1 - side);
		struct rb_flush_rectangle unused;
		const rb_vec3 at = flush_point(inspection, point, side, &unused).at;

		if (!rb_flush_is_corner(other, feature, at, touch->normal) &&
		    !is_inner(inspection, touch, point))
			inspection->out[count++] = *point;
	}
	inspection->all -= inspection->count - count;
	inspection->count = count;
}

/* Replaces the points of hidden touches. */
static bool replace(struct rb_step_points *points, size_t first, const struct touch *touch,
                    size_t count, const struct rb_inspection *each)
{
	struct rb_inspection inspection = *each;
	struct rb_world *const world = each->world;
	size_t hidden = 0;

	for (size_t k = 0; k < count; k++)
		hidden += touch[k].hidden;
	inspection.capacity = points->count - first + 2 * RB_MANIFOLD_MAX * hidden;
	struct rb_step_point *const out = rb_arena_take(inspection.arena, inspection.capacity,
	                                                sizeof *out);
	if (!out)
		return false;
	inspection.out = out;
	for (size_t k = 0; k < count; k++) {
		const struct rb_step_point *const point = &points->row[touch[k].least];
		const struct rb_pair pair = {point->a, point->b};

		if (!touch[k].hidden) {
			memcpy(out + inspection.count, points->row + touch[k].first,
			       touch[k].count * sizeof *out);
			inspection.count += touch[k].count;
			inspection.all += touch[k].count;
			continue;
		}
		if (rb_pair_is_plain(world->model, pair.a, pair.b))
			continue;
		const int part[2] = {rb_step_point_part(point, 0), rb_step_point_part(point, 1)};
		const double slack = rb_clearance_min(
			inspection.max,
			rb_step_closing_of(world, inspection.candidates, pair, inspection.h));
		inspection.pair = point->pair;
		const rb_vec3 outward = rb_vec3_scale(touch[k].side == 0 ? 1 : -1, touch[k].normal);
		rb_inspect_plane(&inspection, pair, part, touch[k].side, outward, slack);
		const size_t from = inspection.count;
		rb_inspect_along(&inspection, pair, part, touch[k].normal, slack);
		keep_borders(&inspection, &touch[k], from);
	}
	RB_ASSERT(!inspection.failed);
	if (!rb_memory_reserve(&points->row, &points->capacity, first + inspection.count,
	                       sizeof *points->row))
		return false;
	memcpy(points->row + first, out, inspection.count * sizeof *out);
	points->count = first + inspection.count;
	return true;
}

/* The same with their touches, sorted by body. */
static bool find_and_replace(struct rb_step_points *points, size_t first,
                             const struct rb_inspection *each)
{
	struct rb_arena *const arena = each->arena;
	const size_t capacity = points->count - first;
	struct touch *const touch = rb_arena_take(arena, capacity, sizeof *touch);
	struct touch *const sorted = rb_arena_take(arena, capacity, sizeof *sorted);
	struct rb_sort_item *const item = rb_arena_take(arena, 2 * capacity, sizeof *item);
	bool any = false;

	if (!touch || !sorted || !item)
		return false;
	const size_t count = find_touches(points, first, touch);
	for (size_t k = 0; k < count; k++)
		item[k] = (struct rb_sort_item){(uint64_t)points->row[touch[k].first].a, k};
	rb_sort_by_key(item, item + count, count);
	for (size_t k = 0; k < count; k++)
		sorted[k] = touch[item[k].value];
	for (size_t k = 0, end; k < count; k = end) {
		for (end = k + 1; end < count && item[end].key == item[k].key;)
			end++;
		for (size_t t = k; t < end; t++) {
			sorted[t].group = sorted + k;
			sorted[t].group_count = (int)(end - k);
		}
		if (end > k + 1 && !find_hidden(each, sorted + k, (int)(end - k), &any))
			return false;
	}
	if (!any)
		return true;
	for (size_t k = 0; k < count; k++)
		touch[sorted[k].index] = sorted[k];
	return replace(points, first, touch, count, each);
}

bool rb_flush_surfaces(struct rb_step_points *points, size_t first,
                       const struct rb_inspection *each)
{
	const rb_arena_mark here = rb_arena_here(each->arena);
	const bool good = first == points->count || find_and_replace(points, first, each);

	rb_arena_back(each->arena, here);
	return good;
}
