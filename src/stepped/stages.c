/* SPDX-License-Identifier: MIT */
/*
 * The row of the stepped method in the table of methods, and the names of its stages, for its
 * description. The stages are not functions called in a loop, as those of the classic method are:
 * stepped.c runs them, and a step that fails runs some of them again.
 */
#include "stepped/stages.h"

#include "stepped/stepped.h"

static const struct rb_method_part rows[] = {
	{"drive", "driven bodies get the velocity to their next pose", RB_FEATURE_DRIVEN},
	{"gravity", "the acceleration of the world", RB_FEATURE_GRAVITY},
	{"gravity_force", "the same force on every body", RB_FEATURE_GRAVITY_FORCE},
	{"forces", "each body's list of forces", RB_FEATURE_FORCES},
	{"pushes", "forces applied by callbacks", RB_FEATURE_PUSHES},
	{"springs", "as they are, or as they will be where the step does not resolve them",
         RB_FEATURE_SPRINGS},
	{"gravitation",
         "attraction of all bodies, by pairs or a tree, at the beginning of the step",
         RB_FEATURE_GRAVITATION},
	{"field", "the scene's functions, at the beginning of the step", RB_FEATURE_FIELD},
	{"drag", "that of the velocity at the end of the step", RB_FEATURE_DRAG},
	{"near", "boxes for several steps: pairs that could touch", RB_FEATURE_CONTACT},
	{"points", "of these pairs, within the reach of the step", RB_FEATURE_CONTACT},
	{"joints", "rows from the poses of the step, drift taken back", RB_FEATURE_JOINTS},
	{"impacts", "by time within the step, each with all that touches", RB_FEATURE_RESTITUTION},
	{"solve", "impulses by groups: sweeps, or sparse factors", RB_FEATURE_CONTACT},
	{"move", "positions: solved velocities, parabolas", 0},
	{"turn", "orientations", RB_FEATURE_ROTATION},
	{"rebound", "impacts of groups too large for that, at once", RB_FEATURE_RESTITUTION},
	{"judge", "finite values, residual, no body past another", 0},
	{"close", "overlap that linearization has left, by positions only", RB_FEATURE_CONTACT},
	{"apart", "groups for which the step has failed go back and halve it", RB_FEATURE_CONTACT},
	{"tell", "contacts with their forces, impacts by time and ids", RB_FEATURE_CONTACT},
};

static const struct rb_method_part *parts(int *count)
{
	*count = (int)(sizeof rows / sizeof rows[0]);
	return rows;
}

const struct rb_method rb_method_stepped = {
	.name = "stepped",
	.what = "equal steps; what touches within one is solved together, to a residual, so that "
		"no gap closes beyond the tolerance; a step that fails is taken back and halved",
	.good_for = "heaps, stacks, towers of any shapes and masses",
	.mind = "contacts act through whole steps: errors fall with the first power of time_step; "
		"springs that a step does not resolve lose their oscillation",
	.steps = &rb_stepper_stepped,
	.parts = parts,
	.parts_title = "stages of a step",
};
