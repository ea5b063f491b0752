/* SPDX-License-Identifier: MIT */
/*
 * Private to located/feature: values with their time derivatives, so that each formula is written
 * once; points, directions and lines of a part in motion.
 */
#ifndef RB_LOCATED_FEATURE_INSIDE_H
#define RB_LOCATED_FEATURE_INSIDE_H

#include "located/feature_side.h"
#include "geom/patch.h"

#include <float.h>

/* Numbers of the crossings of a rim with a line: see geom/patch. */
enum { FIRST_CROSSING = 5, SECOND_CROSSING = 6 };

typedef struct {
	rb_vec3 at, rate;
} vec;

typedef struct {
	double at, rate;
} num;

typedef struct rb_feature_side side;

static inline vec minus(vec a, vec b)
{
	return (vec){rb_vec3_sub(a.at, b.at), rb_vec3_sub(a.rate, b.rate)};
}

static inline num dot(vec a, vec b)
{
	return (num){rb_vec3_dot(a.at, b.at),
	             rb_vec3_dot(a.rate, b.at) + rb_vec3_dot(a.at, b.rate)};
}

static inline vec cross(vec a, vec b)
{
	return (vec){rb_vec3_cross(a.at, b.at),
	             rb_vec3_add(rb_vec3_cross(a.rate, b.at), rb_vec3_cross(a.at, b.rate))};
}

/* a + s b */
static inline vec plus(vec a, num s, vec b)
{
	return (vec){rb_vec3_add_scaled(a.at, s.at, b.at),
	             rb_vec3_add_scaled(rb_vec3_add_scaled(a.rate, s.rate, b.at), s.at, b.rate)};
}

static inline vec plus_constant(vec a, double s, vec b)
{
	return plus(a, (num){s, 0}, b);
}

static inline vec negative(vec a)
{
	return (vec){rb_vec3_neg(a.at), rb_vec3_neg(a.rate)};
}

static inline vec reject(vec a, vec unit)
{
	const num along = dot(a, unit);

	return plus(a, (num){-along.at, -along.rate}, unit);
}

static inline num quotient(num a, num b)
{
	const double q = a.at / b.at;

	return (num){q, (a.rate - q * b.rate) / b.at};
}

/* Length and direction of a vector; false if the length is zero, which has no direction. */
static inline bool direction(vec a, vec *unit, num *length)
{
	const double size = rb_vec3_length(a.at);

	if (!(size > 0))
		return false;
	unit->at = rb_vec3_scale(1 / size, a.at);
	length->at = size;
	length->rate = rb_vec3_dot(unit->at, a.rate);
	unit->rate = rb_vec3_scale(1 / size, rb_vec3_reject(a.rate, unit->at));
	return true;
}

/* ---- parts of a body ---- */

static inline rb_part_kind kind_of(rb_part part)
{
	return (rb_part_kind)(part >> 24 & 15);
}

static inline int index_of(rb_part part)
{
	return (int)(part & 0xffffff);
}

static inline vec vector_of(const side *s, rb_vec3 local)
{
	const rb_vec3 at = rb_mat3_apply(&s->turn, local);

	return (vec){at, rb_vec3_cross(s->spin, at)};
}

static inline vec point_of(const side *s, rb_vec3 local)
{
	const vec arm = vector_of(s, local);

	return (vec){rb_vec3_add(s->at, arm.at), rb_vec3_add(s->velocity, arm.rate)};
}

/* Position and velocity in the body's own axes. */
static inline vec in_body_axes(const side *s, vec p)
{
	const rb_vec3 d = rb_vec3_sub(p.at, s->at);
	const rb_vec3 v = rb_vec3_sub(rb_vec3_sub(p.rate, s->velocity), rb_vec3_cross(s->spin, d));

	return (vec){rb_mat3_apply_transposed(&s->turn, d), rb_mat3_apply_transposed(&s->turn, v)};
}

typedef struct {
	const side *of;
	vec from, along; /* along: unit */
	double length, radius;
	int index; /* of a polytope's edge */
} line;

static inline bool line_of(const side *s, rb_part part, line *out)
{
	const rb_core *core = s->core;
	const rb_vec3 z = {0, 0, 1};

	out->of = s;
	if (kind_of(part) == RB_PART_MANTLE && core->kind == RB_CORE_CYLINDER) {
		out->from = point_of(s, (rb_vec3){0, 0, -core->half_height});
		out->along = vector_of(s, z);
		out->length = 2 * core->half_height;
		out->radius = core->round;
		return true;
	}
	if (kind_of(part) != RB_PART_EDGE || core->kind != RB_CORE_POLYTOPE ||
	    index_of(part) >= core->polytope->edge_count)
		return false;
	out->index = index_of(part);
	const int *edge = core->polytope->edges[out->index];
	const rb_vec3 p = core->polytope->vertices[edge[0]];
	const rb_vec3 d = rb_vec3_sub(core->polytope->vertices[edge[1]], p);

	out->from = point_of(s, p);
	out->along = vector_of(s, rb_vec3_unit(d, z));
	out->length = rb_vec3_length(d);
	out->radius = core->radius;
	return true;
}

/* Which of the two bodies' features ends. */
typedef enum { FIRST, SECOND } side_index;

/*
 * Distance of a point from the nearest end of its features, and the feature beyond it; 0: unknown.
 */
typedef struct {
	num margin;
	side_index owner;
	rb_part part;
} ending;

static const ending endless = {{(double)INFINITY, 0}, FIRST, 0};

static inline void limit_ending(ending *end, num margin, side_index owner, rb_part part)
{
	if (margin.at < end->margin.at)
		*end = (ending){margin, owner, part};
}

/* Distance along a line to its ends. */
static inline void within_line(ending *end, const line *e, num along, side_index owner)
{
	rb_part part[2] = {rb_part_of(RB_PART_RIM, 1), rb_part_of(RB_PART_RIM, 0)};

	for (int k = 0; k < 2 && e->of->core->kind == RB_CORE_POLYTOPE; k++)
		part[k] = rb_part_of(RB_PART_VERTEX, e->of->core->polytope->edges[e->index][k]);
	limit_ending(end, along, owner, part[0]);
	limit_ending(end, (num){e->length - along.at, -along.rate}, owner, part[1]);
}

/*
 * Region of directions in which an edge is nearest: those with no positive component along these
 * borders, in its body's axes; returns their number. Beyond each border a face is nearer. A mere
 * segment has none.
 */
static inline int borders_of(const line *e, rb_vec3 border[2])
{
	const struct rb_polytope *p = e->of->core->polytope;

	if (e->of->core->kind != RB_CORE_POLYTOPE || p->face_count == 0)
		return 0;
	if (p->face_count ==
	    2) { /* a flat polytope has two arcs per edge: from its normal to outward, and on */
		border[0] = p->arcs[2 * e->index].inner[0];
		return 1;
	}
	border[0] = p->arcs[e->index].inner[0];
	border[1] = p->arcs[e->index].inner[1];
	return 2;
}

/* Limits to directions `to`, m, from an edge in which the edge is nearer than its faces. */
static inline void within_borders(ending *end, const line *e, vec to, side_index owner)
{
	rb_vec3 border[2];
	const int count = borders_of(e, border);

	for (int k = 0; k < count; k++) {
		int face = e->of->core->polytope->flanks[e->index][k];

		if (count == 1) /* of a flat's two faces, that on the side of `to` */
			face = rb_vec3_dot(
				       vector_of(e->of, e->of->core->polytope->faces[0].normal).at,
				       to.at) < 0;
		limit_ending(end, dot(vector_of(e->of, border[k]), to), owner,
		             rb_part_of(RB_PART_FACE, face));
	}
}

static inline void set_point(struct rb_feature_point *out, num gap, vec normal, vec point,
                             const ending *end)
{
	*out = (struct rb_feature_point){.gap = gap.at,
	                                 .normal = normal.at,
	                                 .normal_rate = normal.rate,
	                                 .point = point.at,
	                                 .point_rate = point.rate,
	                                 .inside = end->margin.at,
	                                 .inside_rate = end->margin.rate,
	                                 .next = end->part,
	                                 .next_is_b = end->owner == SECOND};
}

/* Outward direction at the middle of an edge: from the middle of its body. */
static inline rb_vec3 outward(const line *e)
{
	const rb_core *core = e->of->core;
	rb_vec3 middle = {0, 0, 0};

	if (core->kind == RB_CORE_POLYTOPE)
		middle = core->polytope->middle;
	const rb_vec3 half = rb_vec3_add_scaled(e->from.at, 0.5 * e->length, e->along.at);
	return rb_vec3_sub(rb_vec3_sub(half, e->of->at), rb_mat3_apply(&e->of->turn, middle));
}

#endif
