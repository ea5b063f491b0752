/* SPDX-License-Identifier: MIT */
/*
 * Painleve impacts: where friction makes the equations of rigid contact inconsistent, forces grow
 * without bound and stop the slip at once. The impulses solve the linear system "all contact points
 * stop" by conjugate gradients (Hestenes, Stiefel 1952), started along the present forces so that
 * of many solutions the one that these lead to is found.
 */
#include "located/painleve.h"

#include "located/mechanics.h"

/*
 * Share by which impulses may be outside of the friction cone: the forces have not quite diverged.
 */
static const double beyond_cone = 0.01;

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
