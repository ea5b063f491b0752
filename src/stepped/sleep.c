/* SPDX-License-Identifier: MIT */
/*
 * Sleeping without a threshold: a group sleeps only if a whole step has left its state bit for bit
 * unchanged under the same forces, and every step checks that the inputs are still the same bits. A
 * run with sleeping is therefore identical to one without, unlike with thresholds on velocity and
 * time. The price is that bodies which creep by an ulp never sleep.
 *
 * A group is a ring through `next`; waking one body wakes the ring. A sleeping group that is
 * touched by an awake body wakes before the step is solved, and waking propagates until no new
 * point touches a sleeping body.
 */
#include "stepped/sleep.h"
#include "stepped/find_points.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"

enum { POSE = 7 };

/*
 * A group sleeps only if its reach in a step is below this share of the smallest size: contacts of
 * spheres are then evaluated at their present positions, whatever the rounding of the step's
 * length.
 */
static const double small_share = 0.05;

enum rb_status rb_sleep_create(struct rb_sleep *sleep, const struct rb_model *model,
                               struct rb_error *err)
{
	const size_t n = (size_t)model->body_count;

	*sleep = (struct rb_sleep){.changed = true};
	sleep->sleeps = rb_memory_take(n, 1);
	sleep->mark = rb_memory_take(n, 1);
	sleep->next = rb_memory_take(n, sizeof *sleep->next);
	sleep->group = rb_memory_take(n, sizeof *sleep->group);
	sleep->points = rb_memory_take(n, sizeof *sleep->points);
	sleep->body = rb_memory_take(n, sizeof *sleep->body);
	sleep->pose = rb_memory_take(POSE * n, sizeof *sleep->pose);
	if (sleep->sleeps && sleep->mark && sleep->next && sleep->group && sleep->points &&
	    sleep->body && sleep->pose)
		return RB_OK;
	rb_sleep_release(sleep);
	return RB_FAIL(err, RB_ERR_MEMORY, "no memory for sleeping groups of %zu bodies", n);
}

void rb_sleep_release(struct rb_sleep *sleep)
{
	rb_memory_free(sleep->sleeps);
	rb_memory_free(sleep->mark);
	rb_memory_free(sleep->next);
	rb_memory_free(sleep->group);
	rb_memory_free(sleep->points);
	rb_memory_free(sleep->body);
	rb_memory_free(sleep->pose);
	rb_memory_free(sleep->live);
	*sleep = (struct rb_sleep){0};
}

/* ---- conditions ---- */

/* Whether the vector of a body is zero; a column that does not exist counts as zero. */
static bool is_none(const double *column, int i)
{
	const double *v = column ? column + 3 * (size_t)i : NULL;

	return !v || (v[0] == 0 && v[1] == 0 && v[2] == 0);
}

static inline uint64_t bits(const double *number)
{
	uint64_t all;

	memcpy(&all, number, sizeof all);
	return all;
}

/* Nonzero where two vectors differ in a bit, the sign of zero included. */
static inline uint64_t differ(const double *a, const double *b)
{
	return (bits(a) ^ bits(b)) | (bits(a + 1) ^ bits(b + 1)) | (bits(a + 2) ^ bits(b + 2));
}

/* Whether position and orientation are these, bit for bit. */
static inline bool has_pose(const struct rb_state *state, int i, const double *pose)
{
	uint64_t sum = differ(state->position + 3 * (size_t)i, pose);

	if (state->orientation) {
		const double *q = state->orientation + 4 * (size_t)i;

		sum |= differ(q, pose + 3) | (bits(q + 3) ^ bits(pose + 6));
	}
	return sum == 0;
}

static void take_pose(const struct rb_state *state, int i, double *pose)
{
	RB_ASSERT_COSTLY(i >= 0);
	memcpy(pose, state->position + 3 * (size_t)i, 3 * sizeof *pose);
	if (state->orientation)
		memcpy(pose + 3, state->orientation + 4 * (size_t)i, 4 * sizeof *pose);
}

static bool is_unmoved(const struct rb_world *world, int i)
{
	double pose[POSE];

	take_pose(&world->mark, i, pose);
	return has_pose(&world->state, i, pose);
}

/* Wakes the group of a body; a driven body is a group of its own. */
static void wake(struct rb_sleep *sleep, int i)
{
	int k = i;

	RB_ASSERT(sleep->sleeps[i] && sleep->count > 0);
	do {
		sleep->sleeps[k] = 0;
		sleep->count--;
		sleep->point_count -= (size_t)sleep->points[k];
		k = sleep->next[k];
	} while (k != i);
	sleep->changed = true;
	sleep->unchanged = false;
}

/* Whether a driven body to which a joint ties this one moves in the step. */
static bool is_pulled(const struct rb_world *world, int i)
{
	const struct rb_joints *joints = world->model->joints;
	bool pulled = false;

	for (int e = joints ? joints->first[i] : 0; joints && e < joints->first[i + 1]; e++) {
		const struct rb_joint *joint = &joints->joint[joints->of[e]];
		const int other = joint->a == i ? joint->b : joint->a;

		if (other >= 0 && other < world->model->body_count &&
		    !rb_stepped_is_dynamic(world, other) && !world->joint[joints->of[e]].released)
			pulled = pulled || !is_none(world->mark.velocity, other) ||
			         !is_none(world->mark.spin, other);
	}
	return pulled;
}

/*
 * Whether the step that put the body to sleep would give the same result again: no velocity, the
 * same pose, the same external acceleration, no joint that pulls.
 */
static bool remains_asleep(const struct rb_world *world, int i, double h)
{
	const struct rb_stepped *s = world->stepped;
	const struct rb_state *state = &world->state, *before = &world->mark;
	static const double none[3] = {0, 0, 0};
	const size_t row = 3 * (size_t)i;
	/* at the beginning of a step a driven body has the velocity to its next pose */
	uint64_t moves = differ(before->velocity + row, none);

	if (state->spin)
		moves |= differ(before->spin + row, none);
	return moves == 0 && has_pose(state, i, s->sleep.pose + POSE * (size_t)i) &&
	       (!rb_stepped_is_dynamic(world, i) ||
	        (!is_pulled(world, i) && rb_rest_holds(&s->solver, i, state->velocity + row,
	                                               state->spin ? state->spin + row : NULL, h)));
}

struct pass {
	struct rb_world *world;
	double h_s;
};

/*
 * Checks a block of sleeping bodies and updates their reaches, which follow the length of the step.
 */
static void check_block(void *user, int block, int worker)
{
	const struct pass *pass = user;
	struct rb_world *world = pass->world;
	struct rb_stepped *s = world->stepped;
	const int n = world->model->body_count, first = block * RB_BODIES_PER_BLOCK;

	(void)worker;
	for (int k = first; k < n && k < first + RB_BODIES_PER_BLOCK; k++) {
		const int i = s->body[k];

		s->sleep.mark[i] = s->sleep.sleeps[i] && !remains_asleep(world, i, pass->h_s);
		if (!s->sleep.sleeps[i])
			continue;
		s->candidates.reach[i] = rb_candidates_displacement(world, &world->state, i,
		                                                    pass->h_s);
		if (s->candidates.ahead && is_none(world->state.spin, i))
			s->candidates.ahead[i] = s->candidates.reach[i];
		else if (s->candidates.ahead)
			rb_candidates_turn(&s->candidates, world, i);
	}
}

void rb_sleep_wake(struct rb_world *world, const unsigned char *mark)
{
	struct rb_sleep *sleep = &world->stepped->sleep;

	for (int i = 0; i < world->model->body_count; i++)
		if (mark[i] && sleep->sleeps[i])
			wake(sleep, i);
}

/* Wakes groups whose inputs have changed since the last step. */
static void wake_changed(struct rb_world *world, double start, double h)
{
	struct rb_stepped *s = world->stepped;
	struct rb_sleep *sleep = &s->sleep;
	const int n = world->model->body_count;
	struct pass pass = {world, h};

	/* another method may have advanced the world, or a callback may have moved bodies */
	if (!(fabs(start - sleep->end_s) <= 1e-3 * h) ||
	    world->contacts.count != sleep->contact_count)
		rb_sleep_forget(s);
	if (sleep->count == 0)
		return;
	s->candidates.h_s = h;
	rb_team_run(world->team, (n + RB_BODIES_PER_BLOCK - 1) / RB_BODIES_PER_BLOCK, check_block,
	            &pass);
	if (!memchr(sleep->mark, 1, (size_t)n))
		return;
	rb_sleep_wake(world, sleep->mark);
	memset(sleep->mark, 0, (size_t)n);
}

/* ---- awake bodies ---- */

void rb_sleep_gather(struct rb_stepped *s)
{
	s->all.body = s->body;
	s->all.member_count = s->member_count;
	s->all.body_count = s->member_count + s->driven_count;
}

/* Lists awake dynamic bodies, then all driven ones. */
static void list_awake(struct rb_stepped *s)
{
	struct rb_sleep *sleep = &s->sleep;
	int count = 0;

	RB_ASSERT(sleep->count >= 0 && sleep->count <= s->member_count + s->driven_count);
	rb_sleep_gather(s);
	for (int k = 0; k < s->member_count; k++)
		if (!sleep->sleeps[s->body[k]])
			sleep->body[count++] = s->body[k];
	memcpy(sleep->body + count, s->body + s->member_count,
	       (size_t)s->driven_count * sizeof *sleep->body);
	sleep->live_bodies = count;
}

/* Restricts the cohort of all to awake bodies. */
static void use_awake(struct rb_stepped *s)
{
	s->all.body = s->sleep.body;
	s->all.member_count = s->sleep.live_bodies;
	s->all.body_count = s->sleep.live_bodies + s->driven_count;
}

static bool sleeps_or_is_static(const struct rb_sleep *sleep, int n, int i)
{
	return i >= n || sleep->sleeps[i];
}

/*
 * Live pairs: those with an awake body. The largest overlap of the others is remembered as long as
 * all of them sleep.
 */
static enum rb_status list_pairs(struct rb_world *world, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_sleep *sleep = &s->sleep;
	struct rb_candidates *candidates = &s->candidates;
	const int n = world->model->body_count;
	size_t count = 0;

	candidates->live = NULL;
	if (sleep->changed)
		sleep->resting_depth = (double)NAN;
	candidates->resting_depth = sleep->resting_depth;
	sleep->changed = false;
	if (sleep->count == 0)
		return RB_OK;
	if (!rb_memory_reserve(&sleep->live, &sleep->live_capacity, candidates->pair_count + 1,
	                       sizeof *sleep->live))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu pairs",
		               candidates->pair_count);
	for (size_t k = 0; k < candidates->pair_count; k++) {
		const struct rb_pair pair = candidates->pair[k];

		sleep->live[count] = (uint32_t)k;
		count += !(sleep->sleeps[pair.a] && sleeps_or_is_static(sleep, n, pair.b));
	}
	candidates->live = sleep->live;
	candidates->live_count = count;
	return RB_OK;
}

enum rb_status rb_sleep_list(struct rb_world *world, struct rb_error *err)
{
	const struct rb_stepped *s = world->stepped;

	return !s->candidates.live && s->sleep.count > 0 ? list_pairs(world, err) : RB_OK;
}

/*
 * Wakes groups touched by the points from `first` on and marks their bodies; returns whether there
 * were any.
 */
static bool wake_touched(struct rb_world *world, size_t first)
{
	struct rb_stepped *s = world->stepped;
	struct rb_sleep *sleep = &s->sleep;
	bool any = false;

	for (size_t k = first; k < s->all.points.count; k++) {
		const int ends[2] = {s->all.points.row[k].a, s->all.points.row[k].b};

		for (int e = 0; e < 2; e++) {
			if (!rb_stepped_is_dynamic(world, ends[e]) || !sleep->sleeps[ends[e]])
				continue;
			any = true;
			wake(sleep, ends[e]);
			for (int i = ends[e]; !sleep->mark[i]; i = sleep->next[i])
				sleep->mark[i] = 1;
		}
	}
	return any;
}

/*
 * Adds points of pairs among the bodies just woken, and between them and sleeping ones; pairs with
 * others have been inspected.
 */
static enum rb_status inspect_woken(struct rb_world *world, double h, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_sleep *sleep = &s->sleep;
	struct rb_candidates *candidates = &s->candidates;
	const int n = world->model->body_count;
	const size_t all_count = candidates->live_count;
	const uint32_t *all = candidates->live;
	uint32_t *fresh = rb_arena_take(&world->arena[0], candidates->pair_count + 1,
	                                sizeof *fresh);
	size_t count = 0;

	if (!fresh)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu pairs",
		               candidates->pair_count);
	for (size_t k = 0; k < candidates->pair_count; k++) {
		const int a = candidates->pair[k].a, b = candidates->pair[k].b;
		const bool of_a = sleep->mark[a], of_b = b < n && sleep->mark[b];

		fresh[count] = (uint32_t)k;
		count += (of_a || of_b) && (of_a || sleep->sleeps[a]) &&
		         (of_b || sleeps_or_is_static(sleep, n, b));
	}
	candidates->live = fresh;
	candidates->live_count = count;
	const enum rb_status status = rb_step_points_add(&s->all.points, world, candidates, h,
	                                                 HUGE_VAL, err);
	candidates->live = all;
	candidates->live_count = all_count;
	return status;
}

/* Sets velocities of sleeping bodies to zero again, since forces were added to all bodies. */
static void stop_sleeping(struct rb_world *world)
{
	struct rb_stepped *s = world->stepped;
	struct rb_state *state = &world->state;

	for (int k = 0; k < s->member_count && s->sleep.count > 0; k++) {
		const int i = s->body[k];

		if (!s->sleep.sleeps[i])
			continue;
		memset(state->velocity + 3 * (size_t)i, 0, 3 * sizeof(double));
		if (state->spin)
			memset(state->spin + 3 * (size_t)i, 0, 3 * sizeof(double));
		if (s->candidates.ahead)
			s->candidates.ahead[i] = s->candidates.reach[i];
	}
}

enum rb_status rb_sleep_points(struct rb_world *world, double start, double h, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct rb_sleep *sleep = &s->sleep;
	struct rb_candidates *candidates = &s->candidates;
	struct rb_step_points *points = &s->all.points;
	size_t first = 0;

	RB_ASSERT(h > 0);
	wake_changed(world, start, h);
	if (sleep->changed)
		list_awake(s);
	use_awake(s);
	rb_candidates_reach(candidates, world, h, s->all.body, s->all.body_count);
	candidates->share = (double)s->all.body_count / world->model->body_count;
	enum rb_status status = rb_candidates_find(candidates, world, s->all.body,
	                                           s->all.body_count, err);
	if (status == RB_OK && sleep->changed)
		status = list_pairs(world, err);
	if (status == RB_OK)
		status = rb_sleep_list(world, err);
	rb_candidates_place(candidates, world, s->all.body, s->all.body_count);
	points->count = 0;
	if (status == RB_OK)
		status = rb_step_points_add(points, world, candidates, h, HUGE_VAL, err);
	while (status == RB_OK && sleep->count > 0 && wake_touched(world, first)) {
		first = points->count;
		list_awake(s);
		use_awake(s);
		status = list_pairs(world, err);
		if (status == RB_OK)
			status = inspect_woken(world, h, err);
		memset(sleep->mark, 0, (size_t)world->model->body_count);
	}
	if (status == RB_OK && first > 0)
		status = rb_step_points_sort(points, &world->arena[0], err);
	stop_sleeping(world);
	return status;
}

/* ---- falling asleep ---- */

void rb_sleep_mark(struct rb_world *world)
{
	struct rb_stepped *s = world->stepped;
	struct rb_sleep *sleep = &s->sleep;
	const struct rb_solver *solver = &s->solver;

	for (int k = 0; k < s->all.body_count; k++)
		sleep->group[s->all.body[k]] = -1;
	for (size_t g = 0; g < solver->island_count; g++) {
		const struct rb_island *island = &solver->island[g];
		const int *member = solver->member + island->first_member;

		for (int k = 0; k < island->member_count && island->rests; k++) {
			sleep->group[member[k]] = member[0];
			sleep->next[member[k]] = member[k + 1 < island->member_count ? k + 1 : 0];
			sleep->points[member[k]] = k == 0 ? island->row_count : 0;
		}
	}
}

/*
 * Whether a body has not failed, has not moved by a bit, has no residual that the next step would
 * use, and has a small reach.
 */
static bool may_sleep(const struct rb_world *world, int i, const unsigned char *failed)
{
	const struct rb_stepped *s = world->stepped;

	return !(failed && failed[i]) && !s->bad[i] && is_unmoved(world, i) &&
	       s->solver.residual[i] == 0 &&
	       s->candidates.reach[i] <= small_share * world->model->size_min_m;
}

static void fall_asleep(struct rb_world *world, int i)
{
	struct rb_sleep *sleep = &world->stepped->sleep;

	sleep->sleeps[i] = 1;
	sleep->count++;
	sleep->point_count += (size_t)sleep->points[i];
	take_pose(&world->state, i, sleep->pose + POSE * (size_t)i);
	sleep->changed = true;
}

/* Driven bodies sleep while their function of time does not move them. */
static void end_driven(struct rb_world *world)
{
	struct rb_stepped *s = world->stepped;
	struct rb_sleep *sleep = &s->sleep;

	for (int k = 0; k < s->driven_count; k++) {
		const int i = s->body[s->member_count + k];
		const bool asleep = is_none(world->mark.velocity, i) &&
		                    is_none(world->mark.spin, i) && is_unmoved(world, i);

		sleep->next[i] = i;
		sleep->points[i] = 0;
		if (asleep && !sleep->sleeps[i])
			fall_asleep(world, i);
		else if (!asleep && sleep->sleeps[i])
			wake(sleep, i);
	}
}

void rb_sleep_end(struct rb_world *world, double end, const unsigned char *failed)
{
	struct rb_stepped *s = world->stepped;
	struct rb_sleep *sleep = &s->sleep;
	const struct rb_cohort *all = &s->all;

	sleep->unchanged = all->points.count == 0;
	sleep->end_s = end;
	sleep->contact_count = world->contacts.count;
	sleep->resting_depth = s->candidates.resting_depth;
	if (sleep->off)
		return;
	end_driven(world);
	for (int k = 0; k < all->member_count; k++) {
		const int i = all->body[k], group = sleep->group[i];

		if (group >= 0 && !may_sleep(world, i, failed))
			sleep->mark[group] = 1;
	}
	for (int k = 0; k < all->member_count; k++) {
		const int i = all->body[k];

		if (sleep->group[i] >= 0 && !sleep->mark[sleep->group[i]])
			fall_asleep(world, i);
	}
	for (int k = 0; k < all->member_count; k++)
		sleep->mark[all->body[k]] = 0;
	sleep->unchanged = sleep->unchanged && !sleep->changed;
}

void rb_sleep_forget(struct rb_stepped *s)
{
	struct rb_sleep *sleep = &s->sleep;

	sleep->unchanged = false;
	if (sleep->count == 0)
		return;
	memset(sleep->sleeps, 0, (size_t)(s->member_count + s->driven_count));
	sleep->count = 0;
	sleep->point_count = 0;
	sleep->changed = true;
}
