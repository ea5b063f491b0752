/* SPDX-License-Identifier: MIT */
/* src/film/mesh.c: triangles that enclose what their shapes do */
#include "worlds.h"

#include <float.h>

#include "film/mesh.h"
#include "solids.h"

/* Where a vertex stands from the shape's middle, by the rule of the header. */
static rb_vec3 place(const struct rb_mesh_vertex *vertex, const struct rb_mesh_fit *fit)
{
	return (rb_vec3){(double)fit->scale[0] * (double)vertex->unit[0],
	                 (double)fit->scale[1] * (double)vertex->unit[1],
	                 (double)fit->scale[2] * (double)vertex->unit[2] +
	                         (double)fit->shift * (double)vertex->unit[3]};
}

/* What the triangles of a range enclose, by the theorem of Gauss. */
static double volume_of(const struct rb_mesh *mesh, struct rb_mesh_range range,
                        const struct rb_mesh_fit *fit)
{
	double sum = 0;

	for (int k = 0; k < range.count; k += 3) {
		const uint32_t *index = mesh->indices + range.first + (size_t)k;
		const rb_vec3 a = place(&mesh->vertices[index[0]], fit),
			      b = place(&mesh->vertices[index[1]], fit),
			      c = place(&mesh->vertices[index[2]], fit);
		sum += rb_vec3_dot(a, rb_vec3_cross(b, c)) / 6;
	}
	return sum;
}

/* Boxes and hulls exactly, to single precision; prisms too: they have the area of their circles. */
static void meshes_enclose_the_volumes_of_their_shapes(void **state)
{
	struct rb_mesh mesh = {0};
	struct rb_mesh_range range;
	struct rb_error err;
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	for (uint64_t k = 0; k < 30; k++) {
		struct rb_shape shape = {.radius = solids_random(k, 0, 0.1, 3),
		                         .size = {solids_random(k, 1, 0.1, 3),
		                                  solids_random(k, 2, 0.1, 3),
		                                  solids_random(k, 3, 0.1, 9)}};
		rb_vec3 points[12];

		for (uint64_t i = 0; i < 12; i++)
			points[i] = (rb_vec3){solids_random(k, 3 * i + 10, 5, 6),
			                      solids_random(k, 3 * i + 11, -1, 1),
			                      solids_random(k, 3 * i + 12, -1, 1)};
		assert_int_equal(
			rb_scene_add_hull(&lab.scene, points, 12, &shape.solid, &lab.error), RB_OK);
		static const enum rb_shape_kind kinds[] = {RB_SHAPE_BOX, RB_SHAPE_HULL,
		                                           RB_SHAPE_CYLINDER, RB_SHAPE_CAPSULE};
		for (int i = 0; i < 4; i++) {
			shape.kind = kinds[i];
			const struct rb_part_size size = rb_part_size(&lab.scene, &shape);
			const struct rb_mesh_fit fit = rb_mesh_fit(&shape, &size, 0, false);
			const double volume = rb_shape_volume(lab.scene.solids, &shape);

			if (i < 2)
				assert_ok(
					rb_mesh_add_faces(&mesh, &lab.scene, &shape, &range, &err));
			else
				assert_ok(rb_mesh_add_round(&mesh, rb_shape_type(&shape)->form, 64,
				                            &range, &err));
			/* latitudes of a capsule are polygons, too, 16 to its quarter */
			assert_near(volume_of(&mesh, range, &fit), volume,
			            volume * (i == 3 ? 3e-3 : 1e-5));
		}
	}
	rb_mesh_release(&mesh);
	rb_mesh_release(&mesh);
	lab_close(&lab);
}

/* Every edge of the surface is gone along once in each direction. */
static void rounds_are_closed_and_normals_have_length_one(void **state)
{
	static const enum rb_shape_form forms[] = {RB_FORM_CAPSULE, RB_FORM_CYLINDER};
	const struct rb_mesh_fit fit = {.scale = {1, 1, 1}, .shift = 2};
	struct rb_error err;

	(void)state;
	for (int f = 0; f < 2; f++)
		for (int sides = 4; sides <= 32; sides *= 2) {
			struct rb_mesh mesh = {0};
			struct rb_mesh_range range;
			rb_vec3 sum = {0, 0, 0};

			assert_ok(rb_mesh_add_round(&mesh, forms[f], sides, &range, &err));
			assert_int_equal(range.count % 3, 0);
			for (int k = 0; k < range.count; k += 3) {
				const uint32_t *index = mesh.indices + k;
				rb_vec3 at[3], normal = {0, 0, 0};

				for (int i = 0; i < 3; i++) {
					const struct rb_mesh_vertex *v = &mesh.vertices[index[i]];
					const rb_vec3 n = {(double)v->normal[0],
					                   (double)v->normal[1],
					                   (double)v->normal[2]};

					assert_true(index[i] < mesh.vertex_count);
					assert_near(rb_vec3_length(n), 1, 1e-6);
					at[i] = place(v, &fit);
					normal = rb_vec3_add(normal, n);
				}
				/* counter-clockwise seen from outside; no area at the poles */
				const rb_vec3 area = rb_vec3_cross(rb_vec3_sub(at[1], at[0]),
				                                   rb_vec3_sub(at[2], at[0]));
				assert_true(rb_vec3_dot(area, normal) > -1e-6);
				sum = rb_vec3_add(sum, area);
			}
			/* the areas of a closed surface add up to nothing */
			assert_vector(sum, ((rb_vec3){0, 0, 0}), 1e-5);
			rb_mesh_release(&mesh);
		}
}

static void each_range_has_its_own_triangles(void **state)
{
	const struct rb_shape box = {.kind = RB_SHAPE_BOX, .size = {2, 2, 2}};
	const struct rb_mesh_fit fit = {.scale = {1, 1, 1}};
	struct rb_mesh mesh = {0};
	struct rb_mesh_range ranges[5];
	struct rb_error err;
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	for (int k = 0; k < 5; k++) {
		assert_ok(rb_mesh_add_faces(&mesh, &lab.scene, &box, &ranges[k], &err));
		assert_int_equal(ranges[k].count, 36); /* two triangles a face */
		assert_int_equal(ranges[k].first, 36 * k);
		assert_int_equal(mesh.vertex_count, 24 * (k + 1));
	}
	for (int k = 0; k < 5; k++)
		assert_near(volume_of(&mesh, ranges[k], &fit), 8, 1e-6);
	rb_mesh_release(&mesh);
	for (uint64_t k = 1; k <= 2; k++) {
		rb_memory_fail_at(k);
		const enum rb_status status = rb_mesh_add_faces(&mesh, &lab.scene, &box, ranges,
		                                                &err);
		rb_memory_fail_at(0);
		assert_int_equal(status, RB_ERR_MEMORY);
		assert_int_equal(mesh.vertex_count + mesh.index_count, 0);
		rb_mesh_release(&mesh);
		rb_memory_fail_at(k);
		const enum rb_status round = rb_mesh_add_round(&mesh, RB_FORM_CAPSULE, 8, ranges,
		                                               &err);
		rb_memory_fail_at(0);
		assert_int_equal(round, RB_ERR_MEMORY);
		assert_int_equal(mesh.vertex_count + mesh.index_count, 0);
		rb_mesh_release(&mesh);
	}
	lab_close(&lab);
}

/* A square of a pattern, counted from the middle, ends at the edges: their number is even. */
static void squares_end_at_the_edges_of_faces(void **state)
{
	struct rb_mesh mesh = {0};
	struct rb_mesh_range range;
	struct rb_error err;
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	for (uint64_t k = 0; k < 60; k++) {
		const struct rb_shape box = {.kind = RB_SHAPE_BOX,
		                             .size = {solids_random(k, 1, 0.01, 9),
		                                      solids_random(k, 2, 0.01, 9),
		                                      solids_random(k, 3, 0.01, 9)}};
		const struct rb_part_size size = rb_part_size(&lab.scene, &box);
		const struct rb_mesh_fit fit = rb_mesh_fit(&box, &size, 0, false);

		for (int i = 0; i < 3; i++) {
			const double count = (double)fit.count[i];
			assert_true(count >= 2 && count <= 16 && fmod(count, 2) == 0);
		}
		if (k > 0)
			continue;
		/* from edge to edge a texture goes from -1/2 to 1/2 of the count */
		assert_ok(rb_mesh_add_faces(&mesh, &lab.scene, &box, &range, &err));
		for (size_t i = 0; i < mesh.vertex_count; i++) {
			assert_near(fabs((double)mesh.vertices[i].tex[0]), 0.5, 1e-6);
			assert_near(fabs((double)mesh.vertices[i].tex[1]), 0.5, 1e-6);
		}
		rb_mesh_release(&mesh);
	}
	const struct rb_shape capsule = {
		.kind = RB_SHAPE_CAPSULE, .radius = 0.5, .size = {0, 0, 3}};
	const struct rb_part_size size = rb_part_size(&lab.scene, &capsule);
	for (int picture = 0; picture < 2; picture++) {
		const struct rb_mesh_fit fit = rb_mesh_fit(&capsule, &size, 0, picture);
		/* from pole to pole: half a turn of the balls at its ends and the way between */
		const double pole = (double)fit.count[1] * acos(0) + (double)fit.count[3];
		const double squares = 2 * pole;

		assert_near(squares, picture ? 1 : rint(squares), 1e-5);
		assert_near(fmod(rint(squares), 2), picture ? 1 : 0, 0);
		assert_near((double)fit.shift, 1.5, 0);
		assert_near((double)fit.scale[2], 0.5, 0);
	}
	lab_close(&lab);
}

/* Not even a sheet of paper vanishes. */
static void nothing_is_thinner_than_was_asked_for(void **state)
{
	const struct rb_shape sheet = {.kind = RB_SHAPE_BOX, .size = {4, 2, 1e-6}},
			      wire = {.kind = RB_SHAPE_CYLINDER, .radius = 1e-6, .size = {0, 0, 8}};
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	struct rb_part_size size = rb_part_size(&lab.scene, &sheet);
	struct rb_mesh_fit fit = rb_mesh_fit(&sheet, &size, 0.125, false);
	assert_true(fit.scale[0] == 2 && fit.scale[1] == 1 && fit.scale[2] == 0.125f);
	size = rb_part_size(&lab.scene, &wire);
	fit = rb_mesh_fit(&wire, &size, 0.125, true);
	assert_true(fit.scale[0] == 0.125f && fit.scale[1] == 0.125f && fit.scale[2] == 4);
	/* one picture covers the side, and one each end */
	assert_true(fit.count[0] == 1 && fit.count[1] == 1 && fit.count[2] == 1);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(meshes_enclose_the_volumes_of_their_shapes),
		cmocka_unit_test(rounds_are_closed_and_normals_have_length_one),
		cmocka_unit_test(each_range_has_its_own_triangles),
		cmocka_unit_test(squares_end_at_the_edges_of_faces),
		cmocka_unit_test(nothing_is_thinner_than_was_asked_for),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
