/* SPDX-License-Identifier: MIT */
#include "stepped/inspection.h"

#include <string.h>

#include "geom/boxes.h"
#include "geom/manifold.h"
#include "geom/patch.h"
#include "step/gap.h"
#include "stepped/ball_gap.h"
#include "stepped/clearance.h"
#include "stepped/flush_points.h"
#include "stepped/internal_edges.h"
#include "stepped/pair_motion.h"
#include "stepped/rolling.h"
#include "stepped/step_closing.h"

/* Capacity of a block's first buffer, points: of fast bodies few pairs touch. */
enum { BLOCK_POINTS = 16 };

/* Starts a buffer of twice the size; earlier points stay in place. */
static bool add_piece(struct rb_inspection *inspection)
{
	const size_t capacity = inspection->all ? 2 * inspection->all : BLOCK_POINTS;
	struct rb_step_point *out = rb_arena_take(inspection->arena, capacity, sizeof *out);
	struct rb_inspection_piece *full = rb_arena_take(inspection->arena, 1, sizeof *full);

	if (!out || !full)
		return false;
	*full = (struct rb_inspection_piece){inspection->out, inspection->count, inspection->full};
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
static struct rb_step_point *add_point(struct rb_inspection *inspection, struct rb_pair pair,
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

void rb_inspection_gather(const struct rb_inspection *inspection, struct rb_step_point *to)
{
	const struct rb_inspection_piece last = {inspection->out, inspection->count,
	                                         inspection->full};
	struct rb_step_point *end = to + inspection->all;

	for (const struct rb_inspection_piece *piece = &last; piece; piece = piece->before) {
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
static void fill_point(const struct rb_inspection *inspection, struct rb_pair_motion *common,
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

/* Whether contacts had forces on a body in the last step; true for bodies that do not move. */
static bool is_held(const struct rb_inspection *inspection, int i)
{
	const struct rb_model *model = inspection->world->model;

	return rb_inspection_is_fixed(model, i) || inspection->points->held[i];
}

/*
 * For two balls that move far: keeps the gap at the end of the step but takes the present line of
 * centres as normal, along which an impulse preserves their angular momentum.
 */
static void keep_present_normal(const struct rb_inspection *inspection, struct rb_step_point *point)
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

void rb_inspect_ball(struct rb_inspection *inspection, struct rb_pair pair, double slack)
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
	const struct rb_gap g = rb_ball_gap_ahead(world, pair, inspection->h);
	if (!(g.gap <= slack) ||
	    rb_ball_gap_is_beside(world, pair, inspection->h,
	                          is_held(inspection, pair.a) && is_held(inspection, pair.b)))
		return;
	struct rb_step_point *point = add_point(inspection, pair, g.normal, g.gap);
	if (!point)
		return;
	inspection->borders = inspection->borders ||
	                      model->shape[pair.b].kind == RB_SHAPE_RECTANGLE;
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

bool rb_inspection_may_go_on(const struct rb_model *model, int i)
{
	return !rb_candidates_is_terrain(model, i) &&
	       (rb_inspection_is_fixed(model, i) ||
	        (model->parts && rb_model_parts(model, i)->count > 1));
}

static void add_manifold(struct rb_inspection *inspection, struct rb_pair pair,
                         const rb_manifold *manifold, double slack, uint32_t parts,
                         const rb_placed *const placed[2])
{
	const struct rb_model *const model = inspection->world->model;
	const bool terrain = rb_candidates_is_terrain(model, pair.b);
	const rb_vec3 at_a = rb_pair_motion_center(inspection->world, pair.a),
		      at_b = rb_pair_motion_center(inspection->world, pair.b);
	struct rb_pair_motion common = rb_pair_motion_of(inspection->world, inspection->h, pair.a,
	                                                 pair.b, manifold->normal, false);

	inspection->borders = inspection->borders ||
	                      (rb_inspection_may_go_on(model, pair.a) &&
	                       rb_flush_is_border(placed[0], manifold->normal)) ||
	                      (rb_inspection_may_go_on(model, pair.b) &&
	                       rb_flush_is_border(placed[1], rb_vec3_neg(manifold->normal)));
	for (int k = 0; k < manifold->count; k++) {
		const rb_manifold_point *at = &manifold->point[k];

		if (!(at->gap <= slack) ||
		    (terrain && !rb_flush_terrain_is_real(model, pair.b, (int)(parts & 0xffff), at,
		                                          manifold->normal, placed[0])))
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
static double band_of(const struct rb_inspection *inspection, struct rb_pair pair, double slack)
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
static struct rb_internal_edge_motion relative(const struct rb_inspection *inspection,
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

static bool passes(const struct rb_inspection *inspection, struct rb_pair pair, const rb_placed *a,
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
double rb_inspect_parts(struct rb_inspection *inspection, struct rb_pair pair, double slack,
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

void rb_inspect_along(struct rb_inspection *inspection, struct rb_pair pair, const int part[2],
                      rb_vec3 normal, double slack)
{
	const struct rb_candidates *const candidates = inspection->candidates;
	const rb_placed *const placed[2] = {
		&candidates->placed[candidates->first_part[pair.a] + part[0]],
		&candidates->placed[candidates->first_part[pair.b] + part[1]]};
	rb_manifold manifold;

	rb_manifold_along(&manifold, placed[0], placed[1], normal,
	                  band_of(inspection, pair, slack));
	add_manifold(inspection, pair, &manifold, slack,
	             (uint32_t)part[0] << 16 | (uint32_t)part[1], placed);
}

void rb_inspect_plane(struct rb_inspection *inspection, struct rb_pair pair, const int part[2],
                      int side, rb_vec3 outward, double slack)
{
	static const rb_core half_space = {.kind = RB_CORE_HALF_SPACE};
	const struct rb_candidates *const candidates = inspection->candidates;
	const double tolerance = inspection->world->model->stepped_tolerance_m;
	const rb_placed *placed[2] = {
		&candidates->placed[candidates->first_part[pair.a] + part[0]],
		&candidates->placed[candidates->first_part[pair.b] + part[1]]};
	const rb_placed *const flush = placed[side];
	const int face = rb_flush_face_along(flush, outward);
	const rb_placed plane = rb_flush_plane(flush, face, &half_space);
	const uint64_t key = (uint64_t)((uint32_t)RB_PART_FACE << 24 | (uint32_t)face)
	                     << (side == 0 ? 32 : 0);
	const uint64_t mask = side == 0 ? 0xffffffff : (uint64_t)0xffffffff << 32;
	rb_manifold manifold;
	int count = 0;

	placed[side] = &plane;
	rb_manifold_with_nearest(&manifold, placed[0], placed[1], band_of(inspection, pair, slack),
	                         gap_error_share * tolerance, (double)INFINITY);
	for (int k = 0; k < manifold.count; k++) {
		rb_manifold_point *const at = &manifold.point[k];

		if (!rb_flush_goes_on(flush, outward, side == 0 ? at->on_a : at->on_b, tolerance))
			continue;
		at->key = (at->key & mask) | key;
		manifold.point[count++] = *at;
	}
	manifold.count = count;
	placed[side] = flush;
	add_manifold(inspection, pair, &manifold, slack,
	             (uint32_t)part[0] << 16 | (uint32_t)part[1], placed);
}
