/* SPDX-License-Identifier: MIT */
/* src/control/player.c */
#include "support.h"

#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

#include "control/player.h"

enum { FRAMES = 100000, SOON_MS = 120000 };

/* A run that does nothing but pass the gate. */
struct play {
	struct rb_player *player;
	uint64_t frame_count;
	uint64_t collision_every; /* frames, 0: none collide */
	atomic_bool held;         /* a frame takes a millisecond */
	atomic_bool stop;
	atomic_uint_fast64_t passed; /* frames that have left the gate */
	enum rb_player_verdict verdict;
	pthread_t thread;
};

static void sleep_ms(long ms)
{
	const struct timespec wait = {ms / 1000, ms % 1000 * 1000000};

	nanosleep(&wait, NULL);
}

static bool stopped(void *user)
{
	struct play *play = user;

	(void)rb_player_status(play->player); /* the gate holds no lock while it asks */
	return atomic_load(&play->stop);
}

static void *simulate(void *argument)
{
	struct play *play = argument;

	for (uint64_t k = 0; k < play->frame_count && !atomic_load(&play->stop); k++) {
		const bool collides = play->collision_every && k > 0 &&
		                      k % play->collision_every == 0;
		const struct rb_frame_numbers numbers = {
			.kinetic_energy = (double)k,
			.collisions = collides,
			.rollbacks = 2,
			.max_penetration = k == 3 ? 0.5 : 0.25,
			.smallest_step = k == 0 ? 0 : 1.0 / (double)(k + 1)};
		const struct rb_player_frame frame = {
			.numbers = &numbers, .index = k, .time_s = (double)k / 100};
		rb_player_arrive(play->player, &frame);
		if (atomic_load(&play->held))
			sleep_ms(1);
		play->verdict = rb_player_gate(play->player, stopped, play);
		if (play->verdict != RB_PLAYER_GO)
			return NULL;
		atomic_fetch_add(&play->passed, 1);
	}
	rb_player_end(play->player);
	return NULL;
}

static void open_play(struct play *play, uint64_t frame_count)
{
	struct rb_error err;

	*play = (struct play){.frame_count = frame_count};
	assert_ok(rb_player_create(&play->player, frame_count, (double)(frame_count - 1) / 100,
	                           &err));
}

static void start(struct play *play)
{
	assert_int_equal(pthread_create(&play->thread, NULL, simulate, play), 0);
}

static void close_play(struct play *play)
{
	pthread_join(play->thread, NULL);
	rb_player_destroy(play->player);
}

/* Waits until the run stands still at a frame. */
static void assert_stands_at(struct play *play, uint64_t frame)
{
	struct rb_player_status status = rb_player_status(play->player);

	for (int ms = 0; ms < SOON_MS && !status.paused; ms++) {
		sleep_ms(1);
		status = rb_player_status(play->player);
	}
	assert_true(status.paused);
	assert_int_equal(status.frame, frame);
	assert_int_equal(atomic_load(&play->passed), frame);
}

static void a_run_that_nobody_stops_passes_all_frames(void **state)
{
	struct play play;

	(void)state;
	open_play(&play, 1000);
	start(&play);
	pthread_join(play.thread, NULL);
	const struct rb_player_status status = rb_player_status(play.player);
	assert_int_equal(atomic_load(&play.passed), 1000);
	assert_true(status.ended && status.begun);
	assert_false(status.paused || status.pausing);
	assert_int_equal(status.frame, 999);
	assert_int_equal(status.frame_count, 1000);
	assert_near(status.time_s, 9.99, 1e-12);
	assert_int_equal(status.rollbacks, 2000);
	assert_near(status.max_penetration_m, 0.5, 0);
	assert_near(status.smallest_step_s, 0.001, 1e-15);
	assert_near(status.kinetic_energy, 999, 0);
	rb_player_destroy(play.player);
}

static void steps_count_frames_exactly(void **state)
{
	struct play play;

	(void)state;
	open_play(&play, FRAMES);
	rb_player_pause(play.player); /* before the first frame: it is the one to stand at */
	start(&play);
	assert_stands_at(&play, 0);
	rb_player_step(play.player, 1);
	assert_stands_at(&play, 1);
	rb_player_step(play.player, 37);
	assert_stands_at(&play, 38);
	/* those that are asked for while others are under way come on top */
	for (int i = 0; i < 5; i++)
		rb_player_step(play.player, 2000);
	assert_stands_at(&play, 10038);
	rb_player_quit(play.player);
	close_play(&play);
	assert_int_equal(play.verdict, RB_PLAYER_QUIT);
}

static void a_pause_ends_steps_and_play_ends_a_pause(void **state)
{
	struct play play;

	(void)state;
	open_play(&play, FRAMES);
	rb_player_pause(play.player);
	start(&play);
	assert_stands_at(&play, 0);
	/* so slow that half of the frames would take a minute */
	atomic_store(&play.held, true);
	rb_player_step(play.player, FRAMES / 2);
	rb_player_pause(play.player);
	for (int ms = 0; ms < SOON_MS && !rb_player_status(play.player).paused; ms++)
		sleep_ms(1);
	const uint64_t frame = rb_player_status(play.player).frame;
	assert_true(frame < FRAMES / 2);
	assert_stands_at(&play, frame);
	rb_player_step(play.player, 1); /* none of those before are left */
	assert_stands_at(&play, frame + 1);
	atomic_store(&play.held, false);
	rb_player_play(play.player);
	close_play(&play);
	assert_int_equal(atomic_load(&play.passed), FRAMES);
}

static void collisions_stop_the_run_when_asked_for(void **state)
{
	struct play play;

	(void)state;
	open_play(&play, 101);
	play.collision_every = 40;
	rb_player_stop_at_collision(play.player, true);
	start(&play);
	assert_stands_at(&play, 40);
	rb_player_step(play.player, 60); /* the next collision comes first */
	assert_stands_at(&play, 80);
	rb_player_stop_at_collision(play.player, false);
	rb_player_play(play.player);
	pthread_join(play.thread, NULL);
	const struct rb_player_status status = rb_player_status(play.player);
	assert_int_equal(status.collisions, 2);
	assert_int_equal(status.part[80], 1); /* frame 40 of 100, in 200 parts */
	assert_int_equal(status.part[160], 1);
	assert_int_equal(status.part[0], 0);
	assert_int_equal(atomic_load(&play.passed), 101);
	rb_player_destroy(play.player);
}

static void a_collision_of_the_last_frame_is_in_the_last_part(void **state)
{
	struct play play;

	(void)state;
	open_play(&play, 101);
	play.collision_every = 100;
	start(&play);
	pthread_join(play.thread, NULL);
	assert_int_equal(rb_player_status(play.player).part[RB_PLAYER_PARTS - 1], 1);
	rb_player_destroy(play.player);
}

static void a_restart_is_told_once_and_a_pause_outlives_it(void **state)
{
	struct play play;

	(void)state;
	open_play(&play, FRAMES);
	rb_player_pause(play.player);
	start(&play);
	assert_stands_at(&play, 0);
	rb_player_step(play.player, 5);
	assert_stands_at(&play, 5);
	rb_player_restart(play.player);
	pthread_join(play.thread, NULL);
	assert_int_equal(play.verdict, RB_PLAYER_RESTART);

	rb_player_begin_again(play.player, FRAMES, 20);
	struct rb_player_status status = rb_player_status(play.player);
	assert_int_equal(status.restarts, 1);
	assert_false(status.begun);
	assert_int_equal(status.rollbacks, 0);
	assert_near(status.duration_s, 20, 0);
	atomic_store(&play.passed, 0);
	start(&play);
	assert_stands_at(&play, 0);
	rb_player_play(play.player);
	close_play(&play);
	assert_int_equal(play.verdict, RB_PLAYER_GO);
}

static void a_signal_ends_the_wait_of_a_paused_run(void **state)
{
	struct play play;

	(void)state;
	open_play(&play, FRAMES);
	rb_player_pause(play.player);
	start(&play);
	assert_stands_at(&play, 0);
	atomic_store(&play.stop, true);
	close_play(&play);
	assert_int_equal(play.verdict, RB_PLAYER_GO);
}

static void pauses_are_not_in_the_run_s_wall_time(void **state)
{
	struct play play;

	(void)state;
	open_play(&play, 1000);
	rb_player_pause(play.player);
	start(&play);
	assert_stands_at(&play, 0);
	const struct rb_player_status before = rb_player_status(play.player);
	sleep_ms(200);
	const struct rb_player_status paused = rb_player_status(play.player);
	assert_true(paused.paused_s >= before.paused_s + 0.2);
	assert_true(paused.wall_s - before.wall_s < 0.02);
	rb_player_play(play.player);
	pthread_join(play.thread, NULL);
	const struct rb_player_status after = rb_player_status(play.player);
	assert_true(after.paused_s >= paused.paused_s);
	rb_player_destroy(play.player);
}

static void a_run_that_nobody_could_continue_does_not_pause(void **state)
{
	struct play play;

	(void)state;
	open_play(&play, FRAMES);
	rb_player_pause(play.player);
	start(&play);
	assert_stands_at(&play, 0);
	rb_player_attend(play.player, false); /* the last one has gone */
	close_play(&play);
	assert_int_equal(atomic_load(&play.passed), FRAMES);
}

/* Many threads that command at random; the run comes to its end all the same. */
static void *command(void *argument)
{
	struct play *play = argument;
	unsigned random = (unsigned)(uintptr_t)&random;

	for (int i = 0; i < 3000; i++) {
		random = random * 1664525 + 1013904223;
		switch (random >> 24 & 7) {
		case 0:
			rb_player_pause(play->player);
			break;
		case 1:
			rb_player_step(play->player, random >> 16 & 15);
			break;
		case 2:
			rb_player_stop_at_collision(play->player, random >> 16 & 1);
			break;
		case 3:
			(void)rb_player_status(play->player);
			break;
		default:
			rb_player_play(play->player);
			break;
		}
	}
	return NULL;
}

static void commands_of_many_do_not_get_in_each_other_s_way(void **state)
{
	enum { MANY = 6 };
	pthread_t threads[MANY];
	struct play play;

	(void)state;
	open_play(&play, FRAMES);
	play.collision_every = 7;
	start(&play);
	for (int i = 0; i < MANY; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, command, &play), 0);
	for (int i = 0; i < MANY; i++)
		pthread_join(threads[i], NULL);
	rb_player_stop_at_collision(play.player, false);
	rb_player_play(play.player);
	close_play(&play);
	assert_int_equal(atomic_load(&play.passed), FRAMES);
}

static void a_checkpoint_is_asked_for_once_also_while_the_run_is_paused(void **state)
{
	struct rb_player *player;

	(void)state;
	assert_int_equal(rb_player_create(&player, 10, 1, NULL), RB_OK);
	rb_player_keep(player);
	assert_int_equal(rb_player_gate(player, NULL, NULL), RB_PLAYER_KEEP);
	assert_int_equal(rb_player_gate(player, NULL, NULL), RB_PLAYER_GO);
	rb_player_pause(player);
	rb_player_keep(player);
	assert_int_equal(rb_player_gate(player, NULL, NULL), RB_PLAYER_KEEP);
	/* what else was asked for meanwhile is not lost */
	rb_player_restart(player);
	rb_player_keep(player);
	assert_int_equal(rb_player_gate(player, NULL, NULL), RB_PLAYER_KEEP);
	assert_int_equal(rb_player_gate(player, NULL, NULL), RB_PLAYER_RESTART);
	rb_player_destroy(player);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_checkpoint_is_asked_for_once_also_while_the_run_is_paused),
		cmocka_unit_test(a_run_that_nobody_stops_passes_all_frames),
		cmocka_unit_test(steps_count_frames_exactly),
		cmocka_unit_test(a_pause_ends_steps_and_play_ends_a_pause),
		cmocka_unit_test(collisions_stop_the_run_when_asked_for),
		cmocka_unit_test(a_collision_of_the_last_frame_is_in_the_last_part),
		cmocka_unit_test(a_restart_is_told_once_and_a_pause_outlives_it),
		cmocka_unit_test(a_signal_ends_the_wait_of_a_paused_run),
		cmocka_unit_test(pauses_are_not_in_the_run_s_wall_time),
		cmocka_unit_test(a_run_that_nobody_could_continue_does_not_pause),
		cmocka_unit_test(commands_of_many_do_not_get_in_each_other_s_way),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
