/* SPDX-License-Identifier: MIT */
/*
 * Drag F = -(c1 + c2 |v|) v at the centre of mass: Stokes and Newton regimes with coefficients of
 * the scene. It exerts no torque, since neither shape nor wake is modelled. Methods solve it
 * implicitly where it is stiff (stepped/force).
 */
#include "force/drag.h"

#include <math.h>
#include <stdio.h>

#include "base/error.h"

#define AT(member) offsetof(struct rb_drag_def, member)

static const struct rb_row keys[] = {
	{"linear", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(linear), NULL, "0", "N s/m",
         "times the velocity"},
	{"quadratic", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(quadratic), NULL, "0",
         "N s^2/m^2", "times the speed, times the velocity"},
};

static bool fault(const struct rb_scene *scene, const void *row, char text[RB_ELEMENT_FAULT_SIZE])
{
	const struct rb_drag_def *drag = row;

	(void)scene;
	if (drag->linear >= 0 && isfinite(drag->linear) && drag->quadratic >= 0 &&
	    isfinite(drag->quadratic))
		return false;
	snprintf(text, RB_ELEMENT_FAULT_SIZE,
	         "'linear' and 'quadratic' must be finite and 0 or more (got %g and %g)",
	         drag->linear, drag->quadratic);
	return true;
}

static bool matters(const void *row)
{
	const struct rb_drag_def *drag = row;

	return drag->linear > 0 || drag->quadratic > 0;
}

/* The force at a pose; always acts, also at rest, where it is zero. */
static bool act(const struct rb_element_query *query, const void *row, int index,
                const struct rb_pose *pose, struct rb_wrench *out)
{
	const struct rb_drag_def *drag = row;
	const double share = drag->linear + drag->quadratic * rb_vec3_length(pose->velocity);

	(void)query, (void)index;
	RB_ASSERT_COSTLY(drag->linear >= 0 && drag->quadratic >= 0);
	*out = (struct rb_wrench){.force = rb_vec3_scale(-share, pose->velocity)};
	return true;
}

static double damps(const void *row)
{
	const struct rb_drag_def *drag = row;

	return drag->quadratic > 0 ? (double)NAN : drag->linear;
}

const struct rb_element_kind rb_force_drag = {
	.name = "drag",
	.plural = "drag",
	.feature = RB_FEATURE_DRAG,
	.row_size = sizeof(struct rb_drag_def),
	.line_at = AT(line),
	.defaults = &(const struct rb_drag_def){0},
	.keys = {"drag", keys, sizeof keys / sizeof keys[0], NULL},
	.wants_one = "'linear', 'quadratic' or both",
	.fault = fault,
	.matters = matters,
	.act = act,
	.damps = damps,
	.is_drag = true,
};

enum rb_status rb_scene_add_drag(struct rb_scene *scene, const struct rb_drag_def *def,
                                 struct rb_error *err)
{
	return rb_scene_add_element(scene, &rb_force_drag, def, err);
}

struct rb_drag_def rb_drag_of_all(const struct rb_model *model)
{
	const struct rb_elements *const drags = rb_model_elements(model, &rb_force_drag);
	struct rb_drag_def all = {0};

	for (int k = 0; drags && k < drags->count; k++) {
		const struct rb_drag_def *const drag = rb_elements_row(drags, k);

		all.linear += drag->linear;
		all.quadratic += drag->quadratic;
	}
	return all;
}
