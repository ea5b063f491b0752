/* SPDX-License-Identifier: MIT */
/*
 * Which of a scene's cameras are filmed, with what the command line changes of them, and the check
 * that no two of them write to one file.
 *
 * Called by app/films before anything is written or simulated.
 */
#ifndef RB_APP_FILM_CHOICE_H
#define RB_APP_FILM_CHOICE_H

#include "app/common.h"
#include "app/films_inside.h"

/* What the command line changes of cameras. NAN, 0, NULL: as the camera says. */
struct rb_films_wish {
	const char *names;   /* "main, side": only these; NULL: all that have an output */
	double from_s, to_s; /* of the film */
	double fps, speed;
	int size_px[2];
	const char *output;    /* instead of the camera's own: a film, or pictures with one %d */
	bool still;            /* one picture, to `output`, at from_s */
	bool runs;             /* the run that is recorded is still to come */
	bool fallback;         /* without a camera in the scene, one that shows the start */
	const char *recording; /* that is written or read: no film may take its place; NULL: none */
	bool replace;          /* existing files */
	double patience_s;     /* with an encoder that hangs; 0: as usual */
	bool trust;            /* cameras may name files anywhere */
	double end_s;          /* of the run */
};

/* Nothing is changed but what the command line of a run can say. */
struct rb_films_wish rb_films_wish_of_run(const struct rb_loaded *loaded,
                                          const struct rb_options *options);

/*
 * Fills films->film with the chosen cameras; films->loaded is set. RB_ERR_USAGE: a camera that is
 * not there, more than can be filmed at once, or several for one output; RB_ERR_SCENE: from a
 * function of a camera; RB_ERR_MEMORY. Each film is released with rb_film_choice_forget, and the
 * list with rb_memory_free, after failures too.
 */
RB_CHECKED enum rb_status rb_film_choice(struct rb_films *films, const struct rb_films_wish *wish,
                                         struct rb_error *err);
/* Releases what one film has from here, and leaves it zeroed. */
void rb_film_choice_forget(struct film *film);
/* RB_ERR_USAGE: a film would replace the recording; RB_ERR_SCENE: two films have one name. */
RB_CHECKED enum rb_status rb_film_choice_check_outputs(const struct rb_films *films,
                                                       const struct rb_films_wish *wish,
                                                       struct rb_error *err);

#endif
