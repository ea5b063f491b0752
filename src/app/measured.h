/* SPDX-License-Identifier: MIT */
/*
 * A scene's own numbers as a run has found them: its results, and each probe's last, smallest and
 * largest value of all frames. Simulator's thread.
 */
#ifndef RB_APP_MEASURED_H
#define RB_APP_MEASURED_H

#include <stdio.h>

#include <rbsim/scene.h>

#include "app/json.h"
#include "base/field_list.h"
#include "script/hooks.h"

/* NAN is no value: smallest and largest are NAN as long as there was none. */
#define RB_PROBE_COURSE_FIELDS(X)                                       \
	X(double, last, , "", "value of the last frame", RB_NUMBER)     \
	X(double, smallest, , "", "of all frames until now", RB_NUMBER) \
	X(double, largest, , "", "of all frames until now", RB_NUMBER)
struct rb_probe_course {
	RB_PROBE_COURSE_FIELDS(RB_FIELD_MEMBER)
};

/* Zeroed: of a scene that has none. */
struct rb_measured {
	const struct rb_scene *scene;   /* borrowed */
	double *results;                /* owned: [result_count]; NAN until the end of the run */
	bool has_results;               /* the run has come to its end */
	struct rb_probe_course *probes; /* owned: [probe_count] */
};

RB_CHECKED enum rb_status rb_measured_init(struct rb_measured *measured,
                                           const struct rb_scene *scene, struct rb_error *err);
void rb_measured_release(struct rb_measured *measured); /* safe on a zeroed one */

/* Asks the scene's probes at this moment; `values`, [probe_count], is a frame's. */
RB_CHECKED enum rb_status rb_measured_take(struct rb_measured *measured, struct rb_script *script,
                                           struct rb_world *world, double *values,
                                           struct rb_error *err);
/* Asks the scene's results, at the end of the run. */
RB_CHECKED enum rb_status rb_measured_end(struct rb_measured *measured, struct rb_script *script,
                                          struct rb_world *world, struct rb_error *err);
/* What of it a checkpoint keeps, both ways. */
void rb_measured_pack(struct rb_measured *measured, struct rb_pack *pack);

/* Lines of the summary; nothing where the scene has neither. */
void rb_measured_print(FILE *file, const struct rb_measured *measured);
/* "results" and "probes", each an object of objects by name; empty where the scene has none. */
void rb_measured_print_json(struct rb_json *json, const struct rb_measured *measured);

#endif
