/* SPDX-License-Identifier: MIT */
/*
 * Counted work is compared with the bodies' own time scale: the more often bodies travel their own
 * size, the more steps would be needed, too. Sums are of rounded numbers, so that they do not
 * depend on the order of bodies.
 */
#include "located/allowance.h"

#include <math.h>

#include "located/crowd.h"
#include "located/inspect.h"
#include "world/joint_state.h"

/*
 * Bodies allowed each time a body travels its own size: by each one, or by so many at rest, whose
 * steps are as cheap; and by the fastest in addition.
 */
enum { PACE_BODY = 1, PACE_AT_REST = 32, PACE_WORLD = 128, PACE_FEW = 4, PACE_RUN = 128 };

/* A number rounded down to eight bits: sums of such are the same in any order. */
static double eight_bits(double number)
{
	int exponent;
	const double digits = frexp(number, &exponent);

	return ldexp(floor(digits * 0x1p8), exponent - 8);
}

/* Velocity at the beginning, m/s: zero for static bodies and the world (-1). */
static rb_vec3 velocity_of(const struct rb_located *l, int i)
{
	return i >= 0 && i < l->n ? rb_world_row3(l->world->state.velocity, i) : (rb_vec3){0, 0, 0};
}

/*
 * Joints that hold a body at the beginning: their number, and the largest speed relative to their
 * other ends.
 */
struct held_by {
	int count;
	double speed; /* m/s */
};

static struct held_by held_by_of(const struct rb_located *l, int i)
{
	const struct rb_joints *const joints = l->model->joints;
	struct held_by all = {0, 0};

	for (int k = joints ? joints->first[i] : 0; joints && k < joints->first[i + 1]; k++) {
		const struct rb_joint *const joint = &joints->joint[joints->of[k]];
		const rb_vec3 other = velocity_of(l, joint->a == i ? joint->b : joint->a);

		if (l->world->joint[joints->of[k]].released)
			continue;
		all.count++;
		all.speed = fmax(all.speed, rb_vec3_length(rb_vec3_sub(velocity_of(l, i), other)));
	}
	return all;
}

/*
 * Speed of a body at the beginning, m/s: for jointed bodies the relative one, which is zero for a
 * chain that flies as one.
 */
static double speed_of(const struct rb_located *l, int i)
{
	const struct held_by held_by = held_by_of(l, i);

	return held_by.count > 0 ? held_by.speed : rb_vec3_length(velocity_of(l, i));
}

/* Largest speed at which an attractor is hit by a body that falls from afar, m/s. */
static double fall_speed(const struct rb_located *l)
{
	const struct rb_model *model = l->model;
	double max = 0;

	for (int j = 0; model->attraction && j < model->body_count + model->static_count; j++) {
		const double reach = rb_model_reach(model, j);

		if (model->attraction[j] > 0 && reach > 0)
			max = fmax(max, sqrt(2 * model->attraction[j] / reach));
	}
	return max;
}

/* Mean kinetic energy of bodies that are not driven, J. */
static double mean_energy(const struct rb_located *l)
{
	double sum = 0;
	int count = 0;

	for (int i = 0; i < l->n; i++) {
		if (rb_located_driven(l, i))
			continue;
		sum += eight_bits(0.5 * l->model->mass[i] * speed_of(l, i) * speed_of(l, i));
		count++;
	}
	return count > 0 ? sum / count : 0;
}

/*
 * Rate at which a body falls by its own size, or travels it with its speed, with the speed of the
 * mean energy (which a light body will reach), or, if it is attracted, with `falls`, m/s; 1/s.
 */
static double own_pace(const struct rb_located *l, int i, double energy, double falls)
{
	const double size = rb_model_reach(l->model, i);
	const double force = rb_vec3_length(l->model->scene->world.gravity_force);
	const double fall = l->weight + l->model->inverse_mass[i] * force;
	double speed = fmax(speed_of(l, i), sqrt(2 * energy * l->model->inverse_mass[i]));

	if (falls > 0 && rb_gravitation_attracts(l->model, i))
		speed = fmax(speed, falls);

	if (!(size > 0 && size < HUGE_VAL))
		return 0;
	const double pace = fmax(sqrt(fall / (2 * size)), speed / size);
	return pace > 0 && pace < HUGE_VAL ? eight_bits(pace) : 0;
}

double rb_located_pace(const struct rb_located *l)
{
	const double energy = mean_energy(l), falls = fall_speed(l);
	double sum = 0, max = 0;

	for (int i = 0; i < l->n; i++) {
		const double pace = own_pace(l, i, energy, falls);

		sum += pace * (1 + 0.5 * held_by_of(l, i).count) /
		       (rb_inspect_is_at_rest(l, i) ? PACE_AT_REST : 1);
		max = fmax(max, pace);
	}
	const double few = l->n > PACE_FEW ? (double)PACE_FEW / l->n : 1;

	const double paid = max > 0 ? PACE_BODY * sum + PACE_WORLD * few * max
	                            : PACE_RUN * (PACE_BODY * (double)l->n + PACE_WORLD) / l->end_s;

	/* speeds only estimate the cost of steps, but steps taken were counted */
	return (double)rb_crowd_limit_factor(l) * fmin(paid, rb_crowd_stepped_pace(l));
}
