/* SPDX-License-Identifier: MIT */
/* A point in common, and an axis of a at right angles to one of b: a cross between two forks. */
#include "joint/joint_types.h"

/* u_3 . w_3 */
static void fill(const struct rb_linkage *link, const struct rb_linkage_parts *p,
                 struct rb_linkage_row *row)
{
	*row = rb_linkage_across(p, rb_linkage_axis_a(p, 2), rb_linkage_axis_b(link, p, 2));
}

static const struct rb_linkage_condition axes_cross = {.count = 1, .couples = true, .fill = fill};

const struct rb_joint_type rb_joint_type_universal = {
	.name = "universal",
	.noun = "universal joint",
	.linkage = {.condition = {&rb_linkage_same_point, &axes_cross}, .free = RB_FREE_ABOUT_BOTH},
	.has_axis = true,
	.has_axis_b = true,
	.form = RB_JOINT_CROSS,
};
