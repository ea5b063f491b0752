/* SPDX-License-Identifier: MIT */
/*
 * Verdict on an attempt, in order of cost: values that are not finite, residuals of the solver,
 * bodies that impacts have moved too far, then overlaps, which are measured only if nothing else
 * has failed or the remaining bodies can keep the step. Both bodies of an impact share its verdict
 * (blame_both), since rolling back one of them would lose momentum.
 *
 * Overlap is the last criterion and the only one that is corrected: the projection moves positions
 * first.
 */
#include "stepped/judge.h"

#include <string.h>

#include "base/error.h"
#include "step/verdict.h"
#include "stepped/impact_pass.h"
#include "stepped/joint_steps.h"
#include "stepped/projection.h"
#include "stepped/nets.h"
#include "stepped/spring_steps.h"
#include "stepped/sleep.h"

/*
 * A step ends at this share of the time before an impact; the shortest part of a whole step that is
 * cut for one.
 */
static const double before_share = 1 - 2e-4, shortest_share = 0x1p-20;

/* ---- quick check of all bodies ---- */

struct quick_check {
	const struct rb_world *world;
	const struct rb_cohort *cohort;
	bool any_not_finite, any_thrown; /* written by all workers */
};

/*
 * Whether a body is farther from its start than without impacts by more than half its size: it may
 * have tunnelled through bodies that are not among its candidates.
 */
static inline bool is_thrown(const struct rb_world *world, const struct rb_cohort *cohort, int i)
{
	const rb_vec3 d = rb_vec3_sub(rb_world_origin_at(world, &world->state, i),
	                              rb_world_origin_at(world, &world->mark, i));
	const double max = cohort->candidates->reach[i] + 0.5 * rb_model_reach(world->model, i);

	return !(rb_vec3_dot(d, d) <= max * max);
}

/* In most steps none is bad, and a loop over single bodies is not needed. */
static void quick_check_bodies(void *user, size_t first, size_t end)
{
	struct quick_check *quick_check = user;
	const struct rb_cohort *cohort = quick_check->cohort;
	const bool throws = quick_check->world->broadphase &&
	                    quick_check->world->model->rollback != RB_ROLLBACK_NONE;

	for (size_t k = first; k < end; k++) {
		const int i = cohort->body[k];

		quick_check->world->stepped->bad[i] = 0;
		if (!rb_verdict_finite(&quick_check->world->state, i))
			__atomic_store_n(&quick_check->any_not_finite, true, __ATOMIC_RELAXED);
		if (throws && (int)k < cohort->member_count &&
		    is_thrown(quick_check->world, cohort, i))
			__atomic_store_n(&quick_check->any_thrown, true, __ATOMIC_RELAXED);
	}
}

/* ---- reasons ---- */

/* Blames bodies whose state is not finite; the first is kept for the message. */
static void blame_not_finite(struct rb_world *world, const struct rb_cohort *cohort,
                             struct rb_attempt_outcome *outcome)
{
	for (int k = 0; k < cohort->body_count; k++) {
		const int i = cohort->body[k];

		if (rb_verdict_finite(&world->state, i))
			continue;
		if (outcome->body < 0)
			outcome->body = i;
		outcome->broken = true;
		rb_stepped_blame(world->stepped, i);
	}
}

/*
 * Blames islands whose residual closes a gap by more than the tolerance in h. With rollback `none`
 * a finite residual is only recorded.
 */
static void blame_residuals(struct rb_world *world, double h, struct rb_attempt_outcome *outcome)
{
	struct rb_stepped *s = world->stepped;
	const struct rb_solver *solver = &s->solver;

	for (size_t g = 0; g < solver->island_count; g++) {
		const struct rb_island *island = &solver->island[g];
		const double left = h * island->residual;

		/* written so that NaN fails */
		if (left <= world->model->stepped_tolerance_m ||
		    (world->model->rollback == RB_ROLLBACK_NONE && isfinite(left))) {
			outcome->residual = fmax(outcome->residual, left);
			outcome->slip = fmax(outcome->slip, h * island->slip);
			continue;
		}
		outcome->broken = true;
		for (int k = 0; k < island->member_count; k++)
			rb_stepped_blame(s, solver->member[island->first_member + k]);
	}
}

/*
 * Blames mechanisms with an impact within the step, which is to end just before it unless that
 * would be too short.
 */
static void blame_impacts(struct rb_world *world, double h, struct rb_attempt_outcome *outcome)
{
	struct rb_stepped *s = world->stepped;
	const struct rb_solver *solver = &s->solver;
	const bool others = s->bad_count > 0;

	if (!world->model->joints || world->model->rollback != RB_ROLLBACK_SELECTIVE)
		return;
	for (size_t g = 0; g < solver->island_count; g++) {
		const struct rb_island *island = &solver->island[g];

		if (!(island->impact_s < h) || !(h > shortest_share * s->solver.whole_s))
			continue;
		outcome->clear_s = fmin(outcome->clear_s, before_share * island->impact_s);
		for (int k = 0; k < island->member_count; k++)
			rb_stepped_blame(s, solver->member[island->first_member + k]);
	}
	if (others)
		outcome->clear_s = (double)INFINITY;
}

static void blame_thrown(struct rb_world *world, const struct rb_cohort *cohort)
{
	for (int k = 0; k < cohort->member_count; k++)
		if (is_thrown(world, cohort, cohort->body[k]))
			rb_stepped_blame(world->stepped, cohort->body[k]);
}

/* Restores bad bodies: the broadphase needs finite positions of these too. */
static void restore_bad(struct rb_world *world, const struct rb_cohort *cohort)
{
	for (int k = 0; k < cohort->body_count; k++)
		if (world->stepped->bad[cohort->body[k]])
			rb_state_copy_rows(&world->state, &world->mark, &cohort->body[k], 1);
}

/* Blames both bodies of an impact if one is bad. */
static void blame_both(struct rb_stepped *s, const struct rb_world *world,
                       const struct rb_cohort *cohort)
{
	bool more = s->bad_count > 0;

	while (more) {
		more = false;
		for (size_t k = 0; k < cohort->impact_count; k++) {
			const int a = cohort->impact[k].a, b = cohort->impact[k].b;

			if (cohort->impact[k].crowded || !rb_stepped_is_dynamic(world, b) ||
			    s->bad[a] == s->bad[b])
				continue;
			rb_stepped_blame(s, a);
			rb_stepped_blame(s, b);
			more = true;
		}
	}
}

enum rb_status rb_judge(struct rb_world *world, struct rb_cohort *cohort, double h,
                        struct rb_attempt_outcome *outcome, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	struct quick_check quick_check = {.world = world, .cohort = cohort};
	struct rb_depths found;
	enum rb_status status = RB_OK;

	RB_ASSERT(h > 0);
	*outcome = (struct rb_attempt_outcome){
		.pair = {-1, -1}, .body = -1, .joint = -1, .clear_s = (double)INFINITY};
	rb_team_share(world->team, (size_t)cohort->body_count, RB_BODIES_PER_BLOCK,
	              quick_check_bodies, &quick_check);
	s->bad_count = 0;
	if (quick_check.any_not_finite)
		blame_not_finite(world, cohort, outcome);
	blame_residuals(world, h, outcome);
	rb_joints_blame(world, cohort, outcome);
	if (world->model->rollback != RB_ROLLBACK_NONE && h > shortest_share * s->solver.whole_s) {
		rb_springs_blame(world);
		rb_nets_blame(world);
	}
	if (world->model->rollback != RB_ROLLBACK_NONE && world->model->joints)
		status = rb_joints_blame_held(world, h, err);
	if (status != RB_OK)
		return status;
	blame_impacts(world, h, outcome);
	if (!world->broadphase)
		return RB_OK;
	if (quick_check.any_thrown)
		blame_thrown(world, cohort);
	blame_both(s, world, cohort);
	if (s->bad_count > 0 && !cohort->divides)
		return RB_OK;
	if (s->bad_count > 0)
		restore_bad(world, cohort);
	/* depths measured by rb_relinearize imply that the candidates held for these poses */
	if (cohort->candidates == &s->candidates && !(cohort->has_depths && s->bad_count == 0) &&
	    !rb_candidates_holds(&s->candidates, world, cohort->body, cohort->body_count)) {
		s->candidates.valid = false;
		status = rb_candidates_find(&s->candidates, world, cohort->body, cohort->body_count,
		                            err);
	}
	if (status == RB_OK && cohort == &s->all)
		status = rb_sleep_list(world, err);
	if (status == RB_OK)
		status = rb_projection_close(world, cohort, &found, err);
	if (status != RB_OK)
		return status;
	rb_joints_blame(world, cohort, outcome); /* projection may have moved jointed bodies */
	blame_both(s, world, cohort);
	outcome->overlap = found.max;
	for (size_t k = 0; k < found.deep_count; k++)
		if (found.deep[k].depth > outcome->overlap) {
			outcome->overlap = found.deep[k].depth;
			outcome->pair[0] = found.deep[k].a;
			outcome->pair[1] = found.deep[k].b;
		}
	return RB_OK;
}

enum rb_status rb_judge_give_up(const struct rb_world *world, double start,
                                const struct rb_attempt_outcome *outcome, struct rb_error *err)
{
	const struct rb_scene *scene = world->model->scene;
	const int *id_of = world->model->id_of;
	char a[64], b[64], label[96], source[96];

	if (outcome->body >= 0)
		return rb_verdict_fail_finite(world->model, outcome->body, start, err);
	if (outcome->pair[0] < 0 && outcome->joint >= 0)
		return RB_FAIL(
			err, RB_ERR_PHYSICS,
			"%sno step holds %s together after t = %.9g s (it drifts by %.3g m, "
			"the tolerance is %.3g m)",
			rb_joint_source(scene, world->model->joints->joint[outcome->joint].def,
		                        source),
			rb_joint_label(scene, world->model->joints->joint[outcome->joint].def,
		                       label),
			start, outcome->drift, world->model->stepped_tolerance_m);
	if (outcome->pair[0] < 0)
		return RB_FAIL(err, RB_ERR_PHYSICS, "no step resolves the impacts after t = %.9g s",
		               start);
	return RB_FAIL(err, RB_ERR_PHYSICS,
	               "%sno step resolves the overlap of '%s' and '%s' after t = %.9g s (%.3g m "
	               "deep, the tolerance is %.3g m)",
	               rb_scene_body_source(scene, id_of[outcome->pair[0]], source),
	               rb_scene_body_label(scene, id_of[outcome->pair[0]], a),
	               rb_scene_body_label(scene, id_of[outcome->pair[1]], b), start,
	               outcome->overlap, world->model->stepped_tolerance_m);
}
