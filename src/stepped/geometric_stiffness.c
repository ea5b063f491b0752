/* SPDX-License-Identifier: MIT */
#include "stepped/geometric_stiffness.h"

/*
 * Largest (h w)^2 of rotation under joint forces for which steps are stable: 4, divided by the
 * factor by which inertia is overestimated (stiffness_of) in a chain of rods whose links rotate
 * alternately, 2.2.
 */
static const double resolved_max = 4 / 2.2;

/* Adds `scale` times the inertia of a unit mass at r: r.r - r r^T. */
static void add_about(rb_mat3 *sum, double scale, rb_vec3 r)
{
	const double x[3] = {r.x, r.y, r.z}, square = rb_vec3_dot(r, r);

	for (int k = 0; k < 9; k++)
		sum->m[k / 3][k % 3] += scale * ((k % 4 == 0) * square - x[k / 3] * x[k % 3]);
}

static double trace(const rb_mat3 *x)
{
	return x->m[0][0] + x->m[1][1] + x->m[2][2];
}

/*
 * 1/kg: upper bound of a body's inverse effective mass at a point `arm` m from its centre of mass;
 * 0 for statics and the world (-1).
 */
static double inverse_mass_at(const struct rb_model *model, int i, double arm)
{
	if (i < 0 || i >= model->body_count)
		return 0;
	const double scalar = model->inverse_inertia_scalar[i];

	return model->inverse_mass[i] +
	       arm * arm * (isnan(scalar) ? trace(rb_model_inverse_inertia(model, i)) : scalar);
}

/*
 * Geometric stiffness, kg m^2. Rotation also moves the bodies joined at r, or this body about them:
 * `joined`, kg m^2, inertia of the effective mass of both there.
 */
static rb_mat3 stiffness_of(const struct rb_world *world, const struct rb_step_joint *all, int i,
                            double h, rb_mat3 *joined)
{
	const struct rb_joints *joints = world->model->joints;
	const rb_quat q = rb_world_orientation_at(world, &world->state, i);
	rb_mat3 sum = {{{0}}};

	for (int e = joints->first[i]; e < joints->first[i + 1]; e++) {
		const struct rb_joint *joint = &joints->joint[joints->of[e]];
		const double *force = all[joints->of[e]].last.force;
		const bool is_a = joint->a == i;
		const rb_vec3 arm = is_a ? joint->link.at_a : joint->link.at_b;
		const rb_vec3 other = is_a ? joint->link.at_b : joint->link.at_a;
		const double inverse_mass = inverse_mass_at(
			world->model, is_a ? joint->b : joint->a, rb_vec3_length(other));
		const rb_vec3 r = rb_quat_rotate(q, arm);
		const rb_vec3 f = {force[0], force[1], force[2]};
		const double along = (is_a ? -1 : 1) * rb_vec3_dot(f, r);
		const double square = rb_vec3_dot(r, r);

		if (!rb_linkage_has_point(&joint->link) || !(square > 0))
			continue;
		add_about(joined, 1 / (world->model->inverse_mass[i] + inverse_mass), r);
		if (along > 0)
			add_about(&sum, h * h * along / square, r);
	}
	return sum;
}

bool rb_geometric_stiffness_add(const struct rb_world *world, const struct rb_step_joint *all,
                                int i, double h, struct rb_solver_body *body, rb_mat3 *tensor)
{
	if (!(body->inverse_mass > 0) || body->inverse_inertia == 0 ||
	    world->model->joints->first[i] == world->model->joints->first[i + 1])
		return false;
	rb_mat3 whole = {{{0}}}, inertia, stiffened, inverse_whole;
	const rb_mat3 stiffness = stiffness_of(world, all, i, h, &whole);
	const double scalar = body->inverse_inertia;
	const rb_mat3 inverse = isnan(scalar) ? *tensor : rb_mat3_diagonal(scalar, scalar, scalar);

	if (!(trace(&inverse) * trace(&stiffness) > resolved_max) ||
	    !rb_mat3_inverse(&inverse, &inertia))
		return false;
	for (int k = 0; k < 9; k++)
		whole.m[k / 3][k % 3] += inertia.m[k / 3][k % 3];
	if (!rb_mat3_inverse(&whole, &inverse_whole))
		return false;
	/* the trace bounds the largest eigenvalue */
	const rb_mat3 share = rb_mat3_multiply(&inverse_whole, &stiffness);
	if (!(trace(&share) > resolved_max))
		return false;
	const rb_vec3 momentum = rb_mat3_apply(&inertia, body->angular);
	for (int k = 0; k < 9; k++)
		inertia.m[k / 3][k % 3] += stiffness.m[k / 3][k % 3];
	if (!rb_mat3_inverse(&inertia, &stiffened))
		return false;
	*tensor = stiffened;
	body->inverse_inertia = (double)NAN;
	body->angular = rb_mat3_apply(&stiffened, momentum);
	return true;
}
