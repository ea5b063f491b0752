/* SPDX-License-Identifier: MIT */
/* Small worlds built in C, without Lua, for the tests of physics. */
#ifndef RB_TESTS_WORLDS_H
#define RB_TESTS_WORLDS_H

#include <rbsim/world.h>

#include <rbsim/model.h>

#include "math/quat.h"
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

static inline void lab_open_located(struct lab *lab, double duration, double frame_rate)
{
	lab_open(lab, duration, frame_rate);
	lab->scene.world.method = RB_METHOD_LOCATED;
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

/* A box of edges `size`, m. */
static inline struct rb_body_def lab_box_def(rb_vec3 size, double mass, rb_vec3 position)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = "box";
	def.shape.kind = RB_SHAPE_BOX;
	rb_vec3_to(def.shape.size, size);
	def.mass = mass;
	def.position = position;
	return def;
}

static inline int lab_box(struct lab *lab, rb_vec3 size, double mass, rb_vec3 position,
                          rb_quat orientation)
{
	struct rb_body_def def = lab_box_def(size, mass, position);

	def.orientation = orientation;
	return lab_add(lab, &def);
}

/* The solid of a table: a plate of 1 m x 0.5 m on two boards. */
static inline int lab_table_solid(struct lab *lab)
{
	struct rb_solid_part part[3];
	int solid = -1;

	for (int k = 0; k < 3; k++) {
		part[k] = (struct rb_solid_part){.orientation = rb_quat_identity, .share = 1};
		part[k].shape.kind = RB_SHAPE_BOX;
		part[k].position = k == 0 ? (rb_vec3){0, 0, 0.25}
		                          : (rb_vec3){k == 1 ? -0.4 : 0.4, 0, -0.05};
		rb_vec3_to(part[k].shape.size,
		           k == 0 ? (rb_vec3){1, 0.5, 0.1} : (rb_vec3){0.1, 0.5, 0.5});
	}
	assert_int_equal(rb_scene_add_union(&lab->scene, part, 3, &solid, &lab->error), RB_OK);
	return solid;
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
	def.orientation = rb_plane_orientation(normal, (rb_vec3){(double)NAN, 0, 0});
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
	def.orientation = rb_plane_orientation(normal, (rb_vec3){(double)NAN, 0, 0});
	def.is_static = true;
	return lab_add(lab, &def);
}

/* `hooks` may be NULL; those of events are announced to the model here. */
static inline void lab_seal_with(struct lab *lab, const struct rb_world_options *options,
                                 const struct rb_world_hooks *hooks)
{
	if (hooks && hooks->step)
		lab->scene.hooks |= RB_HOOK_STEP;
	if (hooks && hooks->collision)
		lab->scene.hooks |= RB_HOOK_COLLISION;
	if (hooks && hooks->transition)
		lab->scene.hooks |= RB_HOOK_TRANSITION;
	if (rb_model_create(&lab->model, &lab->scene, NULL, &lab->error) != RB_OK)
		fail_msg("model: %s", lab->error.text);
	if (rb_world_create(&lab->world, lab->model, options, hooks, &lab->error) != RB_OK)
		fail_msg("world: %s", lab->error.text);
}

static inline void lab_seal(struct lab *lab, int threads)
{
	const struct rb_world_options options = {
		.threads = threads, .keep_events = true, .keep_contacts = true};

	lab_seal_with(lab, &options, NULL);
}

/* What the hooks of collisions and transitions are called with, in that order. */
enum { LAB_LOG_MOST = 40000 };
struct lab_log {
	struct rb_event *row; /* owned: lab_log_close */
	int count;            /* of all, also of those that did not fit */
};

static inline enum rb_status lab_log_event(void *user, struct rb_world *world,
                                           const struct rb_event *event, struct rb_error *err)
{
	struct lab_log *log = user;

	(void)world, (void)err;
	if (log->count < LAB_LOG_MOST)
		log->row[log->count] = *event;
	log->count++;
	return RB_OK;
}

static inline struct rb_world_hooks lab_log_open(struct lab_log *log)
{
	log->count = 0;
	log->row = calloc(LAB_LOG_MOST, sizeof *log->row);
	assert_non_null(log->row);
	return (struct rb_world_hooks){
		.user = log, .collision = lab_log_event, .transition = lab_log_event};
}

static inline void lab_log_close(struct lab_log *log)
{
	free(log->row);
	log->row = NULL;
}

/* The n-th event of that kind, n from 0; NULL: there are fewer. */
static inline const struct rb_event *lab_log_find(const struct lab_log *log,
                                                  enum rb_event_kind kind, int n)
{
	for (int k = 0; k < log->count && k < LAB_LOG_MOST; k++)
		if (log->row[k].kind == kind && n-- == 0)
			return &log->row[k];
	return NULL;
}

static inline int lab_log_count(const struct lab_log *log, enum rb_event_kind kind)
{
	int count = 0;

	for (int k = 0; k < log->count && k < LAB_LOG_MOST; k++)
		count += log->row[k].kind == kind;
	return count;
}

/*
 * A promise that is not kept yet: the test is shown as skipped, with what is missing. RBSIM_OPEN_TESTS=1 runs it all
 * the same.
 */
static inline void lab_open_promise(const char *text)
{
	const char *all = getenv("RBSIM_OPEN_TESTS");

	if (all && strcmp(all, "1") == 0)
		return;
	print_message("not kept yet: %s\n", text);
	skip();
}

static inline void lab_step(struct lab *lab)
{
	if (rb_world_step_frame(lab->world, &lab->error) != RB_OK)
		fail_msg("t = %g: %s", rb_world_time(lab->world), lab->error.text);
}

/* All three components. */
#define assert_vector(found, wanted, tolerance) \
	lab_assert_vector((found), (wanted), (tolerance), #found, __FILE__, __LINE__)

static inline void lab_assert_vector(rb_vec3 found, rb_vec3 wanted, double tolerance,
                                     const char *what, const char *file, int line)
{
	support_assert_near(found.x, wanted.x, tolerance, what, file, line);
	support_assert_near(found.y, wanted.y, tolerance, what, file, line);
	support_assert_near(found.z, wanted.z, tolerance, what, file, line);
}

/* To the end of the run. */
static inline void lab_run(struct lab *lab)
{
	while (rb_world_frame(lab->world) + 1 < rb_world_frame_count(lab->world))
		lab_step(lab);
}

/* A lab on earth whose events are logged. */
struct bench {
	struct lab lab;
	struct lab_log log;
	struct rb_world_hooks hooks;
};

static inline void bench_open(struct bench *bench, double duration, double frame_rate)
{
	lab_open_located(&bench->lab, duration, frame_rate);
	bench->hooks = lab_log_open(&bench->log);
	bench->lab.scene.world.gravity = (rb_vec3){0, 0, -9.81};
}

static inline void bench_seal(struct bench *bench)
{
	const struct rb_world_options options = {.threads = 1};

	lab_seal_with(&bench->lab, &options, &bench->hooks);
}

static inline void bench_close(struct bench *bench)
{
	lab_log_close(&bench->log);
	lab_close(&bench->lab);
}

static inline const struct rb_event *bench_event(const struct bench *bench, enum rb_event_kind kind,
                                                 int n)
{
	const struct rb_event *event = lab_log_find(&bench->log, kind, n);

	if (!event)
		fail_msg("no '%s' number %d among %d events", rb_event_kind_name(kind), n,
		         bench->log.count);
	return event;
}

/* In the coordinate plane across the axis 0, 1, 2; -1: as it is. */
static inline rb_vec3 mirrored(rb_vec3 v, int axis)
{
	if (axis == 0)
		v.x = -v.x;
	if (axis == 1)
		v.y = -v.y;
	if (axis == 2)
		v.z = -v.z;
	return v;
}

/* A pseudovector: the other components change their sign. */
static inline rb_vec3 mirrored_spin(rb_vec3 v, int axis)
{
	return axis < 0 ? v : rb_vec3_neg(mirrored(v, axis));
}

#endif
