/* SPDX-License-Identifier: MIT */
/* All methods, from the outside: bodies that meet in free space keep their momenta, whatever their sizes. */
#include "math/quat.h"
#include "solids.h"
#include "world/world.h"
#include "worlds.h"

enum { BODIES = 8 };
enum kind {
	SPHERES,
	BOXES,
	LOADED,
	KINDS
}; /* loaded: spheres with their masses off their middles */
static const enum rb_method_kind methods[] = {RB_METHOD_LOCATED, RB_METHOD_STEPPED,
                                              RB_METHOD_CLASSIC};

static void open_space(struct lab *lab, enum rb_method_kind method, double duration)
{
	lab_open(lab, duration, 50);
	lab->scene.world.method = method;
	lab->scene.world.time_step_s = 1e-3;
}

/* Moments of inertia about the principal axes, from mass and size alone. */
static rb_vec3 moments_of(const struct rb_body_def *def)
{
	const double *const s = def->shape.size, r = def->shape.radius;

	if (def->inertia)
		return (rb_vec3){def->inertia->m[0][0], def->inertia->m[1][1],
		                 def->inertia->m[2][2]};
	if (def->shape.kind == RB_SHAPE_SPHERE)
		return rb_vec3_scale(0.4 * def->mass * r * r, (rb_vec3){1, 1, 1});
	return rb_vec3_scale(def->mass / 12,
	                     (rb_vec3){s[1] * s[1] + s[2] * s[2], s[2] * s[2] + s[0] * s[0],
	                               s[0] * s[0] + s[1] * s[1]});
}

static rb_vec3 spin_of(const struct lab *lab, int id)
{
	return rb_vec3_from(lab->world->state.spin + 3 * lab->model->index_of[id]);
}

static rb_vec3 spin_momentum(const struct lab *lab, int id)
{
	const int i = lab->model->index_of[id];
	const rb_vec3 moments = moments_of(&lab->scene.bodies[id]);
	const rb_quat turn = rb_quat_from(lab->world->state.orientation + 4 * i);
	const rb_vec3 own = rb_quat_rotate_back(turn, spin_of(lab, id));

	return rb_quat_rotate(turn,
	                      (rb_vec3){moments.x * own.x, moments.y * own.y, moments.z * own.z});
}

/* Linear, angular about the origin, and the sum of what the bodies have of the latter. */
static void sum_up(const struct lab *lab, rb_vec3 sum[2], double *scale)
{
	sum[0] = sum[1] = (rb_vec3){0, 0, 0};
	*scale = 0;
	for (int id = 0; id < lab->scene.body_count; id++) {
		const int i = lab->model->index_of[id];
		const rb_vec3 v = rb_vec3_scale(lab->scene.bodies[id].mass,
		                                rb_vec3_from(lab->world->state.velocity + 3 * i));
		const rb_vec3 way = rb_vec3_cross(rb_vec3_from(lab->world->state.position + 3 * i),
		                                  v);
		const rb_vec3 spin = spin_momentum(lab, id);

		sum[0] = rb_vec3_add(sum[0], v);
		sum[1] = rb_vec3_add(sum[1], rb_vec3_add(way, spin));
		*scale += rb_vec3_length(way) + rb_vec3_length(spin);
	}
}

/* From all sides towards the middle, where they meet several times. */
static void throw_inwards(struct lab *lab, enum kind kind)
{
	for (uint64_t k = 0; k < BODIES; k++) {
		struct rb_body_def def = rb_body_def_default();
		const rb_vec3 corner = {k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1};

		def.call = "body";
		def.shape.kind = kind == BOXES && k % 2 ? RB_SHAPE_BOX : RB_SHAPE_SPHERE;
		if (def.shape.kind == RB_SHAPE_BOX)
			for (int i = 0; i < 3; i++)
				def.shape.size[i] = solids_random(k, 10 + (uint64_t)i, 0.2, 0.7);
		else
			def.shape.radius = solids_random(k, 13, 0.1, 0.45);
		def.mass = solids_random(k, 14, 0.3, 3);
		rb_mat3 inertia = {0};
		if (kind == LOADED) {
			def.center_of_mass = rb_vec3_scale(def.shape.radius,
			                                   (rb_vec3){0.3, -0.2, 0.1});
			for (int i = 0; i < 3; i++)
				inertia.m[i][i] = 0.4 * def.mass * def.shape.radius *
				                  def.shape.radius *
				                  solids_random(k, 19 + (uint64_t)i, 0.7, 1);
		}
		def.inertia = kind == LOADED ? &inertia : NULL;
		def.position = rb_vec3_add(corner, (rb_vec3){5, -3, 2});
		def.orientation = solids_turn(k);
		def.velocity = rb_vec3_scale(-solids_random(k, 15, 1, 3), corner);
		def.angular_velocity = (rb_vec3){solids_random(k, 16, -4, 4),
		                                 solids_random(k, 17, -4, 4),
		                                 solids_random(k, 18, -4, 4)};
		(void)lab_add(lab, &def);
	}
}

/*
 * Located to rounding. Under steps bodies that overlap are moved apart afterwards, without a change of velocity: the angular
 * momentum is kept to the first order of the step, 1e-3 s of 1 s, the linear one to rounding.
 */
static void bodies_that_meet_keep_their_momenta(void **state)
{
	(void)state;
	for (int m = 0; m < 3; m++)
		for (enum kind kind = SPHERES; kind < KINDS; kind++) {
			struct lab lab;
			rb_vec3 first[2], last[2];
			double scale;

			if (methods[m] == RB_METHOD_CLASSIC && kind == BOXES)
				continue;
			open_space(&lab, methods[m], 1);
			lab_surface(&lab, 0.6, 0.5);
			throw_inwards(&lab, kind);
			lab_seal(&lab, 1);
			sum_up(&lab, first, &scale);
			lab_run(&lab);
			sum_up(&lab, last, &(double){0});
			const double tolerance = methods[m] == RB_METHOD_LOCATED ? 1e-13 : 1e-3;
			assert_vector(last[0], first[0], 1e-13 * scale);
			assert_vector(last[1], first[1], tolerance * scale);
			for (int id = 0; id < BODIES; id++) /* and none has missed the others */
				assert_true(rb_vec3_length(rb_vec3_sub(
						    spin_of(&lab, id),
						    lab.scene.bodies[id].angular_velocity)) > 1e-3);
			lab_close(&lab);
		}
}

/* One impulse rubs on both, at their own radii: spin momenta change in the ratio of the radii. */
static void spheres_that_graze_turn_by_their_own_radii(void **state)
{
	(void)state;
	for (int m = 0; m < 3; m++)
		for (int swapped = 0; swapped < 2; swapped++) {
			const double radius[2] = {swapped ? 0.3 : 0.1, swapped ? 0.1 : 0.3};
			struct lab lab;

			open_space(&lab, methods[m], 0.2);
			lab_surface(&lab, 0.4, 0.5);
			lab_sphere(&lab, radius[0], 2, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
			lab_sphere(&lab, radius[1], 3, (rb_vec3){0.45, 0.2, 0.1},
			           (rb_vec3){-4, 0, 0});
			lab_seal(&lab, 1);
			lab_run(&lab);
			const rb_vec3 a = spin_momentum(&lab, 0), b = spin_momentum(&lab, 1);
			assert_true(rb_vec3_length(a) > 1e-3);
			assert_vector(rb_vec3_scale(radius[1], a), rb_vec3_scale(radius[0], b),
			              1e-14);
			lab_close(&lab);
		}
}

static void only_what_turns_has_an_inertia(void **state)
{
	(void)state;
	for (int turns = 0; turns < 2; turns++) {
		struct lab lab;

		open_space(&lab, RB_METHOD_LOCATED, 1);
		lab_surface(&lab, turns ? 0.5 : 0, 1);
		lab_sphere(&lab, 0.5, 2, (rb_vec3){0, 0, 1}, (rb_vec3){0, 0, 0});
		const int plane = lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		lab_seal(&lab, 1);
		const rb_mat3 ball = rb_world_inertia(lab.world, 0);
		const rb_mat3 still = rb_world_inertia(lab.world, plane);
		/* what stands still has none of these, though no mass to count with either */
		assert_near(rb_world_kinetic_energy(lab.world, plane), 0, 0);
		assert_vector(rb_world_momentum(lab.world, plane), ((rb_vec3){0, 0, 0}), 0);
		assert_vector(rb_world_angular_momentum(lab.world, plane), ((rb_vec3){0, 0, 0}), 0);
		for (int i = 0; i < 9; i++) {
			const bool counts = turns && i % 4 == 0;
			assert_near(ball.m[i / 3][i % 3], counts ? 0.4 * 2 * 0.25 : 0, 1e-16);
			assert_near(still.m[i / 3][i % 3], 0, 0);
		}
		lab_close(&lab);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bodies_that_meet_keep_their_momenta),
		cmocka_unit_test(only_what_turns_has_an_inertia),
		cmocka_unit_test(spheres_that_graze_turn_by_their_own_radii),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
