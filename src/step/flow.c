/* SPDX-License-Identifier: MIT */
/*
 * Position update of semi-implicit (symplectic) Euler: x += h v with the new v, so that energy
 * oscillates without drift. Orientation is turned by the exact exponential of the spin; q += h w q
 * / 2 followed by normalization would turn a constant spin by 2 atan(h |w| / 2) instead of h |w|.
 */
#include "step/flow.h"

#include "base/error.h"
#include "math/top.h"

static void translate(struct rb_pass *pass)
{
	double *const position = pass->world->state.position;
	const double *const velocity = pass->world->state.velocity;
	const double h = pass->h_s;

	for (int k = 0; k < pass->member_count; k++) {
		const size_t row = 3 * (size_t)pass->member[k];

		RB_ASSERT_COSTLY(pass->member[k] < pass->world->state.body_count);
		position[row] += h * velocity[row];
		position[row + 1] += h * velocity[row + 1];
		position[row + 2] += h * velocity[row + 2];
	}
}

/* By the rotation through |w| h about w, exactly, so that a constant spin is right for any step. */
static void turn(double *orientation, rb_vec3 spin, double h)
{
	const rb_quat q = rb_quat_multiply(rb_quat_from_turn(rb_vec3_scale(h, spin)),
	                                   rb_quat_from(orientation));

	rb_quat_to(orientation, rb_quat_unit(q));
}

/*
 * For bodies whose spin is constant without torque: spheres, cubes, or a scene without unequal
 * moments.
 */
static void rotate(struct rb_pass *pass)
{
	struct rb_state *state = &pass->world->state;

	for (int k = 0; k < pass->member_count; k++) {
		const size_t i = (size_t)pass->member[k];
		const rb_vec3 spin = rb_vec3_from(state->spin + 3 * i);

		if (spin.x != 0 || spin.y != 0 || spin.z != 0)
			turn(state->orientation + 4 * i, spin, pass->h_s);
	}
}

/*
 * Without torque: kinetic energy and angular momentum are kept for any step. Angular momentum alone
 * is not enough, fast bodies would gain energy until they turn about their smallest moment.
 */
static void rotate_gyroscopic(struct rb_pass *pass)
{
	const struct rb_world *world = pass->world;

	for (int k = 0; k < pass->member_count; k++) {
		const int i = pass->member[k];
		double *const orientation = world->state.orientation + 4 * (size_t)i;
		double *const spin = world->state.spin + 3 * (size_t)i;
		rb_vec3 w = rb_vec3_from(spin);

		if (w.x == 0 && w.y == 0 && w.z == 0)
			continue;
		if (!isnan(world->model->inverse_inertia_scalar[i])) {
			turn(orientation, w, pass->h_s);
			continue;
		}
		rb_quat q = rb_quat_from(orientation);
		rb_top_step(rb_model_top(world->model, i), pass->h_s, &q, &w);
		rb_quat_to(orientation, q);
		rb_vec3_to(spin, w);
	}
}

rb_vec3 rb_flow_turn(const struct rb_world *world, int i, double h, rb_vec3 spin)
{
	const struct rb_model *const model = world->model;

	if (!isnan(model->inverse_inertia_scalar[i]) || !(model->inverse_mass[i] > 0))
		return rb_vec3_scale(h, spin);
	const rb_vec3 more = rb_top_turning(rb_model_top(model, i), rb_model_inertia(model, i),
	                                    rb_quat_from(world->state.orientation + 4 * (size_t)i),
	                                    spin);
	return rb_vec3_scale(h, rb_vec3_add_scaled(spin, 0.5 * h, more));
}

const struct rb_stage rb_stage_translate = {"translate", "positions move", 0, translate};
const struct rb_stage rb_stage_rotate = {"rotate", "orientations turn", RB_FEATURE_ROTATION,
                                         rotate};
const struct rb_stage rb_stage_rotate_gyroscopic = {"rotate_gyroscopic",
                                                    "orientations turn, unequal moments of inertia",
                                                    RB_FEATURE_GYROSCOPIC, rotate_gyroscopic};
