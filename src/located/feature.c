/* SPDX-License-Identifier: MIT */
/*
 * Contact points of named features in closed form, with first derivatives (`num`, `vec`: value and
 * rate). A pair of features determines normal, gap and point: a corner or rim over a surface by the
 * surface's normal; corners and lines by the vector between nearest points; two lines by the
 * direction perpendicular to both, or by the normal of the face in which they lie. `ending` is the
 * distance of the point from the end of its features, and the feature beyond.
 */
#include "located/feature.h"

#include <float.h>
#include <stddef.h>

#include "located/feature_inside.h"

/* A flat feature: face, end of a cylinder, half space; offset by the core's radius. */
typedef struct {
	const side *of;
	vec normal, point;
	rb_part part;
	double radius;
} surface;

/* The surface of a part; false: it is none of this core. */
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
	out->normal = vector_of(s, normal);
	out->point = point_of(s, local);
	return true;
}

/* A round point: a corner, or an end of a mantle's axis. */
typedef struct {
	const side *of;
	rb_part part;
	vec at;
	double radius;
} corner;

/* The corner of a part; false: it is none of this core. */
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

/* ---- distance from the end of a feature ---- */

/* Distance of p from the nearest border of the surface, and what lies beyond it. */
static ending within_surface(const surface *f, vec p)
{
	const vec seen = in_body_axes(f->of, p);
	const rb_core *core = f->of->core;
	ending end = endless;

	if (kind_of(f->part) == RB_PART_END) {
		const vec flat = {{seen.at.x, seen.at.y, 0}, {seen.rate.x, seen.rate.y, 0}};
		const rb_part rim = rb_part_of(RB_PART_RIM, index_of(f->part));
		vec out;
		num radial = {0, 0};

		direction(flat, &out, &radial);
		limit_ending(&end, (num){core->round - radial.at, -radial.rate}, SECOND, rim);
		return end;
	}
	if (core->kind != RB_CORE_POLYTOPE)
		return end;
	const struct rb_polytope *p_ = core->polytope;
	const rb_polytope_face *face = &p_->faces[index_of(f->part)];
	for (int k = 0; k < face->count; k++) {
		const int v = p_->loop[face->first + k];
		const int w = p_->loop[face->first + (k + 1 < face->count ? k + 1 : 0)];
		const rb_vec3 here = p_->vertices[v];
		const rb_vec3 along = rb_vec3_sub(p_->vertices[w], here);
		const rb_vec3 in = rb_vec3_cross(face->normal, rb_vec3_unit(along, face->normal));
		const num margin = {rb_vec3_dot(in, rb_vec3_sub(seen.at, here)),
		                    rb_vec3_dot(in, seen.rate)};

		if (margin.at < end.margin.at)
			limit_ending(&end, margin, SECOND,
			             rb_part_of(RB_PART_EDGE, rb_polytope_edge(p_, v, w)));
	}
	return end;
}

/*
 * Limits to vectors `to` without a positive component along an edge from the corner, else that edge
 * is nearer.
 */
static void within_corner(ending *end, const corner *c, vec to, side_index owner)
{
	const struct rb_polytope *p = c->of->core->polytope;
	const rb_vec3 z = {0, 0, 1};

	if (kind_of(c->part) == RB_PART_MANTLE) {
		const num along = dot(vector_of(c->of, z), to);

		limit_ending(end, index_of(c->part) == 1 ? along : (num){-along.at, -along.rate},
		             owner, 0);
		return;
	}
	const int v = index_of(c->part);
	for (int k = 0; k < p->edge_count; k++) {
		const int *edge = p->edges[k];
		if (edge[0] != v && edge[1] != v)
			continue;
		const int other = edge[0] == v ? edge[1] : edge[0];
		const rb_vec3 d = rb_vec3_unit(rb_vec3_sub(p->vertices[other], p->vertices[v]), z);
		const num along = dot(vector_of(c->of, d), to);

		limit_ending(end, (num){-along.at, -along.rate}, owner,
		             rb_part_of(RB_PART_EDGE, k));
	}
}

/* ---- contacts by kinds of feature ---- */

/* A point x of one core, with a radius, over a surface of the other. */
static void over_surface(struct rb_feature_point *out, vec x, double radius, const surface *f)
{
	const num height = dot(f->normal, minus(x, f->point));
	const ending end = within_surface(f, x);

	set_point(out, (num){height.at - radius - f->radius, height.rate}, negative(f->normal),
	          plus_constant(x, -radius, f->normal), &end);
}

/*
 * A direction in the body's axes without its component along the cylinder's axis. If projected in
 * world axes, the rounding of that component would be a share of a small tilt and lift the rim's
 * lowest point off the end's plane.
 */
static vec across_axis(const side *s, vec way)
{
	const rb_vec3 at = rb_mat3_apply_transposed(&s->turn, way.at);
	const rb_vec3 rate = rb_mat3_apply_transposed(
		&s->turn, rb_vec3_sub(way.rate, rb_vec3_cross(s->spin, way.at)));

	return (vec){{at.x, at.y, 0}, {rate.x, rate.y, 0}};
}

/* A direction that moves in the body's axes, in world axes with its total rate. */
static vec in_world_axes(const side *s, vec local)
{
	const vec way = vector_of(s, local.at);

	return (vec){way.at, rb_vec3_add(way.rate, rb_mat3_apply(&s->turn, local.rate))};
}

/* Sine below which a tilt is rounding and has no direction. */
static const double flat_sine = 16 * DBL_EPSILON;
/*
 * Sine of a tilt within what integration leaves of orientations: when a rim comes to lie flat, or
 * tilts from there, the direction of the remaining tilt is arbitrary, and `half` decides which was
 * meant.
 */
static const double landed_sine = 1e-11;

/* The direction of `way` or its opposite, whichever is on the side's half. */
static vec on_half(const side *s, vec way)
{
	vec out = {s->half, {0, 0, 0}};
	num length;

	if (rb_vec3_length(way.at) > landed_sine && direction(way, &out, &length) &&
	    rb_vec3_dot(out.at, s->half) < 0)
		out = negative(out);
	return out;
}

/*
 * The rim's lowest point over a surface, or a quarter of the rim counted from the other body's
 * axes.
 */
static bool rim_point(const side *s, rb_part part, const surface *f, bool is_a, vec *x)
{
	const bool mantle = kind_of(part) == RB_PART_MANTLE;
	const int index = index_of(part);
	const bool low = mantle ? index == 2 : index & 1;
	const int quarter = mantle ? 0 : index >> 1;
	const rb_core *core = s->core;
	const vec u = vector_of(s, (rb_vec3){0, 0, 1});
	const vec centre = point_of(s,
	                            (rb_vec3){0, 0, low ? -core->half_height : core->half_height});
	vec out;
	num length;

	if (core->kind != RB_CORE_CYLINDER || (mantle && index == 0) || quarter > 4)
		return false;
	const bool halved = rb_vec3_max_abs(s->half) > 0;
	if (quarter == 0 && halved) {
		out = in_world_axes(s, on_half(s, across_axis(s, negative(f->normal))));
	} else if (halved) {
		out = vector_of(s, quarter == 1 ? s->half
		                                : rb_vec3_cross((rb_vec3){0, 0, 1}, s->half));
	} else if (quarter == 0) {
		if (!direction(across_axis(s, negative(f->normal)), &out, &length) ||
		    length.at < flat_sine)
			return false;
		out = in_world_axes(s, out);
	} else {
		/*
		 * counted as in geom/patch_overlap: from an axis of the other body, about the
		 * normal from a to b
		 */
		const vec n = (low ? 1 : 0) == (is_a ? 1 : 0) ? negative(u) : u;
		vec axis = vector_of(f->of, (rb_vec3){1, 0, 0});
		if (fabs(rb_vec3_dot(axis.at, f->normal.at)) > 0.8)
			axis = vector_of(f->of, (rb_vec3){0, 1, 0});
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

/* A corner or rim over a surface. */
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

/*
 * Sine of the angle between two edges above which the cross product is accurate enough as a normal.
 */
static const double oblique_sine = 1e-3;

/* Below this sine two edges have no normal of their own. */
static const double parallel_sine = 1e-7;

/* Two lines: nearest points along the common normal, or along the given normal of a face. */
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
		/*
		 * both lie in the face: its normal and the cross product agree; if one leaves the
		 * face, the cross product remains right
		 */
		if (rb_vec3_dot(n.at, given->at) < 0)
			n = negative(n);
	} else {
		if (sine.at < parallel_sine)
			return false;
		/*
		 * round lines are separated by their radii; the outward direction of a flat
		 * polytope is in its plane and does not tell the sense of a normal across it
		 */
		double sense = rb_vec3_dot(n.at, r.at);
		if (!(a->radius + b->radius > 0))
			sense = rb_vec3_dot(n.at, outward(a)) - rb_vec3_dot(n.at, outward(b));
		if (sense < 0)
			n = negative(n);
	}
	const num square = dot(m, m);
	const num s = quotient(dot(cross(r, b->along), m), square);
	const num t = quotient(dot(cross(r, a->along), m), square);
	/* a given normal is perpendicular to one of them only: take both foot points */
	const vec from_a = given && !oblique ? plus(a->from, s, a->along) : a->from;
	const vec from_b = given && !oblique ? plus(b->from, t, b->along) : b->from;
	const num separation = dot(n, minus(from_b, from_a));
	const vec on_a = plus_constant(plus(a->from, s, a->along), a->radius, n);
	const vec on_b = plus_constant(plus(b->from, t, b->along), -b->radius, n);
	ending end = endless;

	within_line(&end, a, s, FIRST);
	within_line(&end, b, t, SECOND);
	set_point(out, (num){separation.at - a->radius - b->radius, separation.rate}, n,
	          plus_constant(on_a, 0.5, minus(on_b, on_a)), &end);
	return true;
}

/* Two round points, the normal along the vector between them; false: both are sharp. */
static bool between_points(struct rb_feature_point *out, vec from, double radius_a, vec to,
                           double radius_b, const ending *end)
{
	vec n;
	num separation;

	if (!(radius_a + radius_b > 0) || !direction(minus(to, from), &n, &separation))
		return false;
	const vec on_a = plus_constant(from, radius_a, n), on_b = plus_constant(to, -radius_b, n);

	set_point(out, (num){separation.at - radius_a - radius_b, separation.rate}, n,
	          plus_constant(on_a, 0.5, minus(on_b, on_a)), end);
	return true;
}

static bool corner_to_corner(struct rb_feature_point *out, const corner *a, const corner *b)
{
	const vec r = minus(b->at, a->at);
	ending end = endless;

	within_corner(&end, a, r, FIRST);
	within_corner(&end, b, negative(r), SECOND);
	return between_points(out, a->at, a->radius, b->at, b->radius, &end);
}

/* A corner and a line; the normal points from the corner. */
static bool corner_to_line(struct rb_feature_point *out, const corner *c, const line *e)
{
	const num along = dot(minus(c->at, e->from), e->along);
	const vec foot = plus(e->from, along, e->along);
	ending end = endless;

	within_line(&end, e, along, SECOND);
	within_borders(&end, e, minus(c->at, foot), SECOND);
	within_corner(&end, c, minus(foot, c->at), FIRST);
	return between_points(out, c->at, c->radius, foot, e->radius, &end);
}

/* A corner and the nearest point of a rim. */
static bool corner_to_rim(struct rb_feature_point *out, const corner *c, const side *s,
                          rb_part part)
{
	const rb_core *core = s->core;

	if (core->kind != RB_CORE_CYLINDER || index_of(part) > 1)
		return false;
	const double half = index_of(part) ? -core->half_height : core->half_height;
	const vec u = vector_of(s, (rb_vec3){0, 0, half < 0 ? -1 : 1});
	const vec centre = point_of(s, (rb_vec3){0, 0, half});
	const vec d = minus(c->at, centre);
	const num along = dot(d, u);
	ending end = endless;
	num radial;
	vec way;

	if (!direction(reject(d, u), &way, &radial))
		return false;
	const vec foot = plus_constant(centre, core->round, way);
	limit_ending(&end, along, SECOND, rb_part_of(RB_PART_MANTLE, 0));
	limit_ending(&end, (num){radial.at - core->round, radial.rate}, SECOND,
	             rb_part_of(RB_PART_END, index_of(part)));
	within_corner(&end, c, minus(foot, c->at), FIRST);
	return between_points(out, c->at, c->radius, foot, core->radius, &end);
}

/*
 * Contact of two features, of which the first is the corner or rim; the normal points from it.
 * `is_a`: it is a's.
 */
static bool contact_in_order(struct rb_feature_point *out, const side *a, rb_part part_a,
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

enum { IN_FACE_OF_A = 1, IN_FACE_OF_B = 2, SECOND_FACE = 4 };

static int faces_at_edges(const struct rb_polytope *p)
{
	return p->face_count > 0 ? 2 : 0;
}

/*
 * Which face at an edge (0, 1; -1: none) is perpendicular to n within the depth, m, or the slope.
 */
static int face_across(const side *s, rb_part part, rb_vec3 n, double depth, double slope)
{
	const rb_core *core = s->core;

	if (kind_of(part) != RB_PART_EDGE || core->kind != RB_CORE_POLYTOPE)
		return -1;
	const rb_vec3 local = rb_mat3_apply_transposed(&s->turn, n);
	for (int k = 0; k < faces_at_edges(core->polytope); k++) {
		const int face = core->polytope->flanks[index_of(part)][k];
		const rb_polytope_face *f = &core->polytope->faces[face];
		const rb_vec3 *const vertex = core->polytope->vertices;
		const int *const loop = &core->polytope->loop[f->first];
		double low = (double)INFINITY, high = -(double)INFINITY, width = 0;

		if (!(rb_vec3_dot(f->normal, local) > 0.5))
			continue;
		for (int i = 0; i < f->count; i++) {
			const double h = rb_vec3_dot(local, vertex[loop[i]]);

			low = fmin(low, h);
			high = fmax(high, h);
			width = fmax(width,
			             rb_vec3_length(rb_vec3_sub(vertex[loop[i]], vertex[loop[0]])));
		}
		if (high - low <= fmax(depth, slope * width))
			return k;
	}
	return -1;
}

/* The normal, from a to b, of the face that the key's mark names. */
static bool marked_normal(const side *a, const side *b, uint64_t key, vec *n)
{
	const unsigned mark = (unsigned)(key >> RB_CONTACT_KEY_MARK);
	const bool of_a = (mark & IN_FACE_OF_A) != 0;
	const side *s = of_a ? a : b;
	const rb_part part = of_a ? (rb_part)(key >> 32) : (rb_part)key;
	const struct rb_polytope *p = s->core->polytope;

	if (kind_of(part) != RB_PART_EDGE || s->core->kind != RB_CORE_POLYTOPE ||
	    index_of(part) >= p->edge_count || faces_at_edges(p) == 0)
		return false;
	*n = vector_of(s, p->faces[p->flanks[index_of(part)][mark & SECOND_FACE ? 1 : 0]].normal);
	if (!of_a)
		*n = negative(*n);
	return true;
}

bool rb_feature_contact(struct rb_feature_point *out, const struct rb_feature_side *a,
                        const struct rb_feature_side *b, uint64_t key)
{
	const rb_part part_a = (rb_part)(key >> 32), part_b = (rb_part)key;
	const bool marked = key >> RB_CONTACT_KEY_MARK != 0;
	line edge_a, edge_b;
	vec n;

	if (contact_in_order(out, a, part_a, b, part_b, true))
		return true;
	if (contact_in_order(out, b, part_b, a, part_a, false)) {
		out->normal = rb_vec3_neg(out->normal);
		out->normal_rate = rb_vec3_neg(out->normal_rate);
		out->next_is_b = !out->next_is_b;
		return true;
	}
	if (!line_of(a, part_a, &edge_a) || !line_of(b, part_b, &edge_b))
		return false;
	if (marked && !marked_normal(a, b, key, &n))
		return false;
	return across_lines(out, &edge_a, &edge_b, marked ? &n : NULL);
}

/* Direction in the rim's plane of its lowest point, or of the point that will be lowest. */
static bool half_of(const side *rim, rb_part part, const side *flat, rb_part other, rb_vec3 *half)
{
	const rb_vec3 none = {0, 0, 0};
	surface f;

	if (kind_of(part) != RB_PART_RIM || index_of(part) >> 1 != 0 ||
	    rim->core->kind != RB_CORE_CYLINDER || !surface_of(flat, other, &f))
		return false;
	const vec down = across_axis(rim, negative(f.normal));
	if (rb_vec3_max_abs(rim->half) > 0)
		*half = on_half(rim, down).at;
	else
		*half = rb_vec3_unit(rb_vec3_length(down.at) > flat_sine ? down.at : down.rate,
		                     none);
	return rb_vec3_max_abs(*half) > 0;
}

bool rb_feature_half(const struct rb_feature_side *a, const struct rb_feature_side *b, uint64_t key,
                     rb_vec3 *half)
{
	const rb_part part_a = (rb_part)(key >> 32), part_b = (rb_part)key;

	return half_of(a, part_a, b, part_b, half) || half_of(b, part_b, a, part_a, half);
}

/* ---- a flat rim ---- */

enum { LOWEST = 0, AHEAD = 1, ASIDE = 2, QUARTERS = 4 };
/* Lever arm, ulp of the lengths, below which a centre of mass is over the middle of an end. */
enum { LEVER_ULP = 64 };

/* True for a quarter of a rim. */
static bool is_quarter(rb_part part)
{
	const int place = index_of(part) >> 1;

	return kind_of(part) == RB_PART_RIM && place >= 1 && place <= QUARTERS;
}

/*
 * True if the rim comes to lie flat on the surface, or tilts from there; sets the first contact
 * point.
 */
static bool landing_of(const side *rim, rb_part part, const side *flat, rb_part other,
                       const struct rb_feature_fall *fall, struct rb_feature_rim *out)
{
	const rb_vec3 none = {0, 0, 0};
	const double least = fall->least;
	surface f;

	if (!is_quarter(part) || rim->core->kind != RB_CORE_CYLINDER ||
	    !surface_of(flat, other, &f))
		return false;
	const double half = index_of(part) & 1 ? -rim->core->half_height : rim->core->half_height;
	/* the motion of the surface's normal in the rim's own axes moves the lowest point */
	const rb_vec3 rate = across_axis(rim, negative(f.normal)).rate;
	const vec end = point_of(rim, (rb_vec3){0, 0, half}), centre = in_body_axes(flat, end);
	const rb_vec3 comes = rb_mat3_apply(&flat->turn, centre.rate);
	const rb_vec3 slip = rb_vec3_reject(comes, f.normal.at);
	const rb_vec3 off = rb_vec3_sub(fall->middle, end.at);
	const rb_vec3 lever = rb_vec3_reject(off, f.normal.at);
	const bool slips = rb_vec3_length(slip) > least;
	const bool is_off_centre = rb_vec3_length(lever) >
	                           LEVER_ULP * DBL_EPSILON *
	                                   (rim->core->round + rb_vec3_length(off));

	out->turns = 2 * rim->core->round * rb_vec3_length(rate) > least;
	out->direction = rb_vec3_unit(
		out->turns ? rate : across_axis(rim, (vec){slips ? slip : lever, none}).at, none);
	return out->turns || (rb_vec3_dot(comes, f.normal.at) < -least && (slips || is_off_centre));
}

bool rb_feature_landing(const struct rb_feature_side *a, const struct rb_feature_side *b,
                        const struct rb_feature_fall *fall, struct rb_feature_rim *out)
{
	const rb_part part_a = (rb_part)(fall->key >> 32), part_b = (rb_part)fall->key;

	return landing_of(a, part_a, b, part_b, fall, out) ||
	       landing_of(b, part_b, a, part_a, fall, out);
}

/* The key with another position on the rim. */
static uint64_t with_place(uint64_t key, int place)
{
	rb_part part[2] = {(rb_part)(key >> 32), (rb_part)key};

	for (int k = 0; k < 2; k++)
		if (is_quarter(part[k])) {
			part[k] = rb_part_of(RB_PART_RIM, (index_of(part[k]) & 1) | place << 1);
			break;
		}
	return (uint64_t)part[0] << 32 | part[1];
}

uint64_t rb_feature_of_rim(const struct rb_feature_rim *rim, uint64_t quarter, bool aside)
{
	return with_place(quarter, aside ? ASIDE : rim->turns ? LOWEST : AHEAD);
}

bool rb_feature_is_quarter(uint64_t key)
{
	return is_quarter((rb_part)(key >> 32)) || is_quarter((rb_part)key);
}

bool rb_feature_flat_rim(const struct rb_feature_side *a, const struct rb_feature_side *b,
                         uint64_t key, struct rb_feature_flat_rim *out)
{
	const rb_part part[2] = {(rb_part)(key >> 32), (rb_part)key};

	for (int k = 0; k < 2; k++) {
		const side *const rim = k ? b : a, *const flat = k ? a : b;
		const double half = index_of(part[k]) & 1 ? -rim->core->half_height
		                                          : rim->core->half_height;
		surface f;

		if (!is_quarter(part[k]) || rim->core->kind != RB_CORE_CYLINDER ||
		    !surface_of(flat, part[1 - k], &f))
			continue;
		*out = (struct rb_feature_flat_rim){
			.centre = point_of(rim, (rb_vec3){0, 0, half}).at,
			.turn = rim->turn,
			.radius = rim->core->round,
			.key = with_place(key, AHEAD)};
		return true;
	}
	return false;
}

/* ---- names ---- */

/*
 * Marks a key of two lines with the face in which they lie, if there is one. Lines too parallel to
 * have a normal of their own use that of a face which is as close to both as they are to each
 * other.
 */
static uint64_t in_face(const side *a, const side *b, uint64_t key, rb_vec3 n, double depth)
{
	const rb_part part_a = (rb_part)(key >> 32), part_b = (rb_part)key;
	const bool lines = (kind_of(part_a) == RB_PART_EDGE || kind_of(part_a) == RB_PART_MANTLE) &&
	                   (kind_of(part_b) == RB_PART_EDGE || kind_of(part_b) == RB_PART_MANTLE);
	uint64_t mark = IN_FACE_OF_B;
	line x, y;

	if (!lines)
		return key;
	const bool parallel = line_of(a, part_a, &x) && line_of(b, part_b, &y) &&
	                      rb_vec3_length(rb_vec3_cross(x.along.at, y.along.at)) < parallel_sine;
	const double slope = parallel ? parallel_sine : 0;
	int face = face_across(b, part_b, rb_vec3_neg(n), depth, slope);
	if (face < 0) {
		face = face_across(a, part_a, n, depth, slope);
		mark = IN_FACE_OF_A;
	}
	if (face < 0)
		return key;
	return key | (mark | (face == 1 ? SECOND_FACE : 0)) << RB_CONTACT_KEY_MARK;
}

/* The rim's key with the crossing with a line that is at `place`. */
static rb_part name_crossing(const side *disc, rb_part rim, const line *other, rb_vec3 place)
{
	const double half = index_of(rim) & 1 ? -disc->core->half_height : disc->core->half_height;
	const rb_vec3 centre = point_of(disc, (rb_vec3){0, 0, half}).at;
	const bool beyond = rb_vec3_dot(rb_vec3_sub(place, centre), other->along.at) > 0;

	return rb_part_of(RB_PART_RIM,
	                  (index_of(rim) & 1) | (beyond ? SECOND_CROSSING : FIRST_CROSSING) << 1);
}

/*
 * Replaces a rim's position by its nearest point, as which it continues; false for a counted
 * quarter, which does not continue.
 */
static bool drop_quarter(rb_part *part)
{
	const int place = index_of(*part) >> 1;

	if (kind_of(*part) != RB_PART_RIM)
		return true;
	*part = rb_part_of(RB_PART_RIM, index_of(*part) & 1);
	return place == 0 || place == FIRST_CROSSING || place == SECOND_CROSSING;
}

/* Radius of a corner or line, m; 0 for sharp ones and others. */
static double rounding_radius(const side *s, rb_part part)
{
	if (kind_of(part) == RB_PART_MANTLE)
		return s->core->round;
	return kind_of(part) == RB_PART_VERTEX || kind_of(part) == RB_PART_EDGE ? s->core->radius
	                                                                        : 0;
}

static bool is_corner(rb_part part)
{
	return kind_of(part) == RB_PART_VERTEX ||
	       (kind_of(part) == RB_PART_MANTLE && index_of(part) > 0);
}

static bool is_flat(rb_part part)
{
	return kind_of(part) == RB_PART_FACE || kind_of(part) == RB_PART_END;
}

uint64_t rb_feature_beyond(const struct rb_feature_side *sa, const struct rb_feature_side *sb,
                           uint64_t key, const struct rb_feature_point *p)
{
	const unsigned mark = (unsigned)(key >> RB_CONTACT_KEY_MARK);
	rb_part a = (rb_part)(key >> 32), b = (rb_part)key;

	/* points within faces end where other points of the same search begin */
	if (p->next == 0 || mark != 0)
		return 0;
	*(p->next_is_b ? &b : &a) = p->next;
	if (!drop_quarter(&a) || !drop_quarter(&b))
		return 0;
	/* two sharp features have no closed form */
	if ((is_corner(a) || is_corner(b)) && !is_flat(a) && !is_flat(b) &&
	    !(rounding_radius(sa, a) + rounding_radius(sb, b) > 0))
		return 0;
	return (uint64_t)a << 32 | b;
}

uint64_t rb_feature_name(const struct rb_feature_side *a, const struct rb_feature_side *b,
                         const rb_manifold *manifold, int point, double depth)
{
	const rb_manifold_point *p = &manifold->point[point];
	rb_part part_a = (rb_part)(p->key >> 32), part_b = (rb_part)p->key;
	line other;

	if (kind_of(part_a) == RB_PART_RIM && line_of(b, part_b, &other))
		part_a = name_crossing(a, part_a, &other, p->on_a);
	else if (kind_of(part_b) == RB_PART_RIM && line_of(a, part_a, &other))
		part_b = name_crossing(b, part_b, &other, p->on_b);
	return in_face(a, b, (uint64_t)part_a << 32 | part_b, manifold->normal, depth);
}
