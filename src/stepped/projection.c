/* SPDX-License-Identifier: MIT */
#include "stepped/projection.h"

#include <string.h>

#include "base/error.h"
#include "base/forest.h"
#include "base/memory.h"
#include "base/team.h"
#include "stepped/end_points.h"
#include "stepped/projection_impulses.h"
#include "stepped/find_points.h"
#include "stepped/joint_steps.h"
#include "stepped/projection_energy.h"
#include "world/joint_state.h"

/*
 * Limit of rounds; limit of a body's displacement in deepest overlaps, as one body pushes the next.
 */
enum { CLOSINGS_MAX = 12, CHAIN_MAX = 16 };
/*
 * Contacts, counted from an overlap, across which bodies may move in the first round; twice as many
 * in each further one. Most overlaps are closed by few bodies, and a heap is one group.
 */
enum { FIRST_WAVES = 2 };

/*
 * Overlap that is closed by moving positions, as a share of the smallest size, plus multiples of
 * the bend of rotating bodies. A deeper one is relinearized, and the step rejected where twice as
 * much is left.
 */
static const double closable_share = 0.02, closable_bends = 2, lost_ratio = 2;
/* If spin cannot pay for the lift, the step is shortened, down to this part of the whole one. */
static const double paying_parts = 8;
/*
 * Largest rotation in a step whose bend may be closed, rad: the bend is a thirty-second of the
 * radius.
 */
static const double bend_turn_max = 0.25;

/* ---- limits ---- */

/*
 * Bend: distance of the points of a rotating body from the straight paths of the linear model, r (w
 * h)^2 / 2, m.
 */
static double bend_of(const struct rb_world *world, int i, double h)
{
	if (!world->state.spin || i >= world->model->body_count)
		return 0;
	const double turn = fmin(bend_turn_max,
	                         h * fmax(rb_vec3_length(rb_world_row3(world->state.spin, i)),
	                                  rb_vec3_length(rb_world_row3(world->mark.spin, i))));
	return 0.5 * turn * turn * rb_candidates_size(world->model, i);
}

double rb_projection_max(const struct rb_world *world, const struct rb_deep *deep, double h)
{
	return closable_share * world->model->size_min_m +
	       closable_bends * (bend_of(world, deep->a, h) + bend_of(world, deep->b, h));
}

double rb_projection_reject_depth(const struct rb_world *world, const struct rb_deep *deep,
                                  double h)
{
	return lost_ratio * rb_projection_max(world, deep, h);
}

enum { PAIRS_PER_BLOCK = 1024, BODIES_PER_BLOCK = 64 };

/* Positions of a pair's bodies in search.body; -1: not dynamic. */
struct ends {
	int a, b;
};

/* Breadth-first search from overlaps over candidate pairs. All in the arena. */
struct search {
	struct rb_world *world;
	struct rb_cohort *cohort;
	const int *body; /* bodies that could be moved: those of the cohort, and sleeping ones */
	int count;
	/* by body: its candidate pairs are of[first[i]] to of[first[i + 1] - 1] */
	uint32_t *first, *of;
	int *place;              /* by body: index in `body` */
	struct ends *ends;       /* by pair, while pairs are indexed */
	unsigned char *reached;  /* by body: reached by the search */
	double *depth;           /* m, by reached body: largest overlap from which it was reached */
	unsigned char *moved;    /* by body: moved in the last round */
	int *parent;             /* by body: union-find forest of groups */
	unsigned char *lost;     /* by group: contains a bad body */
	unsigned char *visited;  /* by pair: by the search */
	unsigned char *anchored; /* by body: its group of the solution contains a static body */
	unsigned char *frozen;   /* by body: treated as static in this round */
	unsigned char *too_far;  /* by island: moved too far, so it is not moved */
	struct rb_solver_body *saved; /* by body: the solver's copy of a frozen body */
	int waves, waves_max;
	int *wave;              /* bodies from which the search continues */
	int *active;            /* bodies reached and not frozen */
	int *at_rest;           /* bodies whose velocity is saved and cleared */
	unsigned char *stopped; /* by body: is in at_rest */
	uint32_t *pair;         /* pairs to be inspected */
	int wave_count, active_count, resting_count;
	struct rb_projection_energy lift;
	/* the step's points, carried to its end, of pairs that need no inspection */
	struct rb_end_points carried;
	uint32_t *carried_pair; /* pairs of a wave with carried points */
	size_t carried_count;
	bool again; /* not the first round */
};

/* ---- candidates by body ---- */

static enum rb_status no_memory(struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the overlaps of a step");
}

static enum rb_status begin_search(struct search *search, struct rb_error *err)
{
	struct rb_arena *arena = &search->world->arena[0];
	const size_t n = (size_t)search->world->model->body_count;
	const size_t pairs = search->cohort->candidates->pair_count, count = (size_t)search->count;

	RB_ASSERT(pairs < UINT32_MAX / 2);
	search->place = rb_arena_take(arena, n, sizeof *search->place);
	search->first = rb_arena_take(arena, count + 2, sizeof *search->first);
	search->of = rb_arena_take(arena, 2 * pairs + 1, sizeof *search->of);
	search->reached = rb_arena_take(arena, n, 1);
	search->depth = rb_arena_take(arena, n, sizeof *search->depth);
	search->moved = rb_arena_take(arena, n, 1);
	search->stopped = rb_arena_take(arena, n, 1);
	search->parent = rb_arena_take(arena, n, sizeof *search->parent);
	search->lost = rb_arena_take(arena, n, 1);
	search->visited = rb_arena_take(arena, pairs + 1, 1);
	search->anchored = rb_arena_take(arena, n, 1);
	search->frozen = rb_arena_take(arena, n, 1);
	search->too_far = rb_arena_take(arena, n + 1, 1);
	search->saved = rb_arena_take(arena, n, sizeof *search->saved);
	search->wave = rb_arena_take(arena, n, sizeof *search->wave);
	search->active = rb_arena_take(arena, n, sizeof *search->active);
	search->at_rest = rb_arena_take(arena, n, sizeof *search->at_rest);
	search->pair = rb_arena_take(arena, pairs + 1, sizeof *search->pair);
	search->carried_pair = rb_arena_take(arena, pairs + 1, sizeof *search->carried_pair);
	if (search->place && search->first && search->of && search->reached && search->depth &&
	    search->moved && search->stopped && search->parent && search->lost && search->visited &&
	    search->anchored && search->frozen && search->too_far && search->saved &&
	    search->wave && search->active && search->at_rest && search->pair &&
	    search->carried_pair) {
		memset(search->moved, 0, n);
		memset(search->stopped, 0, n);
		return RB_OK;
	}
	return no_memory(err);
}

static void find_ends(void *user, size_t first, size_t end)
{
	const struct search *search = user;
	const struct rb_pair *const pair = search->cohort->candidates->pair;

	for (size_t k = first; k < end; k++)
		search->ends[k] = (struct ends){search->place[pair[k].a],
		                                rb_stepped_is_dynamic(search->world, pair[k].b)
		                                        ? search->place[pair[k].b]
		                                        : -1};
}

static enum rb_status index_pairs(struct search *search, struct rb_error *err)
{
	struct rb_arena *const arena = &search->world->arena[0];
	const rb_arena_mark here = rb_arena_here(arena);
	const size_t pairs = search->cohort->candidates->pair_count;
	uint32_t *const first = search->first;

	search->ends = rb_arena_take(arena, pairs + 1, sizeof *search->ends);
	if (!search->ends)
		return no_memory(err);
	memset(first, 0, ((size_t)search->count + 2) * sizeof *first);
	for (int k = 0; k < search->count; k++)
		search->place[search->body[k]] = k;
	rb_team_share(search->world->team, pairs, PAIRS_PER_BLOCK, find_ends, search);
	for (size_t k = 0; k < pairs; k++) {
		first[search->ends[k].a + 2]++;
		if (search->ends[k].b >= 0)
			first[search->ends[k].b + 2]++;
	}
	for (int k = 0; k < search->count; k++)
		first[k + 2] += first[k + 1];
	for (size_t k = 0; k < pairs; k++) {
		search->of[first[search->ends[k].a + 1]++] = (uint32_t)k;
		if (search->ends[k].b >= 0)
			search->of[first[search->ends[k].b + 1]++] = (uint32_t)k;
	}
	rb_arena_back(arena, here);
	return RB_OK;
}

/* velocities: displacements while positions are moved */

static void clear_velocity(struct rb_world *world, int i)
{
	memset(world->state.velocity + 3 * (size_t)i, 0, 3 * sizeof(double));
	if (world->state.spin)
		memset(world->state.spin + 3 * (size_t)i, 0, 3 * sizeof(double));
}

static void take_velocity(struct search *search, int i)
{
	struct rb_world *world = search->world;
	double *const aside = world->stepped->saved_velocity;

	if (i >= world->model->body_count || search->stopped[i])
		return;
	search->stopped[i] = 1;
	search->at_rest[search->resting_count++] = i;
	rb_vec3_to(aside + 6 * (size_t)i, rb_world_row3(world->state.velocity, i));
	if (world->state.spin)
		rb_vec3_to(aside + 6 * (size_t)i + 3, rb_world_row3(world->state.spin, i));
	clear_velocity(world, i);
	/* a body found in an earlier round: its reach is again that without rotation */
	if (search->again)
		rb_candidates_turn(search->cohort->candidates, world, i);
}

static void give_velocities(const struct search *search)
{
	struct rb_world *world = search->world;
	const double *aside = world->stepped->saved_velocity;

	for (int k = 0; k < search->resting_count; k++) {
		const int i = search->at_rest[k];

		rb_vec3_to(world->state.velocity + 3 * (size_t)i,
		           rb_vec3_from(aside + 6 * (size_t)i));
		if (world->state.spin)
			rb_vec3_to(world->state.spin + 3 * (size_t)i,
			           rb_vec3_from(aside + 6 * (size_t)i + 3));
	}
}

/* ---- groups ---- */

static void inspect_from(struct search *search, int i, double depth)
{
	if (!rb_stepped_is_dynamic(search->world, i))
		return;
	search->depth[i] = search->reached[i] ? fmax(search->depth[i], depth) : depth;
	if (search->reached[i])
		return;
	search->reached[i] = 1;
	search->wave[search->wave_count++] = i;
}

static void join_groups(struct search *search, int a, int b)
{
	a = rb_forest_root(search->parent, a);
	b = rb_forest_root(search->parent, b);
	const bool lost = search->lost[a] || search->lost[b];

	search->parent[a > b ? a : b] = a > b ? b : a;
	search->lost[a > b ? b : a] = lost;
}

/* The larger overlap from which two bodies were reached, m. */
static double depth_from(const struct search *search, int a, int b)
{
	const bool has_b = rb_stepped_is_dynamic(search->world, b) && search->reached[b];

	return fmax(search->reached[a] ? search->depth[a] : 0, has_b ? search->depth[b] : 0);
}

static void join(struct search *search, const struct rb_step_point *point)
{
	if (rb_stepped_is_dynamic(search->world, point->b))
		join_groups(search, point->a, point->b);
	const double depth = depth_from(search, point->a, point->b);

	inspect_from(search, point->a, depth);
	inspect_from(search, point->b, depth);
}

/*
 * Finds bodies whose group, as in the solution, touches a static body. Any other group keeps its
 * centre of mass, so all of it must be movable; nor are joints separated.
 */
static void find_anchored(struct search *search)
{
	const struct rb_step_points *points = &search->cohort->points;
	const struct rb_world *world = search->world;
	unsigned char *const holds = search->frozen; /* scratch, by root of a group */

	for (int k = 0; k < search->count; k++)
		holds[search->body[k]] = search->anchored[search->body[k]] = 0;
	for (size_t k = 0; !world->model->joints && k < points->count; k++)
		if (points->row[k].b >= world->model->body_count)
			holds[rb_forest_root(search->lift.parent, points->row[k].a)] = 1;
	for (int k = 0; k < search->count; k++)
		search->anchored[search->body[k]] =
			holds[rb_forest_root(search->lift.parent, search->body[k])];
}

/*
 * Begins a round from deep overlaps. Groups with a bad body are not moved: overlaps with it are not
 * searched from.
 */
static void begin_round(struct search *search, const struct rb_depths *found)
{
	const unsigned char *bad = search->world->stepped->bad;

	for (int k = 0; k < search->count; k++) {
		const int i = search->body[k];

		search->reached[i] = search->frozen[i] = 0;
		search->parent[i] = i;
		search->lost[i] = bad[i];
	}
	memset(search->visited, 0, search->cohort->candidates->pair_count);
	search->wave_count = search->waves = 0;
	for (size_t k = 0; k < found->deep_count; k++) {
		const int a = found->deep[k].a, b = found->deep[k].b;
		const bool is_dynamic = rb_stepped_is_dynamic(search->world, b);

		if (!bad[a] && !(is_dynamic && bad[b]))
			continue;
		search->lost[a] = 1;
		if (is_dynamic)
			search->lost[b] = 1;
	}
	for (size_t k = 0; k < found->deep_count; k++) {
		inspect_from(search, found->deep[k].a, found->deep[k].depth);
		inspect_from(search, found->deep[k].b, found->deep[k].depth);
	}
}

/* Adds jointed bodies, which move together, whether they are candidates or not. */
static void inspect_joined(struct search *search, int i)
{
	const struct rb_joints *joints = search->world->model->joints;

	for (int e = joints->first[i]; e < joints->first[i + 1]; e++) {
		const struct rb_joint *joint = &joints->joint[joints->of[e]];
		const int other = joint->a == i ? joint->b : joint->a;

		take_velocity(search, i);
		if (other < 0 || search->world->joint[joints->of[e]].released ||
		    !rb_stepped_is_dynamic(search->world, other))
			continue;
		join_groups(search, i, other);
		inspect_from(search, other, search->depth[i]);
	}
}

/*
 * Collects candidate pairs of the wave's bodies that have not been visited, except in lost groups:
 * pairs to inspect, and pairs with carried points. Returns the number of the former.
 */
static size_t next_pairs(struct search *search)
{
	const struct rb_candidates *candidates = search->cohort->candidates;
	size_t count = 0;

	search->carried_count = 0;
	/* the wave grows during the loop */
	for (int k = 0; search->world->model->joints && k < search->wave_count; k++)
		inspect_joined(search, search->wave[k]);
	for (int k = 0; k < search->wave_count; k++) {
		const int place = search->place[search->wave[k]];

		if (search->lost[rb_forest_root(search->parent, search->wave[k])])
			continue;
		if (search->waves >= search->waves_max && search->anchored[search->wave[k]]) {
			search->frozen[search->wave[k]] = 1;
			continue;
		}
		take_velocity(search, search->wave[k]);
		for (uint32_t at = search->first[place]; at < search->first[place + 1]; at++) {
			const uint32_t pair = search->of[at];

			if (search->visited[pair])
				continue;
			search->visited[pair] = 1;
			if (rb_end_points_has(&search->carried, pair)) {
				search->carried_pair[search->carried_count] = pair;
				search->carried_count += rb_end_points_is_near(&search->carried,
				                                               pair);
				continue;
			}
			search->pair[count++] = pair;
			take_velocity(search, candidates->pair[pair].a);
			take_velocity(search, candidates->pair[pair].b);
		}
	}
	search->wave_count = 0;
	search->waves++;
	return count;
}

/*
 * Adds carried points near enough for the displacement that the overlap may cause; one that is
 * missed is found in the next round. False: no memory.
 */
static bool add_carried(struct search *search)
{
	const double tolerance = search->world->model->stepped_tolerance_m;
	bool good = true;

	for (size_t k = 0; k < search->carried_count && good; k++) {
		const uint32_t pair = search->carried_pair[k];
		const struct rb_pair of = search->cohort->candidates->pair[pair];

		good = rb_end_points_add(&search->carried, pair,
		                         CHAIN_MAX * depth_from(search, of.a, of.b) + tolerance,
		                         &search->world->stepped->closing);
	}
	return good;
}

/*
 * Finds the points of all groups with an overlap, in order of pairs, and their bodies, wave by
 * wave.
 */
static enum rb_status find_points(struct search *search, const struct rb_depths *found, double max,
                                  struct rb_error *err)
{
	struct rb_world *world = search->world;
	struct rb_candidates *candidates = search->cohort->candidates;
	struct rb_step_points *points = &world->stepped->closing;
	const uint32_t *const live = candidates->live;
	const size_t live_count = candidates->live_count;
	enum rb_status status = RB_OK;

	points->count = 0;
	begin_round(search, found);
	candidates->live = search->pair;
	while (status == RB_OK && search->wave_count > 0) {
		size_t at = points->count;

		candidates->live_count = next_pairs(search);
		if (candidates->live_count > 0)
			status = rb_step_points_add(points, world, candidates, 1, max, err);
		if (status == RB_OK && !add_carried(search))
			status = no_memory(err);
		for (; at < points->count; at++)
			join(search, &points->row[at]);
	}
	candidates->live = live;
	candidates->live_count = live_count;
	search->active_count = 0;
	for (int k = 0; k < search->count; k++)
		if (search->reached[search->body[k]] && !search->frozen[search->body[k]])
			search->active[search->active_count++] = search->body[k];
	return status == RB_OK ? rb_step_points_sort(points, &world->arena[0], err) : status;
}

/* Leaves out bodies of other groups, since joints have rows without points. */
static void keep_joined(struct search *search)
{
	int kept = 0;

	for (int k = 0; k < search->active_count; k++) {
		const int i = search->active[k], root = rb_forest_root(search->parent, i);

		if (search->moved[root] && !search->lost[root])
			search->active[kept++] = i;
	}
	search->active_count = kept;
}

/* Keeps the points of groups that overlap and have no bad body: others are admissible or lost. */
static void keep_points(struct search *search, const struct rb_depths *found)
{
	struct rb_step_points *points = &search->world->stepped->closing;
	size_t kept = 0;

	memset(search->moved, 0, (size_t)search->world->model->body_count);
	for (size_t k = 0; k < found->deep_count; k++)
		search->moved[rb_forest_root(search->parent, found->deep[k].a)] = 1;
	for (size_t k = 0; k < points->count; k++) {
		const int root = rb_forest_root(search->parent, points->row[k].a);

		if (search->moved[root] && !search->lost[root])
			points->row[kept++] = points->row[k];
	}
	points->count = kept;
	if (search->world->model->joints)
		keep_joined(search);
	memset(search->moved, 0, (size_t)search->world->model->body_count);
}

/* ---- moving ---- */

/* Makes frozen bodies static for the solver. */
static void freeze(struct search *search)
{
	struct rb_solver *const solver = &search->world->stepped->solver;
	struct rb_solver_body *const body = solver->dense.bodies.body;

	for (int k = 0; k < search->count; k++) {
		const int i = search->body[k];

		if (!search->frozen[i])
			continue;
		search->saved[i] = body[i];
		body[i] = (struct rb_solver_body){.inverse_mass = 0};
		solver->island_of[i] = solver->local[i] = -1;
	}
}

static void thaw(struct search *search)
{
	for (int k = 0; k < search->count; k++)
		if (search->frozen[search->body[k]])
			search->world->stepped->solver.dense.bodies.body[search->body[k]] =
				search->saved[search->body[k]];
}

/*
 * Finds groups that would move farther than the distance within which points were searched, m:
 * contacts there are unknown. Where friction or rounding wedges a group, sweeps may end as far off.
 */
static void find_too_far(struct search *search, double max)
{
	const struct rb_world *world = search->world;
	const struct rb_solver *solver = &world->stepped->solver;
	struct rb_step_points *points = &world->stepped->closing;
	bool any = false;

	memset(search->too_far, 0, solver->island_count);
	for (int k = 0; k < search->active_count; k++) {
		const int i = search->active[k];

		if (solver->island_of[i] < 0)
			continue;
		const struct rb_solver_body *body = &solver->dense.bodies.body[i];
		const double displacement = rb_vec3_length(body->linear) +
		                            rb_vec3_length(body->angular) *
		                                    rb_candidates_size(world->model, i);

		/* written so that NaN counts as far */
		if (displacement <= max)
			continue;
		search->too_far[solver->island_of[i]] = 1;
		any = true;
	}
	for (size_t k = 0; any && k < points->count; k++)
		if (search->too_far[solver->island_of[points->row[k].a]])
			points->row[k].normal_impulse = 0;
}

/* Moves the active bodies by the solver's velocities, which are displacements. */
static void shift(void *user, size_t first, size_t end)
{
	struct search *search = user;
	struct rb_world *world = search->world;
	const struct rb_solver *solver = &world->stepped->solver;

	for (size_t k = first; k < end; k++) {
		const int i = search->active[k];

		if (solver->island_of[i] < 0 || search->too_far[solver->island_of[i]])
			continue;
		search->moved[i] = 1;
		const struct rb_solver_body *body = &solver->dense.bodies.body[i];
		double *const at = world->state.position + 3 * (size_t)i;

		rb_projection_energy_add(&search->lift, world, i);
		rb_vec3_to(at, rb_vec3_add(rb_vec3_from(at), body->linear));
		if (!world->state.spin)
			continue;
		double *const q = world->state.orientation + 4 * (size_t)i;
		rb_quat_to(q, rb_quat_turned(rb_quat_from(q), body->angular));
	}
}

static double deepest(const struct rb_depths *found)
{
	double max = 0;

	for (size_t k = 0; k < found->deep_count; k++)
		max = fmax(max, found->deep[k].depth);
	return max;
}

static void lift_joined(struct search *search, int i)
{
	const struct rb_model *model = search->world->model;
	int at = -1;

	for (int k; (k = rb_joints_next_of(search->world, i, &at)) >= 0;) {
		const struct rb_joint *joint = &model->joints->joint[k];
		const int other = joint->a == i ? joint->b : joint->a;

		/* the world is static */
		rb_projection_energy_join(&search->lift, search->world, i,
		                          other < 0 ? model->body_count : other);
	}
}

/* Joins groups for the energy of the lift. A frozen body acts as a static one. */
static void join_lift(struct search *search, int a, int b)
{
	rb_projection_energy_join(&search->lift, search->world, a, b);
	if (search->frozen[a] || (rb_stepped_is_dynamic(search->world, b) && search->frozen[b]))
		rb_projection_energy_join(&search->lift, search->world, a,
		                          search->world->model->body_count);
}

/* Material of projection: no friction. */
static const struct rb_pair_material smooth = {0};

/* One round: finds points, solves the groups concerned, moves their bodies. */
static enum rb_status close_round(struct search *search, const struct rb_depths *found,
                                  struct rb_error *err)
{
	struct rb_world *world = search->world;
	struct rb_stepped *s = world->stepped;

	/* parts are placed at the poses at which overlaps were measured */
	const double max = CHAIN_MAX * deepest(found) + world->model->stepped_tolerance_m;
	enum rb_status status = find_points(search, found, max, err);
	if (status == RB_OK)
		keep_points(search, found);
	for (size_t k = 0; status == RB_OK && k < s->closing.count; k++) {
		s->closing.row[k].material = &smooth;
		join_lift(search, s->closing.row[k].a, s->closing.row[k].b);
	}
	for (int k = 0; status == RB_OK && k < search->active_count; k++)
		lift_joined(search, search->active[k]);
	/* driven bodies have no displacement either */
	for (int k = 0; k < s->driven_count; k++) {
		take_velocity(search, s->body[s->member_count + k]);
		search->active[search->active_count + k] = s->body[s->member_count + k];
	}
	s->solver.active = search->active;
	s->solver.active_count = search->active_count + s->driven_count;
	freeze(search);
	if (status == RB_OK)
		status = rb_solver_step(&s->solver, world, NULL, &s->closing, 1, err);
	if (status == RB_OK) {
		find_too_far(search, max);
		rb_projection_energy_turn(&search->lift, world, &s->closing);
		rb_team_share(world->team, (size_t)search->active_count, BODIES_PER_BLOCK, shift,
		              search);
	}
	thaw(search);
	/* displacements are no velocities: clear them before the next measurement */
	for (int k = 0; k < search->resting_count; k++)
		clear_velocity(world, search->at_rest[k]);
	s->solver.active = search->cohort->body;
	s->solver.active_count = search->cohort->body_count;
	return status;
}

/* Measures overlaps of moved bodies; the parts of others are still in place. */
static enum rb_status find_depths_again(struct search *search, struct rb_depths *found,
                                        struct rb_error *err)
{
	struct rb_world *world = search->world;
	const struct rb_stepped *s = world->stepped;

	rb_candidates_place(search->cohort->candidates, world, search->at_rest,
	                    search->resting_count);
	const enum rb_status status = rb_depths_find(world, search->cohort->candidates,
	                                             s->bad_count > 0 ? s->bad : NULL,
	                                             search->moved, found, err);
	for (int k = 0; k < search->active_count; k++)
		search->moved[search->active[k]] = 0;
	return status;
}

static void blame(struct rb_world *world, const struct rb_deep *deep)
{
	rb_stepped_blame(world->stepped, deep->a);
	if (rb_stepped_is_dynamic(world, deep->b))
		rb_stepped_blame(world->stepped, deep->b);
}

/* Blames overlaps that only shorter steps can avoid. */
static void blame_unclosable(struct rb_world *world, const struct rb_cohort *cohort,
                             const struct rb_depths *found)
{
	for (size_t k = 0; k < found->deep_count; k++) {
		const struct rb_deep *deep = &found->deep[k];

		if (!(deep->depth <=
		      rb_projection_reject_depth(world, deep, cohort->candidates->h_s)))
			blame(world, deep);
	}
}

static bool all_is_lost(const struct rb_stepped *s, const struct rb_cohort *cohort)
{
	return s->bad_count > 0 && !cohort->divides;
}

static enum rb_status find_depths(struct rb_world *world, struct rb_cohort *cohort,
                                  struct rb_depths *found, struct rb_error *err)
{
	const struct rb_stepped *s = world->stepped;

	rb_candidates_place(cohort->candidates, world, cohort->body, cohort->body_count);
	return rb_depths_find(world, cohort->candidates, s->bad_count > 0 ? s->bad : NULL, NULL,
	                      found, err);
}

enum rb_status rb_projection_close(struct rb_world *world, struct rb_cohort *cohort,
                                   struct rb_depths *found, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	const bool all = cohort == &s->all;
	struct search search = {.world = world,
	                        .cohort = cohort,
	                        .body = all ? s->body : cohort->body,
	                        .count = all ? s->member_count : cohort->member_count};
	enum rb_status status = RB_OK;

	if (cohort->has_depths && s->bad_count == 0)
		*found = cohort->depths;
	else
		status = find_depths(world, cohort, found, err);
	struct rb_depths last = *found;
	if (status != RB_OK || found->deep_count == 0)
		return status;
	blame_unclosable(world, cohort, found);
	if (all_is_lost(s, cohort))
		return RB_OK;
	const rb_arena_mark here = rb_arena_here(&world->arena[0]);
	status = begin_search(&search, err);
	if (status == RB_OK)
		status = index_pairs(&search, err);
	if (status == RB_OK)
		status = rb_end_points_begin(&search.carried, world, cohort, err);
	if (status != RB_OK)
		return status;
	status = rb_projection_energy_begin(&search.lift, world, &cohort->points,
	                                    cohort->candidates->h_s, err);
	if (status == RB_OK)
		find_anchored(&search);
	search.waves_max = FIRST_WAVES;
	for (int round = 0; round < CLOSINGS_MAX && status == RB_OK && last.deep_count > 0;
	     round++) {
		status = close_round(&search, &last, err);
		search.again = true;
		search.waves_max *= 2;
		/* nothing to move: each overlapping group has a bad body */
		if (status == RB_OK && s->closing.count == 0)
			break;
		world->frame_counts.closings++;
		if (status == RB_OK)
			status = find_depths_again(&search, &last, err);
	}
	give_velocities(&search);
	if (status == RB_OK)
		status = rb_projection_energy_pay(
			&search.lift, world,
			paying_parts * cohort->candidates->h_s <= s->solver.whole_s, err);
	if (status == RB_OK && search.lift.has_momentum_change)
		status = rb_projection_impulses(world, cohort, search.lift.momentum_change, err);
	for (size_t k = 0; k < last.deep_count; k++)
		blame(world, &last.deep[k]);
	if (last.deep_count > 0 || s->bad_count == 0)
		*found = last;
	else
		found->max = fmax(found->max, last.max);
	if (found->deep_count == 0) /* `found` then holds nothing in the arena */
		rb_arena_back(&world->arena[0], here);
	return status;
}
