/* SPDX-License-Identifier: MIT */
/*
 * How far a run is from what it should be: from the scene's own reference, or from a path that
 * another run has left.
 *
 * A path lies in memory that child processes share (mmap, since blocks of base/memory are private):
 * one process writes it while no other looks. A watch belongs to the process that simulates.
 */
#ifndef RB_APP_DEVIATION_H
#define RB_APP_DEVIATION_H

#include <rbsim/frame.h>
#include <rbsim/world.h>

#include "script/load.h"

enum rb_quantity {
	RB_QUANTITY_POSITION,
	RB_QUANTITY_VELOCITY,
	RB_QUANTITY_ORIENTATION,
	RB_QUANTITY_ANGULAR_VELOCITY,
	RB_QUANTITY_ENERGY,
	RB_QUANTITY_PENETRATION,
	RB_QUANTITY_COUNT
};

struct rb_quantity_row {
	const char *name, *unit; /* "": a plain number */
	const char *what;        /* for people */
};
extern const struct rb_quantity_row rb_quantities[RB_QUANTITY_COUNT];

/* Over all frames looked at and all bodies; NAN once one was no number. */
struct rb_deviation {
	uint64_t count; /* values compared; 0: the quantity is not known */
	double max, rms;
	double final;   /* largest of the last frame */
	double largest; /* magnitude of the quantity itself: what rounding is relative to */
};

/* Every `stride`-th frame of a run. */
struct rb_path {
	int body_count;
	unsigned fields; /* RB_FIELD_*, of every body and sample */
	uint64_t stride, sample_count;
	size_t sample_doubles, bytes;
	double *samples; /* shared, owned */
};

/* As fine as fits into a bounded room. */
RB_CHECKED enum rb_status rb_path_create(struct rb_path *path, const struct rb_model *model,
                                         struct rb_error *err);
void rb_path_destroy(struct rb_path *path); /* safe on a zeroed one */

struct rb_watch {
	struct rb_script *script;      /* borrowed: its reference is what counts; NULL: `against` */
	const struct rb_path *against; /* borrowed; NULL: nothing to compare with */
	struct rb_path *store;         /* borrowed; NULL: nothing is kept */
	double until_s;                /* later frames are not compared */
	enum rb_quantity agree_quantity; /* where `agree` is the bound for ... */
	double agree,
		agree_s; /* ... the last time up to which it was never exceeded; NAN: not at all */
	double start;    /* largest distance of positions at the first frame compared */
	bool energy_drifts; /* the energy is compared with that of the start */
	struct rb_deviation of[RB_QUANTITY_COUNT];

	const struct rb_model *model; /* borrowed */
	struct rb_reference_pose *poses;
	double energy_start, kinetic_max;
	bool disagreed, started;
};

/* `watch` has the borrowed parts and bounds set, all else zeroed. Fails on memory only. */
RB_CHECKED enum rb_status rb_watch_start(struct rb_watch *watch, const struct rb_model *model,
                                         struct rb_error *err);
/*
 * A frame with all columns that the model has; the world is at that frame. RB_ERR_SCENE from the
 * reference.
 */
RB_CHECKED enum rb_status rb_watch_frame(struct rb_watch *watch, struct rb_world *world,
                                         const struct rb_frame *frame, struct rb_error *err);
/* Roots and ratios; after that the deviations can be read. */
void rb_watch_end(struct rb_watch *watch);
void rb_watch_release(struct rb_watch *watch);

#endif
