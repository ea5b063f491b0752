/* SPDX-License-Identifier: MIT */
/*
 * The list of films, for app/films, whose header says how it is used, app/film_choice, which fills
 * it, and app/film_summary, which reports it.
 */
#ifndef RB_APP_FILMS_INSIDE_H
#define RB_APP_FILMS_INSIDE_H

#include <stdatomic.h>

#include "app/steering.h"
#include "flow/between.h"
#include "flow/pump.h"
#include "flow/schedule.h"
#include "sink/module.h"

/* One camera at work. */
struct film {
	struct rb_camera_def camera; /* as wished */
	char label[80];              /* "camera 'main'", for messages */
	struct rb_schedule schedule;
	uint64_t next;       /* picture whose shot comes next */
	bool late;           /* made when the run has ended */
	double from_s, to_s; /* of what a camera without a position sees */
	struct rb_film *film;
	struct rb_sink sink;
	struct rb_pump *pump;
	struct rb_film_tally tally;
	enum rb_status status;
};

struct rb_films {
	struct rb_loaded *loaded;
	const struct rb_film_module *module;
	struct film *film; /* [count] */
	int count;
	bool late;     /* those that are made when the run has ended are at work */
	bool shoots;   /* some camera has functions */
	bool has_last; /* then: `last` is the frame before */
	struct rb_frame last;
	struct rb_between between;
	struct rb_steering steering;
	double *switched_s; /* when pictures were left out, drawn again, ... */
	size_t switch_count, switch_capacity;
	atomic_int cut; /* the signal; set by anybody, after every film's own; 0: not */
};

/* Whether a film ended before its last picture. */
static inline bool rb_film_is_cut_short(const struct rb_film_tally *tally)
{
	return tally->pictures + tally->left_out < tally->picture_count;
}

#endif
