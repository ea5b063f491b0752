/* SPDX-License-Identifier: MIT */
#include "located/needed_parts.h"

static const struct rb_method_part rows[] = {
	{"flight", "a parabola from each body's own last event", 0},
	{"turning", "constant, symmetric and free tops, in closed form or a series to rounding",
         RB_FEATURE_ROTATION},
	{"queue", "the earliest event of each body", RB_FEATURE_CONTACT},
	{"cells", "who is near a body, from 48 bodies on", RB_FEATURE_CONTACT},
	{"impacts", "located touches; all that touch at once together", RB_FEATURE_CONTACT},
	{"clusters", "lasting contacts: rest, slide, roll, and their transitions",
         RB_FEATURE_CONTACT},
	{"integrator", "Gauss collocation of order 16, where a force has no closed form",
         RB_FEATURES_VARIED | RB_FEATURE_DRIVEN | RB_FEATURE_CONTACT | RB_FEATURE_FORCES |
                 RB_FEATURE_PUSHES | RB_FEATURE_JOINTS},
	{"gravitation", "what attracts each other has one clock; impacts go from touch to touch",
         RB_FEATURE_GRAVITATION},
	{"joints", "bodies that joints hold together, in one system with their contacts",
         RB_FEATURE_JOINTS},
	{"switches", "moments at which forces begin and end", RB_FEATURE_FORCES},
	{"callbacks", "every body as of the moment of each impact and transition",
         RB_FEATURE_HOOK_COLLISION | RB_FEATURE_HOOK_TRANSITION},
	{"steps", "the grid of time_step, for callbacks that push", RB_FEATURE_PUSHES},
};

const struct rb_method_part *rb_located_parts(int *count)
{
	*count = (int)(sizeof rows / sizeof rows[0]);
	return rows;
}
