/* SPDX-License-Identifier: MIT */
/* src/script/shots, moment and rb_script_add_cameras: cameras with functions of time, over frames; files of cameras */
#include "own_folder.h"

#include <rbsim/frame.h>
#include <rbsim/model.h>
#include <rbsim/world.h>

#include "base/memory.h"
#include "flow/schedule.h"
#include "script/hooks.h"
#include "script/load.h"
#include "script/shots.h"

enum { BODIES_MAX = 4 };

/* A scene that is loaded and sealed, and a frame of it made by hand. */
struct stage {
	struct rb_script *script;
	struct rb_scene scene;
	struct rb_model *model;
	struct rb_mistakes mistakes;
	struct rb_error error;
	struct rb_frame frame;
	double position[3 * BODIES_MAX], orientation[4 * BODIES_MAX], velocity[3 * BODIES_MAX],
		angular_velocity[3 * BODIES_MAX];
	struct rb_frame_shot shot;
};

static void set_up(struct stage *stage, const char *text)
{
	const struct rb_source_file file = {
		.name = "t.lua", .text = text, .size_bytes = strlen(text)};
	const struct rb_script_options options = {
		.path = "t.lua", .files = &file, .file_count = 1, .callback_instructions = 100000};
	struct rb_error err;

	*stage = (struct stage){0};
	assert_ok(rb_script_load(&stage->script, &stage->scene, &stage->mistakes, &options, &err));
	assert_ok(rb_model_create(&stage->model, &stage->scene, NULL, &err));
	assert_true(stage->model->body_count <= BODIES_MAX);
	for (int i = 0; i < BODIES_MAX; i++)
		stage->orientation[4 * i] = 1;
	stage->frame = (struct rb_frame){.body_count = stage->model->body_count,
	                                 .position = stage->position,
	                                 .orientation = stage->orientation,
	                                 .velocity = stage->velocity,
	                                 .angular_velocity = stage->angular_velocity};
}

static void lower(struct stage *stage)
{
	rb_model_destroy(stage->model);
	rb_script_destroy(stage->script);
	rb_scene_release(&stage->scene);
	rb_mistakes_release(&stage->mistakes);
}

static enum rb_status shoot(struct stage *stage, int camera)
{
	return rb_script_shot(stage->script, stage->model, &stage->scene.cameras[camera],
	                      &stage->frame, &stage->shot, &stage->error);
}

static void must_shoot(struct stage *stage, int camera)
{
	if (shoot(stage, camera) != RB_OK)
		fail_msg("%s", stage->error.text);
}

static void assert_at(rb_vec3 v, double x, double y, double z)
{
	assert_near(v.x, x, 1e-14);
	assert_near(v.y, y, 1e-14);
	assert_near(v.z, z, 1e-14);
}

static void only_what_is_a_function_is_asked_for(void **state)
{
	struct stage it;

	(void)state;
	set_up(&it, "world { duration = 1 } sphere { radius = 1 }\n"
	            "camera { position = function(t) return {t, 2, 3} end }\n"
	            "camera { position = {1, 2, 3} }\n"
	            "camera { look_at = function(t) return vec3(0, t, 0) end,\n"
	            "         up = function(t) return {0, 0, 2} end,\n"
	            "         text = {'constant', function(t) return t end, function(t) return "
	            "('\\u{20ac}'):rep(99) end} }");
	assert_true(rb_camera_has_functions(&it.scene.cameras[0]));
	assert_false(rb_camera_has_functions(&it.scene.cameras[1]));
	assert_true(rb_camera_has_functions(&it.scene.cameras[2]));
	it.frame.time_s = 0.25;
	it.shot = (struct rb_frame_shot){7, 8, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}, false, 1, {""}};
	must_shoot(&it, 0);
	assert_at(it.shot.position, 0.25, 2, 3);
	assert_at(it.shot.look_at, 2, 2, 2);
	assert_at(it.shot.up, 3, 3, 3);
	assert_int_equal(it.shot.camera, 7);
	assert_int_equal(it.shot.picture, 8);
	must_shoot(&it, 2);
	assert_at(it.shot.position, 0.25, 2, 3);
	assert_at(it.shot.look_at, 0, 0.25, 0);
	assert_at(it.shot.up, 0, 0, 2);
	assert_string_equal(it.shot.text[0], "");
	assert_string_equal(it.shot.text[1], "0.25");
	/* cut between two characters of three bytes */
	assert_int_equal(strlen(it.shot.text[2]), 3 * ((RB_CAMERA_TEXT_SIZE - 1) / 3));
	lower(&it);
}

/* A quarter turn about z. */
static void put_turn(double *orientation)
{
	orientation[0] = orientation[3] = sqrt(0.5);
	orientation[1] = orientation[2] = 0;
}

static void handles_show_the_frame_that_is_drawn(void **state)
{
	struct stage it;

	(void)state;
	set_up(&it,
	       "world { duration = 1 }\n"
	       "plane { name = 'floor', point = {0, 0, -5} }\n"
	       "local b = sphere { name = 'b', radius = 1, mass = 2, inertia = {1, 2, 3},\n"
	       "                   position = {9, 9, 9}, velocity = {7, 0, 0} }\n"
	       "camera { position = function() return b.position end,\n"
	       "         look_at = function() return b.point({1, 0, 0}) end,\n"
	       "         up = function() return b.velocity end }\n"
	       "camera { position = function() return b.angular_velocity end,\n"
	       "         look_at = function() return b.momentum end,\n"
	       "         up = function() return b.angular_momentum end }\n"
	       "camera { position = function() return {b.kinetic_energy, b.mass, time()} end,\n"
	       "         look_at = function() local q = b.orientation return {q[1], q[4], "
	       "energy()} end,\n"
	       "         up = function() return momentum() + angular_momentum() end }\n"
	       "camera { look_at = function() return body 'floor'.position + body 'floor'.velocity "
	       "end }");
	it.frame.time_s = 0.5;
	memcpy(it.position, (double[]){1, 2, 3}, sizeof(double[3]));
	memcpy(it.velocity, (double[]){0, 4, 0}, sizeof(double[3]));
	memcpy(it.angular_velocity, (double[]){1, 1, 1}, sizeof(double[3]));
	put_turn(it.orientation);
	it.frame.numbers.kinetic_energy = 10;
	it.frame.numbers.potential_energy = -3;
	it.frame.numbers.momentum = (rb_vec3){1, 2, 3};
	it.frame.numbers.angular_momentum = (rb_vec3){10, 20, 30};
	must_shoot(&it, 0);
	assert_at(it.shot.position, 1, 2, 3);
	assert_at(it.shot.look_at, 1, 3, 3);
	assert_at(it.shot.up, 0, 4, 0);
	must_shoot(&it, 1);
	assert_at(it.shot.position, 1, 1, 1);
	assert_at(it.shot.look_at, 0, 8, 0);
	/* turned by a quarter, the moments about x and y have changed places: L = (2, 1, 3) + r x p */
	assert_at(it.shot.up, 2 - 24, 1, 3 + 8);
	must_shoot(&it, 2);
	assert_at(it.shot.position, 0.5 * 2 * 16 + 0.5 * 6, 2, 0.5);
	assert_at(it.shot.look_at, sqrt(0.5), sqrt(0.5), 7);
	assert_at(it.shot.up, 11, 22, 33);
	must_shoot(&it, 3);
	assert_at(it.shot.look_at, 0, 0, -5);
	lower(&it);
}

static void what_cannot_turn_shows_its_orientation_of_the_start(void **state)
{
	struct stage it;

	(void)state;
	set_up(&it, "world { duration = 1 }\n"
	            "local b = sphere { radius = 1, orientation = {axis = {0, 0, 1}, angle = "
	            "deg(90)} }\n"
	            "camera { position = function() return b.point({1, 0, 0}) end,\n"
	            "         look_at = function() return b.angular_velocity end }");
	assert_false(it.model->features & RB_FEATURE_ROTATION);
	it.frame.orientation = it.frame.angular_velocity = NULL;
	it.position[0] = 3;
	must_shoot(&it, 0);
	assert_at(it.shot.position, 3, 1, 0);
	assert_at(it.shot.look_at, 0, 0, 0);
	lower(&it);
}

static void a_column_that_a_frame_lacks_is_told_by_name(void **state)
{
	struct stage it;

	(void)state;
	set_up(&it, "world { duration = 1 }\n"
	            "local b = sphere { radius = 1, angular_velocity = {0, 0, 1} }\n"
	            "camera { name = 'main', position = function() return b.position end,\n"
	            "         look_at = function() return b.velocity end }\n"
	            "camera { up = function() return b.angular_velocity end }\n");
	it.frame.velocity = it.frame.angular_velocity = NULL;
	assert_int_equal(shoot(&it, 0), RB_ERR_SCENE);
	assert_string_equal(it.error.text, "t.lua:4: a body's 'velocity' is not in the frames that "
	                                   "are drawn (see 'fields' of record) "
	                                   "(camera 'main', look_at at t = 0 s)");
	assert_int_equal(shoot(&it, 1), RB_ERR_SCENE);
	assert_string_equal(it.error.text, "t.lua:5: a body's 'angular_velocity' is not in the "
	                                   "frames that are drawn (see 'fields' of "
	                                   "record) (camera of line 5, up at t = 0 s)");
	lower(&it);
}

static void a_frame_goes_before_the_world_that_runs(void **state)
{
	struct stage it;
	struct rb_world *world;
	struct rb_expect_result result;
	struct rb_error err;

	(void)state;
	set_up(&it, "world { duration = 0.1, frame_rate = 10 }\n"
	            "local b = sphere { radius = 1, velocity = {10, 0, 0} }\n"
	            "camera { position = function() return b.position end }\n"
	            "expect('it is where it came to', function() return math.abs(b.position.x - "
	            "1), 1e-9 end)\n");
	const struct rb_world_hooks hooks = rb_script_hooks(it.script);
	const struct rb_world_options options = {0};
	assert_ok(rb_world_create(&world, it.model, &options, &hooks, &err));
	assert_ok(rb_world_step_frame(world, &err));
	it.position[0] = 0.5;
	must_shoot(&it, 0);
	assert_at(it.shot.position, 0.5, 0, 0);
	assert_ok(rb_script_expects(it.script, world, &result, &err));
	assert_true(result.ok);
	rb_world_destroy(world);
	lower(&it);
}

static void a_camera_can_look_and_change_nothing(void **state)
{
	static const struct {
		const char *code, *says;
	} cases[] = {
		{"b:set_velocity({1, 0, 0})",
	         "set_velocity: only in on_step, on_frame, on_collision and on_transition"},
		{"b:apply_impulse({1, 0, 0})", "apply_impulse: only in on_step"},
		{"sphere { radius = 1 }", "sphere: only while the scene is loaded"},
		{"collisions()", "collisions is not available in the function of a camera"},
		{"max_penetration()",
	         "max_penetration is not available in the function of a camera"},
		{"penetration_tolerance()",
	         "penetration_tolerance is not available in the function of a camera"},
		{"body 'bal'", "body: no body is named 'bal' (did you mean 'ball'?)"},
		{"body { radius = 1 }", "body: only while the scene is loaded"},
		{"while true do end", "the script ran longer than 100000 instructions"},
		{"error('not today')",
	         "t.lua:3: not today (camera of line 3, position at t = 2 s)"},
		{"return {1, 2}",
	         "t.lua:3: 'position' must return a finite vector {x, y, z} (got {1, 2})"},
		{"return {1, 2, 0/0}", "'position' must return a finite vector"},
		{"return", "'position' must return a finite vector {x, y, z} (got nothing)"},
	};
	struct stage it;
	char text[400];

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		snprintf(text, sizeof text,
		         "world { duration = 1 } local b = sphere { name = 'ball', radius = 1 }\n"
		         "plane { name = 'else', point = {0, 0, -9} }\n"
		         "camera { position = function(t) if t > 1 then %s end return {t, 0, 0} "
		         "end }\n",
		         cases[i].code);
		set_up(&it, text);
		must_shoot(&it, 0);
		it.frame.time_s = 2;
		assert_int_equal(shoot(&it, 0), RB_ERR_SCENE);
		if (!strstr(it.error.text, cases[i].says))
			fail_msg("'%s' gives '%s'", cases[i].code, it.error.text);
		it.frame.time_s = 0.5; /* and it goes on */
		must_shoot(&it, 0);
		assert_at(it.shot.position, 0.5, 0, 0);
		lower(&it);
	}
}

static void up_without_a_length_is_refused(void **state)
{
	struct stage it;

	(void)state;
	set_up(&it, "world { duration = 1 } sphere { radius = 1 }\n"
	            "camera { up = function() return {0, 0, 0} end }");
	assert_int_equal(shoot(&it, 0), RB_ERR_SCENE);
	assert_non_null(strstr(it.error.text, "'up' must return a vector with a length"));
	lower(&it);
}

static void random_numbers_of_a_camera_follow_from_the_time_alone(void **state)
{
	static const char scene[] =
		"world { duration = 1 } sphere { radius = 1 }\n"
		"camera { position = function() return {math.random(), math.random(), 0} end }\n"
		"camera { look_at = function() return {drawn, 0, 0} end }\n"
		"on_frame(function() drawn = math.random() end)\n";
	struct stage a, b;
	struct rb_error err;

	(void)state;
	set_up(&a, scene);
	set_up(&b, scene);
	a.frame.time_s = 0.25;
	must_shoot(&a, 0);
	const rb_vec3 first = a.shot.position;
	a.frame.time_s = 0.5;
	must_shoot(&a, 0);
	assert_true(a.shot.position.x != first.x && first.x != first.y);
	a.frame.time_s = 0.25;
	must_shoot(&a, 0);
	assert_at(a.shot.position, first.x, first.y, 0);
	/* callbacks draw what they would have drawn without pictures */
	assert_ok(rb_script_on_frame(a.script, NULL, 0, 0, &err));
	assert_ok(rb_script_on_frame(b.script, NULL, 0, 0, &err));
	must_shoot(&a, 1);
	must_shoot(&b, 1);
	assert_true(a.shot.look_at.x == b.shot.look_at.x && a.shot.look_at.x > 0);
	lower(&a);
	lower(&b);
}

/* ---- body "NAME" ---- */

static void a_body_is_found_by_its_name_while_loading_and_later(void **state)
{
	struct stage it;

	(void)state;
	set_up(&it, "world { duration = 1 }\n"
	            "local b = sphere { name = 'ball', radius = 1, position = {1, 2, 3} }\n"
	            "assert(body 'ball' == b and body 'ball'.position.y == 2)\n"
	            "camera { position = function() return body 'ball'.position end, trails = "
	            "{body 'ball'} }\n");
	it.position[2] = 8;
	must_shoot(&it, 0);
	assert_at(it.shot.position, 0, 0, 8);
	assert_int_equal(it.scene.cameras[0].trails[0], 0);
	lower(&it);
}

/* ---- files of cameras ---- */

static const char *put_file(const char *name, const char *text)
{
	static char path[512];

	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
	return path;
}

static const char scene_text[] =
	"world { duration = 1 }\n"
	"height = 4\n"
	"sphere { name = 'ball', radius = 1, position = {1, 2, 3} }\n"
	"camera { name = 'main', position = function(t) return {t, 0, 5} end }\n";

static enum rb_status add(struct stage *stage, const char *path)
{
	return rb_script_add_cameras(stage->script, path, &stage->mistakes, &stage->error);
}

static void cameras_can_be_added_to_a_scene(void **state)
{
	struct stage it;

	(void)state;
	put_file("part.lua", "return { size = {64, 48} }");
	set_up(&it, scene_text);
	if (add(&it,
	        put_file("more.lua",
	                 "#!/usr/bin/rbsim\nlocal part = require 'part'\n"
	                 "local b = body 'ball'\n"
	                 "camera { name = 'side', look_at = b, size = part.size, mount = 'ball',\n"
	                 "         up = function(t) return {0, t, height} end, png = 'f/%d.png' }\n"
	                 "camera { position = function(t) return b.position end }\n")))
		fail_msg("%s", it.error.text);
	assert_int_equal(it.scene.camera_count, 3);
	assert_int_equal(it.scene.file_count, 1);
	assert_int_equal(it.scene.body_count, 1);
	assert_string_equal(it.scene.file, "t.lua");
	const struct rb_camera_def *side = &it.scene.cameras[1];
	assert_string_equal(side->name, "side");
	assert_int_equal(side->line, 4);
	assert_int_equal(side->size_px[1], 48);
	assert_int_equal(side->mount, 0);
	it.frame.time_s = 0.5;
	it.position[0] = 6;
	must_shoot(&it, 0);
	assert_at(it.shot.position, 0.5, 0, 5);
	must_shoot(&it, 1);
	assert_at(it.shot.up, 0, 0.5, 4);
	must_shoot(&it, 2);
	assert_at(it.shot.position, 6, 0, 0);
	lower(&it);
}

/* rbsim render --with leaves out those of the scene first. */
static void names_of_cameras_that_were_left_out_are_free(void **state)
{
	struct stage it;

	(void)state;
	set_up(&it, scene_text);
	assert_int_equal(add(&it, put_file("more.lua", "camera { name = 'main' }")), RB_ERR_SCENE);
	assert_non_null(
		strstr(it.error.text,
	               "more.lua:1: camera 'main': name 'main' is taken by the camera of line 4"));
	assert_int_equal(it.scene.camera_count, 1);
	it.scene.camera_count = 0;
	if (add(&it, put_file("more.lua", "camera { name = 'main' }")))
		fail_msg("%s", it.error.text);
	assert_int_equal(it.scene.camera_count, 1);
	lower(&it);
}

static void a_file_of_cameras_adds_nothing_else(void **state)
{
	static const struct {
		const char *code, *says;
	} cases[] = {
		{"sphere { radius = 1 }", "sphere: not here: this file can only add cameras"},
		{"plane {}", "plane: not here"},
		{"world { duration = 2 }", "world: not here"},
		{"material { name = 'm' }", "material: not here"},
		{"record { every = 2 }", "record: not here"},
		{"spring { a = 'ball', b = 'ball', stiffness = 1 }", "spring: not here"},
		{"drag { linear = 1 }", "drag: not here"},
		{"field(function() end)", "field: not here"},
		{"param('e', 1, 'x')", "param: not here"},
		{"expect('x', function() return true end)", "expect: not here"},
		{"reference(function() end)", "reference: not here"},
		{"on_step(function() end)", "on_step: not here"},
		{"box { size = {1, 1, 1} }", "box: not here"},
		{"body { shapes = {} }", "body: not here"},
		{"body 'bal'", "body: no body is named 'bal' (did you mean 'ball'?)"},
		{"body 'ball':set_velocity({1, 0, 0})", "set_velocity: only in on_step"},
		{"require 'nothing'",
	         "require 'nothing': there is no such file in the scene's folder"},
		{"kamera {}",
	         "attempt to call a nil value (global 'kamera') (did you mean 'camera'?)"},
		{"camera { widht = 3 }", "camera: unknown key 'widht'"},
		{"camera = 3", "'camera' is a call of the scene language: write camera { ... }"},
		{"while true do end", "the script ran longer than"},
		{"camera {", "unexpected symbol near <eof>"},
	};
	struct stage it;
	char text[200];

	(void)state;
	set_up(&it, scene_text);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		snprintf(text, sizeof text, "camera { name = 'new' }\n%s", cases[i].code);
		const int mistakes = it.mistakes.count;
		assert_int_equal(add(&it, put_file("more.lua", text)), RB_ERR_SCENE);
		char *line = strstr(it.error.text, "more.lua:2: ");
		if (!line || !strstr(line, cases[i].says))
			fail_msg("'%s' gives '%s'", cases[i].code, it.error.text);
		assert_int_equal(it.mistakes.count, mistakes + 1);
		assert_int_equal(it.scene.camera_count, 1);
		assert_int_equal(it.scene.body_count, 1);
		assert_int_equal(it.scene.file_count, 1);
		assert_int_equal(it.scene.hooks, 0);
		if (strstr(cases[i].code, "camera =")) {
			/* the global is gone for good: a fresh scene */
			lower(&it);
			set_up(&it, scene_text);
		}
	}
	assert_int_equal(add(&it, put_file("more.lua", "camera { name = 'new' }")), RB_OK);
	must_shoot(&it, 0);
	lower(&it);
}

static void a_file_of_cameras_that_cannot_be_read_is_told(void **state)
{
	struct stage it;

	(void)state;
	set_up(&it, scene_text);
	assert_int_equal(add(&it, "none.lua"), RB_ERR_INPUT);
	assert_string_equal(it.error.text, "cannot read 'none.lua': No such file or directory");
	assert_int_equal(add(&it, put_file("more.lua", "\x89HDF\r\n\x1a\n")), RB_ERR_INPUT);
	assert_non_null(strstr(it.error.text, "is not a file of cameras: it begins with bytes"));
	assert_int_equal(it.scene.camera_count, 1);
	must_shoot(&it, 0);
	lower(&it);
}

static void no_memory_leaves_the_scene_as_it_was(void **state)
{
	struct stage it;
	int successes = 0;

	(void)state;
	const char *path = put_file(
		"more.lua", "camera { name = 'a' } camera { name = 'b', position = function(t) "
			    "return {t, 0, 0} end }");
	for (uint64_t k = 1; successes < 3 && k < 500; k++) {
		set_up(&it, scene_text);
		rb_memory_fail_at(k);
		const enum rb_status status = add(&it, path);
		const enum rb_status shot = shoot(&it, 0);
		rb_memory_fail_at(0);
		assert_true(status == RB_OK || status == RB_ERR_MEMORY);
		assert_true(shot == RB_OK || shot == RB_ERR_MEMORY);
		assert_int_equal(it.scene.camera_count, status == RB_OK ? 3 : 1);
		assert_int_equal(it.scene.file_count, 1);
		assert_string_equal(it.scene.file, "t.lua");
		successes += status == RB_OK && shot == RB_OK;
		must_shoot(&it, 0);
		lower(&it);
	}
	assert_int_equal(successes, 3);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(only_what_is_a_function_is_asked_for),
		cmocka_unit_test(handles_show_the_frame_that_is_drawn),
		cmocka_unit_test(what_cannot_turn_shows_its_orientation_of_the_start),
		cmocka_unit_test(a_column_that_a_frame_lacks_is_told_by_name),
		cmocka_unit_test(a_frame_goes_before_the_world_that_runs),
		cmocka_unit_test(a_camera_can_look_and_change_nothing),
		cmocka_unit_test(up_without_a_length_is_refused),
		cmocka_unit_test(random_numbers_of_a_camera_follow_from_the_time_alone),
		cmocka_unit_test(a_body_is_found_by_its_name_while_loading_and_later),
		cmocka_unit_test(cameras_can_be_added_to_a_scene),
		cmocka_unit_test(names_of_cameras_that_were_left_out_are_free),
		cmocka_unit_test(a_file_of_cameras_adds_nothing_else),
		cmocka_unit_test(a_file_of_cameras_that_cannot_be_read_is_told),
		cmocka_unit_test(no_memory_leaves_the_scene_as_it_was),
	};

	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
