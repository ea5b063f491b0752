/* SPDX-License-Identifier: MIT */
#include "stepped/contact_points.h"

#include <string.h>

#include "base/memory.h"
#include "constraint/contact_row.h"
#include "geom/boxes.h"
#include "geom/distance.h"
#include "geom/manifold.h"
#include "model/parts.h"
#include "step/gap.h"
#include "stepped/internal_edges.h"
#include "stepped/pivot.h"
#include "stepped/rolling.h"
#include "stepped/clearance.h"
#include "stepped/step_closing.h"
#include "stepped/pair_motion.h"

RB_FIELDS_DEFINE(rb_named_impulse_fields, struct rb_named_impulse, RB_NAMED_IMPULSE_FIELDS);

enum rb_status rb_step_points_create(struct rb_step_points *points, const struct rb_model *model,
                                     struct rb_error *err)
{
	*points = (struct rb_step_points){.joins_arms = rb_levers_matter(model),
	                                  .body_count = model->body_count};
	points->first_last = rb_memory_take((size_t)model->body_count + 1,
	                                    sizeof *points->first_last);
	points->held = rb_memory_take((size_t)model->body_count + 1, 1);
	if (!points->first_last || !points->held)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the contacts of %d bodies",
		               model->body_count);
	return RB_OK;
}

void rb_step_points_release(struct rb_step_points *points)
{
	rb_memory_free(points->row);
	rb_memory_free(points->chosen);
	rb_memory_free(points->last);
	rb_memory_free(points->first_last);
	rb_memory_free(points->held);
	*points = (struct rb_step_points){0};
}

/* ---- one pair ---- */

/* A filled buffer of a block's points. */
struct piece {
	const struct rb_step_point *row;
	size_t count;
	const struct piece *before;
};

/* Input that workers share, read only, then the state of the block that one of them inspects. */
struct inspection {
	struct rb_world *world;
	const struct rb_step_points *points;
	/* cached axes of the pairs of a block are written by its worker */
	struct rb_candidates *candidates;
	double h, max; /* s; m: largest gap of a point */
	size_t pair;   /* the inspected one */
	/* the block's */
	struct rb_step_point *out;
	size_t count, capacity;
	const struct piece *full; /* full buffers before `out`, the last first */
	size_t all;               /* points, including those in `full` */
	size_t place;             /* index of the block's first point among all */
	struct rb_arena *arena;
	bool in_place; /* the first buffer is the final place of the points */
	bool failed;
};

/* Capacity of a block's first buffer, points: of fast bodies few pairs touch. */
enum { BLOCK_POINTS = 16 };

/* Starts a buffer of twice the size; earlier points stay in place. */
static bool add_piece(struct inspection *inspection)
{
	const size_t capacity = inspection->all ? 2 * inspection->all : BLOCK_POINTS;
	struct rb_step_point *out = rb_arena_take(inspection->arena, capacity, sizeof *out);
	struct piece *full = rb_arena_take(inspection->arena, 1, sizeof *full);

	if (!out || !full)
		return false;
	*full = (struct piece){inspection->out, inspection->count, inspection->full};
	if (inspection->count > 0)
		inspection->full = full;
	else
		inspection->in_place = false;
	inspection->out = out;
	inspection->capacity = capacity;
	inspection->count = 0;
	return true;
}

/*
 * Adds a point of a pair, without name or arms yet; NULL: no memory. Field by field: compilers
 * clear a compound literal by an instruction that takes longer than all else about a point.
 */
static struct rb_step_point *add_point(struct inspection *inspection, struct rb_pair pair,
                                       rb_vec3 normal, double gap)
{
	if (inspection->count == inspection->capacity && !add_piece(inspection)) {
		inspection->failed = true;
		return NULL;
	}
	inspection->all++;
	struct rb_step_point *const point = &inspection->out[inspection->count++];

	point->a = pair.a;
	point->b = pair.b;
	point->parts = 0;
	point->central = point->rolls = point->rolls_to = point->after_impact = false;
	point->key = 0;
	point->normal = normal;
	point->arm_a = point->arm_b = point->lever = (rb_vec3){0, 0, 0};
	point->gap = gap;
	point->bend = 0;
	return point;
}

/* Copies the points of a block to their final place, in order. */
static void gather(const struct inspection *inspection, struct rb_step_point *to)
{
	const struct piece last = {inspection->out, inspection->count, inspection->full};
	struct rb_step_point *end = to + inspection->all;

	for (const struct piece *piece = &last; piece; piece = piece->before) {
		end -= piece->count;
		if (piece->count > 0 && (piece->before || !inspection->in_place))
			memcpy(end, piece->row, piece->count * sizeof *end);
	}
}

/* 1 + index in `last` of this key at the point's parts; 0: none. */
static size_t find_key(const struct rb_step_points *points, const struct rb_step_point *point,
                       uint64_t key)
{
	const size_t end = points->last_count > 0 ? points->first_last[point->a + 1] : 0;

	for (size_t k = points->last_count > 0 ? points->first_last[point->a] : 0; k < end; k++) {
		const struct rb_named_impulse *last = &points->last[k];

		if (last->b == point->b && last->key == key && last->parts == point->parts)
			return k + 1;
	}
	return 0;
}

/*
 * 1 + index in `last` of the impulse from which a point starts: by its name, or, on a flat rim,
 * that which represents any of its points.
 */
static size_t find_last(const struct rb_step_points *points, const struct rb_step_point *point)
{
	const size_t found = find_key(points, point, point->key);
	const uint64_t rim = found > 0 ? 0 : rb_contact_key_all_round(point->key);

	return rim == 0 ? found : find_key(points, point, rim);
}

/* Sets material, approach and warm-start impulse of a point whose position is known. */
static void fill_point(const struct inspection *inspection, struct rb_pair_motion *common,
                       struct rb_step_point *point)
{
	const struct rb_step_points *points = inspection->points;

	point->material = common->material;
	point->approach = common->approach;
	if (!point->central)
		point->approach += rb_vec3_dot(
			rb_vec3_sub(rb_vec3_cross(common->spin_a, point->arm_a),
		                    rb_vec3_cross(common->spin_b, point->arm_b)),
			point->normal);
	point->pair = (uint32_t)inspection->pair;
	point->normal_impulse = 0;
	point->friction_impulse = (rb_vec3){0, 0, 0};
	point->from = (uint32_t)find_last(points, point);
	if (point->from == 0)
		return;
	if (point->rolls) /* its velocity is that at the middle of the last step */
		point->approach += fmin(0, point->bend) / inspection->h;
	const struct rb_named_impulse *last = &points->last[point->from - 1];
	point->normal_impulse = inspection->h * last->force;
	if (point->material->friction == 0)
		return;
	point->friction_impulse = rb_pair_motion_turned(
		common, rb_vec3_scale(inspection->h, last->friction_impulse), point->normal);
}

/* A displacement beyond this share of the radius is followed to find the normal at the touch. */
static const double far_share = 0.1;
/* Iterations for it: where the path only grazes, each halves the distance; twice those of a gap. */
enum { APPROACH_ROUNDS = 32 };

/*
 * Gap of a sphere to another shape. One that moves far is measured where its path at present
 * velocities touches or comes closest: the tangent plane at the nearest point of the start would
 * stop it where it only passes.
 */
static struct rb_gap approaching(const struct inspection *inspection, struct rb_pair pair)
{
	const struct rb_world *world = inspection->world;
	const struct rb_state *state = &world->state;
	struct rb_gap g = rb_gap_of(world, state, pair.a, pair.b);
	const rb_vec3 d = rb_step_closing_displacement(world, pair, inspection->h);
	const double size = world->model->shape[pair.a].radius;
	double t = 0, closing;

	if (!(rb_vec3_dot(d, d) > far_share * far_share * size * size) || g.gap <= 0)
		return g;
	/*
	 * the distance is convex along a straight path: Newton's method approaches from one side
	 * without overshoot, until rounding of the path leaves it where it is
	 */
	const rb_vec3 origin = rb_world_origin_at(world, state, pair.a);
	for (int round = 0;; round++) {
		closing = -rb_vec3_dot(g.normal, d);
		const double next = t + (closing > 0 ? g.gap / closing : 1);

		if (round == APPROACH_ROUNDS || next >= 1 || next == t || g.gap <= 1e-12 * size)
			break;
		t = next;
		g = rb_gap_at(world, state, pair.a, rb_vec3_add_scaled(origin, -t, d), pair.b);
	}
	/* of a linear model from the start */
	g.gap += t * closing;
	return g;
}

/* Whether contacts had forces on a body in the last step; true for bodies that do not move. */
static bool is_held(const struct inspection *inspection, int i)
{
	const struct rb_model *model = inspection->world->model;

	return i >= model->body_count || !(model->inverse_mass[i] > 0) ||
	       inspection->points->held[i];
}

/*
 * Whether a sphere comes to the border of a finite plane from the side, as in
 * stepped/internal_edges: the plane separates them as long as forces do not move it through the
 * plane.
 */
static bool is_beside_border(const struct inspection *inspection, struct rb_pair pair)
{
	const struct rb_world *world = inspection->world;
	const struct rb_model *model = world->model;
	const double h = inspection->h, tolerance = model->stepped_tolerance_m;

	if (model->shape[pair.b].kind != RB_SHAPE_RECTANGLE)
		return false;
	const struct rb_gap g = rb_gap_of(world, &world->state, pair.a, pair.b);
	const rb_quat turn = pair.b < model->body_count
	                             ? rb_quat_from(world->state.orientation + 4 * (size_t)pair.b)
	                             : model->orientation[pair.b];
	const rb_vec3 origin = rb_world_origin_at(world, &world->state, pair.a);
	const rb_vec3 local = rb_quat_rotate_back(
		turn, rb_vec3_sub(origin, rb_world_origin_at(world, &world->state, pair.b)));
	const double *const size = model->shape[pair.b].size;

	if (fabs(local.x) <= 0.5 * size[0] && fabs(local.y) <= 0.5 * size[1])
		return false;
	const rb_vec3 up = rb_quat_rotate(turn, (rb_vec3){0, 0, local.z < 0 ? -1 : 1});
	const rb_vec3 low = rb_vec3_add_scaled(origin, -model->shape[pair.a].radius, up);
	const double height = fabs(local.z) - model->shape[pair.a].radius;
	const rb_vec3 arm_a = rb_vec3_sub(origin, rb_pair_motion_center(world, pair.a));
	const rb_vec3 arm_b = rb_vec3_sub(low, rb_pair_motion_center(world, pair.b));
	const rb_vec3 before = rb_vec3_sub(
		rb_pair_motion_velocity(world, &world->mark, pair.a, arm_a),
		rb_pair_motion_velocity(world, &world->mark, pair.b, arm_b));
	const rb_vec3 forced = rb_vec3_sub(
		rb_pair_motion_velocity(world, &world->state, pair.a, arm_a),
		rb_pair_motion_velocity(world, &world->state, pair.b, arm_b));
	const bool by_itself = height <= tolerance ||
	                       (is_held(inspection, pair.a) && is_held(inspection, pair.b));

	return height >= -tolerance && h * rb_vec3_dot(before, g.normal) > g.gap &&
	       height + h * rb_vec3_dot(by_itself ? before : forced, up) >= -tolerance;
}

/*
 * For two balls that move far: keeps the gap at the end of the step but takes the present line of
 * centres as normal, along which an impulse preserves their angular momentum.
 */
static void keep_present_normal(const struct inspection *inspection, struct rb_step_point *point)
{
	const struct rb_world *world = inspection->world;
	const struct rb_gap now = rb_gap_of(world, &world->state, point->a, point->b);
	const rb_vec3 d = rb_step_closing_displacement(world, (struct rb_pair){point->a, point->b},
	                                               inspection->h);

	if (!(rb_vec3_dot(now.normal, point->normal) > 0) || now.gap < 0)
		return;
	point->bend = point->gap + rb_vec3_dot(point->normal, d) - now.gap -
	              rb_vec3_dot(now.normal, d);
	point->gap = now.gap;
	point->normal = now.normal;
}

static void inspect_ball(struct inspection *inspection, struct rb_pair pair, double slack)
{
	const struct rb_world *world = inspection->world;
	const struct rb_model *model = world->model;

	if (model->shape[pair.b].kind == RB_SHAPE_SPHERE) { /* without a square root */
		const rb_vec3 d = rb_vec3_sub(rb_world_origin_at(world, &world->state, pair.b),
		                              rb_world_origin_at(world, &world->state, pair.a));
		const double max = model->shape[pair.a].radius + model->shape[pair.b].radius +
		                   slack;

		if (rb_vec3_dot(d, d) > max * max)
			return;
	}
	const struct rb_gap g = approaching(inspection, pair);
	if (!(g.gap <= slack) || is_beside_border(inspection, pair))
		return;
	struct rb_step_point *point = add_point(inspection, pair, g.normal, g.gap);
	if (!point)
		return;
	point->central = rb_levers_is_ball(world, pair.a) && rb_levers_is_ball(world, pair.b);
	const bool is_ball = model->shape[pair.b].kind == RB_SHAPE_SPHERE;
	const double radius_b = is_ball ? model->shape[pair.b].radius : 0;
	if (point->central && pair.b < model->body_count && inspection->points->joins_arms)
		keep_present_normal(inspection, point);
	if (point->central) {
		point->arm_a.x = model->shape[pair.a].radius;
		point->arm_b.x = -radius_b;
	} else {
		const rb_vec3 at = rb_world_origin_at(world, &world->state, pair.a);
		const rb_vec3 center = rb_pair_motion_center(world, pair.a);
		const rb_vec3 on_a = rb_vec3_add_scaled(at, model->shape[pair.a].radius, g.normal);

		point->arm_a = rb_vec3_sub(on_a, center);
		if (pair.b < model->body_count)
			point->arm_b = rb_vec3_sub(
				is_ball ? rb_vec3_add_scaled(
						  rb_world_origin_at(world, &world->state, pair.b),
						  -radius_b, g.normal)
					: rb_vec3_add_scaled(on_a, g.gap, g.normal),
				rb_pair_motion_center(world, pair.b));
		if (!is_ball) /* its centre of mass is not its centre, on a plane */
			point->bend = rb_rolling_bend_of_ball(
				world, pair.a, rb_vec3_sub(at, center), g.normal, inspection->h);
		point->rolls = point->bend != 0;
	}
	struct rb_pair_motion common = rb_pair_motion_of(world, inspection->h, pair.a, pair.b,
	                                                 point->normal, point->central);

	fill_point(inspection, &common, point);
}

/* Name with the lower index first, which may be that of a driven body. */
static struct rb_contact_name ordered_name(struct rb_pair pair, uint32_t parts, uint64_t key)
{
	const struct rb_contact_name name = {.a = pair.a, .b = pair.b, .parts = parts, .key = key};

	return pair.a < pair.b ? name : rb_contact_name_swapped(&name);
}

/* Largest distance of a point from the line along which a straight side touches, in radii. */
static const double beside_share = 1e-3;

/* Whether a point belongs to facet `j` of a terrain, and not to a facet that continues it. */
static bool is_real(const struct rb_model *model, int terrain, int j, const rb_manifold_point *at,
                    rb_vec3 normal, const rb_placed *other)
{
	const bool is_round = other->core->radius > 0 ||
	                      (rb_part)(at->key >> 32) >> 24 == RB_PART_MANTLE;
	const bool is_sphere = other->core->kind == RB_CORE_POLYTOPE &&
	                       other->core->polytope->vertex_count == 1;
	/* a wide band includes corners beside the line of a straight side */
	if (is_round && !is_sphere) {
		const rb_vec3 across = rb_vec3_cross(rb_placed_axis(other), normal);
		const double round = other->core->radius + other->core->round;
		if (fabs(rb_vec3_dot(across, rb_vec3_sub(at->on_b, other->at))) >
		    beside_share * round)
			return false;
	}
	const rb_quat turn = model->orientation[terrain];
	const rb_vec3 point = rb_quat_rotate_back(turn,
	                                          rb_vec3_sub(at->on_b, model->position[terrain]));
	const rb_vec3 axis = is_sphere ? (rb_vec3){0, 0, 0}
	                               : rb_quat_rotate_back(turn, rb_placed_axis(other));
	const struct rb_terrain *const facets = rb_model_parts(model, terrain)->terrain;

	/*
	 * of a straight part over a plane only corners are lowest, unless rounding has dropped one
	 */
	if (other->core->kind == RB_CORE_POLYTOPE &&
	    (rb_part)(at->key >> 32) >> 24 != RB_PART_VERTEX &&
	    rb_terrain_goes_on(facets, j, point) &&
	    rb_placed_corner_at(other, at->on_b, normal) < 0)
		return false;
	return rb_terrain_touch_is_real(facets, j, point,
	                                rb_quat_rotate_back(turn, rb_vec3_neg(normal)),
	                                is_round ? &axis : NULL);
}

static void add_manifold(struct inspection *inspection, struct rb_pair pair,
                         const rb_manifold *manifold, double slack, uint32_t parts,
                         const rb_placed *const placed[2])
{
	const struct rb_model *const model = inspection->world->model;
	const bool terrain = rb_candidates_is_terrain(model, pair.b);
	const rb_vec3 at_a = rb_pair_motion_center(inspection->world, pair.a),
		      at_b = rb_pair_motion_center(inspection->world, pair.b);
	struct rb_pair_motion common = rb_pair_motion_of(inspection->world, inspection->h, pair.a,
	                                                 pair.b, manifold->normal, false);

	for (int k = 0; k < manifold->count; k++) {
		const rb_manifold_point *at = &manifold->point[k];

		if (!(at->gap <= slack) ||
		    (terrain && !is_real(model, pair.b, (int)(parts & 0xffff), at, manifold->normal,
		                         placed[0])))
			continue;
		struct rb_step_point *point = add_point(inspection, pair, manifold->normal,
		                                        at->gap);
		if (!point)
			return;
		const struct rb_contact_name name = ordered_name(pair, parts, at->key);
		point->parts = name.parts;
		point->key = name.key;
		point->arm_a = rb_vec3_sub(at->on_a, at_a);
		/* opposite a's point: else the impulse would change the angular momentum */
		point->arm_b = rb_vec3_sub(rb_vec3_add_scaled(at->on_a, at->gap, manifold->normal),
		                           at_b);
		const struct rb_rolling rolling = {
			placed,        {pair.a, pair.b}, {point->arm_a, point->arm_b},
			point->normal, at->key,          inspection->h};
		point->bend = rb_rolling_bend(inspection->world, &rolling);
		point->rolls = point->bend != 0;
		fill_point(inspection, &common, point);
	}
}

/*
 * Largest gap of the points of a manifold, m: all that can close within `slack`; but on a driven,
 * rotating body only those that come near in its frame. Corners may move round by more than their
 * height, and corners one above the other would all count.
 */
static double band_of(const struct inspection *inspection, struct rb_pair pair, double slack)
{
	const struct rb_world *world = inspection->world;
	const struct rb_state *state = &world->state;
	const struct rb_model *model = world->model;

	if (pair.b >= model->body_count || !model->driven || !model->driven[pair.b] ||
	    !state->spin || rb_vec3_max_abs(rb_world_row3(state->spin, pair.b)) == 0)
		return slack;
	const double h = inspection->h, reach = rb_model_reach(model, pair.a);
	const rb_vec3 w = rb_world_row3(state->spin, pair.b);
	const rb_vec3 d = rb_vec3_sub(rb_world_row3(state->position, pair.a),
	                              rb_world_row3(state->position, pair.b));
	const rb_vec3 v = rb_vec3_sub(rb_world_row3(state->velocity, pair.a),
	                              rb_world_row3(state->velocity, pair.b));
	const rb_vec3 slide = rb_vec3_sub(v, rb_vec3_cross(w, d));
	const rb_vec3 turn = rb_vec3_sub(rb_world_row3(state->spin, pair.a), w);
	/* rotation of both in the rotating frame, and terms beyond the first order */
	const double angle = h * (rb_vec3_length(w) + rb_vec3_length(turn));
	const double travel = h * (rb_vec3_length(slide) + rb_vec3_length(turn) * reach) +
	                      0.5 * angle * angle * (rb_vec3_length(d) + reach);

	return fmin(slack, travel + model->stepped_tolerance_m);
}

/*
 * Motion of the first body of a pair during the step in the frame of the second; a part of it is at
 * `at`.
 */
static struct rb_internal_edge_motion relative(const struct inspection *inspection,
                                               const struct rb_state *state, struct rb_pair pair,
                                               rb_vec3 at)
{
	const struct rb_world *world = inspection->world;
	const rb_quat a = rb_pair_motion_turn(world, state, pair.a, inspection->h),
		      b = rb_pair_motion_turn(world, state, pair.b, inspection->h);
	const rb_vec3 arm = rb_quat_rotate(a,
	                                   rb_vec3_sub(at, rb_pair_motion_center(world, pair.a)));
	const rb_vec3 then = rb_vec3_add(
		rb_pair_motion_center_after(world, state, pair.a, inspection->h), arm);
	const rb_vec3 from_b = rb_quat_rotate_back(
		b, rb_vec3_sub(then,
	                       rb_pair_motion_center_after(world, state, pair.b, inspection->h)));
	const rb_vec3 was = rb_vec3_sub(at, rb_pair_motion_center(world, pair.b));

	return (struct rb_internal_edge_motion){
		rb_vec3_sub(from_b, was), rb_quat_multiply((rb_quat){b.w, -b.x, -b.y, -b.z}, a)};
}

static bool passes(const struct inspection *inspection, struct rb_pair pair, const rb_placed *a,
                   const rb_placed *b, const rb_manifold *manifold)
{
	const struct rb_world *world = inspection->world;
	/* during position projection there is no motion left */
	const struct rb_state *const before = inspection->max < HUGE_VAL ? &world->state
	                                                                 : &world->mark;

	/* most parts have no internal edge, and their motions are not needed */
	if (manifold->faces < -world->model->stepped_tolerance_m ||
	    !rb_internal_edge_has_face(a, b, manifold->normal, world->model->stepped_tolerance_m))
		return false;
	const struct rb_internal_edge beside = {
		.before = relative(inspection, before, pair, a->at),
		.forced = relative(inspection, &world->state, pair, a->at),
		.held = is_held(inspection, pair.a) && is_held(inspection, pair.b),
		.tolerance = world->model->stepped_tolerance_m};

	return rb_internal_edge(&beside, a, b, manifold);
}

/* Error of a point's gap that is allowed, as a share of the tolerance. */
static const double gap_error_share = 0.125;
/*
 * Adds points of all pairs of parts. Returns a lower bound of their distance, m; -INFINITY:
 * unknown.
 */
static double inspect_parts(struct inspection *inspection, struct rb_pair pair, double slack,
                            struct rb_axis_cache *caches)
{
	const struct rb_candidates *candidates = inspection->candidates;
	const double tolerance = inspection->world->model->stepped_tolerance_m;
	const double fine = gap_error_share * tolerance;
	const double band = band_of(inspection, pair, slack);
	const int a = candidates->first_part[pair.a], b = candidates->first_part[pair.b];
	const int count_a = rb_candidates_part_count(candidates, pair.a);
	const int count_b = rb_candidates_part_count(candidates, pair.b);
	const struct rb_placings placings = rb_placings_of(candidates, pair);
	rb_manifold manifold;
	double least_clearance = (double)INFINITY;

	for (int i = 0; i < count_a; i++) {
		const rb_placed *const pa = &candidates->placed[a + i];
		struct rb_near_parts near;
		int j;

		/* twice as far, so that the bound holds for more than this step */
		rb_candidates_near(&near, inspection->world->model, pair.b, pa, 2 * slack);
		if (near.far)
			least_clearance = rb_clearance_min(least_clearance, 2 * slack);
		while ((j = rb_near_parts_next(&near)) >= 0) {
			const rb_placed *const pb = &candidates->placed[b + j];
			struct rb_axis_cache none = {0};
			struct rb_axis_cache *const cache = near.far ? &none
			                                             : &caches[i * count_b + j];

			const struct rb_part_pair parts = rb_part_pair_of(pa, pb);
			double clearance = rb_clearance_of_spheres(pa, pb, slack);

			/*
			 * for boxes that were close, the closed form costs no more than the bound
			 */
			if (!(clearance > slack) && !rb_axis_cache_knows(cache, placings) &&
			    !(cache->is_close && rb_box_is(pa) && rb_box_is(pb)))
				clearance = rb_clearance_of_parts(&parts, slack, cache);
			if (clearance > slack) {
				least_clearance = rb_clearance_min(least_clearance, clearance);
				cache->is_close = false;
				continue;
			}
			const rb_separation s = rb_clearance_separation(&parts, placings, cache);
			least_clearance = rb_clearance_min(least_clearance,
			                                   s.gap - s.noise - parts.radii);
			/* as without a cached axis: the cache decides cost only */
			cache->is_close = s.gap - parts.radii <= slack;
			if (!cache->is_close)
				continue;
			rb_manifold_from(&manifold, pa, pb, &s, band, fine);
			if (rb_internal_edge_possible(&manifold, band, tolerance) &&
			    passes(inspection, pair, pa, pb, &manifold))
				continue;
			add_manifold(inspection, pair, &manifold, slack,
			             (uint32_t)i << 16 | (uint32_t)j,
			             (const rb_placed *const[2]){pa, pb});
		}
	}
	return least_clearance;
}

/* Cheap upper bound of the approach of a pair in the step, m; not for driven bodies. */
static double closing_bound(const struct inspection *inspection, struct rb_pair pair)
{
	const double closing = rb_step_closing_bound(inspection->world, inspection->candidates,
	                                             pair);

	return closing < inspection->max ? closing : inspection->max;
}

/* Whether a pair may touch by that bound. */
static bool may_touch(const struct inspection *inspection, struct rb_pair pair, double path)
{
	const struct rb_candidates *candidates = inspection->candidates;
	const struct rb_model *model = inspection->world->model;

	/* the bound does not hold for driven bodies, which may rotate */
	if (pair.b < model->body_count && model->driven && model->driven[pair.b])
		return true;
	return !rb_clearance_is_more(candidates, inspection->pair, path,
	                             closing_bound(inspection, pair));
}

/* ---- all pairs, by blocks ---- */

/*
 * Cost of a pair of spheres, and of a part of one body among those of another, in multiplications.
 */
enum { PAIR_WORK = 1 << 8, PART_WORK = 1 << 11 };

struct inspections {
	struct inspection inspection; /* initial state of each block */
	struct rb_world *world;
	int first;                /* first block of the wave */
	struct inspection *block; /* [BLOCKS_PER_WAVE] results */
};

/*
 * Blocks that are inspected before their points are gathered: enough for any number of workers, few
 * enough that points are not stored twice.
 */
enum { BLOCKS_PER_WAVE = 32 };

/* Counts the work of a pair with body `a`; true: the run is interrupted. */
static bool is_interrupted(const struct inspections *inspections, int a)
{
	const int parts = rb_candidates_part_count(inspections->inspection.candidates, a);

	return rb_interrupt_after(&inspections->world->interrupt, PART_WORK * (uint64_t)parts);
}

/*
 * Final index of a block's first point, if it is known and no copy is needed: for the first block,
 * and with one worker, who takes blocks in order. Else SIZE_MAX.
 */
static size_t place_of(const struct inspections *inspections, int block)
{
	size_t place = inspections->inspection.points->count;

	if (block > 0 && rb_team_workers(inspections->world->team) > 1)
		return SIZE_MAX;
	for (int b = 0; b < block; b++)
		place += inspections->block[b].all;
	return place;
}

static void inspect_block(void *user, int block, int worker)
{
	const struct inspections *inspections = user;
	struct inspection inspection = inspections->inspection;
	struct rb_candidates *const candidates = inspection.candidates;
	const size_t first = (size_t)(inspections->first + block) * RB_PAIRS_PER_BLOCK,
		     end = rb_pairs_end(rb_candidates_live_count(candidates), first);

	const double max = inspection.max;
	const bool glances = candidates->clearance && !inspection.world->model->driven;
	inspection.arena = &inspection.world->arena[worker];
	const size_t place = place_of(inspections, block);
	if (place < inspection.points->capacity) {
		inspection.out = inspection.points->row + place;
		inspection.capacity = inspection.points->capacity - place;
		inspection.in_place = true;
	}
	bool more = !rb_interrupt_after(&inspections->world->interrupt, PAIR_WORK * (end - first));
	for (size_t at = first; at < end && more && !inspection.failed; at++) {
		const size_t k = rb_candidates_live(candidates, at);
		const struct rb_pair pair = candidates->pair[k];

		/* true for most pairs */
		if (glances &&
		    rb_clearance_was_more(candidates, k, rb_clearance_path(candidates, pair),
		                          closing_bound(&inspection, pair)))
			continue;
		inspection.pair = k;
		if (rb_pair_is_plain(inspection.world->model, pair.a, pair.b)) {
			inspect_ball(
				&inspection, pair,
				rb_clearance_min(max, rb_step_closing_of_balls(inspection.world,
			                                                       candidates, pair)));
			continue;
		}
		const double path = rb_clearance_path(candidates, pair);
		rb_clearance_prefetch(candidates, k);
		if (!may_touch(&inspection, pair, path))
			continue;
		const double slack = rb_clearance_min(
			max, rb_step_closing_of(inspection.world, candidates, pair, inspection.h));
		candidates->clearance[k] = path +
		                           inspect_parts(&inspection, pair, slack,
		                                         rb_candidates_caches(candidates, k));
		more = !is_interrupted(inspections, pair.a);
	}
	inspections->block[block] = inspection;
}

static void gather_block(void *user, int block, int worker)
{
	const struct inspections *inspections = user;
	const struct inspection *inspection = &inspections->block[block];

	(void)worker;
	gather(inspection, inspection->points->row + inspection->place);
}

/* Adds points of a wave of blocks; resets the arenas to `mark`. */
static enum rb_status add_wave(struct rb_step_points *points, struct inspections *inspections,
                               int blocks, const rb_arena_mark *mark, struct rb_error *err)
{
	struct rb_world *world = inspections->world;
	size_t count = points->count;
	bool good = true;
	enum rb_status status = RB_OK;

	inspections->block = rb_arena_take(&world->arena[0], (size_t)blocks,
	                                   sizeof *inspections->block);
	if (!inspections->block)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the contacts of a step");
	rb_team_run(world->team, blocks, inspect_block, inspections);
	for (int b = 0; b < blocks; b++) {
		inspections->block[b].place = count;
		count += inspections->block[b].all;
		good = good && !inspections->block[b].failed;
	}
	if (rb_interrupt_is_set(&world->interrupt))
		status = RB_FAIL(err, RB_ERR_INTERRUPT, "interrupted");
	else if (!good ||
	         !rb_memory_reserve(&points->row, &points->capacity, count, sizeof *points->row))
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for %zu contacts", count);
	if (status == RB_OK) {
		rb_team_run(world->team, blocks, gather_block, inspections);
		points->count = count;
	}
	for (int k = 0; k < world->worker_count; k++)
		rb_arena_back(&world->arena[k], mark[k]);
	return status;
}

enum rb_status rb_step_points_add(struct rb_step_points *points, struct rb_world *world,
                                  struct rb_candidates *candidates, double h, double max,
                                  struct rb_error *err)
{
	const int blocks = rb_pairs_blocks(rb_candidates_live_count(candidates));
	const struct inspection each = {
		.world = world, .points = points, .candidates = candidates, .h = h, .max = max};
	struct inspections inspections = {.inspection = each, .world = world};
	const rb_arena_mark here = rb_arena_here(&world->arena[0]);
	rb_arena_mark *mark = rb_arena_take(&world->arena[0], (size_t)world->worker_count,
	                                    sizeof *mark);
	enum rb_status status = RB_OK;

	if (!mark)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the contacts of a step");
	for (int k = 0; k < world->worker_count; k++)
		mark[k] = rb_arena_here(&world->arena[k]);
	for (int first = 0; first < blocks && status == RB_OK; first += BLOCKS_PER_WAVE) {
		const int left = blocks - first;

		inspections.first = first;
		status = add_wave(points, &inspections,
		                  left < BLOCKS_PER_WAVE ? left : BLOCKS_PER_WAVE, mark, err);
	}
	rb_arena_back(&world->arena[0], here);
	return status;
}
