/* SPDX-License-Identifier: MIT */
/*
 * The normal acceleration of the points of a rim is an affine function of position, with its
 * minimum in one direction, "down". If the minimum is negative, the rim's four points (quarters)
 * are moved. If a line through two points carries the load, they start at the point with the same
 * coordinate along this line as the centre of pressure, which is near where a load at rest is
 * carried. If a single point does, about which the end rotates, they start between it and the
 * lowest point, until the two are the same.
 */
#include "located/rim_support.h"

#include "base/error.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "constraint/exact_sum.h"

/* Rounding of accelerations, in ulp of those by loads; rounds of moving quarters. */
enum { LEAN_ULP = 64, ROUNDS_MAX = 24 };
/* Share of the angle to the lowest point to move at first, when no other information is known. */
static const double first_share = 0.125;
/* Share of the radius from which a point is on the rim. */
static const double on_rim = 1 - 1e-9;
/* Least sine of two lines that cross. */
static const double crossing = 0.25;

/* State of the search for a rim of a pair. */
struct rim_state {
	int a, b;
	uint32_t parts;
	rb_vec3 direction; /* point about which it rotated, 0: none yet */
	double off;        /* rad: angle from that to the lowest point */
	/*
	 * last line that carried the load: its direction, and the load's coordinate along it, radii
	 */
	rb_vec3 along;
	double offset;
	bool moves; /* quarters must start at `start` */
	rb_vec3 start;
	int contact; /* a contact of the rim */
	struct rb_feature_flat_rim rim;
};

/* Load and motion of a rim. */
struct load {
	double bias;     /* m/s^2: opening acceleration at its centre */
	rb_vec3 slope;   /* 1/s^2: its gradient, tangential */
	double force;    /* N: sum of normal forces */
	int pressing;    /* number of positive normal forces */
	rb_vec3 pressed; /* N m: sum of normal forces times positions from the centre */
};

/* Opening acceleration at contact k, along the normal, m/s^2. */
static double opening_acceleration(const struct rb_resolution *s, int k)
{
	const struct rb_solver_contact *c = &s->problem.contact[k];
	const struct rb_solver_body *a = &s->problem.body[c->a], *b = &s->problem.body[c->b];
	const rb_vec3 rate = rb_vec3_sub(
		rb_vec3_add(b->linear, rb_vec3_cross(b->angular, c->arm_b)),
		rb_vec3_add(a->linear, rb_vec3_cross(a->angular, c->arm_a)));

	return rb_vec3_dot(rb_vec3_add(rate, c->bias), c->normal);
}

/*
 * Load and motion of the rim of contact k, from all points of the pair's parts; `term`: scratch for
 * five numbers per contact.
 */
static struct load load_of(const struct rb_resolution *s, int k,
                           const struct rb_feature_flat_rim *rim, double *term)
{
	const struct rb_solver_contact *c = &s->problem.contact[k];
	const size_t stride = (size_t)s->contact_point_count;
	struct load load = {.pressing = 0};
	double sum[5];
	int first, count = 0;
	const int end = rb_slips_pair(s, k, &first);

	load.slope = rb_vec3_cross(c->normal, rb_vec3_sub(s->problem.body[c->b].angular,
	                                                  s->problem.body[c->a].angular));
	for (int i = first; i < end; i++) {
		const rb_vec3 place = rb_vec3_sub(s->problem.contact[i].arm_a, rim->centre);
		const double force = rb_vec3_dot(s->problem.contact[i].impulse, c->normal);

		if (s->contact_point[i].parts != s->contact_point[k].parts)
			continue;
		term[(size_t)count] = opening_acceleration(s, i) - rb_vec3_dot(load.slope, place);
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

/* Rounding of accelerations of the pair, m/s^2. */
static double noise_of(const struct rb_resolution *s, int k)
{
	const int body[2] = {s->contact_point[k].a, s->contact_point[k].b};
	double sum = s->external_max;

	for (int i = 0; i < 2; i++)
		if (body[i] < s->l->n && s->l->place[body[i]] >= 0)
			sum += s->load[s->l->place[body[i]]];
	return LEAN_ULP * DBL_EPSILON * sum;
}

/*
 * Angle by which to move from the point about which it rotates, when the lowest one is at `off`,
 * rad.
 */
static double angle_step(const struct rim_state *rim_state, rb_vec3 direction, rb_vec3 normal,
                         double off)
{
	const double back = atan2(
		rb_vec3_dot(normal, rb_vec3_cross(direction, rim_state->direction)),
		rb_vec3_dot(direction, rim_state->direction));
	const double root = off * back / (off - rim_state->off);

	/* the lowest point is beyond the one sought */
	return rb_vec3_max_abs(rim_state->direction) > 0 && root / off > 0 && root / off <= 1
	               ? root
	               : first_share * off;
}

/*
 * Point, in radii, that should carry a load with coordinate `offset` along the line: the
 * intersection with the previous line, if these cross; otherwise on the rim.
 */
static rb_vec3 carrying_point(const struct rim_state *rim_state, rb_vec3 normal, rb_vec3 along,
                              double offset)
{
	const rb_vec3 down = rb_vec3_cross(along, normal);
	const rb_vec3 across = rb_vec3_cross(normal, rim_state->along);
	const double between = rb_vec3_dot(along, across);
	const rb_vec3 both = rb_vec3_sub(
		rb_vec3_scale(offset, across),
		rb_vec3_scale(rim_state->offset, rb_vec3_cross(normal, along)));

	if (fabs(between) > crossing)
		return rb_vec3_unit(rb_vec3_scale(1 / between, both), down);
	return rb_vec3_add(rb_vec3_scale(offset, along),
	                   rb_vec3_scale(sqrt(fmax(0, 1 - offset * offset)), down));
}

/* Sets `moves` and `start`, depending on whether the rim would penetrate. */
static void inspect_rim(const struct rb_resolution *s, struct rim_state *rim_state, double *term)
{
	const rb_vec3 n = s->contact_point[rim_state->contact].normal;
	const struct load load = load_of(s, rim_state->contact, &rim_state->rim, term);
	const rb_vec3 slope = rb_vec3_scale(-rim_state->rim.radius, rb_vec3_reject(load.slope, n));
	const double steep = rb_vec3_length(slope), noise = noise_of(s, rim_state->contact);

	rim_state->moves = false;
	if (!(load.force > 0) || !(steep > noise))
		return;
	const rb_vec3 down = rb_vec3_scale(1 / steep, slope), along = rb_vec3_cross(n, down);
	const rb_vec3 at = rb_vec3_scale(1 / (load.force * rim_state->rim.radius), load.pressed);
	const double offset = rb_vec3_dot(at, along), ahead = rb_vec3_dot(at, down);

	if (load.pressing == 1 && ahead > 0 && rb_vec3_length(at) > on_rim) {
		const double off = -atan2(offset, ahead);

		if (!(fabs(offset) * steep > noise))
			return;
		const double by = angle_step(rim_state, at, n, off);
		rim_state->start = rb_vec3_add(rb_vec3_scale(cos(by), at),
		                               rb_vec3_scale(sin(by), rb_vec3_cross(n, at)));
		rim_state->direction = at;
		rim_state->off = off;
		rim_state->moves = true;
	} else if (load.bias - steep < -noise) {
		rim_state->start = carrying_point(rim_state, n, along, offset);
		rim_state->along = along;
		rim_state->offset = offset;
		rim_state->moves = true;
	}
}

/* Is it a contact of this rim? */
static bool is_of(const struct rb_contact_point *m, const struct rim_state *rim_state)
{
	return m->a == rim_state->a && m->b == rim_state->b && m->parts == rim_state->parts;
}

/* Does it lie flat, and remain flat, to rounding? */
static bool lies_flat(const struct rb_resolution *s, const struct rb_contact_point *m,
                      const struct rb_feature_flat_rim *rim)
{
	const rb_vec3 axis = rb_mat3_apply(&rim->turn, (rb_vec3){0, 0, 1});
	const rb_vec3 spin = rb_vec3_sub(m->pose_b.spin, m->pose_a.spin);

	return 2 * rim->radius * rb_vec3_length(rb_vec3_reject(axis, m->normal)) <=
	               rb_contact_point_band(s->l, m, s->t) &&
	       2 * rim->radius * rb_vec3_length(rb_vec3_reject(spin, m->normal)) <=
	               4 * rb_contact_point_noise(s->l, m);
}

/* Returns the state of contact k's rim, adding a new one; NULL: it has no rim that lies flat. */
static struct rim_state *rim_state_of(const struct rb_resolution *s, int k, struct rim_state *all,
                                      int *count)
{
	const struct rb_contact_point *m = &s->contact_point[k];
	struct rb_feature_flat_rim rim;

	if (!rb_touch_rim_of(s->l, m, &rim) || !lies_flat(s, m, &rim))
		return NULL;
	for (int i = 0; i < *count; i++)
		if (is_of(m, &all[i]))
			return &all[i];
	all[*count] = (struct rim_state){.a = m->a, .b = m->b, .parts = m->parts, .contact = -1};
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

/* Is there a point at this place? */
static bool is_there(const struct rb_resolution *s, const struct rb_contact_point *m,
                     const struct found *all, int count)
{
	for (int k = 0; k < count; k++)
		if (rb_event_set_is_same_place(s->l, m, &all[k].point))
			return true;
	return false;
}

/* Replaces the quarters of rims that move, except those that were held, by new ones. */
static bool move_quarters(struct rb_resolution *s, const struct rim_state *rim_state, int count)
{
	struct found *const all = rb_slips_take(s, s->contact_point_count + 4 * count, sizeof *all);
	int kept = 0;

	for (int k = 0; all && k < s->contact_point_count; k++) {
		const struct rb_contact_point *m = &s->contact_point[k];
		struct rb_feature_flat_rim rim;
		bool drop = false;

		for (int i = 0; i < count; i++)
			drop = drop || (rim_state[i].moves && is_of(m, &rim_state[i]) &&
			                s->before[k].a < 0 && rb_touch_rim_of(s->l, m, &rim));
		if (!drop)
			all[kept++] = (struct found){*m, s->before[k]};
	}
	for (int i = 0; all && i < count; i++) {
		if (!rim_state[i].moves)
			continue;
		const struct rb_contact_point m = s->contact_point[rim_state[i].contact];
		rb_vec3 direction = rim_state[i].start;

		for (int quarter = 0; quarter < 4; quarter++) {
			struct found *const f = &all[kept];

			f->point = rb_touch_on_rim(s->l, &m, &rim_state[i].rim, direction);
			f->before = (struct rb_held){.a = -1};
			direction = rb_vec3_cross(m.normal, direction);
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

/* True: quarters were moved. False with l->status: out of memory. */
static bool update_rims(struct rb_resolution *s, struct rim_state *all, int *count)
{
	double *const term = rb_slips_take(s, 5 * s->contact_point_count, sizeof *term);
	bool any = false;

	/* a rim whose quarters were moved before may have no point left */
	for (int i = 0; i < *count; i++) {
		all[i].contact = -1;
		all[i].moves = false;
	}
	for (int k = 0; term && k < s->contact_point_count; k++) {
		struct rim_state *const rim_state = rim_state_of(s, k, all, count);

		if (!rim_state || rim_state->contact >= 0)
			continue;
		rim_state->contact = k;
		rb_touch_rim_of(s->l, &s->contact_point[k], &rim_state->rim);
		inspect_rim(s, rim_state, term);
		any = any || rim_state->moves;
	}
	return any && move_quarters(s, all, *count);
}

bool rb_rim_support_solve(struct rb_resolution *s)
{
	bool solved = rb_slips_solve(s);
	int count = 0;

	if (!solved || s->contact_point_count == 0 || !s->l->model->parts)
		return solved;
	struct rim_state *const all = rb_slips_take(s, s->contact_point_count, sizeof *all);
	for (int round = 0; all && solved && round < ROUNDS_MAX && update_rims(s, all, &count);
	     round++)
		solved = rb_slips_solve(s);
	return solved && s->l->status == RB_OK;
}
