/* SPDX-License-Identifier: MIT */
/*
 * Index-1 treatment of joints: accelerations satisfy d2C/dt2 = 0, and the drift of C and dC/dt is
 * removed after each piece by projection in the metric of mass (Lubich, ZAMP 42 (1991) 715), whose
 * energy error is of second order.
 */
#include "located/joint_rows.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "base/forest.h"
#include "located/arc.h"
#include "located/external_force.h"
#include "located/follow.h"
#include "located/mechanics.h"
#include "step/gap.h"

/* Position corrections: each squares the relative error. */
enum { POSITION_ROUNDS = 2 };
/* Rounding of a rate and of a gap, in ulp of the terms that they are differences of. */
enum { DRIVE_ULP = 64, STOP_ULP = 16 };

bool rb_joint_rows_joined(const struct rb_located *l, int a, int b)
{
	const struct rb_joints *joints = l->model->joints;

	for (int e = joints->first[a]; e < joints->first[a + 1]; e++) {
		const struct rb_joint *joint = &joints->joint[joints->of[e]];

		if ((joint->a == b || joint->b == b) && rb_joint_rows_holds(l, joints->of[e]))
			return true;
	}
	return false;
}

static int place_of(const struct rb_located *l, int body)
{
	return body >= 0 && body < l->n ? l->place[body] : -1;
}

bool rb_joint_rows_collect(struct rb_joint_rows *rows)
{
	const struct rb_located *l = rows->l;
	const struct rb_joints *joints = l->model->joints;
	size_t ends = 0;

	rows->joint_count = rows->count = 0;
	rows->sprung = false;
	if (!joints)
		return true;
	for (int p = 0; p < rows->body_count; p++)
		ends += (size_t)(joints->first[rows->body[p] + 1] - joints->first[rows->body[p]]);
	rows->joint = rb_arena_take(l->arena, ends + 1, sizeof *rows->joint);
	if (!rows->joint)
		return false;
	for (int p = 0; p < rows->body_count; p++) {
		const int i = rows->body[p];

		for (int e = joints->first[i]; e < joints->first[i + 1]; e++) {
			const struct rb_joint *joint = &joints->joint[joints->of[e]];
			const int other = place_of(l, joint->a == i ? joint->b : joint->a);

			/* counted at its first end only */
			if ((other >= 0 && other < p) || !rb_joint_rows_holds(l, joints->of[e]))
				continue;
			rows->joint[rows->joint_count++] = joints->of[e];
			rows->sprung = rows->sprung || joint->stiffness > 0 || joint->damping > 0 ||
			               rb_joint_rows_has_drive(l, joints->of[e]);
			rows->count += rb_linkage_row_count(&joint->link);
		}
	}
	rows->count += RB_JOINT_PARTS_HELD * rows->joint_count;
	rows->row = rb_arena_take(l->arena, (size_t)rows->count + 1, sizeof *rows->row);
	return rows->row != NULL;
}

/* Pose of an end: rows->pose at its place, otherwise on its arc. */
static struct rb_pose end_pose(const struct rb_joint_rows *rows, int body, int place, double t)
{
	if (body < 0)
		return rb_linkage_world();
	return place >= 0 ? rows->pose[place] : rb_arc_pose(rows->l, body, t);
}

/* J times the acceleration of an end that is not dynamic, with the sign of b. */
static double own_acceleration(const struct rb_located *l, int body, rb_vec3 linear,
                               rb_vec3 angular, double t)
{
	if (body < 0 || body >= l->n)
		return 0;
	return rb_vec3_dot(linear, rb_arc_acceleration(l, body, t)) +
	       rb_vec3_dot(angular, rb_mechanics_turning(l, body, t));
}

/* Appends a row; `own` gives the fields that do not follow from the geometry. */
static void add_row(struct rb_joint_rows *rows, int joint_index, const struct rb_joint_row *own,
                    const struct rb_linkage_row *found, double t)
{
	const struct rb_located *l = rows->l;
	const struct rb_joint *joint = &l->model->joints->joint[joint_index];
	struct rb_joint_row *row = &rows->row[rows->count++];

	*row = *own;
	row->joint = joint_index;
	row->a = place_of(l, joint->a);
	row->b = place_of(l, joint->b);
	row->wrench = (struct rb_coupled_wrench){found->linear,
	                                         rb_vec3_scale(row->scale, found->angular_a),
	                                         rb_vec3_scale(row->scale, found->angular_b)};
	row->bias = row->scale * found->bias;
	if (row->a < 0)
		row->bias += own_acceleration(l, joint->a, rb_vec3_neg(found->linear),
		                              row->wrench.angular_a, t);
	if (row->b < 0)
		row->bias += own_acceleration(l, joint->b, found->linear, row->wrench.angular_b, t);
}

static void fill_joint(struct rb_joint_rows *rows, int joint_index, double t)
{
	const struct rb_located *l = rows->l;
	const struct rb_joint *joint = &l->model->joints->joint[joint_index];
	const int a = place_of(l, joint->a), b = place_of(l, joint->b);
	const struct rb_pose pose_a = end_pose(rows, joint->a, a, t);
	const struct rb_pose pose_b = end_pose(rows, joint->b, b, t);
	struct rb_linkage_row found[RB_LINKAGE_ROWS_MAX];
	/* a rope's row is a stop */
	const int count = joint->link.type->one_sided
	                          ? 0
	                          : rb_linkage_rows(&joint->link, &pose_a, &pose_b, found);

	for (int k = 0; k < count; k++) {
		const bool couple = rb_linkage_row_is_couple(&joint->link, k);
		const double scale = couple ? joint->size : 1;
		add_row(rows, joint_index,
		        &(struct rb_joint_row){
				.row = k,
				.drive = -1,
				.scale = scale,
				.error = scale * found[k].error,
				.velocity = scale *
		                            rb_linkage_row_velocity(&found[k], &pose_a, &pose_b)},
		        &found[k], t);
	}
}

/* ---- motors and friction ---- */

static signed char *mode_of(const struct rb_joint_rows *rows, int joint, int kind)
{
	return &rows->l->drive_mode[RB_JOINT_PARTS_HELD * joint + kind];
}

void rb_joint_rows_ends(const struct rb_joint_rows *rows, int joint_index, double t,
                        struct rb_pose end[2])
{
	const struct rb_joint *joint = &rows->l->model->joints->joint[joint_index];

	end[0] = end_pose(rows, joint->a, place_of(rows->l, joint->a), t);
	end[1] = end_pose(rows, joint->b, place_of(rows->l, joint->b), t);
}

static struct rb_linkage_free free_of(const struct rb_joint_rows *rows, int joint_index, double t)
{
	struct rb_pose end[2];

	rb_joint_rows_ends(rows, joint_index, t, end);
	return rb_linkage_free(&rows->l->model->joints->joint[joint_index].link, &end[0], &end[1]);
}

double rb_joint_rows_fall(const struct rb_located *l, int joint_index)
{
	return sqrt(2 * l->weight * l->model->joints->joint[joint_index].size);
}

double rb_joint_rows_eased(const struct rb_located *l, int joint_index, int stop)
{
	const struct rb_joint *joint = &l->model->joints->joint[joint_index];

	if (!l->eased[RB_JOINT_PARTS_HELD * joint_index + stop])
		return 0;
	return rb_joint_eased * (rb_linkage_turns(&joint->link) ? 1 : joint->size);
}

struct rb_joint_stop rb_joint_rows_stop(const struct rb_joint_rows *rows, int joint_index, int stop,
                                        double t)
{
	const struct rb_located *l = rows->l;
	const struct rb_joint *joint = &l->model->joints->joint[joint_index];
	const struct rb_pose a = end_pose(rows, joint->a, place_of(l, joint->a), t);
	const struct rb_pose b = end_pose(rows, joint->b, place_of(l, joint->b), t);
	const double sign = stop == RB_STOP_LOW ? 1 : -1;
	const double limit = stop == RB_STOP_LOW ? joint->low : joint->high;
	const double spins = rb_vec3_length(a.spin) + rb_vec3_length(b.spin);
	const double speeds = rb_vec3_length(a.velocity) + rb_vec3_length(b.velocity) +
	                      spins * joint->size;
	const bool turns = rb_linkage_turns(&joint->link);
	struct rb_joint_stop now;

	RB_ASSERT_COSTLY(rb_joint_rows_has_stop(joint, stop));
	if (joint->link.type->one_sided) {
		struct rb_linkage_row row[RB_LINKAGE_ROWS_MAX];

		rb_linkage_rows(&joint->link, &a, &b, row);
		now = (struct rb_joint_stop){.gap = -row[0].error,
		                             .rate = -rb_linkage_row_velocity(&row[0], &a, &b),
		                             .row = row[0]};
	} else {
		const struct rb_linkage_free free = rb_linkage_free(&joint->link, &a, &b);
		const double value = rb_joint_state_angle(&l->world->joint[joint_index],
		                                          &joint->link, t, &free);

		now = (struct rb_joint_stop){
			.gap = sign * (value - limit), .rate = sign * free.rate, .row = free.row};
	}
	now.gap += rb_joint_rows_eased(l, joint_index, stop);
	now.row.linear = rb_vec3_scale(sign, now.row.linear);
	now.row.angular_a = rb_vec3_scale(sign, now.row.angular_a);
	now.row.angular_b = rb_vec3_scale(sign, now.row.angular_b);
	now.row.bias *= sign;
	const double reach = turns ? fmax(fabs(limit), 1)
	                           : joint->size + fmax(rb_vec3_max_abs(a.position),
	                                                rb_vec3_max_abs(b.position));
	now.band = STOP_ULP * DBL_EPSILON * (reach + t * fabs(now.rate));
	const double fall = rb_joint_rows_fall(l, joint_index);

	now.noise = DRIVE_ULP * DBL_EPSILON * (turns ? spins + fall / joint->size : speeds + fall);
	return now;
}

/* Target of a drive at a moment: a speed, or the motion that its motor follows. */
static struct rb_follow_point target_of(const struct rb_located *l, int joint_index, int kind,
                                        double t)
{
	if (kind == RB_DRIVE_MOTOR && rb_follow_has(l, joint_index))
		return rb_follow_at(l, joint_index, t, true);
	return (struct rb_follow_point){
		.rate = rb_joint_rows_drive_now(l, joint_index, kind).speed};
}

double rb_joint_rows_bound(const struct rb_joint_rows *rows, const struct rb_joint_row *row)
{
	if (rb_joint_rows_is_stop(row))
		return (double)INFINITY;
	return rb_joint_rows_drive_now(rows->l, row->joint, row->drive).max / row->scale;
}

bool rb_joint_rows_drive(const struct rb_joint_rows *rows)
{
	for (int k = 0; k < rows->count; k++)
		if (rows->row[k].drive >= 0)
			return true;
	return false;
}

static bool holds_drive(const struct rb_joint_rows *rows, int joint_index, int kind)
{
	return rb_joint_rows_drive_now(rows->l, joint_index, kind).max > 0 &&
	       *mode_of(rows, joint_index, kind) == RB_DRIVE_HELD;
}

/* Rows of drives that hold their speed, or follow. */
static void fill_drives(struct rb_joint_rows *rows, int joint_index, double t)
{
	const struct rb_located *l = rows->l;
	const struct rb_joint *joint = &l->model->joints->joint[joint_index];
	const double scale = rb_linkage_turns(&joint->link) ? joint->size : 1;

	for (int kind = 0; kind < RB_JOINT_DRIVES; kind++) {
		if (!holds_drive(rows, joint_index, kind))
			continue;
		const struct rb_linkage_free free = free_of(rows, joint_index, t);
		const struct rb_follow_point to = target_of(l, joint_index, kind, t);
		struct rb_joint_row row = {.row = -1,
		                           .drive = kind,
		                           .scale = scale,
		                           .velocity = scale * (free.rate - to.rate),
		                           .speed = scale * to.rate};

		if (kind == RB_DRIVE_MOTOR && rb_follow_has(l, joint_index))
			row.error = scale * (rb_joint_state_angle(&l->world->joint[joint_index],
			                                          &joint->link, t, &free) -
			                     to.value);
		add_row(rows, joint_index, &row, &free.row, t);
		rows->row[rows->count - 1].bias -= scale * to.acceleration;
	}
}

/* Rows of stops that hold or, if `touching`, that touch. */
static void fill_stops(struct rb_joint_rows *rows, int joint_index, double t)
{
	const struct rb_located *l = rows->l;
	const struct rb_joint *joint = &l->model->joints->joint[joint_index];
	const double scale = rb_linkage_turns(&joint->link) ? joint->size : 1;

	for (int stop = RB_STOP_LOW; stop < RB_JOINT_PARTS_HELD; stop++) {
		const signed char mode = *mode_of(rows, joint_index, stop);

		if (!rb_joint_rows_has_stop(joint, stop) ||
		    (mode != RB_DRIVE_HELD && !rows->touching))
			continue;
		const struct rb_joint_stop now = rb_joint_rows_stop(rows, joint_index, stop, t);

		if (mode == RB_STOP_OPEN && !(now.gap <= now.band))
			continue;
		add_row(rows, joint_index,
		        &(struct rb_joint_row){.row = -1,
		                               .drive = stop,
		                               .scale = scale,
		                               .error = scale * now.gap,
		                               .velocity = scale * now.rate,
		                               .noise = scale * now.noise,
		                               .restitution = joint->restitution},
		        &now.row, t);
	}
}

bool rb_joint_rows_adds(const struct rb_joint_rows *rows, int joint_index)
{
	const struct rb_joint *joint = &rows->l->model->joints->joint[joint_index];
	bool adds = false;

	for (int kind = 0; kind < RB_JOINT_DRIVES; kind++)
		adds = adds || holds_drive(rows, joint_index, kind);
	for (int stop = RB_STOP_LOW; stop < RB_JOINT_PARTS_HELD; stop++)
		adds = adds || (rb_joint_rows_has_stop(joint, stop) &&
		                *mode_of(rows, joint_index, stop) == RB_DRIVE_HELD);
	return adds;
}

void rb_joint_rows_fill(struct rb_joint_rows *rows, double t)
{
	rows->count = 0;
	for (int k = 0; k < rows->joint_count; k++) {
		fill_joint(rows, rows->joint[k], t);
		if (rows->bare)
			continue;
		if (rb_joint_rows_has_drive(rows->l, rows->joint[k]))
			fill_drives(rows, rows->joint[k], t);
		fill_stops(rows, rows->joint[k], t);
	}
}

bool rb_joint_rows_spring(const struct rb_joint_rows *rows, int k, double t,
                          struct rb_joint_spring_row *spring)
{
	const struct rb_located *l = rows->l;
	const struct rb_joint *joint = &l->model->joints->joint[rows->joint[k]];
	const int a = place_of(l, joint->a), b = place_of(l, joint->b);

	if (!(joint->stiffness > 0) && !(joint->damping > 0) &&
	    !rb_joint_rows_has_drive(l, rows->joint[k]))
		return false;
	const struct rb_pose pose_a = end_pose(rows, joint->a, a, t);
	const struct rb_pose pose_b = end_pose(rows, joint->b, b, t);
	const struct rb_linkage_free free = rb_linkage_free(&joint->link, &pose_a, &pose_b);
	const double value = rb_joint_state_angle(&l->world->joint[rows->joint[k]], &joint->link, t,
	                                          &free);

	spring->row = (struct rb_joint_row){
		.joint = rows->joint[k],
		.drive = -1,
		.a = a,
		.b = b,
		.wrench = {free.row.linear, free.row.angular_a, free.row.angular_b},
		.scale = 1,
		.velocity = free.rate,
		.bias = free.row.bias};
	spring->multiplier = rb_joint_spring(joint, value, free.rate);
	spring->dissipation = joint->damping * free.rate * free.rate;
	spring->friction_power = spring->drives = 0;
	for (int kind = 0; kind < RB_JOINT_DRIVES; kind++) {
		const double force = rb_joint_rows_drive_now(l, rows->joint[k], kind).max *
		                     *mode_of(rows, rows->joint[k], kind);

		if (!(fabs(force) > 0))
			continue;
		spring->multiplier += force;
		if (kind == RB_DRIVE_MOTOR)
			spring->drives += force * free.rate;
		else
			spring->friction_power -= force * free.rate;
	}
	return true;
}

void rb_joint_rows_add_springs(const struct rb_joint_rows *rows, double t, rb_vec3 *linear,
                               rb_vec3 *angular)
{
	const struct rb_coupled system = {.l = rows->l, .pose = rows->pose, .body = rows->body};
	struct rb_joint_spring_row spring;

	for (int k = 0; k < rows->joint_count && rows->sprung; k++) {
		if (!rb_joint_rows_spring(rows, k, t, &spring))
			continue;
		struct rb_coupled_row row = rb_joint_rows_coupled(&spring.row);

		rb_coupled_respond(&system, &row);
		rb_coupled_add(&row, spring.multiplier, linear, angular);
	}
}

double rb_joint_rows_power(const struct rb_joint_rows *rows, const struct rb_joint_row *row,
                           double multiplier, double t)
{
	if (row->drive != RB_DRIVE_MOTOR)
		return 0;
	return multiplier * row->scale * target_of(rows->l, row->joint, row->drive, t).rate;
}

void rb_joint_rows_enter_springs(const struct rb_joint_rows *rows, const double *multiplier,
                                 double t, struct rb_entries *rate)
{
	struct rb_joint_spring_row spring;

	if (!rows->sprung)
		return;
	for (int k = 0; k < rows->count; k++)
		rb_entries_energy(rate, RB_ENERGY_DRIVEN,
		                  rb_joint_rows_power(rows, &rows->row[k], multiplier[k], t));

	for (int k = 0; k < rows->joint_count; k++) {
		if (!rb_joint_rows_spring(rows, k, t, &spring))
			continue;
		rb_entries_energy(rate, RB_ENERGY_DAMPING, spring.dissipation);
		rb_entries_energy(rate, RB_ENERGY_JOINT_FRICTION, spring.friction_power);
		rb_entries_energy(rate, RB_ENERGY_DRIVEN, spring.drives);
		rb_joint_rows_enter(rows, &spring.row, spring.multiplier, t, rate);
	}
}

struct rb_coupled_row rb_joint_rows_coupled(const struct rb_joint_row *row)
{
	return rb_coupled_row(row->a, row->b, &row->wrench, &row->wrench);
}

/* ---- solutions for joints alone ---- */

/* Assembles the dense system of all rows at the present poses; false: out of memory. */
static bool assemble(const struct rb_joint_rows *rows, struct rb_coupled *system,
                     struct rb_dense *dense)
{
	*system = (struct rb_coupled){.l = rows->l,
	                              .pose = rows->pose,
	                              .body = rows->body,
	                              .body_count = rows->body_count,
	                              .is_symmetric = true};
	*dense = (struct rb_dense){.n = rows->count};
	if (!rb_coupled_reserve(system, rows->count) ||
	    !rb_coupled_reserve_right(rows->l->arena, dense, rows->count))
		return false;
	rb_coupled_turn(system);
	for (int k = 0; k < rows->count; k++) {
		system->row[k] = rb_joint_rows_coupled(&rows->row[k]);
		rb_coupled_respond(system, &system->row[k]);
	}
	system->count = rows->count;
	rb_coupled_sort(system);
	return rb_coupled_fill(system, dense, 0);
}

static bool fail_memory(const struct rb_joint_rows *rows)
{
	struct rb_located *l = rows->l;

	if (l->status == RB_OK)
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for the joints of %d bodies",
		                    rows->body_count);
	return false;
}

bool rb_joint_hold_take(struct rb_joint_hold *hold, struct rb_located *l,
                        const struct rb_pose *pose, double t, bool bare)
{
	hold->rows = (struct rb_joint_rows){
		.l = l, .body = l->set, .pose = pose, .body_count = l->set_count, .bare = bare};
	if (!l->model->joints)
		return true;
	if (!rb_joint_rows_collect(&hold->rows))
		return false;
	if (hold->rows.count == 0)
		return true;
	rb_joint_rows_fill(&hold->rows, t);
	if (!assemble(&hold->rows, &hold->system, &hold->dense))
		return false;
	for (int k = 0; k < hold->rows.count; k++)
		hold->dense.right[k] = 0;
	rb_coupled_solve(&hold->system, &hold->dense);
	return true;
}

void rb_joint_hold_apply(struct rb_joint_hold *hold, rb_vec3 *linear, rb_vec3 *angular)
{
	if (hold->rows.count == 0)
		return;
	for (int k = 0; k < hold->rows.count; k++)
		hold->dense.right[k] = -rb_coupled_rate(&hold->system.row[k], linear, angular);
	rb_coupled_again(&hold->system, &hold->dense);
	for (int k = 0; k < hold->rows.count; k++)
		rb_coupled_add(&hold->system.row[k], hold->dense.right[k], linear, angular);
}

bool rb_joint_rows_accelerate(const struct rb_joint_rows *rows, rb_vec3 *linear, rb_vec3 *angular)
{
	const rb_arena_mark here = rb_arena_here(rows->l->arena);
	struct rb_coupled system;
	struct rb_dense dense;

	if (!assemble(rows, &system, &dense))
		return fail_memory(rows);
	for (int k = 0; k < rows->count; k++)
		dense.right[k] = -(rb_coupled_rate(&system.row[k], linear, angular) +
		                   rows->row[k].bias);
	rb_coupled_solve(&system, &dense);
	for (int k = 0; k < rows->count; k++)
		rb_coupled_add(&system.row[k], dense.right[k], linear, angular);
	rb_arena_back(rows->l->arena, here);
	return true;
}

/* Displaces poses by the motion, by place. */
static void move(const struct rb_joint_rows *rows, struct rb_pose *pose, const rb_vec3 *linear,
                 const rb_vec3 *angular)
{
	const struct rb_located *l = rows->l;

	for (int p = 0; p < rows->body_count; p++)
		rb_arc_displace(l, rows->body[p], &pose[p], linear[p], angular[p]);
}

void rb_joint_rows_wrenches(const struct rb_joint_rows *rows, const double *multiplier, double t,
                            struct rb_wrench *wrench)
{
	const struct rb_located *l = rows->l;

	for (int k = 0; k < rows->joint_count; k++)
		wrench[rows->joint[k]] = (struct rb_wrench){{0, 0, 0}, {0, 0, 0}};
	for (int k = 0; k < rows->count; k++) {
		const struct rb_joint_row *row = &rows->row[k];
		const struct rb_joint *joint = &l->model->joints->joint[row->joint];
		const struct rb_pose b = end_pose(rows, joint->b, row->b, t);
		const rb_vec3 arm = rb_vec3_sub(rb_linkage_point_b(&joint->link, &b), b.position);
		const rb_vec3 force = rb_vec3_scale(multiplier[k], row->wrench.linear);
		const rb_vec3 torque = rb_vec3_scale(multiplier[k], row->wrench.angular_b);
		struct rb_wrench *const on = &wrench[row->joint];

		on->force = rb_vec3_add(on->force, force);
		on->torque = rb_vec3_add(on->torque,
		                         rb_vec3_sub(torque, rb_vec3_cross(arm, force)));
	}
	for (int k = 0; k < rows->joint_count; k++) {
		const struct rb_joint *joint = &l->model->joints->joint[rows->joint[k]];
		struct rb_joint_spring_row spring;
		struct rb_wrench *const on = &wrench[rows->joint[k]];

		if (!rb_joint_rows_spring(rows, k, t, &spring))
			continue;
		const struct rb_pose b = end_pose(rows, joint->b, spring.row.b, t);
		const rb_vec3 arm = rb_vec3_sub(rb_linkage_point_b(&joint->link, &b), b.position);
		const rb_vec3 force = rb_vec3_scale(spring.multiplier, spring.row.wrench.linear);
		const rb_vec3 torque = rb_vec3_scale(spring.multiplier,
		                                     spring.row.wrench.angular_b);

		on->force = rb_vec3_add(on->force, force);
		on->torque = rb_vec3_add(on->torque,
		                         rb_vec3_sub(torque, rb_vec3_cross(arm, force)));
	}
}

void rb_joint_rows_enter(const struct rb_joint_rows *rows, const struct rb_joint_row *row,
                         double multiplier, double t, struct rb_entries *e)
{
	const struct rb_located *l = rows->l;
	const struct rb_joint *joint = &l->model->joints->joint[row->joint];
	const bool on_b = row->a < 0;
	const int fixed = on_b ? joint->a : joint->b;
	const bool driven = fixed >= 0 && rb_located_driven(l, fixed);

	if (row->a >= 0 && row->b >= 0)
		return;
	/* on the dynamic end, about the origin */
	const int place = on_b ? row->b : row->a;
	const rb_vec3 force = rb_vec3_scale(on_b ? multiplier : -multiplier, row->wrench.linear);
	const rb_vec3 torque = rb_vec3_scale(multiplier,
	                                     on_b ? row->wrench.angular_b : row->wrench.angular_a);

	rb_entries_momentum(e, driven ? RB_MOMENTUM_DRIVEN : RB_MOMENTUM_STATIC, force,
	                    rb_vec3_add(torque, rb_vec3_cross(rows->pose[place].position, force)));
	if (!driven)
		return;
	/* the energy that it takes from the driven end */
	const struct rb_pose pose = end_pose(rows, fixed, -1, t);
	const rb_vec3 other = on_b ? row->wrench.angular_a : row->wrench.angular_b;

	rb_entries_energy(e, RB_ENERGY_DRIVEN,
	                  rb_vec3_dot(force, pose.velocity) -
	                          multiplier * rb_vec3_dot(other, pose.spin));
}

/* Adds impulses at joints to the ledger: they take the energy of the motion against the joints. */
static void enter(const struct rb_joint_rows *rows, const double *impulse, double t)
{
	struct rb_entries e = {0};

	if (!rows->l->account_s)
		return;
	for (int k = 0; k < rows->count; k++) {
		/* by the mean of J V before and after, the latter being zero */
		rb_entries_energy(&e, RB_ENERGY_IMPACTS, -0.5 * impulse[k] * rows->row[k].velocity);
		rb_entries_energy(&e, RB_ENERGY_DRIVEN,
		                  rb_joint_rows_power(rows, &rows->row[k], impulse[k], t));
		rb_joint_rows_enter(rows, &rows->row[k], impulse[k], t, &e);
	}
	rb_ledger_enter(&rows->l->world->ledger, &e);
}

/* Input of a projection. */
struct projection {
	struct rb_joint_rows *rows;
	double t;
	struct rb_pose *pose;
	rb_vec3 *linear, *angular; /* scratch, by place */
	bool enters;               /* adds the impulses to the ledger */
	bool near;                 /* errors are within the allowed drift, and there is no loop */
};

/* One round, whose motion is in the arrays. `known`: reuses the system of nearby poses. */
static bool correct_once(const struct projection *p, bool places, bool known,
                         struct rb_coupled *system, struct rb_dense *dense)
{
	struct rb_joint_rows *const rows = p->rows;

	if (!known && !assemble(rows, system, dense))
		return fail_memory(rows);
	memset(p->linear, 0, (size_t)rows->body_count * sizeof *p->linear);
	memset(p->angular, 0, (size_t)rows->body_count * sizeof *p->angular);
	for (int k = 0; k < rows->count; k++)
		dense->right[k] = places ? -rows->row[k].error : -rows->row[k].velocity;
	if (known)
		rb_coupled_again(system, dense);
	else
		rb_coupled_solve(system, dense);
	for (int k = 0; k < rows->count; k++)
		rb_coupled_add(&system->row[k], dense->right[k], p->linear, p->angular);
	if (!places && p->enters)
		enter(rows, dense->right, p->t);
	return true;
}

/*
 * Projects positions, then velocities; rows are filled. If joints have drifted by less than the
 * allowed share of their size, one round and one system suffice: the remaining error is the square
 * of that share, unless rows depend on each other.
 */
static void project(const struct projection *p)
{
	struct rb_coupled system;
	struct rb_dense dense;
	bool good = true;

	for (int round = 0; round < (p->near ? 1 : POSITION_ROUNDS) && good; round++) {
		good = correct_once(p, true, false, &system, &dense);
		if (good)
			move(p->rows, p->pose, p->linear, p->angular);
		rb_joint_rows_fill(p->rows, p->t);
	}
	good = good && correct_once(p, false, p->near, &system, &dense);
	for (int k = 0; k < p->rows->body_count && good; k++) {
		p->pose[k].velocity = rb_vec3_add(p->pose[k].velocity, p->linear[k]);
		p->pose[k].spin = rb_vec3_add(p->pose[k].spin, p->angular[k]);
	}
}

bool rb_joint_rows_project(struct rb_joint_rows *rows, double t, struct rb_pose *pose)
{
	const rb_arena_mark here = rb_arena_here(rows->l->arena);
	const size_t bodies = (size_t)rows->body_count;
	rb_vec3 *const motion = rb_arena_take(rows->l->arena, 2 * bodies, sizeof *motion);

	RB_ASSERT(rows->pose == pose);
	if (!motion)
		return fail_memory(rows);
	rb_joint_rows_fill(rows, t);
	project(&(struct projection){
		.rows = rows, .t = t, .pose = pose, .linear = motion, .angular = motion + bodies});
	rb_arena_back(rows->l->arena, here);
	return rows->l->status == RB_OK;
}

bool rb_joint_rows_is_closed(const struct rb_joint_rows *rows)
{
	const rb_arena_mark here = rb_arena_here(rows->l->arena);
	const int world = rows->body_count; /* all non-dynamic bodies are one */
	int *const parent = rb_arena_take(rows->l->arena, (size_t)world + 1, sizeof *parent);
	bool closed = false;

	for (int p = 0; p <= world && parent; p++)
		parent[p] = p;
	for (int k = 0; k < rows->joint_count && parent && !closed; k++) {
		const struct rb_joint *joint = &rows->l->model->joints->joint[rows->joint[k]];
		const int a = place_of(rows->l, joint->a), b = place_of(rows->l, joint->b);

		if (joint->link.type->one_sided)
			continue;
		const int x = rb_forest_root(parent, a < 0 ? world : a);
		const int y = rb_forest_root(parent, b < 0 ? world : b);
		closed = x == y;
		parent[x] = y;
	}
	rb_arena_back(rows->l->arena, here);
	return closed;
}

/* Touching range at the members' coordinates, m: the rounding of positions. */
static double rounding_of(const struct rb_joint_rows *rows)
{
	double largest = 0;

	for (int k = 0; k < rows->body_count; k++)
		largest = fmax(largest, rb_vec3_max_abs(rows->pose[k].position));
	return RB_TOUCHING_ULP * DBL_EPSILON * largest;
}

/* Sets l->status to the first joint that has drifted too far. */
static bool has_drifted(const struct rb_joint_rows *rows, double t)
{
	struct rb_located *l = rows->l;
	const double rounding = rounding_of(rows);
	char label[96], source[96];

	for (int k = 0; k < rows->count; k++) {
		const struct rb_joint_row *row = &rows->row[k];
		const struct rb_joint *joint = &l->model->joints->joint[row->joint];

		const double eased = rb_joint_rows_is_stop(row)
		                             ? row->scale * rb_joint_rows_eased(l, row->joint,
		                                                                row->drive)
		                             : 0;

		if (fabs(row->error - eased) <= rb_joint_drift_max * joint->size + rounding)
			continue;
		l->status = RB_FAIL(l->err, RB_ERR_PHYSICS,
		                    "%s%s is open by %.3g m at t = %.17g s (at most 1e-9 of its "
		                    "size, %.3g m)",
		                    rb_joint_source(l->model->scene, joint->def, source),
		                    rb_joint_label(l->model->scene, joint->def, label),
		                    fabs(row->error - eased), t, joint->size);
		return true;
	}
	return false;
}

void rb_joint_rows_correct(struct rb_joint_rows *rows, double t, struct rb_pose *pose, bool moved)
{
	struct rb_located *l = rows->l;
	const rb_arena_mark here = rb_arena_here(l->arena);
	const size_t bodies = (size_t)rows->body_count;

	RB_ASSERT(rows->pose == pose);
	if (rows->count == 0 || l->status != RB_OK) /* for instance of a motor's function */
		return;
	rb_vec3 *const linear = rb_arena_take(l->arena, 2 * bodies, sizeof *linear);

	if (!linear) {
		fail_memory(rows);
		return;
	}
	rb_joint_rows_fill(rows, t);
	if (moved || !has_drifted(rows, t))
		project(&(struct projection){.rows = rows,
		                             .t = t,
		                             .pose = pose,
		                             .linear = linear,
		                             .angular = linear + bodies,
		                             .enters = true,
		                             .near = !moved && !rb_joint_rows_is_closed(rows)});
	rb_joint_rows_fill(rows, t);
	for (int k = 0; k < rows->joint_count; k++) {
		const int joint_index = rows->joint[k];
		const struct rb_linkage *link = &l->model->joints->joint[joint_index].link;

		if (!rb_linkage_has_free(link))
			continue;
		const struct rb_linkage_free free = free_of(rows, joint_index, t);

		rb_joint_state_see(&l->world->joint[joint_index], link, t, &free);
	}
	rb_arena_back(l->arena, here);
}
