/* SPDX-License-Identifier: MIT */
/* Small worlds built in C, without Lua, for the tests of physics. */
#ifndef RB_TESTS_WORLDS_H
#define RB_TESTS_WORLDS_H

#include <rbsim/world.h>

#include <rbsim/model.h>

#include "math/vec3.h"
#include "support.h"

struct lab {
	struct rb_scene scene;
	struct rb_model *model;
	struct rb_world *world;
	struct rb_error error;
};

static inline void lab_open(struct lab *lab, double duration, double frame_rate)
{
	*lab = (struct lab){0};
	assert_int_equal(rb_scene_init(&lab->scene, &lab->error), RB_OK);
	lab->scene.world.duration_s = duration;
	lab->scene.world.frame_rate = frame_rate;
}

static inline void lab_close(struct lab *lab)
{
	rb_world_destroy(lab->world);
	rb_model_destroy(lab->model);
	rb_scene_release(&lab->scene);
}

/* The plain material's friction and restitution. */
static inline void lab_surface(struct lab *lab, double friction, double restitution)
{
	lab->scene.materials[0].friction = friction;
	lab->scene.materials[0].restitution = restitution;
}

static inline int lab_add(struct lab *lab, const struct rb_body_def *def)
{
	int id = -1;

	assert_int_equal(rb_scene_add_body(&lab->scene, def, &id, &lab->error), RB_OK);
	return id;
}

static inline struct rb_body_def lab_sphere_def(double radius, double mass, rb_vec3 position,
                                                rb_vec3 velocity)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = "sphere";
	def.shape.kind = RB_SHAPE_SPHERE;
	def.shape.radius = radius;
	def.mass = mass;
	def.position = position;
	def.velocity = velocity;
	return def;
}

static inline int lab_sphere(struct lab *lab, double radius, double mass, rb_vec3 position,
                             rb_vec3 velocity)
{
	const struct rb_body_def def = lab_sphere_def(radius, mass, position, velocity);

	return lab_add(lab, &def);
}

static inline int lab_plane(struct lab *lab, rb_vec3 point, rb_vec3 normal)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = "plane";
	def.shape.kind = RB_SHAPE_PLANE;
	def.position = point;
	def.orientation = rb_plane_orientation(normal, (rb_vec3){NAN, 0, 0});
	def.is_static = true;
	return lab_add(lab, &def);
}

static inline int lab_rectangle(struct lab *lab, rb_vec3 point, rb_vec3 normal, double w, double h)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = "plane";
	def.shape.kind = RB_SHAPE_RECTANGLE;
	def.shape.size[0] = w;
	def.shape.size[1] = h;
	def.position = point;
	def.orientation = rb_plane_orientation(normal, (rb_vec3){NAN, 0, 0});
	def.is_static = true;
	return lab_add(lab, &def);
}

static inline void lab_seal(struct lab *lab, int threads)
{
	const struct rb_world_options options = {
		.threads = threads, .keep_events = true, .keep_contacts = true};

	if (rb_model_create(&lab->model, &lab->scene, NULL, &lab->error) != RB_OK)
		fail_msg("model: %s", lab->error.text);
	if (rb_world_create(&lab->world, lab->model, &options, NULL, &lab->error) != RB_OK)
		fail_msg("world: %s", lab->error.text);
}

static inline void lab_step(struct lab *lab)
{
	if (rb_world_step_frame(lab->world, &lab->error) != RB_OK)
		fail_msg("t = %g: %s", rb_world_time(lab->world), lab->error.text);
}

/* To the end of the run. */
static inline void lab_run(struct lab *lab)
{
	while (rb_world_frame(lab->world) + 1 < rb_world_frame_count(lab->world))
		lab_step(lab);
}

#endif
