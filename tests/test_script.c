/* SPDX-License-Identifier: MIT */
/* src/script: a scene's text to a struct rb_scene, and every mistake in it */
#include "support.h"

#include <dirent.h>

#include <rbsim/model.h>

#include "base/memory.h"
#include "script/load.h"
#include "script/pattern.h"

struct loaded {
	struct rb_script *script;
	struct rb_scene scene;
	struct rb_mistakes mistakes;
	struct rb_error error;
	enum rb_status status;
};

static const char *const shipped = "lua";

static void load_with(struct loaded *loaded, struct rb_script_options *options)
{
	*loaded = (struct loaded){0};
	options->lua_folders = &shipped;
	options->lua_folder_count = 1;
	loaded->status = rb_script_load(&loaded->script, &loaded->scene, &loaded->mistakes, options,
	                                &loaded->error);
}

static void load_text(struct loaded *loaded, const char *text)
{
	const struct rb_source_file file = {
		.name = "t.lua", .text = text, .size_bytes = strlen(text)};
	struct rb_script_options options = {.path = "t.lua", .files = &file, .file_count = 1};

	load_with(loaded, &options);
}

static void load_params(struct loaded *loaded, const char *text, const char *const *params,
                        int count)
{
	const struct rb_source_file file = {
		.name = "t.lua", .text = text, .size_bytes = strlen(text)};
	struct rb_script_options options = {.path = "t.lua",
	                                    .files = &file,
	                                    .file_count = 1,
	                                    .params = params,
	                                    .param_count = count};

	load_with(loaded, &options);
}

static void unload(struct loaded *loaded)
{
	rb_script_destroy(loaded->script);
	rb_scene_release(&loaded->scene);
	rb_mistakes_release(&loaded->mistakes);
}

static void must_load(struct loaded *loaded, const char *text)
{
	load_text(loaded, text);
	if (loaded->status != RB_OK)
		fail_msg("%s", loaded->error.text);
}

static void the_example_of_the_manual_becomes_a_scene(void **state)
{
	struct loaded it;

	(void)state;
	must_load(&it, "local e = param('e', 0.8, 'restitution of the ball', {min = 0, max = 1})\n"
	               "world { title = 'A bouncing ball', duration = 10, frame_rate = 60, gravity "
	               "= {0, 0, -9.81} }\n"
	               "local rubber = material { name = 'rubber', density = 1100, friction = 0.6, "
	               "restitution = e }\n"
	               "plane { normal = {0, 0, 1}, material = rubber, texture = 'checker' }\n"
	               "local ball = sphere { name = 'ball', radius = 0.1, position = {0, 0, 2}, "
	               "material = rubber }\n"
	               "camera { name = 'main', position = {3, -4, 2}, look_at = ball, size = "
	               "{1280, 720}, video = 'b.mp4' }\n"
	               "expect('above', function() return ball.position.z >= 0.1 end)\n");
	assert_string_equal(it.scene.world.title, "A bouncing ball");
	assert_near(it.scene.world.duration_s, 10, 0);
	assert_near(it.scene.world.gravity.z, -9.81, 0);
	assert_int_equal(it.scene.body_count, 2);
	assert_int_equal(it.scene.bodies[0].shape.kind, RB_SHAPE_PLANE);
	assert_true(it.scene.bodies[0].is_static);
	assert_int_equal(it.scene.bodies[1].shape.kind, RB_SHAPE_SPHERE);
	assert_string_equal(it.scene.bodies[1].name, "ball");
	assert_int_equal(it.scene.bodies[1].line, 5);
	assert_string_equal(it.scene.bodies[1].texture, "beachball");
	assert_near(it.scene.bodies[1].position.z, 2, 0);
	assert_int_equal(it.scene.bodies[1].material, 1);
	assert_near(it.scene.materials[1].restitution, 0.8, 0);
	assert_int_equal(it.scene.camera_count, 1);
	assert_int_equal(it.scene.cameras[0].look_at.source, RB_CAMERA_BODY);
	assert_int_equal(it.scene.cameras[0].look_at.body, 1);
	assert_int_equal(it.scene.expect_count, 1);
	assert_int_equal(it.scene.expects[0].line, 7);
	assert_int_equal(it.scene.param_count, 1);
	assert_string_equal(it.scene.params[0].value_text, "0.8");
	assert_int_equal(it.scene.file_count, 1);
	assert_int_equal((int)strlen(it.scene.files[0].sha256), 64);
	unload(&it);
}

static void every_key_of_a_body_arrives(void **state)
{
	struct loaded it;

	(void)state;
	must_load(
		&it,
		"world { duration = 1, rollback = 'global', method = 'classic', seed = 42, "
		"tolerance = 1e-5, time_step = 1e-3 }\n"
		"material { name = 'm' } contact_pair('m', 'm', { friction = 0.25 })\n"
		"sphere { radius = 2, mass = 3, center_of_mass = {0.1, 0, 0}, inertia = {{2, 0.1, "
		"0}, {0.1, 3, 0}, {0, 0, 4}},\n"
		"  orientation = {axis = {0, 0, 2}, angle = deg(90)}, velocity = vec3(1, 2, 3), "
		"angular_velocity = {4, 5, 6},\n"
		"  group = 'a', collides_with = {'b', 'c'}, color = '#ff0080', visible = false, "
		"material = 'm',\n"
		"  forces = {{vector = {1, 0, 0}, point = {0, 1, 0}, start = 1, duration = 2, "
		"frame = 'body'},\n"
		"            {direction = {0, 0, 2}, magnitude = 5}} }\n"
		"plane { normal = {1, 0, 0}, point = {5, 0, 0}, size = {2, 3}, axis = {0, 0, 1} }\n"
		"sphere { radius = 1, static = true, orientation = {1.0005, 0, 0, 0} }\n");
	const struct rb_body_def *body = &it.scene.bodies[0];
	assert_int_equal(it.scene.world.rollback, RB_ROLLBACK_GLOBAL);
	assert_int_equal(it.scene.world.method, RB_METHOD_CLASSIC);
	assert_true(it.scene.world.seed == 42);
	assert_near(it.scene.contact_pairs[0].friction, 0.25, 0);
	assert_true(isnan(it.scene.contact_pairs[0].restitution));
	assert_near(body->mass, 3, 0);
	assert_true(isnan(body->density));
	assert_near(body->center_of_mass.x, 0.1, 0);
	assert_non_null(body->inertia);
	assert_near(body->inertia->m[0][1], 0.1, 0);
	assert_near(body->orientation.w, sqrt(0.5), 1e-15);
	assert_near(body->orientation.z, sqrt(0.5), 1e-15);
	assert_near(body->velocity.y, 2, 0);
	assert_near(body->angular_velocity.z, 6, 0);
	assert_near(body->color[2], 128 / 255.0, 1e-15);
	assert_false(body->visible);
	assert_string_equal(it.scene.groups[body->group], "a");
	assert_true(body->filters);
	assert_true(body->collides_with == 6);
	assert_int_equal(body->force_count, 2);
	assert_int_equal(it.scene.forces[0].frame, RB_FORCE_BODY);
	assert_near(it.scene.forces[0].duration_s, 2, 0);
	assert_near(it.scene.forces[1].vector.z, 5, 1e-15);
	assert_true(isnan(it.scene.forces[1].point.x));
	assert_true(isinf(it.scene.forces[1].duration_s));
	assert_int_equal(it.scene.bodies[1].shape.kind, RB_SHAPE_RECTANGLE);
	assert_near(it.scene.bodies[1].shape.size[1], 3, 0);
	assert_near(it.scene.bodies[1].position.x, 5, 0);
	assert_true(it.scene.bodies[2].is_static);
	assert_near(it.scene.bodies[2].orientation.w, 1, 0); /* close enough to be made unit */
	unload(&it);
}

/* tests/scenes/bad: each file ends in the mistakes that it makes, as `-- expect: :line: what`, all of them in order. */
static int check_bad_scene(const char *path)
{
	struct loaded it;
	struct rb_script_options options = {.path = path};
	int wanted = 0;
	char line[512];

	load_with(&it, &options);
	assert_int_equal(it.status, RB_ERR_SCENE);
	FILE *file = fopen(path, "r");
	assert_non_null(file);
	while (fgets(line, sizeof line, file)) {
		static const char mark[] = "-- expect: ";
		char full[800];
		if (strncmp(line, mark, sizeof mark - 1) != 0)
			continue;
		line[strcspn(line, "\n")] = '\0';
		snprintf(full, sizeof full, "%s%s", path, line + sizeof mark - 1);
		if (wanted >= it.mistakes.count)
			fail_msg("%s: missing '%s'", path, full);
		assert_string_equal(it.mistakes.line[wanted], full);
		wanted++;
	}
	fclose(file);
	if (wanted == 0 || wanted < it.mistakes.count)
		fail_msg("%s: unexpected '%s'", path, it.mistakes.line[wanted]);
	assert_int_equal(strncmp(it.error.text, it.mistakes.line[0], 100), 0);
	unload(&it);
	return wanted;
}

static void every_mistake_gets_its_message_and_all_of_one_pass_come_together(void **state)
{
	static const char folder[] = "tests/scenes/bad";
	DIR *directory = opendir(folder);
	int files = 0, mistakes = 0;
	const struct dirent *entry;

	(void)state;
	assert_non_null(directory);
	while ((entry = readdir(directory))) {
		char path[300];
		const size_t size = strlen(entry->d_name);
		if (size < 4 || strcmp(entry->d_name + size - 4, ".lua") != 0)
			continue;
		snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
		mistakes += check_bad_scene(path);
		files++;
	}
	closedir(directory);
	assert_true(files >= 20);
	assert_true(mistakes >= 100);
}

static void parameters_take_the_type_of_their_default(void **state)
{
	static const char text[] = "world { duration = 1 }\n"
				   "a = param('a', 0.5, 'h', {min = 0, max = 1}) n = param('n', 5, "
				   "'h') b = param('b', true, 'h')\n"
				   "s = param('s', 'x', 'h', {choices = {'x', 'y'}})\n"
				   "assert(a == 0.75 and math.type(n) == 'integer' and n == 10 and "
				   "b == false and s == 'y')\n";
	static const char *const right[] = {"a=0.1", "n=1e1", "b=false", "s=y", "a=0.75"};
	static const char *const wrong[] = {"a=2", "n=1.5", "b=no", "s=z", "aa=3", "q", "a=nan"};
	struct loaded it;

	(void)state;
	load_params(&it, text, right, 5);
	assert_int_equal(it.status, RB_OK);
	assert_string_equal(it.scene.params[0].default_text, "0.5");
	assert_string_equal(it.scene.params[0].value_text, "0.75");
	assert_int_equal(it.scene.params[1].type, RB_PARAM_INTEGER);
	assert_string_equal(it.scene.params[3].choices, "x, y");
	unload(&it);

	load_params(&it,
	            "local a = param('a', 0.5, 'h', {min = 0, max = 1}) param('n', 5, 'h') "
	            "param('b', true, 'h')\n"
	            "param('s', 'x', 'h', {choices = {'x', 'y'}})\n",
	            wrong, 7);
	assert_int_equal(it.status, RB_ERR_USAGE);
	assert_int_equal(it.mistakes.count, 6);
	assert_string_equal(it.mistakes.line[0], "t.lua: --param a: must be a number (got 'nan')");
	assert_string_equal(it.mistakes.line[1],
	                    "t.lua: --param n: must be a whole number, as its default 5 is one "
	                    "(write 5.0 in the scene for any number) (got '1.5')");
	assert_string_equal(it.mistakes.line[2],
	                    "t.lua: --param b: must be true or false (got 'no')");
	assert_string_equal(it.mistakes.line[3], "t.lua: --param s: must be one of x, y (got 'z')");
	assert_string_equal(it.mistakes.line[4],
	                    "t.lua: --param aa: the scene has no such parameter (did you mean "
	                    "'a'?); it has a, n, b, s");
	assert_string_equal(it.mistakes.line[5], "t.lua: --param 'q': expected NAME=VALUE");
	unload(&it);
}

static void a_parameter_out_of_range_says_what_is_allowed(void **state)
{
	static const char *const given[] = {"e=1.5"};
	struct loaded it;

	(void)state;
	load_params(&it, "param('e', 0.5, 'h', {min = 0, max = 1})", given, 1);
	assert_int_equal(it.status, RB_ERR_USAGE);
	assert_string_equal(it.error.text, "t.lua: --param e: must be in [0, 1] (got '1.5')");
	unload(&it);
}

static void a_missing_scene_is_missing_input(void **state)
{
	struct rb_script_options options = {.path = "/nonexistent/scene.lua"};
	struct loaded it;

	(void)state;
	load_with(&it, &options);
	assert_int_equal(it.status, RB_ERR_INPUT);
	assert_string_equal(it.error.text,
	                    "cannot read '/nonexistent/scene.lua': No such file or directory");
	unload(&it);
	options.path = "/tmp";
	load_with(&it, &options);
	assert_int_equal(it.status, RB_ERR_INPUT);
	unload(&it);
}

static void bytecode_is_refused(void **state)
{
	struct loaded it;

	(void)state;
	load_text(&it, "\x1bLua\x54 not for us");
	assert_int_equal(it.status, RB_ERR_SCENE);
	assert_non_null(strstr(it.error.text, "binary chunk"));
	unload(&it);
}

static void a_first_line_for_the_shell_and_a_byte_order_mark_are_passed_over(void **state)
{
	struct loaded it;

	(void)state;
	load_text(&it, "\xef\xbb\xbf#!/usr/bin/env rbsim\nsphere { radius = 1 }\nerror('here')");
	assert_int_equal(it.status, RB_ERR_SCENE);
	assert_string_equal(it.error.text, "t.lua:3: here");
	unload(&it);
}

/* ---- files beside the scene ---- */

static void put_file(const char *folder, const char *name, const char *text)
{
	char path[512];

	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

enum { PNG_HEAD_SIZE = 33 };

static void put_bytes(const char *folder, const char *name, const void *bytes, size_t size)
{
	char path[512];

	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, size, file), size);
	fclose(file);
}

/* The beginning of a PNG file, as far as a scene looks into it. */
static const unsigned char *png_head(unsigned width, unsigned height)
{
	static unsigned char head[PNG_HEAD_SIZE];

	memcpy(head, "\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR", 16);
	for (int i = 0; i < 4; i++) {
		head[16 + i] = (unsigned char)(width >> (24 - 8 * i));
		head[20 + i] = (unsigned char)(height >> (24 - 8 * i));
	}
	head[24] = 8;
	head[25] = 2;
	return head;
}

static void textures_that_are_no_pictures_are_mistakes(void **state)
{
	static const struct {
		unsigned width, height;
		size_t size;
		const char *says;
	} cases[] = {
		{60000, 60000, PNG_HEAD_SIZE,
	         "'texture' must have from 1 to 8192 pixels a side ('x.png' has 60000 x 60000)"},
		{8192, 8193, PNG_HEAD_SIZE, "'x.png' has 8192 x 8193"},
		{0, 5, PNG_HEAD_SIZE, "'x.png' has 0 x 5"},
		{5, 0, PNG_HEAD_SIZE, "'x.png' has 5 x 0"},
		{1u << 31, 5, PNG_HEAD_SIZE, "'x.png' has 2147483648 x 5"},
		{5, 5, PNG_HEAD_SIZE - 1,
	         "must be a whole PNG file ('x.png' is damaged or cut off)"},
		{5, 5, 8, "must be a whole PNG file"},
		{5, 5, 7, "must be a PNG file ('x.png' is not one: it begins with other bytes)"},
		{5, 5, 0, "must be a PNG file"},
		{8192, 1, PNG_HEAD_SIZE, NULL},
	};
	static const char text[] = "world { duration = 1 }\n"
				   "material { name = 'm', texture = 'x.png' }\n"
				   "sphere { name = 's', radius = 1, texture = 'x.png' }\n";
	char folder[256], path[600];
	struct rb_script_options options = {.path = path};
	struct loaded it;

	(void)state;
	support_folder(folder);
	snprintf(path, sizeof path, "%s/t.lua", folder);
	put_file(folder, "t.lua", text);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const unsigned char *const head = png_head(cases[i].width, cases[i].height);
		const struct rb_source_file stored[2] = {
			{.name = "t.lua", .text = text, .size_bytes = sizeof text - 1},
			{.name = "x.png", .text = (const char *)head, .size_bytes = cases[i].size}};
		struct rb_script_options again = {.path = path, .files = stored, .file_count = 2};
		put_bytes(folder, "x.png", head, cases[i].size);
		for (int k = 0; k < 2; k++) { /* from the disk, and as they were stored */
			load_with(&it, k == 0 ? &options : &again);
			assert_int_equal(it.status, cases[i].says ? RB_ERR_SCENE : RB_OK);
			assert_int_equal(it.mistakes.count, cases[i].says ? 2 : 0);
			assert_int_equal(it.scene.file_count, cases[i].says ? 1 : 2);
			if (cases[i].says &&
			    (!strstr(it.mistakes.line[0], ":2: material 'm': 'texture'") ||
			     !strstr(it.mistakes.line[1], ":3: sphere 's': 'texture'") ||
			     !strstr(it.mistakes.line[1], cases[i].says)))
				fail_msg("case %zu gives '%s'", i, it.mistakes.line[1]);
			unload(&it);
		}
	}
	snprintf(path, sizeof path, "%s/x.png", folder);
	assert_int_equal(truncate(path, ((off_t)64 << 20) + 1), 0);
	snprintf(path, sizeof path, "%s/t.lua", folder);
	load_with(&it, &options);
	assert_non_null(strstr(it.error.text, "x.png': it has more than 64 MiB"));
	unload(&it);
	snprintf(path, sizeof path, "rm '%s/x.png' && mkfifo '%s/x.png'", folder, folder);
	assert_int_equal(system(path), 0);
	snprintf(path, sizeof path, "%s/t.lua", folder);
	load_with(&it, &options);
	assert_non_null(strstr(it.error.text, "x.png': it is not a regular file"));
	unload(&it);
	const struct rb_source_file alone = {
		.name = "t.lua", .text = text, .size_bytes = sizeof text - 1};
	struct rb_script_options lost = {.path = path, .files = &alone, .file_count = 1};
	load_with(&it, &lost);
	assert_non_null(
		strstr(it.error.text,
	               "'texture': there is no file 'x.png' among those stored with the scene"));
	unload(&it);
	snprintf(path, sizeof path, "rm -r '%s'", folder);
	assert_int_equal(system(path), 0);
}

static void requires_come_from_beside_the_scene_and_are_kept(void **state)
{
	char folder[256], path[300], link[300];
	struct rb_script_options options = {.path = path};
	struct loaded it;

	(void)state;
	support_folder(folder);
	snprintf(path, sizeof path, "%s/scene.lua", folder);
	put_file(folder, "part.lua", "return { radius = 2 }");
	put_bytes(folder, "skin.png", png_head(8, 8), PNG_HEAD_SIZE);
	put_file(folder, "scene.lua",
	         "local part = require 'part'\nassert(require 'part' == part)\n"
	         "require 'rbsim.palette'\n"
	         "material { name = 'worn', texture = 'skin.png' }\n"
	         "sphere { radius = part.radius, texture = 'skin.png' }\n");
	load_with(&it, &options);
	if (it.status != RB_OK)
		fail_msg("%s", it.error.text);
	assert_int_equal(it.scene.file_count, 5); /* and rbsim.check, which the palette requires */
	assert_string_equal(it.scene.files[0].name, "scene.lua");
	assert_string_equal(it.scene.files[1].name, "part");
	assert_string_equal(it.scene.files[1].text, "return { radius = 2 }");
	assert_string_equal(it.scene.files[2].name, "rbsim.palette");
	assert_string_equal(it.scene.files[4].name, "skin.png");
	assert_int_equal(it.scene.files[4].size_bytes, PNG_HEAD_SIZE);
	assert_memory_equal(it.scene.files[4].text, png_head(8, 8), PNG_HEAD_SIZE);
	assert_string_equal(it.scene.bodies[0].texture, "skin.png");
	assert_string_equal(it.scene.materials[1].texture, "skin.png");
	/* the same scene again from what was kept, with no file on disk */
	struct rb_script_options stored = {
		.path = "again.lua", .files = it.scene.files, .file_count = it.scene.file_count};
	struct loaded again;
	load_with(&again, &stored);
	assert_int_equal(again.status, RB_OK);
	assert_int_equal(again.scene.file_count, 5);
	for (int i = 0; i < 5; i++)
		assert_string_equal(again.scene.files[i].sha256, it.scene.files[i].sha256);
	unload(&again);
	unload(&it);

	/* a link that leads out of the folder is as good as none */
	snprintf(link, sizeof link, "%s/out.lua", folder);
	assert_int_equal(symlink("/etc/passwd", link), 0);
	put_file(folder, "scene.lua", "require 'out'");
	load_with(&it, &options);
	assert_int_equal(it.status, RB_ERR_SCENE);
	assert_non_null(strstr(it.error.text,
	                       "require 'out': there is no such file in the scene's folder"));
	unload(&it);

	put_file(folder, "a.lua", "require 'b'");
	put_file(folder, "b.lua", "require 'a'");
	put_file(folder, "scene.lua", "require 'a'");
	load_with(&it, &options);
	assert_int_equal(it.status, RB_ERR_SCENE);
	assert_non_null(strstr(it.error.text, "in a circle"));
	unload(&it);
}

static void a_call_that_is_assigned_to_is_a_mistake(void **state)
{
	static const struct {
		const char *text, *message;
	} cases[] = {
		{"world { duration = 1 }\nfunction on_step(t, dt) end",
	         "t.lua:2: 'on_step' is a call of the scene language: write on_step(function(t, "
	         "dt) ... end)"},
		{"world { duration = 1 }\n  sphere { radius = 1 }\nlocal f = sphere\nfunction  "
	         "sphere() end",
	         "t.lua:4: 'sphere' is a call of the scene language: write sphere { ... }"},
		{"-- world = nothing\n\nworld = { duration = 1 }",
	         "t.lua:3: 'world' is a call of the scene language: write world { ... }"},
		{"world { duration = 1 }\n_G['sphere'] = 5\n",
	         "t.lua: 'sphere' is a call of the scene language: write sphere { ... }"},
		{"world = { duration = 1 }\nworld()",
	         "t.lua:1: 'world' is a call of the scene language: write world { ... }"},
	};
	struct loaded it;

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		load_text(&it, cases[i].text);
		assert_int_equal(it.status, RB_ERR_SCENE);
		assert_string_equal(it.error.text, cases[i].message);
		unload(&it);
	}
	must_load(&it, "local world, plane = world, 5 world { duration = 1 } box = 3\n"
	               "local t = { sphere = 1 } t.sphere = 2\n"
	               "do local function on_step() end on_step() end\n");
	unload(&it);
}

static void a_mistake_in_a_helper_shows_the_line_of_the_scene(void **state)
{
	struct loaded it;

	(void)state;
	load_text(&it, "local chain = require 'rbsim.chain'\n\nchain.row { count = 2, keys = { "
	               "radius = 1, raduis = 3 } }");
	/* stored files have no shipped helpers: only what is stored */
	assert_int_equal(it.status, RB_ERR_SCENE);
	assert_string_equal(it.error.text,
	                    "t.lua:1: require 'rbsim.chain': no such helper is shipped with rbsim");
	unload(&it);

	char folder[256], path[300];
	struct rb_script_options options = {.path = path};
	support_folder(folder);
	snprintf(path, sizeof path, "%s/scene.lua", folder);
	put_file(folder, "scene.lua",
	         "local chain = require 'rbsim.chain'\n\nchain.row { count = 2, keys = { radius = "
	         "1, raduis = 3 } }\n"
	         "chain.row { count = 0, keys = {} }");
	load_with(&it, &options);
	assert_int_equal(it.status, RB_ERR_SCENE);
	assert_int_equal(it.mistakes.count, 2); /* the same one of two spheres is told once */
	assert_true(rb_pattern_found(it.mistakes.line[0],
	                             "scene%.lua:3: sphere %(in rbsim%.chain:%d+%): unknown key "
	                             "'raduis' %(did you mean"));
	assert_non_null(strstr(
		it.mistakes.line[1],
		"scene.lua:4: chain.row: 'count' must be a whole number, 1 or more (got 0)"));
	unload(&it);
}

/* ---- handles before a run ---- */

static void handles_show_the_initial_values(void **state)
{
	struct loaded it;

	(void)state;
	must_load(&it,
	          "local b = sphere { name = 'b', radius = 1, density = 3 / (4 * math.pi), "
	          "position = {1, 2, 3}, velocity = {2, 0, 0},\n"
	          "  orientation = {axis = {0, 0, 1}, angle = deg(90)}, angular_velocity = {0, 0, "
	          "1} }\n"
	          "local function near(a, b) return math.abs(a - b) < 1e-12 end\n"
	          "assert(b.name == 'b' and b.position == vec3(1, 2, 3) and b.velocity.x == 2)\n"
	          "assert(near(b.mass, 1) and near(b.inertia[1][1], 0.4) and "
	          "near(b.kinetic_energy, 2 + 0.2))\n"
	          "assert(b.momentum.x > 1.99 and near(b.angular_momentum.z, 0.4 - 4))\n"
	          "assert(near(b.point({1, 0, 0}).y, 3) and b.point({1, 0, 0}) == b:point({1, 0, "
	          "0}))\n"
	          "assert(plane { }.mass == math.huge and time() == 0 and b == b and tostring(b) "
	          "== 'body b')\n");
	unload(&it);
}

static void vectors_have_operators(void **state)
{
	struct loaded it;

	(void)state;
	must_load(&it,
	          "local a, b = vec3(1, 2, 3), vec3(3, 4, 12)\n"
	          "assert(a + b == vec3(4, 6, 15) and b - a == vec3(2, 2, 9) and -a == vec3(-1, "
	          "-2, -3))\n"
	          "assert(2 * a == a * 2 and b / 2 == vec3(1.5, 2, 6) and a + {1, 1, 1} == vec3(2, "
	          "3, 4))\n"
	          "assert(b:length() == 13 and a:dot(b) == 47 and a:cross(b) == vec3(12, -3, -2))\n"
	          "assert(a.x == a[1] and a.z == a[3] and tostring(vec3(1, 2, 3.5)) == '{1.0, 2.0, "
	          "3.5}')\n"
	          "assert(math.abs(vec3(0, 3, 4):unit():length() - 1) < 1e-15 and "
	          "math.abs(deg(180) - math.pi) < 1e-15)\n"
	          "a.y = 7 assert(a[2] == 7)\n"
	          "assert(not pcall(function() return a * b end) and not pcall(function() return "
	          "a.w end))\n"
	          "assert(not pcall(function() a.w = 1 end) and not pcall(vec3, 1, 2) and not "
	          "pcall(vec3, '1', 2, 3))\n");
	unload(&it);
}

/* ---- random numbers, order ---- */

static void random_numbers_are_those_of_the_seed(void **state)
{
	static const char draw[] =
		"world { seed = %d }\n"
		"local t = {} for i = 1, 20 do t[i] = math.random(1000) end\n"
		"assert(math.random() < 1 and math.random(3, 3) == 3)\n"
		"assert(not pcall(math.random, 3, 2) and math.type(math.random(0)) == 'integer')\n"
		"sphere { radius = 1, name = table.concat(t, ' ') }\n";
	char text[600], names[3][200];

	(void)state;
	for (int i = 0; i < 3; i++) {
		struct loaded it;
		snprintf(text, sizeof text, draw, i == 2 ? 8 : 7);
		must_load(&it, text);
		snprintf(names[i], sizeof names[i], "%s", it.scene.bodies[0].name);
		unload(&it);
	}
	assert_string_equal(names[0], names[1]);
	assert_string_not_equal(names[0], names[2]);
}

static void the_seed_of_the_command_line_wins(void **state)
{
	static const char text[] =
		"local a = math.random() world { seed = 3 } sphere { radius = 1 + a }";
	const struct rb_source_file file = {
		.name = "t.lua", .text = text, .size_bytes = sizeof text - 1};
	struct rb_script_options options = {
		.path = "t.lua", .files = &file, .file_count = 1, .has_seed = true, .seed = 99};
	struct loaded it;

	(void)state;
	load_with(&it, &options);
	assert_int_equal(it.status, RB_OK);
	assert_true(it.scene.world.seed == 99);
	unload(&it);
}

static void a_refusal_is_expected_with_a_status_there_is(void **state)
{
	static const char *const wrong[] = {"3", "65.5", "0", "'65'", "nil", "1e300"};
	struct loaded it;
	char text[128];

	(void)state;
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		snprintf(text, sizeof text, "world { duration = 1 }\nexpect_refused(%s)", wrong[i]);
		load_text(&it, text);
		assert_int_equal(it.status, RB_ERR_SCENE);
		assert_non_null(strstr(it.error.text, "expected an exit status of rbsim(1) first"));
		unload(&it);
	}
	must_load(&it, "world { duration = 1 }\nexpect_refused(76, 'too deep')");
	assert_int_equal(it.scene.expect_refused, 76);
	assert_string_equal(it.scene.expect_refused_pattern, "too deep");
	unload(&it);
}

static void pairs_has_an_order(void **state)
{
	struct loaded it;

	(void)state;
	must_load(&it, "local function keys(t) local s = {} for k in pairs(t) do s[#s + 1] = "
	               "tostring(k) end return table.concat(s, ' ') end\n"
	               "assert(keys { c = 1, a = 2, [3] = 1, [-1] = 2, [1.5] = 1, b = 3, [true] = "
	               "1 } == '-1 3 1.5 a b c true')\n"
	               "assert(keys { 1, 2, 3 } == '1 2 3' and keys {} == '' and next({}) == nil "
	               "and next { 5 } == 1)\n"
	               "local b, a = sphere { radius = 1, name = 'b' }, sphere { radius = 1, name "
	               "= 'a', position = {9, 0, 0} }\n"
	               "assert(keys { [a] = 1, [b] = 2 } == 'body b body a')\n"
	               "local some, text = {}, '' for i = 1, 9 do some[i] = sphere { radius = 1, "
	               "position = {9 * i, 9, 0} } end\n"
	               "local order = {} for _, i in ipairs { 5, 1, 9, 3, 8, 2, 7, 6, 4 } do "
	               "order[some[i]] = i end\n"
	               "for _, i in pairs(order) do text = text .. i end assert(text == "
	               "'123456789', text)\n"
	               "local t = { a = 1, b = 2, c = 3 } local seen = 0\n"
	               "for k in pairs(t) do t[k] = nil if k == 'a' then t.b = nil end seen = seen "
	               "+ 1 end\n"
	               "assert(seen == 2 and next(t) == nil)\n"
	               "local k, n = nil, 0 local u = { x = 1, y = 2, 7, 8 }\n"
	               "repeat k = next(u, k) n = n + 1 until k == nil assert(n == 5)\n"
	               "assert(not pcall(pairs, { [{}] = 1, [{}] = 2 }) and keys { [{}] = 1 } == "
	               "'table: 1')\n"
	               "local p = setmetatable({}, { __pairs = function() return function(_, k) if "
	               "not k then return 1 end end, nil, nil end })\n"
	               "assert(keys(p) == '1')\n");
	unload(&it);
}

static void patterns_mean_what_they_mean_in_lua(void **state)
{
	struct loaded it;

	(void)state;
	must_load(
		&it,
		"assert(('key = val'):match('^(%w+)%s*=%s*(%w+)$') == 'key' and ('x'):find('') == "
		"1 and ('a.b'):find('.', 1, true) == 2)\n"
		"assert(('hello'):gsub('l+', {ll = 'LL'}) == 'heLLo' and ('abc'):gsub('', '-') == "
		"'-a-b-c-')\n"
		"assert(('f(a(b)c)d'):match('%b()') == '(a(b)c)' and ('THE (quick) "
		"fox'):find('%((%a+)%)') == 5)\n"
		"assert(('THE (quick) fox'):gsub('%f[%a]%a+', string.lower) == 'the (quick) fox')\n"
		"assert(('abab'):match('^(ab)%1$') == 'ab' and ('abc'):match('()b()') == 2 and "
		"('x]y'):match('[]]') == ']')\n"
		"assert(('a-z'):match('[a%-]+') == 'a-' and ('1.5e3'):match('[^%a]+') == '1.5' and "
		"('aaa'):match('a-$') == 'aaa')\n"
		"assert(('abc'):gsub('%w', '%0%0') == 'aabbcc' and select(2, ('abc'):gsub('%w', "
		"'', 2)) == 2)\n"
		"assert(('hello world'):gsub('(o)(.)', '%2%1') == 'hell owrold' and "
		"('abc'):match('.', -1) == 'c')\n"
		"local n = 0 for k, v in ('a=1, b=2'):gmatch('(%w+)=(%w+)') do n = n + tonumber(v) "
		"end assert(n == 3)\n"
		"for _, p in ipairs { '[a', '%', '(', '%b', '%f', '%1', ('('):rep(40) } do "
		"assert(not pcall(string.find, 'aaa', p), p) end\n"
		"assert(not pcall(string.gsub, 'a', 'a', '%2') and not pcall(string.gsub, 'a', "
		"'a', '%x') and not pcall(string.rep))\n");
	unload(&it);
}

static void expect_refused_is_known_even_of_a_scene_that_fails(void **state)
{
	struct loaded it;

	(void)state;
	load_text(&it, "expect_refused(65, \"unknown key 'x'\")\nsphere { x = 1 }");
	assert_int_equal(it.status, RB_ERR_SCENE);
	assert_int_equal(it.scene.expect_refused, 65);
	assert_true(rb_pattern_found(it.mistakes.line[0], it.scene.expect_refused_pattern));
	unload(&it);
}

static void every_allocation_that_fails_is_an_error_and_no_leak(void **state)
{
	static const char text[] = "world { title = 'x', duration = 1 } local m = material { name "
				   "= 'm' } param('p', 1, 'h')\n"
				   "for i = 1, 30 do sphere { name = 'b' .. i, radius = 1, "
				   "material = m, forces = {{vector = {1, 0, 0}}} } end\n"
				   "camera {} expect('e', function() return true end) "
				   "on_step(function() end) print(('x'):rep(5000))\n";
	const uint64_t before = rb_memory_counts().taken - rb_memory_counts().freed;
	bool loaded = false;

	(void)state;
	for (uint64_t k = 1; !loaded && k < 2000; k++) {
		struct loaded it;
		rb_memory_fail_at(k);
		load_text(&it, text);
		rb_memory_fail_at(0);
		loaded = it.status == RB_OK;
		if (!loaded)
			assert_int_equal(it.status, RB_ERR_MEMORY);
		unload(&it);
		assert_true(rb_memory_counts().taken - rb_memory_counts().freed == before);
	}
	assert_true(loaded);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_example_of_the_manual_becomes_a_scene),
		cmocka_unit_test(every_key_of_a_body_arrives),
		cmocka_unit_test(every_mistake_gets_its_message_and_all_of_one_pass_come_together),
		cmocka_unit_test(parameters_take_the_type_of_their_default),
		cmocka_unit_test(a_parameter_out_of_range_says_what_is_allowed),
		cmocka_unit_test(a_missing_scene_is_missing_input),
		cmocka_unit_test(bytecode_is_refused),
		cmocka_unit_test(a_first_line_for_the_shell_and_a_byte_order_mark_are_passed_over),
		cmocka_unit_test(requires_come_from_beside_the_scene_and_are_kept),
		cmocka_unit_test(textures_that_are_no_pictures_are_mistakes),
		cmocka_unit_test(a_call_that_is_assigned_to_is_a_mistake),
		cmocka_unit_test(a_mistake_in_a_helper_shows_the_line_of_the_scene),
		cmocka_unit_test(handles_show_the_initial_values),
		cmocka_unit_test(vectors_have_operators),
		cmocka_unit_test(random_numbers_are_those_of_the_seed),
		cmocka_unit_test(the_seed_of_the_command_line_wins),
		cmocka_unit_test(a_refusal_is_expected_with_a_status_there_is),
		cmocka_unit_test(pairs_has_an_order),
		cmocka_unit_test(patterns_mean_what_they_mean_in_lua),
		cmocka_unit_test(expect_refused_is_known_even_of_a_scene_that_fails),
		cmocka_unit_test(every_allocation_that_fails_is_an_error_and_no_leak),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
