/* SPDX-License-Identifier: MIT */
/*
 * Finished pictures on their way to files, while the next one is drawn: threads that make PNG
 * files, one that feeds the video.
 *
 * Created, filled and closed by one thread; a small ring of pictures lies between it and the
 * press's own. PNG files are made in any order, the video in that of its pictures. The first
 * failure stops all: the next call tells it.
 */
#ifndef RB_FILM_PRESS_H
#define RB_FILM_PRESS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "film/pixmap.h"
#include "film/png.h"

struct rb_press;

enum { RB_PRESS_TEXTS_MAX = 8, RB_PRESS_THREADS_MAX = 16 };

/* All texts are borrowed until the press is destroyed. */
struct rb_press_options {
	const char *png;   /* NULL: none; a pattern with one %d, or a name */
	bool still;        /* it is a name */
	const char *video; /* NULL: none */
	unsigned how;      /* of base/place: whose word these names are */
	int width, height; /* of all pictures */
	double fps;
	int png_threads;
	const char *title; /* of the video; NULL: none */
	const atomic_bool
		*cut;      /* borrowed; set: nobody waits for an ffmpeg that hangs; NULL: never */
	double patience_s; /* with one that hangs; 0: as usual */
	struct rb_png_text texts[RB_PRESS_TEXTS_MAX]; /* of every PNG file */
	int text_count;
};

struct rb_press_tally {
	uint64_t pictures; /* that have become all they should */
	uint64_t bytes;    /* of all files */
	uint64_t png_ns, pipe_ns, wait_ns;
};

/*
 * The name of a picture, like 'frames/00012.png'. False: `pattern` has not one %d, or the name is
 * too long.
 */
bool rb_press_name(char *out, size_t size, const char *pattern, uint64_t picture);

/*
 * Can it be done? Leaves nothing behind. RB_ERR_CREATE, RB_ERR_MISSING; RB_ERR_SCENE: a name that
 * can't be one.
 */
RB_CHECKED enum rb_status rb_press_check(const struct rb_press_options *options,
                                         struct rb_error *err);

/* Makes folders that are missing and starts ffmpeg and the threads. */
RB_CHECKED enum rb_status rb_press_create(struct rb_press **press,
                                          const struct rb_press_options *options,
                                          struct rb_error *err);
/* A copy of the picture goes to print; waits where the press is busy. */
RB_CHECKED enum rb_status rb_press_print(struct rb_press *press, const struct rb_pixmap *pixmap,
                                         uint64_t picture, double time_s, struct rb_error *err);
/*
 * Waits for all pictures and finishes the video with those that were printed, even after a failure,
 * which is told here too. Once.
 */
RB_CHECKED enum rb_status rb_press_close(struct rb_press *press, struct rb_error *err);
void rb_press_destroy(struct rb_press *press); /* NULL is fine */
/* From any thread. */
struct rb_press_tally rb_press_tally(struct rb_press *press);

#endif
