/* SPDX-License-Identifier: MIT */
/*
 * Step size control by rejection. After a failure at time f the next attempts bisect the rest up to
 * f, which converges to the moment of contact; two attempts accepted in a row have moved the
 * contact, and f itself is tried. An impact ends the search. The number of attempts is bounded by a
 * smallest substep and by a least progress.
 */
#include "classic/rollback.h"

#include <float.h>

#include "base/error.h"
#include "classic/contact.h"
#include "classic/classic_ledger.h"
#include "step/gap.h"
#include "classic/groups.h"
#include "classic/impact.h"
#include "step/verdict.h"

/* Smallest substep as a share of the step: below it neither times nor positions change. */
static const double smallest_share = 0x1p-60;
/*
 * Multiplications of an attempt without its solutions, about; and attempts between two tests of
 * progress: a group that gets no further than a millionth of its step in 4096 attempts has failed.
 */
enum { ATTEMPT_WORK = 1024, TRIES_PER_INSPECTION = 4096 };
static const double least_progress = 1e-6;

/* How the next attempt is chosen. */
struct search {
	double fail_s; /* done_s + h_s of the attempt rejected last, INFINITY: none pending */
	int accepted;  /* in a row since then */
};

/* Length of the next attempt after one of length h was accepted, s. */
static double next_attempt(const struct rb_pass *pass, struct search *search, double h)
{
	const double rest = pass->dt_s - pass->done_s;

	if (!isfinite(search->fail_s))
		return fmin(2 * h, rest);
	const double to_fail = search->fail_s - pass->done_s;
	if (!(to_fail > 0) || search->accepted >= 2) {
		/*
		 * two accepted: the smaller steps have moved the contact; try the failed end, then
		 * beyond
		 */
		search->accepted = 0;
		if (!(to_fail > 0)) {
			search->fail_s = HUGE_VAL;
			return fmin(2 * h, rest);
		}
		return fmin(to_fail, rest);
	}
	return fmin(0.5 * to_fail, rest);
}

/* The failure with the bodies, the moment and the depth. */
static enum rb_status give_up(const struct rb_pass *pass, enum rb_verdict verdict, int body,
                              struct rb_error *err)
{
	RB_ASSERT(verdict == RB_VERDICT_NOT_FINITE ? body >= 0 : pass->worst >= 0);

	const struct rb_model *model = pass->world->model;
	const double when = pass->start_s + pass->done_s;
	char a[64], b[64], source[96];

	if (verdict == RB_VERDICT_NOT_FINITE)
		return rb_verdict_fail_finite(model, body, when, err);
	const struct rb_touch *touch = &pass->touch[pass->worst];
	return RB_FAIL(err, RB_ERR_PHYSICS,
	               "%sno step resolves the overlap of '%s' and '%s' at t = %.9g s: %.3g m deep "
	               "after %.3g s, tolerance %.3g m",
	               rb_scene_body_source(model->scene, model->id_of[touch->a], source),
	               rb_scene_body_label(model->scene, model->id_of[touch->a], a),
	               rb_scene_body_label(model->scene, model->id_of[touch->b], b), when,
	               -pass->worst_gap, pass->h_s, model->tolerance_m);
}

/* Records how far each member has been from its start, for rb_groups_merge. */
static void note_travel(struct rb_pass *pass)
{
	const struct rb_world *world = pass->world;
	double *const travelled = world->groups->travelled;

	for (int k = 0; k < pass->member_count; k++) {
		const int i = pass->member[k];
		const rb_vec3 moved = rb_vec3_sub(rb_world_origin_at(world, &world->state, i),
		                                  rb_world_origin_at(world, &world->start, i));

		travelled[i] = fmax(travelled[i], rb_vec3_length(moved));
	}
}

/* Keeps a good attempt: time, gaps, counts, ledger. */
static void accept(struct rb_pass *pass, bool last)
{
	struct rb_gap *const gaps = pass->now;

	rb_classic_ledger_substep(pass, &pass->world->mark);
	pass->done_s = last ? pass->dt_s : pass->done_s + pass->h_s;
	pass->now = pass->next;
	pass->next = gaps;
	pass->counts.substeps++;
	pass->counts.body_steps += (uint64_t)pass->member_count;
	for (int k = 0; k < pass->touch_count; k++)
		pass->counts.max_penetration_m = fmax(pass->counts.max_penetration_m,
		                                      -pass->now[k].gap);
	note_travel(pass);
}

/*
 * Gaps at the start, contacts of the step before, and impacts that callbacks or the start have
 * made.
 */
static enum rb_status begin(struct rb_pass *pass, struct rb_error *err)
{
	const struct rb_world *world = pass->world;

	if (pass->touch_count == 0)
		return RB_OK;
	pass->now = rb_pass_take(pass, pass->kept, pass->touch_count, sizeof *pass->now);
	pass->next = rb_pass_take(pass, pass->kept, pass->touch_count, sizeof *pass->next);
	if (pass->out_of_memory)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %d contacts", pass->touch_count);
	for (int k = 0; k < pass->touch_count; k++) {
		struct rb_touch *touch = &pass->touch[k];

		pass->now[k] = rb_gap_of(world, &world->state, touch->a, touch->b);
		touch->band = rb_gap_band(world, &world->state, touch->a, touch->b);
	}
	rb_contact_begin(pass);
	rb_impact_resolve(pass, false);
	return RB_OK;
}

enum rb_status rb_rollback_run(struct rb_pass *pass, const struct rb_stage_list *plan,
                               struct rb_error *err)
{
	struct rb_world *world = pass->world;
	struct search search = {.fail_s = HUGE_VAL};
	double h = pass->dt_s, inspected_s = -HUGE_VAL;
	bool stuck = false;

	pass->counts = rb_counts_none;
	const enum rb_status status = begin(pass, err);
	if (status != RB_OK)
		return status;
	for (int attempt = 1; pass->done_s < pass->dt_s; attempt++) {
		const double rest = pass->dt_s - pass->done_s;
		const bool last = h >= rest;
		int body = -1;

		pass->h_s = last ? rest : h;
		pass->counts.smallest_step_s = fmin(pass->counts.smallest_step_s, pass->h_s);
		rb_state_copy_rows(&world->mark, &world->state, pass->member, pass->member_count);
		rb_stage_list_run(plan, pass);
		if (pass->out_of_memory)
			return RB_FAIL(err, RB_ERR_MEMORY, "no memory for a group of %d bodies",
			               pass->member_count);

		if (rb_interrupt_after(&world->interrupt, ATTEMPT_WORK))
			return RB_FAIL(err, RB_ERR_INTERRUPT, "interrupted");

		const enum rb_verdict verdict = rb_verdict_of(pass, &body);
		if (attempt % TRIES_PER_INSPECTION == 0) {
			stuck = pass->done_s - inspected_s < least_progress * pass->dt_s;
			inspected_s = pass->done_s;
		}
		if (verdict != RB_VERDICT_GOOD) {
			rb_state_copy_rows(&world->state, &world->mark, pass->member,
			                   pass->member_count);
			pass->counts.rollbacks++;
			pass->counts.discarded_body_steps += (uint64_t)pass->member_count;
			if (pass->h_s <= pass->dt_s * smallest_share || stuck)
				return give_up(pass, verdict, body, err);
			search.fail_s = pass->done_s + pass->h_s;
			search.accepted = 0;
			h = 0.5 * pass->h_s;
		} else {
			accept(pass, last);
			search.accepted++;
			if (pass->touch_count > 0 && rb_impact_resolve(pass, true)) {
				search.fail_s = HUGE_VAL;
				h = pass->dt_s - pass->done_s;
			} else {
				h = next_attempt(pass, &search, pass->h_s);
			}
			if (pass->out_of_memory)
				return RB_FAIL(err, RB_ERR_MEMORY,
				               "no memory for the impacts of a step");
		}
	}
	RB_ASSERT(!(pass->done_s > pass->dt_s));
	rb_contact_resolve(pass);
	return rb_interrupt_is_set(&world->interrupt)
	               ? RB_FAIL(err, RB_ERR_INTERRUPT, "interrupted")
	               : RB_OK;
}
