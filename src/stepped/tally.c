/* SPDX-License-Identifier: MIT */
/*
 * Per-body record of an attempt for the ledger (see tally.h): velocities before and after the
 * solution, impulses of varying forces, and the momentum that position projection has added. It is
 * filled while the numbers exist and read by step_ledger.c if the step is kept; a rejected attempt
 * is overwritten. Nothing of the simulation reads it, so trajectories are the same with and without
 * a ledger.
 */
#include "stepped/tally.h"

#include "base/error.h"
#include "base/memory.h"

enum rb_status rb_tally_create(struct rb_stepped *s, const struct rb_model *model,
                               struct rb_error *err)
{
	struct rb_tally *made;

	if (!model->keeps_ledger)
		return RB_OK;
	made = s->tally = rb_memory_take(1, sizeof *made);
	if (made) {
		made->body = rb_memory_take((size_t)model->body_count, sizeof *made->body);
		made->element = rb_memory_take((size_t)rb_elements_between(model),
		                               sizeof *made->element);
		made->here = rb_memory_take((size_t)(model->body_count + model->static_count), 1);
	}
	return made && made->body && made->element && made->here
	               ? RB_OK
	               : RB_FAIL(err, RB_ERR_MEMORY, "no memory for the ledger of %d bodies",
	                         model->body_count);
}

void rb_tally_release(struct rb_stepped *s)
{
	if (!s->tally)
		return;
	rb_memory_free(s->tally->body);
	rb_memory_free(s->tally->element);
	rb_memory_free(s->tally->here);
	rb_memory_free(s->tally);
}

void rb_tally_begin(struct rb_world *world, const struct rb_cohort *cohort)
{
	for (int k = 0; k < cohort->member_count; k++) {
		struct rb_tally_body *body = &world->stepped->tally->body[cohort->body[k]];

		body->drag = (rb_vec3){0, 0, 0};
		body->varied = body->stored = (struct rb_wrench){0};
		body->potential_change = 0;
	}
}

bool rb_tally_works(const struct rb_model *model)
{
	return model->features & (RB_FEATURE_FORCES | RB_FEATURE_PUSHES | RB_FEATURES_VARIED);
}

/* rad/s; zero in scenes without rotation. */
static rb_vec3 spin_of(const struct rb_state *state, int i)
{
	return state->spin ? rb_world_row3(state->spin, i) : (rb_vec3){0, 0, 0};
}

/* Records velocities of one body at the beginning (after impacts) and as solved, and their mean. */
static void note_solved(const struct rb_world *world, int i, bool sleeps,
                        struct rb_tally_body *body)
{
	const struct rb_stepped *s = world->stepped;

	body->begin[0] = rb_world_row3(world->mark.velocity, i);
	body->begin[1] = spin_of(&world->mark, i);
	body->acted = rb_world_row3(world->mark.position, i);
	if (rb_kicks_have(&s->kicks, i)) {
		const struct rb_kick *const kick = rb_kick_of(&s->kicks, i);

		body->acted = rb_vec3_add(body->acted, kick->shift);
		body->begin[0] = rb_vec3_add(body->begin[0], kick->linear);
		body->begin[1] = rb_vec3_add(body->begin[1], kick->angular);
	}
	/*
	 * the solver's velocity, since move has already rotated the state's spin; sleeping bodies
	 * have no valid entry in the solver
	 */
	body->end[0] = body->end[1] = (rb_vec3){0, 0, 0};
	if (!sleeps) {
		body->end[0] = s->solver.dense.bodies.body[i].linear;
		body->end[1] = s->solver.dense.bodies.body[i].angular;
	}
	for (int m = 0; m < 2; m++)
		body->mean[m] = rb_vec3_scale(0.5, rb_vec3_add(body->begin[m], body->end[m]));
	body->halves = body->kind == RB_TALLY_JOINED && s->solver.island_of[i] >= 0 &&
	               s->solver.island[s->solver.island_of[i]].halves;
	if (body->halves) {
		const struct rb_solver_body *moved = &s->solver.after_forces[i];

		body->mean[0] = rb_vec3_scale(0.5, rb_vec3_add(body->mean[0], moved->linear));
		body->mean[1] = rb_vec3_scale(0.5, rb_vec3_add(body->mean[1], moved->angular));
	}
	body->place = rb_world_row3(world->state.position, i);
	body->swings = body->kind == RB_TALLY_JOINED && s->solver.island_of[i] >= 0 &&
	               s->solver.island[s->solver.island_of[i]].reduced;
	if (body->swings) {
		const struct rb_reduced_motion *const swung = &s->solver.reduced_motion[i];

		body->mean[0] = rb_vec3_scale(1 / s->solver.h_s,
		                              rb_vec3_sub(body->place, body->acted));
		body->mean[1] = swung->turning;
		body->place = swung->place;
		body->drag = swung->dragged.force;
		body->drag_turn = swung->dragged.torque;
		body->drag_lost = swung->lost;
	}
}

void rb_tally_solved(struct rb_world *world, const struct rb_cohort *cohort)
{
	struct rb_stepped *s = world->stepped;
	const struct rb_solver *solver = &s->solver;
	const bool all = cohort == &s->all, works = rb_tally_works(world->model);
	const int *member = all ? s->body : cohort->body;
	const int count = all ? s->member_count : cohort->member_count;

	RB_ASSERT(count >= 0);
	for (int k = 0; k < count; k++) {
		const int i = member[k];
		struct rb_tally_body *body = &s->tally->body[i];
		/* marks are those of the whole step: a group that takes substeps is awake */
		const bool sleeps = all && s->sleep.sleeps[i];

		body->is_closed = false;
		body->kind = sleeps                         ? RB_TALLY_RESTS
		             : rb_solver_is_free(solver, i) ? RB_TALLY_FREE
		             : solver->rests[i]             ? RB_TALLY_RESTS
		                                            : RB_TALLY_JOINED;
		if (body->kind != RB_TALLY_FREE || works)
			note_solved(world, i, sleeps, body);
	}
}

rb_vec3 rb_tally_spin(const struct rb_world *world, const struct rb_state *state, int i,
                      rb_vec3 spin)
{
	const struct rb_model *model = world->model;

	if (!state->spin)
		return (rb_vec3){0, 0, 0};
	if (!isnan(model->inverse_inertia_scalar[i]))
		return rb_vec3_scale(rb_model_inertia(model, i)->m[0][0], spin);
	const rb_quat q = rb_quat_from(state->orientation + 4 * (size_t)i);
	return rb_quat_rotate(
		q, rb_mat3_apply(rb_model_inertia(model, i), rb_quat_rotate_back(q, spin)));
}

/*
 * Adds sign times the linear momentum and the angular momentum about the origin of a body with this
 * velocity and spin at its present place.
 */
static void add_momentum(const struct rb_world *world, int i, const rb_vec3 motion[2], double sign,
                         rb_vec3 sum[2])
{
	const rb_vec3 p = rb_vec3_scale(world->model->mass[i], motion[0]);
	const rb_vec3 l = rb_vec3_add(rb_vec3_cross(rb_world_row3(world->state.position, i), p),
	                              rb_tally_spin(world, &world->state, i, motion[1]));

	sum[0] = rb_vec3_add_scaled(sum[0], sign, p);
	sum[1] = rb_vec3_add_scaled(sum[1], sign, l);
}

void rb_tally_projection_begin(struct rb_world *world, int i, const rb_vec3 motion[2])
{
	struct rb_tally_body *body = &world->stepped->tally->body[i];

	RB_ASSERT_COSTLY(i >= 0 && i < world->model->body_count);
	if (body->is_closed)
		return;
	body->is_closed = true;
	body->turned = 0;
	body->closed[0] = body->closed[1] = (rb_vec3){0, 0, 0};
	add_momentum(world, i, motion, -1, body->closed);
}

void rb_tally_projection_end(struct rb_world *world, int i, enum rb_ledger_momentum by,
                             double lifted)
{
	struct rb_tally_body *body = &world->stepped->tally->body[i];
	const rb_vec3 motion[2] = {rb_world_row3(world->state.velocity, i),
	                           spin_of(&world->state, i)};

	RB_ASSERT_COSTLY(i >= 0 && i < world->model->body_count);
	add_momentum(world, i, motion, 1, body->closed);
	body->closed_by = by;
	body->lifted = lifted;
}
