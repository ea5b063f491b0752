/* SPDX-License-Identifier: MIT */
/*
 * Accelerations of the points of a rim along the normal are an affine function of the place, least
 * in one direction, which is down. Where that is less than none, quarters are counted anew: from
 * the point that lies as far along the rim as the centre of pressure, where a line through two
 * points carries it, which is near where a load at rest is carried; where one point does, about
 * which the end turns, from one between it and the point that is down, until these are the same.
 */
#include "located/rim_support.h"

#include "base/error.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "constraint/exact_sum.h"

/* Ulp of accelerations by loads that are rounding; how often quarters are counted anew. */
enum { LEAN_ULP = 64, ROUNDS_MAX = 24 };
/* Share of the way down from a point about which an end turns, as long as nothing else is known. */
static const double first_share = 0.125;
/* Share of the radius beyond which a point is one of the rim. */
static const double on_rim = 1 - 1e-9;
/* Sine from which on two lines cross. */
static const double crossing = 0.25;

/* A rim of a pair, and what has been tried of it. */
struct lean {
	int a, b;
	uint32_t parts;
	rb_vec3 way; /* the point about which it turned, 0: none yet */
	double off;  /* rad: how far from that down was */
	/* of the last line that carried it: along it, and how far along it the load was, radii */
	rb_vec3 along;
	double aside;
	bool anew; /* quarters are to be counted from `from` */
	rb_vec3 from;
	int of; /* contact whose rim it is */
	struct rb_feature_flat_rim rim;
};

/* A rim under its load. */
struct load {
	double bias;     /* m/s^2: with which the bodies part, in its middle */
	rb_vec3 slope;   /* 1/s^2: how that grows across the normal */
	double force;    /* N: sum of normal forces */
	int pressing;    /* how many there are */
	rb_vec3 pressed; /* N m: of them by places from the middle */
};

/* m/s^2: with which the bodies part at contact k, along the normal. */
static double parts_with(const struct rb_resolution *s, int k)
{
	const struct rb_solver_contact *c = &s->joint.contact[k];
	const struct rb_solver_body *a = &s->joint.body[c->a], *b = &s->joint.body[c->b];
	const rb_vec3 rate = rb_vec3_sub(
		rb_vec3_add(b->linear, rb_vec3_cross(b->angular, c->arm_b)),
		rb_vec3_add(a->linear, rb_vec3_cross(a->angular, c->arm_a)));

	return rb_vec3_dot(rb_vec3_add(rate, c->bias), c->normal);
}

/*
 * What the points of the pair's parts say of the rim that contact k is of; `term` is room for five
 * numbers of each contact.
 */
static struct load load_of(const struct rb_resolution *s, int k,
                           const struct rb_feature_flat_rim *rim, double *term)
{
	const struct rb_solver_contact *c = &s->joint.contact[k];
	const size_t stride = (size_t)s->contact_point_count;
	struct load load = {.pressing = 0};
	double sum[5];
	int first, count = 0;
	const int end = rb_slips_pair(s, k, &first);

	load.slope = rb_vec3_cross(
		c->normal, rb_vec3_sub(s->joint.body[c->b].angular, s->joint.body[c->a].angular));
	for (int i = first; i < end; i++) {
		const rb_vec3 place = rb_vec3_sub(s->joint.contact[i].arm_a, rim->centre);
		const double force = rb_vec3_dot(s->joint.contact[i].impulse, c->normal);

		if (s->contact_point[i].parts != s->contact_point[k].parts)
			continue;
		term[(size_t)count] = parts_with(s, i) - rb_vec3_dot(load.slope, place);
		term[(size_t)count + stride] = force;
		load.pressing += force > 0;
		term[(size_t)count + 2 * stride] = force * place.x;
		term[(size_t)count + 3 * stride] = force * place.y;
		term[(size_t)count + 4 * stride] = force * place.z;
		count++;
	}
	for (size_t i = 0; i < 5; i++)
		sum[i] = rb_exact_sum(term + i * stride, count);
	load.bias = sum[0] / count;
	load.force = sum[1];
	load.pressed = (rb_vec3){sum[2], sum[3], sum[4]};
	return load;
}

/* m/s^2: what rounding makes of accelerations of the pair. */
static double noise_of(const struct rb_resolution *s, int k)
{
	const int body[2] = {s->contact_point[k].a, s->contact_point[k].b};
	double sum = s->external_max;

	for (int i = 0; i < 2; i++)
		if (body[i] < s->l->n && s->l->place[body[i]] >= 0)
			sum += s->load[s->l->place[body[i]]];
	return LEAN_ULP * DBL_EPSILON * sum;
}

/* rad: by how much to go on from the point about which it turns, from which down is `off`. */
static double turn_by(const struct lean *lean, rb_vec3 way, rb_vec3 normal, double off)
{
	const double back = atan2(rb_vec3_dot(normal, rb_vec3_cross(way, lean->way)),
	                          rb_vec3_dot(way, lean->way));
	const double root = off * back / (off - lean->off);

	/* down is beyond the point that is sought */
	return rb_vec3_max_abs(lean->way) > 0 && root / off > 0 && root / off <= 1
	               ? root
	               : first_share * off;
}

/*
 * Where a load is to be carried that lies as far along the line as `aside`, radii: with another
 * line that carried it across the one before, where both say that it is; else at the rim.
 */
static rb_vec3 place_of(const struct lean *lean, rb_vec3 normal, rb_vec3 along, double aside)
{
	const rb_vec3 down = rb_vec3_cross(along, normal);
	const rb_vec3 across = rb_vec3_cross(normal, lean->along);
	const double between = rb_vec3_dot(along, across);
	const rb_vec3 both = rb_vec3_sub(rb_vec3_scale(aside, across),
	                                 rb_vec3_scale(lean->aside, rb_vec3_cross(normal, along)));

	if (fabs(between) > crossing)
		return rb_vec3_unit(rb_vec3_scale(1 / between, both), down);
	return rb_vec3_add(rb_vec3_scale(aside, along),
	                   rb_vec3_scale(sqrt(fmax(0, 1 - aside * aside)), down));
}

/* Sets `anew` and `from`: is the rim pressed in? */
static void look_at(const struct rb_resolution *s, struct lean *lean, double *term)
{
	const rb_vec3 n = s->contact_point[lean->of].normal;
	const struct load load = load_of(s, lean->of, &lean->rim, term);
	const rb_vec3 slope = rb_vec3_scale(-lean->rim.radius, rb_vec3_reject(load.slope, n));
	const double steep = rb_vec3_length(slope), noise = noise_of(s, lean->of);

	lean->anew = false;
	if (!(load.force > 0) || !(steep > noise))
		return;
	const rb_vec3 down = rb_vec3_scale(1 / steep, slope), along = rb_vec3_cross(n, down);
	const rb_vec3 at = rb_vec3_scale(1 / (load.force * lean->rim.radius), load.pressed);
	const double aside = rb_vec3_dot(at, along), ahead = rb_vec3_dot(at, down);

	if (load.pressing == 1 && ahead > 0 && rb_vec3_length(at) > on_rim) {
		const double off = -atan2(aside, ahead);

		if (!(fabs(aside) * steep > noise))
			return;
		const double by = turn_by(lean, at, n, off);
		lean->from = rb_vec3_add(rb_vec3_scale(cos(by), at),
		                         rb_vec3_scale(sin(by), rb_vec3_cross(n, at)));
		lean->way = at;
		lean->off = off;
		lean->anew = true;
	} else if (load.bias - steep < -noise) {
		lean->from = place_of(lean, n, along, aside);
		lean->along = along;
		lean->aside = aside;
		lean->anew = true;
	}
}

/* Is the contact one of the rim's? */
static bool is_of(const struct rb_contact_point *m, const struct lean *lean)
{
	return m->a == lean->a && m->b == lean->b && m->parts == lean->parts;
}

/* Does it lie flat, to rounding, and stay so? */
static bool lies(const struct rb_resolution *s, const struct rb_contact_point *m,
                 const struct rb_feature_flat_rim *rim)
{
	const rb_vec3 axis = rb_mat3_apply(&rim->turn, (rb_vec3){0, 0, 1});
	const rb_vec3 spin = rb_vec3_sub(m->pose_b.spin, m->pose_a.spin);

	return 2 * rim->radius * rb_vec3_length(rb_vec3_reject(axis, m->normal)) <=
	               rb_contact_point_band(s->l, m, s->t) &&
	       2 * rim->radius * rb_vec3_length(rb_vec3_reject(spin, m->normal)) <=
	               4 * rb_contact_point_noise(s->l, m);
}

/* The rim of contact k among those known; NULL: it is of none that lies flat. */
static struct lean *lean_of(const struct rb_resolution *s, int k, struct lean *all, int *count)
{
	const struct rb_contact_point *m = &s->contact_point[k];
	struct rb_feature_flat_rim rim;

	if (!rb_touch_rim_of(s->l, m, &rim) || !lies(s, m, &rim))
		return NULL;
	for (int i = 0; i < *count; i++)
		if (is_of(m, &all[i]))
			return &all[i];
	all[*count] = (struct lean){.a = m->a, .b = m->b, .parts = m->parts, .of = -1};
	return &all[(*count)++];
}

struct found {
	struct rb_contact_point point;
	struct rb_held before;
};

static int by_name(const void *left, const void *right)
{
	const struct found *const a = left, *const b = right;
	const struct rb_contact_name x = rb_contact_name_of(&a->point),
				     y = rb_contact_name_of(&b->point);

	return rb_contact_name_compare(&x, &y);
}

/* Is there a point at that place? */
static bool is_there(const struct rb_resolution *s, const struct rb_contact_point *m,
                     const struct found *all, int count)
{
	for (int k = 0; k < count; k++)
		if (rb_event_set_is_same_place(s->l, m, &all[k].point))
			return true;
	return false;
}

/* Quarters of these rims as they are to be counted, in place of those that were not held. */
static bool count_anew(struct rb_resolution *s, const struct lean *lean, int count)
{
	struct found *const all = rb_slips_take(s, s->contact_point_count + 4 * count, sizeof *all);
	int kept = 0;

	for (int k = 0; all && k < s->contact_point_count; k++) {
		const struct rb_contact_point *m = &s->contact_point[k];
		struct rb_feature_flat_rim rim;
		bool drop = false;

		for (int i = 0; i < count; i++)
			drop = drop || (lean[i].anew && is_of(m, &lean[i]) && s->before[k].a < 0 &&
			                rb_touch_rim_of(s->l, m, &rim));
		if (!drop)
			all[kept++] = (struct found){*m, s->before[k]};
	}
	for (int i = 0; all && i < count; i++) {
		if (!lean[i].anew)
			continue;
		const struct rb_contact_point m = s->contact_point[lean[i].of];
		rb_vec3 way = lean[i].from;

		for (int quarter = 0; quarter < 4; quarter++) {
			struct found *const f = &all[kept];

			f->point = rb_touch_on_rim(s->l, &m, &lean[i].rim, way);
			f->before = (struct rb_held){.a = -1};
			way = rb_vec3_cross(m.normal, way);
			kept += !(f->point.inside < -rb_contact_point_band(s->l, &m, s->t)) &&
			        !is_there(s, &f->point, all, kept);
		}
	}
	struct rb_contact_point *const point = rb_slips_take(s, kept, sizeof *point);
	struct rb_held *const before = rb_slips_take(s, kept, sizeof *before);

	if (!all || !point || !before)
		return false;
	qsort(all, (size_t)kept, sizeof *all, by_name);
	for (int k = 0; k < kept; k++) {
		point[k] = all[k].point;
		before[k] = all[k].before;
	}
	s->contact_point = point;
	s->before = before;
	s->contact_point_count = kept;
	return true;
}

/* True: quarters were counted anew. False, and l->status: no memory. */
static bool leans(struct rb_resolution *s, struct lean *all, int *count)
{
	double *const term = rb_slips_take(s, 5 * s->contact_point_count, sizeof *term);
	bool any = false;

	/* no point may be left of a rim that was counted anew before */
	for (int i = 0; i < *count; i++) {
		all[i].of = -1;
		all[i].anew = false;
	}
	for (int k = 0; term && k < s->contact_point_count; k++) {
		struct lean *const lean = lean_of(s, k, all, count);

		if (!lean || lean->of >= 0)
			continue;
		lean->of = k;
		rb_touch_rim_of(s->l, &s->contact_point[k], &lean->rim);
		look_at(s, lean, term);
		any = any || lean->anew;
	}
	return any && count_anew(s, all, *count);
}

bool rb_rim_support_solve(struct rb_resolution *s)
{
	bool solved = rb_slips_solve(s);
	int count = 0;

	if (!solved || s->contact_point_count == 0 || !s->l->model->parts)
		return solved;
	struct lean *const all = rb_slips_take(s, s->contact_point_count, sizeof *all);
	for (int round = 0; all && solved && round < ROUNDS_MAX && leans(s, all, &count); round++)
		solved = rb_slips_solve(s);
	return solved && s->l->status == RB_OK;
}
