/* SPDX-License-Identifier: MIT */
#include "event/jam.h"

#include "event/pull.h"

/* Impulses along forces that have not quite grown beyond bounds are off the cones by so much. */
static const double beyond_cone = 0.01;

static int place_of(const struct rb_jam *jam, int body)
{
	return body < jam->l->n ? jam->l->place[body] : -1;
}

static void push(struct rb_jam *jam, int body, rb_vec3 arm, rb_vec3 impulse)
{
	const struct rb_located *l = jam->l;
	const int place = place_of(jam, body);

	if (place < 0)
		return;
	jam->linear[place] = rb_vec3_add_scaled(jam->linear[place], l->model->inverse_mass[body],
	                                        impulse);
	if (l->top)
		jam->angular[place] = rb_vec3_add(
			jam->angular[place], rb_pull_yield(l, body, jam->pose[place].orientation,
		                                           rb_vec3_cross(arm, impulse)));
}

static rb_vec3 moved(const struct rb_jam *jam, int body, rb_vec3 arm)
{
	const int place = place_of(jam, body);

	if (place < 0)
		return (rb_vec3){0, 0, 0};
	return rb_vec3_add(jam->linear[place], rb_vec3_cross(jam->angular[place], arm));
}

/* What impulses add to the relative velocities of the contacts' points, into `u`. */
static void respond(struct rb_jam *jam, const rb_vec3 *impulse, rb_vec3 *u)
{
	for (int k = 0; k < jam->body_count; k++)
		jam->linear[k] = jam->angular[k] = (rb_vec3){0, 0, 0};
	for (int k = 0; k < jam->count; k++) {
		const struct rb_meet *m = &jam->meet[k];

		push(jam, m->a, m->arm_a, rb_vec3_neg(impulse[k]));
		push(jam, m->b, m->arm_b, impulse[k]);
	}
	for (int k = 0; k < jam->count; k++) {
		const struct rb_meet *m = &jam->meet[k];

		u[k] = rb_vec3_sub(moved(jam, m->b, m->arm_b), moved(jam, m->a, m->arm_a));
	}
}

static double sum_of_dots(const rb_vec3 *a, const rb_vec3 *b, int count)
{
	double sum = 0;

	for (int k = 0; k < count; k++)
		sum += rb_vec3_dot(a[k], b[k]);
	return sum;
}

/*
 * Impulses that stop all contacts' points, by conjugate gradients from along the present forces: where more contacts than
 * freedoms leave them open, those that the growing forces lead to.
 */
static void stop_points(struct rb_jam *jam)
{
	const int n = jam->count;
	rb_vec3 *const impulse = jam->impulse, *const left = jam->scratch, *const along = left + n,
		       *const image = along + n;

	respond(jam, jam->force, image);
	for (int k = 0; k < n; k++) {
		impulse[k] = (rb_vec3){0, 0, 0};
		left[k] = rb_vec3_neg(jam->meet[k].velocity);
		along[k] = jam->force[k];
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
		/* the first direction is not the residual's */
		const double keep = round == 0 ? 0 : now / square;
		for (int k = 0; k < n; k++)
			along[k] = rb_vec3_add_scaled(left[k], keep, along[k]);
		square = now;
		respond(jam, along, image);
	}
}

bool rb_jam_stop(struct rb_jam *jam)
{
	stop_points(jam);
	for (int k = 0; k < jam->count; k++) {
		const rb_vec3 n = jam->meet[k].normal;
		const double limit = jam->friction[k] * rb_vec3_dot(jam->impulse[k], n);

		if (!(rb_vec3_dot(jam->impulse[k], n) >= 0) ||
		    rb_vec3_length(rb_vec3_reject(jam->impulse[k], n)) > (1 + beyond_cone) * limit)
			return false;
	}
	respond(jam, jam->impulse, jam->scratch);
	return true;
}
