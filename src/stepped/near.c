/* SPDX-License-Identifier: MIT */
#include "stepped/near.h"

#include <string.h>

#include "base/memory.h"

/* Steps that a box is meant to last. */
enum { STEPS_PER_BOX = 8 };

enum rb_status rb_near_create(struct rb_near *near, const struct rb_model *model,
                              struct rb_error *err)
{
	const size_t n = (size_t)model->body_count;

	*near = (struct rb_near){0};
	near->built_at = rb_memory_take(n, sizeof *near->built_at);
	near->margin = rb_memory_take(n, sizeof *near->margin);
	near->reach = rb_memory_take(n, sizeof *near->reach);
	near->box = rb_memory_take(n, sizeof *near->box);
	if (near->built_at && near->margin && near->reach && near->box)
		return RB_OK;
	rb_near_release(near);
	return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the boxes of %zu bodies", n);
}

void rb_near_release(struct rb_near *near)
{
	rb_memory_free(near->built_at);
	rb_memory_free(near->margin);
	rb_memory_free(near->reach);
	rb_memory_free(near->box);
	rb_memory_free(near->axis);
	*near = (struct rb_near){0};
}

/* How far the object's origin gets at most at these speeds. */
static double way(const struct rb_world *world, const struct rb_state *state, int i, double h)
{
	const struct rb_model *model = world->model;
	double distance = rb_vec3_length(rb_world_row3(state->velocity, i)) * h;

	if (model->center_of_mass && state->spin)
		distance += rb_vec3_length(model->center_of_mass[i]) *
		            fmin(2, rb_vec3_length(rb_world_row3(state->spin, i)) * h);
	return distance;
}

static double from_built(const struct rb_near *near, const struct rb_world *world, int i)
{
	return rb_vec3_length(
		rb_vec3_sub(rb_world_origin_at(world, &world->state, i), near->built_at[i]));
}

static enum rb_status build(struct rb_near *near, struct rb_world *world, struct rb_error *err)
{
	const struct rb_model *model = world->model;
	double mean = 0;

	near->valid = false;
	for (int i = 0; i < model->body_count; i++)
		mean += near->reach[i] / model->body_count;
	for (int i = 0; i < model->body_count; i++) {
		const rb_vec3 c = rb_world_origin_at(world, &world->state, i);
		const double size = rb_model_reach(model, i);

		near->built_at[i] = c;
		/* forces add their share again in every step */
		near->margin[i] = STEPS_PER_BOX * fmax(near->reach[i], mean) + size / 64;
		const double half = (size + near->margin[i] + model->tolerance_m) * (1 + 1e-12);
		near->box[i] = (rb_aabb){{c.x - half, c.y - half, c.z - half},
		                         {c.x + half, c.y + half, c.z + half}};
	}
	const enum rb_status status = rb_broadphase_find(world->broadphase, near->box, &near->pair,
	                                                 &near->pair_count, err);
	if (status != RB_OK || !model->parts)
		return status;
	if (!rb_memory_reserve(&near->axis, &near->axis_capacity, near->pair_count,
	                       sizeof *near->axis))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu near pairs",
		               near->pair_count);
	if (near->pair_count > 0)
		memset(near->axis, 0, near->pair_count * sizeof *near->axis);
	return RB_OK;
}

enum rb_status rb_near_find(struct rb_near *near, struct rb_world *world,
                            const struct rb_state *before, double h, struct rb_error *err)
{
	const struct rb_model *model = world->model;

	near->h_s = h;
	for (int i = 0; i < model->body_count; i++) {
		near->reach[i] = fmax(way(world, &world->state, i, h), way(world, before, i, h));
		/* written so that NaN asks for new boxes */
		if (near->valid &&
		    !(from_built(near, world, i) + near->reach[i] <= near->margin[i]))
			near->valid = false;
	}
	if (near->valid)
		return RB_OK;
	const enum rb_status status = build(near, world, err);
	near->valid = status == RB_OK;
	return status;
}

bool rb_near_holds(const struct rb_near *near, const struct rb_world *world)
{
	for (int i = 0; i < world->model->body_count; i++)
		if (!(from_built(near, world, i) <= near->margin[i]))
			return false;
	return true;
}
