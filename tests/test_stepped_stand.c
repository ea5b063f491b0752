/* SPDX-License-Identifier: MIT */
/* src/stepped/sleep: what stands is not looked at, and nothing comes out otherwise for it. */
#include "sanitized.h"
#include "worlds.h"

#include "base/pack.h"
#include "method/save.h"
#include "stepped/stepped_state.h"
#include "world/world.h"

static const double g = 9.81;

enum { FRAMES = 210, STACKS = 5, HIGH = 3 };

/* What a run is made of, and what came of it. */
struct course {
	int pushed, shoved, placed; /* ids that callbacks deal with; -1: none */
	double plate_begins_s;
	bool rain;
	bool off; /* nothing may stand */
	enum rb_rollback_kind rollback;
	int threads;
	int pack_at; /* a frame after which the world is packed and loaded anew, 0: none */
	uint64_t hash[FRAMES];
	int standing[FRAMES];
	struct rb_world_work work;
	struct rb_pack end;
};

static enum rb_status motion(void *user, int id, double t, struct rb_driven_pose *pose,
                             struct rb_error *err)
{
	const struct course *course = user;

	(void)id, (void)err;
	pose->position = (rb_vec3){-6 + 0.5 * fmax(0, t - course->plate_begins_s), 0, 0.1};
	return RB_OK;
}

static enum rb_status on_step(void *user, struct rb_world *world, double t, double h,
                              struct rb_error *err)
{
	const struct course *course = user;
	const rb_vec3 none = {0, 0, 0};

	(void)err;
	if (t >= 0.55 && t < 0.6)
		rb_world_apply_force(world, course->pushed, (rb_vec3){0, 20, 0},
		                     rb_world_position(world, course->pushed));
	if (t >= 2 && t < 2 + h)
		rb_world_set_velocity(world, course->shoved, none);
	if (t >= 2.5 && t < 2.5 + h)
		rb_world_set_position(world, course->placed,
		                      rb_vec3_add(rb_world_position(world, course->placed),
		                                  (rb_vec3){0, 0, 0.01}));
	return RB_OK;
}

static int add_box(struct lab *lab, rb_vec3 size, rb_vec3 at, bool driven)
{
	struct rb_body_def def = lab_box_def(size, 1, at);

	if (driven) {
		def.motion = 0;
		def.mass = (double)NAN;
	}
	return lab_add(lab, &def);
}

/* Stacks of boxes and of balls; a stack on a plate that is driven off; a ball that rolls and one that falls on a stack. */
static void lay(struct lab *lab, struct course *course)
{
	lab_open(lab, (FRAMES + 1) / 60.0, 60);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.time_step_s = 1.0 / 240;
	lab->scene.world.rollback = course->rollback;
	lab->scene.world.tolerance_m = 1e-8; /* so close that some steps fail */
	lab->scene.world.gravity = (rb_vec3){0, 0, -g};
	lab_surface(lab, 0.5, 0);
	lab_plane(lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	for (int k = 0; k < STACKS * HIGH; k++) {
		const rb_vec3 at = {1.05 * (k / HIGH), 0, 0.5 + k % HIGH};

		course->pushed = course->shoved;
		course->shoved = course->placed;
		course->placed = add_box(lab, (rb_vec3){1, 1, 1}, at, false);
		lab_sphere(lab, 0.5, 1, rb_vec3_add(at, (rb_vec3){0, 3, 0}), (rb_vec3){0, 0, 0});
	}
	add_box(lab, (rb_vec3){2, 2, 0.2}, (rb_vec3){-6, 0, 0.1}, true);
	add_box(lab, (rb_vec3){1, 1, 1}, (rb_vec3){-6, 0, 0.7}, false);
	lab_sphere(lab, 0.5, 1, (rb_vec3){-2, 6, 0.5}, (rb_vec3){0.5, 0, 0});
	lab_sphere(lab, 0.5, 1, (rb_vec3){0.2, 3, 10}, (rb_vec3){0, 0, 0});
	lab_sphere(lab, 0.5, 3, (rb_vec3){-14, 0.1, 2}, (rb_vec3){10, 0, 4});
}

/* Bodies of several shapes that fall one after the other into a pit, onto what already stands there. */
static void lay_rain(struct lab *lab, struct course *course)
{
	lab_open(lab, (FRAMES + 1) / 60.0, 60);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.time_step_s = 1.0 / 240;
	lab->scene.world.gravity = (rb_vec3){0, 0, -g};
	lab_surface(lab, 0.6, 0);
	lab_plane(lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	for (int k = 0; k < 48; k++) {
		const double t = 0.05 * k;
		const rb_vec3 at = {2.2 * (k % 4) + 0.3 * sin(3.0 * k), 2.2 * (k / 4 % 3),
		                    0.6 + 1.1 * k};

		course->pushed = course->shoved;
		course->shoved = course->placed;
		course->placed = k % 5 == 4 ? lab_sphere(lab, 0.3, 1, at, (rb_vec3){0, 0, -8 * t})
		                            : add_box(lab, (rb_vec3){1, 0.6 + 0.1 * (k % 4), 0.5},
		                                      at, false);
	}
}

static void seal(struct lab *lab, struct course *course)
{
	const struct rb_world_options options = {
		.threads = course->threads, .keep_events = true, .keep_contacts = true};
	const struct rb_world_hooks hooks = {.user = course, .motion = motion, .step = on_step};

	lab_seal_with(lab, &options, &hooks);
	lab->world->stepped->sleep.off = course->off;
}

static void run(struct course *course)
{
	struct lab lab;

	(course->rain ? lay_rain : lay)(&lab, course);
	seal(&lab, course);
	for (int k = 0; k < FRAMES; k++) {
		lab_step(&lab);
		course->hash[k] = rb_world_hash(lab.world);
		course->standing[k] = lab.world->stepped->sleep.count;
		if (k + 1 != course->pack_at)
			continue;
		struct rb_pack saved = {0};
		assert_int_equal(rb_world_pack(lab.world, &saved, &lab.error), RB_OK);
		lab_close(&lab);
		(course->rain ? lay_rain : lay)(&lab, course);
		seal(&lab, course);
		struct rb_pack pack = {.loading = true, .bytes = saved.bytes, .size = saved.size};
		assert_int_equal(rb_world_pack(lab.world, &pack, &lab.error), RB_OK);
		rb_pack_release(&saved);
	}
	assert_int_equal(rb_world_pack(lab.world, &course->end, &lab.error), RB_OK);
	course->work = rb_world_work(lab.world);
	lab_close(&lab);
}

static void assert_same(const struct course *found, const struct course *wanted)
{
	for (int k = 0; k < FRAMES; k++)
		if (found->hash[k] != wanted->hash[k])
			fail_msg("other bits from frame %d on", k + 1);
	assert_int_equal(found->end.size, wanted->end.size);
	assert_memory_equal(found->end.bytes, wanted->end.bytes, wanted->end.size);
}

/* Something arrives, a callback pushes, stops and puts, a plate begins to move: with the same bits as if all were looked at. */
static void assert_no_bit_changes(enum rb_rollback_kind rollback)
{
	struct course wanted = {
		.off = true, .rollback = rollback, .threads = 1, .plate_begins_s = 3};
	struct course found = {.rollback = rollback, .threads = 1, .plate_begins_s = 3};
	int most = 0, least = INT32_MAX;

	run(&wanted);
	run(&found);
	assert_same(&found, &wanted);
	for (int k = 0; k < FRAMES; k++) {
		assert_int_equal(wanted.standing[k], 0);
		most = found.standing[k] > most ? found.standing[k] : most;
		if (k > 60)
			least = found.standing[k] < least ? found.standing[k] : least;
	}
	/* there was something to be seen: nearly all stood, and some of it was roused; steps failed, overlap was closed */
	assert_true(most >= 2 * STACKS * HIGH - 4);
	assert_true(least < most);
	assert_true(found.work.closings > 0);
	assert_int_equal(found.work.rows, wanted.work.rows);
	if (rollback != RB_ROLLBACK_NONE)
		assert_true(found.work.discarded_body_steps > 0);
	rb_pack_release(&wanted.end);
	rb_pack_release(&found.end);
}

static void what_stands_changes_no_bit(void **state)
{
	(void)state;
	assert_no_bit_changes(RB_ROLLBACK_SELECTIVE);
}

static void nor_where_all_go_back_together_or_nobody_does(void **state)
{
	(void)state;
	assert_no_bit_changes(RB_ROLLBACK_GLOBAL);
	assert_no_bit_changes(RB_ROLLBACK_NONE);
}

static void nor_in_a_rain_of_bodies(void **state)
{
	struct course wanted = {.off = true, .rain = true, .threads = 1};
	struct course found = {.rain = true, .threads = 2, .pack_at = 100};
	int most = 0;

	(void)state;
	run(&found);
	if (compares_threads) {
		run(&wanted);
		assert_same(&found, &wanted);
	}
	for (int k = 0; k < FRAMES; k++)
		most = found.standing[k] > most ? found.standing[k] : most;
	assert_true(most > 4);
	rb_pack_release(&wanted.end);
	rb_pack_release(&found.end);
}

static void it_stands_in_the_same_bits_on_two_threads_and_after_a_restart(void **state)
{
	struct course wanted = {.threads = 1, .plate_begins_s = 3};
	struct course found = {.threads = 2, .plate_begins_s = 3, .pack_at = 71};

	(void)state;
	run(&found);
	if (compares_threads) {
		run(&wanted);
		assert_same(&found, &wanted);
	}
	rb_pack_release(&wanted.end);
	rb_pack_release(&found.end);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_stands_changes_no_bit),
		cmocka_unit_test(nor_where_all_go_back_together_or_nobody_does),
		cmocka_unit_test(nor_in_a_rain_of_bodies),
		cmocka_unit_test(it_stands_in_the_same_bits_on_two_threads_and_after_a_restart),
	};

	return run_tests_of_threads(tests, "rain", "threads");
}
