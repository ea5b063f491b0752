/* SPDX-License-Identifier: MIT */
/* An infinite half space: solid where local z < 0. Its call is that of a rectangle, too. */
#include "shape/shape_types.h"

static enum rb_status core(const struct rb_shape *shape, rb_core *core, struct rb_error *err)
{
	(void)shape, (void)err;
	*core = rb_core_of_half_space();
	return RB_OK;
}

const struct rb_shape_type rb_shape_plane = {
	.name = "plane",
	.plural = "planes",
	.form = RB_FORM_SURFACE,
	.core = core,
};
