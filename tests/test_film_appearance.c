/* SPDX-License-Identifier: MIT */
/* src/film/appearance.c: colours, patterns and pictures of bodies */
#include "worlds.h"

#include "film/appearance.h"
#include "film/png.h"

struct stage {
	struct lab lab;
	struct rb_looks looks;
	struct rb_error err;
};

static void open_stage(struct stage *stage)
{
	*stage = (struct stage){0};
	lab_open(&stage->lab, 1, 10);
	stage->lab.scene.file = "s.lua";
}

static void seal(struct stage *stage)
{
	if (rb_model_create(&stage->lab.model, &stage->lab.scene, NULL, &stage->lab.error) != RB_OK)
		fail_msg("%s", stage->lab.error.text);
}

static void look(struct stage *stage)
{
	seal(stage);
	if (rb_looks_make(&stage->looks, stage->lab.model, &stage->err) != RB_OK)
		fail_msg("%s", stage->err.text);
}

static const struct rb_look *look_of(const struct stage *stage, int id)
{
	return &stage->looks.of[stage->lab.model->index_of[id]];
}

static void close_stage(struct stage *stage)
{
	rb_looks_release(&stage->looks);
	rb_looks_release(&stage->looks);
	lab_close(&stage->lab);
}

static struct rb_body_def ball(double x, const char *texture)
{
	struct rb_body_def def = lab_sphere_def(0.5, 1, (rb_vec3){x, 0, 9}, (rb_vec3){0, 0, 0});

	def.texture = texture;
	return def;
}

/* Numbers of IEC 61966-2-1; the inverse of its formula, over the whole range. */
static void srgb_becomes_linear_light(void **state)
{
	(void)state;
	assert_near(rb_look_linear(0), 0, 0);
	assert_near(rb_look_linear(1), 1, 1e-15);
	assert_near(rb_look_linear(0.5), 0.21404114048223255, 1e-15);
	assert_near(rb_look_linear(0.04045), 0.0031308, 1e-7);
	for (int k = 0; k <= 1000; k++) {
		const double linear = rb_look_linear(k / 1000.0);
		const double back = linear <= 0.0031308 ? 12.92 * linear
		                                        : 1.055 * pow(linear, 1 / 2.4) - 0.055;

		assert_near(back, k / 1000.0, 1e-7);
		assert_true(k == 0 || linear > rb_look_linear((k - 1) / 1000.0));
	}
}

static void a_colour_comes_from_the_body_or_its_material_or_a_palette(void **state)
{
	struct rb_material_def own = rb_material_def_default(), plain = rb_material_def_default();
	struct stage stage;
	int material = 0;

	(void)state;
	open_stage(&stage);
	own.color[0] = own.color[1] = 0;
	own.color[2] = 1;
	own.shininess = 7;
	assert_int_equal(rb_scene_add_material(&stage.lab.scene, &own, &material, NULL), RB_OK);
	struct rb_body_def def = ball(0, NULL);
	def.material = material;
	lab_add(&stage.lab, &def); /* 0: of the material */
	def.position.x = 2;
	def.color[0] = 1;
	def.color[1] = def.color[2] = 0;
	lab_add(&stage.lab, &def);    /* 1: its own */
	for (int k = 0; k < 3; k++) { /* 2 to 4: of materials without a colour */
		assert_int_equal(rb_scene_add_material(&stage.lab.scene, &plain, &material, NULL),
		                 RB_OK);
		def = ball(4 + 2 * k, NULL);
		def.material = material;
		def.visible = k != 1;
		lab_add(&stage.lab, &def);
	}
	lab_plane(&stage.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1}); /* 5 */
	look(&stage);
	const struct rb_look *of[6];
	for (int id = 0; id < 6; id++)
		of[id] = look_of(&stage, id);
	assert_true(of[0]->colour[0] == 0 && of[0]->colour[2] > 0.5f && of[0]->gloss == 7);
	assert_true(of[1]->colour[0] > 0.5f && of[1]->colour[2] == 0);
	for (int id = 0; id < 6; id++)
		for (int k = 0; k < 3; k++)
			assert_true(of[id]->colour[k] >= 0 && of[id]->colour[k] < 1);
	for (int id = 3; id < 5; id++) /* neighbours in the palette are not alike */
		assert_true(memcmp(of[id]->colour, of[id - 1]->colour, sizeof of[id]->colour) != 0);
	assert_true(of[2]->visible && !of[3]->visible);
	/* spheres shine, planes do not, and are grey */
	assert_true(of[2]->gloss > 0 && of[5]->gloss == 0);
	assert_near((double)of[5]->colour[0], (double)of[5]->colour[2], 0.05);
	close_stage(&stage);
}

static void patterns_are_those_that_were_named(void **state)
{
	struct rb_material_def striped = rb_material_def_default();
	struct stage stage;
	int material = 0;

	(void)state;
	open_stage(&stage);
	striped.texture = "stripes";
	assert_int_equal(rb_scene_add_material(&stage.lab.scene, &striped, &material, NULL), RB_OK);
	static const char *const names[] = {"none", "checker", "stripes", "beachball", NULL};
	for (int k = 0; k < 5; k++) {
		const struct rb_body_def def = ball(2 * k, names[k]);
		lab_add(&stage.lab, &def);
	}
	struct rb_body_def def = ball(20, NULL);
	def.material = material;
	lab_add(&stage.lab, &def); /* 5: of its material */
	def = ball(22, "none");
	def.material = material;
	lab_add(&stage.lab, &def);                                     /* 6: its own */
	lab_plane(&stage.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1}); /* 7 */
	def = rb_body_def_default();
	def.shape.kind = RB_SHAPE_PLANE;
	def.is_static = true;
	def.position.z = -1;
	def.texture = "none";
	lab_add(&stage.lab, &def); /* 8 */
	look(&stage);
	static const enum rb_pattern wanted[] = {RB_PATTERN_PLAIN, RB_PATTERN_CHECKER,
	                                         RB_PATTERN_STRIPES, RB_PATTERN_BEACHBALL};
	for (int k = 0; k < 4; k++) {
		assert_int_equal(look_of(&stage, k)->pattern, wanted[k]);
		assert_int_equal(look_of(&stage, k)->image, -1);
		assert_false(look_of(&stage, k)->plain);
	}
	assert_int_equal(look_of(&stage, 5)->pattern, RB_PATTERN_STRIPES);
	assert_int_equal(look_of(&stage, 6)->pattern, RB_PATTERN_PLAIN);
	/* what moves over a plane is seen to move, unless somebody wanted it plain */
	assert_true(look_of(&stage, 7)->plain && !look_of(&stage, 8)->plain);
	struct rb_camera_def camera = rb_camera_def_default();
	camera.position.value = (rb_vec3){0, 0, 10};
	camera.look_at.value = (rb_vec3){0, 0, 0};
	const double near_m = stage.looks.cell_m;
	rb_looks_show_motion(&stage.looks, stage.lab.model, &camera);
	assert_near(stage.looks.cell_m, near_m, 0);
	/* from afar squares are larger: about eight of them, as rounded as ever, fill the height */
	camera.position.value.z = 10000;
	rb_looks_show_motion(&stage.looks, stage.lab.model, &camera);
	assert_near(stage.looks.cell_m, 1000, 1e-9);
	/* of parallel lines of sight and of a frustum by the height that is stated */
	camera.orthographic = true;
	camera.height = 80000;
	rb_looks_show_motion(&stage.looks, stage.lab.model, &camera);
	assert_near(stage.looks.cell_m, 10000, 1e-9);
	camera.orthographic = false;
	camera.has_frustum = true;
	memcpy(camera.frustum, (const double[6]){-1, 1, -4, 4, 1, 1e9}, sizeof camera.frustum);
	camera.position.value.z = 1e5;
	rb_looks_show_motion(&stage.looks, stage.lab.model, &camera);
	assert_near(stage.looks.cell_m, 1e5, 1e-8);
	/* one that moves has no height of its own: they stay as they are */
	camera.position.source = RB_CAMERA_FUNCTION;
	camera.position.value.z = 1e9;
	rb_looks_show_motion(&stage.looks, stage.lab.model, &camera);
	assert_near(stage.looks.cell_m, 1e5, 1e-8);
	assert_int_equal(look_of(&stage, 7)->pattern, RB_PATTERN_CHECKER);
	assert_int_equal(look_of(&stage, 8)->pattern, RB_PATTERN_PLAIN);
	assert_int_equal(look_of(&stage, 0)->pattern, RB_PATTERN_PLAIN);
	close_stage(&stage);
}

/* Of a red picture of 2 x 3 pixels, from a file that is gone afterwards. */
static void add_picture(struct stage *stage, const char *name)
{
	char folder[256], path[300];
	struct rb_pixmap picture;
	struct rb_error err;
	static char bytes[4096];

	support_folder(folder);
	snprintf(path, sizeof path, "%s/a.png", folder);
	assert_ok(rb_pixmap_init(&picture, 2, 3, &err));
	for (int k = 0; k < 6; k++)
		picture.rgba[4 * k] = 255;
	assert_ok(rb_png_write(path, 0, &picture, NULL, NULL, &err));
	rb_pixmap_release(&picture);
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	const size_t size = fread(bytes, 1, sizeof bytes, file);
	fclose(file);
	unlink(path);
	rmdir(folder);
	assert_ok(rb_scene_add_file(&stage->lab.scene, name, bytes, size, "", &err));
}

static void a_picture_is_read_once_for_all_that_wear_it(void **state)
{
	struct stage stage;

	(void)state;
	open_stage(&stage);
	add_picture(&stage, "a.png");
	add_picture(&stage, "deep/b.png");
	static const char *const names[] = {"a.png", "deep/b.png", "a.png", "checker"};
	for (int k = 0; k < 4; k++) {
		const struct rb_body_def def = ball(2 * k, names[k]);
		lab_add(&stage.lab, &def);
	}
	look(&stage);
	assert_int_equal(stage.looks.image_count, 2);
	for (int k = 0; k < 3; k++) {
		const struct rb_look *one = look_of(&stage, k);
		assert_int_equal(one->pattern, RB_PATTERN_IMAGE);
		assert_string_equal(stage.looks.names[one->image], names[k]);
		assert_int_equal(stage.looks.images[one->image].width, 2);
		assert_int_equal(stage.looks.images[one->image].height, 3);
		assert_int_equal(stage.looks.images[one->image].rgba[0], 255);
	}
	assert_int_equal(look_of(&stage, 0)->image, look_of(&stage, 2)->image);
	close_stage(&stage);
}

static void a_texture_that_is_none_is_told_with_its_body(void **state)
{
	struct stage stage;

	(void)state;
	open_stage(&stage);
	struct rb_body_def def = ball(0, "lost.png");
	def.line = 12;
	def.name = "dog";
	lab_add(&stage.lab, &def);
	seal(&stage);
	assert_int_equal(rb_looks_make(&stage.looks, stage.lab.model, &stage.err), RB_ERR_SCENE);
	assert_string_equal(stage.err.text,
	                    "s.lua:12: body 'dog': no texture 'lost.png' came with the scene");
	assert_null(stage.looks.of);
	close_stage(&stage);
	open_stage(&stage);
	assert_int_equal(rb_scene_add_file(&stage.lab.scene, "lost.png", "not one", 7, "", NULL),
	                 RB_OK);
	lab_add(&stage.lab, &def);
	seal(&stage);
	assert_int_equal(rb_looks_make(&stage.looks, stage.lab.model, &stage.err), RB_ERR_SCENE);
	assert_string_equal(stage.err.text,
	                    "s.lua:12: body 'dog': cannot read 'lost.png': it is not "
	                    "a PNG file");
	close_stage(&stage);
}

/* 1, 2 or 5 times a power of ten that is nearest to twice the typical diameter. */
static void squares_of_planes_are_as_large_as_bodies(void **state)
{
	static const struct {
		double radius, cell;
	} cases[] = {{0.25, 1}, {0.5, 2}, {1, 5}, {2.4, 10}, {0.05, 0.2}, {40, 200}, {1e-4, 5e-4}};

	(void)state;
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		struct stage stage;

		open_stage(&stage);
		for (int i = 0; i < 3; i++) { /* the one in the middle counts */
			static const double factors[] = {1, 0.1, 20};
			lab_sphere(&stage.lab, cases[k].radius * factors[i], 1,
			           (rb_vec3){0, 100 * cases[k].radius * i, 0}, (rb_vec3){0, 0, 0});
		}
		look(&stage);
		assert_near(stage.looks.size_m, 2 * cases[k].radius, 1e-12 * cases[k].radius);
		assert_near(stage.looks.cell_m, cases[k].cell, 1e-12 * cases[k].cell);
		close_stage(&stage);
	}
}

static void any_lack_of_memory_leaves_nothing(void **state)
{
	enum rb_status status = RB_ERR_MEMORY;
	struct stage stage;
	uint64_t k;

	(void)state;
	open_stage(&stage);
	add_picture(&stage, "a.png");
	const struct rb_body_def def = ball(0, "a.png");
	lab_add(&stage.lab, &def);
	seal(&stage);
	for (k = 1; status != RB_OK; k++) {
		rb_memory_fail_at(k);
		status = rb_looks_make(&stage.looks, stage.lab.model, &stage.err);
		rb_memory_fail_at(0);
		if (status != RB_OK) {
			assert_int_equal(status, RB_ERR_MEMORY);
			assert_null(stage.looks.of);
			assert_null(stage.looks.images);
		}
	}
	assert_true(k > 6);
	close_stage(&stage);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(srgb_becomes_linear_light),
		cmocka_unit_test(a_colour_comes_from_the_body_or_its_material_or_a_palette),
		cmocka_unit_test(patterns_are_those_that_were_named),
		cmocka_unit_test(a_picture_is_read_once_for_all_that_wear_it),
		cmocka_unit_test(a_texture_that_is_none_is_told_with_its_body),
		cmocka_unit_test(squares_of_planes_are_as_large_as_bodies),
		cmocka_unit_test(any_lack_of_memory_leaves_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
