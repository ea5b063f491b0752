/* SPDX-License-Identifier: MIT */
#include "stepped/joint_constraints.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "constraint/effective_mass.h"
#include "world/joint_state.h"

RB_FIELDS_DEFINE(rb_joint_memory_fields, struct rb_joint_memory, RB_JOINT_MEMORY_FIELDS);

static const rb_vec3 none = {0, 0, 0};

/* Whether the joint has that part, of those after the rows of its linkage. */
static bool has_part(const struct rb_joint *joint, int part)
{
	if (!rb_linkage_has_free(&joint->link))
		return false;
	switch (part) {
	case RB_JOINT_LOW:
		return isfinite(joint->low);
	case RB_JOINT_HIGH:
		return isfinite(joint->high);
	case RB_JOINT_SPRING:
		return joint->stiffness > 0 || joint->damping > 0;
	case RB_JOINT_MOTOR:
		return joint->has_motor;
	default:
		return joint->friction > 0;
	}
}

/* The part of each row, of a FREE one the first of three; returns their number. */
static int list_parts(const struct rb_joint *joint, int part[RB_JOINT_PARTS])
{
	const int count = rb_linkage_row_count(&joint->link);
	int rows = 0;

	for (int k = 0; k < count; k += k == 0 && rb_linkage_has_point(&joint->link) ? 3 : 1)
		part[rows++] = k;
	for (int k = RB_JOINT_LOW; k < RB_JOINT_PARTS; k++)
		if (has_part(joint, k))
			part[rows++] = k;
	return rows;
}

int rb_step_joint_rows_count(const struct rb_joint *joint)
{
	int part[RB_JOINT_PARTS];

	return list_parts(joint, part);
}

static bool is_dynamic(const struct rb_model *model, int i)
{
	return i >= 0 && i < model->body_count && model->inverse_mass[i] > 0;
}

static bool is_turned_round(const struct rb_model *model, const struct rb_joint *joint)
{
	return rb_step_joint_rows_owner(model, joint) != joint->a;
}

/* Of the state; velocities are those before the step. */
static struct rb_pose pose_of(const struct rb_world *world, const struct rb_state *before, int i)
{
	if (i < 0)
		return rb_linkage_world();
	struct rb_pose pose = rb_world_pose(world, &world->state, i);

	if (before && i < world->model->body_count) {
		pose.velocity = rb_world_row3(before->velocity, i);
		pose.spin = before->spin ? rb_world_row3(before->spin, i) : none;
	}
	return pose;
}

/* ---- filling ---- */

struct filling {
	const struct rb_joint_query *query;
	const struct rb_joint *joint;
	struct rb_step_joint *of;
	struct rb_linkage_row link[RB_LINKAGE_ROWS_MAX];
	struct rb_linkage_free free;
	struct rb_pose a, b;
	double way; /* of the free coordinate, turns counted */
};

/* N s, N m s: what a part's impulse begins from. */
static double given_by(const struct filling *f, int part)
{
	return f->query->at_end ? f->of->impulse[part]
	                        : f->query->lasts_s * f->of->last.force[part];
}

/* Three rows of a point: at the middle of both, so that no torque is left over. */
static struct rb_constraint point_row(const struct filling *f)
{
	const double h = f->query->h_s;
	const rb_vec3 d = {f->link[0].error, f->link[1].error, f->link[2].error};
	const rb_vec3 bend = rb_vec3_sub(rb_vec3_from(f->of->bend), rb_vec3_from(f->of->left));
	const rb_vec3 target = rb_vec3_scale(f->query->at_end ? 0 : -1 / h,
	                                     f->query->before ? rb_vec3_add(d, bend) : d);
	struct rb_constraint row = {.set = RB_CONSTRAINT_FREE, .normal = {0, 0, 1}};

	row.arm_a = rb_vec3_add_scaled(rb_quat_rotate(f->a.orientation, f->joint->link.at_a), 0.5,
	                               d);
	row.arm_b = rb_vec3_add_scaled(rb_quat_rotate(f->b.orientation, f->joint->link.at_b), -0.5,
	                               d);
	row.target = rb_constraint_split(&row, target);
	if (f->query->before)
		row.impulse = rb_constraint_split(
			&row, (rb_vec3){given_by(f, 0), given_by(f, 1), given_by(f, 2)});
	return row;
}

/*
 * One row of a linkage for a rate of it: arms across the normal, or a couple; `*scale`: what a unit
 * of the rate is of the row's velocity, m/s.
 */
static struct rb_constraint line_row(const struct filling *f, const struct rb_linkage_row *link,
                                     double rate, double *scale)
{
	struct rb_constraint row = {.set = RB_CONSTRAINT_INTERVAL};

	if (rb_vec3_max_abs(link->linear) > 0) {
		row.normal = link->linear;
		row.arm_a = rb_vec3_neg(rb_vec3_cross(link->linear, link->angular_a));
		row.arm_b = rb_vec3_cross(link->linear, link->angular_b);
		*scale = 1;
	} else {
		row.couple = true;
		row.normal = rb_vec3_unit(link->angular_b, (rb_vec3){0, 0, 1});
		row.arm_a.x = f->joint->size;
		/* of errors: turning by angles whose directions are not units away from zero */
		*scale = f->joint->size / rb_vec3_length(link->angular_b);
	}
	row.target.n = *scale * rate;
	return row;
}

/* N s of a row's impulse for a multiplier: impulse along or about its unit axis. */
static double impulse_of(const struct rb_constraint *row, double given)
{
	return given / (row->couple ? row->arm_a.x : 1);
}

/* In a second half: what pushes one way holds on where it has done so in the first. */
static void keep_open(const struct filling *f, struct rb_constraint *row, int part)
{
	if (f->query->at_end && f->of->impulse[part] == 0)
		row->low = row->high = 0;
}

static struct rb_constraint linkage_row(const struct filling *f, int k)
{
	const double bend = f->query->before ? f->of->bend[k] - f->of->left[k] : 0;
	double rate = -(f->link[k].error + bend) / f->query->h_s, scale;

	if (f->query->before && f->of->eases)
		rate = fmax(rate, 0);
	struct rb_constraint row = line_row(f, &f->link[k], f->query->at_end ? 0 : rate, &scale);

	row.low = -(double)INFINITY;
	row.high = f->joint->link.type->one_sided ? 0 : (double)INFINITY;
	if (f->joint->link.type->one_sided)
		keep_open(f, &row, k);
	return row;
}

/*
 * Springs are at the end of `ahead`, s, which is also what they act for: of their stretch there,
 * and of their rate.
 */
static void soften(const struct filling *f, struct rb_constraint *row, double ahead)
{
	const double k = f->joint->stiffness, c = f->joint->damping;
	const double softness = 1 / (ahead * (ahead * k + c));
	const double scale = row->couple ? row->arm_a.x / rb_vec3_length(f->free.row.angular_b) : 1;

	/* an impulse p of the row is scale p of torque, its velocity scale times the rate */
	row->softness = scale * scale * softness;
	row->target.n = -scale * softness * ahead * k * (f->way - f->joint->rest);
}

static rb_vec3 turn_by(const struct filling *f, int i, rb_vec3 torque)
{
	return is_dynamic(f->query->world->model, i) ? rb_solver_turn(f->query->bodies, i, torque)
	                                             : none;
}

/*
 * What the joint's other rows leave of how its free coordinate yields if its bodies are free: what
 * slides does not turn, what turns goes about the axis. A bound of how it yields in a mechanism.
 */
static double left_by_linkage(const struct filling *f)
{
	const struct rb_joint *joint = f->joint;
	const int count = rb_linkage_row_count(&joint->link);
	double g[RB_LINKAGE_ROWS_MAX + 1][RB_LINKAGE_ROWS_MAX + 1];
	double own[RB_LINKAGE_ROWS_MAX + 1];
	double inverse_mass = 0;

	for (int e = 0; e < 2; e++) {
		const int i = e == 0 ? joint->a : joint->b;

		if (is_dynamic(f->query->world->model, i))
			inverse_mass += f->query->bodies->body[i].inverse_mass;
	}
	for (int i = 0; i <= count; i++) {
		const struct rb_linkage_row *row = i < count ? &f->link[i] : &f->free.row;
		const rb_vec3 a = turn_by(f, joint->a, row->angular_a),
			      b = turn_by(f, joint->b, row->angular_b);

		for (int j = 0; j <= i; j++) {
			const struct rb_linkage_row *to = j < count ? &f->link[j] : &f->free.row;

			g[i][j] = inverse_mass * rb_vec3_dot(row->linear, to->linear) +
			          rb_vec3_dot(a, to->angular_a) + rb_vec3_dot(b, to->angular_b);
		}
		own[i] = g[i][i];
	}
	for (int k = 0; k < count; k++)
		for (int i = k + 1; i <= count && g[k][k] > DBL_EPSILON * own[k]; i++)
			for (int j = k + 1; j <= i; j++)
				g[i][j] -= g[i][k] * g[j][k] / g[k][k];
	return g[count][count] / own[count];
}

/*
 * At the end of the step, or at its middle where impulses are halved and the step resolves it; a
 * second half repeats that.
 */
static void make_spring(const struct filling *f, struct rb_constraint *row)
{
	const struct rb_joint_query *query = f->query;

	if (query->at_end) {
		row->low = row->high = f->of->spring_is_late
		                               ? 0
		                               : impulse_of(row, f->of->impulse[RB_JOINT_SPRING]);
		row->target.n = row->softness = 0;
		return;
	}
	row->low = -(double)INFINITY;
	row->high = (double)INFINITY;
	soften(f, row, query->h_s);
	/* written so that NaN is late */
	f->of->spring_is_late = !(query->lasts_s < query->h_s &&
	                          (row->inverse_mass_n <= row->softness ||
	                           row->inverse_mass_n * left_by_linkage(f) <= row->softness));
	if (!f->of->spring_is_late)
		soften(f, row, query->lasts_s);
}

/* ---- motors that follow ---- */

/*
 * Of its part in the braking that a motor has beside the load (located/follow.h). And the share of
 * its bound by which its force must have changed, for what came of that to tell how its joint
 * answers.
 */
static const double brake_share = 0.5, change_share = 0.1;
/* Share of its bound within which a force is at it. */
static const double at_bound = 1e-9;

/* Has it a motor that follows, in a step that bodies move in? */
static bool follows(const struct filling *f)
{
	return f->query->before && !isnan(f->of->wanted) &&
	       isnan(f->query->world->joint[f->joint->def].motor_speed);
}

/*
 * What the step before tells: what the motor's force has changed in the acceleration of the free
 * coordinate. `answer_max`: if its bodies were free, which is more.
 */
static void learn(const struct filling *f, double answer_max)
{
	struct rb_joint_memory *const last = &f->of->last;
	const double max = f->query->world->joint[f->joint->def].motor_max;
	const double force = last->force[RB_JOINT_MOTOR];

	if (!(last->length_s > 0)) {
		last->acceleration = (double)NAN;
		last->answer = 0;
		return;
	}
	const double acceleration = (f->free.rate - last->rate) / last->length_s;
	const double change = force - last->motor;
	const double answer = (acceleration - last->acceleration) / change;

	/* written so that NAN tells nothing; what moves nothing is not tried again */
	if (fabs(change) >= change_share * max && answer > 0 && answer <= answer_max)
		last->answer = answer;
	else if (fabs(change) >= change_share * max && !(last->answer > 0) && !isnan(answer))
		last->answer = -1;
	last->acceleration = acceleration;
	last->motor = force;
}

/*
 * With which deceleration it begins to brake what it closes in `way` (1 or -1), relative to what it
 * follows, which itself has the acceleration `bends`; 0: at once, it has nothing to brake with;
 * INFINITY: not known.
 */
static double braking_of(const struct filling *f, double way, double bends)
{
	const struct rb_joint_memory *const last = &f->of->last;
	const double max = f->query->world->joint[f->joint->def].motor_max;
	const double force = last->force[RB_JOINT_MOTOR];
	/* what is followed moves away from it, or towards it */
	const double load = last->acceleration - last->answer * force - bends;

	return last->answer > 0 ? fmax(0, brake_share * (last->answer * max - way * load))
	                        : (double)INFINITY;
}

/* The rate that a motor which follows is asked for. */
static double follow_rate(const struct filling *f)
{
	struct rb_step_joint *const of = f->of;
	const double h = f->query->h_s, off = of->wanted_before - f->way, way = off < 0 ? -1 : 1;
	const double mean = (of->wanted - of->wanted_before) / h;
	const double closes = way * (f->free.rate - mean), d = fabs(off);
	const double brake_max = braking_of(f, way, 2 * (of->wanted_rate - mean) / h);
	const double keeps = sqrt(2 * brake_max * d); /* what could just be braked */
	double a = of->last.brakes * way;

	of->end_rate = (double)NAN;
	if (!(a > 0) || closes < 0.5 * sqrt(2 * a * d))
		a = closes > 0.5 * keeps && closes >= keeps - brake_max * h
		            ? closes * closes / (2 * d)
		            : 0;
	of->last.brakes = way * a;
	if (!(a > 0))
		a = brake_max > 0 ? brake_max : (double)INFINITY;
	/* written so that NAN is there within the step */
	if (!(d > 0.5 * fmax(a, brake_max) * h * h)) {
		of->last.brakes = 0;
		return (of->wanted - f->way) / h;
	}
	of->end_rate = mean + way * (sqrt(2 * a * d) - a * h);
	return mean + way * (sqrt(2 * a * d) - 0.5 * a * h);
}

/*
 * It gives all that it has, and has done so ever since it began: for a step it gives half of it, to
 * see how its joint answers.
 */
static bool must_probe(const struct filling *f)
{
	const struct rb_joint_memory *const last = &f->of->last;
	const double max = f->query->world->joint[f->joint->def].motor_max;

	return last->answer == 0 && fabs(last->force[RB_JOINT_MOTOR]) >= max * (1 - at_bound);
}

/* In a second half: whether the first one had all of motor and friction. */
static bool is_given(const struct filling *f)
{
	return f->query->at_end && f->of->spring_is_late;
}

/* Once it is known how its bodies yield; `scale`: the row's velocity per rate. */
static void make_motor(const struct filling *f, struct rb_constraint *row)
{
	const double lever = row->couple ? row->arm_a.x : 1;
	const double scale = row->couple ? lever / rb_vec3_length(f->free.row.angular_b) : 1;
	const double given = impulse_of(row, f->of->impulse[RB_JOINT_MOTOR]);

	if (!follows(f) || is_given(f))
		return;
	if (!f->query->at_end) {
		learn(f, row->inverse_mass_n / (scale * lever));
		row->target.n = scale * follow_rate(f);
		if (must_probe(f))
			row->high *= 0.5;
		row->low = -row->high;
		f->of->motor_bound = row->high;
		return;
	}
	row->target.n = scale * (isnan(f->of->end_rate) ? f->of->wanted_rate : f->of->end_rate);
	/* all of it is all of it in both halves: it is asked for what it cannot reach */
	if (fabs(given) >= f->of->motor_bound * (1 - at_bound))
		row->low = row->high = given;
}

/*
 * m/s, rad/s: with which a limit is come to by the end; `ahead`: it is that far. What turns of a
 * step have taken beyond it comes back within a whole step: in a short part that would throw it.
 */
static double limit_rate(const struct rb_joint_query *query, double ahead, bool is_beyond)
{
	return ahead / (query->before && is_beyond ? fmax(query->h_s, query->whole_s) : query->h_s);
}

static struct rb_constraint free_row(const struct filling *f, int part)
{
	const double speed = f->query->world->joint[f->joint->def].motor_speed;
	const double low = f->joint->low - f->way, high = f->joint->high - f->way;
	double rate = 0;

	if (part == RB_JOINT_LOW && !f->query->at_end)
		rate = limit_rate(f->query, low, low > 0);
	else if (part == RB_JOINT_HIGH && !f->query->at_end)
		rate = limit_rate(f->query, high, high < 0);
	else if (part == RB_JOINT_MOTOR && !isnan(speed))
		rate = speed; /* of what follows it is known with how its bodies yield */
	double scale, max = 0;
	struct rb_constraint row = line_row(f, &f->free.row, rate, &scale);

	if (part == RB_JOINT_LOW || part == RB_JOINT_HIGH) {
		row.low = part == RB_JOINT_LOW ? 0 : -(double)INFINITY;
		row.high = part == RB_JOINT_LOW ? (double)INFINITY : 0;
		keep_open(f, &row, part);
		return row;
	}
	if (!f->query->before)
		return row; /* positions are moved: 0 and 0 */
	if (part == RB_JOINT_SPRING)
		return row; /* made when it is known how its bodies yield */
	max = part == RB_JOINT_MOTOR ? f->query->world->joint[f->joint->def].motor_max
	                             : f->joint->friction;
	if (is_given(f)) /* 0 and 0 */
		return row;
	row.high = impulse_of(&row,
	                      (f->of->spring_is_late ? f->query->h_s : f->query->lasts_s) * max);
	row.low = -row.high;
	return row;
}

/* A body that is not dynamic is the second. */
static void turn_round(struct rb_constraint *row)
{
	const rb_vec3 arm = row->arm_a;

	row->normal = rb_vec3_neg(row->normal);
	row->target.t = rb_vec3_neg(row->target.t);
	row->impulse.t = rb_vec3_neg(row->impulse.t);
	if (row->couple)
		return;
	row->arm_a = row->arm_b;
	row->arm_b = arm;
}

static void set_ends(const struct filling *f, struct rb_constraint *row)
{
	const struct rb_model *model = f->query->world->model;
	const bool round = is_turned_round(model, f->joint);
	const int a = round ? f->joint->b : f->joint->a, b = round ? f->joint->a : f->joint->b;

	if (round)
		turn_round(row);
	row->a = a;
	row->b = b >= 0 && b < model->body_count ? b : f->query->fixed;
	RB_ASSERT_COSTLY(is_dynamic(model, a));
}

/* Its poses alone. */
static struct filling begin_poses(const struct rb_joint_query *query, int k,
                                  struct rb_step_joint *of)
{
	const struct rb_joint *joint = &query->world->model->joints->joint[k];

	return (struct filling){.query = query,
	                        .joint = joint,
	                        .of = of,
	                        .a = pose_of(query->world, query->before, joint->a),
	                        .b = pose_of(query->world, query->before, joint->b)};
}

static struct filling begin(const struct rb_joint_query *query, int k, struct rb_step_joint *of)
{
	struct filling f = begin_poses(query, k, of);
	const struct rb_joint *joint = f.joint;

	(void)rb_linkage_rows(&joint->link, &f.a, &f.b, f.link);
	if (rb_linkage_has_free(&joint->link)) {
		f.free = rb_linkage_free(&joint->link, &f.a, &f.b);
		f.way = rb_linkage_turns(&joint->link)
		                ? rb_linkage_angle_near(f.free.value, of->last.way)
		                : f.free.value;
	}
	return f;
}

/*
 * What steps have left of errors goes within a whole step, too: in a short part it would throw
 * bodies. Of what is within a rope, nothing is an error.
 */
static void keep_errors(const struct filling *f)
{
	const double share = 1 - f->query->h_s / fmax(f->query->h_s, f->query->whole_s);
	const bool rope = f->joint->link.type->one_sided;

	for (int r = 0; r < rb_linkage_row_count(&f->joint->link); r++)
		f->of->left[r] = share * (rope ? fmax(0, f->link[r].error) : f->link[r].error);
}

void rb_step_joint_rows_fill(const struct rb_joint_query *query, int k, struct rb_step_joint *of,
                             struct rb_constraint *row)
{
	const struct filling f = begin(query, k, of);
	int part[RB_JOINT_PARTS];
	const int rows = list_parts(f.joint, part);

	if (query->before && !query->at_end)
		keep_errors(&f);

	RB_ASSERT_COSTLY(query->h_s > 0);
	if (query->before && !query->at_end)
		of->rate = f.joint->link.type->one_sided
		                   ? rb_linkage_row_velocity(&f.link[0], &f.a, &f.b)
		                   : f.free.rate;
	for (int r = 0; r < rows; r++) {
		if (part[r] == 0 && rb_linkage_has_point(&f.joint->link)) {
			row[r] = point_row(&f);
		} else {
			row[r] = part[r] < RB_JOINT_LOW ? linkage_row(&f, part[r])
			                                : free_row(&f, part[r]);
			if (query->before)
				row[r].impulse.n = impulse_of(&row[r], given_by(&f, part[r]));
		}
		set_ends(&f, &row[r]);
		rb_effective_mass_fill(query->bodies, &row[r]);
		if (part[r] == RB_JOINT_SPRING && query->before)
			make_spring(&f, &row[r]);
		if (part[r] == RB_JOINT_MOTOR)
			make_motor(&f, &row[r]);
		row[r].impulse = rb_constraint_project(&row[r], row[r].impulse);
	}
}

/* ---- what has come of it ---- */

/* The middle of the velocities before and after; of bodies that do not yield there is one. */
static struct rb_solver_body mean_of(const struct rb_joint_query *query, int i)
{
	struct rb_solver_body body = query->bodies->body[i], was = body;
	const double half = 0.5 * query->share;

	if (body.inverse_mass == 0)
		return body;
	if (query->from) {
		was = query->from[i];
	} else {
		was.linear = rb_world_row3(query->before->velocity, i);
		was.angular = query->before->spin ? rb_world_row3(query->before->spin, i) : none;
	}
	body.linear = rb_vec3_add_scaled(was.linear, half, rb_vec3_sub(body.linear, was.linear));
	body.angular = rb_vec3_add_scaled(was.angular, half,
	                                  rb_vec3_sub(body.angular, was.angular));
	return body;
}

/* Of what is dynamic by what is not; `at`: the second body's centre of mass. */
static void note_fixed(struct rb_joint_work *work, const struct rb_constraint *row, rb_vec3 at,
                       const struct rb_solver_body *fixed)
{
	const rb_vec3 p = rb_vec3_neg(rb_constraint_impulse(row));

	if (row->couple) {
		const rb_vec3 twist = rb_vec3_scale(row->arm_a.x, p);

		work->angular = rb_vec3_add(work->angular, twist);
		work->driven += rb_vec3_dot(twist, fixed->angular);
		return;
	}
	work->linear = rb_vec3_add(work->linear, p);
	work->angular = rb_vec3_add(work->angular, rb_vec3_cross(rb_vec3_add(at, row->arm_b), p));
	work->driven += rb_vec3_dot(p, rb_solver_point_velocity(fixed, row->arm_b));
}

static void note_work(struct rb_joint_work *work, bool one_sided, int part, double done)
{
	if (part == RB_JOINT_MOTOR)
		work->motor += done;
	else if (part == RB_JOINT_FRICTION)
		work->friction -= done;
	else if (part == RB_JOINT_SPRING)
		work->spring += done;
	else if (part == RB_JOINT_LOW || part == RB_JOINT_HIGH || one_sided)
		work->impacts -= done;
}

/*
 * `done`: by the middle of the velocities before and after. What velocities did not fit the joint
 * by as the step began has been taken away, whatever the step: of halves, and where they were set.
 */
static void note_held(const struct filling *f, int k, const struct rb_constraint *row, double done)
{
	const bool was_set = f->query->world->joint[k].was_set && !f->query->at_end;
	const bool first = f->query->lasts_s < f->query->h_s && !f->query->at_end;
	const rb_vec3 p = rb_constraint_impulse(row);
	const double at_end = 0.5 * rb_vec3_dot(p, rb_constraint_velocity(f->query->bodies, row));
	const bool rope = f->joint->link.type->one_sided;

	/* what comes taut is an impact, of which no shorter step takes less */
	if (!rope || f->of->last.force[0] != 0)
		f->of->work.held += first || was_set ? at_end : done;
	f->of->work.pushed += rb_vec3_length(p);
	/* of ropes all of it is */
	if (was_set && !rope)
		f->of->work.impacts -= done - at_end;
}

/* Adds a row's impulse to the sums of the joint. */
static void note_row(const struct filling *f, int k, int part, const struct rb_constraint *whole)
{
	struct rb_constraint given = *whole;
	const struct rb_constraint *const row = &given;

	given.impulse.n *= f->query->share;
	given.impulse.t = rb_vec3_scale(f->query->share, given.impulse.t);

	const struct rb_model *model = f->query->world->model;
	struct rb_step_joint *const of = f->of;
	const double sign = is_turned_round(model, f->joint) ? -1 : 1;
	const rb_vec3 p = rb_vec3_scale(sign, rb_constraint_impulse(row));
	const rb_vec3 to_point = rb_quat_rotate(f->b.orientation, f->joint->link.at_b);
	const struct rb_solver_body two[2] = {mean_of(f->query, row->a), mean_of(f->query, row->b)};
	const struct rb_solver_bodies pair = {.body = (struct rb_solver_body *)two};
	struct rb_constraint alone = given;

	if (row->set == RB_CONSTRAINT_FREE) {
		of->impulse[0] += p.x;
		of->impulse[1] += p.y;
		of->impulse[2] += p.z;
	} else {
		of->impulse[part] += row->impulse.n * (row->couple ? row->arm_a.x : 1);
	}
	if (row->couple) {
		of->twist = rb_vec3_add_scaled(of->twist, row->arm_a.x, p);
	} else {
		const rb_vec3 arm = sign < 0 ? row->arm_a : row->arm_b;

		of->reaction = rb_vec3_add(of->reaction, p);
		of->twist = rb_vec3_add(of->twist, rb_vec3_cross(rb_vec3_sub(arm, to_point), p));
	}
	alone.a = 0;
	alone.b = 1;
	const double done = rb_vec3_dot(rb_constraint_impulse(row),
	                                rb_constraint_velocity(&pair, &alone));

	note_work(&of->work, f->joint->link.type->one_sided, part, done);
	if (part < RB_JOINT_LOW)
		note_held(f, k, &given, done);
	if (two[1].inverse_mass == 0)
		note_fixed(&of->work, row, sign < 0 ? f->a.position : f->b.position, &two[1]);
}

/* As the solution has it. */
static void give_velocity(const struct rb_joint_query *query, int i, struct rb_pose *pose)
{
	if (i < 0 || i >= query->world->model->body_count)
		return;
	pose->velocity = query->bodies->body[i].linear;
	pose->spin = query->bodies->body[i].angular;
}

/* Where errors of the linkage would be at the end, on straight lines. */
static void go_straight(const struct filling *f)
{
	struct rb_pose a = f->a, b = f->b;

	give_velocity(f->query, f->joint->a, &a);
	give_velocity(f->query, f->joint->b, &b);
	for (int r = 0; r < rb_linkage_row_count(&f->joint->link); r++)
		f->of->straight[r] = f->link[r].error +
		                     f->query->h_s * rb_linkage_row_velocity(&f->link[r], &a, &b);
}

void rb_step_joint_rows_store(const struct rb_joint_query *query, int k, struct rb_step_joint *of,
                              const struct rb_constraint *row)
{
	struct filling f = begin_poses(query, k, of);
	int part[RB_JOINT_PARTS];
	const int rows = list_parts(f.joint, part);

	RB_ASSERT(query->before && query->share >= 0);
	if (!query->from && !query->at_end) {
		memset(of->impulse, 0, sizeof of->impulse);
		of->reaction = of->twist = none;
		of->work = (struct rb_joint_work){0};
		if (query->lasts_s < query->h_s) {
			(void)rb_linkage_rows(&f.joint->link, &f.a, &f.b, f.link);
			go_straight(&f);
		}
	}
	for (int r = 0; r < rows; r++)
		note_row(&f, k, part[r], &row[r]);
}

bool rb_step_joint_rows_are_smooth(const struct rb_joint_query *query, int k,
                                   const struct rb_step_joint *of)
{
	const struct rb_joint *joint = &query->world->model->joints->joint[k];

	if (!joint->link.type->one_sided && !has_part(joint, RB_JOINT_LOW) &&
	    !has_part(joint, RB_JOINT_HIGH))
		return true;
	const struct filling f = begin(query, k, (struct rb_step_joint *)of);
	const double reach = 2 * query->h_s;

	if (f.joint->link.type->one_sided)
		return of->last.force[0] != 0 ||
		       f.link[0].error + reach * fabs(rb_linkage_row_velocity(&f.link[0], &f.a,
		                                                              &f.b)) <
		               0;
	for (int part = RB_JOINT_LOW; part <= RB_JOINT_HIGH; part++) {
		const double way = part == RB_JOINT_LOW ? f.way - f.joint->low
		                                        : f.joint->high - f.way;

		if (has_part(f.joint, part) && of->last.force[part] == 0 &&
		    !(way > reach * fabs(f.free.rate)))
			return false;
	}
	return true;
}

void rb_step_joint_rows_double(struct rb_step_joint *of)
{
	for (int part = 0; part < RB_JOINT_PARTS; part++)
		of->impulse[part] *= 2;
	of->reaction = rb_vec3_scale(2, of->reaction);
	of->twist = rb_vec3_scale(2, of->twist);
	of->work.linear = rb_vec3_scale(2, of->work.linear);
	of->work.angular = rb_vec3_scale(2, of->work.angular);
}

/* ---- rebounds ---- */

/* m/s: with which a limit or rope is left, of its row; 0: it has not been met. */
static double rebound_of(const struct rb_joint *joint, int part, const struct rb_step_joint *of,
                         const struct rb_constraint *row)
{
	const bool low = part == RB_JOINT_LOW;
	const double lever = row->couple ? row->arm_a.x : 1;
	const double approach = lever * (low ? -of->rate : of->rate);

	return of->impulse[part] != 0 ? fmax(0, joint->restitution * approach) : 0;
}

bool rb_step_joint_rows_rebound(const struct rb_joint_query *query, int k,
                                const struct rb_step_joint *of, struct rb_constraint *row,
                                double tolerance)
{
	const struct rb_joint *joint = &query->world->model->joints->joint[k];
	int part[RB_JOINT_PARTS];
	const int rows = list_parts(joint, part);
	bool any = false;

	const struct rb_pose a = pose_of(query->world, NULL, joint->a);
	const struct rb_pose b = pose_of(query->world, NULL, joint->b);
	const bool round = is_turned_round(query->world->model, joint);
	const rb_vec3 way = rb_vec3_scale(round ? -1 : 1, rb_vec3_sub(b.position, a.position));

	for (int r = 0; r < rows; r++) {
		/* bodies have moved since its arms were made */
		if (!row[r].couple) {
			rb_constraint_join_arms(
				&row[r], rb_vec3_add(way, rb_vec3_sub(row[r].arm_b, row[r].arm_a)));
			rb_effective_mass_fill(query->bodies, &row[r]);
		}
		const rb_vec3 now = rb_constraint_velocity(query->bodies, &row[r]);
		const bool rope = joint->link.type->one_sided && part[r] == 0;
		const bool low = part[r] == RB_JOINT_LOW;

		row[r].target = rb_constraint_split(&row[r], now);
		rb_constraint_clear(&row[r]);
		if (part[r] >= RB_JOINT_SPRING)
			row[r].low = row[r].high = row[r].softness = 0;
		if (!rope && !low && part[r] != RB_JOINT_HIGH)
			continue;
		const double back = rebound_of(joint, part[r], of, &row[r]);
		const double sign = low ? 1 : -1;

		/* what has not been met stays open */
		if (of->impulse[part[r]] == 0)
			row[r].target.n = -sign * (double)INFINITY;
		if (!(back > tolerance))
			continue;
		row[r].target.n = sign * back;
		any = true;
	}
	return any;
}
