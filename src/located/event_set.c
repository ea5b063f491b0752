/* SPDX-License-Identifier: MIT */
/*
 * The set: bodies that an event involves. It grows from its first members by clusters, force
 * elements and touching pairs until nothing is added; each pair is examined once. Points of held
 * contacts are matched to found ones by name, then by place, so that a contact keeps its identity
 * while it rolls over features.
 */
#include "located/event_set.h"

#include "base/error.h"
#include "constraint/contact_row.h"
#include "located/crowd.h"
#include "model/joints.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

void rb_event_set_add(struct rb_located *l, int i)
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, i));
	if (rb_located_fixed(l, i) || l->place[i] >= 0)
		return;
	RB_ASSERT_COSTLY(l->set_count < l->n);
	l->place[i] = l->set_count;
	l->set[l->set_count++] = i;
}

void rb_event_set_clear(struct rb_located *l)
{
	for (int k = 0; k < l->set_count; k++)
		l->place[l->set[k]] = -1;
	l->set_count = 0;
}

int rb_event_set_near(const struct rb_located *l, int i)
{
	int count = 0;

	if (l->cells)
		return rb_cells_near(l->cells, i, l->near);
	for (int j = 0; j < l->n; j++)
		if (j != i)
			l->near[count++] = j;
	return count;
}

int rb_event_set_near_once(const struct rb_located *l, int i)
{
	int count = 0;

	if (l->cells)
		return rb_cells_near_once(l->cells, i, l->near);
	for (int j = i + 1; j < l->n; j++)
		l->near[count++] = j;
	return count;
}

const struct rb_held *rb_event_set_held(const struct rb_located *l, int a, int b)
{
	const int mover = a < l->n && l->cluster_of[a] >= 0 ? a : b;

	RB_ASSERT_COSTLY(rb_located_is_body(l, a) && rb_located_is_body(l, b));
	RB_ASSERT_COSTLY(a != b);
	if (mover >= l->n || l->cluster_of[mover] < 0)
		return NULL;
	const struct rb_cluster *c = &l->cluster[l->cluster_of[mover]];
	const int low_a = a < b ? a : b, high_b = a < b ? b : a;
	int low = 0, high = c->held_count;

	while (low < high) {
		const int middle = low + (high - low) / 2;
		const struct rb_held *h = &c->held[middle];

		if (h->a < low_a || (h->a == low_a && h->b < high_b))
			low = middle + 1;
		else
			high = middle;
	}
	return low < c->held_count && c->held[low].a == low_a && c->held[low].b == high_b
	               ? &c->held[low]
	               : NULL;
}

const struct rb_held *rb_event_set_held_end(const struct rb_located *l, const struct rb_held *first)
{
	RB_ASSERT_COSTLY(first != NULL);
	const int mover = first->a < l->n && l->cluster_of[first->a] >= 0 ? first->a : first->b;
	const struct rb_cluster *c = &l->cluster[l->cluster_of[mover]];
	const struct rb_held *h = first;

	while (h < c->held + c->held_count && h->a == first->a && h->b == first->b)
		h++;
	return h;
}

struct rb_contact_point rb_event_set_contact_point(const struct rb_located *l,
                                                   const struct rb_held *held, double t)
{
	const struct rb_contact_name name = rb_event_set_name(held);

	RB_ASSERT_COSTLY(rb_located_is_body(l, held->a) && rb_located_is_body(l, held->b));
	if (rb_event_set_is_single(l, held->a, held->b))
		return rb_contact_point_at(l, held->a, held->b, t);
	const struct rb_pose pose_a = rb_arc_pose(l, held->a, t);
	const struct rb_pose pose_b = rb_arc_pose(l, held->b, t);

	return rb_contact_point_of(l, &name, &pose_a, &pose_b);
}

bool rb_event_set_touches_another(const struct rb_located *l, int i, int except, double t)
{
	const int near = i < l->n ? rb_event_set_near(l, i) : 0;
	const int count = i < l->n ? near + l->model->static_count : 0;
	const struct rb_parabola here = rb_relative_parabola(l, i, t);

	for (int k = 0; k < count; k++) {
		const int j = k < near ? l->near[k] : l->n + k - near;

		if (j == except || !rb_pair_can_touch(l, i, j) ||
		    rb_pair_remains_separated(l, i, j, &here, t, t) ||
		    rb_pair_is_far(l, i, j, t, t))
			continue;
		if (rb_pair_has_features(l, i, j))
			return true;
		const struct rb_contact_point m = rb_contact_point_at(l, i, j, t);
		if (m.gap <= rb_contact_point_band(l, &m, t))
			return true;
	}
	return false;
}

/*
 * Share of the size within which points of a pair are the same; rounding, which depends on
 * features, is far less.
 */
static const double same_place_share = 1e-9;
/* Share of friction's deceleration by which the speed of a creeping slip may change. */
static const double creep_rate_share = 0.05;
/* Share of the speeds below which a slip creeps. */
static const double creep_share = 1e-5;
/*
 * Share of the size by which rounding and integration may put a point past the end of its features.
 */
static const double end_share = 1e-11;

bool rb_event_set_is_same_place(const struct rb_located *l, const struct rb_contact_point *x,
                                const struct rb_contact_point *y)
{
	return rb_vec3_length(rb_vec3_sub(x->point, y->point)) <=
	       same_place_share * rb_contact_point_size(l, x);
}

bool rb_event_set_is_shared_place(const struct rb_located *l, const struct rb_contact_point *x,
                                  const struct rb_contact_point *y)
{
	return (x->a == y->a || x->a == y->b || x->b == y->a || x->b == y->b) &&
	       rb_event_set_is_same_place(l, x, y);
}

bool rb_event_set_has_left(const struct rb_located *l, const struct rb_contact_point *m)
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	return m->inside < 0 && m->inside < -end_share * rb_contact_point_size(l, m);
}

double rb_event_set_landing_gap(const struct rb_located *l, const struct rb_contact_point *m)
{
	struct rb_contact_name other = rb_contact_name_of(m);

	if (!(rb_vec3_max_abs(m->half) > 0))
		return 0;
	other.half = rb_vec3_neg(m->half);
	const struct rb_contact_point across = rb_contact_point_of(l, &other, &m->pose_a,
	                                                           &m->pose_b);
	/*
	 * rotating or falling flat closes faster than this (add_rim of located/convex_contact): an
	 * impact
	 */
	const double rate = rb_vec3_dot(across.velocity, across.normal);
	const double tolerance = l->model->tolerance_m;
	/* with what it has, it would rise no farther */
	const bool wobbles = rate * rate <= 2 * l->weight * tolerance &&
	                     rb_contact_material(l->model, m->a, m->b)->restitution < 1;
	const double max = fmax(end_share * rb_contact_point_size(l, &across),
	                        wobbles ? tolerance : 0);

	return rate < -4 * rb_contact_point_noise(l, &across) && across.gap > 0 && across.gap <= max
	               ? across.gap
	               : 0;
}

double rb_event_set_creep(const struct rb_located *l, const struct rb_contact_point *m)
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	return creep_share / (8 * DBL_EPSILON) * rb_contact_point_noise(l, m);
}

bool rb_event_set_is_slow(const struct rb_located *l, const struct rb_contact_point *m, double rate,
                          rb_vec3 force)
{
	const double *const inverse = l->model->inverse_mass;
	const double friction_force = rb_vec3_length(rb_vec3_reject(force, m->normal)) *
	                              (inverse[m->a] + inverse[m->b]);

	return rb_vec3_length(rb_vec3_reject(m->velocity, m->normal)) <= rb_event_set_creep(l, m) &&
	       fabs(rate) <= creep_rate_share * friction_force;
}

const struct rb_held *rb_event_set_continued(const struct rb_located *l,
                                             const struct rb_contact_point *m)
{
	const struct rb_held *const first = rb_event_set_held(l, m->a, m->b);

	RB_ASSERT_COSTLY(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	if (!first || rb_event_set_is_single(l, m->a, m->b))
		return first;
	const struct rb_held *const end = rb_event_set_held_end(l, first);
	const struct rb_contact_name wanted = rb_contact_name_of(m);
	for (const struct rb_held *h = first; h < end; h++) {
		const struct rb_contact_name name = rb_event_set_name(h);

		if (rb_contact_name_is(&name, &wanted))
			return h;
	}
	for (const struct rb_held *h = first; h < end; h++) {
		const struct rb_contact_name name = rb_event_set_name(h);
		const struct rb_contact_point now = rb_contact_point_of(l, &name, &m->pose_a,
		                                                        &m->pose_b);

		if (rb_event_set_is_same_place(l, m, &now))
			return h;
	}
	return NULL;
}

/*
 * Friction below this share of its limit sticks. With steps, friction of a slipping contact is on
 * the cone to rounding; the mean over a step in which slip began is far below.
 */
static const double stick_share = 1 - 1e-9;

static double friction_of(const struct rb_located *l, int a, int b)
{
	const struct rb_model *model = l->model;
	const int row = model->material[a] * model->material_count;

	return l->top ? model->pair_materials[row + model->material[b]].friction : 0;
}

/*
 * Adds the forces of the pair's contacts, from `first` on, that have this name; returns their
 * number. `all_round`: of all points on the rim that it names.
 */
static int add_named_forces(const struct rb_located *l, const struct rb_contact *first,
                            const struct rb_contact_name *name, bool all_round,
                            struct rb_contact *sum)
{
	const uint64_t rim = all_round ? rb_contact_key_all_round(name->key) : 0;
	int count = 0;

	for (const struct rb_contact *c = first;
	     c < l->stepped_contacts.row + l->stepped_contacts.count; c++) {
		if (c->a != name->a || c->b != name->b)
			break;
		if (c->parts != name->parts || (all_round && rim == 0) ||
		    (all_round ? rb_contact_key_all_round(c->key) != rim : c->key != name->key))
			continue;
		sum->normal_force += c->normal_force;
		sum->tangent_force = rb_vec3_add(sum->tangent_force, c->tangent_force);
		count++;
	}
	return count;
}

bool rb_event_set_left_of(const struct rb_located *l, const struct rb_contact_point *m,
                          struct rb_event_set_left *left)
{
	const struct rb_contact_name own = rb_contact_name_of(m),
				     name = rb_contact_name_shared(&own);
	const struct rb_contact *const first = rb_contacts_first(&l->stepped_contacts, m->a, m->b);
	struct rb_contact sum = {.a = m->a};

	if (!first)
		return false;
	RB_ASSERT_COSTLY(m->a < m->b);
	int count = add_named_forces(l, first, &name, false, &sum);
	if (count == 0)
		count = add_named_forces(l, first, &name, true, &sum);
	if (!(sum.normal_force > 0))
		return false;
	const double normal = sum.normal_force / count;
	const rb_vec3 tangent = rb_vec3_scale(1.0 / count,
	                                      rb_vec3_reject(sum.tangent_force, m->normal));
	left->force = rb_vec3_add_scaled(tangent, normal, m->normal);
	left->sticks = rb_vec3_length(tangent) < stick_share * friction_of(l, m->a, m->b) * normal;
	left->slip = left->sticks ? (rb_vec3){0, 0, 0}
	                          : rb_vec3_unit(rb_vec3_neg(tangent), (rb_vec3){0, 0, 0});
	return true;
}

bool rb_event_set_touching(const struct rb_located *l, const struct rb_contact_point *m, double t,
                           double slack)
{
	(void)slack;
	return m->gap <= rb_contact_point_band(l, m, t) &&
	       !(rb_pair_has_features(l, m->a, m->b) && rb_contact_point_passes(l, m, t));
}

bool rb_event_set_lasting(const struct rb_located *l, const struct rb_contact_point *m, double t,
                          double slack)
{
	const double rate = rb_vec3_dot(m->velocity, m->normal);
	const double rest_speed = rb_contact_point_noise(l, m) + slack;

	/* impacts were resolved before, except those that another method has left */
	return m->gap <= rb_contact_point_band(l, m, t) && rate <= rest_speed &&
	       (!l->starting || rate >= -rest_speed);
}

/* Share of the size by which a held point may drift from contact. */
static const double drift_share = 1e-9;

/* Contact points found so far, and what decides whether one joins. */
struct pairs {
	double t, slack;
	rb_event_set_joins *joins;
	struct rb_contact_point *row; /* in the arena */
	int count, capacity;
	bool failed;
};

/* Appends a point; the array doubles within the arena. */
static void append_point(struct rb_located *l, struct pairs *pairs,
                         const struct rb_contact_point *m)
{
	if (pairs->count == pairs->capacity) {
		const int capacity = pairs->capacity > 0 ? 2 * pairs->capacity : 8;
		struct rb_contact_point *const grown = rb_arena_take(l->arena, (size_t)capacity,
		                                                     sizeof *grown);

		if (!grown) {
			pairs->failed = true;
			return;
		}
		if (pairs->count > 0)
			memcpy(grown, pairs->row, (size_t)pairs->count * sizeof *grown);
		pairs->row = grown;
		pairs->capacity = capacity;
	}
	pairs->row[pairs->count++] = *m;
}

/* Largest drift of a pair's held points, m; integration leaves some roundings. */
static double drift_of(const struct rb_located *l, const struct rb_held *first,
                       const struct rb_held *end, double t)
{
	double drift = 0;

	for (const struct rb_held *h = first; h < end; h++) {
		const struct rb_contact_point m = rb_event_set_contact_point(l, h, t);

		drift = fmax(drift,
		             fmin(2 * fabs(m.gap), drift_share * rb_contact_point_size(l, &m)));
	}
	return drift;
}

/*
 * True if the point has passed the end of its features; with `others`, to within rounding, because
 * other points of the pair have.
 */
static bool has_passed(const struct rb_located *l, const struct rb_contact_point *m, bool others)
{
	return m->beyond != 0 &&
	       (rb_event_set_has_left(l, m) || (others && m->inside < 0 && m->inside_rate < 0));
}

/* Another touching point at this place that does not separate: of adjacent features. */
static const struct rb_contact_point *successor_of(const struct rb_located *l,
                                                   const struct rb_contact_point *m,
                                                   const struct rb_contact_point *all, int count)
{
	for (int k = 0; k < count; k++)
		if (rb_event_set_is_same_place(l, m, &all[k]) &&
		    rb_vec3_dot(all[k].velocity, all[k].normal) <=
		            rb_contact_point_noise(l, &all[k]))
			return &all[k];
	return NULL;
}

/*
 * Passes held points on to adjacent features. The contact stays the same, neither ended nor new,
 * although its normal is off by the overshoot. Points of a pair that roll together are passed on
 * together.
 */
static void pass_on_points(const struct rb_located *l, struct rb_contact_point *m, int count,
                           const struct rb_contact_point *all, int all_count)
{
	bool any = false;

	for (int k = 0; k < count; k++)
		any = any || has_passed(l, &m[k], false);
	for (int k = 0; k < count && any; k++) {
		if (!has_passed(l, &m[k], true))
			continue;
		const struct rb_contact_point *const other = successor_of(l, &m[k], all, all_count);

		m[k] = other ? *other : rb_touch_passed_on(l, &m[k]);
	}
}

/* True if a point of the same name or place is among the first `count` of `of`. */
static bool is_known(const struct rb_located *l, const struct rb_contact_point *m,
                     const struct rb_contact_point *of, int count)
{
	const struct rb_contact_name name = rb_contact_name_of(m);

	for (int k = 0; k < count; k++) {
		const struct rb_contact_name known = rb_contact_name_of(&of[k]);

		if (rb_contact_name_is(&name, &known) || rb_event_set_is_same_place(l, m, &of[k]))
			return true;
	}
	return false;
}

/* Replaces the point on which a rim rolled by the one of that name with which it now lies flat. */
static void replace_landed(struct rb_contact_point *m, const struct rb_contact_point *all,
                           int count)
{
	const struct rb_contact_name name = rb_contact_name_of(m);

	for (int k = 0; k < count && rb_vec3_max_abs(m->half) > 0; k++) {
		const struct rb_contact_name other = rb_contact_name_of(&all[k]);

		if (rb_vec3_max_abs(all[k].half) > 0 && rb_contact_name_is(&name, &other)) {
			*m = all[k];
			return;
		}
	}
}

/*
 * Collects the points of a pair with features: those held, and others that touch. `come`: the
 * pair's touch is the event.
 */
static void inspect_points(struct rb_located *l, struct pairs *pairs, int a, int b, bool come)
{
	struct rb_contact_point all[RB_CONTACT_POINTS_MAX], held[RB_CONTACT_POINTS_MAX];
	const struct rb_held *const first = rb_event_set_held(l, a, b);
	const struct rb_held *const end = first ? rb_event_set_held_end(l, first) : NULL;
	const int before = pairs->count;
	double drift = drift_of(l, first, end, pairs->t);

	for (const struct rb_held *h = first; h < end && come; h++) {
		const struct rb_contact_point m = rb_event_set_contact_point(l, h, pairs->t);

		drift = fmax(drift, rb_event_set_landing_gap(l, &m));
	}
	int count = rb_pair_contact_points(l, a, b, pairs->t, drift, all);

	/* points as close as the held ones count as touching */
	for (int k = 0; k < count && drift > 0; k++)
		all[k].gap = fmin(all[k].gap, 0);
	int held_count = 0;
	for (const struct rb_held *h = first; h < end && held_count < RB_CONTACT_POINTS_MAX; h++)
		held[held_count++] = rb_event_set_contact_point(l, h, pairs->t);
	for (int h = 0; h < held_count; h++)
		replace_landed(&held[h], all, count);
	pass_on_points(l, held, held_count, all, count);
	for (int h = 0; h < held_count; h++) {
		int left = 0;

		/* a point that has left its features is kept only if it is the last of its pair */
		if (rb_event_set_has_left(l, &held[h]) && (count > 0 || held_count > 1))
			continue;
		if (is_known(l, &held[h], held, h))
			continue;
		for (int k = 0; k < count; k++)
			if (!is_known(l, &all[k], &held[h], 1))
				all[left++] = all[k];
		count = left;
		append_point(l, pairs, &held[h]);
	}
	if (come && count == 0 && pairs->count == before) {
		all[0] = rb_contact_point_at(l, a, b, pairs->t);
		all[0].gap = fmin(all[0].gap, 0);
		count = 1;
	}
	for (int k = 0; k < count; k++)
		if (pairs->joins(l, &all[k], pairs->t, pairs->slack))
			append_point(l, pairs, &all[k]);
	if (pairs->count > before) {
		rb_event_set_add(l, a);
		rb_event_set_add(l, b);
	}
}

/* Collects the contact points of a pair. */
static void inspect_pair(struct rb_located *l, struct pairs *pairs, int i, int j)
{
	if (!rb_pair_can_touch(l, i, j))
		return;
	const bool come = (i == l->touch_a && j == l->touch_b) ||
	                  (i == l->touch_b && j == l->touch_a);
	const bool held = rb_event_set_held(l, i, j) != NULL;
	if (!come && !held && rb_pair_is_far(l, i, j, pairs->t, pairs->t))
		return;
	if (!rb_event_set_is_single(l, i, j)) {
		inspect_points(l, pairs, i < j ? i : j, i < j ? j : i, come);
		return;
	}
	struct rb_contact_point m = rb_contact_point_at(l, i < j ? i : j, i < j ? j : i, pairs->t);
	/* a located touch counts as touching, whatever the rounding of the gap */
	if (come)
		m.gap = fmin(m.gap, 0);
	if (!held && !pairs->joins(l, &m, pairs->t, pairs->slack))
		return;
	append_point(l, pairs, &m);
	rb_event_set_add(l, j);
}

void rb_event_set_add_partners(struct rb_located *l, int i)
{
	const struct rb_model *model = l->model;

	for (int k = 0; k < model->element_list_count; k++) {
		const struct rb_elements *elements = &model->elements[k];

		for (int m = elements->end ? elements->first[i] : 0;
		     elements->end && m < elements->first[i + 1]; m++) {
			const int *const end = elements->end[elements->of[m]];

			rb_event_set_add(l, end[0] == i ? end[1] : end[0]);
		}
	}
}

/* Adds the bodies at the other ends of joints. */
static void add_joined(struct rb_located *l, int i)
{
	const struct rb_joints *joints = l->model->joints;

	for (int e = joints->first[i]; e < joints->first[i + 1]; e++) {
		const struct rb_joint *joint = &joints->joint[joints->of[e]];
		const int other = joint->a == i ? joint->b : joint->a;

		if (other >= 0)
			rb_event_set_add(l, other);
	}
}

static int by_name(const void *left, const void *right)
{
	const struct rb_contact_name x = rb_contact_name_of(left), y = rb_contact_name_of(right);

	return rb_contact_name_compare(&x, &y);
}

/*
 * Adds all bodies that gravitation joins to members of the set. Not for an impact, which spreads
 * through contacts only.
 */
static void add_attracted(struct rb_located *l)
{
	bool any = false;

	for (int k = 0; k < l->set_count; k++)
		any = any || rb_gravitation_attracts(l->model, l->set[k]);
	for (int i = 0; any && i < l->n; i++)
		if (rb_gravitation_attracts(l->model, i))
			rb_event_set_add(l, i);
}

int rb_event_set_grow(struct rb_located *l, double t, double slack, rb_event_set_joins *joins,
                      struct rb_contact_point **found)
{
	struct pairs pairs = {.t = t, .slack = slack, .joins = joins};
	const bool is_impact = joins == rb_event_set_touching;

	RB_ASSERT(slack >= 0);
	RB_ASSERT(l->set_count > 0);
	if (rb_located_gravitates(l) && !is_impact)
		add_attracted(l);
	for (int k = 0; k < l->set_count && !pairs.failed; k++) {
		const int i = l->set[k];

		/* with gravitation, an impact adds members of the cluster only by contact */
		if (l->cluster_of[i] >= 0 && !(is_impact && rb_located_gravitates(l))) {
			const struct rb_cluster *c = &l->cluster[l->cluster_of[i]];

			for (int m = 0; m < c->member_count; m++)
				rb_event_set_add(l, c->member[m]);
		}
		rb_event_set_add_partners(l, i);
		if (l->model->joints)
			add_joined(l, i);
		if (!(l->model->features & RB_FEATURE_CONTACT))
			continue;
		const int near = rb_event_set_near(l, i);
		for (int m = 0; m < near; m++) {
			const int j = l->near[m];

			/* each pair once: from its earlier member of the set */
			if (rb_located_driven(l, j) || l->place[j] < 0 || l->place[j] > k)
				inspect_pair(l, &pairs, i, j);
		}
		for (int j = l->n; j < l->n + l->model->static_count; j++)
			inspect_pair(l, &pairs, i, j);
	}
	if (pairs.failed)
		return -1;
	/* two spheres do not count as a crowd */
	for (int k = 1; k < l->set_count && (l->set_count > 2 || l->model->parts); k++)
		rb_crowd_join(l, l->set[0], l->set[k]);
	rb_crowd_limit(l, l->set[0]);
	if (pairs.count > 1)
		qsort(pairs.row, (size_t)pairs.count, sizeof *pairs.row, by_name);
	*found = pairs.row;
	return pairs.count;
}
