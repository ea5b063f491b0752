/* SPDX-License-Identifier: MIT */
/*
 * At which simulated times a camera takes its pictures: film second f shows simulated second from +
 * speed f, and picture n is at f = n / fps. Values; any thread.
 */
#ifndef RB_FLOW_SCHEDULE_H
#define RB_FLOW_SCHEDULE_H

#include <stdbool.h>
#include <stdint.h>

#include <rbsim/model.h>
#include <rbsim/scene.h>

struct rb_schedule {
	double from_s, to_s; /* simulated, of the first picture; none is later than to_s */
	double fps, speed;   /* pictures per second of film; simulated seconds in one of film */
	/* times of the pictures instead, borrowed from the camera: [picture_count]; NULL: none */
	const double *picture_s;
	uint64_t picture_count;
};

/* Of a camera over a run of `frame_rate` that ends at `end_s`. */
struct rb_schedule rb_schedule_of(const struct rb_camera_def *camera, double frame_rate,
                                  double end_s);
/* Simulated time that a film shows; of a single picture, the film that it is of. */
struct rb_film_span {
	double from_s, to_s;
};
struct rb_film_span rb_film_span_of(const struct rb_camera_def *camera, double end_s);
/*
 * How many pictures there are; a quotient within a few ulp of a whole number counts as that number.
 * 0 where the camera starts after its end.
 */
uint64_t rb_schedule_count(const struct rb_schedule *schedule);
/*
 * Simulated time of a picture, s: from + n speed / fps, in this order of rounding, so that with
 * speed 1 and the fps of the recording pictures fall on frames to the bit; never later than to_s.
 */
double rb_schedule_time(const struct rb_schedule *schedule, uint64_t picture);
/* The least time between two pictures, s; of a single one what `speed` says. */
double rb_schedule_step(const struct rb_schedule *schedule);
/* Simulated seconds in a second of film, at a moment. */
double rb_schedule_speed(const struct rb_schedule *schedule, double time_s);
/* Gives a camera the speed of another. */
void rb_camera_take_speed(struct rb_camera_def *camera, const struct rb_camera_def *from);
/* Whether it has functions of time, which are asked for each of its pictures. */
bool rb_camera_has_functions(const struct rb_camera_def *camera);
/* RB_FIELD_* that its arrows and diagrams need. */
unsigned rb_camera_mark_fields(const struct rb_camera_def *camera);
/*
 * RB_FIELD_* that pictures need; between frames also velocities, spins and impacts, which tell how
 * bodies go there.
 */
unsigned rb_schedule_fields(const struct rb_camera_def *camera, const struct rb_model *model,
                            double end_s);

#endif
