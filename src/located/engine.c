/* SPDX-License-Identifier: MIT */
/*
 * The event loop. Every body has one next event in the queue (touch, cell wall, end of its piece),
 * every cluster one (transition, end of its piece, reported event), and forces that begin or end
 * one. An event moves only the bodies that it involves; all others stay on their arcs. A pair of
 * spheres is resolved directly. Whatever may involve more bodies uses the event set: it grows to
 * all bodies in contact, impacts and then contacts are resolved, and the next events of its members
 * are predicted anew.
 *
 * Work is bounded by counters (`crowd`, `products`), which simulated time reduces; above the limit,
 * `auto` takes steps instead.
 */
#include "located/engine.h"

#include "base/error.h"

#include <string.h>

#include "base/memory.h"
#include "located/account.h"
#include "located/cluster.h"
#include "located/crowd.h"
#include "located/driven.h"
#include "located/engine_create.h"
#include "located/piece_warm_start.h"
#include "located/predict.h"
#include "located/integrate.h"
#include "located/allowance.h"
#include "located/inspect.h"
#include "located/external_force.h"
#include "located/field_samples.h"
#include "located/joint_rows.h"
#include "located/resolve_contacts.h"
#include "located/pair_impact.h"
#include "located/resolve_impact.h"
#include "located/drift.h"
#include "located/transition.h"
#include "geom/distance.h"
#include "model/descriptor.h"
#include "world/joint_state.h"

/* Steps of a rotation's series between two polls for an interruption. */
enum { TURNS_PER_POLL = 1 << 20 };
/* Work in multiplications: of an event, without what it leads to; of one body at the start. */
enum { EVENT_WORK = RB_INTERRUPT_WORK / 64, START_WORK = 1 << 10 };
/*
 * Number of events at one moment, plus 64 per body, after which the run fails because time does not
 * advance.
 */
enum { STUCK_EVENTS = 10000 };
/* ---- events ---- */

/*
 * Predicts the next events of the set's members, which are on new arcs; events predicted with them
 * become invalid.
 */
static void predict_set(struct rb_located *l, double t)
{
	for (int k = 0; k < l->set_count; k++)
		l->generation[l->set[k]]++;
	for (int k = 0; k < l->set_count && l->status == RB_OK; k++)
		rb_predict(l, l->set[k], t, -1);
	rb_event_set_clear(l);
}

/*
 * Counts the bodies involved in one impact or change of contacts. Two spheres do not count: under
 * gravity alone they cannot collide densely, while two solids may rattle without end.
 */
static void count_crowd(struct rb_located *l)
{
	if (l->set_count > 2 || l->model->parts)
		l->crowd += (uint64_t)l->set_count;
}

/* Resolves the set's contacts and the impacts that follow from them; then predicts. */
static void resolve_set(struct rb_located *l, double t)
{
	int hit[2];

	if (!rb_resolve_contacts(l, t, false, 0, hit))
		rb_resolve_impacts(l, hit[0], hit[1], t);
	if (l->status == RB_OK)
		predict_set(l, t);
}

/* What an impact of a pair changes. */
struct pair_snapshot {
	struct rb_arc arc[2];
	struct rb_top top[2];
	struct rb_counts counts;
	struct rb_ledger ledger;
	double account_s[2];
	size_t events;
};

static void save_pair(const struct rb_located *l, int i, int j, struct pair_snapshot *before)
{
	before->arc[0] = l->arc[i];
	if (j < l->n)
		before->arc[1] = l->arc[j];
	if (l->top)
		before->top[0] = l->top[i];
	if (l->top && j < l->n)
		before->top[1] = l->top[j];
	before->counts = l->world->frame_counts;
	before->events = l->world->events.count;
	before->account_s[0] = before->account_s[1] = 0;
	if (!l->account_s)
		return;
	before->ledger = l->world->ledger;
	before->account_s[0] = l->account_s[i];
	before->account_s[1] = j < l->n ? l->account_s[j] : 0;
}

static void restore_pair(struct rb_located *l, int i, int j, const struct pair_snapshot *before)
{
	l->arc[i] = before->arc[0];
	if (j < l->n)
		l->arc[j] = before->arc[1];
	if (l->top)
		l->top[i] = before->top[0];
	if (l->top && j < l->n)
		l->top[j] = before->top[1];
	l->world->frame_counts = before->counts;
	l->world->events.count = before->events;
	if (!l->account_s)
		return;
	l->world->ledger = before->ledger;
	l->account_s[i] = before->account_s[0];
	if (j < l->n)
		l->account_s[j] = before->account_s[1];
}

/* Begins new pieces for the bodies of a pair that were on one, as rb_resolve_contacts does. */
static void restart_pieces(struct rb_located *l, const int pair[2], double t)
{
	double try_s = (double)INFINITY;
	uint64_t crept = 0;

	for (int k = 0; k < 2; k++)
		if (pair[k] < l->n && l->cluster_of[pair[k]] >= 0) {
			const struct rb_cluster *const c = &l->cluster[l->cluster_of[pair[k]]];

			try_s = fmin(try_s, c->try_s);
			crept = c->crept > crept ? c->crept : crept;
		}
	for (int k = 0; k < 2 && l->status == RB_OK; k++)
		if (pair[k] < l->n && l->cluster_of[pair[k]] >= 0) {
			const int cluster = l->cluster_of[pair[k]];

			l->cluster[cluster].try_s = try_s;
			l->cluster[cluster].crept = crept;
			rb_integrate_piece(l, cluster, t, false);
			rb_queue_set(l->queue, l->n + cluster, rb_transition_next(l, cluster));
		}
}

/*
 * Resolves a touch of two bodies: first as an isolated pair, undone if a third body turns out to
 * touch.
 */
static void touch(struct rb_located *l, int i, double t)
{
	const int j = l->next[i].partner;
	/* rb_pair_impact has ruled out a third body for these */
	const bool on_pieces = rb_located_on_piece(l, i) || rb_located_on_piece(l, j);
	struct pair_snapshot before;

	if (l->model->parts && j < l->n)
		rb_crowd_join(l, i, j);
	save_pair(l, i, j, &before);
	if (rb_pair_impact(l, i, j, t)) {
		l->generation[i]++;
		if (j < l->n)
			l->generation[j]++;
		const uint64_t products = l->products;
		if (on_pieces)
			restart_pieces(l, (int[]){i, j}, t);
		/* nor do two spheres on pieces count */
		l->products = rb_crowd_counts_spheres(l) ? l->products : products;
		if (l->status != RB_OK)
			return;
		int others = rb_predict(l, i, t, j);
		if (j < l->n)
			others += rb_predict(l, j, t, i);
		if (others == 0 || on_pieces)
			return;
		restore_pair(l, i, j, &before);
	}
	rb_resolve_impacts(l, i, j, t);
	count_crowd(l);
	if (l->status == RB_OK)
		predict_set(l, t);
}

/*
 * Handles a cell wall, an unfinished search or a touch; predicts anew if the partner has had an
 * event since the prediction.
 */
static void body_event(struct rb_located *l, int i, double t)
{
	const struct rb_next *next = &l->next[i];

	if (next->wall_s < next->touch_s) {
		rb_predict_wall(l, i, t);
		return;
	}
	/* unfinished searches count as well */
	l->crowd += next->unfinished && l->model->parts;
	if (next->unfinished ||
	    (next->partner < l->n && next->generation != l->generation[next->partner])) {
		rb_predict(l, i, t, -1);
		return;
	}
	l->events++;
	l->world->frame_counts.substeps++;
	touch(l, i, t);
}

/* Handles a cluster's next piece, transition or impact. */
static void cluster_event(struct rb_located *l, int cluster, double t)
{
	const struct rb_cluster *c = &l->cluster[cluster];

	l->events++;
	l->world->frame_counts.substeps++;
	for (int k = 0; k < c->member_count; k++)
		rb_event_set_add(l, c->member[k]);
	if (c->integrated && c->held_count == 0 &&
	    !l->model->joints) { /* only external forces: the next piece */
		rb_integrate_piece(l, cluster, t, true);
		rb_queue_set(l->queue, l->n + cluster, rb_transition_next(l, cluster));
		predict_set(l, t);
		return;
	}
	/* a next piece does not count as a crowd event; its arithmetic is counted instead */
	if ((!c->integrated || c->is_cut || c->hits || c->has_jumped) && c->held_count > 0)
		count_crowd(l);
	if (c->hits) { /* bodies in contact touch at another point */
		rb_resolve_impacts(l, c->hit_a, c->hit_b, t);
		if (l->status == RB_OK)
			predict_set(l, t);
		return;
	}
	resolve_set(l, t);
}

/* Handles forces that begin or end: bodies with forces get new arcs. */
static void switch_event(struct rb_located *l, double t)
{
	const struct rb_scene *scene = l->model->scene;

	while (l->switch_next < l->switch_count && l->switch_s[l->switch_next] <= t)
		l->switch_next++;
	rb_queue_set(l->queue, 2 * l->n,
	             l->switch_next < l->switch_count ? l->switch_s[l->switch_next] : HUGE_VAL);
	for (int i = 0; i < l->n; i++) {
		if (scene->bodies[l->model->id_of[i]].force_count == 0 || rb_located_fixed(l, i))
			continue;
		rb_event_set_add(l, i);
	}
	resolve_set(l, t);
}

/* Begins the next piece of a driven body and resolves all contacts with it. */
static void driven_event(struct rb_located *l, int i, double t)
{
	rb_driven_piece(l, i, t);
	if (l->status != RB_OK)
		return;
	l->generation[i]++;
	rb_predict(l, i, t, -1);
	/* bodies attracted by it, in contact with it or on its springs follow its new piece */
	for (int k = 0; rb_located_gravitates(l) && l->model->attraction[i] > 0 && k < l->n; k++)
		if (rb_gravitation_attracts(l->model, k) && l->cluster_of[k] >= 0)
			rb_event_set_add(l, k);
	for (int k = 0; k < l->cluster_count; k++)
		for (int h = 0; l->cluster[k].used && h < l->cluster[k].held_count; h++)
			if (l->cluster[k].held[h].a == i || l->cluster[k].held[h].b == i) {
				for (int m = 0; m < l->cluster[k].member_count; m++)
					rb_event_set_add(l, l->cluster[k].member[m]);
				break;
			}
	for (int k = 0; k < l->n && rb_joint_rows_hold(l, i); k++)
		if (l->cluster_of[k] >= 0 && rb_joint_rows_joined(l, i, k))
			rb_event_set_add(l, k);
	rb_event_set_add_partners(l, i);
	if (l->set_count > 0)
		resolve_set(l, t);
}

/* Returns true and fails when time does not advance. */
static bool is_stuck(struct rb_located *l, int which, double t)
{
	char label[64], source[96];
	const int body = which < l->n       ? which
	                 : which < 2 * l->n ? l->cluster[which - l->n].member[0]
	                                    : 0;

	if (t > l->stuck_s) {
		l->stuck_s = t;
		l->stuck_count = 0;
		return false;
	}
	if (++l->stuck_count < (uint64_t)STUCK_EVENTS + 64 * (uint64_t)l->n)
		return false;
	l->status = RB_FAIL(l->err, RB_ERR_PHYSICS,
	                    "%sno progress after %llu events at t = %.17g s, the last of '%s'",
	                    rb_scene_body_source(l->model->scene, l->model->id_of[body], source),
	                    (unsigned long long)l->stuck_count, t,
	                    rb_scene_body_label(l->model->scene, l->model->id_of[body], label));
	return true;
}

/* Writes every body's state at t. */
static void store_all(const struct rb_located *l, double t)
{
	for (int i = 0; i < l->n; i++)
		rb_arc_store(l, i, t);
	l->world->state.time_s = t;
}

/* Global rollback: evaluates the whole scene at the event's time. */
static void restore_everything(struct rb_located *l, double t)
{
	store_all(l, t);
	l->world->frame_counts.rollbacks++;
	l->world->frame_counts.discarded_body_steps += (uint64_t)l->n;
}

/* ---- callbacks ---- */

/* Calls the hooks for events since `first`; bodies that they change get new arcs. */
static void call_hooks(struct rb_located *l, size_t first, double t)
{
	struct rb_world *world = l->world;
	const struct rb_world_hooks *hooks = &world->hooks;
	const size_t count = world->events.count;

	if (count > first && (hooks->collision || hooks->transition)) {
		store_all(l, t);
		rb_account_all(l, t); /* work of callback forces so far */
		rb_state_copy(&world->start, &world->state);
		for (size_t k = first; k < count && l->status == RB_OK; k++) {
			const struct rb_event event = world->events.row[k];

			world->called++;
			world->moment++;
			if (rb_event_is_impact(event.kind) && hooks->collision)
				l->status = hooks->collision(hooks->user, world, &event, l->err);
			else if (!rb_event_is_impact(event.kind) && hooks->transition)
				l->status = hooks->transition(hooks->user, world, &event, l->err);
		}
		if (l->status == RB_OK)
			l->status = rb_engine_take_changes(l, t, l->err);
	}
	if (!world->options.keep_events)
		world->events.count = first;
}

/* True if a body's row differs. */
static bool differs(const double *a, const double *b, int i, int columns)
{
	return a && memcmp(a + (size_t)columns * (size_t)i, b + (size_t)columns * (size_t)i,
	                   (size_t)columns * sizeof *a) != 0;
}

/*
 * Schedules impacts of bodies in contact that a callback has set moving towards each other: the
 * search for touches skips pairs in contact.
 */
static void predict_closing(struct rb_located *l, double t)
{
	for (int k = 0; k < l->cluster_count; k++) {
		const struct rb_cluster *c = &l->cluster[k];

		for (int h = 0; c->used && h < c->held_count; h++) {
			const struct rb_contact_point m = rb_event_set_contact_point(l, &c->held[h],
			                                                             t);
			const double speeds = rb_vec3_length(m.pose_a.velocity) +
			                      rb_vec3_length(m.pose_b.velocity);
			const int mover = rb_located_fixed(l, m.a) ? m.b : m.a;
			const int other = mover == m.a ? m.b : m.a;

			if (!(rb_vec3_dot(m.velocity, m.normal) <
			      -rb_contact_point_noise(l, &m) - rb_drift_correct * speeds))
				continue;
			l->next[mover].touch_s = t;
			l->next[mover].partner = other;
			l->next[mover].unfinished = false;
			l->next[mover].generation = other < l->n ? l->generation[other] : 0;
			rb_queue_set(l->queue, mover, t);
		}
	}
}

/* True if the body has a joint, released or not. */
static bool has_joint(const struct rb_located *l, int i)
{
	return l->model->joints->first[i] < l->model->joints->first[i + 1];
}

enum rb_status rb_engine_take_changes(struct rb_located *l, double t, struct rb_error *err)
{
	const struct rb_state *now = &l->world->state, *before = &l->world->start;

	RB_ASSERT(l->status == RB_OK);
	RB_ASSERT(l->set_count == 0);
	l->err = err;
	l->moment++;
	/*
	 * bodies of a released joint or of a changed motor start new arcs from their present poses
	 */
	const bool joints_changed = l->world->joints_changed;
	l->world->joints_changed = false;
	for (int i = 0; i < l->n && l->started; i++) {
		const bool moved = differs(now->position, before->position, i, 3);
		const bool kicked = moved || differs(now->velocity, before->velocity, i, 3) ||
		                    differs(now->spin, before->spin, i, 3) ||
		                    differs(now->orientation, before->orientation, i, 4) ||
		                    (joints_changed && has_joint(l, i));

		if (rb_located_driven(l, i) ||
		    (!kicked && !differs(now->push, before->push, i, 3) &&
		     !differs(now->twist, before->twist, i, 3)))
			continue;
		struct rb_pose pose = rb_arc_pose(l, i, t);
		if (moved) {
			pose.position = rb_world_row3(now->position, i);
			pose.rest = (rb_vec3){0, 0, 0};
		}
		pose.velocity = rb_world_row3(now->velocity, i);
		if (l->top)
			pose.spin = rb_world_row3(now->spin, i);
		if (kicked && l->cluster_of[i] >= 0) {
			/*
			 * the other members of its cluster start new arcs from their present poses
			 */
			const struct rb_cluster *c = &l->cluster[l->cluster_of[i]];

			for (int m = 0; m < c->member_count; m++) {
				const struct rb_pose other = rb_arc_pose(l, c->member[m], t);

				rb_event_set_add(l, c->member[m]);
				if (rb_located_on_piece(l, c->member[m]))
					rb_arc_anchor(l, c->member[m], t, &other,
					              (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
			}
		}
		if (kicked)
			rb_arc_anchor(l, i, t, &pose, rb_arc_acceleration(l, i, t),
			              (rb_vec3){0, 0, 0});
		if (moved && l->cells)
			rb_cells_place(l->cells, i, pose.position);
		rb_event_set_add(l, i);
	}
	if (l->set_count > 0) {
		rb_resolve_contacts(l, t, true, 0, NULL);
		predict_set(l, t);
		predict_closing(l, t);
	}
	if (l->started)
		rb_joint_states_fit(l->world);
	return l->status;
}

/* ---- advancing ---- */

/* Takes the contact forces left by the stepped method as initial guesses. */
static void take_left(struct rb_located *l)
{
	l->stepped_contacts.count = 0;
	if (rb_contacts_join(&l->stepped_contacts, &l->world->contacts, l->err) != RB_OK)
		l->status = RB_ERR_MEMORY;
}

/*
 * Starts arcs from the world's state; resolves bodies that touch or whose motion has no closed
 * form.
 */
static void start(struct rb_located *l, double t)
{
	const rb_vec3 none = {0, 0, 0};

	l->started = l->starting = true;
	l->now_s = l->from_s = t;
	rb_inspect_forget(l);
	take_left(l);
	rb_account_begin(l, t);
	for (int i = 0; i < l->n && l->status == RB_OK; i++) {
		struct rb_pose pose = {.position = rb_world_row3(l->world->state.position, i),
		                       .velocity = rb_world_row3(l->world->state.velocity, i),
		                       .orientation = l->model->orientation[i]};
		rb_vec3 linear = none;

		if (l->top) {
			pose.orientation = rb_quat_from(l->world->state.orientation +
			                                4 * (size_t)i);
			pose.spin = rb_world_row3(l->world->state.spin, i);
		}
		if (rb_interrupt_after(&l->world->interrupt, START_WORK))
			break;
		rb_arc_anchor(l, i, t, &pose, none, none);
		if (l->cells && t > 0)
			rb_cells_place(l->cells, i, pose.position);
		if (rb_located_driven(l, i)) {
			rb_driven_piece(l, i, t);
			continue;
		}
		const double decay = rb_external_decay(l, i, t);
		if (!isnan(decay))
			linear = rb_external_constant(l, i, t, &pose);
		rb_arc_anchor(l, i, t, &pose, linear, rb_external_turning(l, i));
		rb_arc_set_drag(l, i, isnan(decay) ? 0 : decay);
	}
	/* if events are too dense here, the run is left to steps at once */
	for (int i = 0; i < l->n && l->status == RB_OK && !rb_located_is_dense(l); i++) {
		if (rb_interrupt_after(&l->world->interrupt, START_WORK))
			break;
		/* already predicted together with the cluster that it has joined */
		if (l->cluster_of[i] >= 0 && !rb_located_driven(l, i))
			continue;
		rb_crowd_event(l, i);
		const int touching = rb_predict(l, i, t, -1);

		if (rb_located_driven(l, i) ||
		    (touching == 0 && !isnan(rb_external_decay(l, i, t)) &&
		     !rb_joint_rows_hold(l, i)))
			continue;
		rb_event_set_add(l, i);
		resolve_set(l, t);
		rb_crowd_count(l, i);
	}
	l->pace = rb_located_pace(l);
	l->starting = false;
	while (l->switch_next < l->switch_count && l->switch_s[l->switch_next] <= t)
		l->switch_next++;
	if (l->switch_next < l->switch_count)
		rb_queue_set(l->queue, 2 * l->n, l->switch_s[l->switch_next]);
}

/*
 * Moves the clock to `t` and reduces the work counters by what the elapsed time allows; the result
 * does not depend on how the time is divided.
 */
static void advance_clock(struct rb_located *l, double t)
{
	const uint64_t paid = rb_located_allowed(l, t) - rb_located_allowed(l, l->now_s),
		       crowd = rb_located_crowd(l);

	l->crowd = crowd - (paid < crowd ? paid : crowd);
	l->products %= RB_LOCATED_PRODUCTS;
	if (l->crowd == 0 && t > l->now_s)
		rb_crowd_end(l);
	l->now_s = t;
}

/* Handles one event and its callbacks. */
static void one_event(struct rb_located *l, int which, double t)
{
	RB_ASSERT_COSTLY(which >= 0 && which <= 2 * l->n && t >= l->now_s);

	const size_t reported = l->world->events.count;

	advance_clock(l, t);
	l->moment++;
	if (is_stuck(l, which, t))
		return;
	if (l->model->rollback == RB_ROLLBACK_GLOBAL)
		restore_everything(l, t);
	const int body = which < l->n       ? which
	                 : which < 2 * l->n ? l->cluster[which - l->n].member[0]
	                                    : -1;

	rb_crowd_event(l, body);
	if (which >= 2 * l->n)
		switch_event(l, t);
	else if (which >= l->n)
		cluster_event(l, which - l->n, t);
	else if (rb_located_driven(l, which) && t >= l->piece[which].until_s)
		driven_event(l, which, t);
	else
		body_event(l, which, t);
	rb_crowd_count(l, body);
	if (l->status == RB_OK && !rb_interrupt_is_set(&l->world->interrupt))
		call_hooks(l, reported, t);
}

/* Steps can roll back what events cannot resolve, but do not support every force. */
bool rb_engine_wants_steps(const struct rb_located *l)
{
	return (l->model->features & RB_FEATURE_PUSHES) || rb_located_can_be_stepped(l);
}

bool rb_engine_locates(const struct rb_located *l)
{
	return l->started;
}

double rb_engine_located_time(const struct rb_located *l)
{
	return l->now_s - l->from_s;
}

/*
 * Discards arcs and clusters, of which some may be incomplete, and the memory of clusters:
 * otherwise checkpoints would have them, and steps that take over would carry it.
 */
static void forget_arcs(struct rb_located *l)
{
	for (int k = 0; k < l->cluster_count; k++)
		if (l->cluster[k].used)
			rb_cluster_drop(l, k);
	for (int i = 0; l->piece && i < l->n; i++)
		if (!rb_located_driven(l, i))
			l->piece[i].piece.n = 0;
	rb_cluster_release_rows(l);
	rb_piece_warm_start_release(l);
	for (int i = 0; i < l->n; i++)
		l->bounces[i] = (struct rb_bounces){.partner = -1, .met_with = -1};
	l->merge_count = 0;
	l->switch_next = 0;
	l->stepped_contacts.count = 0;
	l->started = false;
	l->world->open = (struct rb_entries){0};
}

void rb_engine_roll_back(struct rb_located *l)
{
	l->status = RB_OK;
	rb_event_set_clear(l);
	forget_arcs(l);
}

/* True if events are too dense or cannot be resolved, and steps can take over. */
static bool must_give_up(const struct rb_located *l)
{
	if (!rb_located_can_be_stepped(l) || (l->status != RB_OK && l->status != RB_ERR_PHYSICS))
		return false;
	return l->status != RB_OK || rb_located_is_dense(l);
}

/* Stops locating at the time reached if events are too dense or have failed: then true. */
static bool gives_up(struct rb_located *l)
{
	if (!must_give_up(l))
		return false;
	l->status = RB_OK;
	rb_event_set_clear(l);
	store_all(l, l->now_s);
	l->status = rb_inspect_contacts(l, l->now_s);
	rb_account_all(l, l->now_s);
	forget_arcs(l);
	return true;
}

/*
 * Begins to locate. If that is too costly at once, everything is restored: the contacts and the
 * bodies at rest that steps know are as good as before.
 */
static void begin(struct rb_located *l)
{
	struct rb_world *const world = l->world;
	const struct rb_counts counts = world->frame_counts;
	const struct rb_ledger ledger = world->ledger;
	const struct rb_entries open = world->open;
	const size_t reported = world->events.count;

	rb_crowd_begin(l);
	start(l, world->state.time_s);
	if (must_give_up(l)) {
		rb_engine_roll_back(l);
		world->frame_counts = counts;
		world->ledger = ledger;
		world->open = open;
		world->events.count = reported;
	} else if (l->status == RB_OK && !rb_interrupt_is_set(&world->interrupt)) {
		/* slips without a driving force have ended at once */
		call_hooks(l, reported, l->now_s);
	}
}

/* Advances the series of fast rotations in parts; false: the run is interrupted. */
static bool advance_rotations(struct rb_located *l, double t)
{
	for (int i = 0; l->top && i < l->n; i++)
		while (!rb_located_on_piece(l, i) &&
		       !rb_top_follow(&l->top[i], t - l->arc[i].anchor_s, TURNS_PER_POLL))
			if (rb_world_is_stopped(l->world))
				return false;
	return true;
}

/* True if the run is interrupted, whatever state the solvers have reached. */
static bool is_interrupted(struct rb_located *l, uint64_t work)
{
	if (!rb_interrupt_after(&l->world->interrupt, work))
		return false;
	l->status = RB_FAIL(l->err, RB_ERR_INTERRUPT, "interrupted");
	return true;
}

enum rb_status rb_engine_advance(struct rb_located *l, double until, struct rb_error *err)
{
	const double start = l->world->state.time_s;
	double t, seen_s = rb_field_samples_from(l, start);

	RB_ASSERT(until >= start);
	l->err = err;
	const bool starts = !l->started;
	if (starts)
		begin(l);
	if (is_interrupted(l, 0) || !l->started || gives_up(l))
		return l->status;
	if (starts && l->status == RB_OK) /* otherwise steps may still have to fit some of them */
		rb_joint_states_fit(l->world);
	for (int which = rb_field_samples_next(l, until, &seen_s, &t); which >= 0;
	     which = rb_field_samples_next(l, until, &seen_s, &t)) {
		rb_arena_reset(l->arena);
		/* an event that rounding has put before the present time happens now */
		one_event(l, which, fmax(t, l->now_s));
		if (is_interrupted(l, EVENT_WORK))
			return l->status;
		if (gives_up(l))
			return l->status;
	}
	if (l->status != RB_OK)
		return l->status;
	if (!advance_rotations(l, until))
		return RB_FAIL(err, RB_ERR_INTERRUPT, "interrupted");
	advance_clock(l, fmax(l->now_s, until));
	l->stepped_contacts.count = 0;
	store_all(l, until);
	l->world->frame_counts.body_steps += (uint64_t)l->n;
	if (l->model->features & RB_FEATURE_PUSHES) /* callback forces end with the step */
		rb_account_all(l, until);
	else if (l->account_s)
		l->world->open = rb_account_open(l, until);
	return l->status = rb_inspect_finite(l, start);
}

/* Finds the deepest overlap, m; RB_ERR_PHYSICS if it exceeds the tolerance. */
static enum rb_status check(struct rb_located *l, double *depth, struct rb_error *err)
{
	const double t = l->world->state.time_s;
	char first[64], second[64], source[96];
	int a, b;

	*depth = 0;
	if (!(l->model->features & RB_FEATURE_CONTACT))
		return RB_OK;
	*depth = rb_inspect_overlap(l, t, &a, &b);
	if (*depth <= rb_world_tolerance(l->world))
		return RB_OK;
	return l->status = RB_FAIL(
		       err, RB_ERR_PHYSICS,
		       "%s'%s' and '%s' overlap by %.3g m at t = %.9g s, tolerance %.3g m",
		       rb_scene_body_source(l->model->scene, l->model->id_of[a], source),
		       rb_scene_body_label(l->model->scene, l->model->id_of[a], first),
		       rb_scene_body_label(l->model->scene, l->model->id_of[b], second), *depth, t,
		       rb_world_tolerance(l->world));
}

enum rb_status rb_engine_check(struct rb_located *l, struct rb_error *err)
{
	double depth;

	/* with many bodies on arcs (cells), touches have closed forms and cannot be missed */
	return l->cells && !rb_located_varies(l) ? RB_OK : check(l, &depth, err);
}

enum rb_status rb_engine_inspect(struct rb_located *l, struct rb_error *err)
{
	const double t = l->world->state.time_s;
	double depth;

	l->err = err;
	if (!l->started) /* this frame was reached by steps */
		return RB_OK;
	l->status = rb_inspect_contacts(l, t);
	if (l->status == RB_OK && l->world->options.keep_contacts)
		l->status = rb_inspect_forces(l, t, &l->world->shown);
	l->world->has_shown = l->world->options.keep_contacts && l->status == RB_OK;
	if (l->status != RB_OK)
		return l->status;
	const enum rb_status status = check(l, &depth, err);
	l->world->frame_counts.max_penetration_m = fmax(l->world->frame_counts.max_penetration_m,
	                                                depth);
	return status;
}
