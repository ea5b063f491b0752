/* SPDX-License-Identifier: MIT */
/*
 * Checks of the stepped method's state between steps: sleeping groups, candidate pairs and the
 * lists of bodies. A failure is a bug of this program (RB_ERR_BUG), never of the input.
 */
#include "stepped/stepped_invariants.h"

#include "base/error.h"

/*
 * Sleeping groups are rings through `next`: every successor of a sleeping body sleeps, and the
 * counts of bodies and of contact points agree with the marks.
 */
static enum rb_status validate_sleep(const struct rb_stepped *s, int bodies, struct rb_error *err)
{
	const struct rb_sleep *const sleep = &s->sleep;
	size_t points = 0;
	int count = 0;

	for (int i = 0; i < bodies; i++) {
		if (sleep->mark[i])
			return RB_FAIL(err, RB_ERR_BUG, "a mark is left on body %d", i);
		if (!sleep->sleeps[i])
			continue;
		const int next = sleep->next[i];
		if (next < 0 || next >= bodies || !sleep->sleeps[next])
			return RB_FAIL(err, RB_ERR_BUG,
			               "body %d sleeps, body %d of its group does not", i, next);
		points += (size_t)sleep->points[i];
		count++;
	}
	if (count != sleep->count || points != sleep->point_count)
		return RB_FAIL(err, RB_ERR_BUG,
		               "%d bodies sleep on %zu points, counted are %d on %zu", count,
		               points, sleep->count, sleep->point_count);
	return RB_OK;
}

/* Indices in range, the first body of each pair dynamic, live pairs strictly ascending. */
static enum rb_status validate_candidates(const struct rb_world *world,
                                          const struct rb_candidates *candidates,
                                          struct rb_error *err)
{
	const int all = world->model->body_count + world->model->static_count;

	for (size_t k = 0; candidates->valid && k < candidates->pair_count; k++) {
		const struct rb_pair pair = candidates->pair[k];

		if (pair.a < 0 || pair.a >= all || pair.b < 0 || pair.b >= all || pair.a == pair.b)
			return RB_FAIL(err, RB_ERR_BUG, "candidate %zu is of bodies %d and %d", k,
			               pair.a, pair.b);
		if (!rb_stepped_is_dynamic(world, pair.a))
			return RB_FAIL(err, RB_ERR_BUG,
			               "candidate %zu is of bodies %d and %d, neither dynamic", k,
			               pair.a, pair.b);
	}
	for (size_t k = 1; candidates->valid && candidates->live && k < candidates->live_count; k++)
		if (candidates->live[k] <= candidates->live[k - 1] ||
		    candidates->live[k] >= candidates->pair_count)
			return RB_FAIL(err, RB_ERR_BUG, "live candidate %zu is out of order", k);
	return RB_OK;
}

/* `body` holds dynamic bodies, ascending, then driven ones, ascending; together all bodies. */
static enum rb_status validate_bodies(const struct rb_world *world, struct rb_error *err)
{
	const struct rb_stepped *const s = world->stepped;

	if (s->member_count + s->driven_count != world->model->body_count)
		return RB_FAIL(err, RB_ERR_BUG, "%d bodies yield, %d are driven, of %d",
		               s->member_count, s->driven_count, world->model->body_count);
	for (int k = 0; k < world->model->body_count; k++) {
		const int first = k == s->member_count ? 0 : k;

		if (first > 0 && s->body[k] <= s->body[k - 1])
			return RB_FAIL(err, RB_ERR_BUG, "bodies of the step are out of order");
		if (rb_stepped_is_dynamic(world, s->body[k]) != (k < s->member_count))
			return RB_FAIL(err, RB_ERR_BUG, "body %d is in the wrong list", s->body[k]);
	}
	return RB_OK;
}

enum rb_status rb_validate_stepped(const struct rb_world *world, struct rb_error *err)
{
	const struct rb_stepped *const s = world->stepped;
	if (!s)
		return RB_OK;
	enum rb_status status = validate_bodies(world, err);

	if (status == RB_OK)
		status = validate_sleep(s, world->model->body_count, err);
	if (status == RB_OK)
		status = validate_candidates(world, &s->candidates, err);
	return status;
}
