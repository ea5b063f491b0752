/* SPDX-License-Identifier: MIT */
/*
 * The list of films, for app/films, whose header says how it is used, app/film_choice, which fills
 * it, and app/film_summary, which reports it.
 */
#ifndef RB_APP_FILMS_INSIDE_H
#define RB_APP_FILMS_INSIDE_H

#include <stdatomic.h>

#include "app/steering.h"
#include "base/field_list.h"
#include "flow/between.h"
#include "flow/pump.h"
#include "flow/schedule.h"
#include "sink/module.h"

/* One camera that is filmed. */
struct film {
	struct rb_camera_def camera; /* of the scene, with the changes of the command line */
	struct rb_film_cell *cells;  /* owned: [cell_count]; of a film of several cameras */
	int cell_count;
	double *picture_s; /* owned, NULL: the speed is constant */
	char label[80];    /* "camera 'main'", for messages */
	struct rb_schedule schedule;
	uint64_t next;            /* the next picture to compute a shot for */
	bool late;                /* made from the recording after the run */
	struct rb_film_span span; /* whose motion it frames if it has no position */
	struct rb_film *film;
	struct rb_sink sink;
	struct rb_pump *pump;
	struct rb_film_tally tally;
	enum rb_status status;
};

/* Pictures switched off, or on again: off first, then by turns. */
#define RB_FILM_SWITCH_FIELDS(X) X(double, time_s, , "s", "when", RB_FINITE)
struct rb_film_switch {
	RB_FILM_SWITCH_FIELDS(RB_FIELD_MEMBER)
};

struct rb_films {
	struct rb_loaded *loaded;
	const struct rb_film_module *module;
	struct film *film; /* [count] */
	int count;
	bool late;     /* the late ones are being made */
	bool shoots;   /* some camera has functions */
	bool has_last; /* `last` is the previous frame */
	struct rb_frame last;
	struct rb_between between;
	struct rb_steering steering;
	struct rb_film_switch *switched; /* owned: [switch_count] */
	size_t switch_count, switch_capacity;
	atomic_int cut; /* signal that ends all films, 0: none; any thread */
};

/* Cameras of a film, one after the other: its cells', or its own. */
static inline int rb_film_camera_count(const struct film *film)
{
	return film->cell_count > 0 ? film->cell_count : 1;
}

static inline struct rb_camera_def *rb_film_camera(struct film *film, int k)
{
	return film->cell_count > 0 ? &film->cells[k].camera : &film->camera;
}

/* Whether a film ended before its last picture. */
static inline bool rb_film_is_cut_short(const struct rb_film_tally *tally)
{
	return tally->pictures + tally->left_out < tally->picture_count;
}

#endif
