/* SPDX-License-Identifier: MIT */
/*
 * A run made by hand for tests of the recorder and the reader: no script, no world, frames by a formula.
 *
 * Body i of frame k stands at fake_value(k, i, c): any frame of any file can be checked without having kept it.
 * Owned by one test; fake_release frees it.
 */
#ifndef RB_TESTS_H5SUPPORT_H
#define RB_TESTS_H5SUPPORT_H

#include "base/memory.h"
#include "sink/module.h"
#include "sink/reader.h"
#include "sink/h5file.h"
#include "sink/recorder.h"

struct fake {
	struct rb_scene scene;
	struct rb_model model;
	struct rb_run_info info;
	struct rb_frame frame;
	struct rb_event events[4];
	struct rb_frame_contact contacts[4];
	struct rb_recorder *recorder;
	struct rb_sink sink;
};

/* column 0: position, 1: orientation, 2: velocity, 3: angular velocity; a formula that no two cells share */
static inline double fake_value(uint64_t frame, size_t body, int column, int axis)
{
	return (double)frame * 0.125 + (double)body * 4096.0 + column * 0.03125 + axis * 0.0078125;
}

static inline double *fake_column(struct fake *fake, int width)
{
	return rb_memory_take((size_t)fake->model.body_count * (size_t)width + 1, sizeof(double));
}

/* `bodies` spheres and one static plane with id 1 (or 0 without bodies); `turns`: they can rotate. */
static inline void fake_init(struct fake *fake, int bodies, uint64_t frames, bool turns)
{
	const size_t all = (size_t)bodies + 1;

	*fake = (struct fake){
		.model = {.body_count = bodies, .static_count = 1, .material_count = 1}};
	if (rb_scene_init(&fake->scene, NULL) != RB_OK)
		abort();
	fake->scene.world.title = "made by hand";
	for (int i = 0; i <= bodies; i++) {
		struct rb_body_def def = rb_body_def_default();
		char name[32];
		snprintf(name, sizeof name, "body %d", i);
		def.name = i % 2 == 0 ? name : NULL;
		def.is_static = i == (bodies > 0 ? 1 : 0);
		def.shape = (struct rb_shape){
			.kind = def.is_static ? RB_SHAPE_PLANE : RB_SHAPE_SPHERE, .radius = 0.5};
		if (rb_scene_add_body(&fake->scene, &def, NULL, NULL) != RB_OK)
			abort();
	}
	struct rb_model *const model = &fake->model;
	model->scene = &fake->scene;
	model->features = RB_FEATURE_CONTACT | (turns ? RB_FEATURE_ROTATION : 0u);
	model->id_of = rb_memory_take(all, sizeof *model->id_of);
	model->shape = rb_memory_take(all, sizeof *model->shape);
	model->material = rb_memory_take(all, sizeof *model->material);
	model->mass = rb_memory_take(all, sizeof *model->mass);
	model->inertia = turns ? rb_memory_take(1, sizeof *model->inertia) : NULL;
	model->inertia_of = turns ? rb_memory_take(all, sizeof *model->inertia_of) : NULL;
	model->position = rb_memory_take(all, sizeof *model->position);
	model->orientation = rb_memory_take(all, sizeof *model->orientation);
	model->pair_materials = rb_memory_take(1, sizeof *model->pair_materials);
	for (int i = 0, moving = 0; i <= bodies; i++) {
		const int index = fake->scene.bodies[i].is_static ? bodies : moving++;
		model->id_of[index] = i;
		model->shape[index] = fake->scene.bodies[i].shape;
		model->mass[index] = 1 + index;
		model->orientation[index] = (rb_quat){1, 0, 0, 0};
	}
	model->frame_rate = 60;
	model->frame_count = frames;
	model->duration_s = (double)frames / 60;
	model->time_step_s = 1.0 / 240;
	model->tolerance_m = 1e-6;
	fake->info = (struct rb_run_info){.version = "0.0.0",
	                                  .build = "test",
	                                  .command = "rbsim scene.lua",
	                                  .host = "host",
	                                  .author = "author",
	                                  .started = "2026-01-01T00:00:00Z",
	                                  .threads = 1,
	                                  .method = "classic",
	                                  .rollback = "selective",
	                                  .model = model,
	                                  .scene = &fake->scene};
	fake->frame = (struct rb_frame){.body_count = bodies,
	                                .position = fake_column(fake, 3),
	                                .velocity = fake_column(fake, 3),
	                                .orientation = turns ? fake_column(fake, 4) : NULL,
	                                .angular_velocity = turns ? fake_column(fake, 3) : NULL,
	                                .events = fake->events,
	                                .contacts = fake->contacts,
	                                .event_capacity = 4,
	                                .contact_capacity = 4};
}

static inline void fake_release(struct fake *fake)
{
	rb_recorder_destroy(fake->recorder);
	rb_memory_free(fake->model.id_of);
	rb_memory_free(fake->model.shape);
	rb_memory_free(fake->model.material);
	rb_memory_free(fake->model.mass);
	rb_memory_free(fake->model.inertia);
	rb_memory_free(fake->model.inertia_of);
	rb_memory_free(fake->model.position);
	rb_memory_free(fake->model.orientation);
	rb_memory_free(fake->model.pair_materials);
	rb_memory_free(fake->frame.position);
	rb_memory_free(fake->frame.velocity);
	rb_memory_free(fake->frame.orientation);
	rb_memory_free(fake->frame.angular_velocity);
	rb_scene_release(&fake->scene);
	*fake = (struct fake){0};
}

/* Frame k; k % 3 events and k % 4 contacts come with it. */
static inline const struct rb_frame *fake_frame(struct fake *fake, uint64_t k)
{
	static const int width[] = {3, 4, 3, 3};
	struct rb_frame *const frame = &fake->frame;
	double *const columns[] = {frame->position, frame->orientation, frame->velocity,
	                           frame->angular_velocity};

	frame->index = k;
	frame->time_s = (double)k / 60;
	for (int c = 0; c < 4; c++)
		for (size_t i = 0; columns[c] && i < (size_t)frame->body_count; i++)
			for (int axis = 0; axis < width[c]; axis++)
				columns[c][i * (size_t)width[c] + (size_t)axis] = fake_value(
					k, i, c, axis);
	frame->numbers = (struct rb_frame_numbers){.kinetic_energy = (double)k,
	                                           .potential_energy = -(double)k,
	                                           .momentum = {1, 2, (double)k},
	                                           .max_penetration = 1e-9 * (double)k,
	                                           .contacts = k % 4,
	                                           .collisions = k % 3,
	                                           .rollbacks = 1,
	                                           .substeps = 4,
	                                           .smallest_step = 1.0 / (double)(k + 1)};
	frame->event_count = (int)(k % 3);
	for (int i = 0; i < frame->event_count; i++)
		frame->events[i] = (struct rb_event){
			.time_s = frame->time_s,
			.kind = (enum rb_event_kind)((k + (uint64_t)i) % RB_EVENT_KIND_COUNT),
			.a = i,
			.b = i + 1,
			.normal = {0, 0, 1},
			.impulse = {0, 0, (double)k},
			.approach_speed = (double)(i + 1)};
	frame->contact_count = (int)(k % 4);
	for (int i = 0; i < frame->contact_count; i++)
		frame->contacts[i] = (struct rb_frame_contact){
			.a = i, .b = 7, .force = {0, 0, (double)k}, .gap = -1e-9 * i};
	return frame;
}

/* The sink for `path`, not opened. */
static inline enum rb_status fake_sink(struct fake *fake, const char *path, bool replace,
                                       struct rb_error *err)
{
	const struct rb_recorder_options options = {.path = path, .how = replace};

	return rb_recorder_create(&fake->recorder, &fake->sink, &fake->info, &options, err);
}

static inline enum rb_status fake_open(struct fake *fake, const char *path, bool replace,
                                       struct rb_error *err)
{
	const enum rb_status status = fake_sink(fake, path, replace, err);

	return status ? status : fake->sink.open(fake->sink.self, err);
}

static inline enum rb_status fake_push(struct fake *fake, uint64_t from, uint64_t to,
                                       struct rb_error *err)
{
	enum rb_status status = RB_OK;

	for (uint64_t k = from; k < to && status == RB_OK; k++)
		status = fake->sink.frame(fake->sink.self, fake_frame(fake, k), err);
	return status;
}

static inline enum rb_status fake_close(struct fake *fake, enum rb_status status,
                                        struct rb_error *err)
{
	const struct rb_outcome outcome = {.status = status,
	                                   .reason = status ? "for a test" : "",
	                                   .state_hash = 0x0123456789abcdefu};

	return fake->sink.close(fake->sink.self, &outcome, err);
}

/* The whole of a recording. */
static inline enum rb_status fake_record(struct fake *fake, const char *path, struct rb_error *err)
{
	enum rb_status status = fake_open(fake, path, false, err);

	if (status)
		return status;
	status = fake_push(fake, 0, fake->model.frame_count, err);
	const enum rb_status closed = fake_close(fake, status, status ? NULL : err);
	return status ? status : closed;
}

#endif
