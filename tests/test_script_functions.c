/* SPDX-License-Identifier: MIT */
/* src/script/force_calls, functions, hooks: springs, drag, fields, driven bodies and transitions as a scene states them */
#include "support.h"

#include "force/drag.h"
#include "force/spring.h"

#include <rbsim/model.h>
#include <rbsim/world.h>

#include "base/memory.h"
#include "script/hooks.h"
#include "script/load.h"

struct loaded {
	struct rb_script *script;
	struct rb_scene scene;
	struct rb_world_hooks hooks;
	struct rb_error error;
	enum rb_status status;
};

static struct rb_error err;
static const rb_vec3 origin = {0, 0, 0};

static void load(struct loaded *it, const char *text)
{
	const struct rb_source_file file = {
		.name = "t.lua", .text = text, .size_bytes = strlen(text)};
	const struct rb_script_options options = {
		.path = "t.lua", .files = &file, .file_count = 1, .callback_instructions = 100000};

	*it = (struct loaded){0};
	it->status = rb_script_load(&it->script, &it->scene, NULL, &options, &it->error);
	if (it->status == RB_OK)
		it->hooks = rb_script_hooks(it->script);
}

static void must_load(struct loaded *it, const char *text)
{
	load(it, text);
	if (it->status != RB_OK)
		fail_msg("%s", it->error.text);
}

static void unload(struct loaded *it)
{
	rb_script_destroy(it->script);
	rb_scene_release(&it->scene);
}

static rb_vec3 field_at(struct loaded *it, double t, rb_vec3 x, rb_vec3 v)
{
	rb_vec3 force[2] = {{(double)NAN, (double)NAN, (double)NAN}};

	if (it->hooks.field(it->hooks.user, 0, t, (rb_vec3[2]){x, v}, force, &it->error) != RB_OK)
		fail_msg("%s", it->error.text);
	return force[0];
}

static struct rb_driven_pose pose_at(struct loaded *it, int id, double t)
{
	struct rb_driven_pose pose;

	if (it->hooks.motion(it->hooks.user, id, t, &pose, &it->error) != RB_OK)
		fail_msg("%s", it->error.text);
	return pose;
}

static void every_key_of_springs_drags_and_fields_arrives(void **state)
{
	struct loaded it;

	(void)state;
	must_load(&it, "local a = sphere { name = 'a', radius = 1 } sphere { name = 'b', radius = "
	               "1, position = {5, 0, 0} }\n"
	               "spring { a = a, b = 'b', stiffness = 3, damping = 0.5, rest_length = 4, "
	               "at_a = {0, 1, 0}, at_b = {0, 0, 1} }\n"
	               "spring { a = 'b', b = 'a', stiffness = 0 }\n"
	               "drag { linear = 2 } drag { quadratic = 7, linear = 0 }\n"
	               "field(function(t, x, v) return {0, 0, 0} end)");
	const struct rb_spring_def *spring = rb_scene_spring(&it.scene, 0);
	assert_int_equal(rb_scene_element_count(&it.scene, &rb_force_spring), 2);
	assert_int_equal(spring[0].a, 0);
	assert_int_equal(spring[0].b, 1);
	assert_near(spring[0].stiffness, 3, 0);
	assert_near(spring[0].damping, 0.5, 0);
	assert_near(spring[0].rest_length_m, 4, 0);
	assert_near(spring[0].at_a.y, 1, 0);
	assert_near(spring[0].at_b.z, 1, 0);
	assert_int_equal(spring[0].line, 2);
	assert_int_equal(spring[1].a, 1);
	assert_true(isnan(spring[1].rest_length_m) && isnan(spring[1].at_a.x) &&
	            isnan(spring[1].at_b.x));
	const struct rb_drag_def *drags = rb_scene_element(&it.scene, &rb_force_drag, 0);
	assert_int_equal(rb_scene_element_count(&it.scene, &rb_force_drag), 2);
	assert_near(drags[0].linear, 2, 0);
	assert_near(drags[0].quadratic, 0, 0);
	assert_near(drags[1].quadratic, 7, 0);
	assert_int_equal(it.scene.field_count, 1);
	assert_int_equal(it.scene.fields[0].line, 5);
	assert_non_null(it.hooks.field);
	assert_null(it.hooks.motion);
	assert_null(it.hooks.transition);
	unload(&it);
	must_load(&it, "sphere { radius = 1 }");
	assert_null(it.hooks.field);
	unload(&it);
}

static void fields_add_up_and_get_their_arguments(void **state)
{
	struct loaded it;

	(void)state;
	must_load(&it, "sphere { radius = 1 }\n"
	               "field(function(t, x, v) return {t, x.y, v[3]} end)\n"
	               "field(function(t, x, v) return -2 * x + v:cross {0, 0, 1} end)\n"
	               "field(function(t, x, v) x.x = 100 return {0, 0, 0} end)\n"
	               "field(function(t, x, v) return x end)");
	const rb_vec3 force = field_at(&it, 3, (rb_vec3){1, 2, 4}, (rb_vec3){8, 16, 32});
	assert_near(force.x, 3 - 2 + 16 + 1, 0);
	assert_near(force.y, 2 - 4 - 8 + 2, 0);
	assert_near(force.z, 32 - 8 + 4, 0);
	/* any time, in any order: the same arguments give the same force */
	(void)field_at(&it, -1, (rb_vec3){9, 9, 9}, origin);
	const rb_vec3 again = field_at(&it, 3, (rb_vec3){1, 2, 4}, (rb_vec3){8, 16, 32});
	assert_memory_equal(&force, &again, sizeof force);
	unload(&it);
}

static void many_calls_leave_nothing_behind(void **state)
{
	struct loaded it;

	(void)state;
	must_load(&it, "sphere { radius = 1, motion = function(t) return {t, 0, 0} end }\n"
	               "sphere { radius = 1, position = {0, 9, 0} }\n"
	               "field(function(t, x, v) return x - v end)");
	for (int i = 0; i < 20000; i++)
		(void)field_at(&it, i, origin, origin);
	const struct rb_memory_counts before = rb_memory_counts();
	for (int i = 0; i < 200000; i++) {
		assert_near(field_at(&it, i, (rb_vec3){i, 0, 0}, (rb_vec3){1, 0, 0}).x, i - 1, 0);
		assert_near(pose_at(&it, 0, i).position.x, i, 0);
	}
	const struct rb_memory_counts after = rb_memory_counts();
	assert_true(after.taken - after.freed <= before.taken - before.freed + 1);
	unload(&it);
}

static void mistakes_of_a_field_are_told_with_place_and_time(void **state)
{
	static const struct {
		const char *body, *message;
	} cases[] = {
		{"end", "t.lua:2: 'field' must return a finite force {x, y, z} (got nothing)"},
		{"return 1 end", "t.lua:2: 'field' must return a finite force {x, y, z} (got 1)"},
		{"return {0, 0} end",
	         "t.lua:2: 'field' must return a finite force {x, y, z} (got {0, 0})"},
		{"return {0, 0, 1 / 0} end",
	         "t.lua:2: 'field' must return a finite force {x, y, z} (got {0, 0, inf})"},
		{"\n return x.w end",
	         "t.lua:3: vec3: no field 'w' (there are x, y, z, length, dot, cross, unit)"},
		{"while true do end end",
	         "t.lua:2: the script ran longer than 100000 instructions (--trust lifts this)"},
		{"energy() return x end",
	         "t.lua:2: energy: only in callbacks and at the end of a run"},
	};
	struct loaded it;
	char text[300], wanted[300];
	rb_vec3 force[2];

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		snprintf(text, sizeof text, "sphere { radius = 1 }\nfield(function(t, x, v) %s)",
		         cases[i].body);
		must_load(&it, text);
		assert_int_equal(it.hooks.field(it.hooks.user, 0, 0.5, (rb_vec3[2]){origin, origin},
		                                force, &it.error),
		                 RB_ERR_SCENE);
		snprintf(wanted, sizeof wanted, "%s (field at t = 0.5 s)", cases[i].message);
		assert_string_equal(it.error.text, wanted);
		/* what was returned is refused when no function of the scene runs any more */
		const bool returned = strstr(cases[i].message, "must return") != NULL;
		assert_int_equal(strlen(rb_script_traceback(it.script)) == 0, returned);
		unload(&it);
	}
}

static void motion_says_where_a_body_is_at_any_time(void **state)
{
	struct loaded it;

	(void)state;
	must_load(
		&it,
		"sphere { name = 'all', radius = 1, motion = function(t) local c, s = math.cos(t / "
		"2), math.sin(t / 2)\n"
		"  return {t + 5, 0, 0}, {c, 0, 0, s}, {1, 0, 0}, {0, 0, 1} end }\n"
		"plane { normal = {1, 0, 0}, motion = function(t) return vec3(t * t, 0, 0) end }\n"
		"sphere { radius = 1, position = {0, 7, 0}, motion = function(t) return {0, 7, 0}, "
		"{axis = {0, 0, 1}, angle = t} end }\n"
		"sphere { radius = 1, position = {0, 20, 0} }");
	const struct rb_body_def *all = &it.scene.bodies[0], *wall = &it.scene.bodies[1],
				 *axis = &it.scene.bodies[2];
	assert_true(all->motion >= 0 && !all->is_static && all->motion_turns);
	assert_true(all->motion_gives_velocity && all->motion_gives_angular_velocity);
	assert_near(all->position.x, 5, 0);
	assert_near(all->velocity.x, 1, 0);
	assert_near(all->angular_velocity.z, 1, 0);
	assert_true(wall->motion >= 0 && !wall->is_static && !wall->motion_turns);
	assert_false(wall->motion_gives_velocity || wall->motion_gives_angular_velocity);
	assert_true(axis->motion_turns && !axis->motion_gives_angular_velocity);
	assert_int_equal(it.scene.bodies[3].motion, -1);

	struct rb_driven_pose pose = pose_at(&it, 0, 1);
	assert_near(pose.position.x, 6, 0);
	assert_near(pose.orientation.z, sin(0.5), 1e-15);
	assert_true(pose.has_velocity && pose.has_angular_velocity);
	assert_near(pose.angular_velocity.z, 1, 0);
	pose = pose_at(&it, 1, 3);
	assert_near(pose.position.x, 9, 0);
	assert_false(pose.has_velocity || pose.has_angular_velocity);
	/* it returns none: that of its normal holds */
	assert_memory_equal(&pose.orientation, &wall->orientation, sizeof pose.orientation);
	assert_true(fabs(pose.orientation.w) < 0.8);
	pose = pose_at(&it, 2, 2);
	assert_near(pose.orientation.w, cos(1), 1e-15);
	unload(&it);
}

static void mistakes_of_a_motion_are_told_with_the_body(void **state)
{
	static const struct {
		const char *body, *message;
	} cases[] = {
		{"if t > 0 then return {0, 0, 0}, {1, 0, 0, 0} end return {0, 0, 0} end",
	         "t.lua:2: 'motion' must return an orientation always or never: it gave none at "
	         "time 0 (got {1, 0, 0, 0})"},
		{"if t > 0 then return {0, 0, 0} end return {0, 0, 0}, {1, 0, 0, 0} end",
	         "t.lua:2: 'motion' must return an orientation always or never (got nothing)"},
		{"if t > 0 then return end return {0, 0, 0} end",
	         "t.lua:2: 'motion' must return a finite position {x, y, z} first (got nothing)"},
		{"if t > 0 then sphere { radius = 1 } end return {0, 0, 0} end",
	         "t.lua:2: sphere: only while the scene is loaded, not in a callback"},
		{"while t > 0 do end return {0, 0, 0} end",
	         "t.lua:2: the script ran longer than 100000 instructions (--trust lifts this)"},
	};
	struct loaded it;
	struct rb_driven_pose pose;
	char text[300], wanted[300];

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		snprintf(text, sizeof text,
		         "sphere { name = 'fan', radius = 1, motion =\nfunction(t) %s }",
		         cases[i].body);
		must_load(&it, text);
		assert_int_equal(it.hooks.motion(it.hooks.user, 0, 0.25, &pose, &it.error),
		                 RB_ERR_SCENE);
		snprintf(wanted, sizeof wanted, "%s (sphere 'fan' at t = 0.25 s)",
		         cases[i].message);
		assert_string_equal(it.error.text, wanted);
		unload(&it);
	}
	/* a function that never ends is found while the scene is loaded */
	load(&it, "sphere { radius = 1, motion = function(t) while true do end end }");
	assert_int_equal(it.status, RB_ERR_SCENE);
	assert_non_null(strstr(it.error.text, "100000 instructions"));
	unload(&it);
}

static void transitions_are_told_with_their_kind(void **state)
{
	struct loaded it;
	struct rb_event event = {.time_s = 2,
	                         .a = 0,
	                         .b = 1,
	                         .point = {1, 2, 3},
	                         .normal = {0, 0, 1},
	                         .approach_speed = 4};
	char wanted[300] = "";

	(void)state;
	must_load(&it,
	          "local f = plane { name = 'f' } local s = sphere { radius = 1, position = {0, 0, "
	          "1} }\n"
	          "local kinds = {}\n"
	          "on_transition(function(c) assert(c.a == f and c.b == s and c.time == 2) end)\n"
	          "on_transition(function(c) assert(c.point.y == 2 and c.normal.z == 1 and "
	          "c.impulse == nil)\n"
	          "  kinds[#kinds + 1] = c.kind end)\n"
	          "on_collision(function(c) assert(c.kind == 'collision' and c.approach_speed == "
	          "4) end)\n"
	          "on_step(function() error(table.concat(kinds, ' ')) end)");
	assert_true((it.scene.hooks & RB_HOOK_TRANSITION) != 0);
	for (int kind = RB_EVENT_REST; kind < RB_EVENT_IMPULSE; kind++) {
		event.kind = (enum rb_event_kind)kind;
		assert_ok(it.hooks.transition(it.hooks.user, NULL, &event, &err));
		strcat(wanted, kind > RB_EVENT_REST ? " " : "t.lua:7: ");
		strcat(wanted, rb_event_kind_name(event.kind));
	}
	event.kind = RB_EVENT_COLLISION;
	assert_ok(it.hooks.collision(it.hooks.user, NULL, &event, &err));
	assert_int_equal(it.hooks.step(it.hooks.user, NULL, 0, 1, &it.error), RB_ERR_SCENE);
	assert_string_equal(it.error.text, wanted);
	assert_string_equal(wanted, "t.lua:7: rest slide roll lift edge merge");
	unload(&it);
}

static void a_driven_body_is_heavy_and_cannot_be_changed(void **state)
{
	static const char *const text =
		"world { duration = 1 }\n"
		"local fan = sphere { name = 'fan', radius = 1, motion = function(t) return {t, 0, "
		"0}, nil, {1, 0, 0} end }\n"
		"assert(fan.mass == math.huge and fan.kinetic_energy == 0 and fan.momentum.x == "
		"0)\n"
		"sphere { radius = 1, position = {0, 5, 0} }\n"
		"on_frame(function() assert(fan.mass == math.huge and fan.kinetic_energy == 0 and "
		"not fan.static)\n"
		"  assert(fan.velocity.x == 1) fan:set_velocity {0, 0, 0} end)";
	struct loaded it;
	struct rb_model *model;
	struct rb_world *world;
	const struct rb_world_options options = {0};

	(void)state;
	must_load(&it, text);
	assert_ok(rb_model_create(&model, &it.scene, NULL, &err));
	assert_ok(rb_world_create(&world, model, &options, &it.hooks, &err));
	assert_int_equal(rb_script_on_frame(it.script, world, 0, 0, &it.error), RB_ERR_SCENE);
	assert_string_equal(it.error.text,
	                    "t.lua:6: set_velocity: body fan is driven by its 'motion'");
	rb_world_destroy(world);
	rb_model_destroy(model);
	unload(&it);
}

static void every_allocation_that_fails_is_an_error(void **state)
{
	static const char *const text =
		"local a = sphere { radius = 1, motion = function(t) return {t, 0, 0} end }\n"
		"local b = sphere { radius = 1, position = {0, 5, 0} }\n"
		"spring { a = a, b = b, stiffness = 1 } drag { linear = 1 } field(function(t, x) "
		"return x end)";
	struct loaded it;
	bool whole = false;

	(void)state;
	const struct rb_memory_counts before = rb_memory_counts();
	for (uint64_t k = 1; !whole && k < 1000; k++) {
		rb_memory_fail_at(k);
		load(&it, text);
		rb_memory_fail_at(0);
		whole = it.status == RB_OK;
		assert_true(whole || it.status == RB_ERR_MEMORY);
		unload(&it);
		const struct rb_memory_counts after = rb_memory_counts();
		assert_int_equal(after.taken - after.freed, before.taken - before.freed);
	}
	assert_true(whole);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_key_of_springs_drags_and_fields_arrives),
		cmocka_unit_test(fields_add_up_and_get_their_arguments),
		cmocka_unit_test(many_calls_leave_nothing_behind),
		cmocka_unit_test(mistakes_of_a_field_are_told_with_place_and_time),
		cmocka_unit_test(motion_says_where_a_body_is_at_any_time),
		cmocka_unit_test(mistakes_of_a_motion_are_told_with_the_body),
		cmocka_unit_test(transitions_are_told_with_their_kind),
		cmocka_unit_test(a_driven_body_is_heavy_and_cannot_be_changed),
		cmocka_unit_test(every_allocation_that_fails_is_an_error),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
