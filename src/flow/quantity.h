/* SPDX-License-Identifier: MIT */
/*
 * Quantities of frames that have names: of the whole world (energy, momentum), of a body behind its
 * name and a point (z, vx, speed, rx), of a joint (angle, force). Diagrams of `rbsim plot`, tables
 * and films read them. Values and constant tables; any thread.
 *
 * The rotation of a body since the first frame is told as a vector, its axis times the angle
 * (rx, ry, rz). As the logarithm of a rotation it is known but for whole turns about its axis; of
 * these it takes the one nearest to the frame before. So it grows on while a body spins about an
 * axis that keeps its direction, if it turns less than half a turn from frame to frame.
 *
 * Roll, pitch and yaw are those of z-y'-x'': the body is turned by yaw about z, then by pitch about
 * its new y, then by roll about its new x; at a pitch of a quarter turn only their sum is known.
 */
#ifndef RB_FLOW_QUANTITY_H
#define RB_FLOW_QUANTITY_H

#include <rbsim/frame.h>
#include <rbsim/model.h>

/* The rotation of a body from frame to frame; zeroed to begin with. */
struct rb_quantity_turn {
	bool begun;
	rb_quat first;
	rb_vec3 turn;
};

/* A part's number by its name; -1: there is none. NULL behind the last number. */
int rb_body_part_named(const char *name);
int rb_joint_part_named(const char *name);
int rb_world_part_named(const char *name);
const char *rb_world_part_name(int part);

/* RB_FIELD_* that it needs. */
unsigned rb_body_part_field(int part);
const char *rb_body_part_units(int part);
/* Units of joints depend on their kind. */
const char *rb_joint_part_units(int part, int kind);
const char *rb_world_part_units(int part);
/* Whether joints of this kind have it. */
bool rb_joint_part_is_of(int part, int kind);

/*
 * The value at a frame, of a body by its index in the columns, of a joint by its number. False: the
 * frame does not have it.
 */
bool rb_body_part_value(int part, const struct rb_frame *frame, int body,
                        struct rb_quantity_turn *turn, double *value);
bool rb_joint_part_value(int part, const struct rb_frame *frame, int joint, double *value);
double rb_world_part_value(int part, const struct rb_frame *frame);

/*
 * Magnitudes that rounding of these values is relative to, of a frame that has them: of the vector
 * that a value is a component of, and of what gravity makes of a body of that size.
 */
double rb_body_part_magnitude(int part, const struct rb_model *model, const struct rb_frame *frame,
                              int body);
double rb_joint_part_magnitude(int part, const struct rb_model *model, const struct rb_frame *frame,
                               int joint);
double rb_world_part_magnitude(int part, const struct rb_model *model,
                               const struct rb_frame *frame);
/* Whether values between these are one up to rounding. */
bool rb_quantity_is_flat(double low, double high, double magnitude);

#endif
