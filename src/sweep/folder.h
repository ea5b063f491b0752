/* SPDX-License-Identifier: MIT */
/*
 * The folder of a sweep. It is whole in itself:
 *
 *   plan.csv           the plan, written once and last
 *   scene/ lua/  all files that the scene is made of: its own, and the helpers that come with
 *                      rbsim
 *   point-00017.h5     the recording of a point, with .checkpoint beside it while there is one
 *   point-00017.json  what its run said at its end; not there, or not whole, while it has not
 *                      ended
 *   point-00017.log    what it said besides; locked while it runs
 *   point-00017/       the films of a run, where scenes have cameras
 *
 * Several processes may share a folder. Paths below are relative to it where nothing else is said.
 */
#ifndef RB_SWEEP_FOLDER_H
#define RB_SWEEP_FOLDER_H

#include "sweep/plan.h"

#define RB_FOLDER_PLAN "plan.csv"
enum { RB_FOLDER_PATH_SIZE = 4096 };

/* Whether there is a plan in the folder. */
bool rb_folder_has_plan(const char *folder);
/*
 * Makes the folder, the copies of the files, and the plan. RB_ERR_CREATE where the folder holds
 * other things; `*there`: somebody else has written a plan meanwhile, which is to be checked.
 */
RB_CHECKED enum rb_status rb_folder_write(const char *folder, const struct rb_plan *plan,
                                          const struct rb_source_file *files, bool *there,
                                          struct rb_error *err);
/*
 * The plan of a folder. RB_ERR_INPUT where it is none of ours, of another version, or a copy of a
 * file has changed.
 */
RB_CHECKED enum rb_status rb_folder_load(const char *folder, struct rb_plan *plan,
                                         const char *version, struct rb_error *err);
/*
 * Whether the plan in the folder is this one: the head alone, or all rows. RB_ERR_INPUT says what
 * differs.
 */
RB_CHECKED enum rb_status rb_folder_check(const char *folder, const struct rb_plan *plan, bool rows,
                                          struct rb_error *err);

/* FOLDER/point-00017ENDING; `folder` NULL: the name alone. Gives `out`. */
const char *rb_folder_path(const struct rb_plan *plan, const char *folder, uint64_t index,
                           const char *ending, char out[RB_FOLDER_PATH_SIZE]);
/* FOLDER/NAME */
RB_CHECKED enum rb_status rb_folder_name(const char *folder, const char *name,
                                         char out[RB_FOLDER_PATH_SIZE], struct rb_error *err);

/*
 * A whole file, with a zero behind it, to be freed; RB_ERR_INPUT where it cannot be read or has
 * more than `most` bytes.
 */
RB_CHECKED enum rb_status rb_folder_read(const char *path, size_t most, char **text, size_t *size,
                                         struct rb_error *err);

#endif
