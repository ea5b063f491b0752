/* SPDX-License-Identifier: MIT */
/*
 * Broad phase with enlarged boxes (Verlet lists): boxes have a margin that should last some steps,
 * and pairs are searched again only when a body could leave its box. For shapes of several convex
 * parts the list also caches, per pair of parts, a separating axis and a lower bound of the
 * distance, together with the path of each body since.
 *
 * Margins trade the cost of a search against the number of false pairs. Where few bodies move
 * (`share`), boxes last longer, up to the body's size.
 */
#include "stepped/candidates.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "geom/distance.h"
#include "model/joints.h"
#include "model/parts.h"

enum {
	STEPS_PER_BOX = 8, /* steps that a box should last */
	BOXES_MAX = 8,     /* factor of these, up to the body's size, where hardly any body moves */
	FAST_STEPS_PER_BOX = 2, /* for bodies that move farther than their size in STEPS_PER_BOX */
	BODIES_PER_BLOCK = 512
};

/* rad: margin of planes that do not rotate yet; decides cost only. */
static const double turn_margin_min = 1.0 / 64;

/*
 * Adds to `path` an upper bound of how far any point of a body has moved. Rotation by t moves a
 * point at distance r by 2 r sin(t / 2); the difference of the quaternions has length 2 sin(t / 4)
 * >= sin(t / 2), hence 2 r |dq|. 1e-9 and the ulp cover rounding, so that the bound stays a bound.
 */
static void add_path(struct rb_candidates *candidates, int i, rb_vec3 to, rb_quat turn)
{
	const rb_vec3 from = candidates->at[i], displacement = rb_vec3_sub(to, from);
	const rb_quat q = candidates->turn[i];
	const double w = turn.w - q.w, x = turn.x - q.x, y = turn.y - q.y, z = turn.z - q.z;
	const double square = w * w + x * x + y * y + z * z;

	RB_ASSERT_COSTLY(i >= 0 && !(candidates->path[i] < 0)); /* NaN: of an attempt that fails */
	candidates->turn[i] = turn;
	/* also where the square of the rotation underflows */
	candidates->placing[i] = (candidates->placing[i] + 1) & RB_PLACING_MAX;
	if (square > 0)
		candidates->path[i] += 2 * candidates->size[i] * sqrt(square) * (1 + 1e-9);
	if (displacement.x != 0 || displacement.y != 0 || displacement.z != 0)
		candidates->path[i] += rb_vec3_length(displacement) * (1 + 1e-9) +
		                       4 * DBL_EPSILON * (fabs(to.x) + fabs(to.y) + fabs(to.z));
}

/* World pose of every convex part of a body. */
static void place(struct rb_candidates *candidates, const struct rb_model *model, int i,
                  rb_vec3 origin, rb_quat orientation)
{
	const struct rb_body_parts *parts = rb_model_parts(model, i);
	rb_placed *placed = candidates->placed + candidates->first_part[i];

	if (i < model->body_count) {
		/* bitwise unchanged since the last placement; before the first there is none */
		if (memcmp(&candidates->at[i], &origin, sizeof origin) == 0 &&
		    memcmp(&candidates->turn[i], &orientation, sizeof orientation) == 0)
			return;
		add_path(candidates, i, origin, orientation);
	}
	candidates->at[i] = origin;
	for (int k = 0; k < parts->count; k++)
		placed[k] = rb_body_part_place(&parts->part[k], origin, orientation);
}

/* False: no memory. */
static bool take_parts(struct rb_candidates *candidates, const struct rb_model *model)
{
	const int count = model->body_count + model->static_count;
	int parts = 0;

	if (!model->parts)
		return true;
	candidates->first_part = rb_memory_take((size_t)count + 1, sizeof *candidates->first_part);
	if (!candidates->first_part)
		return false;
	for (int i = 0; i < count; i++) {
		candidates->first_part[i] = parts;
		parts += rb_model_parts(model, i)->count;
	}
	candidates->first_part[count] = parts;
	candidates->placed = rb_memory_take((size_t)parts, sizeof *candidates->placed);
	candidates->ahead = rb_memory_take((size_t)count, sizeof *candidates->ahead);
	candidates->turn = rb_memory_take((size_t)model->body_count, sizeof *candidates->turn);
	candidates->path = rb_memory_take((size_t)count, sizeof *candidates->path);
	candidates->placing = rb_memory_take((size_t)count, sizeof *candidates->placing);
	candidates->at = rb_memory_take((size_t)count, sizeof *candidates->at);
	candidates->size = rb_memory_take((size_t)count, sizeof *candidates->size);
	if (!candidates->placed || !candidates->ahead || !candidates->turn || !candidates->path ||
	    !candidates->placing || !candidates->at || !candidates->size)
		return false;
	for (int i = 0; i < count; i++)
		candidates->size[i] = model->shape[i].kind == RB_SHAPE_PLANE
		                              ? (double)INFINITY
		                              : rb_candidates_size(model, i);
	for (int i = model->body_count; i < count; i++)
		place(candidates, model, i, model->position[i], model->orientation[i]);
	return true;
}

enum rb_status rb_candidates_create(struct rb_candidates *candidates, const struct rb_model *model,
                                    struct rb_error *err)
{
	const size_t n = (size_t)model->body_count;

	*candidates = (struct rb_candidates){.share = 1};
	candidates->built_at = rb_memory_take(n, sizeof *candidates->built_at);
	candidates->margin = rb_memory_take(n, sizeof *candidates->margin);
	candidates->reach = rb_memory_take(n, sizeof *candidates->reach);
	if (model->driven) {
		candidates->built_turn = rb_memory_take(n, sizeof *candidates->built_turn);
		candidates->turn_margin = rb_memory_take(n, sizeof *candidates->turn_margin);
	}
	if ((!model->driven || (candidates->built_turn && candidates->turn_margin)) &&
	    candidates->built_at && candidates->margin && candidates->reach &&
	    take_parts(candidates, model))
		return RB_OK;
	rb_candidates_release(candidates);
	return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the boxes of %zu bodies", n);
}

void rb_candidates_release(struct rb_candidates *candidates)
{
	rb_memory_free(candidates->built_at);
	rb_memory_free(candidates->margin);
	rb_memory_free(candidates->reach);
	rb_memory_free(candidates->built_turn);
	rb_memory_free(candidates->turn_margin);
	rb_memory_free(candidates->own_depth);
	rb_memory_free(candidates->own_clearance);
	rb_memory_free(candidates->cache);
	rb_memory_free(candidates->own_first_cache);
	rb_memory_free(candidates->first_part);
	rb_memory_free(candidates->placed);
	rb_memory_free(candidates->turn);
	rb_memory_free(candidates->path);
	rb_memory_free(candidates->placing);
	rb_memory_free(candidates->at);
	rb_memory_free(candidates->size);
	rb_memory_free(candidates->ahead);
	rb_memory_free(candidates->own);
	*candidates = (struct rb_candidates){0};
}

double rb_candidates_displacement(const struct rb_world *world, const struct rb_state *state, int i,
                                  double h)
{
	const struct rb_model *model = world->model;
	double distance = rb_vec3_length(rb_world_row3(state->velocity, i)) * h;

	RB_ASSERT_COSTLY(h >= 0);
	if (model->center_of_mass && state->spin)
		distance += rb_vec3_length(model->center_of_mass[i]) *
		            fmin(2, rb_vec3_length(rb_world_row3(state->spin, i)) * h);
	return distance;
}

/* Distance of the origin from where the box was built, m. */
static inline double from_built(const struct rb_candidates *candidates,
                                const struct rb_world *world, int i)
{
	return rb_vec3_length(
		rb_vec3_sub(rb_world_origin_at(world, &world->state, i), candidates->built_at[i]));
}

double rb_candidates_size(const struct rb_model *model, int i)
{
	const struct rb_shape *shape = &model->shape[i];

	return shape->kind == RB_SHAPE_RECTANGLE ? 0.5 * hypot(shape->size[0], shape->size[1])
	                                         : rb_model_reach(model, i);
}

/* ---- driven bodies ---- */

static bool is_plane(const struct rb_model *model, int i)
{
	return i < model->body_count && model->shape[i].kind == RB_SHAPE_PLANE;
}

/* Bound of a driven plane's rotation in the step, rad. */
static double turn_ahead(const struct rb_candidates *candidates, const struct rb_world *world,
                         int i)
{
	if (!world->state.spin)
		return 0;
	return candidates->h_s * fmax(rb_vec3_length(rb_world_row3(world->state.spin, i)),
	                              rb_vec3_length(rb_world_row3(world->mark.spin, i)));
}

/* Upper bound of a driven plane's rotation since the boxes were built, rad. */
static double turned(const struct rb_candidates *candidates, const struct rb_world *world, int i)
{
	static const double pi = 3.14159265358979323846;
	const rb_quat q = candidates->built_turn[i];
	const rb_quat now = rb_world_orientation_at(world, &world->state, i);
	const double w = now.w - q.w, x = now.x - q.x, y = now.y - q.y, z = now.z - q.z;

	/* |dq| = 2 sin(t / 4) >= t / pi for t <= 2 pi */
	return pi * sqrt(w * w + x * x + y * y + z * z);
}

/*
 * False if body i is a driven plane that has rotated beyond its margin, or would in the step if it
 * is not `over`. Few bodies are planes; scenes without driven bodies skip this (built_turn).
 */
static bool is_turn_within(const struct rb_candidates *candidates, const struct rb_world *world,
                           int i, bool over)
{
	if (!is_plane(world->model, i))
		return true;
	const double ahead = over ? 0 : turn_ahead(candidates, world, i);

	/* written so that NaN requires new boxes */
	return turned(candidates, world, i) + ahead <= candidates->turn_margin[i];
}

/*
 * Whether a driven plane may reach a body while both stay within their margins. The plane rotates
 * about its origin, so that a body at distance r from there comes nearer by at most r times the
 * angle. NaN counts as within reach.
 */
static bool is_in_reach(const struct rb_candidates *candidates, int i, int plane)
{
	const rb_vec3 from = rb_vec3_sub(candidates->built_at[i], candidates->built_at[plane]);
	const double half = 0.5 * (candidates->box[i].high.x - candidates->box[i].low.x);
	const double gap = rb_vec3_dot(from, rb_plane_normal(candidates->built_turn[plane])) - half;
	const double far = rb_vec3_length(from) + half + candidates->margin[plane];
	const double rounding = 16 * DBL_EPSILON *
	                        fmax(rb_vec3_max_abs(candidates->built_at[i]),
	                             rb_vec3_max_abs(candidates->built_at[plane]));

	return !(gap >
	         (candidates->margin[plane] + candidates->turn_margin[plane] * far) * (1 + 1e-9) +
	                 rounding);
}

static bool may_touch(const struct rb_model *model, int a, int b)
{
	RB_ASSERT_COSTLY(a >= 0 && b >= 0);
	if (rb_model_joined(model, a, b))
		return false;
	return !model->group_bit || ((model->collides[a] & model->group_bit[b]) != 0 &&
	                             (model->collides[b] & model->group_bit[a]) != 0);
}

/*
 * Puts the dynamic body first. False: neither is dynamic, or one is a driven plane: planes have no
 * boxes, and order_pairs adds their pairs.
 */
static bool dynamic_first(const struct rb_model *model, struct rb_pair *pair)
{
	RB_ASSERT_COSTLY(pair->a >= 0 && pair->a < pair->b);
	if (is_plane(model, pair->a) || is_plane(model, pair->b))
		return false;
	if (model->driven[pair->a])
		*pair = (struct rb_pair){pair->b, pair->a};
	return pair->a < model->body_count && !model->driven[pair->a];
}

/*
 * Sorts pairs by the first body (counting sort), and adds those of driven planes and dynamic
 * bodies: those within reach, or all where boxes have no margins.
 */
static enum rb_status order_pairs(struct rb_candidates *candidates, const struct rb_world *world,
                                  bool all, struct rb_error *err)
{
	const struct rb_model *model = world->model;
	const int n = model->body_count;
	struct rb_arena *arena = &world->arena[0];
	size_t *first = rb_arena_take(arena, (size_t)n + 1, sizeof *first), count = 0;
	int *plane = rb_arena_take(arena, (size_t)n, sizeof *plane), planes = 0;

	if (!first || !plane)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the pairs of %d bodies", n);
	memset(first, 0, ((size_t)n + 1) * sizeof *first);
	for (int i = 0; i < n; i++)
		if (is_plane(model, i))
			plane[planes++] = i;
	for (size_t k = 0; k < candidates->pair_count; k++) {
		struct rb_pair pair = candidates->pair[k];

		if (dynamic_first(model, &pair))
			first[pair.a + 1]++;
	}
	for (int i = 0; i < n; i++) {
		for (int k = 0; k < planes && !model->driven[i]; k++)
			first[i + 1] += may_touch(model, i, plane[k]) &&
			                (all || is_in_reach(candidates, i, plane[k]));
		first[i + 1] += first[i];
	}
	count = first[n];
	if (!rb_memory_reserve(&candidates->own, &candidates->own_capacity, count + 1,
	                       sizeof *candidates->own))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu pairs", count);
	for (size_t k = 0; k < candidates->pair_count; k++) {
		struct rb_pair pair = candidates->pair[k];

		if (dynamic_first(model, &pair))
			candidates->own[first[pair.a]++] = pair;
	}
	for (int i = 0; i < n; i++)
		for (int k = 0; k < planes && !model->driven[i]; k++)
			if (may_touch(model, i, plane[k]) &&
			    (all || is_in_reach(candidates, i, plane[k])))
				candidates->own[first[i]++] = (struct rb_pair){i, plane[k]};
	candidates->pair = candidates->own;
	candidates->pair_count = count;
	return RB_OK;
}

/* ---- caches and search ---- */

static size_t caches_of(const struct rb_candidates *candidates, struct rb_pair pair)
{
	return (size_t)rb_candidates_part_count(candidates, pair.a) *
	       (size_t)rb_candidates_part_count(candidates, pair.b);
}

void rb_candidates_add_caches(struct rb_candidates *candidates, size_t k)
{
	const size_t count = caches_of(candidates, candidates->pair[k]);
	const uint32_t at = __atomic_fetch_add(&candidates->cache_count, (uint32_t)count,
	                                       __ATOMIC_RELAXED);

	RB_ASSERT_COSTLY(at + count <= candidates->cache_capacity);
	memset(candidates->cache + at, 0, count * sizeof *candidates->cache);
	candidates->first_cache[k] = at;
}

enum rb_status rb_candidates_forget(struct rb_candidates *candidates, const struct rb_model *model,
                                    struct rb_error *err)
{
	size_t count = 0;

	candidates->live = NULL;
	candidates->resting_depth = (double)NAN;
	if (candidates->pair_count > UINT32_MAX ||
	    !rb_memory_reserve(&candidates->own_depth, &candidates->depth_capacity,
	                       candidates->pair_count + 1, sizeof *candidates->own_depth))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu candidate pairs",
		               candidates->pair_count);
	for (size_t k = 0; k < candidates->pair_count; k++)
		candidates->own_depth[k] = NAN;
	candidates->depth = candidates->own_depth;
	if (!candidates->placed)
		return RB_OK;
	if (!rb_memory_reserve(&candidates->own_clearance, &candidates->bounds_capacity,
	                       candidates->pair_count + 1, sizeof *candidates->own_clearance))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu candidate pairs",
		               candidates->pair_count);
	for (size_t k = 0; k < candidates->pair_count; k++)
		candidates->own_clearance[k] = -(double)INFINITY;
	candidates->clearance = candidates->own_clearance;
	if (!rb_memory_reserve(&candidates->own_first_cache, &candidates->first_cache_capacity,
	                       candidates->pair_count + 1, sizeof *candidates->own_first_cache))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu candidate pairs",
		               candidates->pair_count);
	for (size_t k = 0; k < candidates->pair_count; k++) {
		const bool terrain = rb_candidates_is_terrain(model, candidates->pair[k].b);

		candidates->own_first_cache[k] = terrain ? 0 : RB_NO_CACHES;
		if (!terrain)
			count += caches_of(candidates, candidates->pair[k]);
	}
	if (count >= RB_NO_CACHES ||
	    !rb_memory_reserve(&candidates->cache, &candidates->cache_capacity, count + 1,
	                       sizeof *candidates->cache))
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu candidate parts", count);
	candidates->cache_count = 0;
	candidates->first_cache = candidates->own_first_cache;
	return RB_OK;
}

/*
 * What was known of pairs before a search: distances, and caches of those that may touch in a step.
 * All in the arena.
 */
struct earlier {
	struct rb_pair *pair;
	size_t count;
	double *clearance;
	uint32_t *first_cache;
	struct rb_axis_cache *cache; /* in the order of pairs */
};

/* Whether the caches of a pair are worth keeping. */
static bool has_caches(const struct rb_candidates *candidates, const struct rb_model *model,
                       size_t k)
{
	const struct rb_pair pair = candidates->pair[k];
	const double path = candidates->path[pair.a] + candidates->path[pair.b];
	const double ahead = candidates->ahead[pair.a] + candidates->ahead[pair.b] +
	                     model->stepped_tolerance_m;

	return candidates->first_cache[k] != RB_NO_CACHES &&
	       !rb_candidates_is_terrain(model, pair.b) &&
	       !(candidates->clearance[k] - path > ahead);
}

/* False: no memory. */
static bool take_earlier(struct earlier *earlier, const struct rb_candidates *candidates,
                         const struct rb_model *model, struct rb_arena *arena)
{
	const size_t count = candidates->placed ? candidates->pair_count : 0;
	uint32_t caches = 0;

	*earlier = (struct earlier){.count = count};
	if (count == 0)
		return true;
	earlier->pair = rb_arena_take(arena, count, sizeof *earlier->pair);
	earlier->clearance = rb_arena_take(arena, count, sizeof *earlier->clearance);
	earlier->first_cache = rb_arena_take(arena, count, sizeof *earlier->first_cache);
	earlier->cache = rb_arena_take(arena, candidates->cache_count, sizeof *earlier->cache);
	if (!earlier->pair || !earlier->clearance || !earlier->first_cache || !earlier->cache)
		return false;
	memcpy(earlier->pair, candidates->pair, count * sizeof *earlier->pair);
	memcpy(earlier->clearance, candidates->clearance, count * sizeof *earlier->clearance);
	for (size_t k = 0; k < count; k++) {
		earlier->first_cache[k] = RB_NO_CACHES;
		if (!has_caches(candidates, model, k))
			continue;
		const size_t number = caches_of(candidates, candidates->pair[k]);
		memcpy(earlier->cache + caches, candidates->cache + candidates->first_cache[k],
		       number * sizeof *earlier->cache);
		earlier->first_cache[k] = caches;
		caches += (uint32_t)number;
	}
	return true;
}

static bool precedes(struct rb_pair p, struct rb_pair q)
{
	return p.a != q.a ? p.a < q.a : p.b < q.b;
}

/*
 * Gives the caches of pairs found again back. Pairs are in order but for driven planes; of one that
 * is not found less is known, which costs time only.
 */
static void give_earlier(const struct earlier *earlier, struct rb_candidates *candidates)
{
	size_t at = 0;

	for (size_t k = 0; k < candidates->pair_count; k++) {
		const struct rb_pair pair = candidates->pair[k];

		while (at < earlier->count && precedes(earlier->pair[at], pair))
			at++;
		if (at == earlier->count)
			break;
		if (precedes(pair, earlier->pair[at]))
			continue;
		candidates->own_clearance[k] = earlier->clearance[at];
		if (earlier->first_cache[at] == RB_NO_CACHES)
			continue;
		const size_t number = caches_of(candidates, pair);
		memcpy(candidates->cache + candidates->cache_count,
		       earlier->cache + earlier->first_cache[at],
		       number * sizeof *candidates->cache);
		candidates->own_first_cache[k] = candidates->cache_count;
		candidates->cache_count += (uint32_t)number;
	}
}

/* Allocates the boxes of a search; `search` frees them. */
static enum rb_status begin_search(struct rb_candidates *candidates, struct rb_world *world,
                                   struct rb_error *err)
{
	const size_t n = (size_t)world->model->body_count;

	candidates->box = rb_arena_take(&world->arena[0], n, sizeof *candidates->box);
	return candidates->box
	               ? RB_OK
	               : RB_FAIL(err, RB_ERR_MEMORY, "no memory for the boxes of %zu bodies", n);
}

/*
 * Runs the broad phase and clears all caches by pair, but for what is kept; resets the arena to the
 * mark.
 */
static enum rb_status search(struct rb_candidates *candidates, struct rb_world *world, bool all,
                             const struct earlier *earlier, rb_arena_mark here,
                             struct rb_error *err)
{
	enum rb_status status = rb_broadphase_find(world->broadphase, candidates->box,
	                                           &candidates->pair, &candidates->pair_count, err);

	if (status == RB_OK && world->model->driven)
		status = order_pairs(candidates, world, all, err);
	candidates->box = NULL;
	if (status == RB_OK)
		status = rb_candidates_forget(candidates, world->model, err);
	if (status == RB_OK)
		give_earlier(earlier, candidates);
	else
		candidates->pair_count = 0; /* nothing is known of these */
	rb_arena_back(&world->arena[0], here);
	return status;
}

enum rb_status rb_candidates_pairs(struct rb_candidates *candidates, struct rb_world *world,
                                   const rb_aabb *bounds, struct rb_error *err)
{
	const struct rb_model *model = world->model;
	const rb_arena_mark here = rb_arena_here(&world->arena[0]);
	const enum rb_status status = begin_search(candidates, world, err);
	const struct earlier none = {.count = 0};

	if (status != RB_OK)
		return status;
	for (int i = 0; i < model->body_count; i++) {
		const rb_vec3 low = bounds[i].low, high = bounds[i].high;
		/* with the rounding of coordinates */
		const double half = (rb_candidates_size(model, i) + model->stepped_tolerance_m) *
		                            (1 + 1e-12) +
		                    4 * DBL_EPSILON *
		                            fmax(rb_vec3_max_abs(low), rb_vec3_max_abs(high));

		candidates->box[i] = (rb_aabb){{low.x - half, low.y - half, low.z - half},
		                               {high.x + half, high.y + half, high.z + half}};
	}
	return search(candidates, world, true, &none, here, err);
}

/* Builds new boxes around the present positions and searches for pairs. */
static enum rb_status build(struct rb_candidates *candidates, struct rb_world *world,
                            struct rb_error *err)
{
	const struct rb_model *model = world->model;
	const double lasting = STEPS_PER_BOX * fmin(BOXES_MAX, 1 / candidates->share);
	const rb_arena_mark here = rb_arena_here(&world->arena[0]);
	enum rb_status status = begin_search(candidates, world, err);
	double mean = 0;

	candidates->valid = false;
	if (status != RB_OK)
		return status;
	for (int i = 0; i < model->body_count; i++)
		mean += candidates->reach[i] / model->body_count;
	for (int i = 0; i < model->body_count; i++) {
		const rb_vec3 c = rb_world_origin_at(world, &world->state, i);
		const double size = rb_candidates_size(model, i);

		candidates->built_at[i] = c;
		/*
		 * a body at rest accelerates by the forces of each step: its margin is at least
		 * that of an average body
		 */
		double margin = STEPS_PER_BOX * fmax(candidates->reach[i], mean);
		/* the number of pairs grows with the third power of the margin */
		if (size > 0)
			margin = fmin(margin,
			              fmax(size, FAST_STEPS_PER_BOX * candidates->reach[i]));
		candidates->margin[i] = fmax(margin, fmin(lasting * candidates->reach[i], size)) +
		                        size / 64;
		if (is_plane(model, i)) {
			candidates->built_turn[i] = rb_world_orientation_at(world, &world->state,
			                                                    i);
			candidates->turn_margin[i] = STEPS_PER_BOX *
			                                     turn_ahead(candidates, world, i) +
			                             turn_margin_min;
		}
		const double half = (size + candidates->margin[i] + model->stepped_tolerance_m) *
		                    (1 + 1e-12);
		candidates->box[i] = (rb_aabb){{c.x - half, c.y - half, c.z - half},
		                               {c.x + half, c.y + half, c.z + half}};
	}
	struct earlier earlier;
	if (!take_earlier(&earlier, candidates, model, &world->arena[0])) {
		candidates->box = NULL;
		rb_arena_back(&world->arena[0], here);
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu candidate pairs",
		               candidates->pair_count);
	}
	status = search(candidates, world, false, &earlier, here, err);
	candidates->valid = status == RB_OK;
	return status;
}

bool rb_candidates_keep(struct rb_candidates *candidates)
{
	if (candidates->pair == candidates->own || candidates->pair_count == 0)
		return true;
	if (!rb_memory_reserve(&candidates->own, &candidates->own_capacity, candidates->pair_count,
	                       sizeof *candidates->own))
		return false;
	memcpy(candidates->own, candidates->pair, candidates->pair_count * sizeof *candidates->own);
	candidates->pair = candidates->own;
	return true;
}

/* A pass over bodies. */
struct bodies {
	struct rb_candidates *candidates;
	const struct rb_candidates *known; /* the same, of passes that change nothing */
	const struct rb_world *world;
	const int *body;
	double h_s;
	bool over;    /* positions are those at the end of the step */
	bool outside; /* some body is outside, or may get there; written by all workers */
};

static void find_reach(void *user, size_t first, size_t end)
{
	const struct bodies *bodies = user;
	const struct rb_world *world = bodies->world;

	for (size_t k = first; k < end; k++) {
		const int i = bodies->body[k];
		const double reach = fmax(
			rb_candidates_displacement(world, &world->state, i, bodies->h_s),
			rb_candidates_displacement(world, &world->mark, i, bodies->h_s));

		/* a body that is not finite is lost, and must not enlarge the boxes of others */
		bodies->candidates->reach[i] = isfinite(reach) ? reach : 0;
	}
}

void rb_candidates_reach(struct rb_candidates *candidates, const struct rb_world *world, double h,
                         const int *member, int count)
{
	struct bodies bodies = {.candidates = candidates, .world = world, .body = member, .h_s = h};

	RB_ASSERT(h > 0 && count >= 0);
	candidates->h_s = h;
	rb_team_share(world->team, (size_t)count, BODIES_PER_BLOCK, find_reach, &bodies);
}

static void find_outside(void *user, size_t first, size_t end)
{
	struct bodies *bodies = user;
	const struct rb_candidates *known = bodies->known;

	bool inside = !__atomic_load_n(&bodies->outside, __ATOMIC_RELAXED);

	if (!inside)
		return;
	for (size_t k = first; k < end && inside; k++) {
		const int i = bodies->body[k];
		const double ahead = bodies->over ? 0 : known->reach[i];

		/* written so that NaN requires new boxes */
		inside = from_built(known, bodies->world, i) + ahead <= known->margin[i] &&
		         (!known->built_turn ||
		          is_turn_within(known, bodies->world, i, bodies->over));
	}
	if (!inside)
		__atomic_store_n(&bodies->outside, true, __ATOMIC_RELAXED);
}

static bool is_inside(const struct rb_candidates *candidates, const struct rb_world *world,
                      const int *body, int count, bool over)
{
	struct bodies bodies = {.known = candidates, .world = world, .body = body, .over = over};

	rb_team_share(world->team, (size_t)count, BODIES_PER_BLOCK, find_outside, &bodies);
	return !bodies.outside;
}

enum rb_status rb_candidates_find(struct rb_candidates *candidates, struct rb_world *world,
                                  const int *body, int count, struct rb_error *err)
{
	candidates->valid = candidates->valid && is_inside(candidates, world, body, count, false);
	return candidates->valid ? RB_OK : build(candidates, world, err);
}

bool rb_candidates_holds(const struct rb_candidates *candidates, const struct rb_world *world,
                         const int *body, int count)
{
	return is_inside(candidates, world, body, count, true);
}

/* ---- parts ---- */

struct places {
	struct rb_candidates *candidates;
	struct rb_world *world;
	const int *body;
	int count;
};

/* How far rotation may move a point of the body within h, m: at most the diameter. */
static double turn_reach(const struct rb_world *world, int i, double h)
{
	if (!world->state.spin)
		return 0;
	const double spin = fmax(rb_vec3_length(rb_world_row3(world->state.spin, i)),
	                         rb_vec3_length(rb_world_row3(world->mark.spin, i)));
	return fmin(2, h * spin) * rb_model_reach(world->model, i);
}

void rb_candidates_turn(struct rb_candidates *candidates, const struct rb_world *world, int i)
{
	if (candidates->ahead)
		candidates->ahead[i] = candidates->reach[i] + turn_reach(world, i, candidates->h_s);
}

static void place_block(void *user, int block, int worker)
{
	const struct places *places = user;
	const struct rb_world *world = places->world;
	const int first = block * BODIES_PER_BLOCK;
	const int end = first + BODIES_PER_BLOCK < places->count ? first + BODIES_PER_BLOCK
	                                                         : places->count;

	(void)worker;
	for (int k = first; k < end; k++) {
		struct rb_candidates *candidates = places->candidates;
		const int i = places->body[k];

		place(candidates, world->model, i, rb_world_origin_at(world, &world->state, i),
		      rb_world_orientation_at(world, &world->state, i));
		rb_candidates_turn(candidates, world, i);
	}
}

void rb_candidates_place(struct rb_candidates *candidates, struct rb_world *world, const int *body,
                         int count)
{
	struct places places = {candidates, world, body, count};

	if (candidates->placed)
		rb_team_run(world->team, (count + BODIES_PER_BLOCK - 1) / BODIES_PER_BLOCK,
		            place_block, &places);
}
