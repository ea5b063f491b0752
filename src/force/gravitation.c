/* SPDX-License-Identifier: MIT */
#include "force/gravitation.h"

#include <math.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/quat.h"

enum rb_status rb_gravitation_create(struct rb_gravitation *made, const struct rb_model *model,
                                     struct rb_error *err)
{
	const size_t n = (size_t)(model->body_count + model->static_count);

	*made = (struct rb_gravitation){.model = model};
	if (!model->attraction)
		return RB_OK;
	made->block = rb_memory_take(9 * n, sizeof *made->block);
	if (!made->block)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the gravitation of %zu bodies",
		               n);
	made->all = (struct rb_attract){.count = (int)n,
	                                .mu = model->attraction,
	                                .inertial = model->mass,
	                                .softening2 = model->softening2_m2};
	for (size_t m = 0; m < 3; m++) {
		made->all.x[m] = made->block + m * n;
		made->all.rest[m] = made->block + (3 + m) * n;
		made->acceleration[m] = made->block + (6 + m) * n;
	}
	for (int i = model->body_count; i < (int)n; i++) {
		const rb_vec3 center = model->scene->bodies[model->id_of[i]].center_of_mass;

		rb_gravitation_place(made, i,
		                     rb_vec3_add(model->position[i],
		                                 rb_quat_rotate(model->orientation[i], center)),
		                     (rb_vec3){0, 0, 0});
	}
	return RB_OK;
}

void rb_gravitation_release(struct rb_gravitation *gravitation)
{
	rb_memory_free(gravitation->block);
	*gravitation = (struct rb_gravitation){0};
}

void rb_gravitation_find(struct rb_gravitation *gravitation)
{
	RB_ASSERT(gravitation->block != NULL);
	rb_attract_some(&gravitation->all, 0, gravitation->model->body_count,
	                gravitation->acceleration);
}

/* Bodies of a block, and from how many on blocks are shared: some hundred microseconds of sums. */
enum { BODIES_PER_BLOCK = 64, SHARED_FROM = 256 };

static void find_block(void *user, int block, int worker)
{
	const struct rb_gravitation *const gravitation = user;
	const int n = gravitation->model->body_count, first = block * BODIES_PER_BLOCK;
	const int end = first + BODIES_PER_BLOCK < n ? first + BODIES_PER_BLOCK : n;

	(void)worker;
	rb_attract_some(&gravitation->all, first, end, gravitation->acceleration);
}

void rb_gravitation_find_by(struct rb_gravitation *gravitation, struct rb_team *team)
{
	const int n = gravitation->model->body_count;

	if (n < SHARED_FROM)
		rb_gravitation_find(gravitation);
	else
		rb_team_run(team, (n + BODIES_PER_BLOCK - 1) / BODIES_PER_BLOCK, find_block,
		            gravitation);
}

rb_vec3 rb_gravitation_surplus(const struct rb_gravitation *gravitation, int i, int j)
{
	const struct rb_attract *const all = &gravitation->all;
	double factor;
	const rb_vec3 d = rb_attract_between(all, i, j, &factor);

	return rb_vec3_scale(
		factor * (all->inertial[i] * all->mu[j] - rb_attract_strength(all, i, j)), d);
}

double rb_gravitation_weight(const struct rb_model *model)
{
	const int n = model->body_count + model->static_count;
	double least = (double)INFINITY, max = 0;

	if (!model->attraction)
		return 0;
	for (int i = 0; i < model->body_count; i++)
		if (model->inverse_mass[i] > 0)
			least = fmin(least, rb_model_reach(model, i));
	for (int j = 0; j < n; j++) {
		const double distance = rb_model_reach(model, j) + least;

		max = fmax(max,
		           model->attraction[j] / (distance * distance + model->softening2_m2));
	}
	return max;
}
