/* SPDX-License-Identifier: MIT */
/* src/script/shapes.c: sizes, points and parts of bodies with a volume, as scenes write them */
#include "loaded.h"

#include <float.h>

#include <rbsim/model.h>

#include "math/quat.h"
#include "math/vec3.h"
#include "model/shape.h"
#include "script/load.h"
#include "script/shapes.h"

static void sizes_arrive_where_the_shape_has_them(void **state)
{
	struct loaded it;

	(void)state;
	must_load(&it, "sphere { radius = 2 }\n"
	               "box { size = {1, 2, 3} }\n"
	               "capsule { radius = 0.5, length = 4 }\n"
	               "cylinder { radius = 0.25, length = 8 }");
	const struct rb_body_def *b = it.scene.bodies;
	const double pi = 3.14159265358979323846;
	assert_int_equal(b[0].shape.kind, RB_SHAPE_SPHERE);
	assert_int_equal(b[1].shape.kind, RB_SHAPE_BOX);
	assert_int_equal(b[2].shape.kind, RB_SHAPE_CAPSULE);
	assert_int_equal(b[3].shape.kind, RB_SHAPE_CYLINDER);
	static const double factors[] = {32.0 / 3, 6, 0, 0.5};
	for (int i = 0; i < 4; i++) {
		const double volume = i == 1   ? factors[1]
		                      : i == 2 ? pi * (0.25 * 4 + 4.0 / 3 * 0.125)
		                               : pi * factors[i];
		assert_near(rb_shape_volume(it.scene.solids, &b[i].shape), volume,
		            16 * DBL_EPSILON * volume);
		assert_string_equal(b[i].call, rb_shape_types[b[i].shape.kind]->name);
	}
	unload(&it);
}

/* A tetrahedron with three edges of 3 m from a corner: 4.5 m^3, its centroid a quarter on. */
static void a_hull_is_pushed_at_its_centroid(void **state)
{
	struct loaded it;

	(void)state;
	must_load(
		&it,
		"hull { points = {{1, 1, 1}, {4, 1, 1}, {1, 4, 1}, {1, 1, 4}, {1.5, 1.5, 1.5}} }\n"
		"hull { points = {{1, 1, 1}, {4, 1, 1}, {1, 4, 1}, {1, 1, 4}, {1.5, 1.5, 1.5}},"
		"  center_of_mass = {2, 2, 1} }\n"
		"hull { points = {{1, 1, 1}, {4, 1, 1}, {1, 4, 1}, {1, 1, 4}}, static = true }");
	const struct rb_body_def *b = it.scene.bodies;
	assert_int_equal(b[0].shape.kind, RB_SHAPE_HULL);
	const struct rb_solid *solid = &it.scene.solids[b[0].shape.solid];
	assert_int_equal(solid->vertex_count, 4);
	assert_int_equal(solid->face_count, 4);
	assert_int_equal(solid->edge_count, 6);
	assert_near(solid->volume, 4.5, 32 * DBL_EPSILON * 4.5);
	assert_near(b[0].center_of_mass.x, 1.75, 32 * DBL_EPSILON);
	assert_near(b[0].center_of_mass.z, 1.75, 32 * DBL_EPSILON);
	/* the same points have the same solid; what is said of the centre holds */
	assert_int_equal(b[1].shape.solid, b[0].shape.solid);
	assert_near(b[1].center_of_mass.x, 2, 0);
	assert_near(b[1].center_of_mass.z, 1, 0);
	/* what is not pushed has no centre but its origin */
	assert_near(rb_vec3_length(b[2].center_of_mass), 0, 0);
	unload(&it);
}

/* A box of 2 m^3 about (0, 0, 1), three times as dense as a ball at (4, 0, 0). */
static void a_union_weighs_its_parts_by_their_density(void **state)
{
	struct loaded it;

	(void)state;
	must_load(&it,
	          "body { density = 500, shapes = {\n"
	          "  { shape = 'box', size = {1, 1, 2}, position = {0, 0, 1}, density = 1500 },\n"
	          "  { shape = 'sphere', radius = 1, position = {4, 0, 0} },\n"
	          "} }\n"
	          "body { shapes = { { shape = 'cylinder', radius = 1, length = 2,\n"
	          "  orientation = {axis = {1, 0, 0}, angle = deg(90)} },\n"
	          "  { shape = 'hull', points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},\n"
	          "    density = 2000 } } }");
	const struct rb_body_def *b = it.scene.bodies;
	const double ball = 4.0 / 3 * 3.14159265358979323846;
	assert_int_equal(b[0].shape.kind, RB_SHAPE_UNION);
	const struct rb_solid *solid = &it.scene.solids[b[0].shape.solid];
	assert_int_equal(solid->part_count, 2);
	assert_near(solid->parts[0].share, 3, 0);
	assert_near(solid->parts[1].share, 1, 0);
	assert_near(solid->volume, 2 + ball, 16 * DBL_EPSILON * 8);
	assert_near(solid->weight, 6 + ball, 16 * DBL_EPSILON * 12);
	assert_near(b[0].center_of_mass.x, 4 * ball / (6 + ball), 64 * DBL_EPSILON);
	assert_near(b[0].center_of_mass.z, 6 / (6 + ball), 64 * DBL_EPSILON);

	solid = &it.scene.solids[b[1].shape.solid];
	assert_int_equal(solid->parts[0].shape.kind, RB_SHAPE_CYLINDER);
	assert_int_equal(solid->parts[1].shape.kind, RB_SHAPE_HULL);
	assert_near(solid->parts[0].shape.size[2], 2, 0);
	const rb_vec3 axis = rb_quat_rotate(solid->parts[0].orientation, (rb_vec3){0, 0, 1});
	assert_near(axis.y, -1, 4 * DBL_EPSILON); /* a quarter turn about x takes z to -y */
	/* the density of the plain material is 1000 */
	assert_near(solid->parts[1].share, 2, 0);
	unload(&it);
}

static void what_is_missing_or_too_much_is_told(void **state)
{
	(void)state;
	assert_mistake("sphere {}", "t.lua:1: sphere: 'radius' is missing");
	assert_mistake("box { name = 'b' }", "t.lua:1: box 'b': 'size' is missing");
	assert_mistake("capsule { radius = 1 }", "capsule: 'length' is missing");
	assert_mistake("cylinder { length = 1 }", "cylinder: 'radius' is missing");
	assert_mistake("hull {}", "hull: 'points' or 'file' is missing");
	assert_mistake("body {}", "body: 'shapes' is missing");
	/* one word for a key that is misspelt, not two */
	assert_mistake("sphere { raduis = 1 }", "raduis");
	assert_mistake("hull { point = {{0, 0, 0}} }", "point");
	assert_mistake("body { shape = {} }", "shape");
	assert_mistake("sphere(5)", "sphere: expected a table of keys");
	assert_mistake("body(5)", "body: expected the name of a body or a table of keys (got 5)");
	assert_mistake("box { size = {1, 2} }", "'size' must be a list of 3 numbers");
	assert_mistake("box { size = {1, 2, 0} }", "'size' must be positive");
	assert_mistake("sphere { radius = -1 }", "'radius' must be positive");
}

static void points_that_have_no_hull_are_told(void **state)
{
	(void)state;
	assert_mistake("hull { points = 5 }",
	               "'points' must be a list of points {{x, y, z}, ...} (got 5)");
	assert_mistake("hull { points = {{1, 2, 3}, {4, 5}} }",
	               "'points' must be a list of points {x, y, z} (got {4, 5} at 2)");
	assert_mistake("hull { points = {{1, 2, 3}, 'x'} }", "at 2)");
	assert_mistake("hull { points = {} }", "'points'");
	assert_mistake("hull { points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}} }", "'points'");
	assert_mistake("hull { points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}} }",
	               "'points'");
	assert_mistake("hull { points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1/0}} }",
	               "'points'");
	assert_mistake("hull { points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0/0}} }",
	               "'points'");
	assert_mistake("local p = {} for i = 1, 65537 do p[i] = 0 end hull { points = p }",
	               "65537 points are too many (wanted at most 65536)");
}

static void parts_that_make_no_union_are_told(void **state)
{
	(void)state;
	assert_mistake("body { shapes = {} }", "'shapes' must be a list of 1 to 65536 tables");
	assert_mistake("body { shapes = 'box' }", "(got the text 'box')");
	assert_mistake("body { shapes = { 5 } }",
	               "body: shapes[1]: must be a table of keys (got 5)");
	assert_mistake("body { shapes = { { radius = 1 } } }",
	               "body: shapes[1]: 'shape' is missing");
	assert_mistake("body { shapes = { { shape = 'box' } } }", "shapes[1]: 'size' is missing");
	assert_mistake("body { shapes = { { shape = 'plane' } } }", "'shape' must be one of");
	assert_mistake("body { shapes = { { shape = 'body' } } }", "'shape' must be one of");
	assert_mistake("body { shapes = { { shape = 'sphere', radius = 1 },"
	               " { shape = 'sphere', radius = 1, length = 2 } } }",
	               "shapes[2]: 'length' of a sphere: it has none");
	assert_mistake("body { shapes = { { shape = 'sphere', radius = 1, mass = 2 } } }", "mass");
	assert_mistake("body { shapes = { { shape = 'sphere', radius = 1, density = 0 } } }",
	               "shapes[1]: 'density' must be positive");
}

/* Each of a pass is told, and loading goes on behind it. */
static void all_mistakes_of_a_pass_come_together(void **state)
{
	struct loaded it;

	(void)state;
	load(&it, "sphere {}\nbox { size = 1 }\nhull { points = {} }\nbody { shapes = {} }\n"
	          "sphere { radius = 1 }");
	assert_int_equal(it.status, RB_ERR_SCENE);
	assert_int_equal(it.mistakes.count, 4);
	for (int i = 0; i < 4; i++) {
		char line[20];

		snprintf(line, sizeof line, "t.lua:%d: ", i + 1);
		assert_ptr_equal(strstr(it.mistakes.line[i], line), it.mistakes.line[i]);
	}
	unload(&it);
}

static void no_memory_is_told_as_such(void **state)
{
	static const char text[] =
		"hull { points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}} }\n"
		"body { shapes = { { shape = 'box', size = {1, 1, 1} } } }";
	int failed = 0;

	(void)state;
	for (uint64_t k = 1; k < 3000; k += 1 + k / 40) {
		struct loaded it;

		rb_memory_fail_at(k);
		load(&it, text);
		rb_memory_fail_at(0);
		if (it.status != RB_OK)
			assert_int_equal(it.status, RB_ERR_MEMORY);
		failed += it.status != RB_OK;
		unload(&it);
	}
	assert_true(failed > 20);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sizes_arrive_where_the_shape_has_them),
		cmocka_unit_test(a_hull_is_pushed_at_its_centroid),
		cmocka_unit_test(a_union_weighs_its_parts_by_their_density),
		cmocka_unit_test(what_is_missing_or_too_much_is_told),
		cmocka_unit_test(points_that_have_no_hull_are_told),
		cmocka_unit_test(parts_that_make_no_union_are_told),
		cmocka_unit_test(all_mistakes_of_a_pass_come_together),
		cmocka_unit_test(no_memory_is_told_as_such),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
