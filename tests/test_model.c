/* SPDX-License-Identifier: MIT */
/* src/model/model.c, src/model/validate.c, src/model/features.c */
#include "support.h"

#include "force/drag.h"
#include "force/spring.h"

#include <float.h>

#include <rbsim/model.h>

#include "base/memory.h"
#include "model/features.h"

struct bench {
	struct rb_scene scene;
	struct rb_model *model;
	struct rb_mistakes mistakes;
};

static struct rb_error err;

static void open_bench(struct bench *bench)
{
	*bench = (struct bench){0};
	assert_ok(rb_scene_init(&bench->scene, &err));
	bench->scene.file = "test.lua";
	bench->scene.world.duration_s = 1;
}

static void close_bench(struct bench *bench)
{
	rb_model_destroy(bench->model);
	rb_mistakes_release(&bench->mistakes);
	rb_scene_release(&bench->scene);
}

static struct rb_body_def ball(double radius, double x, double y, double z)
{
	struct rb_body_def def = rb_body_def_default();

	def.shape.radius = radius;
	def.position = (rb_vec3){x, y, z};
	return def;
}

static struct rb_body_def flat(enum rb_shape_kind kind)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = "plane";
	def.shape = (struct rb_shape){.kind = kind, .size = {2, 1}};
	def.is_static = true;
	return def;
}

static void add(struct bench *bench, struct rb_body_def def)
{
	def.line = bench->scene.body_count + 2;
	assert_ok(rb_scene_add_body(&bench->scene, &def, NULL, &err));
}

static int material(struct bench *bench, double friction, double restitution)
{
	struct rb_material_def def = rb_material_def_default();
	int index;

	def.friction = friction;
	def.restitution = restitution;
	assert_ok(rb_scene_add_material(&bench->scene, &def, &index, &err));
	return index;
}

static void seal(struct bench *bench)
{
	rb_model_destroy(bench->model);
	assert_ok(rb_model_create(&bench->model, &bench->scene, NULL, &err));
}

static rb_features features(struct bench *b)
{
	seal(b);
	return b->model->features;
}

/* The scene is refused, with one mistake that has this text. */
static void assert_refused(struct bench *bench, const char *text)
{
	rb_model_destroy(bench->model);
	rb_mistakes_release(&bench->mistakes);
	assert_int_equal(rb_model_create(&bench->model, &bench->scene, &bench->mistakes, &err),
	                 RB_ERR_SCENE);
	assert_null(bench->model);
	if (bench->mistakes.count != 1 || !strstr(bench->mistakes.line[0], text))
		fail_msg("%d mistakes, '%s', wanted '%s'", bench->mistakes.count,
		         bench->mistakes.line[0], text);
	assert_non_null(strstr(err.text, "test.lua"));
}

/* A million equal bodies have one tensor; whatever the order, each has its own. */
static void bodies_alike_share_their_inertia(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	add(&b, flat(RB_SHAPE_PLANE));
	for (int k = 0; k < 100; k++)
		add(&b, ball(0.1 + 0.01 * (k % 3), 4 * k, 0, 5));
	seal(&b);
	assert_int_equal(b.model->inertia_count, 1 + 3); /* of what does not yield, and of three */
	for (int k = 0; k < 20; k++)
		add(&b, ball(0.3 + 0.01 * k, 4 * k, 10, 5));
	seal(&b);
	assert_int_equal(b.model->inertia_count, 1 + 3 + 20);
	for (int i = 0; i < b.model->body_count; i++) {
		const double radius = b.model->shape[i].radius;
		const double own = 0.4 * b.model->mass[i] * radius * radius;

		assert_near(rb_model_inertia(b.model, i)->m[2][2], own, 1e-13 * own);
		assert_near(rb_model_inverse_inertia(b.model, i)->m[2][2], 1 / own, 1e-13 / own);
	}
	close_bench(&b);
}

static void moving_bodies_come_first_and_keep_the_order_of_the_scene(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	add(&b, flat(RB_SHAPE_PLANE));
	add(&b, ball(1, 0, 0, 5));
	add(&b, flat(RB_SHAPE_RECTANGLE));
	add(&b, ball(1, 0, 0, 9));
	seal(&b);
	assert_int_equal(b.model->body_count, 2);
	assert_int_equal(b.model->static_count, 2);
	const int id_of[] = {1, 3, 0, 2}, index_of[] = {2, 0, 3, 1};
	for (int i = 0; i < 4; i++) {
		assert_int_equal(b.model->id_of[i], id_of[i]);
		assert_int_equal(b.model->index_of[i], index_of[i]);
	}
	assert_near(b.model->position[1].z, 9, 0);
	assert_int_equal(b.model->shape[3].kind, RB_SHAPE_RECTANGLE);
	assert_true(isinf(b.model->mass[2]) && b.model->inverse_mass[2] == 0);
	assert_near(b.model->mass[0], 4000 * acos(-1) / 3, 1e-9);
	assert_near(rb_model_inertia(b.model, 0)->m[1][1], 0.4 * b.model->mass[0], 1e-9);
	assert_near(b.model->inverse_inertia_scalar[0] * rb_model_inertia(b.model, 0)->m[0][0], 1,
	            1e-15);
	close_bench(&b);
}

static void mass_wins_over_density_and_density_over_the_material(void **slot)
{
	struct bench b;
	struct rb_body_def def = ball(1, 0, 0, 0);

	(void)slot;
	open_bench(&b);
	def.mass = 7;
	add(&b, def);
	def = ball(1, 5, 0, 0);
	def.density = 3;
	add(&b, def);
	seal(&b);
	assert_near(b.model->mass[0], 7, 0);
	assert_near(b.model->mass[1], 4 * acos(-1), 1e-14);
	close_bench(&b);
}

static void frames_follow_the_rule_of_the_language(void **slot)
{
	/* duration, rate, frames with frame 0, time of the last */
	static const double rows[][4] = {
		{10, 60, 601, 10}, {0.1, 60, 7, 0.1},    {1.0 / 3, 3, 2, 1.0 / 3},
		{0.3, 10, 4, 0.3}, {1.01, 60, 62, 1.01}, {1e-3, 60, 2, 1e-3},
		{0.7, 10, 8, 0.7}, {2.5, 1, 4, 2.5},
	};

	(void)slot;
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		struct bench b;

		open_bench(&b);
		add(&b, ball(1, 0, 0, 0));
		b.scene.world.duration_s = rows[i][0];
		b.scene.world.frame_rate = rows[i][1];
		seal(&b);
		assert_int_equal(b.model->frame_count, (uint64_t)rows[i][2]);
		assert_near(rb_model_frame_time(b.model, b.model->frame_count - 1), rows[i][3],
		            1e-16);
		assert_near(rb_model_frame_time(b.model, 0), 0, 0);
		if (b.model->frame_count > 2)
			assert_near(rb_model_frame_time(b.model, 1), 1 / rows[i][1], 0);
		assert_near(b.model->time_step_s, 1 / (4 * rows[i][1]), 0);
		close_bench(&b);
	}
}

static void the_pair_table_has_means_and_takes_pairs_key_by_key(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	const int rough = material(&b, 0.8, 0.3), ice = material(&b, 0.2, 0.6);
	add(&b, ball(1, 0, 0, 0));
	const struct rb_contact_pair_def defs[] = {{rough, ice, (double)NAN, 0.1},
	                                           {ice, rough, 0.05, (double)NAN},
	                                           {ice, ice, 1, 0},
	                                           {ice, ice, (double)NAN, 0.9}};
	for (int i = 0; i < 4; i++)
		assert_ok(rb_scene_add_contact_pair(&b.scene, &defs[i], &err));
	seal(&b);
	const struct rb_pair_material *t = b.model->pair_materials;
	assert_near(t[0 * 3 + rough].friction, sqrt(0.4), 1e-16);
	assert_near(t[rough * 3 + 0].restitution, 0.3, 0);
	assert_near(t[rough * 3 + ice].friction, 0.05, 0);
	assert_near(t[ice * 3 + rough].friction, 0.05, 0);
	assert_near(t[ice * 3 + rough].restitution, 0.1, 0);
	assert_near(t[ice * 3 + ice].friction, 1, 0);
	assert_near(t[ice * 3 + ice].restitution, 0.9, 0);
	assert_near(t[rough * 3 + rough].friction, 0.8, 0);
	close_bench(&b);
}

static void the_default_tolerance_follows_the_smallest_radius_or_the_ulp(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	add(&b, ball(0.5, 0, 0, 0));
	add(&b, ball(2, 100, 0, 0));
	seal(&b);
	assert_near(b.model->tolerance_m, 5e-7, 1e-22);
	assert_near(b.model->stepped_tolerance_m, 5e-5, 1e-20);
	assert_near(b.model->size_min_m, 0.5, 0);
	assert_near(b.model->coordinate_max_m, 100, 0);
	/* what is large counts as coordinates far away do, and in the middle too; what stands still is not the smallest */
	struct rb_body_def sheet = rb_body_def_default();
	sheet.call = "plane";
	sheet.shape.kind = RB_SHAPE_RECTANGLE;
	sheet.is_static = true;
	for (int way = 0; way < 2; way++) {
		sheet.position.z = -10 - way;
		sheet.shape.size[way] = 3000 + way;
		sheet.shape.size[1 - way] = 0.1;
		add(&b, sheet);
		seal(&b);
		assert_near(b.model->coordinate_max_m, 3000 + way, 0);
		assert_near(b.model->size_min_m, 0.5, 0);
	}
	add(&b, ball(4000, 0, -10000, 0));
	seal(&b);
	assert_near(b.model->coordinate_max_m, 10000, 0);
	add(&b, ball(20000, 0, 0, 60000));
	seal(&b);
	assert_near(b.model->coordinate_max_m, 60000, 0);
	assert_near(b.model->tolerance_m, 5e-7, 1e-22);
	add(&b, ball(2, -1e12, 0, 0));
	seal(&b);
	assert_near(b.model->tolerance_m, 8 * 0x1p-13, 0);
	assert_near(b.model->stepped_tolerance_m, 8 * 0x1p-13, 0);
	/* of steps alone there is one tolerance, and what is given holds for both */
	b.scene.world.method = RB_METHOD_STEPPED;
	seal(&b);
	assert_near(b.model->tolerance_m, 8 * 0x1p-13, 0);
	b.scene.world.method = RB_METHOD_AUTO;
	b.scene.world.tolerance_m = 0x1p-10;
	seal(&b);
	assert_near(b.model->stepped_tolerance_m, 0x1p-10, 0);
	b.scene.world.tolerance_m = 0x1p-11;
	assert_refused(
		&b, "'tolerance' 0.000488281 m is below what coordinates resolve (wanted at least "
		    "0.000976562 m");
	close_bench(&b);
}

static void impossible_worlds_are_refused(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	assert_refused(&b, "test.lua: the scene has no body");
	add(&b, ball(1, 0, 0, 0));
	b.scene.world.duration_s = (double)NAN;
	assert_refused(&b, "test.lua: world: 'duration' is missing");
	b.scene.world.duration_s = 0;
	assert_refused(&b, "'duration' must be positive and finite (got 0 s)");
	b.scene.world.duration_s = 1e15;
	assert_refused(&b, "frames (wanted less than 2^53)");
	b.scene.world.duration_s = 1;
	b.scene.world.frame_rate = -1;
	assert_refused(&b, "'frame_rate' must be positive");
	b.scene.world.frame_rate = 60;
	b.scene.world.time_step_s = 0;
	assert_refused(&b, "'time_step' must be positive");
	b.scene.world.time_step_s = 1e-12;
	assert_refused(&b, "more than 1e+09 steps");
	close_bench(&b);
}

static void impossible_bodies_are_named_with_file_line_and_value(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	add(&b, ball(1e-320, 0, 0, 0));
	assert_refused(&b, "test.lua:2: sphere #0: its mass comes out as 0 kg");
	b.scene.bodies[0].name = "dust";
	b.scene.bodies[0].shape.radius = 1e200;
	assert_refused(&b, "test.lua:2: sphere 'dust': its mass comes out as inf kg");
	b.scene.bodies[0].shape.radius = -1;
	assert_refused(&b, "'radius' must be positive and finite (got -1 m)");
	b.scene.bodies[0].shape.radius = 1;
	b.scene.bodies[0].mass = 1e-320;
	assert_refused(&b, "'mass' must be positive and finite, and so its inverse");
	b.scene.bodies[0].mass = 1;
	b.scene.bodies[0].inertia = &(rb_mat3){{{1, 0, 0}, {0, 1, 0}, {0, 0, 5}}};
	assert_refused(
		&b, "sum of the other two, which no body has (principal moments 1, 1, 5 kg m^2)");
	b.scene.bodies[0].inertia = NULL;
	b.scene.bodies[0].position.y = 1e305;
	assert_refused(&b, "'position' must lie within 1e+300 m");
	b.scene.bodies[0].position.y = 0;
	b.scene.bodies[0].velocity.y = (double)INFINITY;
	assert_refused(&b, "'velocity' and 'angular_velocity' must be finite");
	b.scene.bodies[0].velocity.y = 1e154;
	assert_refused(&b, "'velocity' 1e+154 m/s or 'angular_velocity' 0 rad/s is too fast");
	b.scene.bodies[0].velocity.y = 0;
	b.scene.bodies[0].shape.radius = 1e-180;
	b.scene.bodies[0].angular_velocity.z = 1;
	assert_refused(&b, "its inertia comes out as 0 kg m^2");
	/* nothing turns: nothing asks for it */
	b.scene.bodies[0].angular_velocity.z = 0;
	seal(&b);
	close_bench(&b);
}

static void a_plane_is_static_or_driven(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	add(&b, flat(RB_SHAPE_PLANE));
	b.scene.bodies[0].is_static = false;
	assert_refused(
		&b, "plane #0: a plane has no mass: it is static, or 'motion' says how it moves");
	b.scene.bodies[0].motion = 1;
	seal(&b);
	assert_int_equal(b.model->body_count, 1);
	b.scene.bodies[0].is_static = true;
	assert_refused(&b, "plane #0: 'motion' of a static body: it never moves");
	close_bench(&b);
}

static struct rb_body_def driven(struct rb_body_def def)
{
	def.is_static = false;
	def.motion = 1;
	return def;
}

static void driven_bodies_move_and_have_no_mass(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	material(&b, 0, 0);
	add(&b, flat(RB_SHAPE_PLANE));
	b.scene.bodies[0].position.z = -5;
	add(&b, driven(ball(1, 0, 0, 0)));
	add(&b, ball(1, 4, 0, 0));
	b.scene.bodies[1].motion_turns = true;
	seal(&b);
	assert_int_equal(b.model->body_count, 2);
	assert_int_equal(b.model->id_of[0], 1);
	assert_true(b.model->driven[0] == 1 && b.model->driven[1] == 0);
	assert_true(isinf(b.model->mass[0]) && isfinite(b.model->mass[1]));
	assert_near(b.model->inverse_mass[0], 0, 0);
	assert_true(b.model->inverse_mass[1] > 0);
	assert_near(rb_model_inverse_inertia(b.model, 0)->m[1][1], 0, 0);
	assert_near(b.model->inverse_inertia_scalar[0], 0, 0);
	assert_true(rb_model_inverse_inertia(b.model, 1)->m[1][1] > 0);
	b.scene.bodies[1].motion = -1;
	seal(&b);
	assert_null(b.model->driven);
	close_bench(&b);
}

static void driven_bodies_meet_what_can_be_pushed_and_nothing_else(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	b.scene.materials[0].friction = 0;
	add(&b, driven(ball(1, 0, 0, 0)));
	add(&b, driven(flat(RB_SHAPE_PLANE)));
	add(&b, driven(flat(RB_SHAPE_RECTANGLE)));
	add(&b, flat(RB_SHAPE_RECTANGLE));
	assert_int_equal(features(&b), RB_FEATURE_DRIVEN); /* and nobody minds that they overlap */
	add(&b, ball(1, 0, 0, 5));
	assert_int_equal(features(&b), RB_FEATURE_DRIVEN | RB_FEATURE_CONTACT);
	b.scene.bodies[0].motion_turns = true;
	assert_int_equal(features(&b),
	                 RB_FEATURE_DRIVEN | RB_FEATURE_CONTACT | RB_FEATURE_ROTATION);
	b.scene.bodies[4].position = (rb_vec3){9, 0, 0.5};
	assert_refused(&b, "#4: overlaps plane #1 by 0.5 m at the start");
	b.scene.bodies[4].position = (rb_vec3){1.5, 0, 1};
	assert_refused(&b, "#4: overlaps sphere #0 by 0.197224 m at the start");
	close_bench(&b);
}

static void join(struct bench *bench, struct rb_spring_def spring)
{
	spring.line = 7;
	assert_ok(rb_scene_add_spring(&bench->scene, &spring, &err));
}

static void forces_between_and_on_bodies_are_features(void **slot)
{
	struct bench b;
	struct rb_spring_def spring = rb_spring_def_default();
	const struct rb_drag_def none = {0}, drag = {.quadratic = 1};
	const struct rb_field_def field = {.function = 1};

	(void)slot;
	open_bench(&b);
	b.scene.materials[0].friction = 0;
	b.scene.groups = NULL;
	add(&b, ball(1, 0, 0, 0));
	b.scene.bodies[0].filters = true; /* meets nothing */
	add(&b, ball(1, 4, 0, 0));
	assert_ok(rb_scene_add_drag(&b.scene, &none, &err));
	assert_int_equal(features(&b), RB_FEATURE_FILTERS);
	assert_ok(rb_scene_add_drag(&b.scene, &drag, &err));
	assert_ok(rb_scene_add_field(&b.scene, &field, &err));
	spring.a = 0;
	spring.b = 1;
	join(&b, spring);
	const rb_features forces = RB_FEATURE_FILTERS | RB_FEATURE_DRAG | RB_FEATURE_FIELD |
	                           RB_FEATURE_SPRINGS;
	assert_int_equal(features(&b), forces);
	/* an end beside the centre of mass turns the body, unless nothing can */
	rb_scene_spring(&b.scene, 0)->at_b = (rb_vec3){0, 1, 0};
	assert_int_equal(features(&b), forces | RB_FEATURE_ROTATION);
	b.scene.bodies[1].is_static = true;
	assert_int_equal(features(&b), forces);
	rb_scene_spring(&b.scene, 0)->at_a = b.scene.bodies[0].center_of_mass;
	assert_int_equal(features(&b), forces);
	close_bench(&b);
}

/* Of the model's first spring. */
static double rest_of(const struct rb_model *model)
{
	const struct rb_elements *springs = rb_model_elements(model, &rb_force_spring);
	const struct rb_spring_def *spring = rb_elements_row(springs, 0);

	return spring->rest_length_m;
}

static void springs_that_make_no_sense_are_refused(void **slot)
{
	struct bench b;
	struct rb_spring_def spring = rb_spring_def_default();

	(void)slot;
	open_bench(&b);
	add(&b, ball(1, 0, 0, 0));
	add(&b, ball(1, 4, 0, 0));
	spring.a = spring.b = 1;
	join(&b, spring);
	struct rb_spring_def *it = rb_scene_spring(&b.scene, 0);
	assert_refused(&b, "test.lua:7: spring: both ends are on the same body");
	it->a = 0;
	b.scene.bodies[0].is_static = b.scene.bodies[1].is_static = true;
	assert_refused(&b, "test.lua:7: spring: nothing can move either end");
	b.scene.bodies[0].is_static = b.scene.bodies[1].is_static = false;
	it->damping = (double)NAN;
	assert_refused(&b, "'stiffness', 'damping' and 'rest_length' must be finite and 0 or more");
	it->damping = 0;
	it->at_a = (rb_vec3){4, 0, 0};
	seal(&b); /* of no length, and at rest so */
	assert_near(rest_of(b.model), 0, 0);
	it->at_b = (rb_vec3){0, 3, 0};
	seal(&b);
	assert_near(rest_of(b.model), 3, 1e-15);
	it->at_b = (rb_vec3){(double)NAN, 0, 0};
	it->rest_length_m = 0.5;
	assert_refused(&b,
	               "its ends are at one point at the start, so that its 'rest_length' 0.5 m");
	it->at_a.y = 1;
	seal(&b);
	const struct rb_drag_def drag = {.linear = -1, .line = 8};
	assert_ok(rb_scene_add_drag(&b.scene, &drag, &err));
	assert_refused(&b,
	               "test.lua:8: drag: 'linear' and 'quadratic' must be finite and 0 or more");
	close_bench(&b);
}

static void what_the_classic_method_lacks_is_refused_by_name(void **slot)
{
	struct bench b;
	struct rb_spring_def spring = rb_spring_def_default();
	const struct rb_drag_def drag = {.quadratic = 1};
	const struct rb_field_def field = {.function = 1};

	(void)slot;
	open_bench(&b);
	add(&b, ball(1, 0, 0, 0));
	add(&b, ball(1, 4, 0, 0));
	b.scene.world.method = RB_METHOD_CLASSIC;
	b.scene.bodies[0].motion = 1;
	assert_refused(&b,
	               "method 'classic' has no driven bodies ('motion'): use 'located' or 'auto'");
	b.scene.bodies[0].motion = -1;
	spring.a = 0;
	spring.b = 1;
	join(&b, spring);
	assert_refused(&b, "world: method 'classic' has no springs: use 'located' or 'auto'");
	b.scene.elements[rb_element_place(&rb_force_spring)].count = 0;
	assert_ok(rb_scene_add_drag(&b.scene, &drag, &err));
	assert_refused(&b, "method 'classic' has no drag:");
	b.scene.elements[rb_element_place(&rb_force_drag)].count = 0;
	assert_ok(rb_scene_add_field(&b.scene, &field, &err));
	assert_refused(&b, "method 'classic' has no fields:");
	b.scene.world.method = RB_METHOD_LOCATED;
	seal(&b);
	assert_int_equal(b.model->method, RB_METHOD_LOCATED);
	assert_string_equal(rb_model_method(b.model), "located");
	b.scene.world.method = RB_METHOD_AUTO;
	seal(&b);
	assert_string_equal(rb_model_method(b.model), "auto");
	close_bench(&b);
}

static void names_are_unique(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	for (int i = 0; i < 100; i++) {
		struct rb_body_def def = ball(0.1, i, 0, 0);
		char name[16];

		snprintf(name, sizeof name, "b%d", i == 70 ? 12 : i);
		def.name = name;
		add(&b, def);
	}
	assert_refused(&b,
	               "test.lua:72: sphere 'b12': 'name' is taken already (by body #12, line 14)");
	close_bench(&b);
}

static void every_mistake_is_found_in_one_pass(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	b.scene.world.duration_s = -1;
	add(&b, ball(-1, 0, 0, 0));
	add(&b, ball(1, 0, 0, 0));
	b.scene.bodies[1].mass = 0;
	assert_int_equal(rb_model_create(&b.model, &b.scene, &b.mistakes, &err), RB_ERR_SCENE);
	assert_int_equal(b.mistakes.count, 3);
	assert_string_equal(err.text, b.mistakes.line[0]);
	close_bench(&b);
}

static void overlaps_at_the_start_are_named_with_their_depth(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	add(&b, ball(1, 0, 0, 0));
	add(&b, ball(1, 1.5, 0, 0));
	assert_refused(&b, "test.lua:3: sphere #1: overlaps sphere #0 by 0.5 m at the start");
	b.scene.bodies[1].position.x = 0;
	assert_refused(&b, "overlaps sphere #0 by 2 m");
	b.scene.bodies[1] = flat(RB_SHAPE_PLANE);
	b.scene.bodies[1].name = "floor";
	assert_refused(&b, "plane 'floor': overlaps sphere #0 by 1 m");
	b.scene.bodies[1] = flat(RB_SHAPE_RECTANGLE);
	b.scene.bodies[1].position = (rb_vec3){1.6, 0, 0};
	assert_refused(&b, "plane #1: overlaps sphere #0 by 0.4 m");
	/* within the tolerance, touching, and apart are all right */
	b.scene.bodies[1] = ball(1, 2 - 9e-7, 0, 0);
	seal(&b);
	b.scene.bodies[1] = ball(1, 2 - 1.1e-6, 0, 0);
	assert_refused(&b, "overlaps");
	/* filtered, or both static: nobody minds */
	b.scene.bodies[1].filters = true;
	seal(&b);
	b.scene.bodies[1].filters = false;
	b.scene.bodies[0].is_static = b.scene.bodies[1].is_static = true;
	seal(&b);
	close_bench(&b);
}

static void at_most_ten_overlaps_are_named_and_the_rest_counted(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	for (int i = 0; i < 20000; i++)
		add(&b, ball(0.5, 0.75 * i, 0, 0));
	assert_int_equal(rb_model_create(&b.model, &b.scene, &b.mistakes, &err), RB_ERR_SCENE);
	assert_int_equal(b.mistakes.count, 11);
	assert_non_null(strstr(b.mistakes.line[0], "sphere #1: overlaps sphere #0 by 0.25 m"));
	assert_non_null(strstr(b.mistakes.line[10], "19989 more pairs"));
	close_bench(&b);
}

static void a_feature_that_no_body_could_use_is_absent_with_its_columns(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	b.scene.world.gravity.z = -9.81;
	add(&b, ball(1, 0, 0, 0));
	assert_int_equal(features(&b), RB_FEATURE_GRAVITY);
	assert_null(b.model->inertia);
	assert_null(b.model->inverse_inertia);
	assert_null(b.model->inverse_inertia_scalar);
	assert_null(b.model->center_of_mass);
	assert_null(b.model->group_bit);
	assert_null(b.model->collides);
	/* with the plain material's friction what touches turns */
	add(&b, flat(RB_SHAPE_RECTANGLE));
	b.scene.bodies[1].position.z = -5;
	assert_int_equal(features(&b), RB_FEATURE_GRAVITY | RB_FEATURE_CONTACT |
	                                       RB_FEATURE_FRICTION | RB_FEATURE_ROTATION);
	b.scene.materials[0].friction = 0;
	b.scene.materials[0].restitution = 0.5;
	assert_int_equal(features(&b),
	                 RB_FEATURE_GRAVITY | RB_FEATURE_CONTACT | RB_FEATURE_RESTITUTION);
	b.scene.bodies[0].filters = true;
	assert_int_equal(features(&b), RB_FEATURE_GRAVITY | RB_FEATURE_FILTERS);
	assert_non_null(b.model->group_bit);
	close_bench(&b);
}

static void what_can_turn_a_body_brings_rotation(void **slot)
{
	struct bench b;
	struct rb_force_def force = rb_force_def_default();

	(void)slot;
	open_bench(&b);
	b.scene.materials[0].friction = 0;
	add(&b, ball(1, 0, 0, 0));
	assert_int_equal(features(&b), 0);
	b.scene.bodies[0].angular_velocity.y = 1;
	assert_int_equal(features(&b), RB_FEATURE_ROTATION);
	b.scene.bodies[0].inertia = &(rb_mat3){{{2, 0, 0}, {0, 2, 0}, {0, 0, 3}}};
	assert_int_equal(features(&b), RB_FEATURE_ROTATION | RB_FEATURE_GYROSCOPIC);
	assert_true(isnan(b.model->inverse_inertia_scalar[0]));
	assert_near(rb_model_inverse_inertia(b.model, 0)->m[2][2], 1.0 / 3, 1e-16);
	b.scene.bodies[0].angular_velocity.y = 0;
	assert_int_equal(features(&b), 0);
	b.scene.bodies[0].inertia = NULL;

	/* through the centre of mass, then beside it */
	b.scene.bodies[0].center_of_mass.x = 0.25;
	force.vector.z = 1;
	force.point = (rb_vec3){0.25, 0, 0};
	assert_ok(rb_scene_add_force(&b.scene, &force, &err));
	assert_int_equal(features(&b), RB_FEATURE_FORCES | RB_FEATURE_OFF_CENTER);
	assert_near(b.model->center_of_mass[0].x, 0.25, 0);
	b.scene.forces[0].point.x = 0;
	assert_int_equal(features(&b),
	                 RB_FEATURE_FORCES | RB_FEATURE_OFF_CENTER | RB_FEATURE_ROTATION);
	b.scene.bodies[0].force_count = 0;
	add(&b, ball(1, 5, 0, 0));
	assert_int_equal(features(&b),
	                 RB_FEATURE_CONTACT | RB_FEATURE_OFF_CENTER | RB_FEATURE_ROTATION);
	close_bench(&b);
}

static void callbacks_bring_what_they_could_need(void **slot)
{
	struct bench b;

	(void)slot;
	open_bench(&b);
	add(&b, ball(1, 0, 0, 0));
	b.scene.hooks = RB_HOOK_EXPECT_ALWAYS;
	assert_int_equal(features(&b), 0);
	b.scene.hooks = RB_HOOK_STEP;
	assert_int_equal(features(&b),
	                 RB_FEATURE_HOOK_STEP | RB_FEATURE_PUSHES | RB_FEATURE_ROTATION);
	b.scene.hooks = RB_HOOK_COLLISION;
	assert_int_equal(features(&b), RB_FEATURE_HOOK_COLLISION | RB_FEATURE_EVENTS |
	                                       RB_FEATURE_PUSHES | RB_FEATURE_ROTATION);
	b.scene.hooks = RB_HOOK_TRANSITION;
	assert_int_equal(features(&b), RB_FEATURE_HOOK_TRANSITION | RB_FEATURE_EVENTS |
	                                       RB_FEATURE_PUSHES | RB_FEATURE_ROTATION);
	b.scene.hooks = 0;
	b.scene.record.fields |= RB_FIELD_EVENTS;
	assert_int_equal(features(&b), RB_FEATURE_EVENTS);
	close_bench(&b);
}

static void every_feature_has_one_row_with_texts(void **slot)
{
	rb_features seen = 0;
	int count;
	const struct rb_feature_row *rows = rb_feature_rows(&count);

	(void)slot;
	for (int i = 0; i < count; i++) {
		assert_int_equal(rows[i].bit, 1u << i);
		assert_true(rows[i].name[0] && rows[i].help[0] && rows[i].absent[0] &&
		            rows[i].present);
		seen |= rows[i].bit;
	}
	assert_int_equal(seen, 2 * RB_FEATURE_JOINTS - 1);
}

static void running_out_of_memory_is_an_error_at_every_allocation(void **slot)
{
	struct bench b;
	bool whole = false;

	(void)slot;
	open_bench(&b);
	for (int i = 0; i < 40; i++)
		add(&b, ball(0.4, i, 0, 0));
	add(&b, flat(RB_SHAPE_RECTANGLE));
	b.scene.bodies[40].position.z = -1;
	const struct rb_memory_counts before = rb_memory_counts();
	for (uint64_t k = 1; !whole && k < 100; k++) {
		rb_memory_fail_at(k);
		const enum rb_status status = rb_model_create(&b.model, &b.scene, &b.mistakes,
		                                              &err);
		rb_memory_fail_at(0);
		whole = status == RB_OK;
		assert_true(whole || (status == RB_ERR_MEMORY && !b.model));
		rb_model_destroy(b.model);
		b.model = NULL;
	}
	assert_true(whole);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_int_equal(after.taken - before.taken, after.freed - before.freed);
	close_bench(&b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bodies_alike_share_their_inertia),
		cmocka_unit_test(moving_bodies_come_first_and_keep_the_order_of_the_scene),
		cmocka_unit_test(mass_wins_over_density_and_density_over_the_material),
		cmocka_unit_test(frames_follow_the_rule_of_the_language),
		cmocka_unit_test(the_pair_table_has_means_and_takes_pairs_key_by_key),
		cmocka_unit_test(the_default_tolerance_follows_the_smallest_radius_or_the_ulp),
		cmocka_unit_test(impossible_worlds_are_refused),
		cmocka_unit_test(impossible_bodies_are_named_with_file_line_and_value),
		cmocka_unit_test(a_plane_is_static_or_driven),
		cmocka_unit_test(driven_bodies_move_and_have_no_mass),
		cmocka_unit_test(driven_bodies_meet_what_can_be_pushed_and_nothing_else),
		cmocka_unit_test(forces_between_and_on_bodies_are_features),
		cmocka_unit_test(springs_that_make_no_sense_are_refused),
		cmocka_unit_test(what_the_classic_method_lacks_is_refused_by_name),
		cmocka_unit_test(names_are_unique),
		cmocka_unit_test(every_mistake_is_found_in_one_pass),
		cmocka_unit_test(overlaps_at_the_start_are_named_with_their_depth),
		cmocka_unit_test(at_most_ten_overlaps_are_named_and_the_rest_counted),
		cmocka_unit_test(a_feature_that_no_body_could_use_is_absent_with_its_columns),
		cmocka_unit_test(what_can_turn_a_body_brings_rotation),
		cmocka_unit_test(callbacks_bring_what_they_could_need),
		cmocka_unit_test(every_feature_has_one_row_with_texts),
		cmocka_unit_test(running_out_of_memory_is_an_error_at_every_allocation),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
