/* SPDX-License-Identifier: MIT */
/*
 * All of a recording that does not change from frame to frame: who, how, the bodies, the scene
 * (rbsim-recording(5)).
 */
#ifndef RB_SINK_H5ABOUT_H
#define RB_SINK_H5ABOUT_H

#include "flow/run_info.h"
#include "sink/h5file.h"

/* Room of the texts that change. */
enum {
	RB_ABOUT_STATUS_ROOM = 16,
	RB_ABOUT_REASON_ROOM = 256,
	RB_ABOUT_HASH_ROOM = 16,
	RB_ABOUT_ENDED_ROOM = 32
};

/* `h5->file` is open and empty. */
void rb_about_write(struct rb_h5 *h5, const struct rb_run_info *info);
/* Then: what changes, as it is at the start: texts, and the scene's results, NAN. */
void rb_about_write_changing(struct rb_h5 *h5, const struct rb_scene *scene);

/* "/results/NAME", the name as HDF5 can hold it; written to `out`, which is returned. */
enum { RB_ABOUT_PATH_SIZE = 240 };
const char *rb_about_result_path(const char *name, char out[RB_ABOUT_PATH_SIZE]);
/* Overwrites the results, [result_count] of the scene. Works while others read. */
void rb_about_rewrite_results(struct rb_h5 *h5, const struct rb_scene *scene,
                              const double *results);

#endif
