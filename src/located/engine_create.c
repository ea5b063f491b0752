/* SPDX-License-Identifier: MIT */
#include "located/engine_create.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "geom/distance.h"
#include "located/cluster.h"
#include "located/crowd.h"
#include "located/follow.h"
#include "located/external_force.h"
#include "located/joint_rows.h"
#include "located/pair_contacts.h"

/* Number of bodies from which cells pay. */
enum { CELLS_FROM = 48 };

/* A zeroed array of at least one element; sets *failed if there is no memory. */
static void *row(size_t count, size_t size, bool *failed)
{
	void *const block = rb_memory_take(count > 0 ? count : 1, size);

	*failed = *failed || !block;
	return block;
}

/* True if nothing depends on the orientation: then a fast spin does not shorten pieces. */
static bool is_unfelt(const struct rb_located *l, int i)
{
	const struct rb_model *model = l->model;

	return model->shape[i].kind == RB_SHAPE_SPHERE && !model->center_of_mass &&
	       !isnan(model->inverse_inertia_scalar[i]) && !rb_located_driven(l, i) &&
	       !rb_external_turns_with(l, i) && !rb_joint_rows_hold(l, i);
}

/* Allocates and initialises all arrays by body. */
static bool make_rows(struct rb_located *l)
{
	const size_t n = (size_t)l->n;
	bool failed = false;

	l->arc = row(n, sizeof *l->arc, &failed);
	l->generation = row(n, sizeof *l->generation, &failed);
	if (l->model->keeps_ledger)
		l->account_s = row(n, sizeof *l->account_s, &failed);
	l->next = row(n, sizeof *l->next, &failed);
	l->bounces = row(n, sizeof *l->bounces, &failed);
	l->crowd_of = row(n, sizeof *l->crowd_of, &failed);
	l->joined = row(n, sizeof *l->joined, &failed);
	l->cluster_of = row(n, sizeof *l->cluster_of, &failed);
	l->near = row(n, sizeof *l->near, &failed);
	l->inspected = row(n, sizeof *l->inspected, &failed);
	l->set = row(n, sizeof *l->set, &failed);
	l->place = row(n, sizeof *l->place, &failed);
	if (l->model->joints) {
		const size_t parts = (size_t)l->model->joints->count * RB_JOINT_PARTS_HELD;

		l->drive_mode = row(parts, sizeof *l->drive_mode, &failed);
		l->drive_next = row(parts, sizeof *l->drive_next, &failed);
		l->eased = row(parts, sizeof *l->eased, &failed);
		if (!failed)
			memset(l->drive_next, RB_DRIVE_KEEPS, parts);
		failed = !rb_follow_create(l) || failed;
	}
	l->plane_normal = row((size_t)l->model->static_count, sizeof *l->plane_normal, &failed);
	if (l->world->state.orientation) {
		l->top = row(n, sizeof *l->top, &failed);
		l->top_body = row(n, sizeof *l->top_body, &failed);
		l->orientation_unused = row(n, sizeof *l->orientation_unused, &failed);
	}
	if (failed)
		return false;
	for (int i = 0; i < l->n; i++) {
		l->cluster_of[i] = l->place[i] = -1;
		l->next[i] = (struct rb_next){.touch_s = HUGE_VAL, .wall_s = HUGE_VAL};
		l->bounces[i] = (struct rb_bounces){.partner = -1, .met_with = -1};
		if (!l->top)
			continue;
		l->top_body[i] = *rb_model_top(l->model, i);
		l->orientation_unused[i] = is_unfelt(l, i);
	}
	for (int k = 0; k < l->model->static_count; k++)
		l->plane_normal[k] = rb_plane_normal(l->model->orientation[l->n + k]);
	return true;
}

/* Cells of the bodies' bounding spheres about their centres of mass. */
static enum rb_status make_cells(struct rb_located *l, struct rb_error *err)
{
	const size_t n = (size_t)l->n;
	double *const radius = rb_memory_take(n, sizeof *radius);
	enum rb_status status;

	if (!radius)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the cells of %zu bodies", n);
	for (int i = 0; i < l->n; i++)
		radius[i] = rb_pair_extent(l, i);
	status = rb_cells_create(&l->cells, l->n, radius, l->world->state.position, err);
	rb_memory_free(radius);
	return status;
}

/* True if cells pay. */
static bool wants_cells(const struct rb_located *l)
{
	return l->n >= CELLS_FROM && (l->model->features & RB_FEATURE_CONTACT);
}

enum rb_status rb_engine_create(struct rb_located **made, struct rb_world *world,
                                struct rb_error *err)
{
	struct rb_located *l = rb_memory_take(1, sizeof *l);
	enum rb_status status = RB_OK;

	*made = NULL;
	if (!l)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the located method");
	l->world = world;
	l->model = world->model;
	l->n = world->model->body_count;
	l->arena = &world->arena[0];
	l->end_s = world->model->duration_s;
	l->decays = rb_external_drag_is_linear(l->model);
	/* without contacts and joints there are no crowds: located at any cost */
	l->world_max = rb_located_can_be_stepped(l) && (l->model->features &
	                                                (RB_FEATURE_CONTACT | RB_FEATURE_JOINTS))
	                       ? rb_crowd_world_max(l)
	                       : UINT64_MAX;
	l->crowd_max = l->world_max;
	l->weight = rb_vec3_length(world->model->scene->world.gravity) +
	            rb_gravitation_weight(world->model);
	l->stuck_s = -HUGE_VAL;
	l->touch_a = l->touch_b = -1;
	if (!make_rows(l) || !rb_external_switches(l))
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for the located method");
	if (status == RB_OK) {
		rb_crowd_begin(l);
		status = rb_gravitation_create(&l->gravitation, l->model, err);
	}
	/* bodies, clusters (never more than bodies), switches of forces */
	if (status == RB_OK)
		status = rb_queue_create(&l->queue, 2 * l->n + 1, err);
	if (status == RB_OK && wants_cells(l))
		status = make_cells(l, err);
	if (status != RB_OK) {
		rb_engine_destroy(l);
		return status;
	}
	*made = l;
	return RB_OK;
}

void rb_engine_destroy(struct rb_located *l)
{
	if (!l)
		return;
	rb_cluster_release_all(l);
	rb_driven_release(l);
	rb_follow_release(l);
	rb_queue_destroy(l->queue);
	rb_cells_destroy(l->cells);
	rb_memory_free(l->arc);
	rb_memory_free(l->top);
	rb_memory_free(l->top_body);
	rb_memory_free(l->orientation_unused);
	rb_memory_free(l->piece);
	rb_memory_free(l->warm_start);
	rb_memory_free(l->factors);
	rb_memory_free(l->generation);
	rb_memory_free(l->account_s);
	rb_memory_free(l->next);
	rb_memory_free(l->bounces);
	rb_memory_free(l->crowd_of);
	rb_memory_free(l->joined);
	rb_memory_free(l->cluster_of);
	rb_memory_free(l->near);
	rb_memory_free(l->inspected);
	rb_memory_free(l->set);
	rb_memory_free(l->place);
	rb_memory_free(l->plane_normal);
	rb_memory_free(l->drive_mode);
	rb_memory_free(l->drive_next);
	rb_memory_free(l->eased);
	rb_memory_free(l->switch_s);
	rb_gravitation_release(&l->gravitation);
	rb_memory_free(l->merge);
	rb_contacts_release(&l->stepped_contacts);
	rb_memory_free(l);
}
