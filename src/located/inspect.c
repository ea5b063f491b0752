/* SPDX-License-Identifier: MIT */
/*
 * Contacts and overlaps at a time, for frames, reports and checkpoints; the simulation's state does
 * not change.
 */
#include "located/inspect.h"

#include "base/error.h"
#include "located/integrate.h"
#include "located/convex_contact.h"

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

/*
 * Updates the deepest overlap with the pair i, j. Separated spheres, and spheres above planes, are
 * dismissed first.
 */
static void update_deepest(const struct rb_located *l, double t, int i, int j, double *deepest,
                           int pair[2])
{
	const struct rb_model *model = l->model;

	if (model->shape[i].kind == RB_SHAPE_SPHERE && model->shape[j].kind == RB_SHAPE_SPHERE) {
		const rb_vec3 d = rb_vec3_sub(rb_arc_origin(l, j, t), rb_arc_origin(l, i, t));
		const double sum = model->shape[i].radius + model->shape[j].radius;

		if (rb_vec3_dot(d, d) > sum * sum)
			return;
	}
	if (model->shape[i].kind == RB_SHAPE_SPHERE && model->shape[j].kind == RB_SHAPE_PLANE &&
	    j >= l->n) {
		const rb_vec3 d = rb_vec3_sub(rb_arc_origin(l, i, t), model->position[j]);

		if (rb_vec3_dot(d, l->plane_normal[j - l->n]) > model->shape[i].radius)
			return;
	}
	if (!rb_pair_can_touch(l, i, j))
		return;
	if (rb_pair_has_features(l, i, j) && rb_pair_is_far(l, i, j, t, t))
		return;
	const double gap = gap_at(l, i, j, t);
	if (-gap > *deepest) {
		*deepest = -gap;
		pair[0] = i;
		pair[1] = j;
	}
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

/* Finds the deepest overlap of a body with those of higher index. */
static void inspect_body(struct rb_located *l, double t, int i)
{
	struct rb_inspected *const of = &l->inspected[i];
	const bool known = of->rests && (of->with < 0 || has_rested(l, of->with));
	const int near = rb_event_set_near(l, i);
	double deepest = known ? of->depth : 0;
	int pair[2] = {i, known ? of->with : -1};

	for (int k = 0; k < near; k++)
		if (l->near[k] > i && !(known && has_rested(l, l->near[k])))
			update_deepest(l, t, i, l->near[k], &deepest, pair);
	for (int j = l->n; j < l->n + l->model->static_count && !known; j++)
		update_deepest(l, t, i, j, &deepest, pair);
	of->depth = deepest;
	of->with = pair[1];
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
			pair[0] = i;
			pair[1] = l->inspected[i].with;
		}
	}
	*a = pair[0];
	*b = pair[1];
	return deepest;
}
