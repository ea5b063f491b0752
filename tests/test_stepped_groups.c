/* SPDX-License-Identifier: MIT */
/* src/stepped/local_rollback: what fails goes back for the bodies concerned, and nobody else feels it. */
#include "worlds.h"

#include "base/memory.h"
#include "stepped/stepped_state.h"

static const double g = 9.81, far_away = 1000;

enum { HEAP = 12, VIOLENT = 5, BODIES = HEAP + VIOLENT, ROW = 6 };

struct plan {
	bool heap, violent, violent_first;
	enum rb_rollback_kind rollback;
	int threads;
};

struct result {
	double row[BODIES][ROW]; /* heap, then the violent ones: position, velocity */
	struct rb_world_work work;
	struct rb_frame_numbers numbers;
	struct rb_event *event; /* owned */
	int event_count;
};

static int ball(struct lab *lab, rb_vec3 at, rb_vec3 v)
{
	return lab_sphere(lab, 0.5, 1, at, v);
}

/* Comes to rest: nothing in it fails. */
static void lay_heap(struct lab *lab, int *id)
{
	for (int k = 0; k < HEAP; k++)
		id[k] = ball(lab,
		             (rb_vec3){1.02 * (k % 2) + 0.1 * (k / 4), 1.01 * (k / 2 % 2),
		                       0.55 + 1.02 * (k / 4)},
		             (rb_vec3){0, 0, -1});
}

/* A heavy ball that flies ten sizes in a step throws others, in that step, farther than it could get itself. */
static void lay_violent(struct lab *lab, int *id)
{
	id[0] = lab_sphere(lab, 0.5, 100, (rb_vec3){far_away - 20, 0, 0.5}, (rb_vec3){300, 0, 0});
	for (int k = 1; k < VIOLENT; k++)
		id[k] = ball(lab, (rb_vec3){far_away + 6 * k - 4.7, 0, 0.5}, (rb_vec3){0, 0, 0});
}

static void lay(struct lab *lab, const struct plan *plan, int *id)
{
	if (plan->violent && plan->violent_first)
		lay_violent(lab, id + HEAP);
	if (plan->heap)
		lay_heap(lab, id);
	if (plan->violent && !plan->violent_first)
		lay_violent(lab, id + HEAP);
}

/* Steps of a sixtieth of a second on a plane. */
static void open_sixtieths(struct lab *lab)
{
	lab_open(lab, 0.5, 60);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.time_step_s = 1.0 / 60;
	lab->scene.world.tolerance_m = 1e-6;
	lab->scene.world.gravity = (rb_vec3){0, 0, -g};
	lab_surface(lab, 0.5, 0.5);
	lab_plane(lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
}

static void run(const struct plan *plan, struct result *result)
{
	struct lab_log log;
	const struct rb_world_hooks hooks = lab_log_open(&log);
	const struct rb_world_options options = {.threads = plan->threads};
	struct lab lab;
	int id[BODIES];

	open_sixtieths(&lab);
	lab.scene.world.rollback = plan->rollback;
	lay(&lab, plan, id);
	lab_seal_with(&lab, &options, &hooks);
	lab_run(&lab);
	*result = (struct result){.work = rb_world_work(lab.world),
	                          .numbers = rb_world_totals(lab.world),
	                          .event = log.row,
	                          .event_count = log.count};
	for (int k = plan->heap ? 0 : HEAP; k < (plan->violent ? BODIES : HEAP); k++) {
		rb_vec3_to(result->row[k], rb_world_position(lab.world, id[k]));
		rb_vec3_to(result->row[k] + 3, rb_world_velocity(lab.world, id[k]));
	}
	assert_true(result->numbers.max_penetration <= lab.model->tolerance_m);
	lab_close(&lab);
}

static void release(struct result *result)
{
	free(result->event);
}

static void assert_same(const struct result *found, const struct result *wanted, int first, int end)
{
	for (int k = first; k < end; k++)
		for (int c = 0; c < ROW; c++)
			if (found->row[k][c] != wanted->row[k][c])
				fail_msg("body %d, column %d: %.17g, not %.17g", k, c,
				         found->row[k][c], wanted->row[k][c]);
}

static void only_the_group_that_fails_goes_back(void **state)
{
	struct result both, alone, all;

	(void)state;
	run(&(struct plan){.heap = true, .violent = true}, &both);
	run(&(struct plan){.violent = true}, &alone);
	run(&(struct plan){.heap = true, .violent = true, .rollback = RB_ROLLBACK_GLOBAL}, &all);
	assert_true(alone.work.discarded_body_steps > 0);
	assert_int_equal(both.work.discarded_body_steps, alone.work.discarded_body_steps);
	assert_int_equal(both.numbers.rollbacks, alone.numbers.rollbacks);
	/* the heap takes whole steps, 30 of them */
	assert_int_equal(both.work.body_steps, alone.work.body_steps + 30 * HEAP);
	assert_int_equal(all.work.discarded_body_steps, BODIES * all.numbers.rollbacks);
	assert_true(all.work.body_steps > both.work.body_steps);
	release(&both);
	release(&alone);
	release(&all);
}

static void what_is_apart_has_the_same_bits_without_the_rest(void **state)
{
	struct result both, heap, violent;

	(void)state;
	run(&(struct plan){.heap = true, .violent = true}, &both);
	run(&(struct plan){.heap = true}, &heap);
	run(&(struct plan){.violent = true}, &violent);
	assert_int_equal(heap.work.discarded_body_steps, 0);
	assert_same(&both, &heap, 0, HEAP);
	assert_same(&both, &violent, HEAP, BODIES);
	assert_int_equal(both.event_count, heap.event_count + violent.event_count);
	release(&both);
	release(&heap);
	release(&violent);
}

/* Whoever is thrown within the step reaches groups that were apart from it at first: they join, and go back too. */
static void nobody_passes_another_within_a_step(void **state)
{
	struct result both;

	(void)state;
	run(&(struct plan){.heap = true, .violent = true}, &both);
	for (int k = HEAP + 1; k < BODIES; k++)
		assert_true(both.row[k][0] > both.row[k - 1][0]);
	assert_true(both.row[BODIES - 1][0] > far_away + 6 * VIOLENT);
	release(&both);
}

/* A ball far away, on a spring with one that is thrown. */
static void what_a_spring_joins_goes_back_together(void **state)
{
	struct rb_spring_def spring = rb_spring_def_default();
	const struct rb_world_options options = {0};
	uint64_t discarded[2];

	(void)state;
	for (int joined = 0; joined < 2; joined++) {
		struct lab lab;

		lab_open(&lab, 0.5, 60);
		lab.scene.world.method = RB_METHOD_STEPPED;
		lab.scene.world.time_step_s = 1.0 / 60;
		spring.a = ball(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){100, 0, 0});
		(void)ball(&lab, (rb_vec3){3, 0, 0}, (rb_vec3){0, 0, 0});
		spring.b = ball(&lab, (rb_vec3){0, far_away, 0}, (rb_vec3){0, 0, 0});
		spring.stiffness = joined ? 1e-3 : 0;
		if (joined)
			assert_int_equal(rb_scene_add_spring(&lab.scene, &spring, &lab.error),
			                 RB_OK);
		lab_seal_with(&lab, &options, NULL);
		lab_run(&lab);
		discarded[joined] = rb_world_work(lab.world).discarded_body_steps;
		lab_close(&lab);
	}
	assert_true(discarded[0] > 0);
	assert_int_equal(2 * discarded[1], 3 * discarded[0]);
}

/* Blows one ball of three off, as no number can say. */
static enum rb_status blow(void *user, int id, double t, const rb_vec3 at[2], rb_vec3 force[2],
                           struct rb_error *err)
{
	(void)user, (void)id, (void)err;
	*force = (rb_vec3){t > 0.1 && at[0].x > 100 ? 1e308 : 0, 0, 0};
	return RB_OK;
}

static void what_is_not_finite_is_named_and_the_rest_is_as_before(void **state)
{
	const struct rb_field_def field = {.function = 0};
	const struct rb_world_hooks hooks = {.field = blow};
	const struct rb_world_options options = {0};
	enum rb_status status = RB_OK;
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 60);
	lab.scene.world.method = RB_METHOD_STEPPED;
	assert_int_equal(rb_scene_add_field(&lab.scene, &field, &lab.error), RB_OK);
	(void)ball(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){6, 0, 0});
	(void)ball(&lab, (rb_vec3){3, 0, 0}, (rb_vec3){0, 0, 0});
	(void)lab_sphere(&lab, 0.5, 1e-9, (rb_vec3){200, 0, 0}, (rb_vec3){0, 0, 0});
	lab_seal_with(&lab, &options, &hooks);
	while (status == RB_OK && rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world))
		status = rb_world_step_frame(lab.world, &lab.error);
	assert_int_equal(status, RB_ERR_PHYSICS);
	assert_non_null(strstr(lab.error.text, "'#2' is not finite"));
	assert_near(rb_world_position(lab.world, 0).x, 6 * rb_world_time(lab.world), 1e-12);
	assert_near(rb_world_position(lab.world, 2).x, 200, 0);
	lab_close(&lab);
}

/* From the first step on which anything fails: whatever cannot be had, the world is at its last good step. */
static void any_allocation_may_fail_in_a_step_that_goes_back(void **state)
{
	const struct rb_world_options options = {0};
	enum rb_status status = RB_ERR_MEMORY;

	(void)state;
	for (uint64_t k = 1; status == RB_ERR_MEMORY; k++) {
		struct lab lab;
		int id[BODIES];

		lab_open(&lab, 0.2, 60);
		lab.scene.world.method = RB_METHOD_STEPPED;
		lab.scene.world.time_step_s = 1.0 / 60;
		lay_violent(&lab, id);
		lab_seal_with(&lab, &options, NULL);
		for (int frame = 0; frame < 4; frame++)
			lab_step(&lab);
		const double x = rb_world_position(lab.world, 0).x;
		rb_memory_fail_at(k);
		status = rb_world_step_frame(lab.world, &lab.error);
		rb_memory_fail_at(0);
		assert_true(status == RB_OK || status == RB_ERR_MEMORY);
		if (status == RB_OK) {
			assert_true(k > 10);
			assert_true(rb_world_work(lab.world).discarded_body_steps > 0);
		} else {
			assert_near(rb_world_position(lab.world, 0).x, x, 0);
		}
		lab_close(&lab);
	}
}

static void order_of_groups_and_threads_are_not_in_the_bits(void **state)
{
	struct result both, swapped, threads;

	(void)state;
	run(&(struct plan){.heap = true, .violent = true, .threads = 1}, &both);
	run(&(struct plan){.heap = true, .violent = true, .violent_first = true, .threads = 1},
	    &swapped);
	run(&(struct plan){.heap = true, .violent = true, .threads = 3}, &threads);
	assert_same(&swapped, &both, 0, BODIES);
	assert_same(&threads, &both, 0, BODIES);
	assert_int_equal(threads.work.discarded_body_steps, both.work.discarded_body_steps);
	release(&both);
	release(&swapped);
	release(&threads);
}

static void impacts_are_told_in_order_of_time_then_ids(void **state)
{
	struct result both;
	int within = 0;

	(void)state;
	run(&(struct plan){.heap = true, .violent = true}, &both);
	assert_true(both.event_count > 4);
	for (int k = 1; k < both.event_count; k++) {
		const struct rb_event *x = &both.event[k - 1], *y = &both.event[k];
		const double steps = y->time_s * 60;

		assert_true(x->time_s <= y->time_s);
		if (x->time_s == y->time_s)
			assert_true(x->a < y->a || (x->a == y->a && x->b < y->b));
		within += fabs(steps - nearbyint(steps)) > 1e-9;
	}
	/* some of them happened in shorter steps */
	assert_true(within > 0);
	release(&both);
}

static bool count_calls(void *user)
{
	++*(int *)user;
	return false;
}

/* However often a step is halved: the groups ask before each part of it whether the run is to end. */
static void parts_of_a_step_hear_that_the_run_is_to_end(void **state)
{
	int calls = 0;
	const struct rb_world_options options = {.stop = count_calls, .stop_user = &calls};
	struct lab lab;
	int id[BODIES];

	(void)state;
	for (int global = 0; global < 2; global++) {
		open_sixtieths(&lab);
		lab.scene.world.rollback = global ? RB_ROLLBACK_GLOBAL : RB_ROLLBACK_SELECTIVE;
		lay_violent(&lab, id);
		lab_seal_with(&lab, &options, NULL);
		calls = 0;
		lab_run(&lab);
		const int frames = (int)rb_world_frame(lab.world);
		const struct rb_frame_numbers numbers = rb_world_totals(lab.world);
		assert_true(numbers.rollbacks > 0);
		/* at least two parts of what went back, and whoever went on has tried them */
		assert_true(calls >= frames + 2 * (int)numbers.rollbacks);
		lab_close(&lab);
	}
}

static void what_went_back_takes_memory_for_a_while_only(void **state)
{
	struct lab lab;
	int id[BODIES], kept = 0;
	uint64_t rollbacks = 0;

	(void)state;
	open_sixtieths(&lab);
	lab.scene.world.duration_s = 4;
	lay_violent(&lab, id);
	lab_seal(&lab, 1);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		assert_int_equal(rb_world_step_frame(lab.world, &lab.error), RB_OK);
		const struct rb_frame_numbers numbers = rb_world_totals(lab.world);
		/* groups may go back again in one of the next steps */
		if (numbers.rollbacks > rollbacks)
			assert_non_null(lab.world->stepped->local);
		rollbacks = numbers.rollbacks;
		kept += lab.world->stepped->local != NULL;
	}
	assert_true(rollbacks > 0);
	assert_null(lab.world->stepped->local);
	assert_true(kept > 1);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(only_the_group_that_fails_goes_back),
		cmocka_unit_test(what_is_apart_has_the_same_bits_without_the_rest),
		cmocka_unit_test(nobody_passes_another_within_a_step),
		cmocka_unit_test(what_a_spring_joins_goes_back_together),
		cmocka_unit_test(what_is_not_finite_is_named_and_the_rest_is_as_before),
		cmocka_unit_test(any_allocation_may_fail_in_a_step_that_goes_back),
		cmocka_unit_test(order_of_groups_and_threads_are_not_in_the_bits),
		cmocka_unit_test(impacts_are_told_in_order_of_time_then_ids),
		cmocka_unit_test(parts_of_a_step_hear_that_the_run_is_to_end),
		cmocka_unit_test(what_went_back_takes_memory_for_a_while_only),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
