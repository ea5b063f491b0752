/* SPDX-License-Identifier: MIT */
#include "event/settle.h"

#include <float.h>
#include <string.h>

#include "event/cluster.h"
#include "event/integrate.h"
#include "event/mechanics.h"
#include "event/pull.h"
#include "event/tell.h"
#include "event/tidy.h"
#include "event/together.h"
#include "event/transition.h"

/* What one settling works on; all in the arena. */
struct settling {
	struct rb_located *l;
	double t, slack;
	double drift; /* m/s: what rounding of forces has added to velocities of held contacts */
	bool moves;   /* some body of it does */
	bool struck;  /* an impact has just happened */
	bool keeps_slips; /* slips keep the directions that they had, where these are as good as those of velocities */
	struct rb_meet *meet; /* [meet_count], sorted by (a, b, parts, key) */
	int meet_count;
	struct rb_held *before;    /* [meet_count]: what was held of each, a < 0: nothing */
	struct rb_pose *pose;      /* [set_count] */
	rb_vec3 *linear, *angular; /* [set_count]: accelerations without contacts, then with them */
	struct rb_joint joint;     /* bodies: the set, then the fixed partners */
	bool *constant;            /* [set_count]: its other forces are constant */
	int *root;                 /* [set_count]: union-find over what stays together */
	double pull_most;          /* m/s^2: largest acceleration that went in */
	double *load; /* [set_count], m/s^2: what contacts' forces on a body would do to it one by one */
};

enum { STILL_ULP = 64, LOAD_ULP = 64, SLIP_ULP = 1 };
/* Share of what friction does to speeds by which a slip that creeps may change its own. */
static const double slowly = 0.05;
/* Share of the friction that is missing where the solver has not found it, which is more than its residue. */
static const double gave_way = 1e-9;

static void *take(struct settling *s, int count, size_t size)
{
	void *const block = rb_arena_take(s->l->arena, (size_t)(count > 0 ? count : 1), size);

	if (!block && s->l->status == RB_OK)
		s->l->status = RB_FAIL(s->l->err, RB_ERR_MEMORY,
		                       "no memory for the contacts of %d bodies", s->l->set_count);
	return block;
}

/* ---- gathering ---- */

/* What the rounding of a held contact's force has made of its velocity since then, m/s. */
static double drift_of(const struct rb_located *l, const struct rb_held *held, double t)
{
	const int yields = rb_located_fixed(l, held->a) ? held->b : held->a;
	const double age = t - l->cluster[l->cluster_of[yields]].anchor_s;

	return 16 * DBL_EPSILON * age * rb_vec3_length(held->force) *
	       (l->model->inverse_mass[held->a] + l->model->inverse_mass[held->b]);
}

/* A slip is known beforehand to end with its piece, which something else may cut short. */
static bool has_ended(const struct rb_located *l, const struct rb_held *held, double t)
{
	const int yields = rb_located_fixed(l, held->a) ? held->b : held->a;

	return !l->cluster[l->cluster_of[yields]].integrated || t >= l->piece[yields].until_s;
}

static bool begin(struct settling *s)
{
	struct rb_located *l = s->l;

	s->meet_count = rb_set_grow(l, s->t, s->slack, rb_set_lasting, &s->meet);
	if (s->meet_count < 0) {
		take(s, -1, SIZE_MAX / 2);
		return false;
	}
	s->before = take(s, s->meet_count, sizeof *s->before);
	s->pose = take(s, l->set_count, sizeof *s->pose);
	s->linear = take(s, l->set_count, sizeof *s->linear);
	s->angular = take(s, l->set_count, sizeof *s->angular);
	s->constant = take(s, l->set_count, sizeof *s->constant);
	s->root = take(s, l->set_count, sizeof *s->root);
	s->load = take(s, l->set_count, sizeof *s->load);
	if (l->status != RB_OK)
		return false;
	for (int k = 0; k < l->set_count; k++) {
		s->pose[k] = rb_arc_pose(l, l->set[k], s->t);
		s->root[k] = k;
	}
	for (int k = 0; k < s->meet_count; k++) {
		const struct rb_held *held = rb_set_held_like(l, &s->meet[k]);

		s->before[k] = (struct rb_held){.a = -1};
		if (!held)
			continue;
		s->before[k] = *held;
		s->before[k].ending = held->ending && has_ended(l, held, s->t);
		s->drift = fmax(s->drift, drift_of(l, held, s->t));
	}
	return true;
}

/* A contact that was held and is hit or pulled apart by a change is no longer one. */
static bool parts(const struct settling *s, const struct rb_meet *m)
{
	double most = rb_meet_noise(s->l, m) + s->slack + s->drift;

	if (!s->struck)
		most += rb_tidy_drift *
		        (rb_vec3_length(m->pose_a.velocity) + rb_vec3_length(m->pose_b.velocity));
	/* and one whose body has been put elsewhere */
	return rb_vec3_dot(m->velocity, m->normal) > most || rb_set_has_left(s->l, m) ||
	       m->gap > fmax(rb_tidy_drift * rb_meet_size(s->l, m), rb_meet_band(s->l, m, s->t));
}

/* Those of the same pair as contact k: from *first to before the number returned. */
static int pair_of(const struct settling *s, int k, int *first)
{
	const struct rb_meet *m = s->meet;
	int end = k + 1;

	*first = k;
	while (*first > 0 && m[*first - 1].a == m[k].a && m[*first - 1].b == m[k].b)
		--*first;
	while (end < s->meet_count && m[end].a == m[k].a && m[end].b == m[k].b)
		end++;
	return end;
}

/* A contact that ends: either others of its pair go on, with what has been told of the pair, or the bodies part. */
static void end_contact(struct settling *s, int k, const bool *kept)
{
	int first;
	const int end = pair_of(s, k, &first);
	bool goes_on = false;

	if (!s->before[k].is_told)
		return;
	for (int other = first; other < end; other++) {
		struct rb_held *const before = &s->before[other];

		goes_on = goes_on || kept[other];
		if (kept[other] && !before->is_told) {
			before->is_told = true;
			before->told = s->before[k].told;
		} else if (!kept[other] && other > k) {
			before->is_told = false; /* once is enough */
		}
	}
	if (!goes_on)
		rb_tell_transition(s->l, s->t, RB_EVENT_LIFT, &s->meet[k]);
}

static void keep_what_lasts(struct settling *s)
{
	bool *const kept = take(s, s->meet_count, sizeof *kept);
	struct rb_tidy tidy = {.l = s->l,
	                       .t = s->t,
	                       .meet = s->meet,
	                       .before = s->before,
	                       .kept = kept,
	                       .count = s->meet_count,
	                       .pose = s->pose};
	int count = 0;

	if (!kept)
		return;
	for (int k = 0; k < s->meet_count; k++)
		/* an impact has left velocities that are right */
		kept[k] = s->before[k].a >= 0 && !s->struck && !parts(s, &s->meet[k]);
	rb_tidy(&tidy);
	for (int k = 0; k < s->meet_count; k++) {
		rb_tidy_meet(s->l, s->pose, &s->meet[k]);
		kept[k] = s->before[k].a < 0 || !parts(s, &s->meet[k]);
	}
	for (int k = 0; k < s->meet_count; k++)
		if (!kept[k])
			end_contact(s, k, kept);
	for (int k = 0; k < s->meet_count; k++)
		if (kept[k]) {
			s->meet[count] = s->meet[k];
			s->before[count++] = s->before[k];
		}
	s->meet_count = count;
}

/* ---- forces ---- */

static void pulls(struct settling *s)
{
	struct rb_located *l = s->l;
	const struct rb_view view = {.pose = s->pose, .time_s = s->t, .active_s = s->t};

	for (int k = 0; k < l->set_count; k++) {
		rb_pull_at(l, l->set[k], &s->pose[k], &view, &s->linear[k], &s->angular[k]);
		s->constant[k] = rb_pull_is_constant(l, l->set[k], s->t);
		s->pull_most = fmax(s->pull_most, rb_vec3_max_abs(s->linear[k]));
	}
}

static int joint_body(struct settling *s, int body)
{
	const struct rb_located *l = s->l;

	if (body < l->n && l->place[body] >= 0)
		return l->place[body];
	s->joint.body[s->joint.body_count] = rb_mechanics_fixed(l, body, s->t);
	return s->joint.body_count++;
}

static void joint_set(struct settling *s)
{
	const struct rb_located *l = s->l;

	for (int k = 0; k < l->set_count; k++)
		s->joint.body[k] = rb_mechanics_body(l, l->set[k], &s->pose[k], s->linear[k],
		                                     s->angular[k]);
	s->joint.body_count = l->set_count;
}

/* Of a slip that goes on: rounding of its velocity, and of what has changed it since. */
static bool goes_on_as_before(const struct settling *s, int k, rb_vec3 slip, rb_vec3 *old)
{
	const struct rb_held *before = &s->before[k];
	const double speed = rb_vec3_length(slip);
	const double still = 4 * rb_meet_noise(s->l, &s->meet[k]) + s->slack + s->drift;
	const rb_vec3 now = rb_vec3_scale(1 / speed, slip);

	if (before->a < 0 || !before->slipping || before->ending || s->struck)
		return false;
	*old = rb_vec3_unit(rb_vec3_reject(before->slip, s->meet[k].normal), now);
	return rb_vec3_length(rb_vec3_sub(now, *old)) * speed <= still;
}

static void joint_contact(struct settling *s, int k)
{
	struct rb_located *l = s->l;
	const struct rb_meet *m = &s->meet[k];
	const struct rb_held *before = &s->before[k];
	struct rb_joint_contact *c = &s->joint.contact[k];
	const rb_vec3 slip = rb_vec3_reject(m->velocity, m->normal);
	const double speed = rb_vec3_length(slip);
	const double still = 4 * rb_meet_noise(l, m) + s->slack;
	const bool stuck = before->a >= 0 && !s->struck && (!before->slipping || before->ending);

	*c = rb_mechanics_contact(l, m);
	c->a = joint_body(s, m->a);
	c->b = joint_body(s, m->b);
	if (before->a >= 0)
		c->impulse = before->force;
	if (speed > (stuck ? fmax(still, rb_tidy_drift * (rb_vec3_length(m->pose_a.velocity) +
	                                                  rb_vec3_length(m->pose_b.velocity)))
	                   : still)) {
		c->mode = RB_JOINT_SLIDE;
		if (!s->keeps_slips || !goes_on_as_before(s, k, slip, &c->slip))
			c->slip = rb_vec3_scale(1 / speed, slip);
	}
}

static void add_load(struct settling *s, int body, double force)
{
	if (body < s->l->n && s->l->place[body] >= 0)
		s->load[s->l->place[body]] += s->l->model->inverse_mass[body] * force;
}

static void find_loads(struct settling *s)
{
	for (int k = 0; k < s->l->set_count; k++)
		s->load[k] = 0;
	for (int k = 0; k < s->meet_count; k++) {
		const double force = rb_vec3_length(s->joint.contact[k].impulse);

		add_load(s, s->meet[k].a, force);
		add_load(s, s->meet[k].b, force);
	}
}

static void too_many(const struct settling *s)
{
	s->l->status = RB_FAIL(s->l->err, RB_ERR_PHYSICS,
	                       "%d contacts together are too many to locate", s->meet_count);
}

static bool solve(struct settling *s)
{
	s->joint.arena = s->l->arena;
	s->joint.body = take(s, s->l->set_count + 2 * s->meet_count, sizeof *s->joint.body);
	s->joint.contact = take(s, s->meet_count, sizeof *s->joint.contact);
	if (s->l->status != RB_OK)
		return false;
	joint_set(s);
	for (int k = 0; k < s->meet_count; k++)
		joint_contact(s, k);
	s->joint.contact_count = s->meet_count;
	s->joint.products_most = s->moves ? rb_located_products(s->l, s->meet_count) : 0;
	if (s->meet_count > 0)
		rb_joint_forces(&s->joint);
	if (s->moves)
		s->l->crowd += (uint64_t)s->joint.products * (uint64_t)s->meet_count /
		               RB_LOCATED_ROWS;
	if (rb_joint_is_over(&s->joint)) {
		too_many(s);
		return false;
	}
	find_loads(s);
	return true;
}

static bool presses(const struct settling *s, int k)
{
	return rb_vec3_dot(s->joint.contact[k].impulse, s->meet[k].normal) > 0;
}

/* The body of a pair that contacts move; of two, the first. */
static int yielding(const struct settling *s, int k)
{
	return rb_located_fixed(s->l, s->meet[k].a) ? s->meet[k].b : s->meet[k].a;
}

/* ---- who goes on with whom ---- */

static int root_of(int *root, int k)
{
	while (root[k] != k)
		k = root[k] = root[root[k]];
	return k;
}

static void join(struct settling *s, int a, int b)
{
	const struct rb_located *l = s->l;

	if (a >= l->n || b >= l->n || l->place[a] < 0 || l->place[b] < 0)
		return;
	const int x = root_of(s->root, l->place[a]), y = root_of(s->root, l->place[b]);
	s->root[x > y ? x : y] = x > y ? y : x;
}

static void join_all(struct settling *s)
{
	const struct rb_scene *scene = s->l->model->scene;

	for (int k = 0; k < s->meet_count; k++)
		if (presses(s, k))
			join(s, s->meet[k].a, s->meet[k].b);
	for (int k = 0; k < scene->spring_count; k++)
		join(s, s->l->model->index_of[scene->springs[k].a],
		     s->l->model->index_of[scene->springs[k].b]);
}

static enum rb_held_mode mode_of(const struct settling *s, int k)
{
	const struct rb_meet *m = &s->meet[k];
	const rb_vec3 turn = rb_vec3_sub(m->pose_b.spin, m->pose_a.spin);
	const double noise = 4 * rb_meet_noise(s->l, m) + s->slack;
	const struct rb_joint_contact *c = &s->joint.contact[k];

	if (c->slipping || c->mode == RB_JOINT_SLIDE)
		return RB_HELD_SLIDE;
	/* without slip, and without turning against each other */
	return rb_vec3_length(m->velocity) <= noise &&
	                       rb_vec3_length(turn) * rb_meet_size(s->l, m) <= noise
	               ? RB_HELD_REST
	               : RB_HELD_ROLL;
}

/* ---- writing ---- */

/* The solution has less friction than the law where the law has none (event/together); what follows keeps to it. */
static double friction_of(const struct rb_joint_contact *c)
{
	const double push = rb_vec3_dot(c->impulse, c->normal);
	const double rubs = rb_vec3_length(rb_vec3_reject(c->impulse, c->normal));

	return push > 0 && rubs < c->friction * push * (1 - gave_way) ? rubs / push : c->friction;
}

static struct rb_held held_of(struct settling *s, int k)
{
	const struct rb_meet *m = &s->meet[k];
	const struct rb_joint_contact *c = &s->joint.contact[k];
	struct rb_held held = s->before[k];
	const bool known = held.a >= 0;

	if (!known)
		held = (struct rb_held){.tell_s = s->t, .is_told = held.is_told, .told = held.told};
	for (int n = 0; n < s->l->merge_count && !known; n++)
		if (s->l->merge[n].a == m->a && s->l->merge[n].b == m->b) {
			held.tell_s = s->l->merge[n].tell_s;
			held.merged = true;
		}
	held.a = m->a;
	held.b = m->b;
	held.parts = m->parts;
	held.key = m->key;
	held.force = c->impulse;
	held.ending = held.straight = false;
	/* without friction nothing sticks, whether it slips or not */
	held.slipping = c->slipping || c->mode == RB_JOINT_SLIDE || !(c->friction > 0);
	held.slip = c->slip;
	held.friction = friction_of(c);
	if (known && m->on_rim && !held.on_rim)
		rb_tell_transition(s->l, s->t, RB_EVENT_EDGE, m);
	held.on_rim = m->on_rim;
	if (c->slipping && c->mode == RB_JOINT_STICK) {
		/* slip sets in against its friction */
		const rb_vec3 friction = rb_vec3_reject(c->impulse, m->normal);
		const double size = rb_vec3_length(friction);

		held.slip = size > 0 ? rb_vec3_scale(-1 / size, friction) : (rb_vec3){0, 0, 0};
	}
	return held;
}

/*
 * Tells what the points of a pair do together, unless it was told already or an accumulation is still to end: they slide
 * if one of them does, rest if all do, and else they roll, rock or topple.
 */
static void tell_mode(struct settling *s, struct rb_held *held, const int *meet, int count)
{
	static const enum rb_event_kind kinds[] = {[RB_HELD_REST] = RB_EVENT_REST,
	                                           [RB_HELD_SLIDE] = RB_EVENT_SLIDE,
	                                           [RB_HELD_ROLL] = RB_EVENT_ROLL};
	enum rb_held_mode mode = RB_HELD_REST;
	const struct rb_held *told = NULL;
	bool merged = false;

	for (int k = 0; k < count; k++) {
		if (held[k].is_told && !told)
			told = &held[k];
		const enum rb_held_mode own = mode_of(s, meet[k]);
		if (mode != RB_HELD_SLIDE && own != RB_HELD_REST)
			mode = own;
		merged = merged || held[k].merged;
	}
	if (!told && held->tell_s > s->t)
		return;
	const bool again = told && told->told == mode;
	for (int k = 0; k < count; k++) {
		held[k].merged = false;
		held[k].is_told = true;
		held[k].told = mode;
		held[k].tell_s = fmin(held[k].tell_s, s->t);
	}
	if (again)
		return;
	if (merged)
		rb_tell_transition(s->l, s->t, RB_EVENT_MERGE, &s->meet[meet[0]]);
	if (!s->l->starting)
		rb_tell_transition(s->l, s->t, kinds[mode], &s->meet[meet[0]]);
}

/* Rate at which the contact point's slip changes, across the normal. */
static rb_vec3 slip_rate(const struct settling *s, int k)
{
	const struct rb_joint_contact *c = &s->joint.contact[k];
	const struct rb_joint_body *a = &s->joint.body[c->a], *b = &s->joint.body[c->b];
	const rb_vec3 rate = rb_vec3_sub(
		rb_vec3_add(b->linear, rb_vec3_cross(b->angular, c->arm_b)),
		rb_vec3_add(a->linear, rb_vec3_cross(a->angular, c->arm_a)));

	return rb_vec3_reject(rb_vec3_add(rate, c->bias), c->normal);
}

/* Does the slip keep its direction until it ends, to rounding? */
static bool is_straight(const struct settling *s, int k, rb_vec3 slip)
{
	const rb_vec3 rate = slip_rate(s, k);
	const double along = rb_vec3_dot(rate, slip);
	const double aside = rb_vec3_length(rb_vec3_add_scaled(rate, -along, slip));
	const double speed = rb_vec3_length(rb_vec3_reject(s->meet[k].velocity, s->meet[k].normal));
	const double largest = rb_vec3_length(s->meet[k].pose_a.velocity) +
	                       rb_vec3_length(s->meet[k].pose_b.velocity);

	if (aside <= 64 * DBL_EPSILON * s->pull_most)
		return true;
	/* nor is there time to turn where it ends within the rounding of the time */
	return along < 0 && (aside * speed <= -along * 16 * DBL_EPSILON * largest ||
	                     speed <= -along * 16 * DBL_EPSILON * s->t);
}

/* Speeds and accelerations that are nothing to a member: rounding of a fall by its own size, and of what presses it. */
static bool is_nothing(const struct settling *s, int k, double pull, rb_vec3 speed, rb_vec3 rate)
{
	const double radius = rb_model_reach(s->l->model, s->l->set[k]);
	const double still = s->slack + STILL_ULP * DBL_EPSILON * sqrt(2 * pull * radius);

	return rb_vec3_max_abs(speed) <= still &&
	       rb_vec3_max_abs(rate) <= fmax(1e-12 * pull, LOAD_ULP * DBL_EPSILON * s->load[k]);
}

/*
 * Is its direction what balances the forces across it? Of bodies that touch at points, where the slip is slow and changes
 * its speed by much less than friction could: else it has no time to turn there.
 */
static bool creeps(const struct settling *s, int k, const struct rb_held *held)
{
	const struct rb_meet *m = &s->meet[k];
	const double *const inverse = s->l->model->inverse_mass;
	const double rubs = rb_vec3_length(rb_vec3_reject(held->force, m->normal)) *
	                    (inverse[m->a] + inverse[m->b]);

	return held->slipping && !held->straight && held->friction > 0 &&
	       !rb_set_is_single(s->l, m->a, m->b) &&
	       rb_vec3_length(rb_vec3_reject(m->velocity, m->normal)) <= rb_set_creep(s->l, m) &&
	       fabs(rb_vec3_dot(slip_rate(s, k), held->slip)) <= slowly * rubs;
}

/* Neither a closed form nor without turning. */
static bool turns_oddly(const struct settling *s, int k)
{
	const struct rb_located *l = s->l;
	const double radius = rb_model_reach(l->model, l->set[k]);

	/* what turns evenly is in closed form only where it is round */
	if (!l->top || (l->top_body[l->set[k]].kind == RB_TOP_CONSTANT &&
	                l->model->shape[l->set[k]].kind == RB_SHAPE_SPHERE))
		return false;
	return !is_nothing(s, k, s->pull_most, rb_vec3_scale(radius, s->pose[k].spin),
	                   rb_vec3_scale(radius, s->joint.body[k].angular));
}

/* Constant accelerations from here to the next transition? */
static bool in_closed_form(const struct settling *s, int part, const struct rb_cluster *c)
{
	const struct rb_located *l = s->l;

	for (int k = 0; k < l->set_count; k++)
		if (root_of(s->root, k) == part &&
		    (!s->constant[k] || l->model->center_of_mass || turns_oddly(s, k)))
			return false;
	for (int k = 0; k < s->meet_count; k++) {
		const struct rb_held *held = rb_set_held_like(l, &s->meet[k]);

		if (!held || l->cluster_of[yielding(s, k)] != (int)(c - l->cluster))
			continue;
		if (s->meet[k].b < l->n || s->meet[k].on_rim ||
		    l->model->shape[s->meet[k].b].kind == RB_SHAPE_SPHERE)
			return false;
		/* nobody looks for where a point leaves its features, or another one comes */
		if (!rb_set_is_single(l, s->meet[k].a, s->meet[k].b) &&
		    l->model->shape[s->meet[k].b].kind != RB_SHAPE_PLANE)
			return false;
		if (held->slipping && !held->straight)
			return false;
	}
	return true;
}

/*
 * All of a cluster stands still and nothing moves it: static means static. Still is a speed within rounding of that of a
 * fall by its own size.
 */
static bool stands_still(const struct settling *s, int part)
{
	const struct rb_located *l = s->l;
	double pull = 0;

	for (int k = 0; k < l->set_count; k++)
		if (root_of(s->root, k) == part)
			pull = fmax(pull, rb_vec3_max_abs(s->linear[k]));
	for (int k = 0; k < l->set_count; k++) {
		if (root_of(s->root, k) != part)
			continue;
		const double radius = rb_model_reach(l->model, l->set[k]);
		const struct rb_joint_body *b = &s->joint.body[k];

		if (!s->constant[k] || !is_nothing(s, k, pull, s->pose[k].velocity, b->linear) ||
		    !is_nothing(s, k, pull, rb_vec3_scale(radius, s->pose[k].spin),
		                rb_vec3_scale(radius, b->angular)))
			return false;
	}
	return true;
}

static void start_part(struct settling *s, int part, struct rb_cluster *c)
{
	struct rb_located *l = s->l;
	const rb_vec3 none = {0, 0, 0};
	const bool still = stands_still(s, part);
	const bool closed = still || in_closed_form(s, part, c);

	c->anchor_s = s->t;
	c->at_rest = still;
	c->integrated = !closed;
	for (int k = 0; k < l->set_count; k++) {
		if (root_of(s->root, k) != part)
			continue;
		if (still)
			s->pose[k].velocity = s->pose[k].spin = none;
		if (closed)
			s->pose[k].rest = none; /* closed forms go from one number */
		if (!still && closed && l->top && l->model->shape[l->set[k]].kind != RB_SHAPE_SPHERE)
			s->pose[k].spin = s->joint.body[k].angular = none;
		rb_arc_anchor(l, l->set[k], s->t, &s->pose[k],
		              still ? none : s->joint.body[k].linear,
		              still || !closed ? none : s->joint.body[k].angular);
	}
	if (!closed)
		rb_integrate_piece(l, (int)(c - l->cluster), s->t);
}

/* The contacts of a part, for its cluster; `meet`: room for as many numbers. */
static void write_held(struct settling *s, int part, struct rb_cluster *c, int *meet)
{
	const struct rb_located *l = s->l;
	int told = 0;

	for (int k = 0; k < s->meet_count; k++) {
		if (!presses(s, k) || root_of(s->root, l->place[yielding(s, k)]) != part)
			continue;
		struct rb_held held = held_of(s, k);

		held.straight = held.slipping && is_straight(s, k, held.slip);
		held.creeps = creeps(s, k, &held);
		meet[c->held_count] = k;
		c->held[c->held_count++] = held;
	}
	for (int k = 1; k <= c->held_count; k++)
		if (k == c->held_count || c->held[k].a != c->held[told].a ||
		    c->held[k].b != c->held[told].b) {
			tell_mode(s, c->held + told, meet + told, k - told);
			told = k;
		}
}

static void fly(struct settling *s, int body)
{
	const int place = s->l->place[body];

	s->pose[place].rest = (rb_vec3){0, 0, 0};
	rb_arc_anchor(s->l, body, s->t, &s->pose[place], s->linear[place],
	              rb_pull_turning(s->l, body));
}

static void write_parts(struct settling *s, double try_s)
{
	struct rb_located *l = s->l;
	int *member = take(s, l->set_count, sizeof *member);
	int *meet = take(s, s->meet_count, sizeof *meet);

	for (int part = 0; member && meet && part < l->set_count; part++) {
		int count = 0, held_count = 0;
		bool alone = true;

		if (root_of(s->root, part) != part)
			continue;
		for (int k = part; k < l->set_count; k++)
			if (root_of(s->root, k) == part)
				member[count++] = l->set[k];
		for (int k = 0; k < s->meet_count; k++)
			held_count += presses(s, k) &&
			              root_of(s->root, l->place[yielding(s, k)]) == part;
		for (int k = 0; k < count; k++)
			alone = alone && s->constant[l->place[member[k]]];
		if (held_count == 0 && alone) { /* a body in flight */
			for (int k = 0; k < count; k++)
				fly(s, member[k]);
			continue;
		}
		const int cluster = rb_cluster_take(l, member, count, held_count);
		if (cluster < 0) {
			take(s, -1, SIZE_MAX / 2);
			return;
		}
		struct rb_cluster *c = &l->cluster[cluster];
		c->try_s = try_s;
		write_held(s, part, c, meet);
		start_part(s, part, c);
		rb_queue_set(l->queue, l->n + cluster, rb_transition_next(l, cluster));
	}
}

static void forget_before(struct settling *s, double *try_s)
{
	struct rb_located *l = s->l;

	*try_s = 0;
	for (int k = 0; k < l->set_count; k++) {
		const int cluster = l->cluster_of[l->set[k]];

		if (cluster < 0)
			continue;
		if (l->cluster[cluster].integrated)
			*try_s = *try_s > 0 ? fmin(*try_s, l->cluster[cluster].try_s)
			                    : l->cluster[cluster].try_s;
		rb_cluster_drop(l, cluster);
	}
}

/* Of a pair that does not press at any of its points any more. */
static void tell_lifts(struct settling *s)
{
	for (int k = 0, first; k < s->meet_count; k++) {
		const int end = pair_of(s, k, &first);
		bool goes_on = false;

		if (!s->before[k].is_told || presses(s, k))
			continue;
		for (int other = first; other < end; other++)
			goes_on = goes_on || presses(s, other) ||
			          (other < k && s->before[other].is_told);
		if (!goes_on)
			rb_tell_transition(s->l, s->t, RB_EVENT_LIFT, &s->meet[k]);
	}
}

/*
 * A slip that would end within the rounding of sizes has ended: of bodies that touch at several points it may turn at the
 * end as fast as it slows down. Returns whether there was one; then the forces are to be found again.
 */
static bool stop_slow_slips(struct settling *s)
{
	bool *const kept = take(s, s->meet_count, sizeof *kept);
	struct rb_tidy tidy = {.l = s->l,
	                       .t = s->t,
	                       .meet = s->meet,
	                       .before = s->before,
	                       .kept = kept,
	                       .count = s->meet_count,
	                       .pose = s->pose};
	bool any = false;

	for (int k = 0; kept && k < s->meet_count; k++) {
		const struct rb_joint_contact *c = &s->joint.contact[k];
		const struct rb_meet *m = &s->meet[k];
		const rb_vec3 slip = rb_vec3_reject(m->velocity, m->normal);
		const double slows = -rb_vec3_dot(slip_rate(s, k), c->slip);
		const bool slides = presses(s, k) && c->mode == RB_JOINT_SLIDE;
		const bool ends = slides && c->friction > 0 && slows > 0 &&
		                  !rb_set_is_single(s->l, m->a, m->b) &&
		                  rb_vec3_dot(slip, slip) <= 2 * slows * SLIP_ULP * DBL_EPSILON *
		                                                     rb_meet_size(s->l, m);

		kept[k] = presses(s, k);
		s->before[k].slipping = slides && !ends;
		s->before[k].ending = ends;
		any = any || ends;
	}
	if (any)
		rb_tidy_stop(&tidy);
	return any;
}

/*
 * The velocity of a slow slip says its direction to rounding over speed only, and against friction in a direction that is
 * wrong by that it would turn back within speed / (friction g), all the way. So where slips are straight in the directions
 * that they had, within rounding, these are kept.
 */
static bool solve_straight(struct settling *s)
{
	s->keeps_slips = true;
	if (!solve(s))
		return false;
	for (int k = 0; k < s->meet_count; k++) {
		const struct rb_joint_contact *c = &s->joint.contact[k];
		const struct rb_meet *m = &s->meet[k];
		const rb_vec3 slip = rb_vec3_reject(m->velocity, m->normal);
		rb_vec3 old;

		if (c->mode == RB_JOINT_SLIDE && presses(s, k) &&
		    goes_on_as_before(s, k, slip, &old) && !is_straight(s, k, old)) {
			s->keeps_slips = false;
			return solve(s);
		}
	}
	return true;
}

/* What stands is solved once, whatever that costs, and costs nothing from then on; what moves is solved again soon. */
static bool is_moving(const struct settling *s)
{
	const struct rb_located *l = s->l;

	for (int k = 0; k < l->set_count; k++) {
		const double size = rb_model_reach(l->model, l->set[k]);
		const double still = s->slack +
		                     STILL_ULP * DBL_EPSILON * sqrt(2 * l->weight * size);

		if (rb_vec3_max_abs(s->pose[k].velocity) > still ||
		    rb_vec3_max_abs(s->pose[k].spin) * size > still)
			return true;
	}
	return false;
}

void rb_settle(struct rb_located *l, double t, bool struck, double slack)
{
	struct settling s = {.l = l, .t = t, .slack = slack, .struck = struck};
	const rb_arena_mark here = rb_arena_here(l->arena);
	double try_s;

	if (begin(&s)) {
		keep_what_lasts(&s);
		s.moves = is_moving(&s);
		if (s.moves && rb_located_cost(3.0 * s.meet_count) > l->crowd_most) {
			too_many(&s);
			rb_arena_back(l->arena, here);
			return;
		}
		forget_before(&s, &try_s);
		pulls(&s);
		bool solved = l->status == RB_OK && solve_straight(&s);
		if (solved && s.meet_count > 0 && stop_slow_slips(&s))
			solved = solve(&s);
		if (solved) {
			join_all(&s);
			tell_lifts(&s);
			write_parts(&s, try_s);
		}
	}
	l->merge_count = 0;
	rb_arena_back(l->arena, here);
}
