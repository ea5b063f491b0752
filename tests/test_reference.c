/* SPDX-License-Identifier: MIT */
/* src/script/reference.c: the exact motion that a scene states, at one time */
#include "loaded.h"

#include <float.h>

#include <rbsim/model.h>

#include "math/quat.h"
#include "script/load.h"
#include "script/reference.h"
#include "script/script.h"

enum { BODIES = 3 };

/* Two balls and a plane, before what `text` says. */
static void load_balls(struct loaded *it, const char *text)
{
	char whole[2000];

	snprintf(whole, sizeof whole,
	         "world { duration = 1 }\n"
	         "local a = sphere { name = 'a', radius = 1 }\n"
	         "local b = sphere { radius = 1, position = {5, 0, 0} }\n"
	         "plane { name = 'floor', point = {0, 0, -9} }\n%s",
	         text);
	must_load(it, whole);
	assert_int_equal(it->scene.body_count, BODIES);
}

static void must_state(struct loaded *it, double time, struct rb_reference_pose poses[BODIES])
{
	/* what was there before must not show */
	memset(poses, 0x5a, BODIES * sizeof *poses);
	if (rb_script_reference(it->script, NULL, time, poses, &it->err) != RB_OK)
		fail_msg("t = %g: %s", time, it->err.text);
}

static void poses_come_by_name_and_by_handle(void **state)
{
	struct rb_reference_pose poses[BODIES];
	struct loaded it;

	(void)state;
	load_balls(&it,
	           "reference(function(t) return {\n"
	           "  a = { position = {t, 2 * t, -t}, velocity = {1, 2, -1} },\n"
	           "  [b] = { orientation = {0, 0, 1.0005, 0}, angular_velocity = {0, 0, t} }\n"
	           "} end)");
	assert_true(rb_script_has_reference(it.script));
	for (int k = 0; k < 4; k++) {
		const double t = 0.25 * k;

		must_state(&it, t, poses);
		assert_int_equal(poses[0].known, RB_FIELD_POSITION | RB_FIELD_VELOCITY);
		assert_near(poses[0].position.x, t, 0);
		assert_near(poses[0].position.y, 2 * t, 0);
		assert_near(poses[0].position.z, -t, 0);
		assert_near(poses[0].velocity.y, 2, 0);
		assert_int_equal(poses[1].known, RB_FIELD_ORIENTATION | RB_FIELD_ANGULAR_VELOCITY);
		assert_near(poses[1].orientation.y, 1, 0); /* of length 1 */
		assert_near(poses[1].angular_velocity.z, t, 0);
		assert_near(poses[1].position.x, 0, 0);
		assert_int_equal(poses[2].known, 0);
	}
	unload(&it);
}

static void a_scene_may_have_no_reference(void **state)
{
	struct rb_reference_pose poses[BODIES];
	struct loaded it;

	(void)state;
	load_balls(&it, "");
	assert_false(rb_script_has_reference(it.script));
	assert_int_equal(rb_script_reference(it.script, NULL, 0, poses, &it.err), RB_ERR_SCENE);
	assert_non_null(strstr(it.err.text, "states no reference"));
	unload(&it);
	/* nothing has to be stated of any body, and the last word counts */
	load_balls(&it, "reference(function() return 5 end) reference(function() return {} end)");
	must_state(&it, 1, poses);
	for (int i = 0; i < BODIES; i++)
		assert_int_equal(poses[i].known, 0);
	unload(&it);
}

static void assert_wrong(const char *returned, const char *part)
{
	struct rb_reference_pose poses[BODIES];
	struct loaded it;
	char text[1000];

	snprintf(text, sizeof text, "reference(function(t) %s end)", returned);
	load_balls(&it, text);
	assert_int_equal(rb_script_reference(it.script, NULL, 0.5, poses, &it.err), RB_ERR_SCENE);
	if (!strstr(it.err.text, part))
		fail_msg("'%s': '%s' has no '%s'", returned, it.err.text, part);
	/* the script goes on living */
	assert_int_equal(rb_script_reference(it.script, NULL, 0.5, poses, &it.err), RB_ERR_SCENE);
	assert_non_null(strstr(it.err.text, part));
	unload(&it);
}

static void mistakes_are_told_with_place_and_body(void **state)
{
	(void)state;
	assert_wrong("return nil", "t.lua:5: reference: must return a table of bodies");
	assert_wrong("return {c = {}}", "t.lua:5: reference: no body is called 'c'");
	assert_wrong("return {a = {}, c = {}}", "no body is called 'c'");
	assert_wrong("return {[1] = {position = {0, 0, 0}}}", "no body is called '?'");
	assert_wrong("return {a = 5}", "'a' must be a table {position = ...} (got 5)");
	assert_wrong("return {[b] = 5}", "'sphere' must be a table");
	assert_wrong("return {a = {place = {0, 0, 0}}}", "'a': unknown key 'place'");
	assert_wrong("return {a = {{0, 0, 0}}}", "'a': unknown key ''");
	assert_wrong("return {a = {position = {0, 0}}}", "'a': 'position': expected a vector");
	assert_wrong("return {a = {velocity = 0}}", "'a': 'velocity': expected a vector");
	assert_wrong("return {a = {angular_velocity = {0, 0, 1/0}}}",
	             "'a': 'angular_velocity': expected finite");
	assert_wrong("return {floor = {position = {0/0, 0, 0}}}",
	             "'floor': 'position': expected finite");
	assert_wrong("return {a = {orientation = {1, 0, 0}}}",
	             "quaternion {w, x, y, z} of length 1");
	assert_wrong("return {a = {orientation = {1, 0, 0, 0.1}}}", "of length 1");
	assert_wrong("return {a = {orientation = {1/0, 0, 0, 0}}}", "of length 1");
	assert_wrong("return {a = {orientation = {axis = {1, 0, 0}, angle = 1}}}", "of length 1");
	assert_wrong("error('by itself', 0)", "by itself");
	assert_wrong("while true do end", "the script ran longer");
}

static void nothing_can_be_changed_or_defined_by_it(void **state)
{
	(void)state;
	assert_wrong("sphere { radius = 1 } return {}", "sphere");
	assert_wrong("a:set_velocity {1, 0, 0} return {}", "set_velocity");
	assert_wrong("reference(function() return {} end) return {}", "reference");
}

static void many_calls_leave_nothing_behind(void **state)
{
	struct rb_reference_pose poses[BODIES];
	struct loaded it;

	(void)state;
	load_balls(&it, "reference(function(t) if t < 0 then error('before the start') end\n"
	                "return { a = { position = {t, 0, 0} } } end)");
	const int top = lua_gettop(it.script->sandbox.L);
	for (int k = 0; k < 100; k++) {
		must_state(&it, k, poses);
		assert_near(poses[0].position.x, k, 0);
		assert_int_equal(rb_script_reference(it.script, NULL, -1, poses, &it.err),
		                 RB_ERR_SCENE);
		assert_int_equal(poses[0].known, 0);
		assert_int_equal(lua_gettop(it.script->sandbox.L), top);
		assert_int_equal(it.script->phase, RB_PHASE_REST);
	}
	unload(&it);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(poses_come_by_name_and_by_handle),
		cmocka_unit_test(a_scene_may_have_no_reference),
		cmocka_unit_test(mistakes_are_told_with_place_and_body),
		cmocka_unit_test(nothing_can_be_changed_or_defined_by_it),
		cmocka_unit_test(many_calls_leave_nothing_behind),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
