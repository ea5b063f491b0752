/* SPDX-License-Identifier: MIT */
#include "flow/between.h"

#include <stdbool.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "flow/frame.h"
#include "math/quat.h"
#include "math/vec3.h"

/* A column of `to` as it is in `from`: absent there, absent here. */
static bool copy_column(double **to, const double *from, int old_count, int count, int width)
{
	if (!from || (*to && old_count != count)) {
		rb_memory_free(*to);
		*to = NULL;
	}
	if (!from)
		return true;
	if (!*to)
		*to = rb_memory_take((size_t)count, (size_t)width * sizeof **to);
	if (!*to)
		return false;
	memcpy(*to, from, (size_t)count * (size_t)width * sizeof **to);
	return true;
}

/* A list that is kept for the next time, however short this one is. */
static bool copy_list(void *list_address, int *capacity, const void *from, int count, size_t size)
{
	void *list;
	size_t room = (size_t)*capacity;

	memcpy(&list, list_address, sizeof list);
	if (count == 0)
		return true;
	if (!rb_memory_reserve(&list, &room, (size_t)count, size))
		return false;
	*capacity = (int)room;
	memcpy(list_address, &list, sizeof list);
	memcpy(list, from, (size_t)count * size);
	return true;
}

enum rb_status rb_frame_copy(struct rb_frame *to, const struct rb_frame *from, struct rb_error *err)
{
	const int had = to->body_count, count = from->body_count;
	bool held = true;

	held &= copy_column(&to->position, from->position, had, count, 3);
	held &= copy_column(&to->orientation, from->orientation, had, count, 4);
	held &= copy_column(&to->velocity, from->velocity, had, count, 3);
	held &= copy_column(&to->angular_velocity, from->angular_velocity, had, count, 3);
	held &= copy_list(&to->events, &to->event_capacity, from->events, from->event_count,
	                  sizeof *to->events);
	held &= copy_list(&to->contacts, &to->contact_capacity, from->contacts, from->contact_count,
	                  sizeof *to->contacts);
	held &= copy_list(&to->shots, &to->shot_capacity, from->shots, from->shot_count,
	                  sizeof *to->shots);
	if (!held) {
		rb_frame_release(to);
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "cannot copy a frame of %d bodies: out of memory", count);
	}
	to->index = from->index;
	to->time_s = from->time_s;
	to->body_count = count;
	to->numbers = from->numbers;
	to->event_count = from->event_count;
	to->contact_count = from->contact_count;
	to->shot_count = from->shot_count;
	return RB_OK;
}

static double mix(double a, double b, double part)
{
	return a + part * (b - a);
}

static rb_vec3 mix_vec3(rb_vec3 a, rb_vec3 b, double part)
{
	return (rb_vec3){mix(a.x, b.x, part), mix(a.y, b.y, part), mix(a.z, b.z, part)};
}

static void mix_column(double *out, const double *a, int count, double part)
{
	for (int i = 0; i < count; i++)
		out[i] = mix(a[i], out[i], part);
}

/* The shortest turn that the unit quaternion stands for, as a rotation vector. */
static rb_vec3 turn_of(rb_quat q)
{
	if (q.w < 0)
		q = (rb_quat){-q.w, -q.x, -q.y, -q.z};
	const rb_vec3 axis = {q.x, q.y, q.z};
	const double sine = rb_vec3_length(axis);

	/* angle / sin(angle / 2) goes to 2 */
	return rb_vec3_scale(sine > 0 ? 2 * atan2(sine, q.w) / sine : 2, axis);
}

/*
 * With spins, `turn` is what they say of the interval, whole turns and all, and what is left to b is the shortest
 * way; both are gone in proportion, so that constant spin is followed however fast it is. Without: the great circle.
 */
static rb_quat mix_orientation(rb_quat a, rb_quat b, rb_vec3 turn, double part)
{
	const rb_quat expected = rb_quat_multiply(rb_quat_from_turn(turn), a);
	const rb_quat back = {expected.w, -expected.x, -expected.y, -expected.z};
	const rb_vec3 rest = turn_of(rb_quat_multiply(b, back));
	const rb_quat gone = rb_quat_multiply(rb_quat_from_turn(rb_vec3_scale(part, rest)),
	                                      rb_quat_from_turn(rb_vec3_scale(part, turn)));

	return rb_quat_unit(rb_quat_multiply(gone, a));
}

static void mix_orientations(struct rb_frame *out, const struct rb_frame *a,
                             const struct rb_frame *b, double part)
{
	const double half = 0.5 * (b->time_s - a->time_s);
	const bool spins = a->angular_velocity && b->angular_velocity;

	for (int i = 0; i < out->body_count; i++) {
		rb_vec3 turn = {0};
		if (spins)
			turn = rb_vec3_scale(
				half, rb_vec3_add(rb_vec3_from(a->angular_velocity + 3 * i),
			                          rb_vec3_from(b->angular_velocity + 3 * i)));
		rb_quat_to(out->orientation + 4 * i,
		           mix_orientation(rb_quat_from(a->orientation + 4 * i),
		                           rb_quat_from(b->orientation + 4 * i), turn, part));
	}
}

enum rb_status rb_frame_between(struct rb_frame *out, const struct rb_frame *a,
                                const struct rb_frame *b, double time_s, struct rb_error *err)
{
	RB_ASSERT(a->body_count == b->body_count);
	RB_ASSERT(a->time_s <= time_s && time_s <= b->time_s);
	/* Columns of a run are the same in all its frames; b's lists and counts are already right. */
	const enum rb_status status = rb_frame_copy(out, time_s == a->time_s ? a : b, err);
	if (status || time_s == a->time_s || time_s == b->time_s)
		return status;

	const double part = (time_s - a->time_s) / (b->time_s - a->time_s);
	const int count = out->body_count;
	out->time_s = time_s;
	if (out->position && a->position)
		mix_column(out->position, a->position, 3 * count, part);
	if (out->velocity && a->velocity)
		mix_column(out->velocity, a->velocity, 3 * count, part);
	if (out->orientation && a->orientation)
		mix_orientations(out, a, b, part);
	if (out->angular_velocity && a->angular_velocity)
		mix_column(out->angular_velocity, a->angular_velocity, 3 * count, part);

	struct rb_frame_numbers *const numbers = &out->numbers;
	const struct rb_frame_numbers *const before = &a->numbers;
	numbers->kinetic_energy = mix(before->kinetic_energy, numbers->kinetic_energy, part);
	numbers->potential_energy = mix(before->potential_energy, numbers->potential_energy, part);
	numbers->momentum = mix_vec3(before->momentum, numbers->momentum, part);
	numbers->angular_momentum = mix_vec3(before->angular_momentum, numbers->angular_momentum,
	                                     part);
	return RB_OK;
}
