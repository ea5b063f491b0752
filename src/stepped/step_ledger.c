/* SPDX-License-Identifier: MIT */
/*
 * Ledger of a step: entries of momentum and energy by cause. Every impulse p of a step that acts at
 * a contact with relative velocities u before and u' after does the work p . (u + u') / 2, exactly:
 * kinetic energy changes by the sum of these products.
 *
 * Bodies at rest get no entries of their own contacts: their forces are entered, and the holder
 * (static or driven) gives the opposite. At the end dissipation is limited to what the bodies have
 * lost (limit_dissipation), as roundoff may make it negative.
 */
#include "stepped/step_ledger.h"

#include "base/error.h"
#include "step/force_stages.h"
#include "stepped/joint_steps.h"

/* Sums over bodies with weight, for gravity (per mass) and gravity_force (per body). */
struct weights {
	double mass, count;
	rb_vec3 moment, place; /* kg m; m: sums of the points where their weights act */
};

struct entering {
	const struct rb_world *world;
	const struct rb_cohort *cohort;
	const struct rb_tally *tally;
	const struct rb_state *before;
	const unsigned char *skip;
	const int *member; /* of the cohort; for that of all, also sleeping ones */
	int member_count;
	struct rb_pass pass;         /* query of the scene's constant forces */
	struct weights all, resting; /* of all; of those at rest */
	struct rb_entries e;
};

static const rb_vec3 none = {0, 0, 0};

static rb_vec3 mean(rb_vec3 x, rb_vec3 y)
{
	return rb_vec3_scale(0.5, rb_vec3_add(x, y));
}

/* Velocity of the point at that arm from {velocity, spin}. */
static rb_vec3 velocity_at(const rb_vec3 motion[2], rb_vec3 arm)
{
	return rb_vec3_add(motion[0], rb_vec3_cross(motion[1], arm));
}

/* Whether a dynamic body takes part in this entry. */
static bool is_in(const struct entering *n, int i)
{
	return !n->skip || !n->skip[i];
}

/* Cause of impulses from a body that is not dynamic. */
static enum rb_ledger_momentum cause_of(const struct entering *n, int i)
{
	return i < n->world->model->body_count ? RB_MOMENTUM_DRIVEN : RB_MOMENTUM_STATIC;
}

/* Velocity of a static or driven body at a point, m/s, as the solver saw it. */
static rb_vec3 fixed_velocity(const struct entering *n, int i, rb_vec3 at)
{
	if (i >= n->world->model->body_count)
		return none;
	const rb_vec3 arm = rb_vec3_sub(at, rb_world_row3(n->before->position, i));
	const rb_vec3 motion[2] = {rb_world_row3(n->before->velocity, i),
	                           n->before->spin ? rb_world_row3(n->before->spin, i) : none};

	return velocity_at(motion, arm);
}

/* Impulse of a static or driven body at a point, and the work that a driven one does. */
static void enter_fixed(struct entering *n, int i, rb_vec3 impulse, rb_vec3 at)
{
	rb_entries_impulse(&n->e, cause_of(n, i), impulse, at);
	if (i < n->world->model->body_count)
		rb_entries_energy(&n->e, RB_ENERGY_DRIVEN,
		                  rb_vec3_dot(impulse, fixed_velocity(n, i, at)));
}

/* ---- forces ---- */

/*
 * Impulses of all forces on a body except weight; the holder of a body at rest gives the opposite.
 */
struct held {
	rb_vec3 linear, angular; /* N s; N m s about the origin */
};

static void add_to_held(struct held *held, rb_vec3 impulse, rb_vec3 at)
{
	held->linear = rb_vec3_add(held->linear, impulse);
	held->angular = rb_vec3_add(held->angular, rb_vec3_cross(at, impulse));
}

static void add_weight(struct weights *weights, double mass, rb_vec3 at)
{
	weights->mass += mass;
	weights->count++;
	weights->moment = rb_vec3_add_scaled(weights->moment, mass, at);
	weights->place = rb_vec3_add(weights->place, at);
}

/* Impulse and moment of gravity on all bodies of the sum at once. */
static void enter_weights(struct entering *n, enum rb_ledger_momentum cause, double seconds,
                          const struct weights *weights)
{
	const struct rb_world_def *def = &n->world->model->scene->world;
	const rb_vec3 force = rb_vec3_add_scaled(rb_vec3_scale(weights->mass, def->gravity),
	                                         weights->count, def->gravity_force);
	const rb_vec3 torque = rb_vec3_add(rb_vec3_cross(weights->moment, def->gravity),
	                                   rb_vec3_cross(weights->place, def->gravity_force));

	rb_entries_momentum(&n->e, cause, rb_vec3_scale(seconds, force),
	                    rb_vec3_scale(seconds, torque));
}

/* Cause that balances forces on bodies at rest: statics if there are any. */
static enum rb_ledger_momentum holder(const struct entering *n)
{
	return n->world->model->static_count > 0 ? RB_MOMENTUM_STATIC : RB_MOMENTUM_DRIVEN;
}

/* Enters the work of an impulse without potential, at the mean of velocities. */
static void enter_force(struct entering *n, const struct rb_tally_body *body,
                        enum rb_ledger_momentum cause, rb_vec3 impulse, rb_vec3 turn)
{
	static const enum rb_ledger_energy energy[RB_MOMENTUM_CAUSES] = {
		[RB_MOMENTUM_APPLIED] = RB_ENERGY_APPLIED,
		[RB_MOMENTUM_DRAG] = RB_ENERGY_DRAG,
		[RB_MOMENTUM_CALLBACKS] = RB_ENERGY_CALLBACKS};
	const double work = rb_vec3_dot(impulse, body->mean[0]) + rb_vec3_dot(turn, body->mean[1]);

	rb_entries_energy(&n->e, energy[cause], cause == RB_MOMENTUM_DRAG ? -work : work);
}

static void enter_constant_force(struct entering *n, int i, const struct rb_force_impulse *force,
                                 rb_vec3 at, struct held *held)
{
	const struct rb_tally_body *body = &n->tally->body[i];

	enter_force(n, body, force->cause, force->impulse, force->turn);
	rb_entries_impulse(&n->e, force->cause, force->impulse, at);
	rb_entries_twist(&n->e, force->cause, force->turn);
	add_to_held(held, force->impulse, at);
	held->angular = rb_vec3_add(held->angular, force->turn);
}

/* Point at which constant forces act, m: for a free body the middle of its path without them. */
static rb_vec3 constant_force_place(const struct entering *n, int i)
{
	const struct rb_tally_body *body = &n->tally->body[i];
	const rb_vec3 begin = rb_world_row3(n->before->position, i);

	if (body->swings && body->kind == RB_TALLY_JOINED)
		return body->place;
	if (body->kind != RB_TALLY_FREE)
		return body->halves ? mean(begin, body->place) : begin;
	return n->world->stepped->varied
	               ? rb_vec3_add(begin, body->carry)
	               : rb_vec3_add_scaled(begin, 0.5 * n->pass.h_s,
	                                    rb_world_row3(n->before->velocity, i));
}

static void enter_constant_forces(struct entering *n, int i, rb_vec3 at, struct held *held)
{
	const struct rb_model *model = n->world->model;
	const int count = model->scene->bodies[model->id_of[i]].force_count;

	for (int f = 0; f < count; f++) {
		const struct rb_force_impulse force = rb_forces_stated(&n->pass, n->before, i, f);

		enter_constant_force(n, i, &force, at, held);
	}
	if (model->features & RB_FEATURE_PUSHES) {
		const struct rb_force_impulse force = rb_forces_pushed(&n->pass, i);

		enter_constant_force(n, i, &force, at, held);
	}
}

static void enter_impulse(struct entering *n, int i, enum rb_ledger_momentum cause,
                          const struct rb_wrench *impulse, struct held *held)
{
	const rb_vec3 at = rb_world_row3(n->before->position, i);

	rb_entries_impulse(&n->e, cause, impulse->force, at);
	rb_entries_twist(&n->e, cause, impulse->torque);
	add_to_held(held, impulse->force, at);
	held->angular = rb_vec3_add(held->angular, impulse->torque);
}

static void enter_varied(struct entering *n, int i, enum rb_ledger_momentum cause,
                         const struct rb_wrench *impulse, struct held *held)
{
	enter_force(n, &n->tally->body[i], cause, impulse->force, impulse->torque);
	enter_impulse(n, i, cause, impulse, held);
}

/* The holder's impulse on a body at rest: the change of momentum minus all forces. */
static void enter_holder(struct entering *n, int i, const struct held *held)
{
	const struct rb_model *model = n->world->model;
	const struct rb_tally_body *body = &n->tally->body[i];
	const rb_vec3 p = rb_vec3_scale(model->mass[i], rb_vec3_sub(body->end[0], body->begin[0]));
	const rb_vec3 turn = rb_tally_spin(n->world, n->before, i,
	                                   rb_vec3_sub(body->end[1], body->begin[1]));
	const rb_vec3 angular = rb_vec3_add(
		turn, rb_vec3_cross(rb_world_row3(n->before->position, i), p));

	rb_entries_momentum(&n->e, holder(n), rb_vec3_sub(p, held->linear),
	                    rb_vec3_sub(angular, held->angular));
}

/*
 * Effect of position projection on a body, unless by other dynamic bodies: momentum within the
 * group cancels.
 */
static void enter_closing(struct entering *n, int i)
{
	const struct rb_tally_body *body = &n->tally->body[i];

	if (body->closed_by != RB_MOMENTUM_CAUSES)
		rb_entries_momentum(&n->e, body->closed_by, body->closed[0], body->closed[1]);
	rb_entries_energy(&n->e, RB_ENERGY_IMPACTS, body->turned);
	if (body->closed_by == RB_MOMENTUM_DRIVEN)
		rb_entries_energy(&n->e, RB_ENERGY_DRIVEN, body->lifted);
}

/* At rest before and after. */
static bool is_resting(const struct rb_tally_body *body)
{
	return rb_vec3_max_abs(body->begin[0]) == 0 && rb_vec3_max_abs(body->begin[1]) == 0 &&
	       rb_vec3_max_abs(body->end[0]) == 0 && rb_vec3_max_abs(body->end[1]) == 0;
}

/*
 * Gravitation on a body: between dynamic bodies it conserves total momentum and has a potential.
 * Entered are the parts by bodies that are not dynamic, and those without reaction.
 */
static void enter_gravitation(struct entering *n, int i, struct held *held)
{
	const struct rb_world *world = n->world;
	const struct rb_gravitation *const gravitation = world->gravitation;
	const struct rb_attract *const all = &gravitation->all;
	const rb_vec3 at = rb_world_row3(n->before->position, i);
	const double h = n->cohort->gravitation_s;

	add_to_held(held,
	            rb_vec3_scale(h * world->model->mass[i], rb_gravitation_found(gravitation, i)),
	            at);
	if (world->model->center_count == 0 && world->model->attracts_by_mass)
		return;
	for (int j = 0; j < all->count; j++) {
		double factor;

		if (j == i)
			continue;
		if (rb_stepped_is_dynamic(world, j)) {
			const rb_vec3 more = rb_vec3_scale(
				h, rb_gravitation_surplus(gravitation, i, j));

			rb_entries_energy(&n->e, RB_ENERGY_APPLIED,
			                  rb_vec3_dot(more, n->tally->body[i].mean[0]));
			rb_entries_impulse(&n->e, RB_MOMENTUM_APPLIED, more, at);
			continue;
		}
		const rb_vec3 d = rb_attract_between(all, i, j, &factor);
		const rb_vec3 on = rb_vec3_scale(h * factor * all->inertial[i] * all->mu[j], d);

		rb_entries_impulse(&n->e, cause_of(n, j), on, at);
		if (j < world->model->body_count)
			rb_entries_energy(&n->e, RB_ENERGY_DRIVEN,
			                  rb_vec3_dot(on, rb_world_row3(n->before->velocity, j)));
	}
}

static void enter_body(struct entering *n, int i)
{
	static const rb_features others = RB_FEATURE_FORCES | RB_FEATURE_PUSHES | RB_FEATURE_FIELD |
	                                  RB_FEATURE_DRAG | RB_FEATURE_ELEMENTS |
	                                  RB_FEATURE_GRAVITATION;
	const rb_features features = n->world->model->features;
	const struct rb_tally_body *body = &n->tally->body[i];
	const rb_vec3 at = constant_force_place(n, i);
	const bool rests = body->kind == RB_TALLY_RESTS;
	struct held held = {none, none};

	add_weight(&n->all, n->world->model->mass[i], at);
	if (rests)
		add_weight(&n->resting, n->world->model->mass[i], at);
	if (features & (RB_FEATURE_FORCES | RB_FEATURE_PUSHES))
		enter_constant_forces(n, i, at, &held);
	if (features & (RB_FEATURE_FIELD | RB_FEATURE_ELEMENTS))
		enter_varied(n, i, RB_MOMENTUM_APPLIED, &body->varied, &held);
	if ((features & RB_FEATURE_ELEMENTS) || n->world->hooks.potential)
		enter_impulse(n, i, RB_MOMENTUM_APPLIED, &body->stored, &held);
	if (n->world->hooks.potential)
		rb_entries_energy(&n->e, RB_ENERGY_APPLIED, body->potential_change);
	if (body->swings && body->kind == RB_TALLY_JOINED && (features & RB_FEATURE_DRAG)) {
		rb_entries_momentum(&n->e, RB_MOMENTUM_DRAG, body->drag, body->drag_turn);
		rb_entries_energy(&n->e, RB_ENERGY_DRAG, body->drag_lost);
	} else if (features & (RB_FEATURE_DRAG | RB_FEATURE_ELEMENTS)) {
		enter_varied(n, i, RB_MOMENTUM_DRAG, &(struct rb_wrench){.force = body->drag},
		             &held);
	}
	if (features & RB_FEATURE_GRAVITATION)
		enter_gravitation(n, i, &held);
	if (rests && ((features & others) || !is_resting(body)))
		enter_holder(n, i, &held);
	if (body->is_closed)
		enter_closing(n, i);
}

/* ---- force elements between bodies ---- */

/* Pose at the beginning with mean velocities: the wrench acts there, its power is at the mean. */
static struct rb_pose mean_pose(const struct rb_element_query *query, int i)
{
	const struct entering *n = query->user;
	struct rb_pose pose = rb_world_pose(n->world, n->before, i);

	if (rb_stepped_is_dynamic(n->world, i)) {
		pose.velocity = n->tally->body[i].mean[0];
		pose.spin = n->tally->body[i].mean[1];
	}
	return pose;
}

static struct rb_pose end_pose(const struct rb_element_query *query, int i)
{
	const struct entering *n = query->user;

	return rb_world_pose(n->world, &n->world->state, i);
}

/* Reaction of an element's end on a static or driven body, or on a body at rest. */
static void enter_end(struct entering *n, int i, const struct rb_wrench *on,
                      const struct rb_pose *pose)
{
	const bool is_dynamic = rb_stepped_is_dynamic(n->world, i);
	const rb_vec3 turn = rb_vec3_add(on->torque, rb_vec3_cross(pose->position, on->force));

	if (is_dynamic && n->tally->body[i].kind != RB_TALLY_RESTS)
		return;
	rb_entries_momentum(&n->e, is_dynamic ? holder(n) : cause_of(n, i), rb_vec3_neg(on->force),
	                    rb_vec3_neg(turn));
	if (!is_dynamic && i < n->world->model->body_count)
		rb_entries_energy(&n->e, RB_ENERGY_DRIVEN,
		                  -(rb_vec3_dot(on->force, pose->velocity) +
		                    rb_vec3_dot(on->torque, pose->spin)));
}

/*
 * Dissipation of a damper: its power times h, limited to what bodies and element have lost. An
 * element without a potential does work instead.
 */
static void enter_element(struct entering *n, const struct rb_elements *elements, int k,
                          const struct rb_tally_element *tally)
{
	const struct rb_element_kind *kind = elements->kind;
	const void *row = rb_elements_row(elements, k);
	const struct rb_element_query begin = {n->world->model, n->pass.start_s, mean_pose, n};
	const struct rb_element_query end = {n->world->model, n->pass.start_s + n->pass.h_s,
	                                     end_pose, n};
	double work = 0;

	for (int e = 0; e < 2; e++) {
		const struct rb_pose pose = mean_pose(&begin, elements->end[k][e]);

		enter_end(n, elements->end[k][e], &tally->on[e], &pose);
		work += rb_vec3_dot(tally->on[e].force, pose.velocity) +
		        rb_vec3_dot(tally->on[e].torque, pose.spin);
	}
	if (!kind->energy)
		rb_entries_energy(&n->e, RB_ENERGY_APPLIED, work);
	const double power = kind->dissipation ? kind->dissipation(&begin, row) : 0;
	if (!(power > 0) && !(tally->damped > 0))
		return;
	const double taken = isnan(tally->damped) ? n->pass.h_s * power : tally->damped;
	const double lost = kind->energy
	                            ? kind->energy(&begin, row) - kind->energy(&end, row) - work
	                            : taken;

	rb_entries_energy(&n->e, RB_ENERGY_DAMPING, fmax(0, fmin(taken, lost)));
}

/* Elements with an end in the cohort. */
static void enter_elements(struct entering *n)
{
	const struct rb_model *model = n->world->model;
	unsigned char *const here = n->tally->here;
	const struct rb_tally_element *tally = n->tally->element;

	if (rb_elements_between(model) == 0)
		return;
	for (int k = 0; k < n->member_count; k++)
		here[n->member[k]] = is_in(n, n->member[k]);
	for (int list = 0; list < model->element_list_count; list++) {
		const struct rb_elements *elements = &model->elements[list];

		for (int k = 0; elements->end && k < elements->count; k++, tally++)
			if (here[elements->end[k][0]] || here[elements->end[k][1]])
				enter_element(n, elements, k, tally);
	}
	for (int k = 0; k < n->member_count; k++)
		here[n->member[k]] = 0;
}

/* ---- contacts ---- */

/* Ledger entry of friction: in an impact, or of sliding contact. */
static enum rb_ledger_energy friction_entry(const struct rb_step_point *point)
{
	return point->after_impact ? RB_ENERGY_IMPACT_FRICTION : RB_ENERGY_SLIDING;
}

/*
 * Splits the work of an impulse on b at the mean relative velocity u into a normal and a tangential
 * part.
 */
static void enter_work(struct entering *n, const struct rb_step_point *point, rb_vec3 normal,
                       rb_vec3 impulse, rb_vec3 u)
{
	const double work = rb_vec3_dot(impulse, u);
	const double along = rb_vec3_dot(impulse, normal) * rb_vec3_dot(u, normal);

	rb_entries_energy(&n->e, RB_ENERGY_IMPACTS, -along);
	rb_entries_energy(&n->e, friction_entry(point), along - work);
}

/* Arm of a to the point of action, m. */
static rb_vec3 arm_of_a(const struct rb_step_point *point)
{
	return point->central ? rb_vec3_scale(point->arm_a.x, point->normal) : point->lever;
}

/* Arm of b to the same point. */
static rb_vec3 arm_of_b(const struct rb_step_point *point)
{
	return point->central ? rb_vec3_scale(point->arm_b.x, point->normal)
	                      : rb_vec3_add(point->arm_b, rb_vec3_sub(point->lever, point->arm_a));
}

/* Arms of a point whose impulse acts at their common point; `normal` becomes the one there. */
static void joined_arms(const struct entering *n, const struct rb_step_point *point, bool at_end,
                        rb_vec3 *normal, rb_vec3 arm[2])
{
	const struct rb_tally_body *a = &n->tally->body[point->a], *b = &n->tally->body[point->b];
	const int of[2] = {point->a, point->b};
	const rb_vec3 acted = rb_vec3_sub(b->acted, a->acted);
	const rb_vec3 between = at_end ? rb_vec3_sub(b->place, a->place) : acted;

	*normal = point->normal;
	if (point->central) {
		if (at_end)
			*normal = rb_levers_normal(between, point->normal);
		const double gap = rb_vec3_dot(between, *normal) - point->arm_a.x + point->arm_b.x;

		arm[0] = rb_vec3_scale(point->arm_a.x + 0.5 * gap, *normal);
		arm[1] = rb_vec3_scale(point->arm_b.x - 0.5 * gap, *normal);
		return;
	}
	arm[0] = point->lever;
	arm[1] = rb_vec3_sub(point->lever, acted);
	if (at_end)
		rb_levers_join(n->world, of, between, point->normal, arm);
}

/*
 * Mean of the relative velocity before and after, m/s. For spheres the term of the arms is written
 * without their difference of large vectors.
 */
static rb_vec3 mean_at(const struct entering *n, const struct rb_step_point *point, bool is_dynamic,
                       rb_vec3 on_fixed)
{
	const struct rb_tally_body *a = &n->tally->body[point->a], *b = &n->tally->body[point->b];

	if (!is_dynamic)
		return rb_vec3_sub(on_fixed, velocity_at(a->mean, arm_of_a(point)));
	if (rb_stepped_joins_arms(n->world, point->b)) {
		rb_vec3 normal, arm[2];

		joined_arms(n, point, false, &normal, arm);
		return rb_vec3_sub(velocity_at(b->mean, arm[1]), velocity_at(a->mean, arm[0]));
	}
	const rb_vec3 u = rb_vec3_sub(b->mean[0], a->mean[0]);
	if (!point->central)
		return rb_vec3_add(u, rb_vec3_sub(rb_vec3_cross(b->mean[1], arm_of_b(point)),
		                                  rb_vec3_cross(a->mean[1], arm_of_a(point))));
	const rb_vec3 w = rb_vec3_add_scaled(rb_vec3_scale(point->arm_b.x, b->mean[1]),
	                                     -point->arm_a.x, a->mean[1]);
	return rb_vec3_add(u, rb_vec3_cross(w, point->normal));
}

static void enter_point(struct entering *n, const struct rb_step_point *point)
{
	const bool is_dynamic = rb_stepped_is_dynamic(n->world, point->b);
	rb_vec3 on_fixed = none;

	RB_ASSERT_COSTLY(point->normal_impulse > 0);
	if (!is_dynamic) {
		const rb_vec3 at = rb_vec3_add(rb_world_row3(n->before->position, point->a),
		                               arm_of_a(point));
		const rb_vec3 p = rb_vec3_add_scaled(point->friction_impulse, point->normal_impulse,
		                                     point->normal);

		on_fixed = fixed_velocity(n, point->b, at);
		enter_fixed(n, point->b, rb_vec3_neg(p), at);
	}
	const rb_vec3 u = mean_at(n, point, is_dynamic, on_fixed);
	rb_entries_energy(&n->e, RB_ENERGY_IMPACTS,
	                  -point->normal_impulse * rb_vec3_dot(u, point->normal));
	rb_entries_energy(&n->e, friction_entry(point), -rb_vec3_dot(u, point->friction_impulse));
}

/* Mean of this velocity and the present one at that arm. */
static rb_vec3 mean_since(const struct entering *n, int i, const rb_vec3 motion[2], rb_vec3 arm)
{
	const struct rb_state *now = &n->world->state;
	const rb_vec3 after[2] = {rb_world_row3(now->velocity, i),
	                          now->spin ? rb_world_row3(now->spin, i) : none};

	return mean(velocity_at(motion, arm), velocity_at(after, arm));
}

static void enter_rebound(struct entering *n, const struct rb_step_point *point, rb_vec3 rebound)
{
	const struct rb_tally_body *a = &n->tally->body[point->a], *body = n->tally->body;
	rb_vec3 arm[2] = {arm_of_a(point), none}, normal = point->normal, on_b;

	if (rb_stepped_is_dynamic(n->world, point->b)) {
		arm[1] = arm_of_b(point);
		if (rb_stepped_joins_arms(n->world, point->b))
			joined_arms(n, point, true, &normal, arm);
		on_b = mean_since(n, point->b, body[point->b].end, arm[1]);
	} else {
		const rb_vec3 at = rb_vec3_add(a->place, arm[0]);

		on_b = fixed_velocity(n, point->b, at);
		enter_fixed(n, point->b, rb_vec3_neg(rebound), at);
	}
	enter_work(n, point, normal, rebound,
	           rb_vec3_sub(on_b, mean_since(n, point->a, a->end, arm[0])));
}

static void enter_points(struct entering *n)
{
	const struct rb_step_points *points = &n->cohort->points;

	for (size_t k = 0; k < points->count; k++) {
		const struct rb_step_point *point = &points->row[k];

		if (!is_in(n, point->a))
			continue;
		if (point->normal_impulse > 0 && n->tally->body[point->a].kind == RB_TALLY_JOINED)
			enter_point(n, point);
		const rb_vec3 rebound = rb_cohort_rebound(n->cohort, k);
		if (rebound.x != 0 || rebound.y != 0 || rebound.z != 0)
			enter_rebound(n, point, rebound);
	}
}

/*
 * Impacts within the step. The body continues with the velocity of the step's end, as if it had
 * arrived with it: the point of action is computed so.
 */
static void enter_impact(struct entering *n, const struct rb_ledger_impact *impact)
{
	rb_entries_energy(&n->e, RB_ENERGY_IMPACTS, impact->along);
	rb_entries_energy(&n->e, RB_ENERGY_IMPACT_FRICTION, impact->across);
	if (rb_stepped_is_dynamic(n->world, impact->b))
		return;
	const rb_vec3 from = rb_world_row3(n->before->position, impact->a);
	const rb_vec3 center = rb_vec3_add_scaled(from, impact->t_s,
	                                          n->tally->body[impact->a].end[0]);

	rb_entries_impulse(&n->e, cause_of(n, impact->b), rb_vec3_neg(impact->impulse),
	                   rb_vec3_add(center, impact->arm_a));
	if (impact->b < n->world->model->body_count)
		rb_entries_energy(&n->e, RB_ENERGY_DRIVEN, impact->driven);
}

/* ---- joints ---- */

/* Energy that a spring of a joint coordinate has lost beside its work, J, at most its damper's. */
static double spring_lost(const struct entering *n, int k, const struct rb_step_joint *of)
{
	const struct rb_joint *joint = &n->world->model->joints->joint[k];
	const double from = of->last.way - joint->rest;
	const double to = rb_joints_coordinate(n->world, k, n->pass.h_s) - joint->rest;
	const double lost = 0.5 * joint->stiffness * (from - to) * (from + to) - of->work.spring;
	const double rate = (to - from) / n->pass.h_s;

	return fmax(0, fmin(lost, n->pass.h_s * joint->damping * rate * rate));
}

static void enter_joint(struct entering *n, int k)
{
	const struct rb_step_joint *of = &n->world->stepped->solver.joint[k];
	const struct rb_joint *joint = &n->world->model->joints->joint[k];
	const struct rb_joint_work *work = &of->work;
	const bool a_is_dynamic = rb_stepped_is_dynamic(n->world, joint->a);
	const int other = a_is_dynamic ? joint->b : joint->a;

	rb_entries_energy(&n->e, RB_ENERGY_DRIVEN, work->motor);
	rb_entries_energy(&n->e, RB_ENERGY_JOINT_FRICTION, work->friction);
	rb_entries_energy(&n->e, RB_ENERGY_IMPACTS, work->impacts);
	if (joint->damping > 0)
		rb_entries_energy(&n->e, RB_ENERGY_DAMPING, spring_lost(n, k, of));
	if (other >= 0 && rb_stepped_is_dynamic(n->world, other))
		return;
	rb_entries_momentum(&n->e, other < 0 ? RB_MOMENTUM_STATIC : cause_of(n, other),
	                    work->linear, work->angular);
	if (other >= 0 && other < n->world->model->body_count)
		rb_entries_energy(&n->e, RB_ENERGY_DRIVEN, work->driven);
}

/* Joints of the cohort; for bodies at rest the holder balances all forces. */
static void enter_joints(struct entering *n)
{
	for (int m = 0; n->world->model->joints && m < n->cohort->member_count; m++) {
		const int i = n->cohort->body[m];
		int at = -1;

		if (!is_in(n, i) || n->tally->body[i].kind != RB_TALLY_JOINED)
			continue;
		for (int k; (k = rb_joints_next_of(n->world, i, &at)) >= 0;)
			enter_joint(n, k);
	}
}

/* ---- all ---- */

/*
 * Kinetic and potential energy that a body has lost in the step, J; differences are factored, (v -
 * v') . (v + v'), to keep their digits.
 */
static double lost_by(const struct entering *n, int i)
{
	const struct rb_world *world = n->world;
	const struct rb_state *before = n->before, *now = &world->state;
	const struct rb_world_def *def = &world->model->scene->world;
	const double mass = world->model->mass[i];
	const rb_vec3 from = rb_world_row3(before->velocity, i),
		      to = rb_world_row3(now->velocity, i);
	const rb_vec3 displacement = rb_vec3_sub(rb_world_row3(now->position, i),
	                                         rb_world_row3(before->position, i));
	const rb_vec3 weight = rb_vec3_add_scaled(def->gravity_force, mass, def->gravity);
	const double lost = 0.5 * mass * rb_vec3_dot(rb_vec3_sub(from, to), rb_vec3_add(from, to)) +
	                    rb_vec3_dot(weight, displacement);

	if (!now->spin)
		return lost;
	const rb_vec3 w = rb_world_row3(before->spin, i), w_now = rb_world_row3(now->spin, i);
	if (!isnan(world->model->inverse_inertia_scalar[i]))
		return lost + 0.5 * rb_model_inertia(world->model, i)->m[0][0] *
		                      rb_vec3_dot(rb_vec3_sub(w, w_now), rb_vec3_add(w, w_now));
	return lost + 0.5 * (rb_vec3_dot(w, rb_tally_spin(world, before, i, w)) -
	                     rb_vec3_dot(w_now, rb_tally_spin(world, now, i, w_now)));
}

/* A free body under constant forces conserves energy, and a resting one has none to lose. */
static bool may_lose(const struct entering *n, const struct rb_tally_body *body)
{
	return body->is_closed || body->kind == RB_TALLY_JOINED ||
	       (body->kind == RB_TALLY_FREE && rb_tally_works(n->world->model));
}

/* Limits dissipation to [0, energy lost] where no force varies, scaling all takers alike. */
static void limit_dissipation(struct entering *n)
{
	static const enum rb_ledger_energy taker[] = {RB_ENERGY_IMPACTS, RB_ENERGY_IMPACT_FRICTION,
	                                              RB_ENERGY_SLIDING, RB_ENERGY_DRAG};
	double lost = n->e.row[RB_ENERGY_APPLIED] + n->e.row[RB_ENERGY_DRIVEN] +
	              n->e.row[RB_ENERGY_CALLBACKS];
	double taken = 0;

	double *const row = n->e.row;
	/*
	 * friction within an impact can make the normal impulse give energy: only their sum
	 * dissipates
	 */
	if (row[RB_ENERGY_IMPACTS] + row[RB_ENERGY_IMPACT_FRICTION] < 0)
		row[RB_ENERGY_IMPACTS] = row[RB_ENERGY_IMPACT_FRICTION] = 0;
	row[RB_ENERGY_SLIDING] = fmax(0, row[RB_ENERGY_SLIDING]);
	row[RB_ENERGY_DRAG] = fmax(0, row[RB_ENERGY_DRAG]);
	for (size_t k = 0; k < sizeof taker / sizeof taker[0]; k++)
		taken += row[taker[k]];
	if (!(taken > 0) || n->world->stepped->solver.joints_store ||
	    (n->world->model->features & RB_FEATURES_VARIED & ~(rb_features)RB_FEATURE_DRAG))
		return;
	lost -= row[RB_ENERGY_JOINT_FRICTION] + row[RB_ENERGY_DAMPING];
	for (int k = 0; k < n->member_count; k++)
		if (is_in(n, n->member[k]) && may_lose(n, &n->tally->body[n->member[k]]))
			lost += lost_by(n, n->member[k]);
	for (size_t k = 0; k < sizeof taker / sizeof taker[0] && taken > lost; k++)
		row[taker[k]] *= fmax(0, lost) / taken;
}

struct rb_entries rb_step_ledger_enter(struct rb_world *world, const struct rb_cohort *cohort,
                                       const struct rb_state *before, double start, double h,
                                       const unsigned char *skip)
{
	const struct rb_stepped *s = world->stepped;
	const bool all = cohort == &s->all;
	struct entering n = {.world = world,
	                     .cohort = cohort,
	                     .tally = s->tally,
	                     .before = before,
	                     .skip = skip,
	                     .member = all ? s->body : cohort->body,
	                     .member_count = all ? s->member_count : cohort->member_count,
	                     .pass = {.world = world, .start_s = start, .dt_s = h, .h_s = h}};

	for (int k = 0; k < n.member_count; k++)
		if (is_in(&n, n.member[k]))
			enter_body(&n, n.member[k]);
	enter_weights(&n, RB_MOMENTUM_APPLIED, h, &n.all);
	if (n.resting.count > 0)
		enter_weights(&n, holder(&n), -h, &n.resting);
	enter_points(&n);
	for (size_t k = 0; k < cohort->ledger_impact_count; k++)
		if (is_in(&n, cohort->ledger_impact[k].a))
			enter_impact(&n, &cohort->ledger_impact[k]);
	enter_elements(&n);
	enter_joints(&n);
	limit_dissipation(&n);
	return n.e;
}
