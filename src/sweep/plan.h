/* SPDX-License-Identifier: MIT */
/*
 * What a sweep runs: one point for every combination of values (or every point of a sample) and
 * every seed.
 *
 * Points are functions of their index, so a plan takes no memory for them, but for a sample.
 * Written down (sweep/folder), it is `lines`, which begin with '#', and a row of comma-separated
 * values for every point.
 *
 * A plan owns what it holds; const after rb_plan_init. One thread.
 */
#ifndef RB_SWEEP_PLAN_H
#define RB_SWEEP_PLAN_H

#include <stdbool.h>
#include <stddef.h>

#include <rbsim/scene.h>

#include "sweep/axis.h"
#include "sweep/sample.h"

#define RB_PLAN_POINTS_MAX 10000000u

/* What a user asks for; all borrowed. */
struct rb_plan_wish {
	const char *version;       /* of the program */
	const char *scene;         /* its base name */
	const char *const *params; /* NAME=VALUES */
	int param_count;
	const char *sample; /* "latin:N"; NULL: all combinations */
	uint64_t seeds;     /* runs of each combination, each with a seed of its own */
	uint64_t base_seed;
	const char *const *words; /* for every run, like --duration=3 */
	int word_count;
	bool records; /* every run leaves a recording */
	bool films;   /* runs make files besides the recording: each gets a folder */
};

/* A file of the scene, by the name that the scene has for it. */
struct rb_plan_file {
	char *name; /* owned */
	char sha256[65];
};

struct rb_plan {
	char *scene;          /* owned */
	struct rb_axis *axes; /* owned */
	int axis_count;
	uint64_t seeds, base_seed;
	uint64_t sample_count; /* 0: all combinations */
	struct rb_sample sample;
	uint64_t count; /* of points */
	char **words;   /* owned, each too */
	int word_count;
	bool records, films;
	struct rb_plan_file *files; /* owned; [0] is the scene */
	int file_count;
	char **lines; /* owned, each too: the head of plan.csv */
	int line_count;
	size_t row_size; /* room for a row of plan.csv */
};

/*
 * RB_ERR_USAGE where the wish has no sense. `files` are those of the scene. Released in any case.
 */
RB_CHECKED enum rb_status rb_plan_init(struct rb_plan *plan, const struct rb_plan_wish *wish,
                                       const struct rb_source_file *files, int file_count,
                                       struct rb_error *err);
void rb_plan_release(struct rb_plan *plan); /* safe on a zeroed one */

/* The text of a parameter at a point, and the point's seed. */
const char *rb_plan_value(const struct rb_plan *plan, uint64_t index, int axis,
                          char out[RB_AXIS_NUMBER_SIZE]);
uint64_t rb_plan_seed(const struct rb_plan *plan, uint64_t index);
/* "mu=0.3, e=0.5", cut where it does not fit. */
const char *rb_plan_label(const struct rb_plan *plan, uint64_t index, char *out, size_t size);
/* A row of plan.csv without its line break; `out` has room for row_size. */
void rb_plan_row(const struct rb_plan *plan, uint64_t index, char *out);

/* The names above the rows. */
void rb_plan_titles(const struct rb_plan *plan, char *out);

#endif
