/* SPDX-License-Identifier: MIT */
/*
 * Where joints and springs are in a frame, for whoever draws them: pictures, the console's sketch.
 *
 * Pure functions of a model and a frame that has positions and, where bodies turn, orientations.
 */
#ifndef RB_FLOW_JOINT_VIEW_H
#define RB_FLOW_JOINT_VIEW_H

#include <rbsim/frame.h>
#include <rbsim/model.h>

#include "math/vec3.h"

struct rb_joint_place {
	rb_vec3 a, b;           /* m: its point of a and that of b */
	rb_vec3 axis_a, axis_b; /* unit; of a ball joint any */
};

/* False: nothing is to be seen of it, because it was released or is not `visible`. */
bool rb_joint_place(const struct rb_model *model, const struct rb_frame *frame, int joint,
                    struct rb_joint_place *place);

/* The ends of a spring, by its number. False: neither of its bodies is visible. */
bool rb_spring_ends(const struct rb_model *model, const struct rb_frame *frame, int spring,
                    rb_vec3 end[2]);

/*
 * m: of a spring's coil: a part of the smaller body, of a typical diameter `size_m` and of the
 * length at rest; the same in all frames.
 */
double rb_spring_radius(const struct rb_model *model, int spring, double size_m);
/* More springs than these are lines. */
enum { RB_COILS_MAX = 64 };
/* Points of a coil, straight at its ends. */
enum { RB_COIL_TURNS = 10, RB_COIL_POINTS = 12 * RB_COIL_TURNS + 3 };
/* The k-th one: x and y in radii, z in lengths. */
rb_vec3 rb_coil_point(int k);

/* m: half the thickness of what is drawn. */
double rb_joint_radius(const struct rb_model *model, int joint);

/* Straight pieces that a rope is drawn with. */
enum { RB_ROPE_PIECES = 16 };
/*
 * A rope between two points, m, that is not shorter than their distance: straight where it is
 * taut, else it hangs in a parabola along `down` (any length; 0: along -z).
 */
void rb_joint_rope(const struct rb_joint_place *place, double length, rb_vec3 down,
                   rb_vec3 point[RB_ROPE_PIECES + 1]);

/* sRGB in [0, 1]. */
void rb_joint_color(const struct rb_scene *scene, int joint, double color[3]);

#endif
