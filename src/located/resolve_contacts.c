/* SPDX-License-Identifier: MIT */
/*
 * Resolves the contacts of a set at a moment: collects the touching points, removes the drift of
 * lasting ones, finds all forces and modes together (constraint/simultaneous), and writes a cluster
 * for each connected part, or free arcs. The result depends on set and moment only.
 */
#include "located/resolve_contacts.h"

#include "base/error.h"
#include "base/forest.h"

#include <float.h>
#include <string.h>

#include "located/account.h"
#include "located/cluster.h"
#include "located/integrate.h"
#include "located/joint_rest.h"
#include "located/joint_stops.h"
#include "located/rest_rates.h"
#include "located/mechanics.h"
#include "located/piece_warm_start.h"
#include "located/external_force.h"
#include "located/tangential_impact.h"
#include "located/slips.h"
#include "located/rim_support.h"
#include "located/event_records.h"
#include "located/transition.h"
#include "located/work.h"

/* Rounding, in ulp, of speeds (of a fall by the body's size) and of accelerations (of the load). */
enum { REST_ULP = 64, LOAD_ULP = 64 };
/* Share of friction that is missing where the solver has reduced it; above its residual. */
static const double reduced_share = 1e-9;

/* Accelerations below this share of the external ones are residuals of the solver. */
static const double rest_share = 1e-12;

/* ---- gathering ---- */

/* Velocity, m/s, due to rounding of a held contact's force since its cluster began. */
static double drift_of(const struct rb_located *l, const struct rb_held *held, double t)
{
	const int is_dynamic = rb_located_fixed(l, held->a) ? held->b : held->a;
	const double age = t - l->cluster[l->cluster_of[is_dynamic]].anchor_s;

	return 16 * DBL_EPSILON * age * rb_vec3_length(held->force) *
	       (l->model->inverse_mass[held->a] + l->model->inverse_mass[held->b]);
}

/* True if the piece at whose end the slip stops has reached its end, without being cut before. */
static bool has_ended(const struct rb_located *l, const struct rb_held *held, double t)
{
	const int is_dynamic = rb_located_fixed(l, held->a) ? held->b : held->a;

	return !l->cluster[l->cluster_of[is_dynamic]].integrated ||
	       t >= l->piece[is_dynamic].until_s;
}

/* Collects the set's contact points and poses, and the contacts held before. */
static bool begin(struct rb_resolution *s)
{
	struct rb_located *l = s->l;

	s->contact_point_count = rb_event_set_grow(l, s->t, s->slack, rb_event_set_lasting,
	                                           &s->contact_point);
	if (s->contact_point_count < 0) {
		rb_slips_take(s, -1, SIZE_MAX / 2);
		return false;
	}
	s->before = rb_slips_take(s, s->contact_point_count, sizeof *s->before);
	s->pose = rb_slips_take(s, l->set_count, sizeof *s->pose);
	s->linear = rb_slips_take(s, l->set_count, sizeof *s->linear);
	s->angular = rb_slips_take(s, l->set_count, sizeof *s->angular);
	s->constant = rb_slips_take(s, l->set_count, sizeof *s->constant);
	s->constant_at_rest = rb_slips_take(s, l->set_count, sizeof *s->constant_at_rest);
	s->root = rb_slips_take(s, l->set_count, sizeof *s->root);
	s->load = rb_slips_take(s, l->set_count, sizeof *s->load);
	if (l->status != RB_OK)
		return false;
	for (int k = 0; k < l->set_count; k++) {
		s->pose[k] = rb_arc_pose(l, l->set[k], s->t);
		s->root[k] = k;
	}
	s->joints = (struct rb_joint_rows){
		.l = l, .body = l->set, .pose = s->pose, .body_count = l->set_count};
	if (!rb_joint_rows_collect(&s->joints)) {
		rb_slips_take(s, -1, SIZE_MAX / 2);
		return false;
	}
	if (s->joints.joint_count > 0)
		rb_joint_stops_ease(&s->joints, s->t);
	if (l->status != RB_OK)
		return false;
	for (int k = 0; k < s->contact_point_count; k++) {
		const struct rb_held *held = rb_event_set_continued(l, &s->contact_point[k]);

		s->before[k] = (struct rb_held){.a = -1};
		if (!held)
			continue;
		s->before[k] = *held;
		s->before[k].ending = held->ending && has_ended(l, held, s->t);
		s->drift = fmax(s->drift, drift_of(l, held, s->t));
	}
	return true;
}

/* Normal velocity, m/s, that a lasting contact may have by rounding. */
static double rounding_speed(const struct rb_resolution *s, const struct rb_contact_point *m)
{
	return rb_contact_point_noise(s->l, m) + s->slack + s->drift;
}

/* The same, plus the drift of integration. */
static double integration_speed(const struct rb_resolution *s, const struct rb_contact_point *m)
{
	return rounding_speed(s, m) + rb_drift_correct * (rb_vec3_length(m->pose_a.velocity) +
	                                                  rb_vec3_length(m->pose_b.velocity));
}

/* The same, but only rounding after an impact, whose velocities are exact. */
static double drift_speed(const struct rb_resolution *s, const struct rb_contact_point *m)
{
	return rb_slips_is_after_impact(s, m) ? rounding_speed(s, m) : integration_speed(s, m);
}

/* True if a held contact separates or has left its features, or if a body of it was moved away. */
static bool separates(const struct rb_resolution *s, const struct rb_contact_point *m)
{
	const double max = drift_speed(s, m);

	return rb_vec3_dot(m->velocity, m->normal) > max || rb_event_set_has_left(s->l, m) ||
	       m->gap > fmax(rb_drift_correct * rb_contact_point_size(s->l, m),
	                     rb_contact_point_band(s->l, m, s->t));
}

/* Ends a contact: others of its pair inherit its report; otherwise its lift is recorded. */
static void end_contact(struct rb_resolution *s, int k, const bool *kept)
{
	int first;
	const int end = rb_slips_pair(s, k, &first);
	bool goes_on = false;

	if (!s->before[k].is_reported)
		return;
	for (int other = first; other < end; other++) {
		struct rb_held *const before = &s->before[other];

		goes_on = goes_on || kept[other];
		if (kept[other] && !before->is_reported) {
			before->is_reported = true;
			before->reported = s->before[k].reported;
		} else if (!kept[other] && other > k) {
			before->is_reported = false; /* one report per pair */
		}
	}
	if (!goes_on)
		rb_record_transition(s->l, s->t, RB_EVENT_LIFT, &s->contact_point[k]);
}

/*
 * True if a point that has been transferred to other features opens by its overshoot. Its force
 * decides whether it lasts; drift correction would pull a separating body back.
 */
static bool opens_on_new_features(const struct rb_resolution *s, int k)
{
	const struct rb_contact_point *m = &s->contact_point[k];

	return (s->before[k].key != m->key || s->before[k].parts != m->parts) &&
	       rb_vec3_dot(m->velocity, m->normal) > rb_contact_point_noise(s->l, m);
}

/* Marks a contact that slips by more than drift, as when it rolls on to another feature. */
static void find_new_slip(const struct rb_resolution *s, int k)
{
	const struct rb_contact_point *m = &s->contact_point[k];
	struct rb_held *const before = &s->before[k];

	if (before->a >= 0 && !s->l->starting &&
	    rb_vec3_length(rb_vec3_reject(m->velocity, m->normal)) > drift_speed(s, m)) {
		before->slipping = true;
		before->ending = false;
	}
}

/* Removes drift and drops the contacts that ended. */
static void keep_what_lasts(struct rb_resolution *s)
{
	bool *const kept = rb_slips_take(s, s->contact_point_count, sizeof *kept);
	struct rb_drift drift = rb_slips_drift(s, kept);
	int count = 0;

	if (!kept)
		return;
	for (int k = 0; k < s->contact_point_count; k++) {
		find_new_slip(s, k);
		/* after an impact velocities are exact */
		kept[k] = s->before[k].a >= 0 &&
		          !rb_slips_is_after_impact(s, &s->contact_point[k]) &&
		          !separates(s, &s->contact_point[k]) && !opens_on_new_features(s, k);
	}
	rb_joint_drives_fit(&s->joints, s->t, s->pose);
	/* drives that no longer hold must be released before drift is corrected */
	rb_joint_drives_begin(&s->joints, s->t, s->after_impact || s->l->starting, s->slack);
	rb_drift(&drift);
	rb_joint_rows_correct(&s->joints, s->t, s->pose, s->after_impact || s->l->starting);
	rb_joint_drives_turn(&s->joints, s->t, s->after_impact || s->l->starting);
	for (int k = 0; k < s->contact_point_count; k++) {
		rb_drift_point(s->l, s->pose, &s->contact_point[k]);
		kept[k] = s->before[k].a < 0 || !separates(s, &s->contact_point[k]);
	}
	for (int k = 0; k < s->contact_point_count; k++)
		if (!kept[k])
			end_contact(s, k, kept);
	for (int k = 0; k < s->contact_point_count; k++)
		if (kept[k]) {
			s->contact_point[count] = s->contact_point[k];
			s->before[count++] = s->before[k];
		}
	s->contact_point_count = count;
}

/* ---- forces ---- */

/* External accelerations of the set. */
static void sample_external(struct rb_resolution *s)
{
	struct rb_located *l = s->l;
	const struct rb_force_query view = {
		.pose = s->pose, .time_s = s->t, .active_s = s->t, .attracted = true};

	rb_external_attract(l, &view);
	for (int k = 0; k < l->set_count; k++) {
		rb_external_force_at(l, l->set[k], &s->pose[k], &view, &s->linear[k],
		                     &s->angular[k]);
		s->constant[k] = rb_external_is_constant(l, l->set[k], s->t);
		s->constant_at_rest[k] = rb_external_is_constant_at_rest(l, l->set[k], s->t);
		s->external_max = fmax(s->external_max, rb_vec3_max_abs(s->linear[k]));
	}
	rb_joint_rest_follow(s);
	rb_joint_rows_add_springs(&s->joints, s->t, s->linear, s->angular);
}

/* A dynamic body of the pair; of two, the first. */
static int dynamic_of(const struct rb_resolution *s, int k)
{
	return rb_located_fixed(s->l, s->contact_point[k].a) ? s->contact_point[k].b
	                                                     : s->contact_point[k].a;
}

/* ---- connected parts ---- */

/* Joins the parts of two bodies; the smaller place becomes the root. */
static void join(struct rb_resolution *s, int a, int b)
{
	const struct rb_located *l = s->l;

	if (a >= l->n || b >= l->n || l->place[a] < 0 || l->place[b] < 0)
		return;
	const int x = rb_forest_root(s->root, l->place[a]),
		  y = rb_forest_root(s->root, l->place[b]);
	s->root[x > y ? x : y] = x > y ? y : x;
}

/* Joins bodies that press on each other or that joints, force elements or gravitation connect. */
static void join_all(struct rb_resolution *s)
{
	const struct rb_model *model = s->l->model;

	for (int k = 0; k < s->contact_point_count; k++)
		if (rb_slips_press(s, k))
			join(s, s->contact_point[k].a, s->contact_point[k].b);
	for (int k = 0; k < s->joints.joint_count; k++) {
		const struct rb_joint *joint = &model->joints->joint[s->joints.joint[k]];

		if (joint->b >= 0)
			join(s, joint->a, joint->b);
	}
	for (int k = 0; k < model->element_list_count; k++)
		for (int m = 0; model->elements[k].end && m < model->elements[k].count; m++)
			join(s, model->elements[k].end[m][0], model->elements[k].end[m][1]);
	for (int k = 0, first = -1; rb_located_gravitates(s->l) && k < s->l->set_count; k++) {
		if (!rb_gravitation_attracts(model, s->l->set[k]))
			continue;
		if (first >= 0)
			join(s, s->l->set[first], s->l->set[k]);
		else
			first = k;
	}
}

/*
 * Mode of a contact for reports: a body that begins to rotate from rest rolls, even without speed.
 */
static enum rb_held_mode mode_of(const struct rb_resolution *s, int k)
{
	const struct rb_contact_point *m = &s->contact_point[k];
	const struct rb_solver_contact *c = &s->problem.contact[k];
	const double negligible = fmax(rest_share * s->external_max,
	                               LOAD_ULP * DBL_EPSILON *
	                                       s->load[s->l->place[dynamic_of(s, k)]]);

	if (c->slipping || c->mode == RB_SOLVER_SLIDE)
		return RB_HELD_SLIDE;
	return rb_slips_turn(s, k) <= 4 * rb_contact_point_noise(s->l, m) + s->slack &&
	                       rb_slips_turn_rate(s, k) <= negligible
	               ? RB_HELD_REST
	               : RB_HELD_ROLL;
}

/* ---- writing ---- */

/*
 * Friction coefficient of the solution: below the material's where the law has no solution
 * (constraint/simultaneous); the following pieces use it.
 */
static double friction_of(const struct rb_solver_contact *c)
{
	const double normal_impulse = rb_vec3_dot(c->impulse, c->normal);
	const double friction_impulse = rb_vec3_length(rb_vec3_reject(c->impulse, c->normal));

	return normal_impulse > 0 &&
	                       friction_impulse < c->friction * normal_impulse * (1 - reduced_share)
	               ? friction_impulse / normal_impulse
	               : c->friction;
}

/* The held contact for a point of the solution. */
static struct rb_held held_of(struct rb_resolution *s, int k)
{
	const struct rb_contact_point *m = &s->contact_point[k];
	const struct rb_solver_contact *c = &s->problem.contact[k];
	struct rb_held held = s->before[k];
	const bool known = held.a >= 0;

	if (!known)
		held = (struct rb_held){.recorded_s = s->t,
		                        .is_reported = held.is_reported,
		                        .reported = held.reported};
	for (int n = 0; n < s->l->merge_count && !known; n++)
		if (s->l->merge[n].a == m->a && s->l->merge[n].b == m->b) {
			held.recorded_s = s->l->merge[n].recorded_s;
			held.merged = true;
		}
	held.a = m->a;
	held.b = m->b;
	held.parts = m->parts;
	held.key = m->key;
	held.half = m->half;
	held.force = c->impulse;
	held.ending = held.straight = false;
	/* without friction nothing sticks, even if it does not slip */
	held.slipping = c->slipping || c->mode == RB_SOLVER_SLIDE || !(c->friction > 0);
	held.slip = c->slip;
	held.friction = friction_of(c);
	if (known && m->on_rim && !held.on_rim)
		rb_record_transition(s->l, s->t, RB_EVENT_EDGE, m);
	held.on_rim = m->on_rim;
	if (c->slipping && c->mode == RB_SOLVER_STICK) {
		/* slip begins in the direction opposite to friction */
		const rb_vec3 friction = rb_vec3_reject(c->impulse, m->normal);
		const double size = rb_vec3_length(friction);

		held.slip = size > 0 ? rb_vec3_scale(-1 / size, friction) : (rb_vec3){0, 0, 0};
	}
	return held;
}

/*
 * Records the mode of a pair, from all its points, unless it was recorded or an accumulation has
 * still to end: it slides if one point slides, rests if all rest, otherwise it rolls, rocks or
 * topples.
 */
static void record_mode(struct rb_resolution *s, struct rb_held *held, const int *contact_point,
                        int count)
{
	static const enum rb_event_kind kinds[] = {[RB_HELD_REST] = RB_EVENT_REST,
	                                           [RB_HELD_SLIDE] = RB_EVENT_SLIDE,
	                                           [RB_HELD_ROLL] = RB_EVENT_ROLL};
	enum rb_held_mode mode = RB_HELD_REST;
	const struct rb_held *reported = NULL;
	bool merged = false;

	for (int k = 0; k < count; k++) {
		if (held[k].is_reported && !reported)
			reported = &held[k];
		const enum rb_held_mode own = mode_of(s, contact_point[k]);
		if (mode != RB_HELD_SLIDE && own != RB_HELD_REST)
			mode = own;
		merged = merged || held[k].merged;
	}
	if (!reported && held->recorded_s > s->t)
		return;
	const bool again = reported && reported->reported == mode;
	for (int k = 0; k < count; k++) {
		held[k].merged = false;
		held[k].is_reported = true;
		held[k].reported = mode;
		held[k].recorded_s = fmin(held[k].recorded_s, s->t);
	}
	if (again)
		return;
	if (merged)
		rb_record_transition(s->l, s->t, RB_EVENT_MERGE,
		                     &s->contact_point[contact_point[0]]);
	if (!s->l->starting)
		rb_record_transition(s->l, s->t, kinds[mode], &s->contact_point[contact_point[0]]);
}

/* True if speed and acceleration are rounding: of a fall by the body's size, and of its load. */
static bool is_negligible(const struct rb_resolution *s, int k, double external, rb_vec3 speed,
                          rb_vec3 rate)
{
	const double radius = rb_model_reach(s->l->model, s->l->set[k]);
	const double rest_speed = s->slack + REST_ULP * DBL_EPSILON * sqrt(2 * external * radius);

	return rb_vec3_max_abs(speed) <= rest_speed &&
	       rb_vec3_max_abs(rate) <=
	               fmax(rest_share * external, LOAD_ULP * DBL_EPSILON * s->load[k]);
}

/* True if the member rotates, and not in closed form. */
static bool rotates_irregularly(const struct rb_resolution *s, int k)
{
	const struct rb_located *l = s->l;
	const double radius = rb_model_reach(l->model, l->set[k]);

	/* uniform rotation has a closed form only for spheres */
	if (!l->top || (l->top_body[l->set[k]].kind == RB_TOP_CONSTANT &&
	                l->model->shape[l->set[k]].kind == RB_SHAPE_SPHERE))
		return false;
	return !is_negligible(s, k, s->external_max, rb_vec3_scale(radius, s->pose[k].spin),
	                      rb_vec3_scale(radius, s->problem.body[k].angular));
}

/* True if accelerations are constant until the next transition. */
static bool in_closed_form(const struct rb_resolution *s, int part, const struct rb_cluster *c)
{
	const struct rb_located *l = s->l;

	for (int k = 0; k < l->set_count; k++)
		if (rb_forest_root(s->root, k) == part &&
		    (!s->constant[k] || l->model->center_of_mass || rotates_irregularly(s, k) ||
		     rb_joint_rows_hold(l, l->set[k])))
			return false;
	for (int k = 0; k < s->contact_point_count; k++) {
		const struct rb_held *held = rb_event_set_continued(l, &s->contact_point[k]);

		if (!held || l->cluster_of[dynamic_of(s, k)] != (int)(c - l->cluster))
			continue;
		if (s->contact_point[k].b < l->n || s->contact_point[k].on_rim ||
		    l->model->shape[s->contact_point[k].b].kind == RB_SHAPE_SPHERE)
			return false;
		/* nothing would detect that a point leaves its features, or a new one */
		if (!rb_event_set_is_single(l, s->contact_point[k].a, s->contact_point[k].b) &&
		    l->model->shape[s->contact_point[k].b].kind != RB_SHAPE_PLANE)
			return false;
		if (held->slipping && !held->straight)
			return false;
	}
	return true;
}

/* True if a driven body moves although it is at rest at this moment. */
static bool will_move(const struct rb_resolution *s, int body, double external)
{
	const struct rb_located *l = s->l;

	if (!rb_located_driven(l, body))
		return false;
	const struct rb_piece_of *p = &l->piece[body];
	double turning = 0;

	for (int m = 0; l->top && m < 3; m++)
		turning = fmax(turning,
		               rb_gauss_rate_bound(&p->piece, p->first + RB_PIECE_SPIN + m));
	return fmax(p->acceleration_max, turning * rb_model_reach(l->model, body)) >
	       rest_share * external;
}

/*
 * True if the whole cluster is at rest and nothing moves it. At rest: a speed within rounding of
 * that of a fall by its own size.
 */
static bool is_at_rest(const struct rb_resolution *s, int part)
{
	const struct rb_located *l = s->l;
	double external = 0;

	for (int k = 0; k < l->set_count; k++)
		if (rb_forest_root(s->root, k) == part)
			external = fmax(external, rb_vec3_max_abs(s->linear[k]));
	for (int k = 0; k < s->contact_point_count; k++)
		if (rb_slips_press(s, k) &&
		    rb_forest_root(s->root, l->place[dynamic_of(s, k)]) == part &&
		    (will_move(s, s->contact_point[k].a, external) ||
		     will_move(s, s->contact_point[k].b, external)))
			return false;
	for (int k = 0; k < l->set_count; k++) {
		if (rb_forest_root(s->root, k) != part)
			continue;
		const double radius = rb_model_reach(l->model, l->set[k]);
		const struct rb_solver_body *b = &s->problem.body[k];

		if (!s->constant_at_rest[k] ||
		    !is_negligible(s, k, external, s->pose[k].velocity, b->linear) ||
		    !is_negligible(s, k, external, rb_vec3_scale(radius, s->pose[k].spin),
		                   rb_vec3_scale(radius, b->angular)))
			return false;
	}
	return true;
}

/* Rates for the ledger of joints that hold a part at rest. */
static void rate_joints(struct rb_resolution *s, int part, struct rb_account_rates *rates)
{
	bool *const own = rb_slips_take(s, s->l->set_count, sizeof *own);

	if (!own)
		return;
	for (int k = 0; k < s->l->set_count; k++)
		own[k] = rb_forest_root(s->root, k) == part;
	rb_joint_rest_rate(s, own, rates);
}

/* Starts a part on arcs or on its first piece. */
static void start_part(struct rb_resolution *s, int part, struct rb_cluster *c,
                       const int *contact_point)
{
	struct rb_located *l = s->l;
	const rb_vec3 none = {0, 0, 0};
	const bool rest_speed = is_at_rest(s, part);
	const bool closed = rest_speed || in_closed_form(s, part, c);

	c->anchor_s = c->account_s = s->t;
	c->at_rest = rest_speed;
	c->integrated = !closed;
	for (int k = 0; k < l->set_count; k++) {
		if (rb_forest_root(s->root, k) != part)
			continue;
		if (rest_speed)
			s->pose[k].velocity = s->pose[k].spin = none;
		if (closed)
			s->pose[k].rest = none; /* closed forms start from one number */
		if (!rest_speed && closed && l->top &&
		    l->model->shape[l->set[k]].kind != RB_SHAPE_SPHERE)
			s->pose[k].spin = s->problem.body[k].angular = none;
		rb_arc_anchor(l, l->set[k], s->t, &s->pose[k],
		              rest_speed ? none : s->problem.body[k].linear,
		              rest_speed || !closed ? none : s->problem.body[k].angular);
	}
	for (int k = 0; closed && l->account_s && k < c->held_count; k++)
		rb_rest_rates_contact(s, contact_point[k], rest_speed, &c->rates);
	if (rest_speed && l->account_s && s->joints.joint_count > 0)
		rate_joints(s, part, &c->rates);
	for (int k = 0; rest_speed && l->account_s && k < c->member_count; k++)
		rb_rest_rates_centers(s, c->member[k], &c->rates);
	if (!closed)
		rb_integrate_piece(l, (int)(c - l->cluster), s->t, false);
}

/* Writes the contacts of a part to its cluster. */
static void write_held(struct rb_resolution *s, int part, struct rb_cluster *c, int *contact_point)
{
	const struct rb_located *l = s->l;
	int reported = 0;

	for (int k = 0; k < s->contact_point_count; k++) {
		if (!rb_slips_press(s, k) ||
		    rb_forest_root(s->root, l->place[dynamic_of(s, k)]) != part)
			continue;
		struct rb_held held = held_of(s, k);

		held.straight = held.slipping && rb_slips_straight(s, k, held.slip);
		held.creeps = rb_slips_creep(s, k, &held);
		contact_point[c->held_count] = k;
		c->held[c->held_count++] = held;
	}
	for (int k = 1; k <= c->held_count; k++)
		if (k == c->held_count || c->held[k].a != c->held[reported].a ||
		    c->held[k].b != c->held[reported].b) {
			record_mode(s, c->held + reported, contact_point + reported, k - reported);
			reported = k;
		}
}

/* Puts a body without contacts on a free arc. */
static void fly(struct rb_resolution *s, int body)
{
	struct rb_located *l = s->l;
	const int place = l->place[body];
	const double decay = rb_external_decay(l, body, s->t);

	s->pose[place].rest = (rb_vec3){0, 0, 0};
	rb_arc_anchor(l, body, s->t, &s->pose[place],
	              decay > 0 ? rb_external_constant(l, body, s->t, &s->pose[place])
	                        : s->linear[place],
	              rb_external_turning(l, body));
	rb_arc_set_drag(l, body, decay);
}

/* From the previous clusters: the shortest step to try, and the largest `crept`. */
struct pace {
	double try_s;
	uint64_t crept;
};

/* Writes each part as a cluster or free arcs. */
static void write_parts(struct rb_resolution *s, const struct pace *pace)
{
	struct rb_located *l = s->l;
	int *member = rb_slips_take(s, l->set_count, sizeof *member);
	int *contact_point = rb_slips_take(s, s->contact_point_count, sizeof *contact_point);

	for (int part = 0; member && contact_point && part < l->set_count; part++) {
		int count = 0, held_count = 0;
		bool alone = true;

		if (rb_forest_root(s->root, part) != part)
			continue;
		for (int k = part; k < l->set_count; k++)
			if (rb_forest_root(s->root, k) == part)
				member[count++] = l->set[k];
		for (int k = 0; k < s->contact_point_count; k++)
			held_count += rb_slips_press(s, k) &&
			              rb_forest_root(s->root, l->place[dynamic_of(s, k)]) == part;
		for (int k = 0; k < count; k++)
			alone = alone && !isnan(rb_external_decay(l, member[k], s->t)) &&
			        !rb_joint_rows_hold(l, member[k]);
		if (held_count == 0 && alone) { /* a body in flight */
			for (int k = 0; k < count; k++)
				fly(s, member[k]);
			continue;
		}
		const int cluster = rb_cluster_take(l, member, count, held_count);
		if (cluster < 0) {
			rb_slips_take(s, -1, SIZE_MAX / 2);
			return;
		}
		struct rb_cluster *c = &l->cluster[cluster];
		c->try_s = pace->try_s;
		c->crept = pace->crept;
		write_held(s, part, c, contact_point);
		start_part(s, part, c, contact_point);
		rb_queue_set(l->queue, l->n + cluster, rb_transition_next(l, cluster));
	}
}

/* Closes the old clusters. */
static void forget_before(struct rb_resolution *s, struct pace *pace)
{
	struct rb_located *l = s->l;

	*pace = (struct pace){0, 0};
	for (int k = 0; k < l->set_count; k++) {
		const int cluster = l->cluster_of[l->set[k]];

		/* new clusters may take the storage of those that are dropped */
		rb_piece_warm_start_keep(l, l->set[k], s->t);
		if (cluster < 0)
			continue;
		const struct rb_cluster *c = &l->cluster[cluster];
		if (c->integrated)
			pace->try_s = pace->try_s > 0 ? fmin(pace->try_s, c->try_s) : c->try_s;
		pace->crept = c->crept > pace->crept ? c->crept : pace->crept;
		rb_account_cluster(l, cluster, s->t);
		rb_cluster_drop(l, cluster);
	}
}

/* Records the lift of pairs that no longer press at any point. */
static void record_lifts(struct rb_resolution *s)
{
	for (int k = 0, first; k < s->contact_point_count; k++) {
		const int end = rb_slips_pair(s, k, &first);
		bool goes_on = false;

		if (!s->before[k].is_reported || rb_slips_press(s, k))
			continue;
		for (int other = first; other < end; other++)
			goes_on = goes_on || rb_slips_press(s, other) ||
			          (other < k && s->before[other].is_reported);
		if (!goes_on)
			rb_record_transition(s->l, s->t, RB_EVENT_LIFT, &s->contact_point[k]);
	}
}

/* True if the set moves. */
static bool is_moving(const struct rb_resolution *s)
{
	const struct rb_located *l = s->l;

	for (int k = 0; k < l->set_count; k++) {
		const double size = rb_model_reach(l->model, l->set[k]);
		const double rest_speed = s->slack +
		                          REST_ULP * DBL_EPSILON * sqrt(2 * l->weight * size);

		if (rb_vec3_max_abs(s->pose[k].velocity) > rest_speed ||
		    rb_vec3_max_abs(s->pose[k].spin) * size > rest_speed)
			return true;
	}
	return false;
}

/*
 * True if it is a new point of bodies already in contact. An impact may bring one into the touching
 * range by the velocity that it causes, and on a flat rotating rim another point may become the
 * lowest.
 */
static bool comes_to_touch(const struct rb_resolution *s, int k)
{
	return (s->before[k].a < 0 || rb_vec3_max_abs(s->contact_point[k].half) > 0 ||
	        !rb_slips_is_after_impact(s, &s->contact_point[k])) &&
	       !rb_contact_point_passes(s->l, &s->contact_point[k], s->t);
}

/*
 * The first lasting contact, or new point of bodies in contact, that approaches; -1: none.
 * Approaches left by the stepped method are not impacts.
 */
static int find_hit(const struct rb_resolution *s)
{
	for (int k = 0; k < s->contact_point_count && !s->l->starting; k++)
		if (rb_vec3_dot(s->contact_point[k].velocity, s->contact_point[k].normal) <
		            -integration_speed(s, &s->contact_point[k]) &&
		    ((s->before[k].a >= 0 && !rb_slips_is_after_impact(s, &s->contact_point[k])) ||
		     comes_to_touch(s, k)))
			return k;
	return -1;
}

/* One attempt, impacts first; true: repeat. */
static bool resolve_once(struct rb_resolution *s, bool inspects, int round)
{
	struct rb_located *l = s->l;
	struct pace pace;

	if (!begin(s))
		return false;
	s->hit = !inspects ? -1 : round == 0 ? find_hit(s) : rb_tangential_impact_hit(s);
	if (inspects && round == 0 && s->hit < 0) /* the first round has no impact */
		s->hit_joint = rb_joint_stops_hit(&s->joints, s->t, s->slack);
	if (s->hit >= 0 || s->hit_joint >= 0)
		return false;
	const struct rb_ledger before = l->world->ledger;
	keep_what_lasts(s);
	s->moves = is_moving(s);
	if (rb_slips_are_too_many(s))
		rb_slips_too_many(s);
	else
		sample_external(s);
	if (l->status != RB_OK || !rb_rim_support_solve(s) || !rb_joint_rest_decide(s)) {
		/* nothing was written: undo the drift corrections' entries */
		l->world->ledger = before;
		return false;
	}
	join_all(s);
	if (round <= s->l->set_count && s->joints.count == 0 && rb_tangential_impact(s))
		return true;
	forget_before(s, &pace);
	record_lifts(s);
	write_parts(s, &pace);
	return false;
}

bool rb_resolve_contacts(struct rb_located *l, double t, bool after_impact, double slack,
                         int hit[2])
{
	const rb_arena_mark here = rb_arena_here(l->arena);
	bool again = true;

	RB_ASSERT(t >= l->now_s && slack >= 0);
	/* each Painleve impulse ends a slip; a contact that it makes approach is an impact */
	for (int round = 0; again; round++) {
		struct rb_resolution s = {.l = l,
		                          .t = t,
		                          .slack = slack,
		                          .after_impact = after_impact || round > 0,
		                          .hit = -1,
		                          .hit_joint = -1};

		again = resolve_once(&s, hit, round) && l->status == RB_OK;
		const bool is_hit = s.hit >= 0 || s.hit_joint >= 0;
		if (s.hit_joint >= 0) {
			hit[0] = hit[1] = rb_joint_stops_body(l, s.hit_joint);
		} else if (is_hit) {
			hit[0] = s.contact_point[s.hit].a;
			hit[1] = s.contact_point[s.hit].b;
		}
		rb_arena_back(l->arena, here);
		if (is_hit)
			return false;
	}
	l->merge_count = 0;
	return true;
}
