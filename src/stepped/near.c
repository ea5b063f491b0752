/* SPDX-License-Identifier: MIT */
#include "stepped/near.h"

#include <string.h>

#include "base/memory.h"
#include "model/parts.h"

enum {
	STEPS_PER_BOX = 8, /* that a box is meant to last */
	BODIES_PER_BLOCK = 512
};

static void place(struct rb_near *near, const struct rb_model *model, int i, rb_vec3 origin,
                  rb_quat orientation)
{
	const struct rb_body_parts *parts = rb_model_parts(model, i);
	rb_placed *placed = near->placed + near->first_part[i];

	for (int k = 0; k < parts->count; k++)
		placed[k] = rb_body_part_place(&parts->part[k], origin, orientation);
}

static bool take_parts(struct rb_near *near, const struct rb_model *model)
{
	const int count = model->body_count + model->static_count;
	int parts = 0;

	if (!model->parts)
		return true;
	near->first_part = rb_memory_take((size_t)count + 1, sizeof *near->first_part);
	if (!near->first_part)
		return false;
	for (int i = 0; i < count; i++) {
		near->first_part[i] = parts;
		parts += rb_model_parts(model, i)->count;
	}
	near->first_part[count] = parts;
	near->placed = rb_memory_take((size_t)parts, sizeof *near->placed);
	near->ahead = rb_memory_take((size_t)model->body_count, sizeof *near->ahead);
	if (!near->placed || !near->ahead)
		return false;
	for (int i = model->body_count; i < count; i++)
		place(near, model, i, model->position[i], model->orientation[i]);
	return true;
}

enum rb_status rb_near_create(struct rb_near *near, const struct rb_model *model,
                              struct rb_error *err)
{
	const size_t n = (size_t)model->body_count;

	*near = (struct rb_near){0};
	near->built_at = rb_memory_take(n, sizeof *near->built_at);
	near->margin = rb_memory_take(n, sizeof *near->margin);
	near->reach = rb_memory_take(n, sizeof *near->reach);
	near->box = rb_memory_take(n, sizeof *near->box);
	if (near->built_at && near->margin && near->reach && near->box && take_parts(near, model))
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
	rb_memory_free(near->clue);
	rb_memory_free(near->first_part);
	rb_memory_free(near->placed);
	rb_memory_free(near->ahead);
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
	if (!rb_memory_reserve(&near->clue, &near->clue_capacity, near->pair_count,
	                       sizeof *near->clue))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu near pairs",
		               near->pair_count);
	if (near->pair_count > 0)
		memset(near->clue, 0, near->pair_count * sizeof *near->clue);
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

/* ---- parts ---- */

struct places {
	struct rb_near *near;
	struct rb_world *world;
};

static double turn_reach(const struct rb_world *world, int i, double h)
{
	if (!world->state.spin)
		return 0;
	const double spin = fmax(rb_vec3_length(rb_world_row3(world->state.spin, i)),
	                         rb_vec3_length(rb_world_row3(world->mark.spin, i)));
	return fmin(2, h * spin) * rb_model_reach(world->model, i);
}

static void place_block(void *user, int block, int worker)
{
	const struct places *places = user;
	const struct rb_world *world = places->world;
	const int n = world->model->body_count, first = block * BODIES_PER_BLOCK;
	const int end = first + BODIES_PER_BLOCK < n ? first + BODIES_PER_BLOCK : n;

	(void)worker;
	for (int i = first; i < end; i++) {
		struct rb_near *near = places->near;

		place(near, world->model, i, rb_world_origin_at(world, &world->state, i),
		      rb_world_orientation_at(world, &world->state, i));
		near->ahead[i] = near->reach[i] + turn_reach(world, i, near->h_s);
	}
}

void rb_near_place(struct rb_near *near, struct rb_world *world)
{
	struct places places = {near, world};
	const int n = world->model->body_count;

	if (near->placed)
		rb_team_run(world->team, (n + BODIES_PER_BLOCK - 1) / BODIES_PER_BLOCK, place_block,
		            &places);
}
