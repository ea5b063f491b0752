/* SPDX-License-Identifier: MIT */
/*
 * Video through an ffmpeg child: raw pictures down a pipe, no shell in between.
 *
 * One thread at a time; that which creates it must live until it is finished or destroyed, since
 * the child dies with it. The film is written under another name in the same folder and renamed
 * when ffmpeg has ended well and made something. What is needed of the program, and how long a
 * child that hangs is waited for: film/child.h.
 */
#ifndef RB_FILM_ENCODER_H
#define RB_FILM_ENCODER_H

#include <stdatomic.h>
#include <stdbool.h>

#include "film/pixmap.h"

struct rb_encoder;

struct rb_encoder_options {
	const char *
		/*
		 * final name; its ending says the format: .mp4 (H.264, yuv420p, faststart), .webm,
		 * .gif
		 */
		path;
	unsigned how; /* of base/place */
	int width,
		/*
		 * of all pictures; odd ones are padded by a row or column where the format wants
		 * even ones
		 */
		height;
	double fps;
	const char *title; /* metadata; "" for none */
	const atomic_bool
		*cut;      /* borrowed; set: less patience with a child that hangs; NULL: never */
	double patience_s; /* with such a one, --film-timeout; 0: as usual */
};

/*
 * Is there a program ffmpeg (RBSIM_FFMPEG, else in PATH) that runs and has the encoder for that
 * format? RB_ERR_MISSING with what to do, RB_ERR_CREATE where the film exists and must not be
 * replaced, or its folder can't be written to, and RB_ERR_SCENE where the format has no such rate.
 * Leaves nothing behind.
 */
RB_CHECKED enum rb_status rb_encoder_check(const struct rb_encoder_options *options,
                                           struct rb_error *err);

RB_CHECKED enum rb_status rb_encoder_create(struct rb_encoder **encoder,
                                            const struct rb_encoder_options *options,
                                            struct rb_error *err);
/*
 * RB_ERR_MISSING when ffmpeg has failed: exit status or signal, and the last line of what it said.
 * RB_ERR_IO when the disk is full.
 */
RB_CHECKED enum rb_status rb_encoder_picture(struct rb_encoder *encoder,
                                             const struct rb_pixmap *pixmap, struct rb_error *err);
/*
 * Waits for ffmpeg and renames the film; without a picture, or with `discard`, nothing is left.
 * `*bytes` (may be NULL): size of the file.
 */
RB_CHECKED enum rb_status rb_encoder_finish(struct rb_encoder *encoder, bool discard,
                                            uint64_t *bytes, struct rb_error *err);
void rb_encoder_destroy(
	struct rb_encoder *encoder); /* ends and reaps a child that still runs; NULL is fine */

#endif
