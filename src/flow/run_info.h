/* SPDX-License-Identifier: MIT */
/*
 * What a recording says about its run besides the frames: who, when, how, from which scene.
 *
 * Made by whoever starts the run before any thread starts, then read only; all texts live as long
 * as the run.
 */
#ifndef RB_FLOW_RUN_INFO_H
#define RB_FLOW_RUN_INFO_H

#include <stdint.h>

#include <rbsim/model.h>

struct rb_run_info {
	const char *version, *build; /* "0.1.0"; compiler, flags, libraries, commit where known */
	const char *command;         /* the command line */
	const char *host, *author;
	char started[32]; /* UTC */
	int threads;
	const char *method, *rollback; /* as run */
	const struct rb_model
		*model; /* numbers as run: seed, time_step, tolerance, frame_rate, duration */
	const struct rb_scene *scene;
};

/* Texts that a struct rb_run_info borrows. */
struct rb_run_texts {
	char host[256], build[256];
	char *command; /* owned by whoever made it */
};

/* All but version, build, command and threads: those are the caller's. */
void rb_run_info_init(struct rb_run_info *info, struct rb_run_texts *texts,
                      const struct rb_model *model);

#endif
