/* SPDX-License-Identifier: MIT */
#include "located/freeze.h"

#include "located/account.h"
#include "base/error.h"
#include "base/memory.h"
#include "located/driven.h"
#include "located/integrate.h"

#include <math.h>

/* Bytes that a contact, and a cluster that is not used, take at least. */
enum { HELD_LEAST = 105, CLUSTER_LEAST = 13 };

static void out_of_memory(struct rb_pack *pack)
{
	pack->failed = pack->no_memory = true;
}

static void pack_vector(struct rb_pack *pack, rb_vec3 *v)
{
	double numbers[3] = {v->x, v->y, v->z};

	rb_pack_finite(pack, numbers, 3);
	*v = rb_vec3_from(numbers);
}

/* ---- bodies ---- */

static void pack_arc(struct rb_located *l, int i, struct rb_pack *pack)
{
	struct rb_arc *const arc = &l->arc[i];
	bool plain = arc->plain_radius > 0;

	rb_pack_finite(pack, &arc->anchor_s, 1);
	pack_vector(pack, &arc->position);
	pack_vector(pack, &arc->velocity);
	pack_vector(pack, &arc->acceleration);
	rb_pack_bool(pack, &plain);
	if (pack->loading)
		arc->plain_radius = plain ? l->model->shape[i].radius : (double)NAN;
}

/* The rest of it follows from these; what the cache holds is the same whenever it is asked for. */
static void pack_top(struct rb_located *l, int i, struct rb_pack *pack)
{
	struct rb_top *const top = &l->top[i];
	double q[4];

	rb_quat_to(q, top->orientation);
	rb_pack_finite(pack, q, 4);
	pack_vector(pack, &top->spin);
	pack_vector(pack, &top->acceleration);
	if (pack->loading && !pack->failed && l->started)
		*top = rb_top_start(&l->top_body[i], rb_quat_from(q), top->spin, top->acceleration);
}

static void pack_next(struct rb_located *l, int i, struct rb_pack *pack)
{
	struct rb_next *const next = &l->next[i];
	const int walls = l->cells ? rb_cells_wall_count(l->cells, i) : 0;

	rb_pack_times(pack, &next->touch_s, 1);
	rb_pack_int(pack, &next->partner, -1, l->n + l->model->static_count - 1);
	rb_pack_u32(pack, &next->generation);
	rb_pack_bool(pack, &next->again);
	rb_pack_int(pack, &next->wall, -1, walls > 0 ? walls - 1 : 0);
	rb_pack_times(pack, &next->wall_s, 1);
	if (l->cells && l->started)
		(void)rb_pack_check(pack, isinf(next->wall_s) || next->wall >= 0,
		                    "a wall without number");
	(void)rb_pack_check(pack,
	                    isinf(next->touch_s) || (next->partner >= 0 && next->partner != i),
	                    "a body that meets itself");
}

/* Their cluster's piece, or their own where they are driven, must have been loaded. */
static void pack_piece(struct rb_located *l, int i, struct rb_pack *pack)
{
	struct rb_piece_of *const own = &l->piece[i];
	bool on = own->piece.n > 0;

	rb_pack_bool(pack, &on);
	if (!on) {
		if (pack->loading)
			own->piece.n = 0;
		pack_vector(pack, &own->rest);
		return;
	}
	if (!rb_located_driven(l, i) && pack->loading) {
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
	(void)rb_pack_check(pack, own->piece.n > 0, "a driven body without a piece");
	pack_vector(pack, &own->base);
	rb_pack_finite(pack, &own->origin_s, 1);
	rb_pack_times(pack, &own->until_s, 1);
	rb_pack_finite(pack, &own->acceleration_max, 1);
}

static void pack_bodies(struct rb_located *l, struct rb_pack *pack)
{
	for (int i = 0; i < l->n && !pack->failed; i++) {
		pack_arc(l, i, pack);
		rb_pack_u32(pack, &l->generation[i]);
		pack_next(l, i, pack);
	}
	for (int i = 0; l->top && i < l->n && !pack->failed; i++)
		pack_top(l, i, pack);
}

/* After the clusters. */
static void pack_pieces(struct rb_located *l, struct rb_pack *pack)
{
	bool any = l->piece != NULL;

	rb_pack_bool(pack, &any);
	if (!any)
		return;
	if (!l->piece)
		l->piece = rb_memory_take((size_t)l->n, sizeof *l->piece);
	if (!l->piece) {
		out_of_memory(pack);
		return;
	}
	for (int i = 0; i < l->n && !pack->failed; i++) {
		if (rb_located_driven(l, i))
			rb_driven_pack(l, i, pack);
		pack_piece(l, i, pack);
	}
}

/* ---- clusters ---- */

static void pack_held(struct rb_located *l, struct rb_held *held, struct rb_pack *pack)
{
	int reported = (int)held->reported;

	rb_pack_int(pack, &held->a, 0, l->n - 1);
	rb_pack_int(pack, &held->b, 0, l->n + l->model->static_count - 1);
	(void)rb_pack_check(pack, held->a < held->b, "a contact of a body with itself");
	rb_pack_u32(pack, &held->parts);
	rb_pack_u64(pack, &held->key);
	pack_vector(pack, &held->half);
	rb_pack_bool(pack, &held->slipping);
	rb_pack_bool(pack, &held->on_rim);
	rb_pack_bool(pack, &held->ending);
	rb_pack_bool(pack, &held->straight);
	rb_pack_bool(pack, &held->creeps);
	pack_vector(pack, &held->slip);
	pack_vector(pack, &held->common);
	rb_pack_finite(pack, &held->friction, 1);
	pack_vector(pack, &held->force);
	rb_pack_int(pack, &reported, RB_HELD_REST, RB_HELD_ROLL);
	held->reported = (enum rb_held_mode)reported;
	rb_pack_bool(pack, &held->is_reported);
	rb_pack_times(pack, &held->recorded_s, 1);
	rb_pack_bool(pack, &held->merged);
}

/* Its start and coefficients, which stand first in its block. */
static void pack_cluster_piece(struct rb_located *l, struct rb_cluster *c, struct rb_pack *pack)
{
	const int n = c->member_count * rb_located_row(l);
	const size_t size = (size_t)n * (1 + RB_GAUSS_NODES);

	rb_pack_finite(pack, &c->least, 1);
	rb_pack_finite(pack, &c->piece.length_s, 1);
	(void)rb_pack_check(pack, c->piece.length_s > 0, "a piece without length");
	if (pack->loading) {
		if (!rb_memory_reserve(&c->block, &c->block_capacity, rb_integrate_scratch_size(n),
		                       sizeof *c->block)) {
			out_of_memory(pack);
			return;
		}
		c->piece.n = n;
		c->piece.start = c->block;
		c->piece.coefficient = c->block + n;
	}
	rb_pack_finite(pack, c->block, size);
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

static void pack_cluster(struct rb_located *l, int cluster, struct rb_pack *pack)
{
	struct rb_cluster *const c = &l->cluster[cluster];
	size_t members = (size_t)c->member_count, held = (size_t)c->held_count;

	rb_pack_bool(pack, &c->used);
	rb_pack_int(pack, &c->next_free, 0, l->cluster_count);
	rb_pack_times(pack, &c->try_s, 1);
	if (!c->used)
		return;
	rb_pack_bool(pack, &c->integrated);
	rb_pack_bool(pack, &c->at_rest);
	rb_pack_bool(pack, &c->is_cut);
	rb_pack_bool(pack, &c->has_jammed);
	rb_pack_bool(pack, &c->hits);
	if (c->hits) {
		rb_pack_int(pack, &c->hit_a, 0, l->n - 1);
		rb_pack_int(pack, &c->hit_b, 0, l->n + l->model->static_count - 1);
	}
	rb_pack_finite(pack, &c->anchor_s, 1);
	rb_pack_count(pack, &members, (size_t)l->n, sizeof(int32_t));
	rb_pack_count(pack, &held, INT32_MAX, HELD_LEAST);
	if (!rb_pack_check(pack, members > 0, "a cluster of nobody"))
		return;
	if (pack->loading) {
		if (!rb_memory_reserve(&c->member, &c->member_capacity, members,
		                       sizeof *c->member) ||
		    !rb_memory_reserve(&c->held, &c->held_capacity, held, sizeof *c->held)) {
			out_of_memory(pack);
			return;
		}
		c->member_count = (int)members;
		c->held_count = (int)held;
	}
	pack_members(l, cluster, pack);
	for (size_t k = 0; k < held && !pack->failed; k++)
		pack_held(l, &c->held[k], pack);
	if (c->integrated && !pack->failed)
		pack_cluster_piece(l, c, pack);
}

/* The list of unused ones ends, and holds nobody else. */
static void check_free(struct rb_located *l, struct rb_pack *pack)
{
	int left = l->cluster_count, k = l->cluster_free;

	for (; k > 0 && left > 0; left--) {
		if (!rb_pack_check(pack, !l->cluster[k - 1].used, "a used cluster among the free"))
			return;
		k = l->cluster[k - 1].next_free;
	}
	(void)rb_pack_check(pack, k == 0, "free clusters without end");
}

static void pack_clusters(struct rb_located *l, struct rb_pack *pack)
{
	size_t count = (size_t)l->cluster_count;

	/* never more than bodies */
	rb_pack_count(pack, &count, (size_t)l->n, CLUSTER_LEAST);
	if (pack->loading) {
		if (!rb_memory_reserve(&l->cluster, &l->cluster_capacity, count,
		                       sizeof *l->cluster)) {
			out_of_memory(pack);
			return;
		}
		for (size_t k = 0; k < count; k++)
			l->cluster[k] = (struct rb_cluster){0};
		l->cluster_count = (int)count;
	}
	for (size_t k = 0; k < count && !pack->failed; k++)
		pack_cluster(l, (int)k, pack);
	rb_pack_int(pack, &l->cluster_free, 0, l->cluster_count);
	if (pack->loading && !pack->failed)
		check_free(l, pack);
}

/* ---- what comes next ---- */

static void pack_queue(struct rb_located *l, struct rb_pack *pack)
{
	for (int i = 0; i <= 2 * l->n && !pack->failed; i++) {
		double time_s = rb_queue_time(l->queue, i);

		rb_pack_times(pack, &time_s, 1);
		if (pack->loading && !pack->failed)
			rb_queue_set(l->queue, i, time_s);
	}
	/* events of clusters that are not there */
	for (int k = 0; pack->loading && k < l->n && !pack->failed; k++)
		(void)rb_pack_check(pack,
		                    isinf(rb_queue_time(l->queue, l->n + k)) ||
		                            (k < l->cluster_count && l->cluster[k].used),
		                    "an event of nobody");
}

static void pack_merges(struct rb_located *l, struct rb_pack *pack)
{
	size_t count = (size_t)l->merge_count;

	rb_pack_count(pack, &count, INT32_MAX, 16);
	if (pack->loading &&
	    !rb_memory_reserve(&l->merge, &l->merge_capacity, count, sizeof *l->merge)) {
		out_of_memory(pack);
		return;
	}
	l->merge_count = (int)count;
	for (size_t k = 0; k < count && !pack->failed; k++) {
		const int last = l->n + l->model->static_count - 1;

		rb_pack_int(pack, &l->merge[k].a, 0, last);
		rb_pack_int(pack, &l->merge[k].b, 0, last);
		rb_pack_times(pack, &l->merge[k].recorded_s, 1);
	}
}

void rb_freeze_pack(struct rb_located *l, struct rb_pack *pack)
{
	RB_ASSERT(l->set_count == 0);
	rb_pack_bool(pack, &l->started);
	rb_pack_finite(pack, &l->now_s, 1);
	rb_pack_times(pack, &l->stuck_s, 1);
	rb_pack_u64(pack, &l->stuck_count);
	rb_pack_u64(pack, &l->events);
	rb_pack_u64(pack, &l->crowd);
	rb_pack_int(pack, &l->switch_next, 0, l->switch_count);
	pack_bodies(l, pack);
	pack_clusters(l, pack);
	pack_pieces(l, pack);
	if (!pack->failed)
		rb_account_pack(l, pack);
	pack_merges(l, pack);
	if (l->cells && !pack->failed)
		rb_cells_pack(l->cells, pack);
	if (!pack->failed)
		pack_queue(l, pack);
}
