/* SPDX-License-Identifier: MIT */
/*
 * The scales follow from the scene alone: a typical body's size, speed and weight.
 */
#include "film/arrows.h"

#include <math.h>

#include "flow/joint_view.h"
#include "force/spring.h"
#include "math/quat.h"
#include "math/vec3.h"
#include "model/center.h"

/* Lengths of arrows in diameters of a typical body: of a usual speed, of its weight. */
static const double SPEED_SIZES = 1.5, WEIGHT_SIZES = 1;
/* Of the mean distance of bodies, counted as a diameter where bodies are smaller than that. */
static const double DISTANCE_PART = 0.25;

static const double colours[RB_VECTORS_COUNT][3] = {
	[RB_ARROWS_VELOCITY] = {1.00, 0.80, 0.10},
	[RB_ARROWS_CONTACT] = {0.93, 0.16, 0.30},
	[RB_ARROWS_JOINT] = {0.62, 0.20, 0.85},
	[RB_ARROWS_SPRING] = {0.10, 0.62, 0.25},
	[RB_ARROWS_ANGULAR_VELOCITY] = {0.10, 0.75, 0.90},
	[RB_ARROWS_ACCELERATION] = {0.95, 0.45, 0.75},
	[RB_ARROWS_MOMENTUM] = {0.15, 0.35, 0.95},
	[RB_ARROWS_FORCE] = {0.98, 0.50, 0.10},
};

/* ---- scales ---- */

/*
 * Mean distance of moving bodies at the start, m: the longest side of the box around their places,
 * which is divided among as many as are beside each other in a cube of them.
 */
static double usual_distance(const struct rb_model *model)
{
	double low[3], high[3], longest = 0;

	for (int i = 0; i < model->body_count; i++) {
		const rb_vec3 p = model->position[i];
		const double at[3] = {p.x, p.y, p.z};
		for (int k = 0; k < 3; k++) {
			low[k] = i > 0 ? fmin(low[k], at[k]) : at[k];
			high[k] = i > 0 ? fmax(high[k], at[k]) : at[k];
			longest = fmax(longest, high[k] - low[k]);
		}
	}
	return longest / cbrt(fmax(model->body_count, 1));
}

/*
 * Typical speed, m/s: the fastest at the start, or a fall over two diameters; else 40 diameters in
 * the whole run.
 */
static double usual_speed(const struct rb_model *model, double size)
{
	const struct rb_scene *scene = model->scene;
	double fastest = 2 * sqrt(rb_vec3_length(scene->world.gravity) * size);

	for (int i = 0; i < model->body_count; i++)
		fastest = fmax(fastest, rb_vec3_length(scene->bodies[model->id_of[i]].velocity));
	return fastest > 0 ? fastest : 40 * size / model->duration_s;
}

/* Mean mass of the bodies that have one, kg. */
static double usual_mass(const struct rb_model *model)
{
	double mass = 0;
	int count = 0;

	for (int i = 0; i < model->body_count; i++)
		if (isfinite(model->mass[i])) {
			mass += model->mass[i];
			count++;
		}
	return mass / fmax(count, 1);
}

/*
 * Typical force, N: mean weight; else the strongest applied force; else what reverses the typical
 * speed within a diameter.
 */
static double usual_force(const struct rb_model *model, double size, double speed, double mass)
{
	const struct rb_scene *scene = model->scene;
	double applied = 0;

	const double weight = mass * rb_vec3_length(scene->world.gravity) +
	                      rb_vec3_length(scene->world.gravity_force);
	for (int k = 0; k < scene->force_count; k++)
		applied = fmax(applied, rb_vec3_length(scene->forces[k].vector));
	return weight > 0 ? weight : applied > 0 ? applied : mass * speed * speed / size;
}

struct rb_arrow_scales rb_arrow_scales_of(const struct rb_bodies_setup *setup)
{
	/* of planets on their orbits arrows as long as planets would not be seen */
	const double diameter = setup->looks->size_m;
	const double size = fmax(diameter, DISTANCE_PART * usual_distance(setup->model));
	const double speed = usual_speed(setup->model, size);
	const double mass = usual_mass(setup->model);
	const double force = usual_force(setup->model, size, speed, mass);
	const double per_speed = speed > 0 ? SPEED_SIZES * size / speed : 0;
	const double per_force = force > 0 ? WEIGHT_SIZES * size / force : 0;
	struct rb_arrow_scales scales = {
		.per = {[RB_ARROWS_VELOCITY] = per_speed,
	                [RB_ARROWS_CONTACT] = per_force,
	                [RB_ARROWS_JOINT] = per_force,
	                [RB_ARROWS_SPRING] = per_force,
	                [RB_ARROWS_ANGULAR_VELOCITY] = 0.5 * diameter * per_speed, /* of the rim */
	                [RB_ARROWS_ACCELERATION] = per_force * mass,
	                [RB_ARROWS_MOMENTUM] = mass > 0 ? per_speed / mass : 0,
	                [RB_ARROWS_FORCE] = per_force}};

	for (int kind = 0; kind < RB_VECTORS_COUNT; kind++)
		if (setup->camera->arrows[kind].scale > 0)
			scales.per[kind] = setup->camera->arrows[kind].scale;
	return scales;
}

/* ---- gathering ---- */

struct gather {
	const struct rb_bodies_setup *setup;
	const struct rb_model *model;
	const struct rb_frame *frame;
	rb_arrow_put *put;
	void *user;
	int kind;
	double per;
};

/* Whether arrows of the kind are wanted for a body, by its id. */
static bool is_chosen(const struct gather *g, int id)
{
	const struct rb_arrows_def *const arrows = &g->setup->camera->arrows[g->kind];

	for (int k = 0; k < arrows->body_count; k++)
		if (arrows->bodies[k] == id)
			return true;
	return arrows->body_count == 0;
}

static void put(const struct gather *g, rb_vec3 from, rb_vec3 vector)
{
	g->put(g->user, from, rb_vec3_add_scaled(from, g->per, vector), colours[g->kind]);
}

/* Arrows of a column, from centres of mass; of momentum that of velocity times mass. */
static void add_column(const struct gather *g, const double *column)
{
	for (int i = 0; column && i < g->model->body_count; i++) {
		const int id = g->model->id_of[i];
		const rb_pose pose = rb_view_pose(g->model, g->frame, id);
		rb_vec3 vector = rb_vec3_from(column + 3 * i);

		if (!g->setup->looks->of[i].visible || !is_chosen(g, id))
			continue;
		if (g->kind == RB_ARROWS_MOMENTUM) {
			if (!isfinite(g->model->mass[i]))
				continue;
			vector = rb_vec3_scale(g->model->mass[i], vector);
		}
		put(g, rb_model_center(g->model, i, pose.position, pose.orientation), vector);
	}
}

/* Forces on b in lasting contacts. */
static void add_contacts(const struct gather *g)
{
	for (int k = 0; k < g->frame->contact_count; k++) {
		const struct rb_frame_contact *contact = &g->frame->contacts[k];

		if (is_chosen(g, contact->a) || is_chosen(g, contact->b))
			put(g, contact->point, contact->force);
	}
}

/* What joints do to b. */
static void add_joints(const struct gather *g)
{
	const struct rb_scene *scene = g->model->scene;
	struct rb_joint_place place;

	for (int k = 0; g->frame->joint_force && k < g->frame->joint_count; k++)
		if (rb_joint_place(g->model, g->frame, k, &place) &&
		    (is_chosen(g, scene->joints[k].a) || is_chosen(g, scene->joints[k].b)))
			put(g, place.b, rb_vec3_from(g->frame->joint_force + 3 * (size_t)k));
}

/* m/s, of a point of a body; zero if it never moves or the frame does not tell. */
static rb_vec3 velocity_at(const struct gather *g, int id, rb_vec3 point)
{
	const struct rb_frame *frame = g->frame;
	const int i = g->model->index_of[id];

	if (i >= g->model->body_count || !frame->velocity)
		return (rb_vec3){0, 0, 0};
	const rb_vec3 velocity = rb_vec3_from(frame->velocity + 3 * i);
	if (!frame->angular_velocity)
		return velocity;
	const rb_pose pose = rb_view_pose(g->model, frame, id);
	const rb_vec3 arm = rb_vec3_sub(
		point, rb_model_center(g->model, i, pose.position, pose.orientation));
	return rb_vec3_add(velocity,
	                   rb_vec3_cross(rb_vec3_from(frame->angular_velocity + 3 * i), arm));
}

/* What springs do to b. */
static void add_springs(const struct gather *g)
{
	const int count = rb_scene_element_count(g->model->scene, &rb_force_spring);
	rb_vec3 end[2];

	for (int k = 0; k < count; k++) {
		const struct rb_spring_def *spring = rb_scene_spring(g->model->scene, k);

		if (!rb_spring_ends(g->model, g->frame, k, end) ||
		    (!is_chosen(g, spring->a) && !is_chosen(g, spring->b)))
			continue;
		const rb_vec3 span = rb_vec3_sub(end[1], end[0]);
		const rb_vec3 way = rb_vec3_unit(span, (rb_vec3){0, 0, 0});
		const rb_vec3 closing = rb_vec3_sub(velocity_at(g, spring->a, end[0]),
		                                    velocity_at(g, spring->b, end[1]));
		const double push = spring->damping * rb_vec3_dot(closing, way) -
		                    spring->stiffness *
		                            (rb_vec3_length(span) - spring->rest_length_m);
		put(g, end[1], rb_vec3_scale(push, way));
	}
}

void rb_arrows_each(const struct rb_bodies_setup *setup, const struct rb_arrow_scales *scales,
                    const struct rb_frame *frame, rb_arrow_put *put_one, void *user)
{
	const double *const column[RB_VECTORS_COUNT] = {
		[RB_ARROWS_VELOCITY] = frame->velocity,
		[RB_ARROWS_ANGULAR_VELOCITY] = frame->angular_velocity,
		[RB_ARROWS_ACCELERATION] = frame->acceleration,
		[RB_ARROWS_MOMENTUM] = frame->velocity,
		[RB_ARROWS_FORCE] = frame->force};

	for (int kind = 0; kind < RB_VECTORS_COUNT; kind++) {
		const struct gather g = {setup, setup->model,     frame, put_one, user,
		                         kind,  scales->per[kind]};

		if (!(setup->camera->vectors & 1u << kind))
			continue;
		if (kind == RB_ARROWS_CONTACT)
			add_contacts(&g);
		else if (kind == RB_ARROWS_JOINT)
			add_joints(&g);
		else if (kind == RB_ARROWS_SPRING)
			add_springs(&g);
		else
			add_column(&g, column[kind]);
	}
}
