/* SPDX-License-Identifier: MIT */
/*
 * Contact points of convex parts, identified by their features. A search (geom/manifold) finds a
 * point; from then on it is a closed form of the poses (located/feature) until it leaves its
 * features, so that gaps and their rates are smooth functions of time. Where features have no
 * closed form, the search is repeated and rates are central differences.
 */
#include "located/convex_contact.h"

#include "base/error.h"

#include <float.h>
#include <stdlib.h>

#include "located/feature.h"
#include "model/parts.h"

/*
 * A point within this many bands of the end of its features and moving towards it is about to leave
 * them; the features that take over are sought this many bands ahead.
 */
enum { LEAVING_BANDS = 4, AHEAD_BANDS = 64 };
/* Features passed in a row, at most: face, edge, corner, edge, face, on both sides. */
enum { FEATURES_PASSED = 8 };
/*
 * Step of difference quotients, as a share of the size travelled: the cube root of the precision,
 * which leaves a third of the digits to the step and two thirds to the difference.
 */
static const double moment_share = 0x1p-17;

/* Index of a's part in a pair of parts. */
static uint32_t part_of_a(uint32_t parts)
{
	return parts >> 16;
}

static uint32_t part_of_b(uint32_t parts)
{
	return parts & 0xffff;
}

void rb_touch_side(const struct rb_located *l, int i, int part, const struct rb_pose *pose,
                   const struct rb_pose *reference, struct rb_feature_side *side)
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, i));
	RB_ASSERT_COSTLY(part >= 0);
	const struct rb_model *model = l->model;
	const struct rb_body_part *own = &rb_model_parts(model, i)->part[part];
	rb_vec3 origin = {0, 0, 0};
	const rb_placed placed = rb_body_part_place(own, origin, pose->orientation);

	if (i < l->n && model->center_of_mass)
		origin = rb_vec3_neg(rb_quat_rotate(pose->orientation, model->center_of_mass[i]));
	const rb_vec3 arm = rb_vec3_add(origin, placed.at);

	/* relative to the centre of mass: far from the world's origin no digits are lost */
	*side = (struct rb_feature_side){
		.core = placed.core,
		.at = reference ? rb_vec3_add(rb_pose_between(reference, pose), arm) : arm,
		.turn = placed.turn,
		.velocity = rb_vec3_add(pose->velocity, rb_vec3_cross(pose->spin, arm)),
		.spin = pose->spin,
	};
}

/* ---- one point ---- */

/* Two parts as the feature functions take them, both relative to a's centre of mass. */
struct part_pair {
	struct rb_feature_side a, b;
};

/* Both parts at the poses of the pair. */
static void place_parts(const struct rb_located *l, const struct rb_touch_pair *pair,
                        uint32_t parts, struct part_pair *c)
{
	RB_ASSERT_COSTLY((int)part_of_a(parts) < rb_model_parts(l->model, pair->a)->count);
	RB_ASSERT_COSTLY((int)part_of_b(parts) < rb_model_parts(l->model, pair->b)->count);

	rb_touch_side(l, pair->a, (int)part_of_a(parts), &pair->pose_a, NULL, &c->a);
	rb_touch_side(l, pair->b, (int)part_of_b(parts), &pair->pose_b, &pair->pose_a, &c->b);
}

/*
 * Searches for the point named `key`, relative to the first side; false: there is none, and *out is
 * another point.
 */
static bool search_name(const struct part_pair *c, uint64_t key, struct rb_feature_point *out)
{
	const rb_placed a = rb_feature_placed(&c->a), b = rb_feature_placed(&c->b);
	rb_manifold manifold;
	int which = -1;

	rb_manifold_of(&manifold, &a, &b, 0);
	for (int k = 0; k < manifold.count && which < 0; k++)
		if (rb_feature_name(&c->a, &c->b, &manifold, k, 0) == key)
			which = k;
	const rb_manifold_point *p = &manifold.point[which < 0 ? 0 : which];

	*out = (struct rb_feature_point){
		.gap = p->gap,
		.normal = manifold.normal,
		.point = rb_vec3_scale(0.5, rb_vec3_add(p->on_a, p->on_b)),
		.inside = which < 0 ? -(c->a.core->reach + c->a.core->radius) : (double)INFINITY,
	};
	return which >= 0;
}

/* Bound of the relative speed of any two of their points, m/s. */
static double speed_of(const struct part_pair *c)
{
	return rb_vec3_length(rb_vec3_sub(c->b.velocity, c->a.velocity)) +
	       rb_vec3_length(c->a.spin) * (c->a.core->reach + c->a.core->radius) +
	       rb_vec3_length(c->b.spin) * (c->b.core->reach + c->b.core->radius);
}

/* Size of the smaller part, m; a half space has none. */
static double size_of(const struct part_pair *c)
{
	const double a = c->a.core->reach + c->a.core->radius;
	const double b = c->b.core->reach + c->b.core->radius;

	return a > 0 && b > 0 ? fmin(a, b) : fmax(a, b);
}

/* Finds the point by a search, where there is no closed form; rates by differences. */
static void search_with_rates(const struct part_pair *c, uint64_t key, struct rb_feature_point *out)
{
	const double speed = speed_of(c), s = speed > 0 ? moment_share * size_of(c) / speed : 0;
	struct rb_feature_point p[2];
	double from = 0, to = 0;

	const bool named = search_name(c, key, out);
	if (rb_feature_curves(&p[0], &c->a, &c->b, key, out->point) &&
	    rb_vec3_dot(p[0].normal, out->normal) > 0) {
		*out = p[0];
		return;
	}
	if (!named || !(s > 0))
		return;
	p[0] = p[1] = *out;
	for (int k = 0; k < 2; k++) {
		const double time = k ? s : -s;
		const struct part_pair there = {rb_feature_later(&c->a, time),
		                                rb_feature_later(&c->b, time)};
		struct rb_feature_point found;

		if (!search_name(&there, key, &found))
			continue;
		p[k] = found;
		*(k ? &to : &from) = time;
	}
	if (!(to > from))
		return;
	const double per = 1 / (to - from);
	out->normal_rate = rb_vec3_reject(rb_vec3_scale(per, rb_vec3_sub(p[1].normal, p[0].normal)),
	                                  out->normal);
	out->point_rate = rb_vec3_scale(per, rb_vec3_sub(p[1].point, p[0].point));
}

/* Contact point named `key`, with arms and rates relative to the centres of mass. */
static struct rb_contact_point point_of_pair(const struct rb_touch_pair *pair,
                                             const struct part_pair *c, uint32_t parts,
                                             uint64_t key)
{
	struct rb_feature_point p;

	if (!rb_feature_contact(&p, &c->a, &c->b, key))
		search_with_rates(c, key, &p);
	struct rb_contact_point m = {.a = pair->a,
	                             .b = pair->b,
	                             .parts = parts,
	                             .key = key,
	                             .half = c->a.half,
	                             .gap = p.gap,
	                             .normal = p.normal,
	                             .normal_rate = p.normal_rate,
	                             .point = rb_vec3_add(pair->pose_a.position, p.point),
	                             .inside = p.inside,
	                             .inside_rate = p.inside_rate,
	                             .beyond = rb_feature_beyond(&c->a, &c->b, key, &p),
	                             .pose_a = pair->pose_a,
	                             .pose_b = pair->pose_b,
	                             .arm_a = p.point};
	m.arm_b = rb_vec3_sub(p.point, rb_pose_between(&pair->pose_a, &pair->pose_b));
	m.rate_a = rb_vec3_sub(p.point_rate, pair->pose_a.velocity);
	m.rate_b = rb_vec3_sub(p.point_rate, pair->pose_b.velocity);
	m.velocity = rb_vec3_sub(
		rb_vec3_add(pair->pose_b.velocity, rb_vec3_cross(pair->pose_b.spin, m.arm_b)),
		rb_vec3_add(pair->pose_a.velocity, rb_vec3_cross(pair->pose_a.spin, m.arm_a)));
	return m;
}

struct rb_contact_point rb_touch_of(const struct rb_located *l, const struct rb_contact_name *name,
                                    const struct rb_pose *pose_a, const struct rb_pose *pose_b)
{
	const struct rb_touch_pair pair = {name->a, name->b, 0, *pose_a, *pose_b};
	struct part_pair c;

	RB_ASSERT_COSTLY(rb_located_is_body(l, name->a) && rb_located_is_body(l, name->b));
	RB_ASSERT_COSTLY(l->model->parts != NULL);
	place_parts(l, &pair, name->parts, &c);
	c.a.half = c.b.half = name->half;
	return point_of_pair(&pair, &c, name->parts, name->key);
}

bool rb_touch_half(const struct rb_located *l, const struct rb_contact_point *m, rb_vec3 *half)
{
	const struct rb_touch_pair pair = {m->a, m->b, 0, m->pose_a, m->pose_b};
	struct part_pair c;

	RB_ASSERT_COSTLY(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	place_parts(l, &pair, m->parts, &c);
	c.a.half = c.b.half = m->half;
	return rb_feature_half(&c.a, &c.b, m->key, half);
}

bool rb_touch_rim_of(const struct rb_located *l, const struct rb_contact_point *m,
                     struct rb_feature_flat_rim *rim)
{
	const struct rb_touch_pair pair = {m->a, m->b, 0, m->pose_a, m->pose_b};
	struct part_pair c;

	if (!rb_pair_has_features(l, m->a, m->b) || !rb_feature_is_quarter(m->key))
		return false;
	place_parts(l, &pair, m->parts, &c);
	c.a.half = c.b.half = m->half;
	return rb_feature_flat_rim(&c.a, &c.b, m->key, rim);
}

struct rb_contact_point rb_touch_on_rim(const struct rb_located *l,
                                        const struct rb_contact_point *m,
                                        const struct rb_feature_flat_rim *rim, rb_vec3 way)
{
	const rb_vec3 own = rb_mat3_apply_transposed(&rim->turn, way), across = {own.x, own.y, 0};
	struct rb_contact_name name = rb_contact_name_of(m);

	name.key = rim->key;
	name.half = rb_vec3_unit(across, (rb_vec3){1, 0, 0});
	return rb_touch_of(l, &name, &m->pose_a, &m->pose_b);
}

/*
 * The contact point at the features within whose bounds it lies. A search distinguishes features of
 * nearly equal normals only to the root of the precision, and a face may name points beyond its
 * border.
 */
static struct rb_contact_point contact_within(const struct rb_touch_pair *pair,
                                              const struct part_pair *c, uint32_t parts,
                                              uint64_t key)
{
	struct rb_contact_point m = point_of_pair(pair, c, parts, key);

	for (int k = 0; k < FEATURES_PASSED && m.inside < 0 && m.beyond != 0; k++) {
		const struct rb_contact_point next = point_of_pair(pair, c, parts, m.beyond);

		if (!(next.inside > m.inside))
			break;
		m = next;
	}
	return m;
}

struct rb_contact_point rb_touch_passed_on(const struct rb_located *l,
                                           const struct rb_contact_point *m)
{
	const struct rb_touch_pair pair = {m->a, m->b, 0, m->pose_a, m->pose_b};
	struct part_pair c;

	RB_ASSERT_COSTLY(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	place_parts(l, &pair, m->parts, &c);
	return contact_within(&pair, &c, m->parts, m->key);
}

/* ---- the nearest point ---- */

/* Iterates over parts of b within `within` of a part of a; only b may be a terrain. */
static void iterate_near(const struct rb_located *l, const struct rb_touch_pair *pair, int part_a,
                         double within, struct rb_near_parts *near, double *reach)
{
	const struct rb_body_parts *const parts = rb_model_parts(l->model, pair->b);
	struct rb_feature_side a;

	*reach = 0;
	rb_near_parts_all(near, parts);
	if (!parts->terrain)
		return;
	rb_touch_side(l, pair->a, part_a, &pair->pose_a, NULL, &a);
	*reach = rb_convex_reach(a.core);
	rb_near_parts_begin(near, parts, pair->pose_b.position, pair->pose_b.orientation,
	                    rb_vec3_add(pair->pose_a.position, a.at), within + *reach);
}

/* Lower bound of the distance of two parts by their bounding balls, m; -INFINITY for a plane. */
static double ball_gap(const struct part_pair *c)
{
	const rb_core *a = c->a.core, *b = c->b.core;

	if (a->kind == RB_CORE_HALF_SPACE || b->kind == RB_CORE_HALF_SPACE)
		return -(double)INFINITY;
	return rb_vec3_length(rb_vec3_sub(c->b.at, c->a.at)) - rb_convex_reach(a) -
	       rb_convex_reach(b);
}

double rb_touch_gap(const struct rb_located *l, const struct rb_touch_pair *pair, uint32_t *parts)
{
	const int of_a = rb_model_parts(l->model, pair->a)->count;
	const int of_b = rb_model_parts(l->model, pair->b)->count;
	double least = (double)INFINITY;
	struct part_pair c;

	*parts = 0;
	for (int i = 0; i < of_a; i++) {
		struct rb_near_parts near;
		double reach;
		int j;

		iterate_near(l, pair, i, fmax(least, 0), &near, &reach);
		while ((j = rb_near_parts_next(&near)) >= 0) {
			const uint32_t these = (uint32_t)i << 16 | (uint32_t)j;
			place_parts(l, pair, these, &c);
			if (of_a * of_b > 1 && ball_gap(&c) > least)
				continue;
			const rb_placed a = rb_feature_placed(&c.a), b = rb_feature_placed(&c.b);
			const rb_separation s = rb_separation_of(&a, &b);
			const double gap = s.gap - a.core->radius - b.core->radius;
			if (gap < least) {
				least = gap;
				*parts = these;
				rb_near_parts_limit(&near, fmax(least, 0) + reach);
			}
		}
	}
	return least;
}

struct rb_contact_point rb_touch_nearest(const struct rb_located *l, int a, int b,
                                         const struct rb_pose *pose_a, const struct rb_pose *pose_b)
{
	const struct rb_touch_pair pair = {a, b, 0, *pose_a, *pose_b};
	rb_manifold manifold;
	struct part_pair c;
	uint32_t parts = 0;
	int best = 0;

	RB_ASSERT_COSTLY(rb_located_is_body(l, a) && rb_located_is_body(l, b));
	RB_ASSERT_COSTLY(a != b);
	if (rb_model_parts(l->model, a)->count * rb_model_parts(l->model, b)->count > 1)
		rb_touch_gap(l, &pair, &parts);
	place_parts(l, &pair, parts, &c);
	const rb_placed at_a = rb_feature_placed(&c.a), at_b = rb_feature_placed(&c.b);
	rb_manifold_of(&manifold, &at_a, &at_b, 0);
	for (int k = 1; k < manifold.count; k++)
		if (manifold.point[k].gap < manifold.point[best].gap)
			best = k;
	const uint64_t key = rb_feature_name(&c.a, &c.b, &manifold, best, 0);
	return contact_within(&pair, &c, parts, key);
}

/* ---- all points ---- */

/* Share of the size by which rounding may put a point's gap below that of its pair. */
static const double below_share = 1e-9;

struct search {
	const struct rb_located *l;
	const struct rb_touch_pair *pair; /* whose names are added */
	double depth;                     /* m: depth of manifolds */
	double speed;                     /* m/s: relative, rotation included */
	struct rb_contact_name name[RB_CONTACT_POINTS_MAX];
	int count;
	double least; /* m: gap of the pair */
};

/* Adds a name once. */
static void add_name(struct search *s, const struct rb_contact_name *name)
{
	for (int k = 0; k < s->count; k++)
		if (rb_contact_name_compare(&s->name[k], name) == 0)
			return;
	if (s->count < RB_CONTACT_POINTS_MAX)
		s->name[s->count++] = *name;
	RB_ASSERT(s->count <= RB_CONTACT_POINTS_MAX);
}

/*
 * Mean of the pair's centres of mass, weighted by inverse mass, relative to that of a: for a fixed
 * body the centre of the other.
 */
static rb_vec3 middle_of(const struct rb_located *l, const struct rb_touch_pair *pair)
{
	const double a = pair->a < l->n ? l->model->inverse_mass[pair->a] : 0;
	const double b = pair->b < l->n ? l->model->inverse_mass[pair->b] : 0;

	return rb_vec3_scale(a + b > 0 ? b / (a + b) : 0,
	                     rb_pose_between(&pair->pose_a, &pair->pose_b));
}

/*
 * Adds a name. A rim that lies flat touches all round, and four quarters of it determine its
 * support. When it comes to lie flat, or tilts from there, the quarters are counted from the point
 * of first contact.
 */
static void add_rim(struct search *s, const struct part_pair *c, const struct rb_contact_name *name)
{
	const struct rb_contact_point m = rb_touch_of(s->l, name, &s->pair->pose_a,
	                                              &s->pair->pose_b);
	const struct rb_feature_fall fall = {.key = name->key,
	                                     .least = 4 * rb_contact_point_noise(s->l, &m),
	                                     .middle = middle_of(s->l, s->pair)};
	struct rb_feature_rim rim;

	if (!rb_feature_landing(&c->a, &c->b, &fall, &rim)) {
		add_name(s, name);
		return;
	}
	const int before = s->count;

	for (int k = 0; k < 4; k++) {
		struct rb_contact_name landing = *name;

		landing.key = rb_feature_of_rim(&rim, name->key, k >= 2);
		landing.half = k % 2 == 0 ? rim.direction : rb_vec3_neg(rim.direction);
		/* unless past the border of the face on which it lands */
		if (!(rb_touch_of(s->l, &landing, &s->pair->pose_a, &s->pair->pose_b).inside <
		      -s->depth))
			add_name(s, &landing);
	}
	/* if only the rim's foremost point is over the face, all four are past its border */
	if (s->count == before)
		add_name(s, name);
}

/* Smallest separating speed along the normal over all points, m/s. */
static double separating_speed(const struct part_pair *c, const rb_manifold *manifold)
{
	double least = (double)INFINITY;

	for (int k = 0; k < manifold->count; k++) {
		const rb_vec3 at = rb_vec3_scale(
			0.5, rb_vec3_add(manifold->point[k].on_a, manifold->point[k].on_b));
		const rb_vec3 of_a = rb_vec3_add(
			c->a.velocity, rb_vec3_cross(c->a.spin, rb_vec3_sub(at, c->a.at)));
		const rb_vec3 of_b = rb_vec3_add(
			c->b.velocity, rb_vec3_cross(c->b.spin, rb_vec3_sub(at, c->b.at)));

		least = fmin(least, rb_vec3_dot(rb_vec3_sub(of_b, of_a), manifold->normal));
	}
	return least;
}

/* Rounding of the separating speed, m/s. */
static double separating_noise(const struct search *s, const rb_manifold *manifold)
{
	struct rb_contact_point m = {.a = s->pair->a,
	                             .b = s->pair->b,
	                             .pose_a = s->pair->pose_a,
	                             .pose_b = s->pair->pose_b,
	                             .arm_a = manifold->point[0].on_a};

	m.arm_b = rb_vec3_sub(m.arm_a, rb_pose_between(&m.pose_a, &m.pose_b));
	return rb_contact_point_noise(s->l, &m);
}

/*
 * Bodies that touch only in a line or a corner are separated by many planes, and the overlap to
 * come grows along the one towards which they move least: a body that slides over flush bodies does
 * not hit their sides. Tries the faces if the bodies approach along the normal of the search.
 */
static void choose_normal(const struct search *s, const struct part_pair *c, rb_manifold *manifold)
{
	const rb_placed side[2] = {rb_feature_placed(&c->a), rb_feature_placed(&c->b)};
	const double radii = side[0].core->radius + side[1].core->radius;
	const double noise = separating_noise(s, manifold);
	double best = separating_speed(c, manifold);

	if (!(manifold->gap >= -s->depth) || !(best < -noise) ||
	    side[0].core->kind == RB_CORE_HALF_SPACE || side[1].core->kind == RB_CORE_HALF_SPACE)
		return;
	for (int k = 0; k < 2; k++)
		for (int face = 0; face < rb_core_face_count(side[k].core); face++) {
			const rb_vec3 n = rb_vec3_scale(k ? -1 : 1,
			                                rb_placed_face_normal(&side[k], face));
			const double gap = rb_vec3_dot(n, rb_vec3_sub(side[1].at, side[0].at)) -
			                   rb_placed_height(&side[0], n) -
			                   rb_placed_height(&side[1], rb_vec3_neg(n)) - radii;
			rb_manifold along;

			if (!(gap >= -s->depth))
				continue;
			rb_manifold_along(&along, &side[0], &side[1], n, s->depth);
			const double speed = along.count > 0 ? separating_speed(c, &along)
			                                     : -(double)INFINITY;
			if (!(speed > best + noise))
				continue;
			best = speed;
			*manifold = along;
		}
}

/* Name of the side of a facet that faces a. */
static rb_part side_towards(const struct part_pair *c, rb_vec3 normal)
{
	const rb_placed b = rb_feature_placed(&c->b);

	return rb_part_of(RB_PART_FACE, rb_vec3_dot(rb_placed_face_normal(&b, 0), normal) > 0);
}

/*
 * True if the point is on a seam of coplanar triangles. A body that lies flat on several of them
 * shares a polygon with each; corners of these on a seam are no corners of their union, and
 * friction would act there. `at`: m, on the terrain, relative to its position.
 */
static bool is_on_seam(const struct rb_located *l, const struct rb_contact_name *name,
                       const struct rb_pose *pose_b, rb_vec3 at)
{
	const struct rb_terrain *const terrain = rb_model_parts(l->model, name->b)->terrain;

	return terrain && (rb_part)(name->key >> 32) >> 24 != RB_PART_VERTEX &&
	       rb_model_parts(l->model, name->a)->part[part_of_a(name->parts)].core.kind ==
	               RB_CORE_POLYTOPE &&
	       rb_terrain_goes_on(terrain, (int)part_of_b(name->parts),
	                          rb_quat_rotate_back(pose_b->orientation, at));
}

/*
 * Names a corner over a seam as one of this triangle, since rounding may put it on neither side.
 * False: it is no corner.
 */
static bool name_corner(const struct part_pair *c, const rb_manifold *manifold, int k,
                        struct rb_contact_name *name)
{
	const rb_placed a = rb_feature_placed(&c->a);
	const int corner = rb_placed_corner_at(&a, manifold->point[k].on_b, manifold->normal);

	if (corner < 0)
		return false;
	name->key = (uint64_t)rb_part_of(RB_PART_VERTEX, corner) << 32 |
	            side_towards(c, manifold->normal);
	return true;
}

/* Adds the names of all points of all parts within the depth. */
static void add_names(struct search *s, const struct rb_touch_pair *pair)
{
	const int of_a = rb_model_parts(s->l->model, pair->a)->count;
	const rb_vec3 none = {0, 0, 0};
	rb_manifold manifold;
	struct part_pair c;

	s->pair = pair;
	for (int i = 0; i < of_a; i++) {
		struct rb_near_parts near;
		double reach;
		int j;

		iterate_near(s->l, pair, i, s->depth, &near, &reach);
		while ((j = rb_near_parts_next(&near)) >= 0) {
			const uint32_t parts = (uint32_t)i << 16 | (uint32_t)j;
			place_parts(s->l, pair, parts, &c);
			if (ball_gap(&c) > s->depth)
				continue;
			const rb_placed a = rb_feature_placed(&c.a), b = rb_feature_placed(&c.b);
			rb_manifold_of(&manifold, &a, &b, s->depth);
			/* an overlap must not hide the points that touch */
			if (manifold.gap < 0)
				rb_manifold_of(&manifold, &a, &b, s->depth - manifold.gap);
			if (manifold.gap <= s->depth)
				choose_normal(s, &c, &manifold);
			s->least = fmin(s->least, manifold.gap);
			for (int k = 0; k < manifold.count; k++) {
				if (manifold.point[k].gap > s->depth)
					continue;
				struct rb_contact_name name = {
					pair->a, pair->b, parts,
					rb_feature_name(&c.a, &c.b, &manifold, k, s->depth), none};
				const rb_vec3 at = rb_vec3_sub(
					manifold.point[k].on_b,
					rb_pose_between(&pair->pose_a, &pair->pose_b));
				if (is_on_seam(s->l, &name, &pair->pose_b, at) &&
				    !name_corner(&c, &manifold, k, &name))
					continue;
				add_rim(s, &c, &name);
			}
		}
	}
}

/* Advances a pose by s seconds at constant velocities. */
static void advance_pose(struct rb_pose *pose, double s)
{
	const rb_quat turn = rb_quat_from_turn(rb_vec3_scale(s, pose->spin));

	pose->position = rb_vec3_add_scaled(pose->position, s, pose->velocity);
	pose->orientation = rb_quat_unit(rb_quat_multiply(turn, pose->orientation));
}

static int by_name(const void *left, const void *right)
{
	const struct rb_contact_name x = rb_contact_name_of(left), y = rb_contact_name_of(right);

	return rb_contact_name_compare(&x, &y);
}

/*
 * Speed, m/s, below which a point is not taken to leave its features, because the positions after
 * it has left are too far from the present ones. Over a distance x, rotation and curvature change
 * gaps by x^2 / size, which must be within the AHEAD_BANDS bands.
 */
static double slowest_leaving(const struct search *s, const struct rb_contact_point *m, double band)
{
	return s->speed * sqrt(AHEAD_BANDS * band / rb_contact_point_size(s->l, m));
}

/* True if the point is close to the end of its features and moving towards it. */
static bool is_leaving(const struct rb_contact_point *m, double band, double slowest)
{
	return m->inside <= LEAVING_BANDS * band && m->inside_rate < -slowest;
}

/*
 * Collects the contact points of the names that touch; returns their number and, in *leaving, the
 * highest speed at which one leaves its features. Names known to take over are evaluated as well,
 * since a search distinguishes them only to the root of the precision.
 */
static int collect(struct search *s, const struct rb_touch_pair *pair, double slack,
                   struct rb_contact_point *all, double *leaving)
{
	int count = 0;

	*leaving = 0;
	for (int k = 0; k < s->count; k++) {
		const struct rb_contact_name name = s->name[k];
		const struct rb_contact_point m = rb_touch_of(s->l, &name, &pair->pose_a,
		                                              &pair->pose_b);
		const double band = rb_contact_point_band(s->l, &m, pair->t);
		const double noise = rb_contact_point_noise(s->l, &m);
		const bool leaves = is_leaving(&m, band, fmax(noise, slowest_leaving(s, &m, band)));

		if (m.beyond != 0 && (leaves || m.inside < -band)) {
			const struct rb_contact_name next = {
				.a = pair->a, .b = pair->b, .parts = name.parts, .key = m.beyond};
			const struct rb_contact_point n = rb_touch_of(s->l, &next, &pair->pose_a,
			                                              &pair->pose_b);

			/*
			 * between parallel lines rounding decides nothing; beyond a seam is a
			 * neighbour
			 */
			if (!is_on_seam(s->l, &next, &pair->pose_b, n.arm_b) &&
			    n.inside > fmin(m.inside, -LEAVING_BANDS * band)) {
				add_name(s, &next);
				continue;
			}
		}
		/* points of features that touch only at their ends may be anywhere */
		if (!(m.gap <= band + slack) ||
		    m.gap < s->least - s->depth - below_share * rb_contact_point_size(s->l, &m))
			continue;
		if (leaves) {
			*leaving = fmax(*leaving, -m.inside_rate);
			continue;
		}
		all[count++] = m;
	}
	return count;
}

int rb_touch_all(const struct rb_located *l, const struct rb_touch_pair *pair, double slack,
                 struct rb_contact_point all[RB_CONTACT_POINTS_MAX])
{
	const rb_vec3 w = rb_vec3_sub(pair->pose_b.velocity, pair->pose_a.velocity);
	struct rb_contact_point resting = {.a = pair->a,
	                                   .b = pair->b,
	                                   .pose_a = pair->pose_a,
	                                   .pose_b = pair->pose_b,
	                                   .normal = {1, 0, 0}};
	struct search s = {.l = l, .least = HUGE_VAL};
	double leaving;

	/* a speed, and so a band, no less than that of any point */
	const double turning = rb_vec3_length(pair->pose_a.spin) *
	                               rb_model_reach(l->model, pair->a) +
	                       rb_vec3_length(pair->pose_b.spin) *
	                               rb_model_reach(l->model, pair->b);
	resting.velocity.x = rb_vec3_length(w) + 2 * turning;
	const double band = rb_contact_point_band(l, &resting, pair->t);
	s.depth = band + fmax(slack, 0);
	s.speed = resting.velocity.x;
	add_names(&s, pair);
	int count = collect(&s, pair, slack, all, &leaving);
	if (leaving > 0) {
		/* the features that take over are those that touch a moment later */
		struct rb_touch_pair later = *pair;
		const double ahead = AHEAD_BANDS * band / leaving;

		advance_pose(&later.pose_a, ahead);
		advance_pose(&later.pose_b, ahead);
		s.depth += 2 * ahead * resting.velocity.x;
		add_names(&s, &later);
		count = collect(&s, pair, slack, all, &leaving);
	}
	qsort(all, (size_t)count, sizeof *all, by_name);
	return count;
}
