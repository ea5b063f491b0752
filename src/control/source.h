/* SPDX-License-Identifier: MIT */
/*
 * Frames to be viewed: of a recording, also one that still grows, or of a run that is reached
 * through its socket, whose older frames come from its recording.
 *
 * A frame is named by its row. Rows of a recording are its own; those of a run are the numbers of
 * its frames. One thread; nothing here waits longer than the socket's time-out.
 */
#ifndef RB_CONTROL_SOURCE_H
#define RB_CONTROL_SOURCE_H

#include <stdbool.h>

#include <rbsim/model.h>

#include "control/client.h"
#include "sink/module.h"

struct rb_source;

enum { RB_SOURCE_BINS = 400, RB_SOURCE_STATE_SIZE = 24 };

/* What was in a part of the run's time. */
struct rb_source_bins {
	double kinetic[RB_SOURCE_BINS], potential[RB_SOURCE_BINS]; /* J, NAN: nothing is known */
	double penetration[RB_SOURCE_BINS];                        /* m, the largest */
	uint64_t collisions[RB_SOURCE_BINS];
};

struct rb_source_status {
	bool is_run; /* commands can go to a run */
	bool grows;  /* more frames can come */
	bool paused; /* the run stands still, or is about to */
	bool stops_at_collision;
	/* as the run or the recording says: "playing", "complete" */
	char state[RB_SOURCE_STATE_SIZE];
	uint64_t row_count;       /* 0: nothing can be shown yet */
	uint64_t frame_count;     /* of the whole run */
	double end_s, duration_s; /* the last row's time; of the whole run */
	uint64_t restarts;
	double real_time_factor; /* NAN: not known, for all that follow */
	double smallest_step_s, max_penetration_m;
	uint64_t collisions, rollbacks, bytes; /* bytes: of the recording */
	int ring_used, ring_slots;             /* 0 of 0: no ring */
};

/* `path` of a recording whose scene is `model`. The model is borrowed. */
RB_CHECKED enum rb_status rb_source_of_recording(struct rb_source **source, const char *path,
                                                 const struct rb_model *model,
                                                 struct rb_error *err);
/* The client is borrowed; `recording`, NULL where there is none, may come into being later. */
RB_CHECKED enum rb_status rb_source_of_run(struct rb_source **source, struct rb_client *client,
                                           const char *recording, const struct rb_model *model,
                                           struct rb_error *err);
void rb_source_destroy(struct rb_source *source); /* NULL is fine */

/*
 * Looks what there is; asks the run and the file only as often as makes sense, unless it must be
 * `now`. A run that is gone is no error: it then is a recording, or nothing that grows. `*changed`
 * tells whether there is anything new.
 */
RB_CHECKED enum rb_status rb_source_refresh(struct rb_source *source, uint64_t now_ns, bool now,
                                            bool *changed, struct rb_error *err);
/* How a run is at this moment: the status may be older than the newest frame. */
void rb_source_ask(struct rb_source *source);
/*
 * Asks a run at once whether it has made frames behind `row`; then the status tells its newest,
 * which is fetched without asking again.
 */
bool rb_source_newer(struct rb_source *source, uint64_t row);
const struct rb_source_status *rb_source_status(const struct rb_source *source);
const struct rb_source_bins *rb_source_bins(const struct rb_source *source);

/* A row's time, and the last row that is not after a time (0 where all are). */
double rb_source_time(const struct rb_source *source, uint64_t row);
uint64_t rb_source_row_at(const struct rb_source *source, double time_s);

/*
 * The frame of a row, or the nearest one before it that can be had, with the row that it is of. It
 * belongs to the source and holds until the next call.
 */
RB_CHECKED enum rb_status rb_source_frame(struct rb_source *source, uint64_t row,
                                          const struct rb_frame **frame, uint64_t *found,
                                          struct rb_error *err);
/*
 * The next row behind `row` with a collision, or the last one before it. False: there is none that
 * is known.
 */
bool rb_source_collision(struct rb_source *source, uint64_t row, bool forward, uint64_t *found);

/* A line for the run and its answer, as rb_client_request. RB_ERR_USAGE where there is no run. */
RB_CHECKED enum rb_status rb_source_tell(struct rb_source *source, const char *line,
                                         const char **answer, struct rb_error *err);

#endif
