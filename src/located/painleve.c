/* SPDX-License-Identifier: MIT */
/*
 * Painleve impacts: where friction makes the equations of rigid contact inconsistent, forces grow
 * without bound and stop the slip at once. The impulses solve the linear system "all contact points
 * stop" by conjugate gradients (Hestenes, Stiefel 1952), started along the present forces, in order
 * to find the solution to which these lead.
 */
#include "located/painleve.h"

#include <float.h>
#include <string.h>

#include "constraint/contact_row.h"
#include "constraint/eccentric.h"
#include "located/mechanics.h"

/* Share by which impulses may exceed the friction cone: the forces have not quite diverged. */
static const double beyond_cone = 0.01;
/* Effect of balanced impulses, in ulp of their individual effects. */
enum { BALANCE_ULP = 16 };

/* Changes of the relative velocities of the contact points by impulses. */
static void respond(const struct rb_painleve *painleve, const rb_vec3 *impulse, rb_vec3 *u)
{
	const struct rb_mechanics_points points = {.l = painleve->l,
	                                           .contact_point = painleve->contact_point,
	                                           .count = painleve->count,
	                                           .pose = painleve->pose,
	                                           .body_count = painleve->body_count,
	                                           .linear = painleve->linear,
	                                           .angular = painleve->angular};

	rb_mechanics_respond(&points, impulse);
	for (int k = 0; k < painleve->count; k++)
		u[k] = rb_mechanics_response(&points, k);
}

static double sum_of_dots(const rb_vec3 *a, const rb_vec3 *b, int count)
{
	double sum = 0;

	for (int k = 0; k < count; k++)
		sum += rb_vec3_dot(a[k], b[k]);
	return sum;
}

/* Largest inverse mass of a contact, by the masses alone, 1/kg. */
static double largest_inverse_mass(const struct rb_painleve *painleve)
{
	const double *const inverse_mass = painleve->l->model->inverse_mass;
	double max = 0;

	for (int k = 0; k < painleve->count; k++) {
		const struct rb_contact_point *const m = &painleve->contact_point[k];

		max = fmax(max, inverse_mass[m->a] + inverse_mass[m->b]);
	}
	return max;
}

/*
 * Impulses that stop all contact points, by conjugate gradients, until the effect of a direction
 * cancels to rounding: two points of a body cannot be pushed apart, and a step that divides by the
 * rounding of that would be 1e14 times too long.
 */
static void stop_points(struct rb_painleve *painleve)
{
	const int n = painleve->count;
	rb_vec3 *const impulse = painleve->impulse, *const residual = painleve->scratch,
		       *const direction = residual + n, *const image = direction + n;

	respond(painleve, painleve->force, image);
	for (int k = 0; k < n; k++) {
		impulse[k] = (rb_vec3){0, 0, 0};
		residual[k] = rb_vec3_neg(painleve->contact_point[k].velocity);
		direction[k] = painleve->force[k];
	}
	const double start = sum_of_dots(residual, residual, n),
		     inverse_mass_max = largest_inverse_mass(painleve);
	double square = start;
	for (int round = 0; round < 6 * n + 8 && square > 1e-28 * start; round++) {
		const double curvature = sum_of_dots(direction, image, n);
		const bool moves = curvature > BALANCE_ULP * n * DBL_EPSILON * inverse_mass_max *
		                                       sum_of_dots(direction, direction, n);

		if (!moves && round > 0)
			break;
		if (!moves) { /* forces that balance each other are no descent direction */
			memcpy(direction, residual, (size_t)n * sizeof *direction);
			respond(painleve, direction, image);
			continue;
		}
		const double share = sum_of_dots(direction, residual, n) / curvature;
		for (int k = 0; k < n; k++) {
			impulse[k] = rb_vec3_add_scaled(impulse[k], share, direction[k]);
			residual[k] = rb_vec3_add_scaled(residual[k], -share, image[k]);
		}
		const double now = sum_of_dots(residual, residual, n);
		/* the first direction is that of the forces, not the residual's */
		const double keep = round == 0 ? 0 : now / square;
		for (int k = 0; k < n; k++)
			direction[k] = rb_vec3_add_scaled(residual[k], keep, direction[k]);
		square = now;
		respond(painleve, direction, image);
	}
}

bool rb_painleve_stop(struct rb_painleve *painleve)
{
	stop_points(painleve);
	for (int k = 0; k < painleve->count; k++) {
		const rb_vec3 n = painleve->contact_point[k].normal;
		const double limit = painleve->friction[k] * rb_vec3_dot(painleve->impulse[k], n);

		if (!(rb_vec3_dot(painleve->impulse[k], n) >= 0) ||
		    rb_vec3_length(rb_vec3_reject(painleve->impulse[k], n)) >
		            (1 + beyond_cone) * limit)
			return false;
	}
	respond(painleve, painleve->impulse, painleve->scratch);
	return true;
}

bool rb_painleve_slow(struct rb_painleve *painleve)
{
	double share = HUGE_VAL;

	respond(painleve, painleve->force, painleve->scratch);
	for (int k = 0; k < painleve->count; k++) {
		const struct rb_contact_point *const m = &painleve->contact_point[k];
		const rb_vec3 slip = rb_vec3_reject(m->velocity, m->normal);
		const double deceleration = -rb_vec3_dot(slip, painleve->scratch[k]);

		if (deceleration > 0 && rb_vec3_dot(painleve->force[k], m->normal) > 0)
			share = fmin(share, rb_vec3_dot(slip, slip) / deceleration);
	}
	if (!(share < HUGE_VAL))
		return false;
	for (int k = 0; k < painleve->count; k++)
		painleve->impulse[k] = rb_vec3_scale(share, painleve->force[k]);
	respond(painleve, painleve->impulse, painleve->scratch);
	return true;
}

/* True for a body that has a place; others are not dynamic. */
static bool is_dynamic(const struct rb_located *l, int body)
{
	return body < l->n && l->place[body] >= 0;
}

/* Arm on a dynamic body: a fixed one may be anywhere. */
static rb_vec3 arm_of(const struct rb_located *l, const struct rb_contact_point *m)
{
	return is_dynamic(l, m->a) ? m->arm_a : m->arm_b;
}

struct rb_contact_point rb_painleve_middle(const struct rb_located *l,
                                           const struct rb_contact_point *points,
                                           const rb_vec3 *force, int count)
{
	struct rb_contact_point all = points[0];
	rb_vec3 off = {0, 0, 0}, velocity = {0, 0, 0};
	double sum = 0;

	RB_ASSERT(count > 0);
	if (count == 1)
		return all;
	for (int i = 0; i < count; i++) {
		const struct rb_contact_point *const m = &points[i];
		const double normal_force = fmax(0, rb_vec3_dot(force[i], m->normal));

		off = rb_vec3_add_scaled(off, normal_force,
		                         rb_vec3_sub(arm_of(l, m), arm_of(l, &all)));
		velocity = rb_vec3_add_scaled(velocity, normal_force, m->velocity);
		sum += normal_force;
	}
	RB_ASSERT_COSTLY(sum > 0);
	off = rb_vec3_scale(1 / sum, off);
	all.velocity = rb_vec3_scale(1 / sum, velocity);
	all.point = rb_vec3_add(all.point, off);
	all.arm_a = rb_vec3_add(all.arm_a, off);
	all.arm_b = rb_vec3_add(all.arm_b, off);
	return all;
}

rb_vec3 rb_painleve_impulse(const struct rb_located *l, const struct rb_contact_point *m,
                            rb_vec3 *change)
{
	const struct rb_pair_material *const material = rb_contact_material(l->model, m->a, m->b);
	struct rb_eccentric contact = {.normal = m->normal,
	                               .friction = material->friction,
	                               .restitution = material->restitution};
	const rb_vec3 slip = rb_vec3_reject(m->velocity, m->normal);
	const double speed = rb_vec3_length(slip);

	if (is_dynamic(l, m->a))
		rb_mechanics_add_effective_mass(l, m->a, &m->pose_a, m->arm_a,
		                                &contact.inverse_effective_mass);
	if (is_dynamic(l, m->b))
		rb_mechanics_add_effective_mass(l, m->b, &m->pose_b, m->arm_b,
		                                &contact.inverse_effective_mass);
	const rb_vec3 impulse = rb_eccentric_impulse(
		&contact, rb_vec3_add_scaled(slip, -4 * DBL_EPSILON * speed, m->normal));

	*change = rb_mat3_apply(&contact.inverse_effective_mass, impulse);
	return rb_vec3_length(*change) > sqrt(DBL_EPSILON) * speed ? impulse : (rb_vec3){0, 0, 0};
}

int rb_painleve_alone(const struct rb_located *l, const struct rb_contact_point *points,
                      const rb_vec3 *force, int count)
{
	double largest = 0;
	int index = -1;

	RB_ASSERT(count > 0);
	for (int k = 0; k < count; k++) {
		const double normal_force = rb_vec3_dot(force[k], points[k].normal);
		rb_vec3 change;

		if (!(normal_force > largest))
			continue;
		const rb_vec3 impulse = rb_painleve_impulse(l, &points[k], &change);
		if (!(rb_vec3_dot(impulse, points[k].normal) > 0))
			continue;
		largest = normal_force;
		index = k;
	}
	return index;
}
