/* SPDX-License-Identifier: MIT */
/*
 * What a consumer may see of one moment: poses, contacts, numbers.
 *
 * A frame is a slot of the ring or of a reader. Its columns are preallocated; a column nobody asked
 * for, or that the scene cannot change, is NULL. Read only for sinks, valid until their `frame`
 * call returns.
 */
#ifndef RBSIM_FRAME_H
#define RBSIM_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#include <rbsim/error.h>
#include <rbsim/ledger.h>
#include <rbsim/math.h>
#include <rbsim/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * collision: touching and approaching bodies, once each. The others are transitions of a lasting
 * contact of the located method: to rest (neither slides nor rolls), to sliding, to rolling (or
 * spinning) without slip, lift: it ends; edge: it goes on at a rim or corner; merge: infinitely
 * many impacts have ended in it. Their impulse and approach speed are 0.
 *
 * Impulse, angular impulse and displacement are changes that a callback has made to one body, a ==
 * b, which is then at `point` with its centre of mass; their normal and approach speed are 0, and
 * `impulse` holds the change: of momentum, N s; of angular momentum about the centre of mass, N m
 * s; of position, m.
 *
 * The last five are of joints, a == b where the other end is the world. Impacts: one has met its
 * limit (impulse N s along the axis, or N m s about it; approach speed m/s or rad/s), a rope has
 * come taut. Transitions: a rope is taut no longer; motor or friction holds the joint at its speed,
 * or suffices no more.
 */
enum rb_event_kind {
	RB_EVENT_COLLISION,
	RB_EVENT_REST,
	RB_EVENT_SLIDE,
	RB_EVENT_ROLL,
	RB_EVENT_LIFT,
	RB_EVENT_EDGE,
	RB_EVENT_MERGE,
	RB_EVENT_IMPULSE,
	RB_EVENT_ANGULAR_IMPULSE,
	RB_EVENT_DISPLACEMENT,
	RB_EVENT_LIMIT,
	RB_EVENT_TAUT,
	RB_EVENT_SLACK,
	RB_EVENT_DRIVES,
	RB_EVENT_SLIPS,
	RB_EVENT_KIND_COUNT
};

/* "collision", "rest", ... as in scenes and recordings. */
const char *rb_event_kind_name(enum rb_event_kind kind);

/* Impacts call on_collision, all other kinds that callbacks are told of on_transition. */
static inline bool rb_event_is_impact(enum rb_event_kind kind)
{
	return kind == RB_EVENT_COLLISION || kind == RB_EVENT_LIMIT || kind == RB_EVENT_TAUT;
}

struct rb_event {
	double time_s;
	enum rb_event_kind kind; /* which of the fields below it has: rbsim-recording(5) */
	int a, b;                /* ids, a < b, or a == b: of one body */
	rb_vec3 point;           /* m, world */
	rb_vec3 normal;          /* unit, from a to b */
	rb_vec3 impulse;         /* N s, on b */
	double approach_speed;   /* m/s, > 0, along the normal */
	int joint;               /* 1 + the number of the joint that it is of; 0: of none */
};

/* A contact that lasts, as seen at a frame. */
struct rb_frame_contact {
	int a, b; /* ids, a < b */
	rb_vec3 point, normal;
	rb_vec3 force; /* N, on b */
	double gap;    /* m, negative: overlap */
};

/* Numbers of the whole scene at a frame; counts are since the frame before. */
struct rb_frame_numbers {
	double kinetic_energy, potential_energy; /* J; zero of potential at the origin */
	rb_vec3 momentum, angular_momentum;      /* kg m/s; kg m^2/s about the origin */
	/* kg, m: of all where they attract each other, and nothing fixed does; otherwise zeros */
	double mass;
	rb_vec3 center_of_mass;
	double max_penetration;                   /* m, >= 0 */
	uint64_t contacts;                        /* lasting now */
	uint64_t collisions, rollbacks, substeps; /* substeps: accepted, all groups */
	double smallest_step;                     /* s, the smallest substep tried */
	double stepped; /* s that the classic method has simulated, the rest was located */
	/*
	 * where steps sum gravitation by a tree: the largest error of an acceleration among bodies
	 * chosen at random, as a share of it; a bound of that of its potential energy; otherwise 0
	 */
	double gravitation_error, gravitation_energy_error;
	bool has_ledger;
	struct rb_ledger_values ledger; /* zeros without one */
};

/*
 * Where a camera that moves by functions of time, or that commands have moved, stands at one of its
 * pictures. Made by whoever fills the frame, because only that thread may run the scene's Lua; the
 * picture's time lies after that of the frame before and not after that of this one.
 */
struct rb_frame_shot {
	int camera;                    /* its place in the list of cameras that are filmed */
	uint64_t picture;              /* the number of the picture, from 0 */
	rb_vec3 position, look_at, up; /* m, m, any length; world */
	/* by commands: all three hold, whatever the camera is on; else those of functions */
	bool steered;
	/* by commands: an orthographic picture shows so many times less; 1: as much as ever */
	double enlarged;
	char text[RB_CAMERA_TEXTS_MAX][RB_CAMERA_TEXT_SIZE]; /* what functions of texts return */
};

struct rb_frame {
	uint64_t index; /* k: frame k is at k / frame_rate */
	double time_s;
	int body_count; /* moving bodies, in the order of the scene */

	double *position;    /* [body_count][3] m, of the object's origin */
	double *orientation; /* [body_count][4] w, x, y, z; NULL when nothing can turn */
	double *velocity;    /* [body_count][3] m/s, of the centre of mass */
	/* [body_count][3] rad/s, world axes; NULL when nothing can turn */
	double *angular_velocity;
	double *acceleration;         /* [body_count][3] m/s^2, of the centre of mass */
	double *angular_acceleration; /* [body_count][3] rad/s^2; NULL when nothing can turn */
	double *force;                /* [body_count][3] N, of all that acts: struct rb_load */
	double *torque;               /* [body_count][3] N m; NULL when nothing can turn */

	int joint_count; /* of the scene */
	/*
	 * NULL unless asked for and there are joints: [joint_count] of rb_joint_reading, the last
	 * two [joint_count][3]
	 */
	double *joint_value, *joint_speed, *joint_force, *joint_torque;

	struct rb_frame_numbers numbers; /* of the whole world */
	double *probes; /* [probe_count] of the scene, in its order; NULL: it has none */
	int probe_count;

	struct rb_event *events; /* since the frame before, in order of time */
	int event_count, event_capacity;
	bool has_events; /* nobody is told of any, else */
	struct rb_frame_contact *contacts;
	int contact_count, contact_capacity; /* of `contacts` */
	struct rb_frame_shot
		*shots; /* by camera, then picture; NULL where no camera has functions */
	int shot_count, shot_capacity;
};

#ifdef __cplusplus
}
#endif
#endif
