/* SPDX-License-Identifier: MIT */
#include "method/save.h"

#include "base/memory.h"
#include "located/freeze.h"
#include "step/broadphase.h"
#include "model/descriptor.h"
#include "world/joint_state.h"
#include "world/world.h"

#include <math.h>

/* Approximate bytes per body beside its state, for its boxes and its arc. */
enum { BOX_SIZE = 80, ARC_SIZE = 400 };

static void pack_state(struct rb_state *state, struct rb_pack *pack)
{
	rb_pack_u64(pack, &state->frame);
	rb_pack_finite(pack, &state->time_s, 1);
	rb_pack_finite(pack, state->block, state->size_bytes / sizeof(double));
}

/*
 * Checks that pairs are in order; they may repeat, since faces and edges touch at several points.
 */
static void pack_contacts(struct rb_world *world, struct rb_contacts *contacts,
                          struct rb_pack *pack)
{
	const struct rb_limits limits = rb_limits_of(world->model);
	size_t count = contacts->count;

	rb_pack_count(pack, &count, INT32_MAX, rb_fields_bytes(rb_contact_fields()));
	if (pack->loading && rb_contacts_reserve(contacts, count, NULL) != RB_OK)
		rb_pack_fail_memory(pack);
	if (pack->failed)
		return;
	contacts->count = count;
	rb_fields_pack(rb_contact_fields(), contacts->row, count, limits.high, pack);
	for (size_t k = 0; pack->loading && k < count && !pack->failed; k++) {
		const struct rb_contact *const c = &contacts->row[k];

		(void)rb_pack_check(pack,
		                    c->a < c->b && (k == 0 || c[-1].a < c->a ||
		                                    (c[-1].a == c->a && c[-1].b <= c->b)),
		                    "contacts that are not in order");
	}
}

/*
 * What callbacks read of the last step: its mean contact forces, and the forces that callbacks
 * applied in it.
 */
static void pack_loads(struct rb_world *world, struct rb_pack *pack)
{
	(void)rb_pack_check(pack, world->held || !world->has_held, "pushes of nobody");
	if (world->has_shown && !pack->failed)
		pack_contacts(world, &world->shown, pack);
	if (!world->held || pack->failed)
		return;
	if (world->has_held)
		rb_pack_finite(pack, world->held, 6 * (size_t)world->model->body_count);
	if (pack->loading) {
		world->pushed = true; /* the state may contain such forces */
		world->moment++;
	}
}

static void pack_events(struct rb_world *world, struct rb_pack *pack)
{
	const struct rb_limits limits = rb_limits_of(world->model);
	struct rb_events *const events = &world->events;
	size_t count = events->count;

	rb_pack_count(pack, &count, INT32_MAX, rb_fields_bytes(rb_event_fields()));
	if (pack->loading &&
	    !rb_memory_reserve(&events->row, &events->capacity, count, sizeof *events->row))
		rb_pack_fail_memory(pack);
	if (pack->failed)
		return;
	events->count = count;
	rb_fields_pack(rb_event_fields(), events->row, count, limits.high, pack);
}

/* Sizes of what follows, which reject the bytes of another scene. */
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
 * State of the methods, one after the other; pack_sizes tells which there are. A new method with
 * state for warm starts (impulses, sleeping) is added at the end, and its bytes to the guess below.
 */
static void pack_methods(struct rb_world *world, struct rb_pack *pack)
{
	/* each stepper once, in the order of the table */
	for (int k = 0; k < RB_METHOD_KIND_COUNT && !pack->failed; k++)
		if (!rb_methods[k]->locates)
			rb_methods[k]->steps->pack(world, pack);
	(void)rb_pack_check(pack, !world->located || world->dense_left == 0 || world->stepped,
	                    "steps of a world that was never stepped");
	if (world->located && !pack->failed)
		rb_freeze_pack(world->located, pack);
}

uint64_t rb_world_hash(const struct rb_world *world)
{
	const uint64_t state = rb_joint_states_hash(world, rb_state_hash(&world->state));

	return rb_contacts_hash(&world->contacts, state);
}

size_t rb_world_pack_guess(const struct rb_world *world)
{
	const size_t state = world->state.size_bytes * (world->state.push ? 2 : 1);
	const size_t each = rb_fields_bytes(rb_contact_fields()) + BOX_SIZE +
	                    (world->located ? ARC_SIZE : 0);

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
	if (!pack->failed)
		rb_joint_states_pack(world, pack);
	/* the state with which a callback's changes are compared */
	if (world->state.push && !pack->failed)
		pack_state(&world->start, pack);
	rb_fields_pack(rb_world_fields(), world, 1, NULL, pack);
	if (!pack->failed)
		pack_contacts(world, &world->contacts, pack);
	if (!pack->failed)
		pack_loads(world, pack);
	rb_fields_pack(rb_ledger_fields(), &world->ledger, 1, NULL, pack);
	rb_fields_pack(rb_entries_fields(), &world->open, 1, NULL, pack);
	rb_fields_pack(rb_counts_fields(), &world->frame_counts, 1, NULL, pack);
	rb_fields_pack(rb_counts_fields(), &world->total_counts, 1, NULL, pack);
	if (!pack->failed)
		pack_events(world, pack);
	pack_methods(world, pack);
	return rb_pack_status(pack, "the state of the world in the checkpoint", err);
}
