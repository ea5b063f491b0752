/* SPDX-License-Identifier: MIT */
/* <rbsim.h>: what it gives, and what it refuses. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <rbsim.h>

#include "base/memory.h"

/* A ball on its way up, without anything to meet. */
static const char ball[] = "local v = param('v', 2, 'm/s')\n"
			   "world { duration = 0.5, gravity = {0, 0, -10}, frame_rate = 20 }\n"
			   "local m = material { name = 'wood', density = 700, friction = 0 }\n"
			   "local b = sphere { name = 'ball', radius = 0.1, position = {0, 0, 1}, "
			   "velocity = {0, 0, v}, material = m }\n"
			   "sphere { radius = 0.1, position = {5, 0, 1}, material = m, mass = 3 }\n"
			   "result('height', function() return b.position.z end, { unit = 'm' })\n";

static char path[512];

static const char *scene_file(const char *text)
{
	snprintf(path, sizeof path, "%s/embed.lua", getenv("TMPDIR") ? getenv("TMPDIR") : ".");
	FILE *const file = fopen(path, "w");
	assert_non_null(file);
	assert_true(fputs(text, file) >= 0 && fclose(file) == 0);
	return path;
}

static void a_scene_is_stepped_to_its_end(void **state)
{
	static const char *const params[] = {"v=3"};
	const struct rbsim_options options = {
		.size = sizeof options, .params = params, .param_count = 1};
	struct rbsim_simulation *simulation;
	struct rbsim_error error;
	double height;

	(void)state;
	assert_int_equal(rbsim_open(&simulation, scene_file(ball), &options, &error), RBSIM_OK);
	assert_string_equal(error.text, "");
	assert_int_equal(rbsim_frame_count(simulation), 11);
	assert_int_equal(rbsim_find(simulation, "ball"), 0);
	assert_int_equal(rbsim_find(simulation, "bal"), -1);
	assert_int_equal(rbsim_find(simulation, ""), -1);
	assert_string_equal(rbsim_name(simulation, 1), "");
	assert_true(rbsim_mass(simulation, 1) == 3.0);

	const struct rbsim_frame *const now = rbsim_frame(simulation);
	assert_int_equal(now->body_count, 2);
	assert_int_equal(now->index, 0);
	assert_true(now->position[2] == 1.0 && now->velocity[2] == 3.0);
	assert_null(now->orientation);
	assert_int_equal(rbsim_result(simulation, "height", &height, &error), RBSIM_USAGE);
	assert_true(isnan(height));
	int steps = 0;
	for (; !rbsim_is_over(simulation); steps++)
		assert_int_equal(rbsim_step(simulation, &error), RBSIM_OK);
	assert_int_equal(steps, 10);
	/* 1 + 3 t - 5 t^2 at 0.5 s, to rounding of numbers of the order of 1 */
	assert_true(fabs(now->position[2] - 1.25) < 4e-16);
	assert_int_equal(rbsim_result(simulation, "height", &height, &error), RBSIM_OK);
	assert_true(height == now->position[2]);
	assert_int_equal(rbsim_result(simulation, "width", &height, &error), RBSIM_USAGE);
	assert_int_equal(rbsim_step(simulation, &error), RBSIM_USAGE);
	assert_string_equal(error.text, "rbsim_step: the run is over");
	rbsim_close(simulation);
}

static void calls_that_are_wrong_are_refused(void **state)
{
	static const char *const params[] = {"v=fast"}, *const nothing[] = {NULL};
	struct rbsim_options options = {.size = sizeof options, .param_count = 1};
	struct rbsim_simulation *simulation;
	struct rbsim_recording *recording;
	const struct rbsim_frame *frame;
	struct rbsim_error error;
	double value;

	(void)state;
	scene_file(ball);
	assert_int_equal(rbsim_open(NULL, path, NULL, &error), RBSIM_USAGE);
	assert_int_equal(rbsim_open(&simulation, NULL, NULL, NULL), RBSIM_USAGE);
	assert_int_equal(rbsim_open(&simulation, path, &options, &error), RBSIM_USAGE);
	options.params = nothing;
	assert_int_equal(rbsim_open(&simulation, path, &options, &error), RBSIM_USAGE);
	options.params = params;
	assert_int_equal(rbsim_open(&simulation, path, &options, &error), RBSIM_USAGE);
	assert_non_null(strstr(error.text, "--param v: "));
	assert_null(simulation);
	options.size = 4096;
	assert_int_equal(rbsim_open(&simulation, path, &options, &error), RBSIM_USAGE);
	assert_int_equal(rbsim_open(&simulation, "absent.lua", NULL, &error), RBSIM_INPUT);
	assert_non_null(strstr(error.text, "absent.lua"));
	assert_int_equal(rbsim_open(&simulation, scene_file("ball {}\n"), NULL, &error),
	                 RBSIM_SCENE);
	assert_null(simulation);

	assert_int_equal(rbsim_step(NULL, &error), RBSIM_USAGE);
	assert_int_equal(rbsim_finish_recording(NULL, &error), RBSIM_USAGE);
	assert_int_equal(rbsim_result(NULL, "x", &value, &error), RBSIM_USAGE);
	assert_int_equal(rbsim_is_over(NULL), 1);
	assert_null(rbsim_frame(NULL));
	assert_int_equal(rbsim_frame_count(NULL), 0);
	assert_string_equal(rbsim_name(NULL, 0), "");
	assert_int_equal(rbsim_find(NULL, "x"), -1);
	assert_true(isnan(rbsim_mass(NULL, 0)));
	rbsim_close(NULL);

	assert_int_equal(rbsim_recording_open(&recording, NULL, &error), RBSIM_USAGE);
	assert_int_equal(rbsim_recording_frame(NULL, 0, &frame, &error), RBSIM_USAGE);
	assert_null(frame);
	assert_int_equal(rbsim_recording_refresh(NULL, &error), RBSIM_USAGE);
	assert_int_equal(rbsim_recording_frame_count(NULL), 0);
	assert_string_equal(rbsim_recording_status(NULL), "");
	assert_string_equal(rbsim_recording_name(NULL, 0), "");
	assert_int_equal(rbsim_recording_find(NULL, "x"), -1);
	rbsim_recording_close(NULL);
}

static void older_options_are_understood(void **state)
{
	/* as a program would pass them that knows `size` alone */
	const struct rbsim_options options = {.size = sizeof options.size, .param_count = -1};
	struct rbsim_simulation *simulation;

	(void)state;
	assert_int_equal(rbsim_open(&simulation, scene_file(ball), &options, NULL), RBSIM_OK);
	assert_string_equal(rbsim_version(), RBSIM_VERSION);
	rbsim_close(simulation);
}

static void a_step_that_fails_keeps_the_last_frame(void **state)
{
	struct rbsim_simulation *simulation;
	struct rbsim_error error;

	(void)state;
	scene_file("world { duration = 1, frame_rate = 10 }\n"
	           "local m = material { name = 'm', density = 1 }\n"
	           "sphere { radius = 1, position = {0, 0, 0}, material = m }\n"
	           "on_step(function(t) if t > 0.45 then error('enough') end end)\n");
	assert_int_equal(rbsim_open(&simulation, path, NULL, &error), RBSIM_OK);
	while (!rbsim_step(simulation, &error))
		;
	assert_int_equal(error.status, RBSIM_SCENE);
	assert_non_null(strstr(error.text, "enough"));
	assert_int_equal(rbsim_is_over(simulation), 1);
	const uint64_t index = rbsim_frame(simulation)->index;
	assert_int_equal(rbsim_step(simulation, &error), RBSIM_SCENE);
	assert_int_equal(rbsim_frame(simulation)->index, index);
	assert_true(index >= 3 && index <= 5);
	rbsim_close(simulation);
}

/* A function that fails after the bodies of its frame are known: what is shown is of one moment. */
static void a_frame_that_fails_is_not_shown(void **state)
{
	struct rbsim_simulation *simulation;
	struct rbsim_error error;

	(void)state;
	scene_file(
		"world { duration = 1, frame_rate = 8 }\n"
		"sphere { radius = 1, velocity = {1, 0, 0} }\n"
		"probe('p', function() if time() > 0.4 then error('enough') end return 1 end)\n");
	assert_int_equal(rbsim_open(&simulation, path, NULL, &error), RBSIM_OK);
	const struct rbsim_frame *const now = rbsim_frame(simulation);
	const double *const position = now->position;
	while (!rbsim_step(simulation, &error))
		;
	assert_int_equal(error.status, RBSIM_SCENE);
	assert_int_equal(now->index, 3);
	assert_true(now->time_s == 0.375 && now->position[0] == 0.375);
	assert_ptr_equal(now->position, position);
	rbsim_close(simulation);
}

static void an_open_without_memory_leaves_nothing(void **state)
{
	struct rbsim_simulation *simulation;
	struct rbsim_error error;
	enum rbsim_status status = RBSIM_MEMORY;

	(void)state;
	scene_file(ball);
	for (uint64_t k = 1; status == RBSIM_MEMORY; k++) {
		const struct rb_memory_counts before = rb_memory_counts();
		rb_memory_fail_at(k);
		status = rbsim_open(&simulation, path, NULL, &error);
		rb_memory_fail_at(0);
		const struct rb_memory_counts after = rb_memory_counts();
		if (status)
			assert_int_equal(after.taken - before.taken, after.freed - before.freed);
	}
	assert_int_equal(status, RBSIM_OK);
	rbsim_close(simulation);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_scene_is_stepped_to_its_end),
		cmocka_unit_test(calls_that_are_wrong_are_refused),
		cmocka_unit_test(older_options_are_understood),
		cmocka_unit_test(a_step_that_fails_keeps_the_last_frame),
		cmocka_unit_test(a_frame_that_fails_is_not_shown),
		cmocka_unit_test(an_open_without_memory_leaves_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
