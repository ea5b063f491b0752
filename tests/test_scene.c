/* SPDX-License-Identifier: MIT */
/* src/model/scene.c */
#include "support.h"

#include "force/drag.h"
#include "force/spring.h"

#include <rbsim/scene.h>

#include "base/memory.h"
#include "math/quat.h"

static struct rb_error err;

static void a_fresh_scene_has_the_defaults_of_the_language(void **slot)
{
	struct rb_scene scene;

	(void)slot;
	assert_ok(rb_scene_init(&scene, &err));
	assert_true(isnan(scene.world.duration_s));
	assert_near(scene.world.frame_rate, 60, 0);
	assert_true(isnan(scene.world.time_step_s) && isnan(scene.world.tolerance_m));
	assert_int_equal(scene.world.rollback, RB_ROLLBACK_SELECTIVE);
	assert_int_equal(scene.world.seed, 1);
	assert_string_equal(scene.world.title, "");
	assert_int_equal(scene.record.every, 1);
	assert_int_equal(scene.record.fields, RB_FIELD_DEFAULT);
	assert_int_equal(scene.material_count, 1);
	assert_near(scene.materials[0].density, 1000, 0);
	assert_near(scene.materials[0].friction, 0.5, 0);
	assert_near(scene.materials[0].restitution, 0, 0);
	rb_scene_release(&scene);
	rb_scene_release(&scene);
}

static void what_is_added_is_kept_in_order_with_its_own_texts(void **slot)
{
	struct rb_scene scene;
	char name[32];

	(void)slot;
	assert_ok(rb_scene_init(&scene, &err));
	for (int i = 0; i < 3000; i++) {
		struct rb_body_def body = rb_body_def_default();
		int id = -1;

		snprintf(name, sizeof name, "ball %d", i);
		body.name = name;
		body.shape.radius = i + 1;
		assert_ok(rb_scene_add_body(&scene, &body, &id, &err));
		assert_int_equal(id, i);
	}
	memset(name, 'x', sizeof name - 1);
	for (int i = 0; i < 3000; i++) {
		snprintf(name, sizeof name, "ball %d", i);
		assert_string_equal(scene.bodies[i].name, name);
		assert_near(scene.bodies[i].shape.radius, i + 1, 0);
	}
	rb_scene_release(&scene);
}

static void springs_drags_and_fields_are_kept_in_order(void **slot)
{
	struct rb_scene scene;

	(void)slot;
	assert_ok(rb_scene_init(&scene, &err));
	for (int i = 0; i < 300; i++) {
		struct rb_spring_def spring = rb_spring_def_default();
		const struct rb_drag_def drag = {.linear = i};
		const struct rb_field_def field = {.function = i};

		assert_true(isnan(spring.rest_length_m) && isnan(spring.at_a.x) &&
		            isnan(spring.at_b.x));
		spring.stiffness = i;
		assert_ok(rb_scene_add_spring(&scene, &spring, &err));
		assert_ok(rb_scene_add_drag(&scene, &drag, &err));
		assert_ok(rb_scene_add_field(&scene, &field, &err));
	}
	assert_int_equal(rb_scene_element_count(&scene, &rb_force_spring), 300);
	assert_int_equal(rb_scene_element_count(&scene, &rb_force_drag), 300);
	assert_int_equal(scene.field_count, 300);
	for (int i = 0; i < 300; i++) {
		assert_near(rb_scene_spring(&scene, i)->stiffness, i, 0);
		assert_near(
			((struct rb_drag_def *)rb_scene_element(&scene, &rb_force_drag, i))->linear,
			i, 0);
		assert_int_equal(scene.fields[i].function, i);
	}
	assert_int_equal(rb_body_def_default().motion, -1);
	rb_scene_release(&scene);
}

static void forces_belong_to_the_body_added_last(void **slot)
{
	struct rb_scene scene;
	struct rb_body_def body = rb_body_def_default();
	struct rb_force_def force = rb_force_def_default();

	(void)slot;
	assert_ok(rb_scene_init(&scene, &err));
	body.force_count = 7; /* a leftover that must not count */
	assert_ok(rb_scene_add_body(&scene, &body, NULL, &err));
	force.vector.x = 1;
	assert_ok(rb_scene_add_force(&scene, &force, &err));
	assert_ok(rb_scene_add_body(&scene, &body, NULL, &err));
	force.vector.x = 2;
	assert_ok(rb_scene_add_force(&scene, &force, &err));
	force.vector.x = 3;
	assert_ok(rb_scene_add_force(&scene, &force, &err));
	assert_int_equal(scene.bodies[0].force_count, 1);
	assert_int_equal(scene.bodies[1].force_first, 1);
	assert_int_equal(scene.bodies[1].force_count, 2);
	assert_near(scene.forces[2].vector.x, 3, 0);
	assert_true(isinf(scene.forces[2].duration_s) && isnan(scene.forces[2].point.x));
	rb_scene_release(&scene);
}

static void the_sixty_fourth_group_is_refused(void **slot)
{
	struct rb_scene scene;
	char name[16];
	int index;

	(void)slot;
	assert_ok(rb_scene_init(&scene, &err));
	for (int i = 0; i < 63; i++) {
		snprintf(name, sizeof name, "g%d", i);
		assert_ok(rb_scene_group(&scene, name, &index, &err));
		assert_int_equal(index, i);
	}
	assert_ok(rb_scene_group(&scene, "g5", &index, &err));
	assert_int_equal(index, 5);
	assert_int_equal(rb_scene_group(&scene, "more", &index, &err), RB_ERR_SCENE);
	assert_non_null(strstr(err.text, "'more'"));
	rb_scene_release(&scene);
}

static void files_keep_every_byte(void **slot)
{
	struct rb_scene scene;
	const char text[] = "a\0b";

	(void)slot;
	assert_ok(rb_scene_init(&scene, &err));
	assert_ok(rb_scene_add_file(&scene, "s.lua", text, 3, "00ff", &err));
	assert_ok(rb_scene_add_file(&scene, "empty.lua", "", 0, "", &err));
	assert_int_equal(scene.files[0].size_bytes, 3);
	assert_memory_equal(scene.files[0].text, text, 4);
	assert_string_equal(scene.files[0].sha256, "00ff");
	assert_string_equal(scene.files[1].text, "");
	rb_scene_release(&scene);
}

static void a_label_is_the_name_or_the_number(void **slot)
{
	struct rb_scene scene;
	struct rb_body_def body = rb_body_def_default();
	char label[64];

	(void)slot;
	assert_ok(rb_scene_init(&scene, &err));
	assert_ok(rb_scene_add_body(&scene, &body, NULL, &err));
	body.name = "ball";
	assert_ok(rb_scene_add_body(&scene, &body, NULL, &err));
	assert_string_equal(rb_scene_body_label(&scene, 0, label), "#0");
	assert_string_equal(rb_scene_body_label(&scene, 1, label), "ball");
	rb_scene_release(&scene);
}

static void assert_axis(rb_quat q, rb_vec3 local, rb_vec3 world, double tol)
{
	const rb_vec3 turned = rb_quat_rotate(q, local);

	assert_near(turned.x, world.x, tol);
	assert_near(turned.y, world.y, tol);
	assert_near(turned.z, world.z, tol);
}

static void a_planes_axes_follow_its_normal_and_axis(void **slot)
{
	const rb_vec3 none = {(double)NAN, 0, 0}, x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};

	(void)slot;
	/* along the axes the rotation is exact */
	assert_axis(rb_plane_orientation(z, none), z, z, 0);
	assert_axis(rb_plane_orientation(z, none), x, x, 0);
	assert_axis(rb_plane_orientation((rb_vec3){0, 0, -2}, none), z, (rb_vec3){0, 0, -1}, 0);
	assert_axis(rb_plane_orientation((rb_vec3){3, 0, 0}, none), z, x, 0);
	assert_axis(rb_plane_orientation((rb_vec3){3, 0, 0}, none), x, y, 0);
	/* a slope: local x is the axis projected */
	const rb_quat slope = rb_plane_orientation((rb_vec3){-3, 0, 4}, none);
	assert_axis(slope, z, (rb_vec3){-0.6, 0, 0.8}, 1e-15);
	assert_axis(slope, x, (rb_vec3){0.8, 0, 0.6}, 1e-15);
	assert_axis(rb_plane_orientation(z, (rb_vec3){1, 1, 5}), x,
	            (rb_vec3){sqrt(0.5), sqrt(0.5), 0}, 1e-15);
	/* without overflow or underflow */
	assert_axis(rb_plane_orientation((rb_vec3){0, 1e300, 1e300}, none), z,
	            (rb_vec3){0, sqrt(0.5), sqrt(0.5)}, 1e-15);
	assert_axis(rb_plane_orientation((rb_vec3){0, 1e-300, 0}, none), z, y, 1e-15);
}

/* Every allocation fails in turn: an error each time, nothing leaked. */
static void running_out_of_memory_is_an_error_at_every_allocation(void **slot)
{
	const struct rb_memory_counts before = rb_memory_counts();
	bool whole = false;

	(void)slot;
	for (uint64_t k = 1; !whole && k < 100; k++) {
		struct rb_scene scene;
		struct rb_body_def body = rb_body_def_default();
		struct rb_force_def force = rb_force_def_default();
		struct rb_camera_def camera = rb_camera_def_default();
		int group;

		body.name = "ball";
		rb_memory_fail_at(k);
		enum rb_status status = rb_scene_init(&scene, &err);
		if (status == RB_OK)
			status = rb_scene_add_body(&scene, &body, NULL, &err);
		if (status == RB_OK)
			status = rb_scene_add_force(&scene, &force, &err);
		if (status == RB_OK)
			status = rb_scene_add_camera(&scene, &camera, &err);
		if (status == RB_OK)
			status = rb_scene_group(&scene, "g", &group, &err);
		rb_memory_fail_at(0);
		whole = status == RB_OK;
		assert_true(whole || status == RB_ERR_MEMORY);
		rb_scene_release(&scene);
	}
	assert_true(whole);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_int_equal(after.taken - before.taken, after.freed - before.freed);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_fresh_scene_has_the_defaults_of_the_language),
		cmocka_unit_test(what_is_added_is_kept_in_order_with_its_own_texts),
		cmocka_unit_test(springs_drags_and_fields_are_kept_in_order),
		cmocka_unit_test(forces_belong_to_the_body_added_last),
		cmocka_unit_test(the_sixty_fourth_group_is_refused),
		cmocka_unit_test(files_keep_every_byte),
		cmocka_unit_test(a_label_is_the_name_or_the_number),
		cmocka_unit_test(a_planes_axes_follow_its_normal_and_axis),
		cmocka_unit_test(running_out_of_memory_is_an_error_at_every_allocation),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
