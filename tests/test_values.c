/* SPDX-License-Identifier: MIT */
/* src/script/values.c: single values of a scene, checked as their row says */
#include "loaded.h"

#include <float.h>

#include <lauxlib.h>

#include <rbsim/model.h>

#include "script/load.h"
#include "script/values.h"

/* A value of a key of a ball, the world, the recording, a camera. */
static void assert_ball(const char *keys, const char *part)
{
	char text[300];

	snprintf(text, sizeof text, "sphere { radius = 1, %s }", keys);
	assert_mistake(text, part);
}

static void assert_camera(const char *keys, const char *part)
{
	char text[300];

	snprintf(text, sizeof text, "camera { %s }", keys);
	assert_mistake(text, part);
}

static void numbers_are_numbers_in_their_range(void **state)
{
	(void)state;
	assert_ball("mass = '1'", "'mass' must be a number (got the text '1')");
	assert_ball("mass = 0/0", "'mass' must be finite (got nan)");
	assert_ball("mass = 1/0", "'mass' must be finite (got inf)");
	assert_ball("mass = 0", "'mass' must be positive (got 0)");
	assert_ball("mass = -2", "'mass' must be positive (got -2)");
	assert_ball("mass = 1e-320", "'mass' must be positive"); /* its inverse is infinite */
	assert_mistake("material { restitution = 1.0001 }", "'restitution' must lie in [0, 1]");
	assert_mistake("material { restitution = -1e-9 }", "'restitution' must lie in [0, 1]");
	assert_mistake("material { friction = -1 }", "'friction' must be 0 or more (got -1)");
	assert_camera("fov = 0", "'fov' must be between 0 and pi");
	assert_camera("fov = math.pi", "'fov' must be between 0 and pi");
	assert_camera("samples = 65", "'samples' must lie in [1, 64] (got 65)");
	assert_camera("samples = 2.5", "'samples' must be a whole number (got 2.5)");
	assert_mistake("record { compression = 10 }", "'compression' must lie in [0, 9] (got 10)");
	assert_mistake("record { every = 0 }", "'every' must be 1 or more");
	assert_mistake("record { every = 2^31 }", "'every' must be less than 2^31");
	assert_mistake("world { seed = -1 }", "'seed' must be a whole number, 0 or more");
	assert_mistake("world { seed = 1.5 }", "'seed' must be a whole number, 0 or more");
	assert_ball("static = 1", "'static' must be true or false (got 1)");

	struct loaded it;
	must_load(&it,
	          "world { seed = 2^62, duration = 1 } material { restitution = 1, friction = 0 }\n"
	          "record { every = 2147483647, compression = 9 }\n"
	          "sphere { radius = 2.2250738585072014e-308, mass = 1e308 }");
	assert_true(it.scene.world.seed == (uint64_t)1 << 62);
	assert_int_equal(it.scene.record.every, INT32_MAX);
	assert_int_equal(it.scene.record.compression, 9);
	assert_near(it.scene.materials[1].restitution, 1, 0);
	assert_near(it.scene.bodies[0].shape.radius, DBL_MIN, 0);
	unload(&it);
}

static void vectors_and_lists_have_their_length(void **state)
{
	(void)state;
	assert_ball("position = {1, 2}", "'position' must be a vector {x, y, z} (got {1, 2})");
	assert_ball("position = {1, 2, 3, 4}", "'position' must be a vector {x, y, z}");
	assert_ball("position = {x = 1, y = 2, z = 3}", "(got a table)");
	assert_ball("position = 'up'", "(got the text 'up')");
	assert_ball("velocity = {0, 0, 0/0}", "'velocity' must be finite");
	assert_mistake("plane { normal = {0, 0, 0} }", "'normal' must be a vector with a length");
	assert_mistake("plane { normal = {1e-310, 0, 0} }",
	               "'normal' must be a vector with a length");
	assert_mistake("plane { size = {1} }", "'size' must be a list of 2 numbers");
	assert_camera("size = {640, 480.5}", "'size' must be whole numbers");
	assert_camera("size = {640, 0}", "'size' must lie in [1, 16384]");
	assert_camera("position = 5",
	              "'position' must be a vector {x, y, z}, a body or a function");
	assert_ball("orientation = {1, 1, 0, 0}", "'orientation'");
	assert_ball("orientation = {axis = {0, 0, 0}, angle = 1}", "'orientation'");
	assert_ball("orientation = {1, 0, 0}",
	            "{w, x, y, z} or {axis = {x, y, z}, angle = radians}");
}

static void colors_are_hex_digits_or_three_parts(void **state)
{
	static const char *const wrong[] = {"'#12345'",   "'#1234567'", "'123456'", "'#12345g'",
	                                    "{1, 1}",     "5",          "'red'",    "{1, 1, 2}",
	                                    "{-1, 0, 0}", "{0, 0, 0/0}"};
	struct loaded it;
	char text[80];

	(void)state;
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		snprintf(text, sizeof text, "color = %s", wrong[i]);
		assert_ball(text, "'color' must be");
	}
	must_load(&it, "sphere { radius = 1, color = '#00fF80' } sphere { radius = 1, color = {0, "
	               "0.5, 1} }\n"
	               "sphere { radius = 1 }");
	const struct rb_body_def *b = it.scene.bodies;
	assert_near(b[0].color[0], 0, 0);
	assert_near(b[0].color[1], 1, 0);
	assert_near(b[0].color[2], 128 / 255.0, DBL_EPSILON);
	assert_near(b[1].color[1], 0.5, 0);
	assert_true(isnan(b[2].color[0]));
	unload(&it);
}

static void choices_and_flags_are_found_by_name(void **state)
{
	struct loaded it;

	(void)state;
	assert_mistake("world { method = 'Located' }", "'method' must be one of auto, classic, "
	                                               "located, stepped (got 'Located') (did you "
	                                               "mean 'located'?)");
	assert_mistake("world { method = 3 }", "'method' must be one of");
	assert_mistake("world { method = '' }", "'method' must be one of");
	assert_mistake("world { method = 'auto,' }", "'method' must be one of");
	assert_mistake("record { precision = 'half' }",
	               "'precision' must be one of double, single");
	assert_mistake("record { fields = {'position', 'speed'} }", "'fields' must be one of");
	assert_mistake("record { fields = {'position', x = 1} }",
	               "'fields' must be a text or a list");
	assert_mistake("record { fields = 5 }", "'fields' must be a text or a list of texts");
	assert_mistake("local f = {} for i = 1, 33 do f[i] = 'events' end record { fields = f }",
	               "'fields' must be a text or a list of texts");
	must_load(&it,
	          "record { fields = {'events', 'position', 'events'}, precision = 'single' }\n"
	          "world { method = 'stepped', duration = 1 }\n"
	          "camera { overlay = 'energy' } camera { overlay = {} }\n"
	          "camera { overlay = {'time', 'title'}, style = 'wireframe' }");
	assert_int_equal(it.scene.record.fields, RB_FIELD_EVENTS | RB_FIELD_POSITION);
	assert_true(it.scene.record.single_precision);
	assert_int_equal(it.scene.world.method, RB_METHOD_STEPPED);
	assert_int_equal(it.scene.cameras[0].overlay, RB_OVERLAY_ENERGY);
	assert_int_equal(it.scene.cameras[1].overlay, 0);
	assert_int_equal(it.scene.cameras[2].overlay, RB_OVERLAY_TIME | RB_OVERLAY_TITLE);
	assert_true(it.scene.cameras[2].wireframe && !it.scene.cameras[1].wireframe);
	unload(&it);
	must_load(&it, "record { fields = {'+', 'contacts'} }");
	assert_int_equal(it.scene.record.fields & ~(unsigned)RB_FIELD_EVENTS,
	                 RB_FIELD_DEFAULT | RB_FIELD_CONTACTS);
	unload(&it);
}

static void texts_and_paths_are_plain(void **state)
{
	(void)state;
	assert_ball("name = 5", "'name' must be a text (got 5)");
	assert_ball("name = 'a\\0b'", "'name' must be a text without zero bytes");
	assert_mistake("record { file = '../x.h5' }",
	               "'file' must be a path within the output folder");
	assert_mistake("record { file = '/tmp/x.h5' }", "(--trust lifts this)");
	assert_mistake("record { file = '' }", "'file' must be a path within");
	assert_camera("png = 'a/../../%d.png'", "'png' must be a path within the output folder");
	assert_ball("texture = 'cheker'",
	            "or a PNG file beside the scene (got 'cheker') (did you mean "
	            "'checker'?)");
	assert_ball("texture = '../x.png'", "'texture' must be a path within the scene's folder");
	assert_ball("texture = 5", "'texture' must be a text");
}

static void materials_and_bodies_are_found_by_name_or_handle(void **state)
{
	struct loaded it;

	(void)state;
	must_load(&it, "local m = material { name = 'steel' } material { name = 'wood' }\n"
	               "local b = sphere { radius = 1, material = m, name = 'one' }\n"
	               "sphere { radius = 1, material = 'wood', name = 'two' }\n"
	               "camera { mount = b } camera { mount = 'two' }\n"
	               "camera { position = b, look_at = function(t) return {t, 0, 0} end, up = "
	               "{0, 1, 0} }");
	assert_int_equal(it.scene.bodies[0].material, 1);
	assert_int_equal(it.scene.bodies[1].material, 2);
	assert_int_equal(it.scene.cameras[0].mount, 0);
	assert_int_equal(it.scene.cameras[1].mount, 1);
	const struct rb_camera_def *camera = &it.scene.cameras[2];
	assert_int_equal(camera->position.source, RB_CAMERA_BODY);
	assert_int_equal(camera->position.body, 0);
	assert_int_equal(camera->look_at.source, RB_CAMERA_FUNCTION);
	assert_true(camera->look_at.function > 0);
	assert_int_equal(camera->up.source, RB_CAMERA_FIXED);
	assert_near(camera->up.value.y, 1, 0);

	char hint[96];
	assert_int_equal(rb_body_named(it.script->sandbox.L, "two", hint), 1);
	assert_int_equal(rb_body_named(it.script->sandbox.L, "twoo", hint), -1);
	assert_string_equal(hint, " (did you mean 'two'?)");
	assert_int_equal(rb_body_named(it.script->sandbox.L, "nobody", hint), -1);
	assert_string_equal(hint, "");
	unload(&it);
	assert_ball("material = 'steel'", "'material': no material is named 'steel' so far");
	assert_ball("material = 5", "'material' must be a material or the name of one (got 5)");
	assert_mistake("local b = sphere { radius = 1 } sphere { radius = 1, material = b }",
	               "must be a material or the name of one (got a body)");
	assert_camera("mount = 'ball'", "'mount': no body is named 'ball' so far");
	assert_ball("motion = 5", "'motion' must be a function (got 5)");
}

/* Rotational inertia: no principal moment is more than the sum of the two others. */
static void an_inertia_is_one_that_a_body_can_have(void **state)
{
	struct loaded it;

	(void)state;
	assert_ball("mass = 1, inertia = {1, 1}", "'inertia' must be {Ix, Iy, Iz} or three rows");
	assert_ball("mass = 1, inertia = {1, 1, 0}", "'inertia' must be positive");
	assert_ball("mass = 1, inertia = {1, 1, 1/0}", "'inertia' must be finite");
	assert_ball("mass = 1, inertia = {{1, 0, 0}, {0, 1, 0}, 5}",
	            "'inertia' must be {Ix, Iy, Iz}");
	assert_ball("mass = 1, inertia = {{1, 0, 0}, {0, 1, 0}, {0, 0, 0/0}}", "must be finite");
	assert_ball("mass = 1, inertia = {1, 1, 3}", "'inertia'");
	assert_ball("mass = 1, inertia = {{1, 0.5, 0}, {0, 1, 0}, {0, 0, 1}}", "'inertia'");
	assert_ball("mass = 1, inertia = {{1, 2, 0}, {2, 1, 0}, {0, 0, 1}}", "'inertia'");
	must_load(
		&it,
		"sphere { radius = 1, mass = 1, inertia = {2, 3, 4} }\n"
		"sphere { radius = 1, mass = 1, inertia = {{2, 0.5, 0}, {0.5, 2, 0}, {0, 0, 3}} }");
	assert_non_null(it.scene.bodies[0].inertia);
	assert_near(it.scene.bodies[0].inertia->m[2][2], 4, 0);
	assert_near(it.scene.bodies[0].inertia->m[0][1], 0, 0);
	assert_near(it.scene.bodies[1].inertia->m[1][0], 0.5, 0);
	unload(&it);
}

/* A value that is wrong leaves its place alone. */
static void a_wrong_value_leaves_what_was_there(void **state)
{
	static const struct {
		const char *key, *value;
	} cases[] = {{"mass", "-1"},           {"position", "{1, 2}"},
	             {"static", "'yes'"},      {"name", "7"},
	             {"color", "'#12345g'"},   {"orientation", "{2, 0, 0, 0}"},
	             {"inertia", "{1, 1, 9}"}, {"material", "'nothing'"}};
	struct loaded it;
	static union {
		unsigned char bytes[256];
		double aligned;
	} place;

	(void)state;
	must_load(&it, "");
	lua_State *const L = it.script->sandbox.L;
	struct rb_call call = {.L = L, .script = it.script, .line = 3, .label = "sphere"};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const struct rb_row *row = rb_row_find(&rb_rows_body, cases[i].key, NULL);
		char text[80];

		assert_non_null(row);
		snprintf(text, sizeof text, "return %s", cases[i].value);
		assert_int_equal(luaL_dostring(L, text), LUA_OK);
		memset(&place, 0x5a, sizeof place);
		it.script->mistakes = NULL; /* those of loading are over */
		const int before = it.script->mistake_count;
		assert_false(rb_call_value(&call, row, -1, &place));
		for (size_t k = 0; k < sizeof place; k++)
			assert_int_equal(place.bytes[k], 0x5a);
		assert_int_equal(it.script->mistake_count, before + 1);
		assert_int_equal(lua_gettop(L), 1);
		lua_settop(L, 0);
	}
	unload(&it);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(numbers_are_numbers_in_their_range),
		cmocka_unit_test(vectors_and_lists_have_their_length),
		cmocka_unit_test(colors_are_hex_digits_or_three_parts),
		cmocka_unit_test(choices_and_flags_are_found_by_name),
		cmocka_unit_test(texts_and_paths_are_plain),
		cmocka_unit_test(materials_and_bodies_are_found_by_name_or_handle),
		cmocka_unit_test(an_inertia_is_one_that_a_body_can_have),
		cmocka_unit_test(a_wrong_value_leaves_what_was_there),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
