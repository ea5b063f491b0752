/* SPDX-License-Identifier: MIT */
/* src/model/solids.c and what follows from it: bodies of all shapes in models and in flight. */
#include "worlds.h"

#include "geom/mass.h"
#include "runge.h"
#include "solids.h"

static struct rb_body_def box_def(double x, double y, double z, double mass)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = "box";
	def.shape = (struct rb_shape){.kind = RB_SHAPE_BOX, .size = {x, y, z}};
	def.mass = mass;
	return def;
}

/* A hull whose points are where the author put them: the centroid is the centre of mass. */
static struct rb_body_def hull_def(struct lab *lab, const rb_vec3 *points, size_t count)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = "hull";
	def.shape = (struct rb_shape){.kind = RB_SHAPE_HULL};
	assert_int_equal(
		rb_scene_add_hull(&lab->scene, points, count, &def.shape.solid, &lab->error),
		RB_OK);
	def.center_of_mass = lab->scene.solids[def.shape.solid].centroid;
	return def;
}

/* ---- what a model makes of them ---- */

static void assert_refused(struct lab *lab, int count, const char *text)
{
	struct rb_mistakes mistakes = {0};

	assert_int_equal(rb_model_create(&lab->model, &lab->scene, &mistakes, &lab->error),
	                 RB_ERR_SCENE);
	assert_null(lab->model);
	if (mistakes.count != count || !strstr(mistakes.line[0], text))
		fail_msg("%d mistakes, '%s', wanted %d, '%s'", mistakes.count, mistakes.line[0],
		         count, text);
	rb_mistakes_release(&mistakes);
}

static void the_classic_method_refuses_boxes_that_could_touch_by_name(void **slot)
{
	struct lab lab;
	struct rb_body_def def = box_def(1, 1, 1, 1);

	(void)slot;
	lab_open(&lab, 1, 60);
	lab.scene.world.method = RB_METHOD_CLASSIC;
	def.name = "crate";
	lab_add(&lab, &def);
	def.name = NULL;
	def.call = "capsule";
	def.shape = (struct rb_shape){.kind = RB_SHAPE_CAPSULE, .radius = 1, .size = {0, 0, 1}};
	def.position.x = 10;
	lab_add(&lab, &def);
	assert_refused(&lab, 2,
	               "box 'crate': the classic method has no contacts of boxes (use 'located' or "
	               "'auto', or let it collide with nothing: collides_with = {})");
	/* one that collides with nothing frees the other too */
	lab.scene.bodies[0].filters = true;
	lab_seal(&lab, 1);
	assert_int_equal(lab.model->features & RB_FEATURE_CONTACT, 0);
	rb_world_destroy(lab.world);
	rb_model_destroy(lab.model);
	lab.world = NULL;
	lab.model = NULL;
	/* static: what moves could touch it */
	lab.scene.bodies[0].filters = false;
	lab.scene.bodies[0].is_static = true;
	assert_refused(&lab, 2, "the classic method has no contacts of boxes");
	lab_close(&lab);
}

static void alone_or_among_what_does_not_yield_a_box_flies(void **slot)
{
	struct lab lab;
	struct rb_body_def def = box_def(1, 2, 3, 1);

	(void)slot;
	lab_open(&lab, 1, 60);
	lab_add(&lab, &def);
	lab_seal(&lab, 1);
	lab_run(&lab);
	lab_close(&lab);
	/* two that nothing can push cannot meet */
	lab_open(&lab, 1, 60);
	def.is_static = true;
	lab_add(&lab, &def);
	def.position.x = 0.1;
	lab_add(&lab, &def);
	lab_seal(&lab, 1);
	lab_run(&lab);
	lab_close(&lab);
}

static void wrong_sizes_are_named(void **slot)
{
	static const struct {
		struct rb_shape shape;
		const char *text;
	} wrong[] = {
		{{.kind = RB_SHAPE_BOX, .size = {1, -1, 1}}, "three positive finite lengths"},
		{{.kind = RB_SHAPE_BOX, .size = {1, 1, 0}}, "three positive finite lengths"},
		{{.kind = RB_SHAPE_CAPSULE, .radius = 1}, "'radius' and 'length' must be positive"},
		{{.kind = RB_SHAPE_CYLINDER, .size = {0, 0, 1}},
	         "'radius' and 'length' must be positive"},
		{{.kind = RB_SHAPE_BOX, .size = {1e-200, 1e-200, 1e-200}},
	         "its mass comes out as 0"},
	};

	(void)slot;
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		struct lab lab;
		struct rb_body_def def = rb_body_def_default();

		lab_open(&lab, 1, 60);
		def.shape = wrong[i].shape;
		lab_add(&lab, &def);
		assert_refused(&lab, 1, wrong[i].text);
		lab_close(&lab);
	}
}

static void only_scenes_with_such_bodies_pay_for_their_reach(void **slot)
{
	struct lab lab;
	struct rb_body_def box = box_def(2, 4, 4, 1);

	(void)slot;
	lab_open(&lab, 1, 60);
	lab_sphere(&lab, 0.5, 1, (rb_vec3){0, 0, 0}, (rb_vec3){1, 0, 0});
	lab_seal(&lab, 1);
	assert_null(lab.model->reach);
	assert_null(lab.model->center_of_mass);
	assert_near(rb_model_reach(lab.model, 0), 0.5, 0);
	box.angular_velocity = (rb_vec3){1, 0, 0};
	lab_close(&lab);
	lab_open(&lab, 1, 60);
	lab_add(&lab, &box);
	lab_seal(&lab, 1);
	assert_near(rb_model_reach(lab.model, 0), 3, 1e-15);
	assert_near(lab.model->size_min_m, 1, 0);
	assert_near(lab.model->tolerance_m, 1e-6, 1e-21);
	assert_near(lab.model->coordinate_max_m, 3, 1e-15);
	assert_near(rb_model_inertia(lab.model, 0)->m[0][0], 32.0 / 12, 1e-15);
	assert_null(lab.model->center_of_mass);
	lab_close(&lab);
}

static void a_hull_falls_by_its_centroid_and_turns_about_it(void **slot)
{
	struct lab lab;
	const rb_vec3 points[4] = {{1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}};
	const rb_vec3 spin = {0.3, -2, 1}, v = {1, 2, 3}, middle = {1.25, 1.25, 1.25};

	(void)slot;
	lab_open_located(&lab, 2, 60);
	lab.scene.world.gravity = (rb_vec3){0, 0, -10};
	struct rb_body_def def = hull_def(&lab, points, 4);
	def.position = (rb_vec3){5, 0, 0};
	def.velocity = v;
	def.angular_velocity = spin;
	lab_add(&lab, &def);
	lab_seal(&lab, 1);
	const rb_vec3 before = rb_world_angular_momentum(lab.world, 0);
	const double energy = rb_world_kinetic_energy(lab.world, 0);
	assert_vector(rb_world_center_of_mass(lab.world, 0), rb_vec3_add(def.position, middle),
	              1e-15);
	assert_near(rb_world_mass(lab.world, 0), 1000.0 / 6, 1e-12);
	lab_run(&lab);
	/* the centre on its parabola, the object's origin a fixed arm from it */
	const rb_vec3 center = rb_world_center_of_mass(lab.world, 0);
	assert_vector(center, ((rb_vec3){6.25 + 2, 1.25 + 4, 1.25 + 6 - 20}), 1e-13);
	assert_vector(rb_world_point(lab.world, 0, middle), center, 1e-14);
	const rb_vec3 fallen = rb_world_velocity(lab.world, 0);
	assert_near(rb_world_kinetic_energy(lab.world, 0) -
	                    0.5 * 1000 / 6 * (rb_vec3_dot(fallen, fallen) - rb_vec3_dot(v, v)),
	            energy, 1e-10);
	const rb_vec3 push = rb_vec3_scale(1000.0 / 6, fallen);
	const rb_vec3 orbit = rb_vec3_cross(rb_vec3_add(def.position, middle),
	                                    rb_vec3_scale(1000.0 / 6, v));
	assert_vector(
		rb_vec3_sub(rb_world_angular_momentum(lab.world, 0), rb_vec3_cross(center, push)),
		rb_vec3_sub(before, orbit), 1e-10);
	lab_close(&lab);
}

/* ---- flight ---- */

/* Euler's equations along principal axes, and the quaternion's: w then q. */
static void euler(const void *user, double t, const double *y, double *rate)
{
	const double *const m = user;
	const rb_quat q = rb_quat_from(y + 3);
	const rb_quat turned = rb_quat_multiply(q, (rb_quat){0, y[0], y[1], y[2]});

	(void)t;
	rate[0] = (m[1] - m[2]) / m[0] * y[1] * y[2];
	rate[1] = (m[2] - m[0]) / m[1] * y[2] * y[0];
	rate[2] = (m[0] - m[1]) / m[2] * y[0] * y[1];
	rb_quat_to(rate + 3, turned);
	for (int k = 3; k < 7; k++)
		rate[k] *= 0.5;
}

/*
 * The box of the books, as a box, as a hull in other axes and as a union of halves: it turns over as Euler's equations
 * say, and keeps energy and momentum.
 */
static void a_racket_turns_over_whatever_it_is_made_of(void **slot)
{
	static const double moments[3] = {2.5, 5, 6.5}, size[3] = {3, 2, 1};
	const rb_vec3 spin = {0.01, 5, 0.01};
	const double duration = 9;
	const rb_quat turn = solids_turn(3);
	struct lab lab;
	rb_vec3 points[8];
	double y[7] = {spin.x, spin.y, spin.z, 1, 0, 0, 0};

	(void)slot;
	lab_open_located(&lab, duration, 10);
	struct rb_body_def def[3] = {box_def(3, 2, 1, 6)};
	solids_box(points, size, turn, (rb_vec3){1, 2, 3});
	def[1] = hull_def(&lab, points, 8);
	/* the hull is turned against its object axes: turned back, it stands as the box does */
	def[1].orientation = (rb_quat){turn.w, -turn.x, -turn.y, -turn.z};
	struct rb_solid_part halves[2] = {
		{{.kind = RB_SHAPE_BOX, .size = {1, 2, 1}}, {-1, 0, 0}, rb_quat_identity, 1},
		{{.kind = RB_SHAPE_BOX, .size = {2, 2, 1}}, {0.5, 0, 0}, rb_quat_identity, 1}};
	def[2] = rb_body_def_default();
	def[2].shape.kind = RB_SHAPE_UNION;
	assert_int_equal(rb_scene_add_union(&lab.scene, halves, 2, &def[2].shape.solid, &lab.error),
	                 RB_OK);
	def[2].center_of_mass = lab.scene.solids[def[2].shape.solid].centroid;
	for (int k = 0; k < 3; k++) {
		def[k].mass = 6;
		def[k].filters = true;
		def[k].angular_velocity = spin;
		lab_add(&lab, &def[k]);
	}
	lab_seal(&lab, 1);
	const rb_vec3 momentum = rb_world_angular_momentum(lab.world, 0);
	const double energy = rb_world_kinetic_energy(lab.world, 0);
	assert_near(energy, 62.50045, 1e-13);
	int flips = 0;
	double side = 1;
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		const double along = rb_quat_rotate_back(rb_world_orientation(lab.world, 0),
		                                         rb_world_angular_velocity(lab.world, 0))
		                             .y;
		if (side * along < -4) {
			side = -side;
			flips++;
		}
		for (int k = 0; k < 3; k++) {
			assert_near(rb_world_kinetic_energy(lab.world, k), energy, 1e-12 * energy);
			assert_vector(rb_world_angular_momentum(lab.world, k), momentum,
			              1e-12 * rb_vec3_length(momentum));
		}
	}
	assert_int_equal(flips, 1);
	/* what Runge and Kutta round grows by the fourth power of ten while the box turns over */
	runge_solve(euler, moments, 7, y, 0, duration, 100000);
	const rb_quat q = rb_quat_from(y + 3);
	for (int k = 0; k < 3; k++) {
		/* the way from a body's object axes to those of the box */
		const rb_quat own = rb_quat_multiply(rb_world_orientation(lab.world, k),
		                                     k == 1 ? turn : rb_quat_identity);
		const rb_vec3 x = {1, 0, 0}, z = {0, 0, 1};

		assert_vector(rb_quat_rotate(own, x), rb_quat_rotate(q, x), 1e-9);
		assert_vector(rb_quat_rotate(own, z), rb_quat_rotate(q, z), 1e-9);
		assert_vector(rb_world_angular_velocity(lab.world, k),
		              rb_quat_rotate(q, rb_vec3_from(y)), 5e-9);
	}
	lab_close(&lab);
}

/* Moments whose ratio is 1e12: about each axis, a little beside, and obliquely. */
static void needles_and_foils_keep_energy_and_momentum(void **slot)
{
	static const double sizes[][3] = {{1, 1e-6, 1e-6}, {1, 1, 1e-6}, {1, 1e-3, 1e-6}};
	static const rb_vec3 spins[] = {{5, 0, 0},       {0, 5, 0},       {0, 0, 5},
	                                {5, 1e-3, 1e-3}, {1e-3, 5, 1e-3}, {1e-3, 1e-3, 5},
	                                {1, 2, 3}};

	(void)slot;
	for (int s = 0; s < 3; s++)
		for (int k = 0; k < 7; k++) {
			struct lab lab;
			struct rb_body_def def = box_def(sizes[s][0], sizes[s][1], sizes[s][2], 1);

			lab_open_located(&lab, 2, 5);
			def.angular_velocity = spins[k];
			def.orientation = solids_turn(9);
			lab_add(&lab, &def);
			lab_seal(&lab, 1);
			const rb_vec3 momentum = rb_world_angular_momentum(lab.world, 0);
			const double energy = rb_world_kinetic_energy(lab.world, 0);
			assert_true(energy > 0);
			lab_run(&lab);
			assert_near(rb_world_kinetic_energy(lab.world, 0), energy, 1e-11 * energy);
			assert_vector(rb_world_angular_momentum(lab.world, 0), momentum,
			              1e-11 * rb_vec3_length(momentum));
			lab_close(&lab);
		}
}

/* Sizes of errors follow the reach of a body, which of a box is not its radius. */
static void a_box_hangs_on_a_spring_by_its_corner_and_keeps_its_energy(void **slot)
{
	struct lab lab;
	struct rb_body_def def = box_def(1, 2, 3, 6);
	struct rb_spring_def spring = rb_spring_def_default();

	(void)slot;
	lab_open_located(&lab, 5, 10);
	lab.scene.world.gravity = (rb_vec3){0, 0, -9.81};
	def.filters = true;
	spring.a = lab_add(&lab, &def);
	def.position = (rb_vec3){0, 0, 10};
	def.is_static = true;
	spring.b = lab_add(&lab, &def);
	def.is_static = false;
	def.position = (rb_vec3){0, 0, 0};
	spring.at_a = (rb_vec3){0.5, 1, 1.5};
	spring.stiffness = 200;
	assert_int_equal(rb_scene_add_spring(&lab.scene, &spring, &lab.error), RB_OK);
	lab_seal(&lab, 1);
	const struct rb_frame_numbers first = rb_world_totals(lab.world);
	lab_run(&lab);
	const struct rb_frame_numbers last = rb_world_totals(lab.world);
	assert_true(rb_vec3_length(rb_world_angular_velocity(lab.world, 0)) > 0.1);
	assert_near(last.kinetic_energy + last.potential_energy,
	            first.kinetic_energy + first.potential_energy, 1e-10 * 600);
	lab_close(&lab);
}

static void the_classic_method_flies_them_too(void **slot)
{
	struct lab lab;
	struct rb_body_def def = box_def(3, 2, 1, 6);

	(void)slot;
	lab_open(&lab, 1, 60);
	lab.scene.world.method = RB_METHOD_CLASSIC;
	def.filters = true;
	def.angular_velocity = (rb_vec3){0.01, 5, 0.01};
	lab_add(&lab, &def);
	/* others touch each other meanwhile */
	lab_sphere(&lab, 0.5, 1, (rb_vec3){10, 0, 0}, (rb_vec3){1, 0, 0});
	lab_sphere(&lab, 0.5, 1, (rb_vec3){11.1, 0, 0}, (rb_vec3){-1, 0, 0});
	lab_plane(&lab, (rb_vec3){0, 0, -1}, (rb_vec3){0, 0, 1});
	lab_seal(&lab, 2);
	const double energy = rb_world_kinetic_energy(lab.world, 0);
	lab_run(&lab);
	assert_near(rb_world_kinetic_energy(lab.world, 0), energy, 1e-3 * energy);
	lab_close(&lab);
}

/* Many bodies, so that the located method uses its cells, among them some that have no contacts. */
static void spheres_hit_each_other_beside_boxes_that_they_cannot_touch(void **slot)
{
	struct lab lab;
	struct rb_body_def def = box_def(1, 1, 1, 1);

	(void)slot;
	lab_open_located(&lab, 2, 10);
	lab_surface(&lab, 0, 1);
	def.filters = true;
	for (int i = 0; i < 60; i++) {
		lab_sphere(&lab, 0.1, 1, (rb_vec3){i, 0, 0}, (rb_vec3){i % 2 ? -1 : 1, 0, 0});
		def.position = (rb_vec3){i, 0, 0};
		def.velocity = (rb_vec3){0, 1, 0};
		lab_add(&lab, &def);
	}
	lab_seal(&lab, 1);
	lab_run(&lab);
	/* pairs 0-1, 2-3, ... meet in their middles and part again */
	assert_vector(rb_world_velocity(lab.world, 0), ((rb_vec3){-1, 0, 0}), 1e-14);
	for (int i = 0; i < 60; i++)
		assert_vector(rb_world_position(lab.world, 2 * i + 1), ((rb_vec3){i, 2, 0}), 1e-14);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_classic_method_refuses_boxes_that_could_touch_by_name),
		cmocka_unit_test(alone_or_among_what_does_not_yield_a_box_flies),
		cmocka_unit_test(wrong_sizes_are_named),
		cmocka_unit_test(only_scenes_with_such_bodies_pay_for_their_reach),
		cmocka_unit_test(a_hull_falls_by_its_centroid_and_turns_about_it),
		cmocka_unit_test(a_racket_turns_over_whatever_it_is_made_of),
		cmocka_unit_test(needles_and_foils_keep_energy_and_momentum),
		cmocka_unit_test(a_box_hangs_on_a_spring_by_its_corner_and_keeps_its_energy),
		cmocka_unit_test(the_classic_method_flies_them_too),
		cmocka_unit_test(spheres_hit_each_other_beside_boxes_that_they_cannot_touch),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
