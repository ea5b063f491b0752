/* SPDX-License-Identifier: MIT */
/* src/sink/h5solids.c: what hulls and unions are made of, written and read back */
#include "h5place.h"

#include "model/shape.h"
#include "sink/h5solids.h"

/* A tetrahedron, a union of a ball, a capsule and that tetrahedron, and bodies of them. */
static void open_scene(struct rb_scene *scene)
{
	static const rb_vec3 points[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	static const enum rb_shape_kind kinds[] = {RB_SHAPE_HULL, RB_SHAPE_SPHERE, RB_SHAPE_UNION,
	                                           RB_SHAPE_BOX, RB_SHAPE_HULL};
	struct rb_error err;
	int hull = -1, joined = -1;

	assert_ok(rb_scene_init(scene, &err));
	assert_ok(rb_scene_add_hull(scene, points, 4, &hull, &err));
	const struct rb_solid_part parts[] = {
		{.shape = {.kind = RB_SHAPE_SPHERE, .solid = 77, .radius = 2},
	         .position = {5, 6, 7},
	         .orientation = {1, 0, 0, 0},
	         .share = 1},
		{.shape = {.kind = RB_SHAPE_CAPSULE, .radius = 0.5, .size = {0, 0, 3}},
	         .position = {-5, 0, 0},
	         .orientation = {0, 1, 0, 0},
	         .share = 0.25},
		{.shape = {.kind = RB_SHAPE_HULL, .solid = hull},
	         .orientation = {0, 0, 1, 0},
	         .share = 4}};
	assert_ok(rb_scene_add_union(scene, parts, 3, &joined, &err));
	for (int i = 0; i < 5; i++) {
		struct rb_body_def def = rb_body_def_default();

		def.shape = (struct rb_shape){
			.kind = kinds[i], .solid = 99, .radius = 1, .size = {1, 1, 1}};
		if (kinds[i] == RB_SHAPE_HULL)
			def.shape.solid = hull;
		if (kinds[i] == RB_SHAPE_UNION)
			def.shape.solid = joined;
		assert_ok(rb_scene_add_body(scene, &def, NULL, &err));
	}
}

/* `count` numbers of a list, of `width` each where that is more than one. */
static void read_list(struct file *file, const char *path, enum rb_h5_kind kind, hsize_t count,
                      hsize_t width, void *out)
{
	const hid_t dataset = H5Dopen2(file->h5.file, path, H5P_DEFAULT);
	const hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);
	hsize_t size[2] = {0, 1};

	if (space < 0)
		fail_msg("no '%s'", path);
	assert_int_equal(H5Sget_simple_extent_dims(space, size, NULL), width > 1 ? 2 : 1);
	if (size[0] != count || size[1] != width)
		fail_msg("'%s' has %d rows of %d", path, (int)size[0], (int)size[1]);
	assert_true(H5Dread(dataset, rb_h5_type(kind), H5S_ALL, H5S_ALL, H5P_DEFAULT, out) >= 0);
	rb_h5_done(space);
	rb_h5_done(dataset);
}

static void lists_are_laid_end_to_end(void **state)
{
	struct file file;
	struct rb_scene scene;
	int32_t n[16];
	double x[16];

	(void)state;
	open_file(&file);
	open_scene(&scene);
	rb_solids_write(&file.h5, &scene);
	turn_file(&file, H5F_ACC_RDONLY);
	read_list(&file, "/rbsim/solids/vertex_count", RB_H5_I32, 2, 1, n);
	assert_true(n[0] == 4 && n[1] == 0);
	read_list(&file, "/rbsim/solids/face_count", RB_H5_I32, 2, 1, n);
	assert_true(n[0] == 4 && n[1] == 0);
	read_list(&file, "/rbsim/solids/part_count", RB_H5_I32, 2, 1, n);
	assert_true(n[0] == 0 && n[1] == 3);
	read_list(&file, "/rbsim/solids/volume", RB_H5_F64, 2, 1, x);
	assert_near(x[0], 1 / 6.0, 1e-15);
	/* a ball of radius 2, a capsule of 0.5 about 3 m, the tetrahedron */
	const double pi = 3.14159265358979323846;
	assert_near(x[1], pi * (32 / 3.0 + 0.75 + 1 / 6.0) + 1 / 6.0, 1e-13);
	read_list(&file, "/rbsim/solids/centroid", RB_H5_F64, 2, 3, x);
	for (int i = 0; i < 3; i++)
		assert_near(x[i], 0.25, 1e-15);
	read_list(&file, "/rbsim/solids/vertices", RB_H5_F64, 4, 3, x);
	for (int i = 0; i < 12; i++)
		assert_true(x[i] == (i == 3 || i == 7 || i == 11));
	read_list(&file, "/rbsim/solids/face_first", RB_H5_I32, 5, 1, n);
	for (int i = 0; i < 5; i++)
		assert_int_equal(n[i], 3 * i);
	read_list(&file, "/rbsim/solids/loops", RB_H5_I32, 12, 1, n);
	int found[4] = {0};
	for (int i = 0; i < 12; i++)
		found[n[i]]++;
	for (int i = 0; i < 4; i++) /* each corner is one of three faces */
		assert_int_equal(found[i], 3);
	read_list(&file, "/rbsim/solids/parts/kind", RB_H5_I32, 3, 1, n);
	assert_true(n[0] == RB_SHAPE_SPHERE && n[1] == RB_SHAPE_CAPSULE && n[2] == RB_SHAPE_HULL);
	read_list(&file, "/rbsim/solids/parts/radius", RB_H5_F64, 3, 1, x);
	assert_true(x[0] == 2 && x[1] == 0.5);
	read_list(&file, "/rbsim/solids/parts/size", RB_H5_F64, 3, 3, x);
	assert_true(x[5] == 3);
	read_list(&file, "/rbsim/solids/parts/position", RB_H5_F64, 3, 3, x);
	assert_true(x[0] == 5 && x[2] == 7 && x[3] == -5 && x[8] == 0);
	read_list(&file, "/rbsim/solids/parts/orientation", RB_H5_F64, 3, 4, x);
	assert_true(x[0] == 1 && x[5] == 1 && x[10] == 1);
	read_list(&file, "/rbsim/solids/parts/share", RB_H5_F64, 3, 1, x);
	assert_true(x[0] == 1 && x[1] == 0.25 && x[2] == 4);
	rb_scene_release(&scene);
	close_file(&file);
}

/* Whatever a shape has in its field that is not read of its kind. */
static void only_shapes_that_need_a_solid_refer_to_one(void **state)
{
	struct file file;
	struct rb_scene scene;
	int32_t n[5];

	(void)state;
	open_file(&file);
	open_scene(&scene);
	rb_solids_write(&file.h5, &scene);
	turn_file(&file, H5F_ACC_RDONLY);
	read_list(&file, "/rbsim/shapes/solid", RB_H5_I32, 5, 1, n);
	static const int wanted[] = {0, -1, 1, -1, 0};
	for (int i = 0; i < 5; i++)
		assert_int_equal(n[i], wanted[i]);
	read_list(&file, "/rbsim/solids/parts/solid", RB_H5_I32, 3, 1, n);
	assert_true(n[0] == -1 && n[1] == -1 && n[2] == 0);
	rb_scene_release(&scene);
	close_file(&file);
}

static void a_scene_without_solids_has_none_of_it(void **state)
{
	struct file file;
	struct rb_scene scene;
	struct rb_error err;

	(void)state;
	open_file(&file);
	assert_ok(rb_scene_init(&scene, &err));
	rb_solids_write(&file.h5, &scene);
	assert_int_equal(file.h5.status, RB_OK);
	assert_int_equal(H5Lexists(file.h5.file, "/rbsim", H5P_DEFAULT), 0);
	rb_scene_release(&scene);
	open_scene(&scene);
	rb_memory_fail_at(1);
	rb_solids_write(&file.h5, &scene);
	rb_memory_fail_at(0);
	assert_int_equal(file.h5.status, RB_ERR_MEMORY);
	assert_non_null(strstr(file.h5.error.text, "out of memory"));
	file.h5.status = RB_OK;
	rb_scene_release(&scene);
	close_file(&file);
}

static void kinds_are_named_by_number(void **state)
{
	char text[160], word[40];

	(void)state;
	rb_solids_kinds(text);
	const char *at = text;
	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++) {
		snprintf(word, sizeof word, "%s%d %s", k > 0 ? ", " : "", k,
		         rb_shape_types[k]->name);
		assert_ptr_equal(strstr(at, word), at);
		at += strlen(word);
	}
	assert_int_equal(*at, '\0');
}

static void shapes_are_counted_by_kind(void **state)
{
	static const int32_t kinds[] = {RB_SHAPE_BOX, RB_SHAPE_SPHERE, RB_SHAPE_BOX, -1,
	                                1000,         RB_SHAPE_UNION};
	struct file file;
	struct rb_input input;
	struct rb_error err;
	int kind[7], counts[RB_SHAPE_KIND_COUNT];

	(void)state;
	open_file(&file);
	assert_true(H5Fflush(file.h5.file, H5F_SCOPE_LOCAL) >= 0);
	rb_h5_put(&file.h5, "/rbsim/shapes/kind", RB_H5_I32, (rb_h5_shape){1, {6}}, kinds);
	turn_file(&file, H5F_ACC_RDONLY);
	assert_ok(rb_input_open(&input, file.path, &err));
	assert_true(rb_solids_tally(&input, 6, kind, counts));
	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++)
		assert_int_equal(counts[k], k == RB_SHAPE_BOX                             ? 2
		                            : k == RB_SHAPE_SPHERE || k == RB_SHAPE_UNION ? 1
		                                                                          : 0);
	assert_false(rb_solids_tally(&input, 7, kind, counts)); /* there are not so many */
	rb_input_close(&input);
	close_file(&file);
	open_file(&file);
	turn_file(&file, H5F_ACC_RDONLY);
	assert_ok(rb_input_open(&input, file.path, &err));
	assert_true(rb_solids_tally(&input, 0, kind, counts));
	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++)
		assert_int_equal(counts[k], 0);
	rb_input_close(&input);
	close_file(&file);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lists_are_laid_end_to_end),
		cmocka_unit_test(only_shapes_that_need_a_solid_refer_to_one),
		cmocka_unit_test(a_scene_without_solids_has_none_of_it),
		cmocka_unit_test(kinds_are_named_by_number),
		cmocka_unit_test(shapes_are_counted_by_kind),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
