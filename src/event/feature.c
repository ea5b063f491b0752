/* SPDX-License-Identifier: MIT */
/* Values go with their derivatives in time, so each formula is written once. */
#include "event/feature.h"

#include <float.h>
#include <stddef.h>

typedef struct {
	rb_vec3 at, rate;
} vec;

typedef struct {
	double at, rate;
} num;

typedef struct rb_feature_side side;

static vec minus(vec a, vec b)
{
	return (vec){rb_vec3_sub(a.at, b.at), rb_vec3_sub(a.rate, b.rate)};
}

static num dot(vec a, vec b)
{
	return (num){rb_vec3_dot(a.at, b.at),
	             rb_vec3_dot(a.rate, b.at) + rb_vec3_dot(a.at, b.rate)};
}

static vec cross(vec a, vec b)
{
	return (vec){rb_vec3_cross(a.at, b.at),
	             rb_vec3_add(rb_vec3_cross(a.rate, b.at), rb_vec3_cross(a.at, b.rate))};
}

/* a + s b */
static vec plus(vec a, num s, vec b)
{
	return (vec){rb_vec3_add_scaled(a.at, s.at, b.at),
	             rb_vec3_add_scaled(rb_vec3_add_scaled(a.rate, s.rate, b.at), s.at, b.rate)};
}

static vec plus_constant(vec a, double s, vec b)
{
	return plus(a, (num){s, 0}, b);
}

static vec negative(vec a)
{
	return (vec){rb_vec3_neg(a.at), rb_vec3_neg(a.rate)};
}

static vec reject(vec a, vec unit)
{
	const num along = dot(a, unit);

	return plus(a, (num){-along.at, -along.rate}, unit);
}

static num quotient(num a, num b)
{
	const double q = a.at / b.at;

	return (num){q, (a.rate - q * b.rate) / b.at};
}

/* Its length, and its direction; a length of zero has none, and gives false. */
static bool direction(vec a, vec *unit, num *length)
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

static rb_part_kind kind_of(rb_part part)
{
	return (rb_part_kind)(part >> 24 & 15);
}

static int index_of(rb_part part)
{
	return (int)(part & 0xffffff);
}

static vec way_of(const side *s, rb_vec3 local)
{
	const rb_vec3 at = rb_mat3_apply(&s->turn, local);

	return (vec){at, rb_vec3_cross(s->spin, at)};
}

static vec point_of(const side *s, rb_vec3 local)
{
	const vec arm = way_of(s, local);

	return (vec){rb_vec3_add(s->at, arm.at), rb_vec3_add(s->velocity, arm.rate)};
}

/* Seen from the body: its own coordinates. */
static vec seen_from(const side *s, vec p)
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

static bool line_of(const side *s, rb_part part, line *out)
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

typedef struct {
	const side *of;
	vec normal, point;
	rb_part part;
	double radius;
} surface;

static bool surface_of(const side *s, rb_part part, surface *out)
{
	const rb_core *core = s->core;
	const int i = index_of(part);
	rb_vec3 local = {0, 0, 0}, normal = {0, 0, 1};

	*out = (surface){.of = s, .part = part, .radius = core->radius};
	switch (kind_of(part)) {
	case RB_PART_FACE:
	case RB_PART_SEVERAL:
		if (core->kind != RB_CORE_POLYTOPE || i >= core->polytope->face_count)
			return false;
		normal = core->polytope->faces[i].normal;
		local = core->polytope
		                ->vertices[core->polytope->loop[core->polytope->faces[i].first]];
		break;
	case RB_PART_END:
		if (core->kind != RB_CORE_CYLINDER)
			return false;
		normal.z = i ? -1 : 1;
		local.z = i ? -core->half_height : core->half_height;
		break;
	case RB_PART_SURFACE:
		if (core->kind != RB_CORE_HALF_SPACE)
			return false;
		break;
	default:
		return false;
	}
	out->normal = way_of(s, normal);
	out->point = point_of(s, local);
	return true;
}

/* A point with a ball about it: a corner, or an end of a mantle's axis. */
typedef struct {
	const side *of;
	rb_part part;
	vec at;
	double radius;
} corner;

static bool corner_of(const side *s, rb_part part, corner *out)
{
	const rb_core *core = s->core;
	const int i = index_of(part);

	*out = (corner){.of = s, .part = part, .radius = core->radius};
	if (kind_of(part) == RB_PART_VERTEX && core->kind == RB_CORE_POLYTOPE &&
	    i < core->polytope->vertex_count) {
		out->at = point_of(s, core->polytope->vertices[i]);
		return true;
	}
	if (kind_of(part) == RB_PART_MANTLE && i > 0 && core->kind == RB_CORE_CYLINDER) {
		const double half = i == 1 ? core->half_height : -core->half_height;

		out->at = point_of(s, (rb_vec3){0, 0, half});
		out->radius = core->round;
		return true;
	}
	return false;
}

/* ---- how far from the end of a feature ---- */

static void nearer(num *inside, num value)
{
	if (value.at < inside->at)
		*inside = value;
}

static const num endless = {(double)INFINITY, 0};

static num within_surface(const surface *f, vec p)
{
	const vec seen = seen_from(f->of, p);
	const rb_core *core = f->of->core;
	num inside = endless;

	if (kind_of(f->part) == RB_PART_END) {
		const vec flat = {{seen.at.x, seen.at.y, 0}, {seen.rate.x, seen.rate.y, 0}};
		vec out;
		num radial;

		if (!direction(flat, &out, &radial))
			return (num){core->round, 0};
		return (num){core->round - radial.at, -radial.rate};
	}
	if (core->kind != RB_CORE_POLYTOPE)
		return inside;
	const struct rb_polytope *p_ = core->polytope;
	const rb_polytope_face *face = &p_->faces[index_of(f->part)];
	for (int k = 0; k < face->count; k++) {
		const rb_vec3 here = p_->vertices[p_->loop[face->first + k]];
		const rb_vec3 next =
			p_->vertices[p_->loop[face->first + (k + 1 < face->count ? k + 1 : 0)]];
		const rb_vec3 in = rb_vec3_cross(
			face->normal, rb_vec3_unit(rb_vec3_sub(next, here), face->normal));

		nearer(&inside, (num){rb_vec3_dot(in, rb_vec3_sub(seen.at, here)),
		                      rb_vec3_dot(in, seen.rate)});
	}
	return inside;
}

static void within_line(num *inside, const line *e, num along)
{
	nearer(inside, along);
	nearer(inside, (num){e->length - along.at, -along.rate});
}

/* What is nearest to the corner must not lie farther along one of the edges that end there. */
static void within_corner(num *inside, const corner *c, vec to)
{
	const struct rb_polytope *p = c->of->core->polytope;
	const rb_vec3 z = {0, 0, 1};

	if (kind_of(c->part) == RB_PART_MANTLE) {
		const num along = dot(way_of(c->of, z), to);

		nearer(inside, index_of(c->part) == 1 ? along : (num){-along.at, -along.rate});
		return;
	}
	const int v = index_of(c->part);
	for (int k = 0; k < p->edge_count; k++) {
		const int *edge = p->edges[k];
		if (edge[0] != v && edge[1] != v)
			continue;
		const int other = edge[0] == v ? edge[1] : edge[0];
		const rb_vec3 d = rb_vec3_unit(rb_vec3_sub(p->vertices[other], p->vertices[v]), z);
		const num along = dot(way_of(c->of, d), to);

		nearer(inside, (num){-along.at, -along.rate});
	}
}

/* ---- what meets what ---- */

static void put(struct rb_feature_point *out, num gap, vec normal, vec point, num inside)
{
	*out = (struct rb_feature_point){.gap = gap.at,
	                                 .normal = normal.at,
	                                 .normal_rate = normal.rate,
	                                 .point = point.at,
	                                 .point_rate = point.rate,
	                                 .inside = inside.at,
	                                 .inside_rate = inside.rate};
}

/* A point of one core over a surface of the other: `x` on the core, `radius` round it. */
static void over_surface(struct rb_feature_point *out, vec x, double radius, const surface *f)
{
	const num height = dot(f->normal, minus(x, f->point));

	put(out, (num){height.at - radius - f->radius, height.rate}, negative(f->normal),
	    plus_constant(x, -radius, f->normal), within_surface(f, x));
}

/* The point of a rim that lies lowest over a surface, or a quarter of it counted from the other body's axes. */
static bool rim_point(const side *s, rb_part part, const surface *f, bool is_a, vec *x)
{
	const bool mantle = kind_of(part) == RB_PART_MANTLE;
	const int index = index_of(part);
	const bool low = mantle ? index == 2 : index & 1;
	const int quarter = mantle ? 0 : index >> 1;
	const rb_core *core = s->core;
	const vec u = way_of(s, (rb_vec3){0, 0, 1});
	const vec centre = point_of(s,
	                            (rb_vec3){0, 0, low ? -core->half_height : core->half_height});
	vec out;
	num length;

	if (core->kind != RB_CORE_CYLINDER || (mantle && index == 0) || quarter > 4)
		return false;
	if (quarter == 0) {
		if (!direction(reject(negative(f->normal), u), &out, &length) || length.at < 1e-8)
			return false;
	} else {
		/* as geom/overlay counts them: from an axis of the other body, turning about the normal from a to b */
		const vec n = (low ? 1 : 0) == (is_a ? 1 : 0) ? negative(u) : u;
		vec axis = way_of(f->of, (rb_vec3){1, 0, 0});
		if (fabs(rb_vec3_dot(axis.at, f->normal.at)) > 0.8)
			axis = way_of(f->of, (rb_vec3){0, 1, 0});
		if (!direction(reject(axis, n), &out, &length))
			return false;
		if (quarter % 2 == 0)
			out = cross(n, out);
		if (quarter > 2)
			out = negative(out);
	}
	*x = plus_constant(centre, core->round, out);
	return true;
}

static bool on_surface(struct rb_feature_point *out, const side *s, rb_part part, const surface *f,
                       bool is_a)
{
	corner c;
	vec x;

	if (kind_of(part) == RB_PART_VERTEX && corner_of(s, part, &c)) {
		over_surface(out, c.at, c.radius, f);
		return true;
	}
	if ((kind_of(part) == RB_PART_RIM || kind_of(part) == RB_PART_MANTLE) &&
	    rim_point(s, part, f, is_a, &x)) {
		over_surface(out, x, 0, f);
		return true;
	}
	return false;
}

/* Which way is out at the middle of an edge: from the middle of its body. */
static rb_vec3 outward(const line *e)
{
	const rb_core *core = e->of->core;
	rb_vec3 middle = {0, 0, 0};

	if (core->kind == RB_CORE_POLYTOPE)
		middle = core->polytope->middle;
	const rb_vec3 half = rb_vec3_add_scaled(e->from.at, 0.5 * e->length, e->along.at);
	return rb_vec3_sub(rb_vec3_sub(half, e->of->at), rb_mat3_apply(&e->of->turn, middle));
}

/* Sine of the angle between two edges from which on rounding leaves enough of the normal across both. */
static const double oblique_sine = 1e-3;

static bool across_lines(struct rb_feature_point *out, const line *a, const line *b,
                         const vec *given)
{
	const vec r = minus(b->from, a->from);
	const vec m = cross(a->along, b->along);
	vec n;
	num sine;

	if (!direction(m, &n, &sine) || !(sine.at > 8 * DBL_EPSILON))
		return false;
	const bool oblique = sine.at > oblique_sine;

	if (given && !oblique) {
		n = *given;
	} else if (given) {
		/* where both lie in the face this is its normal; where one leaves it, still theirs */
		if (rb_vec3_dot(n.at, given->at) < 0)
			n = negative(n);
	} else {
		if (sine.at < 1e-7)
			return false;
		double sense = rb_vec3_dot(n.at, outward(a)) - rb_vec3_dot(n.at, outward(b));
		/* a segment has no inside */
		if (fabs(sense) <= 1e-9 * (a->length + b->length))
			sense = rb_vec3_dot(n.at, r.at);
		if (sense < 0)
			n = negative(n);
	}
	const num square = dot(m, m);
	const num s = quotient(dot(cross(r, b->along), m), square);
	const num t = quotient(dot(cross(r, a->along), m), square);
	/* a given normal is across one of them only */
	const vec from_a = given && !oblique ? plus(a->from, s, a->along) : a->from;
	const vec from_b = given && !oblique ? plus(b->from, t, b->along) : b->from;
	const num apart = dot(n, minus(from_b, from_a));
	const vec on_a = plus_constant(plus(a->from, s, a->along), a->radius, n);
	const vec on_b = plus_constant(plus(b->from, t, b->along), -b->radius, n);
	num inside = endless;

	within_line(&inside, a, s);
	within_line(&inside, b, t);
	put(out, (num){apart.at - a->radius - b->radius, apart.rate}, n,
	    plus_constant(on_a, 0.5, minus(on_b, on_a)), inside);
	return true;
}

/* From a round thing at `from` to another at `to`. */
static bool between_points(struct rb_feature_point *out, vec from, double radius_a, vec to,
                           double radius_b, num inside)
{
	vec n;
	num apart;

	if (!(radius_a + radius_b > 0) || !direction(minus(to, from), &n, &apart))
		return false;
	const vec on_a = plus_constant(from, radius_a, n), on_b = plus_constant(to, -radius_b, n);

	put(out, (num){apart.at - radius_a - radius_b, apart.rate}, n,
	    plus_constant(on_a, 0.5, minus(on_b, on_a)), inside);
	return true;
}

static bool corner_to_corner(struct rb_feature_point *out, const corner *a, const corner *b)
{
	const vec r = minus(b->at, a->at);
	num inside = endless;

	within_corner(&inside, a, r);
	within_corner(&inside, b, negative(r));
	return between_points(out, a->at, a->radius, b->at, b->radius, inside);
}

/* The normal points from the corner. */
static bool corner_to_line(struct rb_feature_point *out, const corner *c, const line *e)
{
	const num along = dot(minus(c->at, e->from), e->along);
	const vec foot = plus(e->from, along, e->along);
	num inside = endless;

	within_line(&inside, e, along);
	within_corner(&inside, c, minus(foot, c->at));
	return between_points(out, c->at, c->radius, foot, e->radius, inside);
}

static bool corner_to_rim(struct rb_feature_point *out, const corner *c, const side *s,
                          rb_part part)
{
	const rb_core *core = s->core;

	if (core->kind != RB_CORE_CYLINDER || index_of(part) > 1)
		return false;
	const double half = index_of(part) ? -core->half_height : core->half_height;
	const vec u = way_of(s, (rb_vec3){0, 0, half < 0 ? -1 : 1});
	const vec centre = point_of(s, (rb_vec3){0, 0, half});
	const vec d = minus(c->at, centre);
	const num along = dot(d, u);
	num inside = endless, radial;
	vec way;

	if (!direction(reject(d, u), &way, &radial))
		return false;
	const vec foot = plus_constant(centre, core->round, way);
	nearer(&inside, along);
	nearer(&inside, (num){radial.at - core->round, radial.rate});
	within_corner(&inside, c, minus(foot, c->at));
	return between_points(out, c->at, c->radius, foot, core->radius, inside);
}

/* The first of the two is the one that has the corner or the rim; the normal points from it. It is a, or not. */
static bool meet_in_order(struct rb_feature_point *out, const side *a, rb_part part_a,
                          const side *b, rb_part part_b, bool is_a)
{
	surface face;
	corner point, other;
	line edge;

	if (surface_of(b, part_b, &face))
		return on_surface(out, a, part_a, &face, is_a);
	if (!corner_of(a, part_a, &point))
		return false;
	if (corner_of(b, part_b, &other))
		return corner_to_corner(out, &point, &other);
	if (line_of(b, part_b, &edge))
		return corner_to_line(out, &point, &edge);
	return kind_of(part_b) == RB_PART_RIM && corner_to_rim(out, &point, b, part_b);
}

/* ---- edges within faces ---- */

enum { IN_FACE_OF_A = 1, IN_FACE_OF_B = 2, SECOND_FACE = 4, MARK_SHIFT = 60 };

/* The faces at an edge. */
static int faces_at(const struct rb_polytope *p, int edge, int faces[2])
{
	const int v = p->edges[edge][0], w = p->edges[edge][1];
	int count = 0;

	for (int f = 0; f < p->face_count && count < 2; f++) {
		const int *loop = p->loop + p->faces[f].first, n = p->faces[f].count;
		for (int k = 0; k < n; k++) {
			const int x = loop[k], y = loop[k + 1 < n ? k + 1 : 0];
			if ((x == v && y == w) || (x == w && y == v)) {
				faces[count++] = f;
				break;
			}
		}
	}
	return count;
}

/* Which of the faces at an edge lies across n, to within the depth: 0, 1; -1: none. */
static int face_across(const side *s, rb_part part, rb_vec3 n, double depth)
{
	const rb_core *core = s->core;
	int faces[2];

	if (kind_of(part) != RB_PART_EDGE || core->kind != RB_CORE_POLYTOPE)
		return -1;
	const rb_vec3 local = rb_mat3_apply_transposed(&s->turn, n);
	const int count = faces_at(core->polytope, index_of(part), faces);
	for (int k = 0; k < count; k++) {
		const rb_polytope_face *f = &core->polytope->faces[faces[k]];
		double low = (double)INFINITY, high = -(double)INFINITY;

		if (!(rb_vec3_dot(f->normal, local) > 0.5))
			continue;
		for (int i = 0; i < f->count; i++) {
			const int v = core->polytope->loop[f->first + i];
			const double h = rb_vec3_dot(local, core->polytope->vertices[v]);

			low = fmin(low, h);
			high = fmax(high, h);
		}
		if (high - low <= depth)
			return k;
	}
	return -1;
}

uint64_t rb_feature_in_face(const struct rb_feature_side *a, const struct rb_feature_side *b,
                            uint64_t key, rb_vec3 n, double depth)
{
	const rb_part part_a = (rb_part)(key >> 32), part_b = (rb_part)key;
	const bool lines = (kind_of(part_a) == RB_PART_EDGE || kind_of(part_a) == RB_PART_MANTLE) &&
	                   (kind_of(part_b) == RB_PART_EDGE || kind_of(part_b) == RB_PART_MANTLE);
	uint64_t mark = IN_FACE_OF_B;

	if (!lines)
		return key;
	int face = face_across(b, part_b, rb_vec3_neg(n), depth);
	if (face < 0) {
		face = face_across(a, part_a, n, depth);
		mark = IN_FACE_OF_A;
	}
	if (face < 0)
		return key;
	return key | (mark | (face == 1 ? SECOND_FACE : 0)) << MARK_SHIFT;
}

/* The normal, from a to b, that the key's mark names. */
static bool marked_normal(const side *a, const side *b, uint64_t key, vec *n)
{
	const unsigned mark = (unsigned)(key >> MARK_SHIFT);
	const bool of_a = (mark & IN_FACE_OF_A) != 0;
	const side *s = of_a ? a : b;
	const rb_part part = of_a ? (rb_part)(key >> 32) : (rb_part)key;
	int faces[2];

	if (kind_of(part) != RB_PART_EDGE || s->core->kind != RB_CORE_POLYTOPE ||
	    index_of(part) >= s->core->polytope->edge_count)
		return false;
	const int count = faces_at(s->core->polytope, index_of(part), faces);
	const int k = mark & SECOND_FACE ? 1 : 0;
	if (k >= count)
		return false;
	*n = way_of(s, s->core->polytope->faces[faces[k]].normal);
	if (!of_a)
		*n = negative(*n);
	return true;
}

bool rb_feature_meet(struct rb_feature_point *out, const struct rb_feature_side *a,
                     const struct rb_feature_side *b, uint64_t key)
{
	const rb_part part_a = (rb_part)(key >> 32), part_b = (rb_part)key;
	const bool marked = key >> MARK_SHIFT != 0;
	line edge_a, edge_b;
	vec n;

	if (meet_in_order(out, a, part_a, b, part_b, true))
		return true;
	if (meet_in_order(out, b, part_b, a, part_a, false)) {
		out->normal = rb_vec3_neg(out->normal);
		out->normal_rate = rb_vec3_neg(out->normal_rate);
		return true;
	}
	if (!line_of(a, part_a, &edge_a) || !line_of(b, part_b, &edge_b))
		return false;
	if (marked && !marked_normal(a, b, key, &n))
		return false;
	return across_lines(out, &edge_a, &edge_b, marked ? &n : NULL);
}

/* ---- rims ---- */

/* A line or a circle: its point at a parameter (m; radians), and two derivatives by it. */
typedef struct {
	bool round;
	line straight;
	vec centre, x, y; /* of a circle: radii across each other, m */
	vec at, first, second;
} curve;

static bool curve_of(const side *s, rb_part part, curve *out)
{
	const rb_core *core = s->core;

	*out = (curve){.round = kind_of(part) == RB_PART_RIM};
	if (!out->round)
		return line_of(s, part, &out->straight);
	if (core->kind != RB_CORE_CYLINDER)
		return false;
	const double half = index_of(part) & 1 ? -core->half_height : core->half_height;
	out->centre = point_of(s, (rb_vec3){0, 0, half});
	out->x = way_of(s, (rb_vec3){core->round, 0, 0});
	out->y = way_of(s, (rb_vec3){0, core->round, 0});
	out->straight.of = s;
	return true;
}

/* The parameter at which it is nearest to a place. */
static double nearest_on(const curve *c, rb_vec3 near)
{
	if (!c->round)
		return rb_vec3_dot(rb_vec3_sub(near, c->straight.from.at), c->straight.along.at);
	const rb_vec3 d = rb_vec3_sub(near, c->centre.at);
	return atan2(rb_vec3_dot(d, c->y.at), rb_vec3_dot(d, c->x.at));
}

static void go_to(curve *c, double s)
{
	const vec none = {{0, 0, 0}, {0, 0, 0}};

	if (!c->round) {
		c->at = plus_constant(c->straight.from, s, c->straight.along);
		c->first = c->straight.along;
		c->second = none;
		return;
	}
	const double co = cos(s), si = sin(s);
	const vec out = plus_constant(plus_constant(none, co, c->x), si, c->y);
	c->at = plus_constant(c->centre, 1, out);
	c->first = plus_constant(plus_constant(none, -si, c->x), co, c->y);
	c->second = negative(out);
}

/* Along a curve whose parameter changes at this rate as well. */
static vec carried(vec p, double rate, vec by)
{
	p.rate = rb_vec3_add_scaled(p.rate, rate, by.at);
	return p;
}

/* r.a' = 0 and r.b' = 0 for r from a's point to b's: what is left of both, and what changes of parameters make of it. */
typedef struct {
	double left[2], rate[2], m[2][2], whole;
} foot_point;

static foot_point foot_of(const curve *a, const curve *b)
{
	const vec r = minus(b->at, a->at);
	const num on_a = dot(r, a->first), on_b = dot(r, b->first);
	foot_point f = {.left = {on_a.at, on_b.at}, .rate = {on_a.rate, on_b.rate}};

	f.m[0][0] = rb_vec3_dot(r.at, a->second.at) - rb_vec3_dot(a->first.at, a->first.at);
	f.m[0][1] = rb_vec3_dot(b->first.at, a->first.at);
	f.m[1][0] = -f.m[0][1];
	f.m[1][1] = rb_vec3_dot(r.at, b->second.at) + rb_vec3_dot(b->first.at, b->first.at);
	f.whole = f.m[0][0] * f.m[1][1] - f.m[0][1] * f.m[1][0];
	return f;
}

static void solve(const foot_point *f, const double right[2], double out[2])
{
	out[0] = (right[0] * f->m[1][1] - right[1] * f->m[0][1]) / f->whole;
	out[1] = (right[1] * f->m[0][0] - right[0] * f->m[1][0]) / f->whole;
}

/* Which way is out of a body where a curve is. */
static rb_vec3 outward_of(const curve *c)
{
	if (!c->round)
		return outward(&c->straight);
	return rb_vec3_sub(c->at.at, c->straight.of->at);
}

/* Of a line, the way to its ends; at a rim, what the outward normal has along the end's and along the mantle's. */
static void within_curve(num *inside, const curve *c, double s, double rate, vec n)
{
	if (!c->round) {
		within_line(inside, &c->straight, (num){s, rate});
		return;
	}
	const vec at = carried(c->at, rate, c->first);
	const vec radial = minus(at, c->centre);
	vec u = cross(c->x, c->y);
	if (rb_vec3_dot(u.at, rb_vec3_sub(c->centre.at, c->straight.of->at)) < 0)
		u = negative(u);
	const double per = 1 / rb_vec3_length(radial.at);
	const num on_end = dot(n, u), on_mantle = dot(n, radial);

	nearer(inside, (num){on_end.at * per, on_end.rate * per});
	nearer(inside, on_mantle);
}

bool rb_feature_curves(struct rb_feature_point *out, const struct rb_feature_side *a,
                       const struct rb_feature_side *b, uint64_t key, rb_vec3 near)
{
	enum { ROUNDS = 12 };
	const rb_part part_a = (rb_part)(key >> 32), part_b = (rb_part)key;
	double s[2], step[2], rate[2];
	curve on_a, on_b;
	foot_point foot;
	vec n;
	num sine, inside = endless;

	if ((kind_of(part_a) != RB_PART_RIM && kind_of(part_b) != RB_PART_RIM) ||
	    !curve_of(a, part_a, &on_a) || !curve_of(b, part_b, &on_b))
		return false;
	s[0] = nearest_on(&on_a, near);
	s[1] = nearest_on(&on_b, near);
	for (int k = 0; k < ROUNDS; k++) {
		go_to(&on_a, s[0]);
		go_to(&on_b, s[1]);
		foot = foot_of(&on_a, &on_b);
		if (!(fabs(foot.whole) > 0))
			return false;
		solve(&foot, foot.left, step);
		s[0] -= step[0];
		s[1] -= step[1];
		if (fabs(step[0]) <= 4 * DBL_EPSILON * (1 + fabs(s[0])) &&
		    fabs(step[1]) <= 4 * DBL_EPSILON * (1 + fabs(s[1])))
			break;
		if (k + 1 == ROUNDS)
			return false;
	}
	solve(&foot, foot.rate, rate);
	rate[0] = -rate[0];
	rate[1] = -rate[1];
	const vec at_a = carried(on_a.at, rate[0], on_a.first);
	const vec at_b = carried(on_b.at, rate[1], on_b.first);
	const vec m = cross(carried(on_a.first, rate[0], on_a.second),
	                    carried(on_b.first, rate[1], on_b.second));
	if (!direction(m, &n, &sine) ||
	    sine.at < 1e-6 * rb_vec3_length(on_a.first.at) * rb_vec3_length(on_b.first.at))
		return false;
	if (rb_vec3_dot(n.at, outward_of(&on_a)) - rb_vec3_dot(n.at, outward_of(&on_b)) < 0)
		n = negative(n);
	const double radius_a = on_a.round ? 0 : on_a.straight.radius;
	const double radius_b = on_b.round ? 0 : on_b.straight.radius;
	const num apart = dot(n, minus(at_b, at_a));
	const vec surface_a = plus_constant(at_a, radius_a, n);
	const vec surface_b = plus_constant(at_b, -radius_b, n);
	within_curve(&inside, &on_a, s[0], rate[0], n);
	within_curve(&inside, &on_b, s[1], rate[1], negative(n));
	put(out, (num){apart.at - radius_a - radius_b, apart.rate}, n,
	    plus_constant(surface_a, 0.5, minus(surface_b, surface_a)), inside);
	return true;
}
