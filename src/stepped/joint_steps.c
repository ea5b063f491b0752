/* SPDX-License-Identifier: MIT */
#include "stepped/joint_steps.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "stepped/energy.h"
#include "world/joint_state.h"

/* Drift, as a share of the tolerance, up to which a step is not relinearized. */
static const double inspect_share = 1.0 / 16;
/* Reduction of the drift that the last relinearization must have reached for another one. */
static const double gain_share = 0.5;
/*
 * Work by constraint forces of a group's joints that is allowed, as a share of its kinetic energy;
 * and the shortest part of a whole step that is cut for more: the work of a jump does not become
 * less.
 */
static const double held_share = 1.0 / 256, shortest_share = 0x1p-12;

int rb_joints_next_of(const struct rb_world *world, int body, int *at)
{
	const struct rb_model *model = world->model;
	const struct rb_joints *joints = model->joints;

	if (!joints)
		return -1;
	for (*at = *at < 0 ? joints->first[body] : *at + 1; *at < joints->first[body + 1]; ++*at)
		if (!world->joint[joints->of[*at]].released &&
		    rb_step_joint_rows_owner(model, &joints->joint[joints->of[*at]]) == body)
			return joints->of[*at];
	return -1;
}

/* Iterator over the joints of a cohort. */
struct cursor {
	int body, at;
};

static const struct cursor cursor_start = {0, -1};

static int next(const struct rb_world *world, const struct rb_cohort *cohort, struct cursor *c)
{
	if (!world->model->joints)
		return -1;
	for (; c->body < cohort->member_count; c->body++, c->at = -1) {
		const int k = rb_joints_next_of(world, cohort->body[c->body], &c->at);

		if (k >= 0)
			return k;
	}
	return -1;
}

struct rb_pose rb_joints_pose(const struct rb_world *world, int i)
{
	return i < 0 ? rb_linkage_world() : rb_world_pose(world, &world->state, i);
}

/* Free coordinate at the present poses; whole turns are those nearest to `guess`. */
static double coordinate_of(const struct rb_world *world, const struct rb_joint *joint,
                            double guess)
{
	const struct rb_pose a = rb_joints_pose(world, joint->a);
	const struct rb_pose b = rb_joints_pose(world, joint->b);

	if (!rb_linkage_has_free(&joint->link))
		return 0;
	const double value = rb_linkage_free(&joint->link, &a, &b).value;

	return rb_linkage_turns(&joint->link) ? rb_linkage_angle_near(value, guess) : value;
}

void rb_joints_start(struct rb_world *world)
{
	const struct rb_joints *joints = world->model->joints;

	for (int k = 0; joints && k < joints->count; k++) {
		struct rb_step_joint *of = &world->stepped->solver.joint[k];

		of->last = of->kept = (struct rb_joint_memory){
			.way = coordinate_of(world, &joints->joint[k], of->kept.way)};
	}
}

void rb_joints_begin(struct rb_world *world)
{
	const struct rb_joints *joints = world->model->joints;

	for (int k = 0; joints && k < joints->count; k++) {
		struct rb_step_joint *of = &world->stepped->solver.joint[k];

		if (world->joint[k].released) {
			of->kept = (struct rb_joint_memory){.way = of->kept.way};
			of->first_row = -1;
		}
		of->before = of->last = of->kept;
		memcpy(of->noted_before, world->joint[k].noted, sizeof of->noted_before);
		of->sum[0] = of->sum[1] = (rb_vec3){0, 0, 0};
		of->elapsed_s = 0;
	}
}

void rb_joints_go_back(struct rb_world *world, const struct rb_cohort *cohort)
{
	struct cursor c = cursor_start;

	for (int k; (k = next(world, cohort, &c)) >= 0;) {
		struct rb_step_joint *of = &world->stepped->solver.joint[k];

		of->last = of->kept = of->before;
		memcpy(world->joint[k].noted, of->noted_before, sizeof of->noted_before);
		of->sum[0] = of->sum[1] = (rb_vec3){0, 0, 0};
		of->elapsed_s = 0;
	}
}

/* Target of a motor at `time`, and its rate; a rate that is not stated is differenced. */
static enum rb_status ask_target(struct rb_world *world, int k, double time, double h,
                                 struct rb_step_joint *of, struct rb_error *err)
{
	const struct rb_world_hooks *hooks = &world->hooks;
	double at[2], before[2] = {0}, after[2];
	enum rb_status status = hooks->follow(hooks->user, k, time, at, err);

	of->wanted = at[0];
	of->wanted_rate = at[1];
	if (status == RB_OK)
		status = hooks->follow(hooks->user, k, time - h, before, err);
	of->wanted_before = before[0];
	if (status != RB_OK || !isnan(at[1]))
		return status;
	status = hooks->follow(hooks->user, k, time - 0.5 * h, before, err);
	if (status == RB_OK)
		status = hooks->follow(hooks->user, k, time + 0.5 * h, after, err);
	of->wanted_rate = (after[0] - before[0]) / h;
	return status;
}

enum rb_status rb_joints_begin_attempt(struct rb_world *world, const struct rb_cohort *cohort,
                                       double start, double h, struct rb_error *err)
{
	struct cursor c = cursor_start;

	for (int k; (k = next(world, cohort, &c)) >= 0;) {
		struct rb_step_joint *of = &world->stepped->solver.joint[k];

		of->last = of->kept; /* an attempt that was rejected has changed it */
		of->wanted = of->wanted_before = world->joint[k].motor_angle;
		of->wanted_rate = 0;
		if (rb_joint_state_follows(&world->joint[k]) && isnan(of->wanted)) {
			const enum rb_status status = ask_target(world, k, start + h, h, of, err);

			if (status != RB_OK)
				return status;
		}

		of->drift = (double)INFINITY;
		of->is_measured = of->eases = of->halves = of->reduced = false;
		for (int r = 0; r < RB_LINKAGE_ROWS_MAX; r++) {
			const double since = 0.5 * (h + of->last.curve_s);

			of->bend[r] = h * h * (of->last.curve[r] + since * of->last.trend[r]);
		}
	}
	return RB_OK;
}

/* ---- drift ---- */

static bool is_one_sided(const struct rb_world *world, int joint)
{
	return world->model->joints->joint[joint].link.type->one_sided;
}

double rb_joints_error(const struct rb_world *world, int k, struct rb_step_joint *of,
                       const double *left)
{
	const struct rb_joint *joint = &world->model->joints->joint[k];
	const struct rb_pose a = rb_joints_pose(world, joint->a),
			     b = rb_joints_pose(world, joint->b);
	struct rb_linkage_row link[RB_LINKAGE_ROWS_MAX];
	const int count = rb_linkage_rows(&joint->link, &a, &b, link);
	double square = 0, max = 0;

	for (int r = 0; r < count; r++) {
		const bool turns = rb_linkage_row_is_couple(&joint->link, r);
		double error = link[r].error - (left ? left[r] : 0);

		of->miss[r] = link[r].error;
		if (joint->link.type->one_sided)
			error = fmax(0, error);
		if (turns)
			max = fmax(max, joint->size * fabs(error));
		else
			square += error * error;
	}
	/* written so that NaN counts as large */
	return max >= 0 && square >= 0 ? fmax(max, sqrt(square)) : (double)INFINITY;
}

/* For the joints of the last solution. */
bool rb_joints_mark(struct rb_world *world, unsigned char *of_group)
{
	const struct rb_solver *solver = &world->stepped->solver;
	const double max = inspect_share * world->model->stepped_tolerance_m;
	bool any = false;

	for (int k = 0; solver->joint && k < solver->active_joint_count; k++) {
		const int number = solver->active_joint[k];
		struct rb_step_joint *of = &solver->joint[number];
		const int owner = rb_step_joint_rows_owner(world->model,
		                                           &world->model->joints->joint[number]);
		const double before = of->drift;

		if (of->first_row < 0)
			continue;
		of->drift = rb_joints_error(world, number, of, of->left);
		of->is_measured = true;
		of->eases = of->eases ||
		            (is_one_sided(world, number) && before > max && of->drift > before);
		if (of->drift <= max || (of->drift <= world->model->stepped_tolerance_m &&
		                         !(of->drift <= gain_share * before)))
			continue;
		of_group[solver->island_of[owner]] = 1;
		any = true;
	}
	return any;
}

void rb_joints_bend(struct rb_world *world, const unsigned char *of_group)
{
	const struct rb_solver *solver = &world->stepped->solver;

	for (int k = 0; solver->joint && k < solver->active_joint_count; k++) {
		const int number = solver->active_joint[k];
		const struct rb_joint *joint = &world->model->joints->joint[number];
		struct rb_step_joint *of = &solver->joint[number];
		const int owner = rb_step_joint_rows_owner(world->model, joint);
		const bool slack = joint->link.type->one_sided && of->impulse[0] == 0;

		if (of->first_row < 0 || !of_group[solver->island_of[owner]])
			continue;
		for (int r = 0; r < rb_linkage_row_count(&joint->link); r++) {
			const double miss = of->miss[r] - of->left[r];

			of->bend[r] += slack ? fmax(0, miss) : miss;
		}
		of->is_measured = false;
	}
}

/*
 * Largest drift of a joint that counts as held, m: the tolerance; where that is not promised, the
 * size of what it joins, beyond which forces along its rows have nothing to do with it.
 */
static double drift_max(const struct rb_model *model, const struct rb_joint *joint)
{
	return model->rollback == RB_ROLLBACK_NONE ? joint->size : model->stepped_tolerance_m;
}

void rb_joints_blame(struct rb_world *world, const struct rb_cohort *cohort,
                     struct rb_attempt_outcome *outcome)
{
	struct rb_stepped *s = world->stepped;
	struct cursor c = cursor_start;

	if (!world->model->joints)
		return;
	for (int k; (k = next(world, cohort, &c)) >= 0;) {
		const struct rb_joint *joint = &world->model->joints->joint[k];
		const int ends[2] = {joint->a, joint->b};
		const double drift = rb_joints_error(world, k, &s->solver.joint[k], NULL);

		/* written so that NaN fails */
		if (drift <= drift_max(world->model, joint))
			continue;
		outcome->broken = true;
		if (outcome->joint < 0 || drift > outcome->drift) {
			outcome->joint = k;
			outcome->drift = drift;
		}
		for (int e = 0; e < 2; e++)
			if (ends[e] >= 0 && rb_stepped_is_dynamic(world, ends[e]))
				rb_stepped_blame(s, ends[e]);
	}
}

/* Kinetic energy of a group at the end of the step, J. */
static double kinetic_energy(const struct rb_world *world, const struct rb_island *island)
{
	const struct rb_solver *solver = &world->stepped->solver;
	double twice = 0;

	for (int k = 0; k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];
		const rb_vec3 v = rb_world_velocity(world, i);

		twice += rb_vec3_dot(v, v) / world->model->inverse_mass[i];
		if (!world->state.spin)
			continue;
		const rb_vec3 spin = rb_world_row3(world->state.spin, i);
		twice += rb_vec3_dot(spin, rb_world_spin_momentum(world, i));
	}
	return 0.5 * twice;
}

/*
 * Work of the torques by geometric stiffness, J. Their damping of vibrations under a steady tension
 * is little of the kinetic energy; where the motion itself causes the tension it is much of it.
 */
static double stiffening_work(const struct rb_world *world, const struct rb_island *island)
{
	const struct rb_solver *solver = &world->stepped->solver;
	double sum = 0;

	for (int k = 0; k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];
		const struct rb_solver_body turning = {
			.angular = solver->dense.bodies.body[i].angular};

		if (!solver->stiff[i])
			continue;
		/* at the beginning of the step: after a rebound the solver has other values */
		const rb_vec3 before = rb_world_row3(world->mark.spin, i);
		const rb_vec3 more = rb_vec3_sub(
			rb_energy_momentum_of(solver, i, &turning).angular,
			rb_world_weigh_spin(world, &world->mark, i, turning.angular));
		sum -= 0.5 * rb_vec3_dot(more, rb_vec3_add(before, turning.angular));
	}
	return sum;
}

/* Work of a group's joints, J, and its limit: forces times the tolerance. */
struct held {
	double work, max;
};

/*
 * Whether shorter steps would resolve a group's motion better: contacts do not prevent that,
 * springs with rows in whole impulses do, as these damp what the step does not resolve.
 */
static bool is_resolvable(const struct rb_solver *solver, const struct rb_island *island)
{
	if (rb_islands_has_no_rows(island) || (island->has_springs && !island->halves))
		return false;
	for (int k = 0; k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];

		if (solver->rests[i] || rb_kicks_have(solver->kicks, i))
			return false;
	}
	return true;
}

enum rb_status rb_joints_blame_held(struct rb_world *world, double h, struct rb_error *err)
{
	struct rb_stepped *s = world->stepped;
	const struct rb_solver *solver = &s->solver;
	const double along = world->model->stepped_tolerance_m / h;
	struct held *const held = rb_arena_take(&world->arena[0], solver->island_count + 1,
	                                        sizeof *held);

	if (!(h > shortest_share * solver->whole_s))
		return RB_OK;
	if (!held)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the groups of a step");
	memset(held, 0, (solver->island_count + 1) * sizeof *held);
	for (int k = 0; solver->joint && k < solver->active_joint_count; k++) {
		const int number = solver->active_joint[k];
		const struct rb_joint *joint = &world->model->joints->joint[number];
		const struct rb_joint_work *work = &solver->joint[number].work;
		struct held *of =
			&held[solver->island_of[rb_step_joint_rows_owner(world->model, joint)]];

		of->work += work->held;
		of->max += along * work->pushed;
	}
	for (size_t g = 0; g < solver->island_count; g++) {
		const struct rb_island *island = &solver->island[g];

		if (!is_resolvable(solver, island))
			continue;
		if (!island->halves)
			held[g].work += stiffening_work(world, island);
		/* written so that NaN is left to other checks */
		if (!(fabs(held[g].work) > held[g].max) ||
		    !(fabs(held[g].work) >
		      held[g].max + held_share * kinetic_energy(world, island)))
			continue;
		for (int k = 0; k < island->member_count; k++)
			rb_stepped_blame(s, solver->member[island->first_member + k]);
	}
	return RB_OK;
}

/* ---- keeping a step ---- */

/*
 * Remembers the nonlinear part of a row: the measured one, also for redundant rows, whatever was
 * predicted.
 */
static void remember_bend(struct rb_step_joint *of, int r, bool slack, double h)
{
	struct rb_joint_memory *const last = &of->last;
	const bool is_new = of->halves && of->is_measured;
	const double bend = is_new ? of->miss[r] - of->straight[r] : of->bend[r];
	const double curve = slack ? 0 : bend / (h * h), since = 0.5 * (h + last->curve_s);

	last->trend[r] = is_new && last->curve_s > 0 ? (curve - last->curve[r]) / since : 0;
	last->curve[r] = curve;
}

static void remember(const struct rb_joint *joint, struct rb_step_joint *of, double h)
{
	const bool slack = joint->link.type->one_sided && of->impulse[0] == 0;

	for (int p = 0; p < RB_JOINT_PARTS; p++)
		of->last.force[p] = of->impulse[p] / h;
	for (int r = 0; r < RB_LINKAGE_ROWS_MAX; r++)
		remember_bend(of, r, slack, h);
	of->last.curve_s = of->halves ? h : 0;
	of->last.rate = of->rate;
	of->last.length_s = h;
	of->last.reaction = rb_vec3_scale(1 / h, of->reaction);
	of->last.twist = rb_vec3_scale(1 / h, of->twist);
}

double rb_joints_coordinate(const struct rb_world *world, int k, double h)
{
	const struct rb_step_joint *of = &world->stepped->solver.joint[k];

	return coordinate_of(world, &world->model->joints->joint[k], of->last.way + h * of->rate);
}

void rb_joints_keep(struct rb_world *world, const struct rb_cohort *cohort, double h,
                    const unsigned char *skip)
{
	struct cursor c = cursor_start;

	RB_ASSERT(h > 0);
	for (int k; (k = next(world, cohort, &c)) >= 0;) {
		const struct rb_joint *joint = &world->model->joints->joint[k];
		struct rb_step_joint *of = &world->stepped->solver.joint[k];

		if (skip && skip[cohort->body[c.body]])
			continue;
		/* groups at rest keep the forces with which they came to rest */
		if (of->first_row >= 0 || of->reduced)
			remember(joint, of, h);
		world->joint[k].was_set = false;
		memcpy(world->joint[k].noted, of->noted, sizeof of->noted);
		of->last.way = rb_joints_coordinate(world, k, h);
		of->kept = of->last;
		of->sum[0] = rb_vec3_add_scaled(of->sum[0], h, of->last.reaction);
		of->sum[1] = rb_vec3_add_scaled(of->sum[1], h, of->last.twist);
		of->elapsed_s += h;
	}
}

void rb_joints_load(const struct rb_stepped *s, int joint, rb_vec3 *reaction, rb_vec3 *twist)
{
	const struct rb_step_joint *of = &s->solver.joint[joint];

	*reaction = of->last.reaction;
	*twist = of->last.twist;
	if (!(of->elapsed_s > 0))
		return; /* asleep: the values are those of the last step */
	*reaction = rb_vec3_scale(1 / of->elapsed_s, of->sum[0]);
	*twist = rb_vec3_scale(1 / of->elapsed_s, of->sum[1]);
}
