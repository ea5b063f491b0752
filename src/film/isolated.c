/* SPDX-License-Identifier: MIT */
/*
 * Which spheres cut others. Bodies in contact overlap by the tolerance at most, so radii are taken
 * 0.1 % smaller, about a tenth of a pixel of a sphere of 100 px: touching spheres count as apart.
 */
#include "film/isolated.h"

#include <math.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/vec3.h"

const double rb_apart_part = 0.999;

void rb_apart_init(struct rb_apart *apart)
{
	*apart = (struct rb_apart){0};
	rb_grid_init(&apart->grid);
}

void rb_apart_release(struct rb_apart *apart)
{
	rb_grid_release(&apart->grid);
	rb_memory_free(apart->box);
	*apart = (struct rb_apart){0};
}

enum rb_status rb_apart_find(struct rb_apart *apart, struct rb_apart_ball *balls, int count,
                             struct rb_error *err)
{
	const struct rb_pair *pairs;

	if (!rb_memory_reserve(&apart->box, &apart->capacity, (size_t)count, sizeof *apart->box))
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw %d spheres: out of memory", count);
	for (int k = 0; k < count; k++) {
		const rb_vec3 c = balls[k].centre;
		const double r = rb_apart_part * balls[k].radius;
		apart->box[k].low = (rb_vec3){c.x - r, c.y - r, c.z - r};
		apart->box[k].high = (rb_vec3){c.x + r, c.y + r, c.z + r};
	}
	const struct rb_grid_boxes boxes = {.moving = apart->box, .moving_count = count};
	const enum rb_status status = rb_grid_find(&apart->grid, &boxes, err);
	if (status)
		return status;
	pairs = apart->grid.pairs;
	for (size_t p = 0; p < apart->grid.pair_count; p++) {
		struct rb_apart_ball *a = &balls[pairs[p].a], *b = &balls[pairs[p].b];
		const rb_vec3 way = rb_vec3_sub(b->centre, a->centre);
		const double reach = rb_apart_part * (a->radius + b->radius);
		if (rb_vec3_dot(way, way) < reach * reach)
			a->cuts = b->cuts = true;
	}
	return RB_OK;
}

/* Parameter of the foot on an edge, within it. */
static double part_of(rb_vec3 way, rb_vec3 edge)
{
	const double part = rb_vec3_dot(way, edge) / rb_vec3_dot(edge, edge);

	return fmin(fmax(part, 0), 1);
}

bool rb_apart_cuts_rectangle(const struct rb_apart_ball *ball, rb_vec3 corner, rb_vec3 u, rb_vec3 v)
{
	const rb_vec3 way = rb_vec3_sub(ball->centre, corner);
	rb_vec3 rest = rb_vec3_add_scaled(way, -part_of(way, u), u);

	rest = rb_vec3_add_scaled(rest, -part_of(way, v), v);
	const double reach = rb_apart_part * ball->radius;
	return rb_vec3_dot(rest, rest) < reach * reach;
}
