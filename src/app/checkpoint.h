/* SPDX-License-Identifier: MIT */
/*
 * Checkpoints: the small file beside a recording that its run can go on from.
 *
 * RUN.h5.checkpoint, and the one before as RUN.h5.checkpoint~:
 *
 *   head       "rbsim-cp", order of bytes, format, size and hash (base/hash) of all that follows
 *   sections  name of 8 bytes, size, hash, bytes: "about" (whose run, which frame), "world"
 *              (method/save), "script"
 *              (script/keep), "run" (what the summary tells); each once, in this order
 *
 * The simulator's thread copies what is to be kept (rb_checkpoint_take); a thread beside it waits
 * until the recording holds every frame up to there, syncs it, writes the file under a new name,
 * syncs that, and renames. So the file that is there is whole, and never ahead of its recording. A
 * file that is not whole all the same is told by its hashes.
 */
#ifndef RB_APP_CHECKPOINT_H
#define RB_APP_CHECKPOINT_H

#include <stdbool.h>
#include <stdint.h>

#include <rbsim/world.h>

#include "base/field_list.h"

struct rb_script;
struct rb_checkpoints;

/* Whose state it is. */
#define RB_CHECKPOINT_ABOUT_FIELDS(X)                                                         \
	X(uint64_t, run, , "", "hash of scene, parameters, settings and version: app/resume", \
	  RB_ANY_BITS)                                                                        \
	X(char, started, [32], "", "of the recording it belongs to", RB_ANY_BITS)             \
	X(uint64_t, frame, , "", "reached", RB_ANY_BITS)                                      \
	X(uint64_t, row_count, , "", "rows of the recording up to it", RB_ANY_BITS)           \
	X(uint64_t, state_hash, , "", "of the world's state", RB_ANY_BITS)
struct rb_checkpoint_about {
	RB_CHECKPOINT_ABOUT_FIELDS(RB_FIELD_MEMBER)
};

/* What keeps a part of it, for whoever has something that this module doesn't know. */
struct rb_checkpoint_parts {
	struct rb_world *world;
	struct rb_script *script;
	void (*pack)(void *user, struct rb_pack *pack); /* "run" */
	void *user;
};

struct rb_checkpoints_options {
	const char *recording; /* borrowed */
	unsigned how;          /* of base/place */
	/*
	 * Waits until the recording holds all frames up to this one; false: it never will. In the
	 * writing thread.
	 */
	bool (*recorded)(void *user, uint64_t frame);
	void *user;
	/* bytes that one will take: room that need not be found while the run waits */
	size_t size_guess;
	uint64_t
		/* when (base/clock) that room is to be ready in memory, too; 0: not beforehand */
		ready_ns;
};

/* Starts the thread that writes; nothing is written yet. */
RB_CHECKED enum rb_status rb_checkpoints_start(struct rb_checkpoints **made,
                                               const struct rb_checkpoints_options *options,
                                               struct rb_error *err);
/*
 * The last one will be asked for soon, and nobody wants to wait for it long: what the recording
 * holds already is sent to the disk, and from `until_ns` (base/clock) on what has not come there is
 * not waited for any more. Any thread.
 */
void rb_checkpoints_hurry(struct rb_checkpoints *checkpoints, uint64_t until_ns);
/* One is still being written: the next one would have to wait. */
bool rb_checkpoints_busy(struct rb_checkpoints *checkpoints);
/*
 * Copies all parts and leaves the rest to the thread; `about` lacks nothing but state_hash.
 * RB_ERR_SCENE: the script has something that can't be kept.
 */
RB_CHECKED enum rb_status rb_checkpoints_take(struct rb_checkpoints *checkpoints,
                                              const struct rb_checkpoint_about *about,
                                              const struct rb_checkpoint_parts *parts,
                                              struct rb_error *err);
/* Until the one under way, if any, is written: how the last one went. */
RB_CHECKED enum rb_status rb_checkpoints_wait(struct rb_checkpoints *checkpoints,
                                              struct rb_error *err);
struct rb_checkpoints_tally {
	uint64_t written, bytes; /* how many; of the last one */
	uint64_t stall_ns;       /* of the simulator, by all of them, and by the longest */
	uint64_t stall_most_ns;
	uint64_t stall_cpu_ns; /* of which its thread has worked */
	uint64_t frame;        /* of the last one */
};
struct rb_checkpoints_tally rb_checkpoints_tally(struct rb_checkpoints *checkpoints);
/* Waits for what is under way. NULL is fine. */
void rb_checkpoints_stop(struct rb_checkpoints *checkpoints);

/* Both files go, if they are there. `how` is that of base/place, here and below. */
void rb_checkpoints_remove(const char *recording, unsigned how);

/* ---- going on from one ---- */

struct rb_checkpoint {
	struct rb_checkpoint_about about;
	unsigned char *bytes; /* owned; all of the file */
	size_t size;
	struct rb_pack world, script, run; /* into `bytes` */
};

/*
 * The checkpoint of a recording, or the one before where that is not whole, of which a warning
 * tells. RB_ERR_INPUT where there is one but none is whole; `*found` false where there is none.
 * Released in any case.
 */
RB_CHECKED enum rb_status rb_checkpoint_read(struct rb_checkpoint *checkpoint, bool *found,
                                             const char *recording, unsigned how,
                                             struct rb_error *err);
/* The same from memory, which it takes over. RB_ERR_INPUT: `what` is wrong with `name`. */
RB_CHECKED enum rb_status rb_checkpoint_parse(struct rb_checkpoint *checkpoint,
                                              unsigned char *bytes, size_t size, const char *name,
                                              struct rb_error *err);
void rb_checkpoint_release(struct rb_checkpoint *checkpoint); /* safe on a zeroed one */

/* World and script as they were then, both just made. RB_ERR_INPUT. */
RB_CHECKED enum rb_status rb_checkpoint_restore(struct rb_checkpoint *checkpoint,
                                                const struct rb_checkpoint_parts *parts,
                                                struct rb_error *err);

#endif
