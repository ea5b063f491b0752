/* SPDX-License-Identifier: MIT */
/*
 * The time that counts of crowds are held against is that of the bodies themselves: the more often
 * they pass their own size, the more often steps would have to look at them, too. Sums are of
 * rounded numbers, so that they do not depend on the order of bodies.
 */
#include "located/allowance.h"

#include <math.h>

#include "located/crowd.h"
#include "located/inspect.h"
#include "world/joint_state.h"

/*
 * Bodies of crowds that a body's way by its own size allows: each, or so many that stand, whose
 * steps are as cheap; and the fastest beside.
 */
enum { PACE_BODY = 1, PACE_AT_REST = 32, PACE_WORLD = 128, PACE_FEW = 4, PACE_RUN = 128 };

/* A number rounded down to eight bits: sums of such are the same in any order. */
static double eight_bits(double number)
{
	int exponent;
	const double digits = frexp(number, &exponent);

	return ldexp(floor(digits * 0x1p8), exponent - 8);
}

/* m/s, at the beginning: none of static bodies and of the world (-1). */
static rb_vec3 velocity_of(const struct rb_located *l, int i)
{
	return i >= 0 && i < l->n ? rb_world_row3(l->world->state.velocity, i) : (rb_vec3){0, 0, 0};
}

/* What holds a body at the beginning: how many joints, how fast it passes their other ends. */
struct holds {
	int count;
	double speed; /* m/s */
};

static struct holds holds_of(const struct rb_located *l, int i)
{
	const struct rb_joints *const joints = l->model->joints;
	struct holds all = {0, 0};

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

/* Speed, m/s, of a body at the beginning: a chain that swings or flies as one passes nothing. */
static double speed_of(const struct rb_located *l, int i)
{
	const struct holds holds = holds_of(l, i);

	return holds.count > 0 ? holds.speed : rb_vec3_length(velocity_of(l, i));
}

/* m/s: with which one that attracts is hit by what falls to it from afar. */
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

/* J: mean kinetic energy of bodies that no motion is given. */
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
 * 1/s: how often a body falls by its own size, or flies with the speed that it has, that a light
 * one will have with the same energy as others, or, if it is attracted, with `falls`, m/s.
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

		sum += pace * (1 + 0.5 * holds_of(l, i).count) /
		       (rb_inspect_is_at_rest(l, i) ? PACE_AT_REST : 1);
		max = fmax(max, pace);
	}
	const double few = l->n > PACE_FEW ? (double)PACE_FEW / l->n : 1;

	const double paid = max > 0 ? PACE_BODY * sum + PACE_WORLD * few * max
	                            : PACE_RUN * (PACE_BODY * (double)l->n + PACE_WORLD) / l->end_s;

	/* what speeds allow is a guess, steps have been counted */
	return (double)rb_located_worth(l) * fmin(paid, rb_crowd_stepped_pace(l));
}
