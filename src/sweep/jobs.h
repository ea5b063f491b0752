/* SPDX-License-Identifier: MIT */
/*
 * Runs the points of a sweep that are due, several at a time, each in a process of its own: this
 * program again, without a shell in between, in a process group of its own, so that what a terminal
 * sends reaches it through us alone.
 *
 * Main thread, which must be the only one. Inside the call the signals of rb_thread_stops are
 * taken: the first one goes on to the runs as what it asks for, to stop properly, and no other run
 * is started; a SIGINT after that stops them at once. Should this process die, its runs are stopped
 * properly by the system. Processes that are not ours are never waited for.
 */
#ifndef RB_SWEEP_JOBS_H
#define RB_SWEEP_JOBS_H

#include <signal.h>

#include "sweep/point.h"

struct rb_jobs_tally {
	uint64_t total;        /* points of the share */
	uint64_t done, failed; /* all of them, also of earlier sessions */
	int lack;              /* status of the first one that lacked memory, disk or a program */
	uint64_t lacking;      /* its index; `lack` 0: there is none */
	uint64_t running, elsewhere; /* by us, by other processes */
	uint64_t started, ended;     /* by us, so far */
	uint64_t due;                /* not yet looked at, or waiting */
	double wall_s, cpu_s;        /* cpu: of all runs that have ended */
	int signal;                  /* that asked for an end, 0: none */
};

/* All borrowed. */
struct rb_jobs_order {
	const char *folder; /* absolute */
	const struct rb_plan *plan;
	const struct rb_hdf5_module *module; /* for rb_point_look; NULL: no recordings */
	int jobs, threads;                   /* at a time; of each */
	uint64_t share, shares;              /* the share-th of so many, from 0 */
	bool retry;
	double checkpoint_every_s; /* NAN: as runs do by themselves */
	double point_time_s;       /* wall time of a run, then it is ended; NAN: no bound */
	double point_disk_bytes;   /* of all files of a run; NAN: no bound */
	sigset_t mask_before;      /* of signals: what runs get */
	int tick_ms;               /* longest time between two calls of `tick`; 0: never */
	void (*tick)(void *user, const struct rb_jobs_tally *tally);
	/* A run of ours has ended, or a failed one was found. */
	void (*told)(void *user, uint64_t index, const struct rb_point *point);
	void *user;
};

/*
 * The signals that stop a sweep wait for rb_jobs_run from here on: before anything is there that a
 * later call goes on with. `mask_before`: as it was.
 */
void rb_jobs_hold_signals(sigset_t *mask_before);

/* RB_OK whatever becomes of the runs; the tally is right in any case. */
RB_CHECKED enum rb_status rb_jobs_run(const struct rb_jobs_order *order,
                                      struct rb_jobs_tally *tally, struct rb_error *err);

#endif
