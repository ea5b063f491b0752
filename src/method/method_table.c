/* SPDX-License-Identifier: MIT */
/*
 * All methods, a line each (model/descriptor). A new one needs a line here, one in enum
 * rb_method_kind, and a folder of its own. Rows of methods that locate are defined here, because
 * they use the steps of another method.
 */
#include <string.h>

#include "classic/classic.h"
#include "located/needed_parts.h"
#include "stepped/stages.h"
#include "stepped/stepped.h"

static const struct rb_method located = {
	.name = "located",
	.what = "every body flies on its own clock from event to event; impacts are located to "
		"rounding and lasting contacts end where they end",
	.good_for =
		"impacts that must be right, gases, long runs; springs, drag, fields, gravitation "
		"and driven bodies",
	.mind = "touching bodies are solved together, which costs much where they are many; one "
		"thread",
	.locates = true,
	.steps = &rb_stepper_stepped, /* forces at the start */
	.parts = rb_located_parts,
	.parts_title = "parts of the located method",
};

static const struct rb_method automatic = {
	.name = "auto",
	.what = "located, but stepped while events come too densely, or motion is too fast, to "
		"locate",
	.good_for = "whoever does not want to choose (the default)",
	.mind = "the summary and the recording report how much time was stepped",
	.locates = true,
	.changes = true,
	.steps = &rb_stepper_stepped,
	.parts = rb_located_parts,
	.parts_title = "parts of the located method",
};

const struct rb_method *const rb_methods[RB_METHOD_KIND_COUNT] = {
	[RB_METHOD_AUTO] = &automatic,
	[RB_METHOD_CLASSIC] = &rb_method_classic,
	[RB_METHOD_LOCATED] = &located,
	[RB_METHOD_STEPPED] = &rb_method_stepped,
};

const char *rb_method_name(enum rb_method_kind kind)
{
	return (int)kind >= 0 && (int)kind < RB_METHOD_KIND_COUNT ? rb_methods[kind]->name
	                                                          : "unknown";
}

const char *rb_model_method(const struct rb_model *model)
{
	return rb_method_name(model->method);
}

int rb_method_find(const char *name)
{
	for (int kind = 0; kind < RB_METHOD_KIND_COUNT; kind++)
		if (strcmp(rb_methods[kind]->name, name) == 0)
			return kind;
	return -1;
}
