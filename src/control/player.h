/* SPDX-License-Identifier: MIT */
/*
 * Play, pause, step and stop of one run, shared by all who watch it: the gate through which the
 * simulator passes after each frame, and the numbers that `status` tells.
 *
 * Owned by whoever started the run. The gate belongs to the simulator's thread, everything else may
 * be called from any.
 */
#ifndef RB_CONTROL_PLAYER_H
#define RB_CONTROL_PLAYER_H

#include <stdbool.h>
#include <stdint.h>

#include <rbsim/frame.h>

#include "control/command.h"
#include "script/nearest.h"

struct rb_player;

/* KEEP: a checkpoint is asked for; the gate is to be passed once more after it. */
enum rb_player_verdict { RB_PLAYER_GO, RB_PLAYER_RESTART, RB_PLAYER_QUIT, RB_PLAYER_KEEP };

/* Collisions of the run so far, by the part of its time in which they were. */
enum { RB_PLAYER_PARTS = 200 };

/* What is known of the run at its last frame. */
struct rb_player_status {
	uint64_t frame, frame_count;
	double time_s, duration_s;
	double wall_s, paused_s; /* since the run began: without its pauses; of its pauses */
	bool begun;              /* a frame has passed the gate */
	bool pausing; /* a pause was asked for: the next frame, or this one, is the last */
	bool paused;  /* and has come: the run stands still */
	bool ended, stops_at_collision;
	bool has_films, filming; /* the run makes films; their pictures are drawn */
	uint64_t restarts;
	uint64_t collisions, rollbacks;          /* of the run so far */
	double smallest_step_s;                  /* of the run so far, 0: none was taken */
	double max_penetration_m;                /* of the run so far */
	double kinetic_energy, potential_energy; /* J */
	int ring_used, ring_slots;               /* 0 of 0: no ring */
	uint64_t part[RB_PLAYER_PARTS];          /* collisions */
};

RB_CHECKED enum rb_status rb_player_create(struct rb_player **player, uint64_t frame_count,
                                           double duration_s, struct rb_error *err);
void rb_player_destroy(struct rb_player *player); /* NULL is fine */

/* Simulator's thread: the run begins anew. Whether it is paused stays as it is. */
void rb_player_begin_again(struct rb_player *player, uint64_t frame_count, double duration_s);

/* What the gate is told of a frame. */
struct rb_player_frame {
	const struct rb_frame_numbers *numbers;
	uint64_t index;
	double time_s;
	int ring_used, ring_slots;
};

/*
 * The simulator's thread, after each frame was published: it is the one that the run stands at from
 * now on.
 */
void rb_player_arrive(struct rb_player *player, const struct rb_player_frame *frame);
/*
 * Then: waits while the run is paused (or until `stop` says that a signal ended it) and says what
 * is to be done next. Costs a lock that nobody holds for long. `stop` is asked while the gate
 * waits, some times a second.
 */
enum rb_player_verdict rb_player_gate(struct rb_player *player, bool (*stop)(void *user),
                                      void *user);
void rb_player_end(struct rb_player *player); /* the run is over: nothing waits any more */

void rb_player_play(struct rb_player *player);
void rb_player_pause(struct rb_player *player);
/* Then paused. Steps that are asked for while others are under way come on top of them. */
void rb_player_step(struct rb_player *player, uint64_t frames);
void rb_player_restart(struct rb_player *player);
void rb_player_keep(struct rb_player *player); /* a checkpoint */
void rb_player_quit(struct rb_player *player); /* the run ends as if interrupted */
void rb_player_stop_at_collision(struct rb_player *player, bool on);
void rb_player_film(struct rb_player *player, bool on);
/* The run that begins makes films, which are on at first. */
void rb_player_has_films(struct rb_player *player, bool has);
bool rb_player_filming(struct rb_player *player);
/*
 * Nobody is left who could say play, or somebody is: without anybody the gate never waits. True at
 * first.
 */
void rb_player_attend(struct rb_player *player, bool attended);
/* A film's camera is to be moved, from the frame at which the simulator's thread takes this. */
struct rb_player_aim {
	char camera[RB_COMMAND_TEXT_SIZE]; /* "": the only one */
	enum rb_camera_action action;      /* move, orbit or zoom */
	double vector[3], factor;          /* as of struct rb_command */
};
enum { RB_PLAYER_AIMS_MAX = 64 };
/* False: as many wait as may. */
bool rb_player_aim(struct rb_player *player, const struct rb_player_aim *aim);
bool rb_player_take_aim(struct rb_player *player,
                        struct rb_player_aim *aim); /* False: none waits. */
struct rb_player_status rb_player_status(struct rb_player *player);

/* What a movement may be for: the films of a scene and the cameras that make them. */
struct rb_player_movable {
	const char *name;  /* that is asked for, "": any */
	bool found, early; /* the latter: one whose film is drawn during the run */
	struct rb_nearest nearest;
};

/* Fills the rest by the cameras and films of a scene; `name` and `nearest` are set. */
void rb_player_consider_films(struct rb_player_movable *movable, const struct rb_scene *scene);

#endif
