/* SPDX-License-Identifier: MIT */
#include "located/account.h"

#include "base/error.h"

#include <string.h>

#include "base/memory.h"
#include "math/decay.h"

/* ---- bodies in flight ---- */

/* Integrals of an arc over a span of time. */
struct span {
	double seconds;
	rb_vec3 way;      /* m: displacement */
	rb_vec3 place;    /* m s: integral of the position */
	double square;    /* m^2/s^2: integral of the velocity's square, times `decay` */
	rb_vec3 momentum; /* m^2/s: of position x velocity, times `decay` */
};

/*
 * Integrals of an arc with drag: with tau = s f_1, psi = s^2 f_2 of math/decay, whose rates are
 * e^-z and tau, and k times whose integrals are s - tau and s^2/2 - psi, k int v^2 = k v^2 int
 * e^-2z + k tau^2 v.g + (psi - tau^2/2) g^2, and k int x x v = k x_0 x way + (2 psi - tau^2 - k psi
 * tau) v x g.
 */
static struct span decaying_span(const struct rb_arc *arc, double from, double to)
{
	const double s = to - from, k = arc->decay;
	const struct rb_decay d = rb_decay_at(k * s);
	const double before = from - arc->anchor_s;
	const rb_vec3 g = arc->acceleration, v = rb_decay_velocity(k, before, arc->velocity, g);
	const rb_vec3 x = rb_vec3_add(arc->position, rb_decay_way(k, before, arc->velocity, g));
	const double tau = s * d.once, psi = s * s * d.twice;
	struct span span = {.seconds = s};

	span.way = rb_vec3_add_scaled(rb_vec3_scale(tau, v), psi, g);
	span.place = rb_vec3_add_scaled(rb_vec3_add_scaled(rb_vec3_scale(s, x), psi, v),
	                                s * s * s * d.thrice, g);
	span.square = k * s * rb_decay_at(2 * k * s).once * rb_vec3_dot(v, v) +
	              k * tau * tau * rb_vec3_dot(v, g) +
	              (psi - 0.5 * tau * tau) * rb_vec3_dot(g, g);
	span.momentum = rb_vec3_add_scaled(rb_vec3_scale(k, rb_vec3_cross(x, span.way)),
	                                   2 * psi - tau * tau - k * psi * tau,
	                                   rb_vec3_cross(v, g));
	return span;
}

static struct span span_of(const struct rb_arc *arc, double from, double to)
{
	if (arc->decay > 0)
		return decaying_span(arc, from, to);
	const double s = to - from, before = from - arc->anchor_s;
	const rb_vec3 v = rb_vec3_add_scaled(arc->velocity, before, arc->acceleration);
	const rb_vec3 x = rb_vec3_add_scaled(
		arc->position, before,
		rb_vec3_add_scaled(arc->velocity, 0.5 * before, arc->acceleration));
	const rb_vec3 half = rb_vec3_add_scaled(rb_vec3_scale(0.5, v), s / 6, arc->acceleration);

	return (struct span){
		.seconds = s,
		.way = rb_vec3_scale(s, rb_vec3_add_scaled(v, 0.5 * s, arc->acceleration)),
		.place = rb_vec3_scale(s, rb_vec3_add_scaled(x, s, half))};
}

static void add_force(struct rb_entries *e, enum rb_ledger_momentum cause, rb_vec3 force,
                      const struct span *span)
{
	rb_entries_momentum(e, cause, rb_vec3_scale(span->seconds, force),
	                    rb_vec3_cross(span->place, force));
}

/*
 * Adds the scene's forces on a body; on a parabola these act at the centre of mass and exert no
 * torque (located/external_force).
 */
static void add_scene_forces(const struct rb_located *l, int i, const struct span *span,
                             struct rb_entries *e)
{
	const struct rb_scene *scene = l->model->scene;
	const struct rb_body_def *body = &scene->bodies[l->model->id_of[i]];

	for (int f = 0; f < body->force_count; f++) {
		const struct rb_force_def *def = &scene->forces[body->force_first + f];
		rb_vec3 force = def->vector;

		if (!rb_force_acts(def, l->arc[i].anchor_s))
			continue;
		if (def->frame == RB_FORCE_BODY)
			force = rb_quat_rotate(l->model->orientation[i], force);
		rb_entries_energy(e, RB_ENERGY_APPLIED, rb_vec3_dot(force, span->way));
		add_force(e, RB_MOMENTUM_APPLIED, force, span);
	}
}

static void add_pushes(const struct rb_located *l, int i, double from, double to,
                       const struct span *span, struct rb_entries *e)
{
	const rb_vec3 push = rb_world_row3(l->world->state.push, i);
	const rb_vec3 twist = rb_world_row3(l->world->state.twist, i);

	rb_entries_energy(e, RB_ENERGY_CALLBACKS, rb_vec3_dot(push, span->way));
	add_force(e, RB_MOMENTUM_CALLBACKS, push, span);
	if (!l->top || rb_vec3_max_abs(twist) == 0)
		return;
	/*
	 * only bodies with equal moments remain on arcs with a torque: their spin changes linearly
	 */
	rb_vec3 begin, end;
	rb_quat q;

	rb_top_at(&l->top[i], from - l->arc[i].anchor_s, &q, &begin);
	rb_top_at(&l->top[i], to - l->arc[i].anchor_s, &q, &end);
	rb_entries_energy(e, RB_ENERGY_CALLBACKS,
	                  0.5 * span->seconds * rb_vec3_dot(twist, rb_vec3_add(begin, end)));
	rb_entries_twist(e, RB_MOMENTUM_CALLBACKS, rb_vec3_scale(span->seconds, twist));
}

static void add_flight(const struct rb_located *l, int i, double from, double to,
                       struct rb_entries *e)
{
	const rb_features features = l->model->features;
	const struct rb_world_def *def = &l->model->scene->world;

	if (!(to > from) || rb_located_on_piece(l, i) || rb_located_driven(l, i))
		return;
	if (!(features & (RB_FEATURE_GRAVITY | RB_FEATURE_GRAVITY_FORCE | RB_FEATURE_FORCES |
	                  RB_FEATURE_PUSHES)) &&
	    !(l->arc[i].decay > 0))
		return;
	const struct span span = span_of(&l->arc[i], from, to);

	add_force(e, RB_MOMENTUM_APPLIED,
	          rb_vec3_add_scaled(def->gravity_force, l->model->mass[i], def->gravity), &span);
	if (l->arc[i].decay > 0) {
		rb_entries_energy(e, RB_ENERGY_DRAG, l->model->mass[i] * span.square);
		rb_entries_momentum(e, RB_MOMENTUM_DRAG,
		                    rb_vec3_scale(-l->model->mass[i] * l->arc[i].decay, span.way),
		                    rb_vec3_scale(-l->model->mass[i], span.momentum));
	}
	if (features & RB_FEATURE_FORCES)
		add_scene_forces(l, i, &span, e);
	if (features & RB_FEATURE_PUSHES)
		add_pushes(l, i, from, to, &span, e);
}

void rb_account_arc(struct rb_located *l, int i, double t)
{
	struct rb_entries e = {0};

	RB_ASSERT_COSTLY(rb_located_moves(l, i));
	RB_ASSERT_COSTLY(t >= l->arc[i].anchor_s || !l->account_s);
	if (!l->account_s)
		return;
	add_flight(l, i, l->account_s[i], t, &e);
	if (e.causes)
		rb_ledger_enter(&l->world->ledger, &e);
	l->account_s[i] = t;
}

/* ---- clusters ---- */

/*
 * Integrals of the contacts' rates between parabolas, from the cluster's beginning to `s` seconds
 * later.
 */
static void contacts_until(const struct rb_account_rates *r, double s, struct rb_entries *e)
{
	e->row[RB_ENERGY_SLIDING] = s * (r->sliding[0] + 0.5 * s * r->sliding[1]);
	for (int k = 0; k < 2; k++) {
		const int cause = k == 0 ? RB_MOMENTUM_STATIC : RB_MOMENTUM_DRIVEN;
		const rb_vec3 *t = r->torque[k];
		const rb_vec3 mean = rb_vec3_add_scaled(
			t[0], s, rb_vec3_add_scaled(rb_vec3_scale(0.5, t[1]), s / 3, t[2]));

		rb_vec3_to(e->row + RB_ENTRY_LINEAR + 3 * cause, rb_vec3_scale(s, r->force[k]));
		rb_vec3_to(e->row + RB_ENTRY_ANGULAR + 3 * cause, rb_vec3_scale(s, mean));
	}
}

static void cluster_until(const struct rb_cluster *c, double t, struct rb_entries *e)
{
	*e = (struct rb_entries){.causes = ~0u};
	if (c->account.n > 0)
		rb_gauss_values(&c->account, t - c->anchor_s, e->row);
	else
		contacts_until(&c->rates, t - c->anchor_s, e);
}

static void cluster_entries(const struct rb_cluster *c, double t, struct rb_entries *e)
{
	struct rb_entries before, now;

	/* on parabolas only contacts have entries; integrated without an account there are none */
	if (!c->used || !(t > c->account_s) || (c->integrated && c->account.n == 0))
		return;
	cluster_until(c, c->account_s, &before);
	cluster_until(c, t, &now);
	rb_entries_add(e, -1, &before);
	rb_entries_add(e, 1, &now);
}

void rb_account_cluster(struct rb_located *l, int cluster, double t)
{
	struct rb_entries e = {0};

	RB_ASSERT(cluster >= 0 && cluster < l->cluster_count);
	if (!l->account_s)
		return;
	cluster_entries(&l->cluster[cluster], t, &e);
	if (e.causes != 0)
		rb_ledger_enter(&l->world->ledger, &e);
	l->cluster[cluster].account_s = t;
}

bool rb_account_reserve(struct rb_located *l, struct rb_cluster *c)
{
	c->account.n = 0;
	if (!l->account_s)
		return true;
	if (!c->account_block)
		c->account_block = rb_memory_take((size_t)RB_ENTRIES * (1 + RB_GAUSS_NODES),
		                                  sizeof *c->account_block);
	c->account.start = c->account_block;
	c->account.coefficient = c->account_block + RB_ENTRIES;
	return c->account_block != NULL;
}

/* ---- all ---- */

void rb_account_all(struct rb_located *l, double t)
{
	for (int i = 0; l->account_s && i < l->n; i++)
		rb_account_arc(l, i, t);
	for (int k = 0; l->account_s && k < l->cluster_count; k++)
		rb_account_cluster(l, k, t);
}

void rb_account_begin(struct rb_located *l, double t)
{
	for (int i = 0; l->account_s && i < l->n; i++)
		l->account_s[i] = t;
}

struct rb_entries rb_account_open(const struct rb_located *l, double t)
{
	struct rb_entries e = {0};

	for (int i = 0; l->account_s && i < l->n; i++)
		add_flight(l, i, l->account_s[i], t, &e);
	for (int k = 0; l->account_s && k < l->cluster_count; k++)
		cluster_entries(&l->cluster[k], t, &e);
	return e;
}

static void pack_cluster(struct rb_located *l, struct rb_cluster *c, struct rb_pack *pack)
{
	bool integrals = c->account.n > 0;

	rb_fields_pack(rb_account_rates_fields(), &c->rates, 1, NULL, pack);
	rb_pack_bool(pack, &integrals);
	if (!integrals || pack->failed)
		return;
	if (pack->loading && !rb_account_reserve(l, c)) {
		rb_pack_fail_memory(pack);
		return;
	}
	c->account.n = RB_ENTRIES;
	rb_pack_finite(pack, &c->account.length_s, 1);
	(void)rb_pack_check(pack, c->account.length_s > 0, "a piece without length");
	rb_pack_doubles(pack, c->account_block, (size_t)RB_ENTRIES * (1 + RB_GAUSS_NODES));
}

void rb_account_pack(struct rb_located *l, struct rb_pack *pack)
{
	if (!l->account_s)
		return;
	rb_pack_finite(pack, l->account_s, (size_t)l->n);
	for (int k = 0; k < l->cluster_count && !pack->failed; k++)
		if (l->cluster[k].used)
			pack_cluster(l, &l->cluster[k], pack);
}
