/* SPDX-License-Identifier: MIT */
/*
 * The columns are a macro list, because four functions must agree on them: what is counted against
 * memory (rb_frame_bytes) is exactly what is allocated. A column that the model cannot change is
 * NULL, and readers take the value from the model.
 */
#include "flow/frame.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "model/joints.h"

/* Room at the start: a scene with few impacts never grows it. */
enum { EVENTS_AT_START = 16, CONTACTS_AT_START = 16 };

/* Columns of a frame, one row each. */
#define COLUMNS(X)                                                \
	X(RB_FIELD_POSITION, position, 3)                         \
	X(RB_FIELD_ORIENTATION, orientation, 4)                   \
	X(RB_FIELD_VELOCITY, velocity, 3)                         \
	X(RB_FIELD_ANGULAR_VELOCITY, angular_velocity, 3)         \
	X(RB_FIELD_ACCELERATION, acceleration, 3)                 \
	X(RB_FIELD_ANGULAR_ACCELERATION, angular_acceleration, 3) \
	X(RB_FIELD_FORCE, force, 3)                               \
	X(RB_FIELD_TORQUE, torque, 3)

/* Those of joints. */
#define JOINT_COLUMNS(X)  \
	X(joint_value, 1) \
	X(joint_speed, 1) \
	X(joint_force, 3) \
	X(joint_torque, 3)

const char *rb_event_kind_name(enum rb_event_kind kind)
{
	static const char *const names[RB_EVENT_KIND_COUNT] = {
		[RB_EVENT_COLLISION] = "collision",
		[RB_EVENT_REST] = "rest",
		[RB_EVENT_SLIDE] = "slide",
		[RB_EVENT_ROLL] = "roll",
		[RB_EVENT_LIFT] = "lift",
		[RB_EVENT_EDGE] = "edge",
		[RB_EVENT_MERGE] = "merge",
		[RB_EVENT_IMPULSE] = "impulse",
		[RB_EVENT_ANGULAR_IMPULSE] = "angular_impulse",
		[RB_EVENT_DISPLACEMENT] = "displacement",
		[RB_EVENT_LIMIT] = "limit",
		[RB_EVENT_TAUT] = "taut",
		[RB_EVENT_SLACK] = "slack",
		[RB_EVENT_DRIVES] = "drives",
		[RB_EVENT_SLIPS] = "slips",
	};

	RB_ASSERT(kind < RB_EVENT_KIND_COUNT);
	return names[kind];
}

static size_t joints_of(const struct rb_model *model)
{
	return model->joints ? (size_t)model->joints->count : 0;
}

unsigned rb_frame_fields(const struct rb_model *model, unsigned fields)
{
	if (!(model->features & RB_FEATURE_ROTATION))
		fields &= ~(unsigned)(RB_FIELD_ORIENTATION | RB_FIELD_ANGULAR_VELOCITY |
		                      RB_FIELD_ANGULAR_ACCELERATION | RB_FIELD_TORQUE);
	if (joints_of(model) == 0)
		fields &= ~(unsigned)RB_FIELD_JOINTS;
	return fields;
}

/* Probes of the scene; a model of a test may have none. */
static size_t probe_count(const struct rb_model *model)
{
	return model->scene ? (size_t)model->scene->probe_count : 0;
}

size_t rb_frame_bytes(const struct rb_model *model, unsigned fields)
{
	const unsigned wanted = rb_frame_fields(model, fields);
	size_t doubles = 0;

	RB_ASSERT(model->body_count >= 0);
#define X(field, name, width) doubles += wanted & (field) ? (size_t)(width) : 0;
	COLUMNS(X)
#undef X
	doubles *= (size_t)model->body_count;
#define X(name, width) doubles += wanted & RB_FIELD_JOINTS ? (width)*joints_of(model) : 0;
	JOINT_COLUMNS(X)
#undef X
	return (doubles + probe_count(model)) * sizeof(double);
}

enum rb_status rb_frame_init(struct rb_frame *frame, const struct rb_model *model, unsigned fields,
                             struct rb_error *err)
{
	const unsigned wanted = rb_frame_fields(model, fields);
	const size_t count = (size_t)model->body_count;
	bool failed = false;

	const size_t joints = joints_of(model);

	*frame = (struct rb_frame){.body_count = model->body_count, .joint_count = (int)joints};
#define X(field, name, width) \
	if (wanted & (field)) \
		failed |= !(frame->name = rb_memory_take(count, (width) * sizeof(double)));
	COLUMNS(X)
#undef X
	if (probe_count(model) > 0) {
		frame->probe_count = (int)probe_count(model);
		frame->probes = rb_memory_take(probe_count(model), sizeof *frame->probes);
		failed |= !frame->probes;
	}
#define X(name, width)                \
	if (wanted & RB_FIELD_JOINTS) \
		failed |= !(frame->name = rb_memory_take(joints, (width) * sizeof(double)));
	JOINT_COLUMNS(X)
#undef X
	if (wanted & RB_FIELD_EVENTS) {
		frame->events = rb_memory_take(EVENTS_AT_START, sizeof *frame->events);
		frame->event_capacity = EVENTS_AT_START;
		failed |= !frame->events;
	}
	if (wanted & RB_FIELD_CONTACTS) {
		frame->contacts = rb_memory_take(CONTACTS_AT_START, sizeof *frame->contacts);
		frame->contact_capacity = CONTACTS_AT_START;
		failed |= !frame->contacts;
	}
	if (failed) {
		rb_frame_release(frame);
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "cannot hold a frame of %zu bodies: out of memory", count);
	}
	return RB_OK;
}

void rb_frame_release(struct rb_frame *frame)
{
#define X(field, name, width) rb_memory_free(frame->name);
	COLUMNS(X)
#undef X
	rb_memory_free(frame->probes);
#define X(name, width) rb_memory_free(frame->name);
	JOINT_COLUMNS(X)
#undef X
	rb_memory_free(frame->events);
	rb_memory_free(frame->contacts);
	rb_memory_free(frame->shots);
	*frame = (struct rb_frame){0};
}

enum rb_status rb_frame_init_all(struct rb_frame *frames, int count, const struct rb_model *model,
                                 unsigned fields, struct rb_error *err)
{
	const unsigned wanted = rb_frame_fields(model, fields);
	const size_t bodies = (size_t)model->body_count;
	unsigned of_bodies = 0;
	bool failed = false;

	RB_ASSERT(count > 0);
	memset(frames, 0, (size_t)count * sizeof *frames);
#define X(field, name, width) of_bodies |= (field);
	COLUMNS(X)
#undef X
	for (int i = 0; i < count; i++) {
		const enum rb_status status = rb_frame_init(&frames[i], model, fields & ~of_bodies,
		                                            err);
		if (status) {
			rb_frame_release_all(frames, i);
			return status;
		}
	}
#define X(field, name, width)                                                                      \
	if (wanted & (field)) {                                                                    \
		frames[0].name = rb_memory_take((size_t)count * bodies, (width) * sizeof(double)); \
		failed |= !frames[0].name;                                                         \
		for (int i = 1; i < count && frames[0].name; i++)                                  \
			frames[i].name = frames[0].name + (size_t)i * bodies * (width);            \
	}
	COLUMNS(X)
#undef X
	if (failed) {
		rb_frame_release_all(frames, count);
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "cannot hold %d frames of %zu bodies: out of memory", count, bodies);
	}
	return RB_OK;
}

void rb_frame_release_all(struct rb_frame *frames, int count)
{
	for (int i = count - 1; i >= 0; i--) {
		/* a reader may have given a frame columns of its own, which are that frame's */
#define X(field, name, width)                                                                    \
	if (i > 0 && frames[0].name &&                                                           \
	    frames[i].name ==                                                                    \
	            frames[0].name + (size_t)i * (size_t)frames[i].body_count * (size_t)(width)) \
		frames[i].name = NULL;
		COLUMNS(X)
#undef X
		rb_frame_release(&frames[i]);
	}
}

enum rb_status rb_frame_add_shot(struct rb_frame *frame, const struct rb_frame_shot *shot,
                                 struct rb_error *err)
{
	size_t capacity = (size_t)frame->shot_capacity;

	RB_ASSERT(frame->shot_count >= 0 && frame->shot_count <= frame->shot_capacity);
	if (!rb_memory_reserve(&frame->shots, &capacity, (size_t)frame->shot_count + 1,
	                       sizeof *frame->shots))
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot hold a frame: out of memory");
	RB_ASSERT(capacity <= INT32_MAX);
	frame->shot_capacity = (int)capacity;
	frame->shots[frame->shot_count++] = *shot;
	return RB_OK;
}
