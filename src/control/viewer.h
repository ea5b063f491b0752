/* SPDX-License-Identifier: MIT */
/*
 * What a console shows: which frame, when, from where; and what it has to say. Knows no terminal:
 * whoever has one calls rb_viewer_tick, draws, tells when that was done, and waits until
 * rb_viewer_next.
 *
 * One thread. Times are those of base/clock, handed in.
 */
#ifndef RB_CONTROL_VIEWER_H
#define RB_CONTROL_VIEWER_H

#include <stdbool.h>

#include "control/command.h"
#include "control/pace.h"
#include "control/session.h"
#include "control/source.h"
#include "control/steer.h"
#include "flow/framing.h"

struct rb_script;

enum { RB_VIEWER_LOG_LINES = 200, RB_VIEWER_LOG_SIZE = 200 };

/* Why a console ends. */
enum rb_viewer_wish {
	RB_VIEWER_GOES_ON,
	RB_VIEWER_QUITS,
	RB_VIEWER_RELOADS, /* the run began anew: its scene may be another one */
	RB_VIEWER_RESTARTS /* a run that has ended is to be started again (options.run) */
};

struct rb_viewer_options {
	struct rb_source *source; /* borrowed, as all below */
	const struct rb_model *model;
	struct rb_script *script; /* for cameras with functions; NULL: they stand still */
	const char *name;         /* of what is viewed: a file, a socket */
	double fps;               /* pictures a second at most */
	double speed;
	bool live; /* begins with the newest frame and stays with it */
	/* a run that can be started again once it has ended; NULL: it cannot */
	struct rb_viewer_run *run;
};

/* A run of the console's own. */
struct rb_viewer_run {
	struct rb_session_set sets[RB_SESSION_SETS_MAX]; /* for when it is started again */
	int set_count;
	/* Whether its process has ended; how, as the exit status of a shell tells it. */
	bool (*ended)(void *user, int *exit_code);
	void *user;
};

struct rb_viewer {
	/* set once */
	struct rb_viewer_options options;

	/* what is shown */
	struct rb_frame frame; /* a copy */
	bool has_frame;
	uint64_t row;
	uint64_t picture; /* counts up when there is something else to be drawn: frame or camera */
	uint64_t drawn, drawn_count; /* the last one that came to the screen; how many did */

	/* how it goes on */
	bool playing;  /* the view's own; a run may stand still besides */
	bool live;     /* stays with the newest frame */
	bool starved;  /* wants frames that the run has not made yet */
	bool stops;    /* at collisions */
	bool has_goal; /* steps that the run has yet to make */
	uint64_t goal; /* row */
	double speed;
	rb_pace pace;
	rb_pace wished;  /* the same, had it never had to wait for frames */
	uint64_t due_ns; /* of the frame that is shown; 0: it was not a matter of time */
	uint64_t tick_ns, restarts;
	struct rb_lateness lateness;
	enum rb_viewer_wish wish;

	/* from where */
	struct rb_camera_def camera;
	const char *camera_name; /* "" for one without a name */
	int camera_index;        /* in the scene; -1: the scene has none */
	bool camera_moved;       /* by hand */
	struct rb_frame_shot shot;
	bool has_shot;
	bool reframes;             /* something went where nothing was, since it was placed */
	struct rb_framing framing; /* of what was seen so far, for a camera without a position */
	int inspected, followed;   /* ids, -1: none */

	/* what is said: line n in [n % RB_VIEWER_LOG_LINES] */
	uint64_t log_count;
	char log[RB_VIEWER_LOG_LINES][RB_VIEWER_LOG_SIZE];
	bool wants_help;
	bool wants_end; /* the run has ended, and it is not said how */
};

RB_CHECKED enum rb_status rb_viewer_create(struct rb_viewer **viewer,
                                           const struct rb_viewer_options *options, uint64_t now_ns,
                                           struct rb_error *err);
void rb_viewer_destroy(struct rb_viewer *viewer); /* NULL is fine */

/* Looks at the source, and goes on to the frame that belongs on the screen now. */
void rb_viewer_tick(struct rb_viewer *viewer, uint64_t now_ns);
/* The frame of the last tick is on the screen. */
void rb_viewer_shown(struct rb_viewer *viewer, uint64_t now_ns);
/* When the next tick makes sense, never later than a quarter of a second. */
uint64_t rb_viewer_next(const struct rb_viewer *viewer, uint64_t now_ns);

/* A line for the log. */
void rb_viewer_say(struct rb_viewer *viewer, const char *format, ...) RB_PRINTF(2, 3);

/* ---- for control/orders ---- */

/* The frame of a row at once, or the nearest one that there is. */
void rb_viewer_go(struct rb_viewer *viewer, uint64_t row, uint64_t now_ns);
/* Time goes on from the frame that is shown. */
void rb_viewer_pace(struct rb_viewer *viewer, uint64_t now_ns);
/* The number-th camera of the scene, -1: one that shows the start. */
void rb_viewer_take_camera(struct rb_viewer *viewer, int number);
/*
 * The camera goes where it sees all that moves: in the whole recording, or in what was seen of a
 * run.
 */
void rb_viewer_show_all(struct rb_viewer *viewer);
struct rb_stand rb_viewer_stand(const struct rb_viewer *viewer);
/* Where the frame's camera stands, for one with functions; and something is to be drawn. */
void rb_viewer_aim(struct rb_viewer *viewer);
/* At the last frame that there is. */
bool rb_viewer_at_end(const struct rb_viewer *viewer);
/* "playing", "paused", ...: of the view and of the run, for people. */
const char *rb_viewer_state(const struct rb_viewer *viewer);

#endif
