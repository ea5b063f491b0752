/* SPDX-License-Identifier: MIT */
#include "stepped/joint_constraints.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "constraint/effective_mass.h"
#include "world/joint_state.h"

RB_FIELDS_DEFINE(rb_joint_memory_fields, struct rb_joint_memory, RB_JOINT_MEMORY_FIELDS);

static const rb_vec3 none = {0, 0, 0};

/* Whether the joint has that part, for parts after the rows of its linkage. */
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

/* Lists the part of each row, for a FREE one the first of three; returns their number. */
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

static bool is_swapped(const struct rb_model *model, const struct rb_joint *joint)
{
	return rb_step_joint_rows_owner(model, joint) != joint->a;
}

/* Pose in the state; velocities are those before the step. */
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
	double value; /* free coordinate, turns counted */
};

/* N s, N m s: warm-start impulse of a part. */
static double warm_impulse(const struct filling *f, int part)
{
	return f->query->at_end ? f->of->impulse[part]
	                        : f->query->lasts_s * f->of->last.force[part];
}

/* Three rows of a point: midway between both, so that no torque remains. */
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
			&row,
			(rb_vec3){warm_impulse(f, 0), warm_impulse(f, 1), warm_impulse(f, 2)});
	return row;
}

/*
 * One row of a linkage with a target rate: arms across the normal, or a couple; `*scale`: row
 * velocity, m/s, per unit of the rate.
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
		/* of errors: rotations about axes that are not unit vectors away from zero */
		*scale = f->joint->size / rb_vec3_length(link->angular_b);
	}
	row.target.n = *scale * rate;
	return row;
}

/* N s: impulse of a row for an impulse along or about its unit axis. */
static double impulse_of(const struct rb_constraint *row, double given)
{
	return given / (row->couple ? row->arm_a.x : 1);
}

/* In a second half: unilateral rows are active if they were in the first. */
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
 * Makes a row soft: a spring with its stretch and rate at the end of `ahead`, s, which is also the
 * time that it acts.
 */
static void soften(const struct filling *f, struct rb_constraint *row, double ahead)
{
	const double k = f->joint->stiffness, c = f->joint->damping;
	const double softness = 1 / (ahead * (ahead * k + c));
	const double scale = row->couple ? row->arm_a.x / rb_vec3_length(f->free.row.angular_b) : 1;

	/* an impulse p of the row is a torque impulse scale p, its velocity scale times the rate */
	row->softness = scale * scale * softness;
	row->target.n = -scale * softness * ahead * k * (f->value - f->joint->rest);
}

static rb_vec3 turn_by(const struct filling *f, int i, rb_vec3 torque)
{
	return is_dynamic(f->query->world->model, i) ? rb_solver_turn(f->query->bodies, i, torque)
	                                             : none;
}

/*
 * Fraction of the free coordinate's inverse effective mass that the joint's other rows leave, with
 * its bodies free: a slider does not rotate, a hinge rotates about its axis. A bound of it in a
 * mechanism.
 */
static double share_left_by_linkage(const struct filling *f)
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
 * Sets up a spring's row: tension at the end of the step, or at its middle if impulses are in
 * halves and the step resolves it; a second half repeats that.
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
	/* written so that NaN counts as late */
	f->of->spring_is_late = !(
		query->lasts_s < query->h_s &&
		(row->inverse_mass_n <= row->softness ||
	         row->inverse_mass_n * share_left_by_linkage(f) <= row->softness));
	if (!f->of->spring_is_late)
		soften(f, row, query->lasts_s);
}

/* ---- following motors ---- */

/*
 * Fraction of the motor's available braking that is used besides the load (located/follow.h).
 * Fraction of its bound by which its force must have changed for its response to be measured.
 */
static const double brake_share = 0.5, change_share = 0.1;
/* Relative distance from its bound within which a force is at it. */
static const double at_bound = 1e-9;

/* Whether it has a motor that follows a target, in a step that bodies move in. */
static bool follows(const struct filling *f)
{
	return f->query->before && !isnan(f->of->wanted) &&
	       isnan(f->query->world->joint[f->joint->def].motor_speed);
}

/*
 * Measures the motor's response in the step before: change of the free coordinate's acceleration
 * per change of force. `answer_max`: response if its bodies were free, which is larger.
 */
static void measure_response(const struct filling *f, double answer_max)
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

	/* written so that NAN changes nothing; a motor that moves nothing is not probed again */
	if (fabs(change) >= change_share * max && answer > 0 && answer <= answer_max)
		last->answer = answer;
	else if (fabs(change) >= change_share * max && !(last->answer > 0) && !isnan(answer))
		last->answer = -1;
	last->acceleration = acceleration;
	last->motor = force;
}

/*
 * Deceleration with which it begins to brake its approach in `direction` (1 or -1), relative to the
 * target, which itself has the acceleration `bends`; 0: at once, it cannot brake; INFINITY: not
 * known.
 */
static double braking_of(const struct filling *f, double direction, double bends)
{
	const struct rb_joint_memory *const last = &f->of->last;
	const double max = f->query->world->joint[f->joint->def].motor_max;
	const double force = last->force[RB_JOINT_MOTOR];
	/* the target moves away from it, or towards it */
	const double load = last->acceleration - last->answer * force - bends;

	return last->answer > 0 ? fmax(0, brake_share * (last->answer * max - direction * load))
	                        : (double)INFINITY;
}

/* Target rate of a following motor. */
static double follow_rate(const struct filling *f)
{
	struct rb_step_joint *const of = f->of;
	const double h = f->query->h_s, off = of->wanted_before - f->value,
		     direction = off < 0 ? -1 : 1;
	const double mean = (of->wanted - of->wanted_before) / h;
	const double closes = direction * (f->free.rate - mean), d = fabs(off);
	const double brake_max = braking_of(f, direction, 2 * (of->wanted_rate - mean) / h);
	const double brakable = sqrt(2 * brake_max * d); /* speed that could just be braked */
	double a = of->last.brakes * direction;

	of->end_rate = (double)NAN;
	if (!(a > 0) || closes < 0.5 * sqrt(2 * a * d))
		a = closes > 0.5 * brakable && closes >= brakable - brake_max * h
		            ? closes * closes / (2 * d)
		            : 0;
	of->last.brakes = direction * a;
	if (!(a > 0))
		a = brake_max > 0 ? brake_max : (double)INFINITY;
	/* written so that NAN counts as reached within the step */
	if (!(d > 0.5 * fmax(a, brake_max) * h * h)) {
		of->last.brakes = 0;
		return (of->wanted - f->value) / h;
	}
	of->end_rate = mean + direction * (sqrt(2 * a * d) - a * h);
	return mean + direction * (sqrt(2 * a * d) - 0.5 * a * h);
}

/*
 * Whether the motor has been at its bound ever since it began: for one step it gives half of it, to
 * measure its response.
 */
static bool must_probe(const struct filling *f)
{
	const struct rb_joint_memory *const last = &f->of->last;
	const double max = f->query->world->joint[f->joint->def].motor_max;

	return last->answer == 0 && fabs(last->force[RB_JOINT_MOTOR]) >= max * (1 - at_bound);
}

/* In a second half: whether motor and friction acted entirely in the first one. */
static bool is_given(const struct filling *f)
{
	return f->query->at_end && f->of->spring_is_late;
}

/* Sets up a motor's row, once its effective mass is known; `scale`: row velocity per rate. */
static void make_motor(const struct filling *f, struct rb_constraint *row)
{
	const double lever = row->couple ? row->arm_a.x : 1;
	const double scale = row->couple ? lever / rb_vec3_length(f->free.row.angular_b) : 1;
	const double given = impulse_of(row, f->of->impulse[RB_JOINT_MOTOR]);

	if (!follows(f) || is_given(f))
		return;
	if (!f->query->at_end) {
		measure_response(f, row->inverse_mass_n / (scale * lever));
		row->target.n = scale * follow_rate(f);
		if (must_probe(f))
			row->high *= 0.5;
		row->low = -row->high;
		f->of->motor_bound = row->high;
		return;
	}
	row->target.n = scale * (isnan(f->of->end_rate) ? f->of->wanted_rate : f->of->end_rate);
	/* at its bound in both halves: its target cannot be reached */
	if (fabs(given) >= f->of->motor_bound * (1 - at_bound))
		row->low = row->high = given;
}

/*
 * m/s, rad/s: rate at which a limit is reached by the end; `ahead`: distance to it. Excess rotation
 * beyond it left by earlier steps is corrected within a whole step: in a short part that would be
 * violent.
 */
static double limit_rate(const struct rb_joint_query *query, double ahead, bool is_beyond)
{
	return ahead / (query->before && is_beyond ? fmax(query->h_s, query->whole_s) : query->h_s);
}

static struct rb_constraint free_row(const struct filling *f, int part)
{
	const double speed = f->query->world->joint[f->joint->def].motor_speed;
	const double low = f->joint->low - f->value, high = f->joint->high - f->value;
	double rate = 0;

	if (part == RB_JOINT_LOW && !f->query->at_end)
		rate = limit_rate(f->query, low, low > 0);
	else if (part == RB_JOINT_HIGH && !f->query->at_end)
		rate = limit_rate(f->query, high, high < 0);
	else if (part == RB_JOINT_MOTOR && !isnan(speed))
		rate = speed; /* a following motor's is set once its effective mass is known */
	double scale, max = 0;
	struct rb_constraint row = line_row(f, &f->free.row, rate, &scale);

	if (part == RB_JOINT_LOW || part == RB_JOINT_HIGH) {
		row.low = part == RB_JOINT_LOW ? 0 : -(double)INFINITY;
		row.high = part == RB_JOINT_LOW ? (double)INFINITY : 0;
		keep_open(f, &row, part);
		return row;
	}
	if (!f->query->before)
		return row; /* position projection: bounds 0 and 0 */
	if (part == RB_JOINT_SPRING)
		return row; /* set up once its effective mass is known */
	max = part == RB_JOINT_MOTOR ? f->query->world->joint[f->joint->def].motor_max
	                             : f->joint->friction;
	if (is_given(f)) /* bounds 0 and 0 */
		return row;
	row.high = impulse_of(&row,
	                      (f->of->spring_is_late ? f->query->h_s : f->query->lasts_s) * max);
	row.low = -row.high;
	return row;
}

/* Swaps the ends of a row: a body that is not dynamic is the second. */
static void swap_ends(struct rb_constraint *row)
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
	const bool swapped = is_swapped(model, f->joint);
	const int a = swapped ? f->joint->b : f->joint->a, b = swapped ? f->joint->a : f->joint->b;

	if (swapped)
		swap_ends(row);
	row->a = a;
	row->b = b >= 0 && b < model->body_count ? b : f->query->fixed;
	RB_ASSERT_COSTLY(is_dynamic(model, a));
}

/* Sets the poses only. */
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
		f.value = rb_linkage_turns(&joint->link)
		                  ? rb_linkage_angle_near(f.free.value, of->last.way)
		                  : f.free.value;
	}
	return f;
}

/*
 * Errors left by earlier steps are corrected within a whole step, too: in a short part that would
 * throw bodies. For a slack rope there is no error.
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
				row[r].impulse.n = impulse_of(&row[r], warm_impulse(&f, part[r]));
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

/* ---- results ---- */

/* Mean of the velocities before and after; bodies that are not dynamic have only one. */
static struct rb_solver_body mean_of(const struct rb_joint_query *query, int i)
{
	struct rb_solver_body body = query->bodies->body[i], before = body;
	const double half = 0.5 * query->share;

	if (body.inverse_mass == 0)
		return body;
	if (query->from) {
		before = query->from[i];
	} else {
		before.linear = rb_world_row3(query->before->velocity, i);
		before.angular = query->before->spin ? rb_world_row3(query->before->spin, i) : none;
	}
	body.linear = rb_vec3_add_scaled(before.linear, half,
	                                 rb_vec3_sub(body.linear, before.linear));
	body.angular = rb_vec3_add_scaled(before.angular, half,
	                                  rb_vec3_sub(body.angular, before.angular));
	return body;
}

/* Adds impulses on a dynamic body by one that is not; `at`: the second body's centre of mass. */
static void add_fixed(struct rb_joint_work *work, const struct rb_constraint *row, rb_vec3 at,
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

static void add_work(struct rb_joint_work *work, bool one_sided, int part, double done)
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
 * `done`: work at the mean of the velocities before and after. Velocities that violated the joint
 * as the step began are removed, whatever the step: in halves, and where they were set.
 */
static void add_held(const struct filling *f, int k, const struct rb_constraint *row, double done)
{
	const bool was_set = f->query->world->joint[k].was_set && !f->query->at_end;
	const bool first = f->query->lasts_s < f->query->h_s && !f->query->at_end;
	const rb_vec3 p = rb_constraint_impulse(row);
	const double at_end = 0.5 * rb_vec3_dot(p, rb_constraint_velocity(f->query->bodies, row));
	const bool rope = f->joint->link.type->one_sided;

	/* a rope becoming taut is an impact, whose work no shorter step reduces */
	if (!rope || f->of->last.force[0] != 0)
		f->of->work.held += first || was_set ? at_end : done;
	f->of->work.pushed += rb_vec3_length(p);
	/* for ropes all of it is counted already */
	if (was_set && !rope)
		f->of->work.impacts -= done - at_end;
}

/* Adds a row's impulse to the sums of the joint. */
static void add_row(const struct filling *f, int k, int part, const struct rb_constraint *whole)
{
	struct rb_constraint given = *whole;
	const struct rb_constraint *const row = &given;

	given.impulse.n *= f->query->share;
	given.impulse.t = rb_vec3_scale(f->query->share, given.impulse.t);

	const struct rb_model *model = f->query->world->model;
	struct rb_step_joint *const of = f->of;
	const double sign = is_swapped(model, f->joint) ? -1 : 1;
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

	add_work(&of->work, f->joint->link.type->one_sided, part, done);
	if (part < RB_JOINT_LOW)
		add_held(f, k, &given, done);
	if (two[1].inverse_mass == 0)
		add_fixed(&of->work, row, sign < 0 ? f->a.position : f->b.position, &two[1]);
}

/* Sets the velocity of the solution. */
static void set_velocity(const struct rb_joint_query *query, int i, struct rb_pose *pose)
{
	if (i < 0 || i >= query->world->model->body_count)
		return;
	pose->velocity = query->bodies->body[i].linear;
	pose->spin = query->bodies->body[i].angular;
}

/* Errors of the linkage at the end if they grew at constant rates. */
static void go_straight(const struct filling *f)
{
	struct rb_pose a = f->a, b = f->b;

	set_velocity(f->query, f->joint->a, &a);
	set_velocity(f->query, f->joint->b, &b);
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
		add_row(&f, k, part[r], &row[r]);
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
		const double distance = part == RB_JOINT_LOW ? f.value - f.joint->low
		                                             : f.joint->high - f.value;

		if (has_part(f.joint, part) && of->last.force[part] == 0 &&
		    !(distance > reach * fabs(f.free.rate)))
			return false;
	}
	return true;
}

void rb_step_joint_rows_repeat_half(struct rb_step_joint *of)
{
	for (int part = 0; part < RB_JOINT_PARTS; part++)
		of->impulse[part] *= 2;
	of->reaction = rb_vec3_scale(2, of->reaction);
	of->twist = rb_vec3_scale(2, of->twist);
	of->work.linear = rb_vec3_scale(2, of->work.linear);
	of->work.angular = rb_vec3_scale(2, of->work.angular);
}

/* ---- rebounds ---- */

/* m/s: rebound velocity of a limit's or rope's row; 0: no impact. */
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
	const bool swapped = is_swapped(query->world->model, joint);
	const rb_vec3 between = rb_vec3_scale(swapped ? -1 : 1,
	                                      rb_vec3_sub(b.position, a.position));

	for (int r = 0; r < rows; r++) {
		/* bodies have moved since its arms were made */
		if (!row[r].couple) {
			rb_constraint_join_arms(
				&row[r],
				rb_vec3_add(between, rb_vec3_sub(row[r].arm_b, row[r].arm_a)));
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

		/* without an impulse it stays inactive */
		if (of->impulse[part[r]] == 0)
			row[r].target.n = -sign * (double)INFINITY;
		if (!(back > tolerance))
			continue;
		row[r].target.n = sign * back;
		any = true;
	}
	return any;
}
