/* SPDX-License-Identifier: MIT */
#include "stepped/reduced_islands.h"

#include <string.h>

#include "base/error.h"
#include "math/quat.h"
#include "stepped/reduced_step.h"
#include "stepped/strategies.h"

/*
 * Least mass and moment of inertia, as fractions of the largest: articulated inertias lose digits
 * by their ratio.
 */
static const double lightest_share = 1e-8;

static const rb_vec3 none = {0, 0, 0};

/* ---- which islands ---- */

static bool is_static(const struct rb_reduced_step *s, int body)
{
	return body < 0 || body >= s->world->model->body_count;
}

/*
 * Whether the joint has only rows that stay in force within the step: no drive, spring, or limit.
 */
static bool joint_moves_freely(const struct rb_joint_query *query, int k,
                               const struct rb_step_joint *of)
{
	const struct rb_joint *const joint = &query->world->model->joints->joint[k];
	const struct rb_joint_state *const state = &query->world->joint[k];

	for (int kind = 0; kind < RB_JOINT_DRIVES; kind++)
		if (rb_joint_state_drive(state, joint, kind).max > 0)
			return false;
	return (joint->link.type->one_sided || joint->link.type->free) && joint->stiffness == 0 &&
	       joint->damping == 0 && of->last.force[RB_JOINT_LOW] == 0 &&
	       of->last.force[RB_JOINT_HIGH] == 0 &&
	       !(joint->link.type->one_sided && of->last.force[0] != 0) &&
	       rb_step_joint_rows_are_smooth(query, k, of);
}

/*
 * Whether all joints of the island move freely, and their other ends are static or dynamic; counts
 * those that are not ropes in `joints`.
 */
static bool joints_move_freely(const struct rb_reduced_step *s, const struct rb_solver *solver,
                               const struct rb_island *island, int *joints)
{
	const struct rb_joints *const all = s->world->model->joints;
	const struct rb_joint_query query = rb_islands_joints(solver, s->world);
	bool good = true;

	*joints = 0;
	for (int m = 0; m < island->member_count && good; m++) {
		const int i = s->tree.body[m];

		for (int e = all->first[i]; e < all->first[i + 1] && good; e++) {
			const int number = all->of[e];
			const struct rb_joint *const joint = &all->joint[number];
			const int other = joint->a == i ? joint->b : joint->a;

			if (s->world->joint[number].released ||
			    rb_step_joint_rows_owner(s->world->model, joint) != i)
				continue;
			good = joint_moves_freely(&query, number, &solver->joint[number]) &&
			       (is_static(s, other) || s->world->model->inverse_mass[other] > 0);
			*joints += !joint->link.type->one_sided;
		}
	}
	return good;
}

/* Whether masses and moments are of comparable size. */
static bool has_comparable_masses(const struct rb_reduced_step *s)
{
	const struct rb_model *const model = s->world->model;
	double least[2] = {(double)INFINITY, (double)INFINITY}, max[2] = {0, 0};

	for (int k = 0; k < s->tree.body_count; k++) {
		const int i = s->tree.body[k];
		const rb_mat3 *const inertia = rb_model_inertia(model, i);
		const double trace = inertia->m[0][0] + inertia->m[1][1] + inertia->m[2][2];
		const rb_mat3 *const inverse = rb_model_inverse_inertia(model, i);
		const double trace_of_inverse = isnan(model->inverse_inertia_scalar[i])
		                                        ? inverse->m[0][0] + inverse->m[1][1] +
		                                                  inverse->m[2][2]
		                                        : 3 * model->inverse_inertia_scalar[i];

		least[0] = fmin(least[0], model->mass[i]);
		max[0] = fmax(max[0], model->mass[i]);
		least[1] = fmin(least[1], 1 / trace_of_inverse);
		max[1] = fmax(max[1], trace);
	}
	/* written so that NaN fails */
	return least[0] >= lightest_share * max[0] && least[1] >= lightest_share * max[1];
}

static struct rb_pose fixed_pose(const void *user, int body, double t)
{
	const struct rb_reduced_step *const s = user;

	(void)t;
	return rb_world_pose(s->world, s->before, body);
}

static bool take_memory(struct rb_reduced_step *s, size_t count, struct rb_arena *arena,
                        int **link_of)
{
	rb_vec3 *const vectors = rb_arena_take(arena, (2 * (RB_REDUCED_STEP_NODES + 1) + 4) * count,
	                                       sizeof *vectors);
	struct rb_pose *const poses = rb_arena_take(arena, (RB_REDUCED_STEP_NODES + 1) * count,
	                                            sizeof *poses);
	struct rb_wrench *const wrenches = rb_arena_take(arena, 4 * count, sizeof *wrenches);

	s->tree.link = rb_arena_take(arena, count, sizeof *s->tree.link);
	s->tree.freedom = rb_arena_take(arena, 3 * count, sizeof *s->tree.freedom);
	s->path = rb_arena_take(arena, count, sizeof *s->path);
	s->lost = rb_arena_take(arena, count, sizeof *s->lost);
	*link_of = rb_arena_take(arena, count, sizeof **link_of);
	if (!vectors || !poses || !wrenches || !s->tree.link || !s->tree.freedom || !s->path ||
	    !s->lost || !*link_of)
		return false;
	for (size_t at = 0; at <= RB_REDUCED_STEP_NODES; at++) {
		s->pose[at] = poses + at * count;
		s->linear[at] = vectors + 2 * at * count;
		s->angular[at] = vectors + (2 * at + 1) * count;
	}
	s->kept = vectors + 2 * (RB_REDUCED_STEP_NODES + 1) * count;
	s->place = s->kept + 2 * count;
	s->spin = s->place + count;
	s->force = wrenches;
	s->on = wrenches + count;
	s->sum = wrenches + 2 * count;
	s->dragged = wrenches + 3 * count;
	return true;
}

/* Forces other than those of joints and drag; drag has left a known fraction of the velocities. */
static void take_forces(struct rb_reduced_step *s, const struct rb_solver *solver)
{
	const struct rb_model *const model = s->world->model;
	const struct rb_world_def *const def = &model->scene->world;
	const bool stated = model->features & (RB_FEATURE_FORCES | RB_FEATURE_PUSHES);

	for (int k = 0; k < s->tree.body_count; k++) {
		const int i = s->tree.body[k];
		struct rb_wrench *const force = &s->force[k];

		*force = (struct rb_wrench){rb_vec3_add_scaled(def->gravity, model->inverse_mass[i],
		                                               def->gravity_force),
		                            none};
		if (stated) {
			const double each = 1 / solver->h_s;
			const double undragged = solver->undragged ? solver->undragged[i] : 1;
			const rb_vec3 w = rb_vec3_sub(solver->after_forces[i].angular,
			                              rb_world_row3(s->before->spin, i));

			force->force = rb_vec3_scale(
				each, rb_vec3_sub(rb_vec3_scale(1 / undragged,
			                                        solver->after_forces[i].linear),
			                          rb_world_row3(s->before->velocity, i)));
			force->torque = rb_vec3_scale(
				each,
				rb_reduced_step_times_inertia(
					model, i,
					rb_quat_from(s->before->orientation + 4 * (size_t)i), w));
		}
	}
}

/* Whether nothing is or becomes faster than a body at rest: rows bring it to rest. */
static bool is_at_rest(struct rb_reduced_step *s, const struct rb_solver *solver)
{
	const double rest_speed = rb_stillness_speed(solver);

	return rb_reduced_step_speed(s) <= rest_speed &&
	       solver->h_s * rb_reduced_step_acceleration(s) <= rest_speed;
}

/* ---- contact points nearby ---- */

/* m: displacement of the end of an arm; bodies that are not dynamic move at constant velocities. */
static rb_vec3 displacement_of(const struct rb_reduced_step *s, const struct rb_solver *solver,
                               int i, rb_vec3 arm)
{
	if (i >= solver->body_count)
		return none;
	const struct rb_solver_body *const body = &solver->dense.bodies.body[i];

	if (!(body->inverse_mass > 0))
		return rb_vec3_scale(solver->h_s,
		                     rb_vec3_add(body->linear, rb_vec3_cross(body->angular, arm)));
	const struct rb_pose *const end = &s->pose[RB_REDUCED_STEP_NODES][solver->local[i]];
	const struct rb_pose begin = rb_world_pose(s->world, s->before, i);
	const rb_vec3 turned = rb_quat_rotate(end->orientation,
	                                      rb_quat_rotate_back(begin.orientation, arm));

	return rb_vec3_add(rb_pose_between(&begin, end), rb_vec3_sub(turned, arm));
}

/* Whether no gap has closed at the end of the step, along its normal at the beginning. */
static bool has_no_contact(const struct rb_reduced_step *s, const struct rb_solver *solver,
                           const struct rb_group_points *points)
{
	bool free = true;

	for (int k = 0; k < points->count && free; k++) {
		const struct rb_step_point *const point = &points->row[points->number[k]];
		const rb_vec3 arm_a = point->central ? none : point->arm_a;
		const rb_vec3 arm_b = point->central ? none : point->arm_b;
		const rb_vec3 displacement = rb_vec3_sub(
			displacement_of(s, solver, point->b, arm_b),
			displacement_of(s, solver, point->a, arm_a));

		/* written so that NaN is not free */
		free = point->gap + rb_vec3_dot(displacement, point->normal) > 0;
	}
	return free;
}

/* ---- results ---- */

/* Momentum of a body, N s, and about the origin, N m s. */
static struct rb_wrench momentum_of(const struct rb_model *model, int i, const struct rb_pose *pose)
{
	const rb_vec3 p = rb_vec3_scale(model->mass[i], pose->velocity);

	return (struct rb_wrench){p, rb_vec3_add(rb_vec3_cross(pose->position, p),
	                                         rb_reduced_step_times_inertia(
							 model, i, pose->orientation, pose->spin))};
}

/*
 * Adds the share of the body at place k in the impulse of a static body on its tree: its change of
 * momentum less that by forces. Impulses within the tree cancel.
 */
static void add_static_impulse(const struct rb_reduced_step *s, double h, int k,
                               struct rb_joint_work *work)
{
	const struct rb_model *const model = s->world->model;
	const int i = s->tree.body[k];
	const struct rb_pose from = rb_world_pose(s->world, s->before, i);
	const struct rb_wrench previous = momentum_of(model, i, &from);
	const struct rb_wrench present = momentum_of(model, i, &s->pose[RB_REDUCED_STEP_NODES][k]);
	const rb_vec3 force = rb_vec3_scale(model->mass[i], s->force[k].force);

	work->linear = rb_vec3_add(work->linear, rb_vec3_sub(present.force, previous.force));
	work->linear = rb_vec3_add_scaled(work->linear, -h, force);
	work->linear = rb_vec3_sub(work->linear, s->dragged[k].force);
	work->angular = rb_vec3_add(work->angular, rb_vec3_sub(present.torque, previous.torque));
	work->angular = rb_vec3_sub(work->angular, rb_vec3_cross(s->place[k], force));
	work->angular = rb_vec3_add_scaled(work->angular, -h, s->force[k].torque);
	work->angular = rb_vec3_sub(work->angular, s->dragged[k].torque);
}

/*
 * Enters the impulses of static bodies at the joints of the roots, each that on its own tree.
 * `link_of` (links by place) is replaced by those of the roots.
 */
static void store_static_impulses(const struct rb_reduced_step *s, struct rb_solver *solver,
                                  int *link_of)
{
	for (int k = 0; k < s->tree.count; k++) {
		const struct rb_joint_tree_link *const link = &s->tree.link[k];

		if (link->parent >= 0)
			link_of[link->place] = link_of[s->tree.link[link->parent].place];
	}
	for (int k = 0; k < s->tree.body_count; k++) {
		const int joint = s->tree.link[link_of[k]].joint;

		if (joint >= 0)
			add_static_impulse(s, solver->h_s, k, &solver->joint[joint].work);
	}
}

static void store_joint(const struct rb_reduced_step *s, const struct rb_solver *solver, int k)
{
	const struct rb_joint_tree_link *const link = &s->tree.link[k];
	const struct rb_joint *const joint = &s->world->model->joints->joint[link->joint];
	struct rb_step_joint *const of = &solver->joint[link->joint];

	memset(of->impulse, 0, sizeof of->impulse);
	of->reaction = s->sum[k].force;
	of->twist = s->sum[k].torque;
	if (rb_linkage_has_point(&joint->link))
		rb_vec3_to(of->impulse, of->reaction);
	of->work = (struct rb_joint_work){0};
	of->reduced = true;
}

static void store(const struct rb_reduced_step *s, struct rb_solver *solver,
                  struct rb_island *island, int *link_of)
{
	const double each = 1 / solver->h_s;
	double taken = s->taken;
	const struct rb_joints *const all = s->world->model->joints;

	for (int k = 0; k < s->tree.body_count; k++) {
		const int i = s->tree.body[k];
		const struct rb_pose *const pose = &s->pose[RB_REDUCED_STEP_NODES][k];
		struct rb_solver_body *const body = &solver->dense.bodies.body[i];

		solver->reduced_motion[i] = (struct rb_reduced_motion){
			.position = pose->position,
			.orientation = pose->orientation,
			.velocity = pose->velocity,
			.spin = pose->spin,
			.place = rb_vec3_scale(each, s->place[k]),
			.turning = rb_vec3_scale(each, s->spin[k]),
			.dragged = s->dragged[k],
			.lost = s->lost[k]};
		body->linear = pose->velocity;
		body->angular = pose->spin;
		solver->rests[i] = 0;
		for (int e = all->first[i]; e < all->first[i + 1]; e++) {
			const struct rb_joint *const joint = &all->joint[all->of[e]];
			struct rb_step_joint *const of = &solver->joint[all->of[e]];

			/* a rope that hangs slack */
			if (joint->link.type->one_sided && !s->world->joint[all->of[e]].released) {
				memset(of->impulse, 0, sizeof of->impulse);
				of->reaction = of->twist = none;
				of->work = (struct rb_joint_work){0};
				of->reduced = true;
			}
		}
	}
	for (int k = 0; k < s->tree.count; k++) {
		const int joint = s->tree.link[k].joint;

		if (joint < 0)
			continue;
		store_joint(s, solver, k);
		/*
		 * where none was set, it is due to errors of earlier rows, and is not accounted for
		 */
		if (s->world->joint[joint].was_set) {
			solver->joint[joint].work.impacts = taken;
			taken = 0;
		}
	}
	store_static_impulses(s, solver, link_of);
	island->sweeps = (int)s->evaluations;
	island->factors = 0;
	island->residual = island->slip = island->energy_budget = 0;
}

bool rb_reduced_islands_try(struct rb_solver *solver, const struct rb_world *world,
                            struct rb_island *island, const struct rb_group_points *points,
                            struct rb_arena *arena)
{
	const size_t count = (size_t)island->member_count;
	struct rb_reduced_step s = {.world = world,
	                            .before = solver->before,
	                            .tree = {.model = world->model,
	                                     .state = world->joint,
	                                     .body = solver->member + island->first_member,
	                                     .body_count = island->member_count,
	                                     .place = solver->local,
	                                     .placed = solver->body_count,
	                                     .fixed_pose = fixed_pose}};
	int joints, *link_of;

	if (!joints_move_freely(&s, solver, island, &joints) || !has_comparable_masses(&s) ||
	    !take_memory(&s, count, arena, &link_of))
		return false;
	s.tree.user = &s;
	s.drag = rb_drag_of_all(world->model);
	for (int k = 0; k < s.tree.body_count; k++)
		solver->local[s.tree.body[k]] = k;
	rb_joint_tree_grow(&s.tree, link_of);
	for (int k = 0; k < s.tree.count; k++)
		joints -= s.tree.link[k].joint >= 0;
	/* else there is a ring */
	take_forces(&s, solver);
	const bool good = joints == 0 && !is_at_rest(&s, solver) &&
	                  rb_reduced_step_take(&s, solver->h_s) &&
	                  has_no_contact(&s, solver, points);

	for (int k = 0; k < s.tree.body_count; k++)
		solver->local[s.tree.body[k]] = -1;
	if (good)
		store(&s, solver, island, link_of);
	return good;
}
