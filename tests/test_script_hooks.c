/* SPDX-License-Identifier: MIT */
/* src/script/hooks, expects, handles: a scene's callbacks and expectations while a world runs */
#include "support.h"

#include <rbsim/model.h>
#include <rbsim/world.h>

#include "script/hooks.h"
#include "script/load.h"

enum { EXPECTS_MAX = 16 };

struct run {
	struct rb_script *script;
	struct rb_scene scene;
	struct rb_model *model;
	struct rb_world *world;
	struct rb_error error;
	enum rb_status status;
	struct rb_expect_result results[EXPECTS_MAX];
};

static const char *const shipped = "lua";

/* Loads, runs to the end as the program does, asks the expectations. The first status that is not RB_OK stays. */
static void run_text(struct run *run, const char *text)
{
	const struct rb_source_file file = {
		.name = "t.lua", .text = text, .size_bytes = strlen(text)};
	const struct rb_script_options options = {.path = "t.lua",
	                                          .files = &file,
	                                          .file_count = 1,
	                                          .lua_folders = &shipped,
	                                          .lua_folder_count = 1,
	                                          .callback_instructions = 100000};
	const struct rb_world_options world_options = {.keep_events = true};

	*run = (struct run){0};
	struct rb_error *err = &run->error;
	run->status = rb_script_load(&run->script, &run->scene, NULL, &options, err);
	if (run->status == RB_OK)
		run->status = rb_model_create(&run->model, &run->scene, NULL, err);
	if (run->status != RB_OK)
		return;
	const struct rb_world_hooks hooks = rb_script_hooks(run->script);
	run->status = rb_world_create(&run->world, run->model, &world_options, &hooks, err);
	if (run->status == RB_OK)
		run->status = rb_script_on_frame(run->script, run->world, 0, 0, err);
	while (run->status == RB_OK &&
	       rb_world_frame(run->world) + 1 < rb_world_frame_count(run->world)) {
		run->status = rb_world_step_frame(run->world, err);
		if (run->status == RB_OK)
			run->status = rb_script_on_frame(run->script, run->world,
			                                 rb_world_time(run->world),
			                                 rb_world_frame(run->world), err);
	}
	assert_true(run->scene.expect_count <= EXPECTS_MAX);
	if (run->status == RB_OK)
		run->status = rb_script_expects(run->script, run->world, run->results, err);
}

static void must_run(struct run *run, const char *text)
{
	run_text(run, text);
	if (run->status != RB_OK)
		fail_msg("%s", run->error.text);
}

static void end(struct run *run)
{
	rb_world_destroy(run->world);
	rb_model_destroy(run->model);
	rb_script_destroy(run->script);
	rb_scene_release(&run->scene);
}

static void must_end_with(const char *text, const char *message)
{
	struct run run;

	run_text(&run, text);
	assert_int_equal(run.status, RB_ERR_SCENE);
	assert_string_equal(run.error.text, message);
	end(&run);
}

static void a_scene_without_callbacks_has_no_hooks(void **state)
{
	struct run run;

	(void)state;
	must_run(&run, "world { duration = 0.1 } sphere { radius = 1 } on_frame(function() end) "
	               "expect('e', function() return true end)");
	const struct rb_world_hooks hooks = rb_script_hooks(run.script);
	assert_null(hooks.step);
	assert_null(hooks.collision);
	assert_true(run.results[0].ok);
	end(&run);
}

static void on_step_and_on_frame_come_on_their_grids(void **state)
{
	struct run run;

	(void)state;
	must_run(&run,
	         "world { duration = 1, frame_rate = 10, time_step = 0.05 } sphere { radius = 1 }\n"
	         "state.steps, state.frames, state.last, state.span = 0, {}, -1, 0\n"
	         "on_step(function(t, dt) state.steps = state.steps + 1 assert(t > state.last and "
	         "t == time()) state.last = t\n"
	         "  state.span = state.span + dt end)\n"
	         "on_frame(function(t, k) state.frames[#state.frames + 1] = {t, k} end)\n"
	         "on_frame(function(t, k) state.second = k end)\n"
	         "expect('20 steps', function() return math.abs(state.steps - 20), 0 end)\n"
	         "expect('they make a second', function() return math.abs(state.span - 1), 1e-12 "
	         "end)\n"
	         "expect('11 frames', function() return #state.frames == 11 and state.frames[1][1] "
	         "== 0 and state.frames[11][2] == 10\n"
	         "  and state.frames[4][1] == 3 / 10 and state.second == 10 end)\n");
	for (int i = 0; i < run.scene.expect_count; i++)
		if (!run.results[i].ok)
			fail_msg("%s: %s", run.results[i].text, run.results[i].message);
	end(&run);
}

static void a_collision_is_told_once_with_its_numbers(void **state)
{
	struct run run;

	(void)state;
	must_run(&run, "world { duration = 1, frame_rate = 100 }\n"
	               "local m = material { restitution = 1, friction = 0 }\n"
	               "local a = sphere { name = 'a', radius = 0.5, mass = 1, velocity = {2, 0, "
	               "0}, material = m }\n"
	               "local b = sphere { name = 'b', radius = 0.5, mass = 1, position = {2, 0, "
	               "0}, material = m }\n"
	               "local seen = {}\n"
	               "on_collision(function(c) seen[#seen + 1] = c end)\n"
	               "expect('one', function() return #seen == 1 and collisions() == 1 end)\n"
	               "expect('of these', function() local c = seen[1] return c.a == a and c.b == "
	               "b and c.a.name == 'a' end)\n"
	               "expect('numbers', function() local c = seen[1] return "
	               "math.abs(c.approach_speed - 2) < 1e-9 and c.normal.x > 0.999\n"
	               "  and math.abs(c.impulse.x - 2) < 1e-9 and math.abs(c.point.x - 1.5) < "
	               "0.05 and math.abs(c.time - 0.5) < 0.02 end)\n"
	               "expect('velocities change hands', function() return b.velocity.x, 2 + 1e-9 "
	               "end)\n");
	assert_int_equal(run.scene.expect_count, 4);
	for (int i = 0; i < 4; i++)
		if (!run.results[i].ok)
			fail_msg("%s: %s", run.results[i].text, run.results[i].message);
	end(&run);
}

static void handles_change_bodies_in_callbacks(void **state)
{
	struct run run;

	(void)state;
	must_run(&run,
	         "world { duration = 1, frame_rate = 10 }\n"
	         "local a = sphere { radius = 0.1, mass = 2 } local b = sphere { radius = 0.1, "
	         "position = {5, 0, 0} }\n"
	         "local c = sphere { radius = 0.1, position = {0, 5, 0}, mass = 2 } local f = "
	         "plane { point = {0, 0, -50} }\n"
	         "local first = true\n"
	         "on_step(function(t) if first then a:apply_impulse({4, 0, 0}) b:set_velocity {0, "
	         "1, 0} b:set_angular_velocity {0, 0, 3}\n"
	         "  b:set_position(vec3(7, 0, 0)) first = false c:set_velocity {0, 0, 5} "
	         "c:set_angular_velocity {2, 0, 0} end\n"
	         "  c:apply_force({2, 0, 0}) end)\n"
	         "expect('impulse', function() return math.abs(a.velocity.x - 2), 1e-12 end)\n"
	         "expect('velocity', function() return b.velocity == vec3(0, 1, 0) and "
	         "b.position.x == 7 and b.angular_velocity.z == 3 end)\n"
	         "expect('its own', function() return c.velocity.z == 5 and c.angular_velocity.x "
	         "== 2 and a.velocity.z == 0 end)\n"
	         "expect('force', function() return math.abs(c.velocity.x - 1), 1e-9 end)\n"
	         "expect('mass', function() return a.mass == 2 and a.momentum.x == 4 and f.mass == "
	         "math.huge end)\n"
	         "expect('energy', function() return math.abs(a.kinetic_energy - 4), 1e-9 end)\n"
	         "expect('whole', function() return math.abs(momentum().x - 6), 1e-9 end)\n");
	for (int i = 0; i < run.scene.expect_count; i++)
		if (!run.results[i].ok)
			fail_msg("%s: %s (%.17g, %.17g)", run.results[i].text,
			         run.results[i].message, run.results[i].measured,
			         run.results[i].bound);
	end(&run);
}

static void vectors_of_handles_are_copies(void **state)
{
	struct run run;

	(void)state;
	must_run(&run,
	         "world { duration = 1 }\n"
	         "local a = sphere { radius = 0.1, velocity = {1, 2, 0} }\n"
	         "local b = sphere { radius = 0.1, position = {5, 0, 0}, velocity = {1, 2, 0} }\n"
	         "on_step(function() a.velocity.x = 3 a.position.y = 9 a.angular_velocity.z = 1\n"
	         "  local v, old = b.velocity, b.velocity v.x = 3 b:set_velocity(v) v.x = 4\n"
	         "  state.old = state.old or old.x end)\n"
	         "expect('unchanged', function() return a.velocity == vec3(1, 2, 0) and "
	         "a.angular_velocity == vec3(0, 0, 0) end)\n"
	         "expect('set', function() return b.velocity == vec3(3, 2, 0) end)\n"
	         "expect('does not follow', function() return state.old == 1 end)\n");
	for (int i = 0; i < run.scene.expect_count; i++)
		if (!run.results[i].ok)
			fail_msg("%s: %s", run.results[i].text, run.results[i].message);
	end(&run);
}

static void an_error_in_a_callback_has_its_place_and_a_traceback(void **state)
{
	struct run run;

	(void)state;
	run_text(&run, "world { duration = 1 } sphere { radius = 1 }\n"
	               "local function inner() local x = nil + 1 end\n"
	               "on_step(function(t) inner() end)\n");
	assert_int_equal(run.status, RB_ERR_SCENE);
	assert_string_equal(run.error.text,
	                    "t.lua:2: attempt to perform arithmetic on a nil value");
	assert_non_null(strstr(rb_script_traceback(run.script), "stack traceback:"));
	assert_non_null(strstr(rb_script_traceback(run.script), "t.lua:3:"));
	end(&run);
}

static void mistakes_in_callbacks_are_told(void **state)
{
	static const char *const head = "world { duration = 1 } local f = plane { name = 'f', "
					"point = {0, 0, -9} } local b = sphere { radius = 1 } ";
	static const struct {
		const char *text, *message;
	} cases[] = {
		{"on_step(function() f:set_velocity {0, 0, 1} end)",
	         "t.lua:1: set_velocity: body f is static"},
		{"on_step(function() b:set_velocity(5) end)",
	         "t.lua:1: set_velocity: expected a vector {x, y, z} (got 5)"},
		{"on_step(function() b:set_velocity {0, 0, 0 / 1, 1} end)",
	         "t.lua:1: set_velocity: expected a vector {x, y, z} (got {0, 0, 0, 1})"},
		{"on_step(function() b:apply_force({1, 0, math.huge}) end)",
	         "t.lua:1: apply_force: expected finite numbers (got {1, 0, inf})"},
		{"on_step(function() b:aply_force({1, 0, 0}) end)",
	         "t.lua:1: body #1 has no field 'aply_force' (did you mean 'apply_force'?)"},
		{"on_step(function() sphere { radius = 1 } end)",
	         "t.lua:1: sphere: only while the scene is loaded, not in a callback"},
		{"on_step(function() param('x', 1) end)",
	         "t.lua:1: param: only while the scene is loaded, not in a callback"},
		{"on_step(function() on_step(print) end)",
	         "t.lua:1: on_step: only while the scene is loaded, not in a callback"},
		{"on_step(function() require 'x' end)",
	         "t.lua:1: require: only while the scene is loaded, not in a callback"},
		{"on_frame(function() while true do end end)",
	         "t.lua:1: the script ran longer than 100000 instructions (--trust lifts this)"},
		{"expect('e', function() b:set_velocity {1, 1, 1} end)",
	         "t.lua:1: set_velocity: only in on_step, on_frame, on_collision and "
	         "on_transition"},
		{"expect('e', function() return 1 end)",
	         "t.lua:1: expect 'e': the function must return a boolean, or measured and bound "
	         "(got 1 and nothing)"},
		{"expect_always('e', function() return 'x' end)",
	         "t.lua:1: expect_always 'e': the function must return a boolean, or measured and "
	         "bound (got the text 'x' and nothing)"},
		{"on_step(function() b.position = {0, 0, 0} end)",
	         "t.lua:1: a body's 'position' can't be assigned: call body:set_position(p) in a "
	         "callback"},
		{"on_frame(function() error(b) end)", "t.lua:1: body #1"},
	};
	char text[400];

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		snprintf(text, sizeof text, "%s%s", head, cases[i].text);
		must_end_with(text, cases[i].message);
	}
}

static void expectations_are_measured_against_their_bounds(void **state)
{
	struct run run;

	(void)state;
	must_run(&run,
	         "world { duration = 1, frame_rate = 10 } sphere { radius = 1 }\n"
	         "expect('holds', function() return 1, 2 end)\n"
	         "expect('fails', function() return 3, 2 end)\n"
	         "expect('is no number', function() return 0 / 0, 2 end)\n"
	         "expect('false', function() return false end)\n"
	         "expect_always('always', function() return time(), 0.55 end)\n"
	         "expect_always('ever', function() return true end)\n"
	         "expect_always('worst', function() return 0.5 - math.abs(time() - 0.3), 1 end)\n");
	assert_true(run.results[0].ok && run.results[0].has_numbers);
	assert_near(run.results[0].measured, 1, 0);
	assert_near(run.results[0].bound, 2, 0);
	assert_int_equal(run.results[0].line, 2);
	assert_string_equal(run.results[0].message, "");
	assert_false(run.results[1].ok);
	assert_string_equal(run.results[1].message, "measured 3, bound 2");
	assert_false(run.results[2].ok);
	assert_false(run.results[3].ok || run.results[3].has_numbers);
	assert_string_equal(run.results[3].message, "is false");
	assert_true(run.results[4].always);
	assert_false(run.results[4].ok);
	assert_near(run.results[4].failed_s, 0.6, 1e-12);
	assert_near(run.results[4].measured, 1, 1e-12); /* the worst, not the first */
	assert_non_null(strstr(run.results[4].message, "at t = 0.6 s"));
	assert_true(run.results[5].ok && isnan(run.results[5].failed_s));
	assert_true(run.results[6].ok);
	assert_near(run.results[6].measured, 0.5, 1e-12);
	end(&run);
}

static void a_broken_expectation_does_not_cost_the_others(void **state)
{
	struct run run;

	(void)state;
	run_text(&run, "world { duration = 0.1 } sphere { radius = 1 }\n"
	               "expect('before', function() return true end)\n"
	               "expect('breaks', function() return nil + 1 end)\n"
	               "expect('of no type', function() return 'x' end)\n"
	               "expect('after', function() return 1, 2 end)\n");
	assert_int_equal(run.status, RB_ERR_SCENE);
	assert_string_equal(run.error.text,
	                    "t.lua:3: attempt to perform arithmetic on a nil value");
	assert_non_null(strstr(rb_script_traceback(run.script), "t.lua:3:"));
	assert_true(run.results[0].ok && run.results[3].ok);
	assert_false(run.results[1].ok || run.results[2].ok);
	assert_string_equal(run.results[1].message, run.error.text);
	assert_non_null(strstr(run.results[2].message, "expect 'of no type'"));
	assert_near(run.results[3].measured, 1, 0);
	end(&run);
}

static void a_reference_can_be_used_by_expects(void **state)
{
	struct run run;

	(void)state;
	must_run(&run,
	         "world { duration = 1 } local b = sphere { radius = 1, velocity = {2, 0, 0} }\n"
	         "local exact = reference(function(t) return { b = { position = vec3(2 * t, 0, 0) "
	         "} } end)\n"
	         "expect('where it should be', function() return (b.position - "
	         "exact(time()).b.position):length(), 1e-12 end)\n");
	assert_true(run.results[0].ok);
	end(&run);
}

static void random_numbers_in_callbacks_repeat_from_run_to_run(void **state)
{
	static const char text[] =
		"world { duration = 0.5, seed = 5 } local b = sphere { radius = 1, mass = 1 }\n"
		"on_step(function() b:apply_impulse({math.random() - 0.5, math.random(), 0}) "
		"end)\n";
	struct run first, second;

	(void)state;
	must_run(&first, text);
	must_run(&second, text);
	assert_true(rb_world_hash(first.world) == rb_world_hash(second.world));
	end(&first);
	end(&second);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_scene_without_callbacks_has_no_hooks),
		cmocka_unit_test(on_step_and_on_frame_come_on_their_grids),
		cmocka_unit_test(a_collision_is_told_once_with_its_numbers),
		cmocka_unit_test(handles_change_bodies_in_callbacks),
		cmocka_unit_test(vectors_of_handles_are_copies),
		cmocka_unit_test(an_error_in_a_callback_has_its_place_and_a_traceback),
		cmocka_unit_test(mistakes_in_callbacks_are_told),
		cmocka_unit_test(expectations_are_measured_against_their_bounds),
		cmocka_unit_test(a_broken_expectation_does_not_cost_the_others),
		cmocka_unit_test(a_reference_can_be_used_by_expects),
		cmocka_unit_test(random_numbers_in_callbacks_repeat_from_run_to_run),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
