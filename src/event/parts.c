/* SPDX-License-Identifier: MIT */
#include "event/parts.h"

#include "model/features.h"

static const struct rb_part rows[] = {
	{"flight", "a parabola from each body's own last event", 0},
	{"turning", "constant, symmetric and free tops, in closed form or a series to rounding",
         RB_FEATURE_ROTATION},
	{"queue", "the earliest event of each body", RB_FEATURE_CONTACT},
	{"cells", "who is near a body, from 48 bodies on", RB_FEATURE_CONTACT},
	{"impacts", "located touches; all that touch at once together", RB_FEATURE_CONTACT},
	{"clusters", "lasting contacts: rest, slide, roll, and their transitions",
         RB_FEATURE_CONTACT},
	{"integrator", "Gauss collocation of order 16, where a force has no closed form",
         RB_FEATURES_NOT_CLASSIC | RB_FEATURE_CONTACT | RB_FEATURE_FORCES | RB_FEATURE_PUSHES},
	{"switches", "moments at which forces begin and end", RB_FEATURE_FORCES},
	{"callbacks", "every body as of the moment of each impact and transition",
         RB_FEATURE_HOOK_COLLISION | RB_FEATURE_HOOK_TRANSITION},
	{"steps", "the grid of time_step, for callbacks that push", RB_FEATURE_PUSHES},
};

const struct rb_part *rb_parts(int *count)
{
	*count = (int)(sizeof rows / sizeof rows[0]);
	return rows;
}

bool rb_part_is_used(const struct rb_part *part, const struct rb_model *model)
{
	return part->need == 0 || (model->features & part->need) != 0;
}

const char *rb_part_why_not(const struct rb_part *part, const struct rb_model *model)
{
	int count = 0;
	const struct rb_feature_row *row = rb_feature_rows(&count);

	for (int k = 0; k < count && !rb_part_is_used(part, model); k++)
		if (row[k].bit & part->need)
			return row[k].absent;
	return "";
}
