/* SPDX-License-Identifier: MIT */
/*
 * Pictures are numbered and their times computed from the number, never summed: the
 * hundred-thousandth picture is as exact as the first, and a film that is continued falls on the
 * same times.
 */
#include "flow/schedule.h"

#include <float.h>
#include <math.h>

#include "base/error.h"
#include "flow/quantity.h"

/* 2^53: beyond that a double does not tell numbers of pictures apart. */
static const double count_max = 9007199254740992.0;

struct rb_schedule rb_schedule_of(const struct rb_camera_def *camera, double frame_rate,
                                  double end_s)
{
	return (struct rb_schedule){.from_s = camera->from_s,
	                            .to_s = fmin(camera->to_s, end_s),
	                            .fps = isnan(camera->fps) ? frame_rate : camera->fps,
	                            .speed = camera->speed,
	                            .picture_s = camera->picture_s,
	                            .picture_count = camera->picture_count};
}

struct rb_film_span rb_film_span_of(const struct rb_camera_def *camera, double end_s)
{
	return (struct rb_film_span){
		.from_s = camera->single ? camera->film_from_s : camera->from_s,
		.to_s = fmin(camera->single ? camera->film_to_s : camera->to_s, end_s)};
}

uint64_t rb_schedule_count(const struct rb_schedule *schedule)
{
	const double from = schedule->from_s, to = schedule->to_s;
	const double per_second = schedule->fps / schedule->speed; /* pictures, of simulated time */

	RB_ASSERT(schedule->fps > 0 && schedule->speed > 0);
	if (schedule->picture_s)
		return schedule->picture_count;
	if (!(from <= to))
		return 0;
	const double steps = (to - from) * per_second;
	if (!(steps < count_max))
		return (uint64_t)count_max;
	/*
	 * what rounding of both times, of their difference and of the quotient can make of a whole
	 * number
	 */
	const double noise = 8 * DBL_EPSILON * (fmax(fabs(from), fabs(to)) * per_second + steps);
	const double nearest = nearbyint(steps);
	const double whole = fabs(steps - nearest) <= noise ? nearest : floor(steps);
	return (uint64_t)whole + 1;
}

double rb_schedule_time(const struct rb_schedule *schedule, uint64_t picture)
{
	const double since = (double)picture * schedule->speed / schedule->fps;

	RB_ASSERT(schedule->fps > 0 && schedule->speed > 0);
	if (schedule->picture_s) {
		RB_ASSERT(picture < schedule->picture_count);
		return schedule->picture_s[picture];
	}
	return fmin(schedule->from_s + since, schedule->to_s);
}

double rb_schedule_step(const struct rb_schedule *schedule)
{
	double step = schedule->picture_count > 1 ? (double)INFINITY
	                                          : schedule->speed / schedule->fps;

	for (uint64_t k = 1; k < schedule->picture_count; k++)
		step = fmin(step, schedule->picture_s[k] - schedule->picture_s[k - 1]);
	return step;
}

double rb_schedule_speed(const struct rb_schedule *schedule, double time_s)
{
	const double *const at = schedule->picture_s;
	uint64_t low = 0, high = schedule->picture_count;

	if (high < 2)
		return schedule->speed;
	/* the picture at or before it that has one after it */
	while (low + 1 < high - 1) {
		const uint64_t middle = low + (high - 1 - low) / 2;
		if (at[middle] <= time_s)
			low = middle;
		else
			high = middle + 1;
	}
	return (at[low + 1] - at[low]) * schedule->fps;
}

void rb_camera_take_speed(struct rb_camera_def *camera, const struct rb_camera_def *from)
{
	camera->speed = from->speed;
	camera->speed_varies = from->speed_varies;
	camera->speed_function = from->speed_function;
	camera->picture_s = from->picture_s;
	camera->picture_count = from->picture_count;
}

bool rb_camera_has_functions(const struct rb_camera_def *camera)
{
	bool has = camera->position.source == RB_CAMERA_FUNCTION ||
	           camera->look_at.source == RB_CAMERA_FUNCTION ||
	           camera->up.source == RB_CAMERA_FUNCTION;

	for (int i = 0; i < camera->text_count; i++)
		has |= camera->texts[i].function >= 0;
	return has;
}

unsigned rb_camera_mark_fields(const struct rb_camera_def *camera)
{
	static const unsigned needed[RB_VECTORS_COUNT] = {
		[RB_ARROWS_VELOCITY] = RB_FIELD_VELOCITY,
		[RB_ARROWS_CONTACT] = RB_FIELD_CONTACTS,
		[RB_ARROWS_JOINT] = RB_FIELD_JOINTS,
		[RB_ARROWS_SPRING] = RB_FIELD_VELOCITY | RB_FIELD_ANGULAR_VELOCITY,
		[RB_ARROWS_ANGULAR_VELOCITY] = RB_FIELD_ANGULAR_VELOCITY,
		[RB_ARROWS_ACCELERATION] = RB_FIELD_ACCELERATION,
		[RB_ARROWS_MOMENTUM] = RB_FIELD_VELOCITY,
		[RB_ARROWS_FORCE] = RB_FIELD_FORCE};
	unsigned fields = 0;

	for (int kind = 0; kind < RB_VECTORS_COUNT; kind++)
		if (camera->vectors & 1u << kind)
			fields |= needed[kind];
	for (int k = 0; k < camera->plot_count; k++) {
		const struct rb_plot_def *const plot = &camera->plots[k];

		if (plot->of == RB_PLOT_JOINT)
			fields |= RB_FIELD_JOINTS;
		if (plot->of == RB_PLOT_BODY)
			fields |= rb_body_part_field(plot->part);
	}
	return fields;
}

unsigned rb_schedule_fields(const struct rb_camera_def *camera, const struct rb_model *model,
                            double end_s)
{
	const struct rb_schedule schedule = rb_schedule_of(camera, model->frame_rate, end_s);
	const int every = model->scene->record.every;
	/* frames of a run, or fewer in a recording */
	const double rate = model->frame_rate / (every > 1 ? every : 1);
	const double step = schedule.speed * rate / schedule.fps;
	const double first = schedule.from_s * rate;
	/*
	 * relative; rates are given with few digits, so ratios that are meant to be whole are
	 * within a few ulp of it
	 */
	const double noise = 1e-12;
	unsigned fields = RB_FIELD_POSITION | RB_FIELD_ORIENTATION;

	fields |= rb_camera_mark_fields(camera);
	if (camera->speed_varies || fabs(step - nearbyint(step)) > noise * step ||
	    fabs(first - nearbyint(first)) > noise * first)
		fields |= RB_FIELD_VELOCITY | RB_FIELD_ANGULAR_VELOCITY | RB_FIELD_EVENTS;
	return fields;
}
