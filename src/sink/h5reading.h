/* SPDX-License-Identifier: MIT */
/*
 * What of a recording does not grow, into struct rb_reading: the run, its parameters, files, bodies
 * and forces. Texts and lists are in the arena.
 */
#ifndef RB_SINK_H5READING_H
#define RB_SINK_H5READING_H

#include "sink/h5input.h"
#include "sink/module.h"

/* All borrowed. */
struct rb_reading_source {
	const char *path; /* of the recording, for messages */
	struct rb_input *input;
	struct rb_arena *arena;
	struct rb_reading *reading;
};

/* A scalar; NAN: there is none. */
double rb_reading_number(const struct rb_reading_source *from, const char *path);

/* What is there only for information: "" and NAN where it is missing. */
void rb_reading_run(const struct rb_reading_source *from);
RB_CHECKED enum rb_status rb_reading_params(const struct rb_reading_source *from,
                                            struct rb_error *err);
RB_CHECKED enum rb_status rb_reading_files(const struct rb_reading_source *from,
                                           struct rb_error *err);
/* Who is who; first of all, because the others count by it. */
RB_CHECKED enum rb_status rb_reading_bodies(const struct rb_reading_source *from,
                                            struct rb_error *err);
RB_CHECKED enum rb_status rb_reading_forces(const struct rb_reading_source *from,
                                            struct rb_error *err);
/* Kinds and names of joints, if there are any. */
RB_CHECKED enum rb_status rb_reading_joints(const struct rb_reading_source *from,
                                            struct rb_error *err);
/*
 * Names (still escaped) and units of the members of a folder of results or probes, RB_MEASURES_MAX
 * at most; the units are those of NAME`tail`. `*units` NULL: no memory.
 */
int rb_reading_measures(const struct rb_reading_source *from, const char *folder, const char *tail,
                        const char ***names, const char ***units);

#endif
