/* SPDX-License-Identifier: MIT */
/*
 * A running world: a sealed model, the state that steps change, and the plan that changes it.
 *
 * Owned by one thread, the simulator's; nobody else may touch it while a run goes on. `id` is the
 * body's place in the scene, in [0, rb_world_id_count): moving and static bodies alike.
 */
#ifndef RBSIM_WORLD_H
#define RBSIM_WORLD_H

#include <stdbool.h>
#include <stdint.h>

#include <rbsim/error.h>
#include <rbsim/frame.h>
#include <rbsim/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

struct rb_model;
struct rb_world;

/* What a `motion` function returns. */
struct rb_driven_pose {
	rb_vec3 position;    /* m, of the object's origin */
	rb_quat orientation; /* a unit quaternion; the body's own when the function returns none */
	bool has_velocity, has_angular_velocity; /* else they are to be differenced */
	rb_vec3 velocity, angular_velocity;      /* m/s of the object's origin; rad/s, world axes */
};

/*
 * Called by the step, on the thread that runs it, where a scene asks for it: optional, NULL is
 * free. A status other than RB_OK ends the run with it. They may read the world and change it
 * through the rb_world_* calls below.
 */
struct rb_world_hooks {
	void *user;
	enum rb_status (*step)(void *user, struct rb_world *world, double time_s, double dt_s,
	                       struct rb_error *err);
	enum rb_status (*collision)(void *user, struct rb_world *world,
	                            const struct rb_event *event, struct rb_error *err);
	/* a transition of a lasting contact (located method) */
	enum rb_status (*transition)(void *user, struct rb_world *world,
	                             const struct rb_event *event, struct rb_error *err);
	/*
	 * Sums of the scene's fields on the body of that id at {position, velocity}, N: force[0] of
	 * those without and force[1] of those with a potential; NULL where it has none. Depends on
	 * nothing but its arguments.
	 */
	enum rb_status (*field)(void *user, int id, double time_s, const rb_vec3 at[2],
	                        rb_vec3 force[2], struct rb_error *err);
	/* Sum of their potentials, J; NULL where no field has one. */
	enum rb_status (*potential)(void *user, int id, double time_s, rb_vec3 position,
	                            double *energy, struct rb_error *err);
	/*
	 * Pose of a driven body, by id, at a time; NULL where the scene has none. Depends on
	 * nothing but these.
	 */
	enum rb_status (*motion)(void *user, int id, double time_s, struct rb_driven_pose *pose,
	                         struct rb_error *err);
	/*
	 * Angle or way, rad or m, that the motor of a joint follows, by the joint's number, and its
	 * rate, rad/s or m/s, NAN: it is differenced; NULL where none follows any. Depends on
	 * nothing but these.
	 */
	enum rb_status (*follow)(void *user, int joint, double time_s, double value[2],
	                         struct rb_error *err);
};

/* Of these, the functions that the world asks for values; nothing is called back. */
static inline struct rb_world_hooks rb_world_hooks_asked(const struct rb_world_hooks *all)
{
	struct rb_world_hooks asked = *all;

	asked.step = NULL;
	asked.collision = NULL;
	asked.transition = NULL;
	return asked;
}

/* Set before the first step, then only read. */
struct rb_world_options {
	int threads;        /* workers of the simulator; 0: one */
	bool keep_events;   /* for the frames */
	bool keep_contacts; /* for the frames */
	/*
	 * Polled while a step is at work, by any of its threads, one at a time; true ends the run
	 * where the last whole step has. May be NULL.
	 */
	bool (*stop)(void *user);
	void *stop_user;
};

/* The world takes its starting values from the model, which must outlive it. */
RB_CHECKED enum rb_status rb_world_create(struct rb_world **world, const struct rb_model *model,
                                          const struct rb_world_options *options,
                                          const struct rb_world_hooks *hooks, struct rb_error *err);
void rb_world_destroy(struct rb_world *world); /* NULL is fine */

/*
 * Advances to the next frame: k becomes k + 1. RB_ERR_PHYSICS when no step resolves an overlap or a
 * state is not finite; the world is then at the last good step. RB_OK with rb_world_stopped when
 * `stop` said so.
 */
RB_CHECKED enum rb_status rb_world_step_frame(struct rb_world *world, struct rb_error *err);
bool rb_world_stopped(const struct rb_world *world);

uint64_t rb_world_frame(const struct rb_world *world); /* k */
uint64_t rb_world_frame_count(
	const struct rb_world *world);              /* of the whole run, frame 0 included */
double rb_world_time(const struct rb_world *world); /* s */
/*
 * Largest overlap that a frame may show by now, m: of auto that of steps once there was one, since
 * arcs keep what steps have left between bodies in contact.
 */
double rb_world_tolerance(const struct rb_world *world);
uint64_t rb_world_hash(const struct rb_world *world); /* of all that decides the future */

/*
 * Fills the columns that `frame` has, its numbers, events and contacts, and begins to count anew
 * for the next frame. Fails on memory only (events).
 */
RB_CHECKED enum rb_status rb_world_fill_frame(struct rb_world *world, struct rb_frame *frame,
                                              struct rb_error *err);
/* Numbers of this moment; counts are of the whole run. */
struct rb_frame_numbers rb_world_totals(struct rb_world *world);
/* Stepped: contacts of a group at most whose impacts are passed on one by one. */
enum { RB_IMPACT_CONTACTS = 200 };
/*
 * Accepted and discarded (rolled back) body substeps of the whole run, and pair tests of the
 * broadphase.
 */
struct rb_world_work {
	uint64_t body_steps, discarded_body_steps, pair_tests;
	uint64_t
		/* clusters of impacts that were ended without restitution after all rounds */
		plastic_ends;
	/*
	 * stepped: impacts of groups that are too large to be passed on one by one, and the energy
	 * of their approach, J
	 */
	uint64_t crowded_impacts;
	double crowded_energy_j;
	/*
	 * stepped: contact points of all steps, times that one was swept, factorizations, moves of
	 * positions only
	 */
	uint64_t rows, row_sweeps, factors, closings;
	double residual_m; /* stepped: the largest that a solution left of a gap's closing */
	/* stepped: the largest slip that was left where friction was held; 0: nowhere */
	double slip_m;
};
struct rb_world_work rb_world_work(const struct rb_world *world);

/* What acts on a body at this moment, contacts included, and what it does. */
struct rb_load {
	rb_vec3 force;                /* N */
	rb_vec3 torque;               /* N m, about the centre of mass, world axes */
	rb_vec3 acceleration;         /* m/s^2, of the centre of mass */
	rb_vec3 angular_acceleration; /* rad/s^2, world axes */
};
/*
 * Of a body, by id; changes nothing. Located motion has them from its arcs on; of steps contacts
 * have the mean force of the step that has ended. Forces of callbacks are those of the step under
 * way or, between steps, of the one that has ended. Of a driven or static body force and torque are
 * what contacts and springs do to it.
 */
RB_CHECKED enum rb_status rb_world_load(struct rb_world *world, int id, struct rb_load *load,
                                        struct rb_error *err);

/* A joint at a moment. */
struct rb_joint_reading {
	/*
	 * of a hinge: its angle, rad, turns counted; slider, cylindrical: its way, m; rod, rope:
	 * the distance of its ends, m; else 0
	 */
	double angle;
	double speed;   /* rad/s or m/s, of it */
	rb_vec3 force;  /* N: what the joint exerts on b, or on the world, at its point there */
	rb_vec3 torque; /* N m, with it */
	bool released;
};
/* By the joint's number in the scene; changes nothing. */
RB_CHECKED enum rb_status rb_world_joint(struct rb_world *world, int joint,
                                         struct rb_joint_reading *reading, struct rb_error *err);
/*
 * m: by how far its points, or its way beyond a limit, are off; 0 once it is released. `allowed`:
 * at the start.
 */
double rb_world_joint_gap(const struct rb_world *world, int joint, double *allowed);

int rb_world_id_count(const struct rb_world *world);
bool rb_world_is_static(const struct rb_world *world, int id);
double rb_world_mass(const struct rb_world *world, int id); /* kg; INFINITY: static */
rb_mat3 rb_world_inertia(const struct rb_world *world,
                         int id); /* kg m^2, object axes; zero: static */
rb_vec3 rb_world_position(const struct rb_world *world, int id); /* m, of the object's origin */
rb_quat rb_world_orientation(const struct rb_world *world, int id);
rb_vec3 rb_world_velocity(const struct rb_world *world, int id); /* m/s, of the centre of mass */
rb_vec3 rb_world_angular_velocity(const struct rb_world *world, int id);
double rb_world_kinetic_energy(const struct rb_world *world, int id); /* J */
rb_vec3 rb_world_momentum(const struct rb_world *world, int id);
rb_vec3 rb_world_angular_momentum(const struct rb_world *world, int id); /* about the origin */
rb_vec3 rb_world_point(const struct rb_world *world, int id,
                       rb_vec3 point_local); /* world position */

/* Changes from callbacks; `id` must be a moving body, values finite. Points are world positions. */
void rb_world_apply_impulse(struct rb_world *world, int id, rb_vec3 impulse, rb_vec3 point);
/* Holds until the next step hook. */
void rb_world_apply_force(struct rb_world *world, int id, rb_vec3 force, rb_vec3 point);
/* N m, as long. */
void rb_world_apply_torque(struct rb_world *world, int id, rb_vec3 torque);
void rb_world_set_velocity(struct rb_world *world, int id, rb_vec3 velocity);
void rb_world_set_angular_velocity(struct rb_world *world, int id, rb_vec3 angular_velocity);
void rb_world_set_position(struct rb_world *world, int id, rb_vec3 position);
/*
 * Changes of a joint from callbacks: the speed that its motor keeps and the most that it exerts
 * (NAN: as before; a motor that follows a function does so no longer once it has a speed); its end.
 */
void rb_world_joint_set_motor(struct rb_world *world, int joint, double speed, double max);
/* Its motor follows this angle, rad, or way, m, from now on; NAN: the function of the scene. */
void rb_world_joint_follow(struct rb_world *world, int joint, double angle);
void rb_world_joint_release(struct rb_world *world, int joint);
/* Where an impulse or force goes that names no point: the centre of mass, world. */
rb_vec3 rb_world_center_of_mass(const struct rb_world *world, int id);

#ifdef __cplusplus
}
#endif
#endif
