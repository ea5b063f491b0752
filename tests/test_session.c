/* SPDX-License-Identifier: MIT */
/* src/control/session.c, history.c, answer.c */
#include "host.h"

#include "base/memory.h"
#include "control/wire.h"

static void what_a_run_cannot_serve_is_refused_in_one_line(void **state)
{
	static const char *const lines[] = {"seek 1",     "speed 2",  "back",
	                                    "follow x",   "camera a", "snapshot",
	                                    "view pause", "next",     "previous"};
	struct host host;

	(void)state;
	open_session(&host);
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
		const char *answer = asked(&host, lines[i]);
		assert_int_equal(strncmp(answer, "error '", 7), 0);
		assert_ptr_equal(strchr(answer, '\n'), answer + strlen(answer) - 1);
		assert_non_null(strstr(answer, "needs a console"));
	}
	close_host(&host);
}

static void films_are_switched_where_there_are_any(void **state)
{
	struct host host;

	(void)state;
	open_session(&host);
	assert_answer(&host, "status", " film none\n");
	assert_string_equal(asked(&host, "film off"),
	                    "error 'film': no camera of this run makes a film\n");
	rb_player_has_films(host.player, true);
	assert_answer(&host, "status", " film on\n");
	assert_string_equal(asked(&host, "film off"), "ok\n");
	assert_answer(&host, "status", " film off\n");
	assert_false(rb_player_filming(host.player));
	/* another run, with films of its own */
	rb_player_begin_again(host.player, 101, 10);
	assert_true(rb_player_filming(host.player));
	assert_answer(&host, "status", " film none\n");
	close_host(&host);
}

/* Counts are those of the run so far, the rest is of the frame that came last. */
static void the_status_tells_what_the_frames_have_told(void **state)
{
	static const char *const lines[] = {
		" state playing\n",       " frame 2\n",
		" frames 101\n",          " time 0.25\n",
		" duration 10\n",         " restarts 1\n",
		" collisions 13\n",       " rollbacks 7\n",
		" smallest-step 0.001\n", " kinetic-energy 2.5\n",
		" potential-energy -3\n", " max-penetration 2e-09\n",
	};
	struct host host;

	(void)state;
	open_session(&host);
	rb_player_begin_again(host.player, 101, 10);
	for (uint64_t k = 1; k <= 2; k++) {
		const struct rb_frame_numbers numbers = {.kinetic_energy = 2.5,
		                                         .potential_energy = -3,
		                                         .max_penetration = k == 1 ? 2e-9 : 1e-9,
		                                         .collisions = k == 1 ? 12 : 1,
		                                         .rollbacks = k == 1 ? 3 : 4,
		                                         .smallest_step = k == 1 ? 0.001 : 0.002};
		const struct rb_player_frame passing = {
			.numbers = &numbers, .index = k, .time_s = (double)k / 8};
		rb_player_arrive(host.player, &passing);
	}
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
		assert_answer(&host, "status", lines[i]);
	close_host(&host);
}

static void commands_reach_the_player(void **state)
{
	struct host host;

	(void)state;
	open_session(&host);
	rb_player_attend(host.player, true);
	assert_string_equal(asked(&host, "pause"), "ok\n");
	assert_true(rb_player_status(host.player).pausing);
	assert_string_equal(asked(&host, "toggle"), "ok\n");
	assert_false(rb_player_status(host.player).pausing);
	assert_string_equal(asked(&host, "stop at collision on"), "ok\n");
	assert_true(rb_player_status(host.player).stops_at_collision);
	assert_answer(&host, "status", " stop-at-collision on\n");
	assert_string_equal(asked(&host, ""), "ok\n");
	assert_string_equal(asked(&host, "# pause"), "ok\n");
	assert_false(rb_player_status(host.player).pausing);
	assert_answer(&host, "pausse", "error unknown command 'pausse' (did you mean 'pause'?)");
	assert_answer(&host, "help", " toggle: ");
	assert_answer(&host, "help step", " step [N]: ");
	assert_answer(&host, "events", " 2 0 test: stop\n");
	assert_string_equal(asked(&host, "events 3"), "ok\n");
	close_host(&host);
}

static void the_last_frames_are_kept_and_sent(void **state)
{
	struct host host;
	struct rb_frame frame = {0};

	(void)state;
	open_session(&host);
	assert_answer(&host, "frame", "error there is no frame yet");
	assert_answer(&host, "body #0", "error there is no frame yet");
	for (uint64_t k = 0; k < RB_HISTORY_FRAMES_MAX + 10; k++)
		keep_frame(&host, k);
	assert_answer(&host, "frame 9", "error frame 9 is not kept, wanted one from 10 to 609");
	assert_answer(&host, "frame 610", "error frame 610 is not kept");
	assert_answer(&host, "frame x", "usage: frame [N] [all]");
	assert_answer(&host, "status", " kept 10 609\n");
	for (int k = 0; k < 4; k++) {
		static const char *const lines[] = {"frame", "frame 10 all", "newer 1", "frame 10"};
		const char *answer = asked(&host, lines[k]);
		const char *end = strchr(answer, '\n');
		assert_string_equal(end, "\nok\n");
		assert_good(host.err, rb_wire_read_frame(&frame, BODIES, answer + 1,
		                                         (size_t)(end - answer - 1), &host.err));
		assert_int_equal(frame.index, k % 2 ? 10 : 609);
		assert_near(frame.position[3], k % 2 ? 10 : 609, 0);
		assert_near(frame.position[4], 1, 0);
		assert_true((frame.velocity != NULL) == (k == 1));
	}
	assert_string_equal(asked(&host, "newer 609"), "ok\n");
	rb_frame_release(&frame);
	close_host(&host);
}

static void bodies_are_inspected_in_full(void **state)
{
	struct host host;

	(void)state;
	open_session(&host);
	keep_frame(&host, 0);
	keep_frame(&host, 1);
	assert_answer(&host, "body \"the ball\"", " body #1\n name the ball\n moves yes\n");
	assert_answer(&host, "body \"the ball\"", " frame 1\n time 0.10000000000000001\n");
	assert_answer(&host, "body \"the ball\"", " velocity 0.10000000000000001 0 0\n");
	assert_answer(&host, "body #3", " moves no\n shape plane\n");
	assert_answer(&host, "body #4", "error there is no body '#4'");
	assert_answer(&host, "body \"the bal\"", "(did you mean 'the ball'?)");
	close_host(&host);
}

static void parameters_are_set_as_the_command_line_would_take_them(void **state)
{
	static struct rb_session_set sets[RB_SESSION_SETS_MAX];
	struct host host;

	(void)state;
	open_session(&host);
	assert_answer(&host, "set e 0.25", " e=0.25 from the next restart on\nok\n");
	assert_answer(&host, "set e 2", "error parameter 'e' must be in [0, 1] (got '2')");
	assert_answer(&host, "set e x", "error parameter 'e' must be a number (got 'x')");
	assert_answer(&host, "set e inf", "must be a number");
	assert_answer(&host, "set f 1", "the scene has no parameter 'f'; it has e, kind");
	assert_answer(&host, "set kind sideways", "must be one of up, down (got 'sideways')");
	assert_answer(&host, "set kind u", "must be one of up, down");
	assert_answer(&host, "set kind down", "ok\n");
	assert_answer(&host, "set e 0x1p-1", "ok\n"); /* a number as Lua reads it */
	assert_int_equal(rb_session_sets(host.session, sets), 2);
	assert_string_equal(sets[0].text, "e=0x1p-1");
	assert_string_equal(sets[1].text, "kind=down");
	assert_answer(&host, "status", " set kind=down\n");
	close_host(&host);
}

static void the_scene_goes_out_whole(void **state)
{
	struct host host;

	(void)state;
	open_session(&host);
	assert_answer(&host, "scene", " bodies 3 1\n duration 10\n frame-rate 10\n");
	assert_answer(&host, "scene", " param ZQ== MC41\n"); /* e, 0.5 */
	assert_answer(&host, "scene", " file c2NlbmUubHVh YSBzY2VuZQB3aXRoIGEgemVybw==\n");
	assert_answer(&host, "hello", " protocol 1\n");
	assert_answer(&host, "hello", " title Three?balls\n");
	assert_answer(&host, "timeline", " collisions 000");
	close_host(&host);
}

static void between_two_runs_questions_are_refused_and_nothing_else(void **state)
{
	struct host host;

	(void)state;
	open_session(&host);
	keep_frame(&host, 0);
	rb_session_detach(host.session);
	assert_answer(&host, "frame", "error the run is restarting");
	assert_answer(&host, "body #0", "error the run is restarting");
	assert_answer(&host, "scene", "error the run is restarting");
	assert_answer(&host, "hello", "error the run is restarting");
	assert_answer(&host, "set e 0.25", "error the run is restarting");
	assert_answer(&host, "status", "ok\n");
	assert_answer(&host, "pause", "ok\n");
	assert_good(host.err, rb_session_attach(host.session, &host.info, NULL, &host.err));
	assert_answer(&host, "frame", "error there is no frame yet");
	keep_frame(&host, 0);
	assert_answer(&host, "frame", " frame 0 0 3 po ");
	close_host(&host);
}

static void memory_that_is_out_leaves_the_session_whole(void **state)
{
	static const char *const lines[] = {"scene", "frame", "body #0", "set e 0.5", "status"};
	struct host host;

	(void)state;
	open_session(&host);
	keep_frame(&host, 0);
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
		for (uint64_t k = 1; k < 20; k++) {
			struct rb_answer answer = {0};
			rb_memory_fail_at(k);
			const bool right = rb_session_execute(host.session, lines[i], "test",
			                                      &answer);
			rb_memory_fail_at(0);
			if (right)
				assert_memory_equal(answer.text + answer.size - 3, "ok\n", 3);
			rb_answer_release(&answer);
		}
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
		assert_answer(&host, lines[i], "ok\n");
	close_host(&host);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_a_run_cannot_serve_is_refused_in_one_line),
		cmocka_unit_test(films_are_switched_where_there_are_any),
		cmocka_unit_test(the_status_tells_what_the_frames_have_told),
		cmocka_unit_test(commands_reach_the_player),
		cmocka_unit_test(the_last_frames_are_kept_and_sent),
		cmocka_unit_test(bodies_are_inspected_in_full),
		cmocka_unit_test(parameters_are_set_as_the_command_line_would_take_them),
		cmocka_unit_test(the_scene_goes_out_whole),
		cmocka_unit_test(between_two_runs_questions_are_refused_and_nothing_else),
		cmocka_unit_test(memory_that_is_out_leaves_the_session_whole),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
