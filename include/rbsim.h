/* SPDX-License-Identifier: MIT */
/*
 * librbsim: rigid-body scenes from C, see rbsim(3).
 *
 * Open a scene, step it frame by frame, read its bodies, record it; open a recording and read its
 * frames. SI units, radians, right-handed axes.
 *
 * Functions that can fail return RBSIM_OK or another status and fill `error`, which may be NULL.
 * NULL in place of a handle or of a result is refused with RBSIM_USAGE; nothing prints, exits or
 * aborts for what a caller, a scene or a file has got wrong. A handle belongs to one thread at a
 * time; different simulations may run in different threads, but HDF5 serves one thread at a time:
 * calls that record or read recordings must not overlap.
 *
 * Stable within a major version: members are appended to structs, `size` says which ones a caller
 * knows, and what the library returns a pointer to it owns.
 */
#ifndef RBSIM_H
#define RBSIM_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RBSIM_VERSION "0.1.0"

#if defined(__GNUC__)
#define RBSIM_CHECKED __attribute__((warn_unused_result))
#else
#define RBSIM_CHECKED
#endif

/* Statuses are the exit statuses of rbsim(1). */
enum rbsim_status {
	RBSIM_OK = 0,
	RBSIM_USAGE = 64,   /* a call is wrong */
	RBSIM_SCENE = 65,   /* the scene is wrong, at load or in a callback */
	RBSIM_INPUT = 66,   /* a file is missing or not what it claims to be */
	RBSIM_MISSING = 69, /* something of the system that is needed is absent */
	RBSIM_BUG = 70,     /* ours */
	RBSIM_MEMORY = 71,
	RBSIM_CREATE = 73, /* a recording cannot be created: it exists, no permission, no space */
	RBSIM_IO = 74,     /* a write failed */
	RBSIM_PHYSICS = 76 /* no step resolves an overlap, or a state is not finite */
};

struct rbsim_error {
	enum rbsim_status status;
	char text[256]; /* for people; "" after RBSIM_OK */
};

/* Version of the library that runs; RBSIM_VERSION is that of the header. */
const char *rbsim_version(void);

/*
 * A moment of the moving bodies, in the order of the scene. Columns are NULL where a scene cannot
 * change them (without rotation no orientation) or a recording has not stored them.
 */
struct rbsim_frame {
	uint64_t index; /* frame k is at k / frame_rate */
	double time_s;
	int body_count;
	const double *position;         /* [body_count][3] m, of the object's origin */
	const double *orientation;      /* [body_count][4] w, x, y, z: world = q local q* */
	const double *velocity;         /* [body_count][3] m/s, of the centre of mass */
	const double *angular_velocity; /* [body_count][3] rad/s, world axes */
	double kinetic_energy;          /* J */
	double potential_energy;        /* J */
	double momentum[3];             /* kg m/s */
	double angular_momentum[3];     /* kg m^2/s, about the origin */
	double max_penetration;         /* m, >= 0: the largest overlap */
	uint64_t contact_count;         /* contacts that last at this moment */
	uint64_t collision_count;       /* impacts since the frame before */
};

/* ---- simulation ---- */

struct rbsim_simulation;

/* Zeroed but for `size` is a good start: the scene as it stands, not recorded. */
struct rbsim_options {
	size_t size;               /* sizeof (struct rbsim_options) */
	const char *const *params; /* "NAME=VALUE" each, as with rbsim --param */
	int param_count;
	const char *record; /* name of the recording; NULL: none */
	int replace;        /* not 0: an existing file may be replaced */
	int has_seed;       /* not 0: `seed` in place of the scene's */
	uint64_t seed;
	int threads; /* workers of the simulator; 0: one. Results do not depend on it */
};

/*
 * Loads a scene and makes its frame 0. `options` may be NULL. `*simulation` is NULL after a
 * failure. With `record`, frame 0 is in the recording.
 */
RBSIM_CHECKED enum rbsim_status rbsim_open(struct rbsim_simulation **simulation, const char *scene,
                                           const struct rbsim_options *options,
                                           struct rbsim_error *error);
/* Closes the recording, marked as interrupted if the run is not over; NULL is fine. */
void rbsim_close(struct rbsim_simulation *simulation);

/*
 * Advances to the next frame. RBSIM_USAGE once the run is over. After any other failure the frame
 * is still the last good one, and further calls fail the same way.
 */
RBSIM_CHECKED enum rbsim_status rbsim_step(struct rbsim_simulation *simulation,
                                           struct rbsim_error *error);
/* 1 once the last frame of the scene's duration is there, or a step has failed; 1 of NULL. */
int rbsim_is_over(const struct rbsim_simulation *simulation);
/* Frames of the whole run, frame 0 included. */
uint64_t rbsim_frame_count(const struct rbsim_simulation *simulation);
/* The present frame; the simulation's, its numbers hold until the next call of rbsim_step. */
const struct rbsim_frame *rbsim_frame(const struct rbsim_simulation *simulation);

/*
 * Name of the moving body `body` of the frame's columns, "" where it has none or there is no such
 * body; and the body of that name, -1 where there is none.
 */
const char *rbsim_name(const struct rbsim_simulation *simulation, int body);
int rbsim_find(const struct rbsim_simulation *simulation, const char *name);
/* kg; INFINITY of a driven body; NAN where there is no such body. */
double rbsim_mass(const struct rbsim_simulation *simulation, int body);

/*
 * A `result` of the scene, by name, once the run is over. RBSIM_USAGE where there is no such
 * result or the run goes on.
 */
RBSIM_CHECKED enum rbsim_status rbsim_result(const struct rbsim_simulation *simulation,
                                             const char *name, double *value,
                                             struct rbsim_error *error);
/*
 * Closes the recording and says whether all of it was written; of use before rbsim_close, which
 * cannot tell. The simulation may be read on but not stepped. RBSIM_USAGE without a recording.
 */
RBSIM_CHECKED enum rbsim_status rbsim_finish_recording(struct rbsim_simulation *simulation,
                                                       struct rbsim_error *error);

/* ---- recordings ---- */

struct rbsim_recording;

/* Opens a recording that is complete, still grows or was cut off; `*recording` NULL on failure. */
RBSIM_CHECKED enum rbsim_status rbsim_recording_open(struct rbsim_recording **recording,
                                                     const char *path, struct rbsim_error *error);
void rbsim_recording_close(struct rbsim_recording *recording); /* NULL is fine */

/* Frames that are stored, as they were when it was opened or last refreshed. */
uint64_t rbsim_recording_frame_count(const struct rbsim_recording *recording);
/* Looks again at a recording that grows. */
RBSIM_CHECKED enum rbsim_status rbsim_recording_refresh(struct rbsim_recording *recording,
                                                        struct rbsim_error *error);
/* "complete", "running", "interrupted" or "failed"; "" of NULL. Holds until it is closed. */
const char *rbsim_recording_status(const struct rbsim_recording *recording);
/*
 * The frame of a row, from 0; the recording's, it holds until the next call of this function or of
 * rbsim_recording_refresh. `*frame` is NULL after a failure.
 */
RBSIM_CHECKED enum rbsim_status rbsim_recording_frame(struct rbsim_recording *recording,
                                                      uint64_t row,
                                                      const struct rbsim_frame **frame,
                                                      struct rbsim_error *error);
/* As rbsim_name and rbsim_find. */
const char *rbsim_recording_name(const struct rbsim_recording *recording, int body);
int rbsim_recording_find(const struct rbsim_recording *recording, const char *name);

#ifdef __cplusplus
}
#endif
#endif
