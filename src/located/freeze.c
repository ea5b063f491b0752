/* SPDX-License-Identifier: MIT */
#include "located/freeze.h"

#include "located/account.h"
#include "base/error.h"
#include "base/memory.h"
#include "located/crowd.h"
#include "located/follow.h"
#include "located/integrate.h"
#include "located/piece_warm_start.h"
#include "model/joints.h"

#include <math.h>

RB_FIELDS_DEFINE(rb_arc_fields, struct rb_arc, RB_ARC_FIELDS);
RB_FIELDS_DEFINE(rb_piece_fields, struct rb_piece_of, RB_PIECE_FIELDS);
RB_FIELDS_DEFINE(rb_next_fields, struct rb_next, RB_NEXT_FIELDS);
RB_FIELDS_DEFINE(rb_held_fields, struct rb_held, RB_HELD_FIELDS);
RB_FIELDS_DEFINE(rb_account_rates_fields, struct rb_account_rates, RB_ACCOUNT_RATES_FIELDS);
RB_FIELDS_DEFINE(rb_cluster_fields, struct rb_cluster, RB_CLUSTER_FIELDS);
RB_FIELDS_DEFINE(rb_bounces_fields, struct rb_bounces, RB_BOUNCES_FIELDS);
RB_FIELDS_DEFINE(rb_crowd_fields, struct rb_crowd_of, RB_CROWD_FIELDS);
RB_FIELDS_DEFINE(rb_merge_fields, struct rb_merge, RB_MERGE_FIELDS);
RB_FIELDS_DEFINE_PART(rb_located_fields, struct rb_located, RB_LOCATED_FIELDS);

static struct rb_limits limits_of(const struct rb_located *l)
{
	struct rb_limits limits = rb_limits_of(l->model);

	/* there are never more clusters than bodies */
	limits.high[RB_LIMIT_NEXT_FREE] = l->n;
	limits.high[RB_LIMIT_SWITCH] = l->switch_count;
	return limits;
}

/* ---- bodies ---- */

static bool fits(const struct rb_located *l, int i)
{
	const struct rb_next *const next = &l->next[i];
	const double radius = l->arc[i].plain_radius;
	const int walls = l->cells ? rb_cells_wall_count(l->cells, i) : 0;

	/* zero before the start; after steps have taken over, of the last arc */
	if (!isnan(radius) && !(radius == l->model->shape[i].radius) &&
	    !(radius == 0 && !l->started))
		return false;
	if (!(l->arc[i].decay >= 0) || (l->arc[i].decay > 0 && !l->decays))
		return false;
	if (isfinite(next->touch_s) && (next->partner < 0 || next->partner == i))
		return false;
	/* for a driven body it may be the end of its piece */
	if (l->cells && l->started && isfinite(next->wall_s) && next->wall < 0 &&
	    !rb_located_driven(l, i))
		return false;
	return next->wall < (walls > 0 ? walls : 1);
}

/* Other fields of a top follow from those that are packed. */
static void pack_bodies(struct rb_located *l, struct rb_pack *pack)
{
	const struct rb_limits limits = limits_of(l);
	const size_t n = (size_t)l->n;

	rb_fields_pack(rb_arc_fields(), l->arc, n, NULL, pack);
	rb_pack_bytes(pack, l->generation, n * sizeof *l->generation);
	rb_fields_pack(rb_next_fields(), l->next, n, limits.high, pack);
	rb_fields_pack(rb_bounces_fields(), l->bounces, n, limits.high, pack);
	if (!pack->loading)
		rb_crowd_compress(l);
	rb_fields_pack(rb_crowd_fields(), l->crowd_of, n, limits.high, pack);
	if (pack->loading && !pack->failed)
		(void)rb_pack_check(pack, rb_crowd_complete(l), "crowds without end");
	if (l->top)
		rb_fields_pack(rb_top_fields(), l->top, n, NULL, pack);
	for (int i = 0; pack->loading && i < l->n && !pack->failed; i++) {
		struct rb_top *const top = l->top && l->started ? &l->top[i] : NULL;

		(void)rb_pack_check(pack, fits(l, i), "a body that meets itself, or no wall");
		if (top)
			*top = rb_top_start(&l->top_body[i], top->orientation, top->spin,
			                    top->acceleration);
	}
}

/* The cluster's piece, or a driven body's own, must have been loaded. */
static void pack_piece(struct rb_located *l, int i, struct rb_pack *pack)
{
	struct rb_piece_of *const own = &l->piece[i];
	bool on = own->piece.n > 0;

	rb_pack_bool(pack, &on);
	rb_fields_pack(rb_piece_fields(), own, 1, NULL, pack);
	if (!pack->loading || pack->failed)
		return;
	if (on && !rb_located_driven(l, i)) {
		const int cluster = l->cluster_of[i];

		if (!rb_pack_check(pack, cluster >= 0 && l->cluster[cluster].integrated,
		                   "a body on a piece of nobody"))
			return;
		const struct rb_cluster *c = &l->cluster[cluster];

		own->piece = c->piece;
		own->first = 0;
		while (c->member[own->first] != i)
			own->first++;
		own->first *= rb_located_row(l);
	}
	if (!on)
		own->piece.n = 0;
	(void)rb_pack_check(pack, !on || own->piece.n > 0, "a driven body without a piece");
}

/* Call after pack_clusters. */
static void pack_pieces(struct rb_located *l, struct rb_pack *pack)
{
	bool any = l->piece != NULL;

	rb_pack_bool(pack, &any);
	if (!any)
		return;
	if (!rb_piece_warm_start_reserve(l)) {
		rb_pack_fail_memory(pack);
		return;
	}
	for (int i = 0; i < l->n && !pack->failed; i++) {
		if (rb_located_driven(l, i))
			rb_driven_pack(l, i, pack);
		pack_piece(l, i, pack);
	}
}

/* ---- clusters ---- */

/* The first part of its block. */
static void pack_cluster_piece(struct rb_located *l, struct rb_cluster *c, struct rb_pack *pack)
{
	const int n = c->member_count * rb_located_row(l);

	rb_pack_finite(pack, &c->piece.length_s, 1);
	(void)rb_pack_check(pack, c->piece.length_s > 0, "a piece without length");
	if (pack->loading && !rb_memory_reserve(&c->block, &c->block_capacity,
	                                        rb_integrate_scratch_size(n), sizeof *c->block))
		rb_pack_fail_memory(pack);
	if (pack->failed)
		return;
	rb_integrate_lay_out(c, n);
	rb_pack_finite(pack, c->block, rb_integrate_kept_size(n));
}

static void pack_members(struct rb_located *l, int cluster, struct rb_pack *pack)
{
	struct rb_cluster *const c = &l->cluster[cluster];

	for (int k = 0; k < c->member_count && !pack->failed; k++) {
		rb_pack_int(pack, &c->member[k], 0, l->n - 1);
		if (!pack->loading || pack->failed)
			continue;
		if (rb_pack_check(pack, l->cluster_of[c->member[k]] < 0, "a body in two clusters"))
			l->cluster_of[c->member[k]] = cluster;
	}
}

static void pack_held(struct rb_located *l, struct rb_cluster *c, struct rb_pack *pack)
{
	const struct rb_limits limits = limits_of(l);

	rb_fields_pack(rb_held_fields(), c->held, (size_t)c->held_count, limits.high, pack);
	for (int k = 0; pack->loading && k < c->held_count; k++)
		(void)rb_pack_check(pack, c->held[k].a < c->held[k].b,
		                    "a contact of a body with itself");
}

/* Arrays of a cluster that is used. */
static void pack_cluster(struct rb_located *l, int cluster, struct rb_pack *pack)
{
	struct rb_cluster *const c = &l->cluster[cluster];
	size_t members = (size_t)c->member_count, held = (size_t)c->held_count;

	rb_pack_count(pack, &members, (size_t)l->n, sizeof(int32_t));
	rb_pack_count(pack, &held, INT32_MAX, rb_fields_bytes(rb_held_fields()));
	(void)rb_pack_check(pack, members > 0, "a cluster of nobody");
	if (pack->loading &&
	    (!rb_memory_reserve(&c->member, &c->member_capacity, members, sizeof *c->member) ||
	     !rb_memory_reserve(&c->held, &c->held_capacity, held, sizeof *c->held)))
		rb_pack_fail_memory(pack);
	if (pack->failed)
		return;
	c->member_count = (int)members;
	c->held_count = (int)held;
	pack_members(l, cluster, pack);
	pack_held(l, c, pack);
	if (c->integrated && !pack->failed)
		pack_cluster_piece(l, c, pack);
}

/* Checks that the list of free clusters ends and contains only unused ones. */
static void check_free(struct rb_located *l, struct rb_pack *pack)
{
	int left = l->cluster_count, k = l->cluster_free;

	for (; k > 0 && left > 0; left--) {
		if (!rb_pack_check(pack, k <= l->cluster_count && !l->cluster[k - 1].used,
		                   "a used cluster among the free"))
			return;
		k = l->cluster[k - 1].next_free;
	}
	(void)rb_pack_check(pack, k == 0, "free clusters without end");
}

static void pack_clusters(struct rb_located *l, struct rb_pack *pack)
{
	const struct rb_limits limits = limits_of(l);
	size_t count = (size_t)l->cluster_count;

	rb_pack_count(pack, &count, (size_t)l->n, rb_fields_bytes(rb_cluster_fields()));
	if (pack->loading) {
		if (!rb_memory_reserve(&l->cluster, &l->cluster_capacity, count,
		                       sizeof *l->cluster)) {
			rb_pack_fail_memory(pack);
			return;
		}
		for (size_t k = 0; k < count; k++)
			l->cluster[k] = (struct rb_cluster){0};
		l->cluster_count = (int)count;
	}
	rb_fields_pack(rb_cluster_fields(), l->cluster, count, limits.high, pack);
	for (size_t k = 0; k < count && !pack->failed; k++)
		if (l->cluster[k].used)
			pack_cluster(l, (int)k, pack);
	if (pack->loading && !pack->failed)
		check_free(l, pack);
}

/* ---- events ---- */

static void pack_queue(struct rb_located *l, struct rb_pack *pack)
{
	for (int i = 0; i <= 2 * l->n && !pack->failed; i++) {
		double time_s = rb_queue_time(l->queue, i);

		rb_pack_times(pack, &time_s, 1);
		if (pack->loading && !pack->failed)
			rb_queue_set(l->queue, i, time_s);
	}
	/* events of clusters that do not exist */
	for (int k = 0; pack->loading && k < l->n && !pack->failed; k++)
		(void)rb_pack_check(pack,
		                    isinf(rb_queue_time(l->queue, l->n + k)) ||
		                            (k < l->cluster_count && l->cluster[k].used),
		                    "an event of nobody");
}

static void pack_merges(struct rb_located *l, struct rb_pack *pack)
{
	const struct rb_limits limits = limits_of(l);
	size_t count = (size_t)l->merge_count;

	rb_pack_count(pack, &count, INT32_MAX, rb_fields_bytes(rb_merge_fields()));
	if (pack->loading &&
	    !rb_memory_reserve(&l->merge, &l->merge_capacity, count, sizeof *l->merge))
		rb_pack_fail_memory(pack);
	if (pack->failed)
		return;
	l->merge_count = (int)count;
	rb_fields_pack(rb_merge_fields(), l->merge, count, limits.high, pack);
}

/*
 * Packed by hand: arrays, state shared by several objects (pieces), and derived state: the order of
 * the queue, members of cells.
 */
void rb_freeze_pack(struct rb_located *l, struct rb_pack *pack)
{
	const struct rb_limits limits = limits_of(l);

	RB_ASSERT(l->set_count == 0);
	rb_fields_pack(rb_located_fields(), l, 1, limits.high, pack);
	pack_bodies(l, pack);
	for (int k = 0;
	     l->model->joints && !pack->failed && k < RB_JOINT_PARTS_HELD * l->model->joints->count;
	     k++) {
		int mode = l->drive_mode[k], next = l->drive_next[k];

		rb_pack_int(pack, &mode, RB_DRIVE_LOW, RB_DRIVE_REACHED);
		rb_pack_int(pack, &next, RB_DRIVE_LOW, RB_DRIVE_KEEPS);
		l->drive_mode[k] = (signed char)mode;
		l->drive_next[k] = (signed char)next;
		rb_pack_bool(pack, &l->eased[k]);
	}
	if (!pack->failed)
		rb_follow_pack(l, pack);
	if (!pack->failed)
		pack_clusters(l, pack);
	if (!pack->failed)
		pack_pieces(l, pack);
	if (!pack->failed)
		rb_account_pack(l, pack);
	pack_merges(l, pack);
	if (l->cells && !pack->failed)
		rb_cells_pack(l->cells, pack);
	if (!pack->failed)
		pack_queue(l, pack);
}
