/* SPDX-License-Identifier: MIT */
/*
 * Contacts and overlaps at a time, for frames, reports and checkpoints; the simulation's state does
 * not change.
 */
#include "located/inspect.h"

#include "base/error.h"
#include "located/integrate.h"
#include "located/convex_contact.h"
#include "step/verdict.h"

/* Appends a held contact with a given force. */
static void add_contact(struct rb_located *l, struct rb_contacts *contacts,
                        const struct rb_held *held, double t, rb_vec3 force)
{
	const struct rb_contact_point m = rb_event_set_contact_point(l, held, t);
	const double normal = rb_vec3_dot(force, m.normal);
	const struct rb_contact_name own = rb_event_set_name(held),
				     name = rb_contact_name_shared(&own);

	contacts->row[contacts->count++] = (struct rb_contact){
		.a = held->a,
		.b = held->b,
		.point = m.point,
		.normal = m.normal,
		.gap = m.gap,
		/* a contact about to end may pull by rounding: without friction then */
		.normal_force = fmax(0, normal),
		.tangent_force = normal > 0 ? rb_vec3_add_scaled(force, -normal, m.normal)
	                                    : (rb_vec3){0, 0, 0},
		.parts = name.parts,
		.key = name.key};
}

/*
 * Adds the contacts of a cluster. With `force` the forces are computed for time t, since they
 * change along the piece; else those at its beginning are reported.
 */
static void add_cluster(struct rb_located *l, struct rb_contacts *contacts, int cluster, double t,
                        rb_vec3 *force)
{
	const struct rb_cluster *c = &l->cluster[cluster];
	const bool carries = c->used && (c->held_count > 0 || l->model->joints);
	/* at rest, the forces of contacts are known, but those of joints are not */
	const bool rests = c->at_rest && !c->integrated && l->model->joints;
	const bool found = force && carries && (c->integrated || rests) && !c->has_jumped &&
	                   rb_integrate_forces(l, cluster, t, force);
	const bool now = found && c->integrated;

	for (int h = 0; h < c->held_count; h++)
		add_contact(l, contacts, &c->held[h], t, now ? force[h] : c->held[h].force);
}

/* All held contacts at t, sorted. */
static enum rb_status list(struct rb_located *l, double t, bool at_moment,
                           struct rb_contacts *contacts)
{
	const rb_arena_mark here = rb_arena_here(l->arena);
	rb_vec3 *force = NULL;
	size_t count = 0;

	for (int k = 0; k < l->cluster_count; k++)
		count += (size_t)l->cluster[k].held_count;
	contacts->count = 0;
	const enum rb_status status = rb_contacts_reserve(contacts, count, l->err);
	if (status != RB_OK)
		return status;
	if (at_moment) {
		force = rb_arena_take(l->arena, count + 1, sizeof *force);
		if (!force)
			return RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for %zu contacts", count);
	}
	for (int k = 0; k < l->cluster_count; k++)
		add_cluster(l, contacts, k, t, force);
	rb_arena_back(l->arena, here);
	rb_contacts_sort(contacts);
	return l->status;
}

enum rb_status rb_inspect_contacts(struct rb_located *l, double t)
{
	RB_ASSERT(t >= l->now_s);
	return list(l, t, false, &l->world->contacts);
}

enum rb_status rb_inspect_forces(struct rb_located *l, double t, struct rb_contacts *shown)
{
	const double *const push = l->world->push, *const twist = l->world->twist;

	rb_world_choose_pushes(l->world);
	const enum rb_status status = list(l, t, true, shown);
	l->world->push = push;
	l->world->twist = twist;
	return status;
}

/* Gap of a pair, m: that of its deepest point. */
static double gap_at(const struct rb_located *l, int i, int j, double t)
{
	if (!rb_pair_has_features(l, i, j))
		return rb_contact_point_at(l, i, j, t).gap;
	const struct rb_touch_pair pair = {i, j, t, rb_arc_pose(l, i, t), rb_arc_pose(l, j, t)};
	uint32_t parts;

	return rb_touch_gap(l, &pair, &parts);
}

/* The shape's origin at the time of the state, which has the positions of all arcs already. */
static inline rb_vec3 origin_of(const struct rb_located *l, int i)
{
	const struct rb_state *const state = &l->world->state;

	if (i >= l->n || l->model->center_of_mass)
		return rb_arc_origin(l, i, state->time_s);
	const rb_vec3 here = rb_world_row3(state->position, i);

	RB_ASSERT_COSTLY(rb_vec3_max_abs(rb_vec3_sub(here, rb_arc_position(l, i, state->time_s))) ==
	                 0);
	return here;
}

/* True if both are spheres and separate, as most bodies that are near. */
static inline bool are_separate(const struct rb_located *l, int i, int j)
{
	const struct rb_shape *const a = &l->model->shape[i], *const b = &l->model->shape[j];

	if (a->kind != RB_SHAPE_SPHERE || b->kind != RB_SHAPE_SPHERE)
		return false;
	const rb_vec3 d = rb_vec3_sub(origin_of(l, j), origin_of(l, i));
	const double sum = a->radius + b->radius;

	return rb_vec3_dot(d, d) > sum * sum;
}

/* True if a sphere is separate from a static one, or above a plane. */
static bool is_separate_static(const struct rb_located *l, int i, int j)
{
	const struct rb_shape *const a = &l->model->shape[i], *const b = &l->model->shape[j];

	if (a->kind != RB_SHAPE_SPHERE || b->kind != RB_SHAPE_PLANE)
		return are_separate(l, i, j);
	const rb_vec3 d = rb_vec3_sub(origin_of(l, i), l->model->position[j]);

	return rb_vec3_dot(d, l->plane_normal[j - l->n]) > a->radius;
}

/* Deepest overlap of a body with another one; -1: none. */
struct deepest {
	double depth_m;
	int with;
};

/* Updates it with the pair i, j, which is not separate at a glance. */
static void update_deepest(const struct rb_located *l, double t, int i, int j,
                           struct deepest *deepest)
{
	/* the same bits whichever of the two the pair is listed for */
	const int a = i < j ? i : j, b = i < j ? j : i;

	if (!rb_pair_can_touch(l, a, b))
		return;
	if (rb_pair_has_features(l, a, b) && rb_pair_is_far(l, a, b, t, t))
		return;
	const double gap = gap_at(l, a, b, t);
	if (-gap > deepest->depth_m)
		*deepest = (struct deepest){-gap, j};
}

void rb_inspect_forget(struct rb_located *l)
{
	for (int i = 0; i < l->n; i++)
		l->inspected[i].rested = false;
}

bool rb_inspect_is_at_rest(const struct rb_located *l, int i)
{
	const struct rb_state *state = &l->world->state;
	const rb_vec3 none = {0, 0, 0};
	const rb_vec3 spin = state->spin ? rb_world_row3(state->spin, i) : none;

	return !rb_located_on_piece(l, i) && !rb_located_driven(l, i) &&
	       rb_vec3_max_abs(l->arc[i].velocity) == 0 &&
	       rb_vec3_max_abs(l->arc[i].acceleration) == 0 && rb_vec3_max_abs(spin) == 0;
}

/* Updates which bodies have been at rest since the last call. */
static void update_rest(struct rb_located *l)
{
	for (int i = 0; i < l->n; i++) {
		struct rb_inspected *const of = &l->inspected[i];
		const bool at_rest = rb_inspect_is_at_rest(l, i);

		of->rests = at_rest && of->rested && of->generation == l->generation[i];
		of->rested = at_rest;
		of->generation = l->generation[i];
	}
}

static bool has_rested(const struct rb_located *l, int j)
{
	return j >= l->n || l->inspected[j].rests;
}

/* Finds the deepest overlap in the pairs that are listed for a body. */
static void inspect_body(struct rb_located *l, double t, int i)
{
	struct rb_inspected *const of = &l->inspected[i];
	const bool known = of->rests && (of->with < 0 || has_rested(l, of->with));
	const int near = rb_event_set_near_once(l, i);
	struct deepest found = {known ? of->depth : 0, known ? of->with : -1};

	for (int k = 0; k < near; k++) {
		const int j = l->near[k];

		if (!are_separate(l, i, j) && !(known && has_rested(l, j)))
			update_deepest(l, t, i, j, &found);
	}
	for (int j = l->n; j < l->n + l->model->static_count && !known; j++)
		if (!is_separate_static(l, i, j))
			update_deepest(l, t, i, j, &found);
	of->depth = found.depth_m;
	of->with = found.with;
}

double rb_inspect_overlap(struct rb_located *l, double t, int *a, int *b)
{
	double deepest = 0;
	int pair[2] = {-1, -1};

	RB_ASSERT(t >= l->now_s);
	update_rest(l);
	for (int i = 0; i < l->n; i++) {
		inspect_body(l, t, i);
		if (l->inspected[i].depth > deepest) {
			deepest = l->inspected[i].depth;
			const int with = l->inspected[i].with;

			pair[0] = i < with ? i : with;
			pair[1] = i < with ? with : i;
		}
	}
	*a = pair[0];
	*b = pair[1];
	return deepest;
}

enum rb_status rb_inspect_finite(const struct rb_located *l, double start_s)
{
	for (int i = 0; i < l->n; i++)
		if (!rb_verdict_finite(&l->world->state, i))
			return rb_verdict_fail_finite(l->model, i, start_s, l->err);
	return RB_OK;
}
