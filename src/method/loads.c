/* SPDX-License-Identifier: MIT */
/*
 * Forces and accelerations at a time, on demand. While motion is located the engine itself computes
 * them; while it is stepped, a second engine that never runs evaluates external forces, so that
 * both methods report by the same functions. Contact forces before the first step come from a
 * separate world that takes that step.
 */
#include "method/loads.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "located/driven.h"
#include "located/engine.h"
#include "located/engine_create.h"
#include "located/inspect.h"
#include "located/mechanics.h"
#include "located/external_force.h"
#include "classic/classic.h"
#include "method/numbers.h"
#include "stepped/joint_steps.h"
#include "stepped/stepped.h"
#include "model/descriptor.h"
#include "world/joint_state.h"

struct rb_loads {
	bool known; /* the arrays below are those of `moment` */
	uint64_t moment;
	rb_vec3 *force, *torque;     /* of contacts and joints, by index, also of static bodies */
	struct rb_contacts contacts; /* scratch */
	struct rb_located *
		/*
		 * owned: the engine that evaluates external forces while none is located; NULL
		 * until needed
		 */
		observer;
	struct rb_pose *pose;            /* [bodies], of all while motion is stepped */
	struct rb_external_parts *parts; /* [bodies], of which one row is used */
};

static void release(struct rb_loads *loads)
{
	rb_engine_destroy(loads->observer);
	rb_contacts_release(&loads->contacts);
	rb_memory_free(loads->force);
	rb_memory_free(loads->torque);
	rb_memory_free(loads->pose);
	rb_memory_free(loads->parts);
}

void rb_loads_destroy(struct rb_loads *loads)
{
	if (!loads)
		return;
	release(loads);
	rb_memory_free(loads);
}

/* Allocates on the first call. */
static enum rb_status create(struct rb_world *world, struct rb_error *err)
{
	const size_t n = (size_t)world->model->body_count;
	const size_t all = n + (size_t)world->model->static_count;
	struct rb_loads *loads = rb_memory_take(1, sizeof *loads);
	enum rb_status status = RB_OK;

	if (!loads)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the forces on %zu bodies", all);
	loads->force = rb_memory_take(all, sizeof *loads->force);
	loads->torque = rb_memory_take(all, sizeof *loads->torque);
	loads->pose = rb_memory_take(n + 1, sizeof *loads->pose);
	loads->parts = rb_memory_take(n + 1, sizeof *loads->parts);
	if (!loads->force || !loads->torque || !loads->pose || !loads->parts)
		status = RB_FAIL(err, RB_ERR_MEMORY, "no memory for the forces on %zu bodies", all);
	if (status != RB_OK) {
		rb_loads_destroy(loads);
		return status;
	}
	world->loads = loads;
	return RB_OK;
}

/* ---- contacts ---- */

/* True if the present motion is located. */
static bool is_located(const struct rb_world *world)
{
	return world->located && world->located->started;
}

/* Centre of mass of a moving body, origin of a static one. */
static rb_vec3 center_of(const struct rb_world *world, int i)
{
	return i < world->model->body_count ? rb_world_row3(world->state.position, i)
	                                    : world->model->position[i];
}

static void add(rb_vec3 *to, double sign, rb_vec3 more)
{
	*to = rb_vec3_add_scaled(*to, sign, more);
}

/* Adds the load of a joint: on a the opposite of that on b, at the same point. */
static void gather_joint(struct rb_loads *loads, const struct rb_world *world, int k)
{
	const struct rb_joint *joint = &world->model->joints->joint[k];
	const struct rb_wrench *load = &world->joint_load[k];
	const struct rb_pose pose = joint->b < 0 ? rb_linkage_world()
	                                         : rb_world_pose(world, &world->state, joint->b);
	const rb_vec3 point = rb_linkage_point_b(&joint->link, &pose);
	const int end[2] = {joint->a, joint->b};

	for (int side = 0; side < 2; side++) {
		const double sign = side ? 1 : -1;

		if (end[side] < 0)
			continue;
		const rb_vec3 arm = rb_vec3_sub(point, center_of(world, end[side]));
		add(&loads->force[end[side]], sign, load->force);
		add(&loads->torque[end[side]], sign, load->torque);
		add(&loads->torque[end[side]], sign, rb_vec3_cross(arm, load->force));
	}
}

/* Sums the forces and torques of contacts and joints over each body, N and N m. */
static void gather(struct rb_loads *loads, const struct rb_world *world)
{
	const int all = world->model->body_count + world->model->static_count;

	for (int i = 0; i < all; i++)
		loads->force[i] = loads->torque[i] = (rb_vec3){0, 0, 0};
	for (size_t k = 0; k < loads->contacts.count; k++) {
		const struct rb_contact *c = &loads->contacts.row[k];
		const rb_vec3 force = rb_vec3_add_scaled(c->tangent_force, c->normal_force,
		                                         c->normal);
		const int pair[2] = {c->a, c->b};

		for (int side = 0; side < 2; side++) {
			const int i = pair[side];
			RB_ASSERT_COSTLY(i >= 0 && i < all);
			const rb_vec3 arm = rb_vec3_sub(c->point, center_of(world, i));

			add(&loads->force[i], side ? 1 : -1, force);
			add(&loads->torque[i], side ? 1 : -1, rb_vec3_cross(arm, force));
		}
	}
	for (int k = 0; world->joint_load && k < world->model->joints->count; k++)
		gather_joint(loads, world, k);
}

/*
 * Forces of located contacts at the state's time. The engine's own error and status are restored: a
 * report must not fail the run.
 */
static enum rb_status inspect_located(struct rb_located *l, struct rb_contacts *to,
                                      struct rb_error *err)
{
	struct rb_error *const before = l->err;
	const enum rb_status was = l->status;

	l->err = err;
	l->status = RB_OK;
	const enum rb_status status = rb_inspect_forces(l, l->world->state.time_s, to);
	l->err = before;
	l->status = was;
	return status;
}

/* Contacts and joint loads as the world keeps them. */
static enum rb_status copy_kept(struct rb_contacts *to, const struct rb_world *world,
                                struct rb_error *err)
{
	to->count = 0;
	for (int k = 0; world->joint_load && world->stepped && k < world->model->joints->count;
	     k++) {
		struct rb_wrench *const load = &world->joint_load[k];

		*load = (struct rb_wrench){{0, 0, 0}, {0, 0, 0}};
		if (!world->joint[k].released)
			rb_joints_load(world->stepped, k, &load->force, &load->torque);
	}
	return rb_contacts_join(to, world->has_shown ? &world->shown : &world->contacts, err);
}

/* Takes the first step of another world, for the forces at the start. */
static enum rb_status first_step(struct rb_world *other, struct rb_error *err)
{
	const struct rb_model *model = other->model;
	const double from = other->state.time_s;
	const double dt = fmin(model->time_step_s, rb_model_frame_time(model, 1) - from);
	const struct rb_stepper *const steps = rb_model_method_row(model)->steps;
	const enum rb_status status = steps->prepare(other, err);

	return status == RB_OK ? steps->step(other, from, dt, err) : status;
}

/*
 * Forces of contacts and joints before the first step: those of another world with the same state
 * and no callbacks. If its step fails for physical reasons there are none.
 */
static enum rb_status find_initial(struct rb_world *world, struct rb_error *err)
{
	struct rb_contacts *to = &world->loads->contacts;
	const struct rb_world_options options = {.threads = 1, .keep_contacts = true};
	const struct rb_world_hooks hooks = rb_world_hooks_asked(&world->hooks);
	struct rb_world *other;
	enum rb_status status = rb_world_create(&other, world->model, &options, &hooks, err);

	to->count = 0;
	if (status != RB_OK)
		return status;
	rb_state_copy(&other->state, &world->state);
	if (other->located)
		status = rb_engine_advance(other->located, other->state.time_s, err);
	if (status == RB_OK && is_located(other)) {
		status = inspect_located(other->located, to, err);
	} else if (status == RB_OK) {
		status = first_step(other, err);
		if (status == RB_OK)
			status = copy_kept(to, other, err);
	}
	if (world->joint_load)
		memcpy(world->joint_load, other->joint_load,
		       (size_t)world->model->joints->count * sizeof *world->joint_load);
	gather(world->loads, other);
	rb_world_destroy(other);
	return status == RB_ERR_PHYSICS ? RB_OK : status;
}

/* Poses of all bodies for the evaluator. */
static enum rb_status place_all(struct rb_world *world, struct rb_error *err)
{
	struct rb_loads *loads = world->loads;

	if (!loads->observer) {
		const enum rb_status status = rb_engine_create(&loads->observer, world, err);

		if (status != RB_OK)
			return status;
		for (int i = 0; i < world->model->body_count; i++)
			loads->observer->place[i] = i;
	}
	for (int i = 0; i < world->model->body_count; i++)
		loads->pose[i] = rb_world_pose(world, &world->state, i);
	return RB_OK;
}

/* Computes the attraction on all bodies at this time. */
static void attract(struct rb_world *world)
{
	struct rb_loads *loads = world->loads;
	struct rb_located *const l = is_located(world) ? world->located : loads->observer;
	const struct rb_force_query view = {.time_s = world->state.time_s,
	                                    .pose = is_located(world) ? NULL : loads->pose};

	rb_external_attract(l, &view);
}

/* Updates contacts and poses to this time, once for all bodies. */
static enum rb_status refresh(struct rb_world *world, struct rb_error *err)
{
	struct rb_loads *loads = world->loads;
	enum rb_status status;

	if (loads->known && loads->moment == world->moment)
		return RB_OK;
	const bool begins = !world->begun &&
	                    (world->model->features & (RB_FEATURE_CONTACT | RB_FEATURE_JOINTS));
	if (is_located(world))
		status = inspect_located(world->located, &loads->contacts, err);
	else if (begins)
		status = find_initial(world, err);
	else
		status = copy_kept(&loads->contacts, world, err);
	if (status == RB_OK && !is_located(world))
		status = place_all(world, err);
	if (status != RB_OK)
		return status;
	attract(world);
	if (is_located(world) || !begins)
		gather(loads, world);
	loads->moment = world->moment;
	loads->known = true;
	return RB_OK;
}

/* ---- external forces ---- */

/*
 * The engine with which located/external_force evaluates: the running one, whose arcs hold all
 * poses, or the evaluator with the poses of the state.
 */
static struct rb_located *begin_inspection(struct rb_world *world, int i,
                                           struct rb_force_query *view)
{
	struct rb_loads *loads = world->loads;
	struct rb_located *l = is_located(world) ? world->located : loads->observer;

	*view = (struct rb_force_query){.time_s = world->state.time_s,
	                                .active_s = world->state.time_s,
	                                .pose = is_located(world) ? NULL : loads->pose,
	                                .parts = loads->parts,
	                                .attracted = true};
	loads->pose[i] = rb_world_pose(world, &world->state, i);
	l->place[i] = i;
	rb_world_choose_pushes(world);
	return l;
}

/* Removes the body from the running engine's set again. */
static void end_inspection(struct rb_located *l, int i)
{
	if (is_located(l->world))
		l->place[i] = -1;
}

/* Forces on and accelerations of a dynamic body: external forces, then contacts. */
static enum rb_status external(struct rb_world *world, int i, struct rb_load *load,
                               struct rb_error *err)
{
	struct rb_loads *loads = world->loads;
	struct rb_force_query view;
	struct rb_located *l = begin_inspection(world, i, &view);
	struct rb_error *const before = l->err;
	const enum rb_status was = l->status;
	const uint64_t products = l->products;

	l->err = err;
	l->status = RB_OK;
	rb_external_force_at(l, i, &loads->pose[i], &view, &load->acceleration,
	                     &load->angular_acceleration);
	const enum rb_status status = l->status;
	l->err = before;
	l->status = was;
	l->products = products;
	end_inspection(l, i);
	for (int cause = 0; cause < RB_EXTERNAL_CAUSES; cause++) {
		add(&load->force, 1, loads->parts[i].force[cause]);
		add(&load->torque, 1, loads->parts[i].torque[cause]);
	}
	add(&load->force, 1, loads->force[i]);
	add(&load->torque, 1, loads->torque[i]);
	add(&load->acceleration, world->model->inverse_mass[i], loads->force[i]);
	if (world->state.spin)
		add(&load->angular_acceleration, 1,
		    rb_inverse_inertia_apply(l, i, loads->pose[i].orientation, loads->torque[i]));
	return status;
}

/* Adds the attraction of a fixed body by all others. */
static void add_attraction(const struct rb_gravitation *gravitation, int i, struct rb_load *load)
{
	const struct rb_attract *const all = &gravitation->all;

	for (int j = 0; j < gravitation->model->body_count; j++) {
		double factor;
		const rb_vec3 d = rb_attract_between(all, i, j, &factor);

		if (j != i && !isinf(all->inertial[j]))
			add(&load->force, factor * all->inertial[j] * all->mu[i], d);
	}
}

/* Forces of contacts, elements and gravitation on a static or driven body. */
static void add_fixed_load(struct rb_world *world, int i, struct rb_load *load)
{
	const struct rb_model *model = world->model;
	struct rb_located *l = is_located(world) ? world->located : world->loads->observer;
	const struct rb_force_query view = {.time_s = world->state.time_s,
	                                    .pose = is_located(world) ? NULL : world->loads->pose};
	const struct rb_element_view at = {l, &view};
	const struct rb_element_query query = rb_external_query(&at);
	const struct rb_pose pose = query.pose(&query, i);

	load->force = world->loads->force[i];
	load->torque = world->loads->torque[i];
	if (rb_located_gravitates(l))
		add_attraction(&l->gravitation, i, load);
	for (int k = 0; k < model->element_list_count; k++) {
		const struct rb_elements *elements = &model->elements[k];
		struct rb_wrench on;

		for (int m = elements->end ? elements->first[i] : 0;
		     elements->end && m < elements->first[i + 1]; m++) {
			if (!elements->kind->act(&query, rb_elements_row(elements, elements->of[m]),
			                         i, &pose, &on))
				continue;
			add(&load->force, 1, on.force);
			add(&load->torque, 1, on.torque);
		}
	}
}

/* Puts a driven body on the piece of its motion that begins at `t`. */
static enum rb_status start_piece(struct rb_located *l, int i, double t, struct rb_error *err)
{
	rb_driven_release(l);
	l->driven = NULL;
	for (int k = 0; l->piece && k < l->n; k++)
		l->piece[k].piece.n = 0;
	l->err = err;
	l->status = RB_OK;
	rb_driven_piece(l, i, t);
	return l->status;
}

enum rb_status rb_loads_start_driven(struct rb_world *world, struct rb_error *err)
{
	const struct rb_model *model = world->model;
	const double t = world->state.time_s;
	struct rb_located *l;
	struct rb_error own;
	const enum rb_status status = rb_engine_create(&l, world, err);

	if (status != RB_OK)
		return status;
	for (int i = 0; i < model->body_count; i++) {
		const struct rb_body_def *def = &model->scene->bodies[model->id_of[i]];

		if (!model->driven[i] || start_piece(l, i, t, &own) != RB_OK)
			continue;
		if (!def->motion_gives_velocity)
			rb_vec3_to(world->state.velocity + 3 * (size_t)i, rb_arc_velocity(l, i, t));
		if (l->top && def->motion_turns && !def->motion_gives_angular_velocity)
			rb_vec3_to(world->state.spin + 3 * (size_t)i, rb_arc_pose(l, i, t).spin);
	}
	rb_engine_destroy(l);
	return RB_OK;
}

enum rb_status rb_world_load(struct rb_world *world, int id, struct rb_load *load,
                             struct rb_error *err)
{
	RB_ASSERT(id >= 0 && id < world->model->body_count + world->model->static_count);

	const struct rb_model *model = world->model;
	const int i = model->index_of[id];
	enum rb_status status = world->loads ? RB_OK : create(world, err);

	*load = (struct rb_load){.force = {0, 0, 0}};
	if (status == RB_OK)
		status = refresh(world, err);
	if (status != RB_OK)
		return status;
	const bool driven = i < model->body_count && model->driven && model->driven[i];
	if (i < model->body_count && !driven)
		return external(world, i, load, err);
	add_fixed_load(world, i, load);
	if (!driven)
		return RB_OK;
	const double t = world->state.time_s;
	struct rb_located *l = is_located(world) ? world->located : world->loads->observer;

	if (!is_located(world))
		status = start_piece(l, i, t, err);
	if (status != RB_OK)
		return status;
	load->acceleration = rb_arc_acceleration(l, i, t);
	load->angular_acceleration = rb_mechanics_turning(l, i, t);
	return RB_OK;
}

enum rb_status rb_world_joint(struct rb_world *world, int joint, struct rb_joint_reading *now,
                              struct rb_error *err)
{
	enum rb_status status = world->loads ? RB_OK : create(world, err);

	*now = rb_joint_state_now(world, joint);
	if (status == RB_OK)
		status = refresh(world, err);
	if (status != RB_OK)
		return status;
	now->force = world->joint_load[joint].force;
	now->torque = world->joint_load[joint].torque;
	return RB_OK;
}

/* ---- frames ---- */

/* True if a frame asks for loads. */
static bool wants(const struct rb_frame *frame)
{
	return frame->acceleration || frame->angular_acceleration || frame->force || frame->torque;
}

enum rb_status rb_world_fill_frame(struct rb_world *world, struct rb_frame *frame,
                                   struct rb_error *err)
{
	for (int i = 0; wants(frame) && i < world->model->body_count; i++) {
		struct rb_load load;
		const enum rb_status status = rb_world_load(world, world->model->id_of[i], &load,
		                                            err);

		if (status != RB_OK)
			return status;
		if (frame->acceleration)
			rb_vec3_to(frame->acceleration + 3 * (size_t)i, load.acceleration);
		if (frame->angular_acceleration)
			rb_vec3_to(frame->angular_acceleration + 3 * (size_t)i,
			           load.angular_acceleration);
		if (frame->force)
			rb_vec3_to(frame->force + 3 * (size_t)i, load.force);
		if (frame->torque)
			rb_vec3_to(frame->torque + 3 * (size_t)i, load.torque);
	}
	for (int k = 0; frame->joint_value && k < frame->joint_count; k++) {
		struct rb_joint_reading now;
		const enum rb_status status = rb_world_joint(world, k, &now, err);

		if (status != RB_OK)
			return status;
		frame->joint_value[k] = now.angle;
		frame->joint_speed[k] = now.speed;
		rb_vec3_to(frame->joint_force + 3 * (size_t)k, now.force);
		rb_vec3_to(frame->joint_torque + 3 * (size_t)k, now.torque);
	}
	return rb_numbers_fill_frame(world, frame, err);
}
