/* SPDX-License-Identifier: MIT */
#include "method/save.h"

#include "base/memory.h"
#include "located/freeze.h"
#include "step/broadphase.h"
#include "model/descriptor.h"
#include "world/world.h"

#include <math.h>

/*
 * Bytes that a contact and an event take; what a body takes beside its state, with its boxes, and
 * on its arc.
 */
enum { CONTACT_SIZE = 96, EVENT_SIZE = 100, BOX_SIZE = 80, ARC_SIZE = 400 };

static void pack_vector(struct rb_pack *pack, rb_vec3 *v)
{
	double numbers[3] = {v->x, v->y, v->z};

	rb_pack_finite(pack, numbers, 3);
	*v = rb_vec3_from(numbers);
}

static void pack_state(struct rb_state *state, struct rb_pack *pack)
{
	rb_pack_u64(pack, &state->frame);
	rb_pack_finite(pack, &state->time_s, 1);
	rb_pack_finite(pack, state->block, state->size_bytes / sizeof(double));
}

static void pack_contacts(struct rb_world *world, struct rb_contacts *contacts,
                          struct rb_pack *pack)
{
	const int last = world->model->body_count + world->model->static_count - 1;
	size_t count = contacts->count;

	rb_pack_count(pack, &count, INT32_MAX, CONTACT_SIZE);
	if (pack->loading && rb_contacts_reserve(contacts, count, NULL) != RB_OK) {
		pack->failed = pack->no_memory = true;
		return;
	}
	contacts->count = count;
	for (size_t k = 0; k < count && !pack->failed; k++) {
		struct rb_contact *const c = &contacts->row[k];

		rb_pack_int(pack, &c->a, 0, world->model->body_count - 1);
		rb_pack_int(pack, &c->b, 0, last);
		pack_vector(pack, &c->point);
		pack_vector(pack, &c->normal);
		rb_pack_finite(pack, &c->gap, 1);
		rb_pack_finite(pack, &c->normal_force, 1);
		pack_vector(pack, &c->tangent_force);
		/* faces and edges touch at several points */
		(void)rb_pack_check(pack,
		                    c->a < c->b && (k == 0 || c[-1].a < c->a ||
		                                    (c[-1].a == c->a && c[-1].b <= c->b)),
		                    "contacts that are not in order");
	}
}

/*
 * What callbacks are told of the step before: contacts over the whole of it, and what they pushed
 * with.
 */
static void pack_loads(struct rb_world *world, struct rb_pack *pack)
{
	bool shown = world->keeps_means && world->has_shown;

	rb_pack_bool(pack, &shown);
	world->has_shown = shown;
	if (shown && !pack->failed)
		pack_contacts(world, &world->shown, pack);
	if (!world->held || pack->failed)
		return;
	rb_pack_bool(pack, &world->has_held);
	if (world->has_held)
		rb_pack_finite(pack, world->held, 6 * (size_t)world->model->body_count);
	if (pack->loading) {
		world->pushed = true; /* the state may hold some */
		world->moment++;
	}
}

static void pack_events(struct rb_world *world, struct rb_pack *pack)
{
	struct rb_events *const events = &world->events;
	size_t count = events->count;

	rb_pack_count(pack, &count, INT32_MAX, EVENT_SIZE);
	if (pack->loading &&
	    !rb_memory_reserve(&events->row, &events->capacity, count, sizeof *events->row)) {
		pack->failed = pack->no_memory = true;
		return;
	}
	events->count = count;
	for (size_t k = 0; k < count && !pack->failed; k++) {
		struct rb_event *const event = &events->row[k];
		int kind = (int)event->kind;

		rb_pack_finite(pack, &event->time_s, 1);
		rb_pack_int(pack, &kind, 0, RB_EVENT_KIND_COUNT - 1);
		event->kind = (enum rb_event_kind)kind;
		rb_pack_int(pack, &event->a, 0, rb_world_id_count(world) - 1);
		rb_pack_int(pack, &event->b, 0, rb_world_id_count(world) - 1);
		pack_vector(pack, &event->point);
		pack_vector(pack, &event->normal);
		pack_vector(pack, &event->impulse);
		rb_pack_finite(pack, &event->approach_speed, 1);
	}
}

static void pack_counts(struct rb_counts *counts, struct rb_pack *pack)
{
	rb_pack_u64(pack, &counts->collisions);
	rb_pack_u64(pack, &counts->rollbacks);
	rb_pack_u64(pack, &counts->substeps);
	rb_pack_u64(pack, &counts->body_steps);
	rb_pack_u64(pack, &counts->discarded_body_steps);
	rb_pack_u64(pack, &counts->plastic_ends);
	rb_pack_u64(pack, &counts->crowded_impacts);
	rb_pack_finite(pack, &counts->crowded_energy_j, 1);
	rb_pack_u64(pack, &counts->rows);
	rb_pack_u64(pack, &counts->row_sweeps);
	rb_pack_u64(pack, &counts->factors);
	rb_pack_u64(pack, &counts->closings);
	rb_pack_finite(pack, &counts->residual_m, 1);
	rb_pack_finite(pack, &counts->slip_m, 1);
	rb_pack_times(pack, &counts->smallest_step_s, 1);
	rb_pack_finite(pack, &counts->stepped_s, 1);
	rb_pack_finite(pack, &counts->max_penetration_m, 1);
}

/* Sizes of what follows: bytes of another scene end here. */
static void pack_sizes(struct rb_world *world, struct rb_pack *pack)
{
	uint64_t found[4] = {(uint64_t)world->model->body_count,
	                     (uint64_t)world->model->static_count, world->state.size_bytes,
	                     world->located != NULL};
	const uint64_t wanted[4] = {found[0], found[1], found[2], found[3]};

	for (int i = 0; i < 4; i++) {
		rb_pack_u64(pack, &found[i]);
		(void)rb_pack_check(pack, found[i] == wanted[i], "it is of another scene");
	}
}

/*
 * What methods keep beside the state, one after the other; pack_sizes says which there are. Another
 * one that starts from what it has found before (impulses, rest) has its place at the end, and its
 * bytes in the guess below.
 */
static void pack_methods(struct rb_world *world, struct rb_pack *pack)
{
	/* of each stepper once, in the order of the table */
	for (int k = 0; k < RB_METHOD_KIND_COUNT && !pack->failed; k++)
		if (!rb_methods[k]->locates)
			rb_methods[k]->steps->pack(world, pack);
	(void)rb_pack_check(pack, !world->located || world->dense_left == 0 || world->stepped,
	                    "steps of a world that was never stepped");
	if (world->located && !pack->failed)
		rb_freeze_pack(world->located, pack);
}

size_t rb_world_pack_guess(const struct rb_world *world)
{
	const size_t state = world->state.size_bytes * (world->state.push ? 2 : 1);
	const size_t each = CONTACT_SIZE + BOX_SIZE + (world->located ? ARC_SIZE : 0);

	return state + (size_t)world->model->body_count * each;
}

enum rb_status rb_world_pack(struct rb_world *world, struct rb_pack *pack, struct rb_error *err)
{
	pack_sizes(world, pack);
	if (!pack->failed)
		pack_state(&world->state, pack);
	(void)rb_pack_check(pack, world->state.frame < world->model->frame_count,
	                    "a frame after the last one");
	if (pack->loading)
		world->begun = world->state.frame > 0;
	/* what changes that a callback makes are told from */
	if (world->state.push && !pack->failed)
		pack_state(&world->start, pack);
	if (!pack->failed)
		pack_contacts(world, &world->contacts, pack);
	if (!pack->failed)
		pack_loads(world, pack);
	rb_ledger_pack(&world->ledger, pack);
	rb_pack_finite(pack, world->open.row, RB_ENTRIES);
	rb_pack_u32(pack, &world->open.causes);
	pack_counts(&world->frame_counts, pack);
	pack_counts(&world->total_counts, pack);
	if (!pack->failed)
		pack_events(world, pack);
	rb_pack_i64(pack, &world->dense_steps);
	rb_pack_i64(pack, &world->dense_left);
	(void)rb_pack_check(pack, world->dense_steps >= 0 && world->dense_left >= 0,
	                    "a count below zero");
	rb_pack_bool(pack, &world->moved_by_hand);
	pack_methods(world, pack);
	return rb_pack_status(pack, "the state of the world in the checkpoint", err);
}
