/* SPDX-License-Identifier: MIT */
#include "located/located_invariants.h"

#include "base/error.h"

static const double unit_error = 1e-9; /* world/invariants */

static enum rb_status validate_arcs(const struct rb_located *l, struct rb_error *err)
{
	for (int i = 0; i < l->n; i++) {
		const struct rb_arc *const arc = &l->arc[i];

		if (!(arc->anchor_s <= l->now_s) || !rb_vec3_finite(arc->position) ||
		    !rb_vec3_finite(arc->velocity) || !rb_vec3_finite(arc->acceleration) ||
		    !(arc->decay >= 0) || (arc->decay > 0 && !l->decays))
			return RB_FAIL(err, RB_ERR_BUG, "the arc of body %d begins at %.17g s", i,
			               arc->anchor_s);
		if (l->place[i] != -1)
			return RB_FAIL(err, RB_ERR_BUG, "body %d is left in the set", i);
		if (rb_located_on_piece(l, i) && !rb_located_driven(l, i) &&
		    (l->cluster_of[i] < 0 || !l->cluster[l->cluster_of[i]].integrated))
			return RB_FAIL(err, RB_ERR_BUG, "body %d is on a piece of nobody", i);
		const struct rb_next *const next = &l->next[i];
		if (isfinite(next->touch_s) && (next->partner < 0 || next->partner == i ||
		                                next->partner >= l->n + l->model->static_count))
			return RB_FAIL(err, RB_ERR_BUG, "body %d touches body %d next", i,
			               next->partner);
	}
	return RB_OK;
}

static enum rb_status validate_held(const struct rb_located *l, int cluster,
                                    const struct rb_held *held, struct rb_error *err)
{
	const int last = l->n + l->model->static_count - 1;

	if (held->a < 0 || held->a >= l->n || held->b <= held->a || held->b > last)
		return RB_FAIL(err, RB_ERR_BUG, "cluster %d holds a contact of bodies %d and %d",
		               cluster, held->a, held->b);
	if ((!rb_located_fixed(l, held->a) && l->cluster_of[held->a] != cluster) ||
	    (!rb_located_fixed(l, held->b) && l->cluster_of[held->b] != cluster))
		return RB_FAIL(err, RB_ERR_BUG,
		               "cluster %d holds a contact of bodies %d and %d, which are not its",
		               cluster, held->a, held->b);
	if (!rb_vec3_finite(held->force) || !(held->friction >= 0))
		return RB_FAIL(err, RB_ERR_BUG, "the contact of bodies %d and %d has no force",
		               held->a, held->b);
	const double slip = rb_vec3_length(held->slip);
	/* without friction its direction is not used */
	if (held->slipping && !(fabs(slip - 1) <= unit_error) &&
	    !(slip == 0 && held->friction == 0))
		return RB_FAIL(err, RB_ERR_BUG, "the slip of bodies %d and %d has the length %.17g",
		               held->a, held->b, slip);
	return RB_OK;
}

static bool is_after(const struct rb_held *x, const struct rb_held *y)
{
	if (x->a != y->a)
		return x->a > y->a;
	if (x->b != y->b)
		return x->b > y->b;
	return x->parts != y->parts ? x->parts > y->parts : x->key >= y->key;
}

static enum rb_status validate_cluster(const struct rb_located *l, int cluster,
                                       struct rb_error *err)
{
	const struct rb_cluster *const c = &l->cluster[cluster];
	enum rb_status status = RB_OK;

	if (c->member_count <= 0 || !(c->anchor_s <= l->now_s))
		return RB_FAIL(err, RB_ERR_BUG, "cluster %d of %d bodies begins at %.17g s",
		               cluster, c->member_count, c->anchor_s);
	for (int k = 0; k < c->member_count; k++) {
		if (c->member[k] < 0 || c->member[k] >= l->n)
			return RB_FAIL(err, RB_ERR_BUG, "cluster %d has a body %d", cluster,
			               c->member[k]);
		if (l->cluster_of[c->member[k]] != cluster)
			return RB_FAIL(err, RB_ERR_BUG, "body %d is in clusters %d and %d",
			               c->member[k], cluster, l->cluster_of[c->member[k]]);
	}
	for (int k = 0; k < c->held_count && status == RB_OK; k++) {
		status = validate_held(l, cluster, &c->held[k], err);
		if (status == RB_OK && k > 0 && !is_after(&c->held[k], &c->held[k - 1]))
			status = RB_FAIL(err, RB_ERR_BUG, "contacts of cluster %d are not sorted",
			                 cluster);
	}
	if (status == RB_OK && c->integrated && !(c->piece.n > 0 && c->piece.length_s > 0))
		status = RB_FAIL(err, RB_ERR_BUG, "cluster %d has a piece of %g s", cluster,
		                 c->piece.length_s);
	return status;
}

static enum rb_status validate_clusters(const struct rb_located *l, struct rb_error *err)
{
	enum rb_status status = RB_OK;
	int members = 0, in_clusters = 0, unused = 0;

	for (int k = 0; k < l->cluster_count && status == RB_OK; k++) {
		unused += !l->cluster[k].used;
		if (!l->cluster[k].used)
			continue;
		members += l->cluster[k].member_count;
		status = validate_cluster(l, k, err);
	}
	if (status != RB_OK)
		return status;
	for (int i = 0; i < l->n; i++)
		in_clusters += l->cluster_of[i] >= 0;
	if (members != in_clusters)
		return RB_FAIL(err, RB_ERR_BUG, "%d bodies are in clusters, which have %d",
		               in_clusters, members);
	for (int k = l->cluster_free; k > 0 && unused >= 0; k = l->cluster[k - 1].next_free) {
		if (k > l->cluster_count || l->cluster[k - 1].used)
			return RB_FAIL(err, RB_ERR_BUG, "cluster %d is used, and free", k - 1);
		unused--;
	}
	return unused == 0 ? RB_OK : RB_FAIL(err, RB_ERR_BUG, "free clusters are not all listed");
}

static enum rb_status validate_queue(const struct rb_located *l, struct rb_error *err)
{
	for (int k = 0; k <= 2 * l->n; k++) {
		const double time_s = rb_queue_time(l->queue, k);

		if (!(time_s >= l->now_s))
			return RB_FAIL(err, RB_ERR_BUG, "event %d is at %.17g s, past at %.17g s",
			               k, time_s, l->now_s);
		const int cluster = k - l->n;
		if (isfinite(time_s) && cluster >= 0 && cluster < l->n &&
		    (cluster >= l->cluster_count || !l->cluster[cluster].used))
			return RB_FAIL(err, RB_ERR_BUG, "cluster %d has an event and no bodies",
			               cluster);
	}
	return RB_OK;
}

enum rb_status rb_validate_located(const struct rb_located *l, struct rb_error *err)
{
	enum rb_status status = RB_OK;

	if (!l->started)
		return RB_OK;
	if (l->set_count != 0)
		return RB_FAIL(err, RB_ERR_BUG, "%d bodies are left in the set", l->set_count);
	status = validate_arcs(l, err);
	if (status == RB_OK)
		status = validate_clusters(l, err);
	if (status == RB_OK)
		status = validate_queue(l, err);
	return status;
}
