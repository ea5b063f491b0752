/* SPDX-License-Identifier: MIT */
/*
 * A sweep as a command line asks for it: of a scene, planned and written into its folder unless it
 * is there already, or of a folder that has one. Main thread.
 */
#ifndef RB_APP_PLANNED_H
#define RB_APP_PLANNED_H

#include <limits.h>

#include "app/common.h"
#include "sink/module.h"
#include "sweep/folder.h"
#include "sweep/jobs.h"

struct rb_planned {
	const struct rb_options *options;
	const char *shown;     /* the folder as the user calls it; borrowed */
	char folder[PATH_MAX]; /* absolute */
	struct rb_plan plan;
	bool goes_on;         /* the folder was there before */
	sigset_t mask_before; /* of signals, which are held if points are to be run here */

	/* while it is planned */
	struct rb_loaded loaded;      /* with the defaults of its parameters */
	struct rb_source_file *files; /* owned, names and texts too */
	int file_count;
	const char **words; /* owned: for every run; they point into `text` */
	int word_count;
	char *text; /* owned */
	bool films;
};

/*
 * Everything up to the first run. `*scene_failed`: the mistakes are those of the scene in `loaded`.
 * Released in any case.
 */
RB_CHECKED enum rb_status rb_planned_init(struct rb_planned *sweep,
                                          const struct rb_options *options, bool *scene_failed,
                                          struct rb_error *err);
/* The sweep of a folder, as it is. */
RB_CHECKED enum rb_status rb_planned_open(struct rb_planned *sweep,
                                          const struct rb_options *options, const char *folder,
                                          struct rb_error *err);
void rb_planned_release(struct rb_planned *sweep);

/* What reads the recordings of a sweep that has any; NULL else. */
RB_CHECKED enum rb_status rb_planned_reader(const struct rb_planned *sweep,
                                            const struct rb_hdf5_module **module,
                                            struct rb_error *err);

#endif
