/* SPDX-License-Identifier: MIT */
/*
 * Inside event/feature: values that go with their derivatives in time, so that each formula is written once; points,
 * directions and lines of a part in motion.
 */
#ifndef RB_EVENT_FEATURE_INSIDE_H
#define RB_EVENT_FEATURE_INSIDE_H

#include "event/feature_side.h"
#include "geom/patch.h"

#include <float.h>

/* Where a rim meets a line: see geom/patch. */
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

/* Its length, and its direction; a length of zero has none, and gives false. */
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

static inline vec way_of(const side *s, rb_vec3 local)
{
	const rb_vec3 at = rb_mat3_apply(&s->turn, local);

	return (vec){at, rb_vec3_cross(s->spin, at)};
}

static inline vec point_of(const side *s, rb_vec3 local)
{
	const vec arm = way_of(s, local);

	return (vec){rb_vec3_add(s->at, arm.at), rb_vec3_add(s->velocity, arm.rate)};
}

/* Seen from the body: its own coordinates. */
static inline vec seen_from(const side *s, vec p)
{
	const rb_vec3 d = rb_vec3_sub(p.at, s->at);
	const rb_vec3 v = rb_vec3_sub(rb_vec3_sub(p.rate, s->velocity), rb_vec3_cross(s->spin, d));

	return (vec){rb_mat3_apply_transposed(&s->turn, d), rb_mat3_apply_transposed(&s->turn, v)};
}

typedef struct {
	const side *of;
	vec from, along; /* along: unit */
	double length, radius;
} line;

static inline bool line_of(const side *s, rb_part part, line *out)
{
	const rb_core *core = s->core;
	const rb_vec3 z = {0, 0, 1};

	out->of = s;
	if (kind_of(part) == RB_PART_MANTLE && core->kind == RB_CORE_CYLINDER) {
		out->from = point_of(s, (rb_vec3){0, 0, -core->half_height});
		out->along = way_of(s, z);
		out->length = 2 * core->half_height;
		out->radius = core->round;
		return true;
	}
	if (kind_of(part) != RB_PART_EDGE || core->kind != RB_CORE_POLYTOPE ||
	    index_of(part) >= core->polytope->edge_count)
		return false;
	const int *edge = core->polytope->edges[index_of(part)];
	const rb_vec3 p = core->polytope->vertices[edge[0]];
	const rb_vec3 d = rb_vec3_sub(core->polytope->vertices[edge[1]], p);

	out->from = point_of(s, p);
	out->along = way_of(s, rb_vec3_unit(d, z));
	out->length = rb_vec3_length(d);
	out->radius = core->radius;
	return true;
}

static inline void nearer(num *inside, num value)
{
	if (value.at < inside->at)
		*inside = value;
}

static const num endless = {(double)INFINITY, 0};

static inline void within_line(num *inside, const line *e, num along)
{
	nearer(inside, along);
	nearer(inside, (num){e->length - along.at, -along.rate});
}

static inline void put(struct rb_feature_point *out, num gap, vec normal, vec point, num inside)
{
	*out = (struct rb_feature_point){.gap = gap.at,
	                                 .normal = normal.at,
	                                 .normal_rate = normal.rate,
	                                 .point = point.at,
	                                 .point_rate = point.rate,
	                                 .inside = inside.at,
	                                 .inside_rate = inside.rate};
}

/* Which way is out at the middle of an edge: from the middle of its body. */
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
