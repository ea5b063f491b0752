/* SPDX-License-Identifier: MIT */
/*
 * The HDF5 side of the program lives in a module of its own, rbsim-hdf5.so, loaded when a run records or a
 * verb reads a recording: linking HDF5 would cost every start some milliseconds and megabytes.
 *
 * rb_module_hdf5 loads it once (later calls return the same table); RB_ERR_MISSING says which file was looked
 * for and why it could not be loaded.
 */
#ifndef RB_SINK_MODULE_H
#define RB_SINK_MODULE_H

#include <rbsim/sink.h>

#include "flow/info.h"

struct rb_recorder_options {
	const char *path; /* final name */
	_Bool replace;    /* --force: an existing file may be replaced */
	double flush_s;   /* longest wall time between flushes; 0: one second */
};

struct rb_recorder;
struct rb_reader;

/* What a recording says of itself; texts are owned by the reader. */
struct rb_reading {
	int body_count, static_count;
	int driven_count;                          /* of the bodies */
	int spring_count, drag_count, field_count; /* of the scene */
	uint64_t frame_count;
	const char *status, *reason, *state_hash, *started, *ended;
	const char *version, *build, *command, *host, *method, *rollback, *title;
	uint64_t seed;
	int threads;
	double time_step_s, tolerance_m, frame_rate, duration_s;
	unsigned fields;    /* RB_FIELD_* that are stored per frame */
	const char **names; /* [body_count + static_count], by id, "" where a body has none */
	const int *id;      /* [body_count]: moving bodies */
	int param_count;
	const char **param_names, **param_values;
	int file_count;
	const char **file_names, **file_texts; /* [0] is the scene */
	uint64_t event_count;
};

/* The module's one exported object is `const struct rb_hdf5_module rb_hdf5_module`. */
struct rb_hdf5_module {
	int version; /* RB_HDF5_MODULE_VERSION of the build */

	/* The recorder is a sink; the row in `sink` borrows the recorder, which the sink's owner destroys after closing. */
	enum rb_status (*recorder_create)(struct rb_recorder **recorder, struct rb_sink *sink,
	                                  const struct rb_run_info *info,
	                                  const struct rb_recorder_options *options,
	                                  struct rb_error *err);
	void (*recorder_destroy)(struct rb_recorder *recorder);
	/* Bytes that a whole run's recording will take (for `rbsim check`). */
	uint64_t (*recorder_estimate)(const struct rb_run_info *info);

	/* RB_ERR_INPUT when it can't be opened or is no recording of ours. Works on one that is still growing or was cut off. */
	enum rb_status (*reader_open)(struct rb_reader **reader, const char *path,
	                              struct rb_error *err);
	void (*reader_close)(struct rb_reader *reader);
	const struct rb_reading *(*reader_reading)(const struct rb_reader *reader);
	/* Looks again at a growing recording: updates frame_count and status. */
	enum rb_status (*reader_refresh)(struct rb_reader *reader, struct rb_error *err);
	/* The frame's columns belong to the reader and hold until the next call. */
	enum rb_status (*reader_frame)(struct rb_reader *reader, uint64_t row,
	                               struct rb_frame *frame, struct rb_error *err);
	/* A per-frame observable "kinetic_energy", ...: `values` has room for frame_count * width doubles. */
	enum rb_status (*reader_observable)(struct rb_reader *reader, const char *name, int width,
	                                    double *values, struct rb_error *err);
};

enum { RB_HDF5_MODULE_VERSION = 2 };

RB_CHECKED enum rb_status rb_module_hdf5(const struct rb_hdf5_module **module,
                                         struct rb_error *err);

#endif
