/* SPDX-License-Identifier: MIT */
/*
 * Painleve impacts: where friction makes the equations of rigid contact inconsistent, forces grow
 * without bound and stop the slip at once. The impulses solve the linear system "all contact points
 * stop" by conjugate gradients (Hestenes, Stiefel 1952), started along the present forces so that
 * of many solutions the one that these lead to is found.
 */
#include "located/painleve.h"

#include "located/external_force.h"

/*
 * Share by which impulses may be outside of the friction cone: the forces have not quite diverged.
 */
static const double beyond_cone = 0.01;

/* Place of a body in the set; -1: fixed. */
static int place_of(const struct rb_painleve *painleve, int body)
{
	return body < painleve->l->n ? painleve->l->place[body] : -1;
}

/* Adds an impulse to a body's change of velocity. */
static void apply(struct rb_painleve *painleve, int body, rb_vec3 arm, rb_vec3 impulse)
{
	const struct rb_located *l = painleve->l;
	const int place = place_of(painleve, body);

	if (place < 0)
		return;
	painleve->linear[place] = rb_vec3_add_scaled(painleve->linear[place],
	                                             l->model->inverse_mass[body], impulse);
	if (l->top)
		painleve->angular[place] = rb_vec3_add(
			painleve->angular[place],
			rb_effective_mass_inverse(l, body, painleve->pose[place].orientation,
		                                  rb_vec3_cross(arm, impulse)));
}

/* Change of velocity at an arm. */
static rb_vec3 moved(const struct rb_painleve *painleve, int body, rb_vec3 arm)
{
	const int place = place_of(painleve, body);

	if (place < 0)
		return (rb_vec3){0, 0, 0};
	return rb_vec3_add(painleve->linear[place], rb_vec3_cross(painleve->angular[place], arm));
}

/* Changes of the relative velocities of the contact points by impulses. */
static void respond(struct rb_painleve *painleve, const rb_vec3 *impulse, rb_vec3 *u)
{
	for (int k = 0; k < painleve->body_count; k++)
		painleve->linear[k] = painleve->angular[k] = (rb_vec3){0, 0, 0};
	for (int k = 0; k < painleve->count; k++) {
		const struct rb_contact_point *m = &painleve->contact_point[k];

		apply(painleve, m->a, m->arm_a, rb_vec3_neg(impulse[k]));
		apply(painleve, m->b, m->arm_b, impulse[k]);
	}
	for (int k = 0; k < painleve->count; k++) {
		const struct rb_contact_point *m = &painleve->contact_point[k];

		u[k] = rb_vec3_sub(moved(painleve, m->b, m->arm_b),
		                   moved(painleve, m->a, m->arm_a));
	}
}

static double sum_of_dots(const rb_vec3 *a, const rb_vec3 *b, int count)
{
	double sum = 0;

	for (int k = 0; k < count; k++)
		sum += rb_vec3_dot(a[k], b[k]);
	return sum;
}

/* Impulses that stop all contact points, by conjugate gradients. */
static void stop_points(struct rb_painleve *painleve)
{
	const int n = painleve->count;
	rb_vec3 *const impulse = painleve->impulse, *const left = painleve->scratch,
		       *const along = left + n, *const image = along + n;

	respond(painleve, painleve->force, image);
	for (int k = 0; k < n; k++) {
		impulse[k] = (rb_vec3){0, 0, 0};
		left[k] = rb_vec3_neg(painleve->contact_point[k].velocity);
		along[k] = painleve->force[k];
	}
	const double start = sum_of_dots(left, left, n);
	double square = start;
	for (int round = 0; round < 6 * n + 8 && square > 1e-28 * start; round++) {
		const double bend = sum_of_dots(along, image, n);

		if (!(bend > 0))
			break;
		const double share = sum_of_dots(along, left, n) / bend;
		for (int k = 0; k < n; k++) {
			impulse[k] = rb_vec3_add_scaled(impulse[k], share, along[k]);
			left[k] = rb_vec3_add_scaled(left[k], -share, image[k]);
		}
		const double now = sum_of_dots(left, left, n);
		/* the first direction is that of the forces, not the residual's */
		const double keep = round == 0 ? 0 : now / square;
		for (int k = 0; k < n; k++)
			along[k] = rb_vec3_add_scaled(left[k], keep, along[k]);
		square = now;
		respond(painleve, along, image);
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
