/* SPDX-License-Identifier: MIT */
/*
 * `--resume`: what of a run is there already, and whether it is of the same run.
 *
 * The same are: the version, every file of the scene, parameters, seed, method, rollback, time
 * step, tolerance, frame rate and duration. Threads and outputs may differ.
 */
#ifndef RB_APP_RESUME_H
#define RB_APP_RESUME_H

#include "app/checkpoint.h"
#include "app/common.h"
#include "app/films.h"
#include "flow/ring.h"

enum rb_resume_kind {
	RB_RESUME_NEW, /* there is nothing to go on from, or nobody wants to: from the beginning */
	RB_RESUME_AGAIN, /* from the beginning, over what the recording has, which is the same */
	RB_RESUME_GO_ON, /* from the checkpoint */
	RB_RESUME_DONE   /* the recording is complete */
};

struct rb_resume {
	enum rb_resume_kind kind;
	char started[32];                /* AGAIN, GO_ON: of the recording */
	struct rb_checkpoint checkpoint; /* GO_ON */
};

/* Of all that decides what a run becomes. */
uint64_t rb_resume_run_hash(const struct rb_loaded *loaded);

/*
 * Looks, and changes nothing but a checkpoint that is not whole, which goes where there is a good
 * one before it. RB_ERR_USAGE: the recording is of another run, and how they differ. RB_ERR_INPUT:
 * it or its checkpoint can't be read. Released in any case.
 */
RB_CHECKED enum rb_status rb_resume_look(struct rb_resume *resume, const struct rb_loaded *loaded,
                                         const struct rb_options *options, struct rb_error *err);
void rb_resume_release(struct rb_resume *resume); /* safe on a zeroed one */

/*
 * The frames up to the checkpoint once more, out of the recording, for films, which begin again.
 * The ring's frames get the columns that the recording has. `stop` says that nobody wants them any
 * more. RB_ERR_USAGE where the recording lacks what the films show.
 */
struct rb_resume_films {
	struct rb_films *films;
	struct rb_ring *ring;
	bool (*stop)(void *user);
	void *user;
};
RB_CHECKED enum rb_status rb_resume_feed(const struct rb_resume *resume,
                                         const struct rb_loaded *loaded,
                                         const struct rb_resume_films *to, struct rb_error *err);

#endif
