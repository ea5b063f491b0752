/* SPDX-License-Identifier: MIT */
/*
 * The grid of geom/grid with the static boxes prepared once. Infinite planes have no box: each is
 * tested against every moving box, since scenes have a handful of them. Rectangles have tight
 * boxes, all other static bodies that of their bounding sphere.
 */
#include "step/broadphase.h"

#include <float.h>

#include "base/error.h"
#include "base/memory.h"
#include "geom/distance.h"
#include "model/joints.h"

struct half_space {
	rb_vec3 point, normal;
	int index; /* of the plane in the model */
};

struct rb_broadphase {
	/* set once, then only read */
	const struct rb_model *model;
	rb_aabb *fixed;   /* owned: boxes of the bounded statics */
	int *fixed_index; /* owned: their indices in the model, ascending */
	int fixed_count;
	struct half_space *planes; /* owned */
	int plane_count;
	uint64_t *group_bit, *collides; /* owned: by index of the grid; NULL without filters */

	struct rb_grid grid;
	uint64_t plane_tests;
};

/* World box of a bounded static body, m. */
static rb_aabb box_of_static(const struct rb_model *model, int index)
{
	const rb_vec3 p = model->position[index];
	const struct rb_shape *shape = &model->shape[index];
	const double reach = rb_model_reach(model, index);
	rb_vec3 h = {reach, reach, reach};

	if (shape->kind == RB_SHAPE_RECTANGLE) {
		const rb_rectangle r = rb_rectangle_of(p, model->orientation[index], shape->size);
		const rb_vec3 x = rb_vec3_scale(r.half_x, r.axis_x),
			      y = rb_vec3_scale(r.half_y, r.axis_y);
		/* margin for the rounding of the rotated axes */
		const double slack = 4 * DBL_EPSILON * (r.half_x + r.half_y);

		h = (rb_vec3){fabs(x.x) + fabs(y.x) + slack, fabs(x.y) + fabs(y.y) + slack,
		              fabs(x.z) + fabs(y.z) + slack};
	}
	return (rb_aabb){rb_vec3_sub(p, h), rb_vec3_add(p, h)};
}

/* Allocates for the static bodies and, with filters, for all. */
static enum rb_status take_columns(struct rb_broadphase *broadphase, struct rb_error *err)
{
	const struct rb_model *model = broadphase->model;
	const size_t statics = (size_t)model->static_count;
	const size_t bodies = (size_t)model->body_count + statics;

	broadphase->fixed = rb_memory_take(statics, sizeof *broadphase->fixed);
	broadphase->fixed_index = rb_memory_take(statics, sizeof *broadphase->fixed_index);
	broadphase->planes = rb_memory_take(statics, sizeof *broadphase->planes);
	if (model->group_bit) {
		broadphase->group_bit = rb_memory_take(bodies, sizeof *broadphase->group_bit);
		broadphase->collides = rb_memory_take(bodies, sizeof *broadphase->collides);
	}
	if (!broadphase->fixed || !broadphase->fixed_index || !broadphase->planes ||
	    (model->group_bit && (!broadphase->group_bit || !broadphase->collides)))
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "out of memory for the boxes of %zu static bodies", statics);
	return RB_OK;
}

/* Divides the static bodies into planes and boxes; filters are copied by index of the grid. */
static void sort_statics(struct rb_broadphase *broadphase)
{
	const struct rb_model *model = broadphase->model;
	const int moving = model->body_count;

	for (int i = moving; i < moving + model->static_count; i++) {
		if (model->shape[i].kind == RB_SHAPE_PLANE) {
			broadphase->planes[broadphase->plane_count++] = (struct half_space){
				.point = model->position[i],
				.normal = rb_plane_normal(model->orientation[i]),
				.index = i,
			};
		} else {
			broadphase->fixed[broadphase->fixed_count] = box_of_static(model, i);
			broadphase->fixed_index[broadphase->fixed_count++] = i;
		}
	}
	if (!model->group_bit)
		return;
	for (int i = 0; i < moving + broadphase->fixed_count; i++) {
		const int index = i < moving ? i : broadphase->fixed_index[i - moving];

		broadphase->group_bit[i] = model->group_bit[index];
		broadphase->collides[i] = model->collides[index];
	}
	RB_ASSERT(broadphase->fixed_count + broadphase->plane_count == model->static_count);
}

enum rb_status rb_broadphase_create(struct rb_broadphase **broadphase, const struct rb_model *model,
                                    struct rb_error *err)
{
	struct rb_broadphase *made = rb_memory_take(1, sizeof *made);

	*broadphase = NULL;
	if (!made)
		return RB_FAIL(err, RB_ERR_MEMORY, "out of memory for the broadphase");
	made->model = model;
	rb_grid_init(&made->grid);
	const enum rb_status status = take_columns(made, err);
	if (status != RB_OK) {
		rb_broadphase_destroy(made);
		return status;
	}
	sort_statics(made);
	*broadphase = made;
	return RB_OK;
}

void rb_broadphase_share(struct rb_broadphase *broadphase, struct rb_team *team)
{
	broadphase->grid.team = team;
}

void rb_broadphase_destroy(struct rb_broadphase *broadphase)
{
	if (!broadphase)
		return;
	rb_memory_free(broadphase->fixed);
	rb_memory_free(broadphase->fixed_index);
	rb_memory_free(broadphase->planes);
	rb_memory_free(broadphase->group_bit);
	rb_memory_free(broadphase->collides);
	rb_grid_release(&broadphase->grid);
	rb_memory_free(broadphase);
}

void rb_broadphase_borrow(struct rb_broadphase *broadphase, struct rb_arena *arena)
{
	broadphase->grid.arena = arena;
}

/*
 * True if the box's deepest corner is behind the plane, with a margin of 8 ulp of the sum's terms.
 */
static inline bool reaches(const struct half_space *plane, const rb_aabb *box)
{
	const rb_vec3 n = plane->normal;
	const double x = (n.x >= 0 ? box->low.x : box->high.x) - plane->point.x;
	const double y = (n.y >= 0 ? box->low.y : box->high.y) - plane->point.y;
	const double z = (n.z >= 0 ? box->low.z : box->high.z) - plane->point.z;
	const double size = fabs(x * n.x) + fabs(y * n.y) + fabs(z * n.z);

	return x * n.x + y * n.y + z * n.z <= 8 * DBL_EPSILON * size;
}

/* Adds the pairs of planes and moving boxes. */
static enum rb_status find_planes(struct rb_broadphase *broadphase, const rb_aabb *box,
                                  struct rb_error *err)
{
	const struct rb_model *model = broadphase->model;

	for (int p = 0; p < broadphase->plane_count; p++) {
		const struct half_space *plane = &broadphase->planes[p];

		for (int i = 0; i < model->body_count; i++) {
			if (!reaches(plane, &box[i]))
				continue;
			if (model->group_bit &&
			    ((model->collides[i] & model->group_bit[plane->index]) == 0 ||
			     (model->collides[plane->index] & model->group_bit[i]) == 0))
				continue;
			const enum rb_status status = rb_grid_add_pair(&broadphase->grid, i,
			                                               plane->index, err);
			if (status != RB_OK)
				return status;
		}
		broadphase->plane_tests += (uint64_t)model->body_count;
	}
	return RB_OK;
}

/* Removes pairs connected by joints. */
static void drop_joined(struct rb_grid *grid, const struct rb_model *model)
{
	size_t kept = 0;

	for (size_t i = 0; i < grid->pair_count; i++)
		if (!rb_joints_between(model->joints, grid->pairs[i].a, grid->pairs[i].b))
			grid->pairs[kept++] = grid->pairs[i];
	grid->pair_count = kept;
}

enum rb_status rb_broadphase_find(struct rb_broadphase *broadphase, const rb_aabb *box,
                                  const struct rb_pair **pairs, size_t *pair_count,
                                  struct rb_error *err)
{
	const struct rb_model *model = broadphase->model;
	struct rb_grid *grid = &broadphase->grid;
	const struct rb_grid_boxes boxes = {
		.moving = box,
		.fixed = broadphase->fixed,
		.moving_count = model->body_count,
		.fixed_count = broadphase->fixed_count,
		.group_bit = broadphase->group_bit,
		.collides = broadphase->collides,
	};

	*pairs = NULL;
	*pair_count = 0;
	enum rb_status status = rb_grid_find(grid, &boxes, err);
	/* from indices of the grid, which omit the planes, to those of the model */
	if (broadphase->plane_count > 0)
		for (size_t i = 0; i < grid->pair_count; i++)
			if (grid->pairs[i].b >= model->body_count)
				grid->pairs[i].b = broadphase->fixed_index[grid->pairs[i].b -
				                                           model->body_count];
	if (status == RB_OK)
		status = find_planes(broadphase, box, err);
	if (model->joints)
		drop_joined(grid, model);
	if (status == RB_OK)
		status = rb_grid_sort(grid, model->body_count + model->static_count, err);
	if (status == RB_OK) {
		RB_ASSERT(grid->pair_count == 0 || grid->pairs[0].a < grid->pairs[0].b);
		*pairs = grid->pairs;
		*pair_count = grid->pair_count;
	}
	return status;
}

void rb_broadphase_discard(struct rb_broadphase *broadphase, size_t bytes)
{
	rb_memory_discard(broadphase->grid.pairs, bytes);
}

uint64_t rb_broadphase_tests(const struct rb_broadphase *broadphase)
{
	return broadphase->grid.tests + broadphase->plane_tests;
}
