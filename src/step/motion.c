/* SPDX-License-Identifier: MIT */
/*
 * Verifies a driven body's function of time by adaptive bisection. An interval is smooth if the
 * displacement matches Simpson's rule over the returned velocities, or, without velocities, if the
 * middle is near the mean of the ends. Rough intervals are bisected further: at a kink roughness
 * shrinks with the interval, at a jump it does not and the interval reaches the resolution of time,
 * and velocities that contradict the positions are rough everywhere.
 */
#include "step/motion.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

#include "base/error.h"
#include "math/quat.h"
#include "math/vec3.h"
#include "model/joints.h"

/*
 * Samples that a few kinks and jumps of one interval never need (each takes two for each of some 50
 * halvings); contradicting velocities, rough everywhere, exceed it.
 */
enum { INSPECTIONS_MAX = 1024 };
/* Share of the size by which velocities and places may differ at a kink without notice. */
static const double kink_share = 1e-9;
/*
 * Share of the change over an interval by which its middle may be off the mean. A kink at the
 * middle is off by up to 1/2, as is a jump near an end.
 */
static const double bent = 0.4;

/* q or -q, whichever is nearer to `near`: both are the same orientation. */
static rb_quat on_side_of(rb_quat near, rb_quat q)
{
	if (q.w * near.w + q.x * near.x + q.y * near.y + q.z * near.z < 0)
		return (rb_quat){-q.w, -q.x, -q.y, -q.z};
	return q;
}

enum rb_status rb_motion_ask(const struct rb_world *world, int i, double t, rb_quat near,
                             struct rb_driven_pose *pose, struct rb_error *err)
{
	RB_ASSERT(i >= 0 && i < world->model->body_count);

	const struct rb_world_hooks *hooks = &world->hooks;
	enum rb_status status = RB_OK;

	*pose = (struct rb_driven_pose){.orientation = world->model->orientation[i]};
	if (hooks->motion)
		status = hooks->motion(hooks->user, world->model->id_of[i], t, pose, err);
	pose->orientation = on_side_of(near, pose->orientation);
	return status;
}

enum rb_status rb_motion_ask_motor(const struct rb_world *world, int joint, double t,
                                   struct rb_driven_pose *pose, struct rb_error *err)
{
	const struct rb_world_hooks *hooks = &world->hooks;

	double value[2] = {0, 0};
	const enum rb_status status = hooks->follow
	                                      ? hooks->follow(hooks->user, joint, t, value, err)
	                                      : RB_OK;

	*pose = (struct rb_driven_pose){.orientation = {1, 0, 0, 0},
	                                .position = {value[0], 0, 0},
	                                .has_velocity = !isnan(value[1]),
	                                .velocity = {isnan(value[1]) ? 0 : value[1], 0, 0}};
	return status;
}

double rb_motion_size(const struct rb_world *world, int i, bool motor)
{
	return motor && rb_linkage_turns(&world->model->joints->joint[i].link)
	               ? 1
	               : world->model->size_min_m;
}

const char *rb_motion_label(const struct rb_world *world, int i, bool motor,
                            char out[RB_MOTION_LABEL])
{
	const struct rb_model *model = world->model;
	const int def = motor ? model->joints->joint[i].def : 0;
	char label[96], source[96];

	if (motor)
		snprintf(out, RB_MOTION_LABEL, "%s'%s' of the motor of %s",
		         rb_joint_source(model->scene, def, source),
		         rb_linkage_turns(&model->joints->joint[i].link) ? "angle" : "way",
		         rb_joint_label(model->scene, def, label));
	else
		snprintf(out, RB_MOTION_LABEL, "%s'motion' of '%s'",
		         rb_scene_body_source(model->scene, model->id_of[i], source),
		         rb_scene_body_label(model->scene, model->id_of[i], label));
	return out;
}

/* Evaluates the function of a motion at a time. */
static enum rb_status ask(const struct rb_motion *motion, double t, rb_quat near,
                          struct rb_driven_pose *pose, struct rb_error *err)
{
	if (motion->motor)
		return rb_motion_ask_motor(motion->world, motion->i, t, pose, err);
	return rb_motion_ask(motion->world, motion->i, t, near, pose, err);
}

/* ---- bisection ---- */

struct moment {
	double t;
	struct rb_driven_pose pose;
};

struct watch {
	const struct rb_motion *motion;
	struct rb_error *err;
	enum rb_status status;
	bool places, turns; /* velocities, angular velocities are returned */
	double size, round; /* m: of the smallest body; rounding of coordinates */
	double instant;     /* s: shortest interval that is bisected */
	int inspections;
};

/* dq/dt = w q / 2, w in world axes. */
static rb_quat turning_of(const struct rb_driven_pose *pose)
{
	const rb_vec3 w = pose->angular_velocity;

	return rb_quat_multiply((rb_quat){0, 0.5 * w.x, 0.5 * w.y, 0.5 * w.z}, pose->orientation);
}

/* Components of place (3) or orientation (4) and of their rates; returns how many. */
static int values_of(const struct moment *m, bool turns, double value[4], double rate[4])
{
	if (turns) {
		rb_quat_to(value, m->pose.orientation);
		rb_quat_to(rate, turning_of(&m->pose));
		return 4;
	}
	rb_vec3_to(value, m->pose.position);
	rb_vec3_to(rate, m->pose.velocity);
	return 3;
}

/*
 * Deviation of [a, b] from a smooth motion, judged at its middle m: the change against Simpson's
 * rule over the velocities, or the middle against the mean of the ends. Zero within what is not
 * noticeable and the rounding of time.
 */
static double roughness(const struct watch *w, const struct moment *a, const struct moment *m,
                        const struct moment *b, bool turns)
{
	const bool given = turns ? w->turns : w->places;
	const double unit = turns ? 1 : w->size, h = b->t - a->t;
	double at[3][4], rate[3][4], off = 0, way = 0, ride = 0, speed = 0;
	const int count = values_of(a, turns, at[0], rate[0]);

	values_of(m, turns, at[1], rate[1]);
	values_of(b, turns, at[2], rate[2]);
	for (int k = 0; k < count; k++) {
		const double change = at[2][k] - at[0][k];
		const double by_rate = h / 6 * (rate[0][k] + 4 * rate[1][k] + rate[2][k]);
		const double middle = at[1][k] - 0.5 * (at[0][k] + at[2][k]);

		off = fmax(off, fabs(given ? change - by_rate : middle));
		way = fmax(way, fabs(change));
		ride = fmax(ride, fabs(by_rate));
		speed = fmax(speed, fabs(rate[1][k]));
	}
	const double unseen = (given ? kink_share : w->motion->coarse) * unit +
	                      16 * DBL_EPSILON * (turns ? 1 : w->round);
	const double known = given ? w->motion->agreement * (way + ride) +
	                                     16 * DBL_EPSILON * fabs(b->t) * speed
	                           : bent * way;
	return off > unseen + known ? off : 0;
}

/* An interval with its middle; orientations continue on one side. */
struct part {
	struct moment begin, middle, end;
	bool rough[2]; /* places, orientations */
};

/* Samples the middle and rates both halves' roughness; false: the function failed. */
static bool sample(struct watch *w, const struct moment *begin, const struct moment *end,
                   struct part *part)
{
	RB_ASSERT(end->t >= begin->t);

	*part = (struct part){.begin = *begin, .end = *end};
	struct moment *const m = &part->middle;

	m->t = begin->t + 0.5 * (end->t - begin->t);
	w->status = ask(w->motion, m->t, begin->pose.orientation, &m->pose, w->err);
	part->end.pose.orientation = on_side_of(m->pose.orientation, end->pose.orientation);
	for (int turns = 0; turns < 2; turns++)
		part->rough[turns] = roughness(w, begin, m, &part->end, turns) > 0;
	return w->status == RB_OK;
}

/* Angle of the turn from one orientation to another, rad. */
static double angle_between(rb_quat a, rb_quat b)
{
	const rb_quat d = rb_quat_multiply(b, (rb_quat){a.w, -a.x, -a.y, -a.z});

	return 2 * atan2(rb_vec3_length((rb_vec3){d.x, d.y, d.z}), fabs(d.w));
}

static void refuse_jump(struct watch *w, const struct moment *a, const struct moment *b)
{
	const struct rb_motion *motion = w->motion;
	const double way = rb_vec3_length(rb_vec3_sub(b->pose.position, a->pose.position));
	const double angle = angle_between(a->pose.orientation, b->pose.orientation);
	const bool turns = angle > way / w->size;
	const bool hinge = motion->motor &&
	                   rb_linkage_turns(&motion->world->model->joints->joint[motion->i].link);
	char label[RB_MOTION_LABEL];

	w->status = RB_FAIL(w->err, RB_ERR_SCENE,
	                    "%s jumps by %.3g %s at t = %.9g s: %s moves without jumps",
	                    rb_motion_label(motion->world, motion->i, motion->motor, label),
	                    turns ? angle : way, turns || hinge ? "rad" : "m", b->t,
	                    motion->motor ? "what a motor follows" : "a driven body");
}

static void refuse_velocities(struct watch *w, const struct part *p, bool turns)
{
	const struct rb_motion *motion = w->motion;
	const double off = roughness(w, &p->begin, &p->middle, &p->end, turns) /
	                   (p->end.t - p->begin.t);
	char label[RB_MOTION_LABEL];

	w->status = RB_FAIL(w->err, RB_ERR_SCENE,
	                    "%s at t = %.9g s: its %s is %.3g %s off what leads from "
	                    "one %s to the next (it may be left out)",
	                    rb_motion_label(motion->world, motion->i, motion->motor, label),
	                    p->begin.t, turns ? "angular velocity" : "velocity",
	                    turns ? 2 * off : off, turns ? "rad/s" : "m/s",
	                    turns ? "orientation" : "position");
}

/* Bisects a rough interval; a jump is what remains rough down to the resolution of time. */
static void inspect_closer(struct watch *w, const struct part *p)
{
	struct part low, high;

	if (!(p->end.t - p->begin.t > w->instant)) {
		refuse_jump(w, &p->begin, &p->end);
		return;
	}
	if (!sample(w, &p->begin, &p->middle, &low) || !sample(w, &p->middle, &p->end, &high))
		return;
	w->inspections += 2;
	/* only the first jump is reported */
	if (low.rough[0] || low.rough[1])
		inspect_closer(w, &low);
	if (w->status == RB_OK && w->inspections < INSPECTIONS_MAX &&
	    (high.rough[0] || high.rough[1]))
		inspect_closer(w, &high);
}

enum rb_status rb_motion_watch(const struct rb_motion *motion, struct rb_error *err)
{
	const struct moment begin = {motion->from_s, motion->begin};
	const struct moment end = {motion->to_s, motion->end};
	struct watch w = {.motion = motion,
	                  .err = err,
	                  .places = begin.pose.has_velocity && end.pose.has_velocity,
	                  .turns = begin.pose.has_angular_velocity && end.pose.has_angular_velocity,
	                  .size = rb_motion_size(motion->world, motion->i, motion->motor),
	                  .round = fmax(rb_vec3_max_abs(begin.pose.position),
	                                rb_vec3_max_abs(end.pose.position)),
	                  .instant = 4 * DBL_EPSILON * fmax(end.t, end.t - begin.t)};
	struct part all;

	if (sample(&w, &begin, &end, &all) && (all.rough[0] || all.rough[1]))
		inspect_closer(&w, &all);
	if (motion->middle)
		*motion->middle = all.middle.pose;
	for (int turns = 0; turns < 2; turns++)
		if (w.status == RB_OK && w.inspections >= INSPECTIONS_MAX && all.rough[turns] &&
		    (turns ? w.turns : w.places))
			refuse_velocities(&w, &all, turns);
	return w.status;
}
