/* SPDX-License-Identifier: MIT */
/* src/shape/shape_types.c and all rows of shapes: what a row says in one way must follow from what it says
 * in another. */
#include "shape/shape_types.h"

#include "math/quat.h"
#include "math/random.h"

#include "support.h"

static struct rb_scene scene;
static int hull, both, slope;

/* One of each type that has a volume, with sizes that differ. */
static int all_shapes(struct rb_shape shape[RB_SHAPE_KIND_COUNT])
{
	static const rb_vec3 corner[5] = {{-0.3, -0.4, -0.5},
	                                  {0.7, -0.2, -0.4},
	                                  {0, 0.9, -0.3},
	                                  {0.1, 0.1, 0.8},
	                                  {-0.6, 0.5, 0.2}};
	const struct rb_solid_part parts[2] = {
		{.shape = {.kind = RB_SHAPE_BOX, .size = {0.4, 0.5, 0.6}},
	         .position = {-0.5, 0, 0.1},
	         .orientation = {1, 0, 0, 0},
	         .share = 1},
		{.shape = {.kind = RB_SHAPE_CYLINDER, .radius = 0.2, .size = {0, 0, 0.7}},
	         .position = {0.5, 0.1, 0},
	         .orientation = {sqrt(0.5), sqrt(0.5), 0, 0},
	         .share = 1}};
	static const int triangle[1][3] = {{0, 1, 2}};
	const struct rb_terrain_def terrain = {
		.vertices = corner, .corners = triangle, .vertex_count = 3, .count = 1};
	int count = 0;

	if (scene.solid_count == 0) {
		assert_int_equal(rb_scene_init(&scene, NULL), RB_OK);
		assert_int_equal(rb_scene_add_hull(&scene, corner, 5, &hull, NULL), RB_OK);
		assert_int_equal(rb_scene_add_union(&scene, parts, 2, &both, NULL), RB_OK);
		assert_int_equal(rb_scene_add_terrain(&scene, &terrain, &slope, NULL), RB_OK);
	}
	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++)
		if (rb_shape_types[k]->form != RB_FORM_SURFACE && k != RB_SHAPE_TERRAIN)
			shape[count++] = (struct rb_shape){.kind = (enum rb_shape_kind)k,
			                                   .solid = k == RB_SHAPE_UNION ? both
			                                                                : hull,
			                                   .radius = 0.3,
			                                   .size = {0.5, 0.6, 0.8}};
	return count;
}

static int release(void **state)
{
	(void)state;
	rb_scene_release(&scene);
	return 0;
}

/* m: negative inside. */
static double distance(const struct rb_shape *shape, rb_vec3 p)
{
	const struct rb_solid *const solid = rb_shape_solid(shape) < 0
	                                             ? NULL
	                                             : &scene.solids[shape->solid];
	double largest = -(double)INFINITY;

	if (rb_shape_type(shape)->distance)
		return rb_shape_type(shape)->distance(shape, p);
	if (solid->part_count > 0) {
		for (int k = 0; k < solid->part_count; k++) {
			const struct rb_solid_part *const part = &solid->parts[k];
			const rb_vec3 local = rb_quat_rotate_back(part->orientation,
			                                          rb_vec3_sub(p, part->position));

			largest = fmax(largest, -distance(&part->shape, local));
		}
		return -largest;
	}
	for (int f = 0; f < solid->face_count; f++) {
		const int *const loop = solid->loops + solid->face_first[f];
		const rb_vec3 a = solid->vertices[loop[0]], b = solid->vertices[loop[1]],
			      c = solid->vertices[loop[2]];
		const rb_vec3 n = rb_vec3_cross(rb_vec3_sub(b, a), rb_vec3_sub(c, a));

		largest = fmax(largest, rb_vec3_dot(rb_vec3_unit(n, n), rb_vec3_sub(p, a)));
	}
	return largest;
}

/*
 * Points on a grid of 80^3 that lie inside count as much as their cells. A pair of sides along the
 * grid is off by a cell at most, so that three are by 3/2 of a cell for each half width.
 */
static void mass_is_that_of_the_points_inside(void **state)
{
	struct rb_shape shapes[RB_SHAPE_KIND_COUNT];
	const int count = all_shapes(shapes);
	enum { CELLS = 80 };

	(void)state;
	for (int s = 0; s < count; s++) {
		const double reach = rb_shape_reach(scene.solids, &shapes[s]);
		const double cell = 2.02 * reach / CELLS;
		double volume = 0, inertia[3][3] = {{0}};
		rb_vec3 first = {0, 0, 0};
		const rb_vec3 centroid = rb_shape_centroid(scene.solids, &shapes[s]);

		for (int k = 0; k < CELLS * CELLS * CELLS; k++) {
			const rb_vec3 p = {(k % CELLS - 0.5 * (CELLS - 1)) * cell,
			                   (k / CELLS % CELLS - 0.5 * (CELLS - 1)) * cell,
			                   (k / CELLS / CELLS - 0.5 * (CELLS - 1)) * cell};

			if (distance(&shapes[s], p) > 0)
				continue;
			const rb_vec3 arm = rb_vec3_sub(p, centroid);
			const double x[3] = {arm.x, arm.y, arm.z};

			volume += cell * cell * cell;
			first = rb_vec3_add_scaled(first, cell * cell * cell, arm);
			for (int i = 0; i < 3; i++)
				for (int j = 0; j < 3; j++)
					inertia[i][j] += cell * cell * cell *
					                 ((i == j ? rb_vec3_dot(arm, arm) : 0) -
					                  x[i] * x[j]);
		}
		const double want = rb_shape_volume(scene.solids, &shapes[s]);
		const rb_mat3 tensor = rb_shape_inertia(scene.solids, &shapes[s], want);

		const double bound = 1.5 * cell / rb_shape_half_width(scene.solids, &shapes[s]);

		assert_near(volume / want, 1, bound);
		assert_true(rb_vec3_length(first) < bound * want * reach);
		for (int i = 0; i < 9; i++)
			assert_near(inertia[i / 3][i % 3], tensor.m[i / 3][i % 3],
			            bound * (tensor.m[0][0] + tensor.m[1][1] + tensor.m[2][2]));
	}
}

static void reach_width_box_and_core_belong_together(void **state)
{
	struct rb_shape shapes[RB_SHAPE_KIND_COUNT];
	const int count = all_shapes(shapes);
	const struct rb_solid *solid;

	(void)state;
	for (int s = 0; s < count; s++) {
		const struct rb_shape_type *const type = rb_shape_type(&shapes[s]);
		const double reach = rb_shape_reach(scene.solids, &shapes[s]);
		const double width = rb_shape_half_width(scene.solids, &shapes[s]);
		rb_core core;

		assert_true(width > 0 && width <= reach);
		if (type->form == RB_FORM_UNION)
			continue;
		assert_int_equal(rb_shape_core(scene.solids, &shapes[s], &core, NULL), RB_OK);
		assert_near(core.reach + core.radius, reach, 1e-15);
		for (int axis = 0; axis < 3 && type->half; axis++) {
			const rb_placed placed = {
				.core = &core, .at = {0, 0, 0}, .turn = rb_mat3_diagonal(1, 1, 1)};
			const rb_vec3 way = {axis == 0, axis == 1, axis == 2};

			assert_near(rb_placed_height(&placed, way) + core.radius,
			            rb_vec3_dot(type->half(&shapes[s]), way), 1e-15);
		}
		if (core.kind == RB_CORE_POLYTOPE)
			rb_polytope_destroy((struct rb_polytope *)(uintptr_t)core.polytope);
	}
	solid = &scene.solids[hull];
	assert_near(solid->reach,
	            rb_shape_reach(scene.solids,
	                           &(struct rb_shape){.kind = RB_SHAPE_HULL, .solid = hull}),
	            0);
}

/* From outside the nearest point is as far away as a step along the gradient says. */
static void distances_are_those_to_the_surface(void **state)
{
	struct rb_shape shapes[RB_SHAPE_KIND_COUNT];
	const int count = all_shapes(shapes);

	(void)state;
	for (int s = 0; s < count; s++) {
		for (uint64_t k = 0; k < 200 && rb_shape_type(&shapes[s])->distance; k++) {
			rb_vec3 p = {rb_random_unit(7, 1, 3 * k) * 4 - 2,
			             rb_random_unit(7, 1, 3 * k + 1) * 4 - 2,
			             rb_random_unit(7, 1, 3 * k + 2) * 4 - 2};
			const double d = distance(&shapes[s], p), h = 1e-6;
			const rb_vec3 gradient = {
				(distance(&shapes[s], rb_vec3_add(p, (rb_vec3){h, 0, 0})) - d) / h,
				(distance(&shapes[s], rb_vec3_add(p, (rb_vec3){0, h, 0})) - d) / h,
				(distance(&shapes[s], rb_vec3_add(p, (rb_vec3){0, 0, h})) - d) / h};

			if (d < 0.01)
				continue;
			assert_near(rb_vec3_length(gradient), 1, 1e-4);
			p = rb_vec3_add_scaled(p, -d, gradient);
			assert_near(distance(&shapes[s], p), 0, 1e-4);
		}
	}
}

static void every_number_that_a_row_reads_has_a_fault_and_a_text(void **state)
{
	static const char *const want[RB_SHAPE_KIND_COUNT] = {
		"sphere 2",     "plane",  "rectangle 3 4", "box 3 4 5", "capsule 2 5",
		"cylinder 2 5", "hull 5", "union 2",       "terrain 3"};

	all_shapes((struct rb_shape[RB_SHAPE_KIND_COUNT]){{0}});
	(void)state;
	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++) {
		const struct rb_shape_type *const type = rb_shape_types[k];
		const struct rb_shape right = {.kind = (enum rb_shape_kind)k,
		                               .solid = k == RB_SHAPE_UNION     ? both
		                                        : k == RB_SHAPE_TERRAIN ? slope
		                                                                : hull,
		                               .radius = 2,
		                               .size = {3, 4, 5}};
		char text[RB_SHAPE_FAULT_SIZE];

		rb_shape_text(scene.solids, &right, text);
		assert_string_equal(text, want[k]);
		assert_string_equal(rb_shape_name((enum rb_shape_kind)k), type->name);
		assert_true(type->key_count <= RB_SHAPE_KEYS_MAX);
		if (!type->fault)
			continue;
		assert_false(type->fault(&right, text));
		for (unsigned bit = RB_SHAPE_READS_RADIUS, at = 0; at < 4; bit *= 2, at++) {
			struct rb_shape wrong = right;

			*(at == 0 ? &wrong.radius : &wrong.size[at - 1]) = -1;
			assert_int_equal(type->fault(&wrong, text), rb_shape_reads(&right, bit));
			*(at == 0 ? &wrong.radius : &wrong.size[at - 1]) = (double)INFINITY;
			assert_int_equal(type->fault(&wrong, text), rb_shape_reads(&right, bit));
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(mass_is_that_of_the_points_inside),
		cmocka_unit_test(reach_width_box_and_core_belong_together),
		cmocka_unit_test(distances_are_those_to_the_surface),
		cmocka_unit_test(every_number_that_a_row_reads_has_a_fault_and_a_text),
	};

	return cmocka_run_group_tests(tests, NULL, release);
}
