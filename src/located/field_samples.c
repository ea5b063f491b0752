/* SPDX-License-Identifier: MIT */
#include "located/field_samples.h"

#include "base/error.h"

#include "located/external_force.h"
#include "located/queue.h"
#include "math/gauss_piece.h"

enum { NODES = RB_GAUSS_NODES };

/* No gap between nodes is a larger share of a piece. */
static const double node_gap = 0.2;
/*
 * Change of a member's velocity between samples that may be missed, relative to its size: eight
 * errors of a step (located/integrate), as at its ends.
 */
static const double missed_max = 8 * 3e-14;

/* Change of a force in the rounding of time that no smooth function of it has, relative. */
static const double jump_min = 1e-9;

double rb_field_samples_from(const struct rb_located *l, double t)
{
	const double interval = rb_located_sampling(l);
	double k = ceil(t / interval);

	if (!(l->model->features & RB_FEATURE_FIELD))
		return HUGE_VAL;
	while ((k - 1) * interval >= t)
		k--;
	while (k * interval < t)
		k++;
	return k * interval;
}

double rb_field_samples_after(const struct rb_located *l, double t)
{
	return rb_field_samples_from(l, nextafter(t, HUGE_VAL));
}

/* Position and velocity of member k at a time of the piece. */
static void place(const struct rb_field_samples *of, int k, double s, rb_vec3 at[2])
{
	const struct rb_located *l = of->l;
	double value[RB_PIECE_ORIENTATION];

	rb_gauss_some(&of->c->piece, k * rb_located_row(l), RB_PIECE_ORIENTATION, s, value);
	at[0] = rb_vec3_add(of->base ? of->base[k] : l->piece[of->c->member[k]].base,
	                    rb_vec3_from(value + RB_PIECE_POSITION));
	at[1] = rb_vec3_from(value + RB_PIECE_VELOCITY);
}

/* Fills the accelerations by the field at the nodes, once for each piece. */
static void find_at_nodes(const struct rb_field_samples *of)
{
	struct rb_cluster *const c = of->c;
	double *to = c->at_nodes;

	for (int j = 0; j < NODES && !c->has_nodes; j++) {
		const double s = rb_gauss_node(j) * c->piece.length_s;

		for (int k = 0; k < c->member_count; k++, to += 3) {
			rb_vec3 at[2];

			place(of, k, s, at);
			rb_vec3_to(to, rb_external_field(of->l, c->member[k], of->origin_s + s,
			                                 at[0], at[1]));
		}
	}
	c->has_nodes = true;
}

/* Does an error of position or velocity of the piece's own size change the force as much? */
static bool is_error(const struct rb_field_samples *of, int k, double t, const rb_vec3 at[2],
                     double speed, double off)
{
	const struct rb_located *l = of->l;
	const int i = of->c->member[k];
	const double size[2] = {missed_max *
	                                fmax(rb_model_reach(l->model, i), rb_vec3_max_abs(at[0])),
	                        missed_max * speed};
	const rb_vec3 there = rb_external_field(of->l, i, t, at[0], at[1]);
	double change = 0;

	for (int m = 0; m < 6; m++) {
		rb_vec3 other[2] = {at[0], at[1]};
		double moved[3];

		rb_vec3_to(moved, at[m / 3]);
		moved[m % 3] += size[m / 3];
		other[m / 3] = rb_vec3_from(moved);
		change += rb_vec3_max_abs(
			rb_vec3_sub(rb_external_field(of->l, i, t, other[0], other[1]), there));
	}
	return off <= change;
}

/* Is the field all that varies of what acts on members that nothing holds? */
static bool is_alone(const struct rb_field_samples *of)
{
	const struct rb_located *const l = of->l;
	const rb_features others = (RB_FEATURES_VARIED & ~(rb_features)RB_FEATURE_FIELD) |
	                           RB_FEATURE_FORCES | RB_FEATURE_PUSHES;

	return of->c->held_count == 0 && !l->model->joints && !(l->model->features & others);
}

/* Acceleration by the field of which the piece's own is the sum with what is constant. */
static rb_vec3 from_piece(const struct rb_field_samples *of, int k, double s)
{
	const struct rb_located *const l = of->l;
	const struct rb_world_def *const world = &l->model->scene->world;
	double rate[3];

	rb_gauss_some_rates(&of->c->piece, k * rb_located_row(l) + RB_PIECE_VELOCITY, 3, s, rate);
	return rb_vec3_sub(rb_vec3_from(rate),
	                   rb_vec3_add_scaled(world->gravity,
	                                      l->model->inverse_mass[of->c->member[k]],
	                                      world->gravity_force));
}

/*
 * The same from what the field is at the nodes, with Lagrange's `weight`; raises `max` to the
 * largest of these.
 */
static rb_vec3 from_nodes(const struct rb_field_samples *of, int k, const double weight[NODES],
                          double *max)
{
	rb_vec3 sum = {0, 0, 0};

	for (int j = 0; j < NODES; j++) {
		const rb_vec3 there = rb_vec3_from(of->c->at_nodes +
		                                   3 * (j * of->c->member_count + k));

		sum = rb_vec3_add_scaled(sum, weight[j], there);
		*max = fmax(*max, rb_vec3_max_abs(there));
	}
	return sum;
}

bool rb_field_samples_depart(const struct rb_field_samples *of, double sample_s)
{
	struct rb_located *const l = of->l;
	struct rb_cluster *const c = of->c;
	const double h = c->piece.length_s, interval = rb_located_sampling(l);
	const double s = sample_s - of->origin_s;
	const bool alone = is_alone(of);
	double weight[NODES];
	bool departs = false;

	if (!(node_gap * h > interval) || !(s < h))
		return false;
	if (!alone) {
		find_at_nodes(of);
		rb_gauss_lagrange(s / h, weight);
	}
	for (int k = 0; k < c->member_count && l->status == RB_OK && !departs; k++) {
		const int i = c->member[k];
		double max = 0;
		rb_vec3 at[2];

		place(of, k, s, at);
		const rb_vec3 expected = alone ? from_piece(of, k, s)
		                               : from_nodes(of, k, weight, &max);
		const rb_vec3 a = rb_external_field(l, i, sample_s, at[0], at[1]);
		const double off = rb_vec3_max_abs(rb_vec3_sub(a, expected));

		max = fmax(max, rb_vec3_max_abs(expected));
		const double fall = sqrt((max + l->weight) * rb_model_reach(l->model, i));
		const double speed = fmax(rb_vec3_max_abs(at[1]), fmax(max * h, fall));

		departs = off * interval > missed_max * speed &&
		          !is_error(of, k, sample_s, at, speed, off);
	}
	return departs && l->status == RB_OK;
}

bool rb_field_samples_jump(const struct rb_field_samples *of, double soon_s)
{
	struct rb_located *const l = of->l;
	bool jumps = false;

	for (int k = 0; k < of->c->member_count && (l->model->features & RB_FEATURE_FIELD); k++) {
		const int i = of->c->member[k];
		rb_vec3 at[2];

		place(of, k, 0, at);
		const rb_vec3 now = rb_external_field(l, i, of->origin_s, at[0], at[1]);
		const rb_vec3 soon = rb_external_field(l, i, of->origin_s + soon_s, at[0], at[1]);

		jumps = jumps ||
		        rb_vec3_max_abs(rb_vec3_sub(soon, now)) > jump_min * rb_vec3_max_abs(now);
	}
	return jumps && l->status == RB_OK;
}

static void look_ahead(struct rb_located *l, double t, double sample_s)
{
	for (int k = 0; k < l->cluster_count && l->status == RB_OK; k++) {
		struct rb_cluster *const c = &l->cluster[k];

		if (!c->used || !c->integrated)
			continue;
		const struct rb_piece_of *const on = &l->piece[c->member[0]];
		const struct rb_field_samples of = {.l = l, .c = c, .origin_s = on->origin_s};

		if (!(sample_s < on->until_s) || !rb_field_samples_depart(&of, sample_s))
			continue;
		/* the next piece ends where a node sees it, and this one not as it would have */
		c->try_s = sample_s - t;
		c->hits = c->is_cut = false;
		rb_queue_set(l->queue, l->n + k, t);
	}
}

int rb_field_samples_next(struct rb_located *l, double until, double *seen_s, double *t)
{
	int which = rb_queue_first(l->queue, t);

	while (l->status == RB_OK && fmin(*t, until) > *seen_s) {
		const double sample_s = rb_field_samples_after(l, *seen_s);

		look_ahead(l, *seen_s, sample_s);
		*seen_s = sample_s;
		which = rb_queue_first(l->queue, t);
	}
	return l->status == RB_OK && *t <= until ? which : -1;
}
