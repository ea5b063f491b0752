/* SPDX-License-Identifier: MIT */
#include "located/failure.h"

#include "base/error.h"

#include <float.h>
#include <math.h>

#include "located/coupled.h"
#include "located/follow.h"
#include "located/joint_rows.h"
#include "located/pair_contacts.h"
#include "located/piece_scales.h"

/* Above this, sums of squares, from which sizes and lengths are computed, overflow a double. */
static const double rate_max = 1e150;

/*
 * No step is short enough: two bodies that attract each other and cannot touch may have collided
 * head on. Names them; false: no such pair.
 */
bool rb_failure_by_collision(const struct rb_modes *w)
{
	struct rb_located *l = w->l;
	const struct rb_attract *const all = &l->gravitation.all;
	double least = HUGE_VAL, factor;
	int pair[2] = {-1, -1};
	char first[64], second[64], source[96];

	for (int k = 0; rb_located_gravitates(l) && k < w->c->member_count; k++)
		for (int j = 0; j < all->count; j++) {
			const int i = w->c->member[k];

			if (j == i || !(all->mu[i] > 0 || all->mu[j] > 0))
				continue;
			const rb_vec3 d = rb_attract_between(all, i, j, &factor);
			if (rb_vec3_length(d) < least) {
				least = rb_vec3_length(d);
				pair[0] = i < j ? i : j;
				pair[1] = i < j ? j : i;
			}
		}
	if (pair[0] < 0 || rb_pair_can_touch(l, pair[0], pair[1]))
		return false;
	l->status = RB_FAIL(
		l->err, RB_ERR_PHYSICS,
		"%s'%s' and '%s' come within %.3g m of each other at t = %.9g s, and nothing keeps "
		"them apart: let them collide, or give 'gravitation' a 'softening'",
		rb_scene_body_source(l->model->scene, l->model->id_of[pair[0]], source),
		rb_scene_body_label(l->model->scene, l->model->id_of[pair[0]], first),
		rb_scene_body_label(l->model->scene, l->model->id_of[pair[1]], second), least,
		w->origin_s);
	return true;
}

/* Residual acceleration of a joint's row, m/s^2. */
static double residual_of(const struct rb_modes *w, const struct rb_joint_row *row)
{
	const struct rb_coupled_row coupled = rb_joint_rows_coupled(row);

	return fabs(rb_coupled_rate(&coupled, w->linear, w->angular) + row->bias);
}

/*
 * Joints that lock: motions that they allow to first order are not allowed to second order, as in a
 * straight chain that is held taut at both ends. Their rows are combinations of others, but
 * contradict them. Elimination takes a row for a combination (math/dense) if the square of its
 * independent share is within 16 n ulp, and an admissible motion contradicts that by up to about
 * its square root; larger contradictions persist from one piece to the next, each as short as
 * rounding makes it. Motors and contacts are released instead. Names the joint; false: the rows
 * agree.
 */
bool rb_failure_by_lock(const struct rb_modes *w)
{
	struct rb_located *l = w->l;
	const struct rb_joint_rows *rows = &w->joints;
	const double share = 8 * sqrt(16 * rows->count * DBL_EPSILON);
	double worst = 0;
	int joint_index = 0;
	char label[96], source[96];

	if (rows->count == 0 || !w->dense.open || w->c->held_count > 0 || rb_joint_rows_drive(rows))
		return false;
	for (int k = 0; k < rows->count; k++) {
		const double residual = residual_of(w, &rows->row[k]);

		if (residual > worst) {
			worst = residual;
			joint_index = rows->row[k].joint;
		}
	}
	if (!(worst > share * fmax(w->max, rb_piece_scales_load(w))))
		return false;
	const int def = l->model->joints->joint[joint_index].def;

	l->status = RB_FAIL(
		l->err, RB_ERR_PHYSICS,
		"%s%s cannot be kept together with the other joints at t = %.17g s: they lock, and "
		"leave it %.3g m/s^2 (is a chain held taut, or a linkage stretched flat?)",
		rb_joint_source(l->model->scene, def, source),
		rb_joint_label(l->model->scene, def, label), w->origin_s, worst);
	return true;
}

/* Names the joint with the largest multiplier; false: there are none. */
bool rb_failure_by_joints(const struct rb_modes *w, const char *why)
{
	struct rb_located *l = w->l;
	double largest = 0;
	char label[96], source[96], body[64];

	if (w->joints.count == 0)
		return false;
	int joint_index = w->joints.row[0].joint;
	for (int k = 0; k < w->joints.count; k++)
		if (fabs(w->multiplier[k]) > largest) {
			largest = fabs(w->multiplier[k]);
			joint_index = w->joints.row[k].joint;
		}
	const int def = l->model->joints->joint[joint_index].def;

	l->status = RB_FAIL(
		l->err, RB_ERR_PHYSICS,
		"%sthe motion of '%s' and what is joined to it cannot be followed beyond "
		"t = %.17g s: %s, and %s carries most",
		rb_joint_source(l->model->scene, def, source),
		rb_scene_body_label(l->model->scene, l->model->id_of[w->c->member[0]], body),
		w->origin_s, why, rb_joint_label(l->model->scene, def, label));
	return true;
}

bool rb_failure_by_size(const struct rb_modes *w)
{
	struct rb_located *l = w->l;
	char label[64], source[96];

	for (int k = 0; k < w->c->member_count; k++) {
		const double *const v = w->c->piece.start + k * w->row + RB_PIECE_VELOCITY;
		const double speed = fmax(fmax(fabs(v[0]), fabs(v[1])), fabs(v[2]));
		const double rate = rb_vec3_max_abs(w->linear[k]);

		if (speed < rate_max && rate < rate_max)
			continue;
		const int id = l->model->id_of[w->c->member[k]];
		l->status = RB_FAIL(l->err, RB_ERR_PHYSICS,
		                    "%s'%s' moves at %.3g m/s and gets %.3g m/s^2 at t = %.9g s: "
		                    "squares of more than %.0e are not finite",
		                    rb_scene_body_source(l->model->scene, id, source),
		                    rb_scene_body_label(l->model->scene, id, label), speed, rate,
		                    w->origin_s, rate_max);
		return true;
	}
	return false;
}
