/* SPDX-License-Identifier: MIT */
#include "located/articulated.h"

#include <float.h>

#include "base/error.h"
#include "located/arc.h"

/*
 * Allowed difference from accelerations by rows, per body, relative to the largest acceleration.
 * Rounding is well below it, unless a body many orders of magnitude heavier hangs on a light one.
 */
static const double agreement_share = 64 * DBL_EPSILON;

static bool is_static(const struct rb_located *l, int body)
{
	return body < 0 || body >= l->n;
}

static bool is_member(const struct rb_joint_rows *rows, int body)
{
	const int place = rows->l->place[body];

	return place >= 0 && place < rows->body_count && rows->body[place] == body;
}

/* Can all joints be part of trees, with no other rows that hold? */
static bool may_be_tree(const struct rb_joint_rows *rows)
{
	const struct rb_located *const l = rows->l;
	bool good = true;

	for (int k = 0; k < rows->joint_count && good; k++) {
		const struct rb_joint *const joint = &l->model->joints->joint[rows->joint[k]];
		const int end[2] = {joint->a, joint->b};

		good = (joint->link.type->one_sided || joint->link.type->free) &&
		       !rb_joint_rows_adds(rows, rows->joint[k]);
		for (int e = 0; e < 2; e++)
			good = good && (is_static(l, end[e]) || is_member(rows, end[e]));
	}
	return good;
}

bool rb_articulated_agrees(const struct rb_joint_rows *rows, double max, const rb_vec3 *linear,
                           const rb_vec3 *angular, const rb_vec3 *known)
{
	const int count = rows->body_count;
	double off = 0;

	for (int k = 0; k < count; k++) {
		const double size = rows->l->model->shape[rows->body[k]].radius;
		const rb_vec3 *const by_rows = known + 2 * k;
		const double by = rb_vec3_length(rb_vec3_sub(linear[k], by_rows[0])) +
		                  size * rb_vec3_length(rb_vec3_sub(angular[k], by_rows[1]));

		max = fmax(max, rb_vec3_max_abs(by_rows[0]));
		max = fmax(max, size * rb_vec3_max_abs(by_rows[1]));
		if (!isfinite(by)) /* an inertia is zero */
			return false;
		off = fmax(off, by);
	}
	return off <= agreement_share * count * max;
}

static struct rb_pose fixed_pose(const void *user, int body, double t)
{
	return rb_arc_pose((struct rb_located *)user, body, t);
}

bool rb_articulated_take(const struct rb_joint_rows *rows, struct rb_joint_tree **found)
{
	struct rb_located *const l = rows->l;
	const size_t count = (size_t)rows->body_count;

	*found = NULL;
	if (!l->top || rows->joint_count == 0 || !may_be_tree(rows) ||
	    rb_joint_rows_is_closed(rows))
		return true;
	struct rb_joint_tree *const tree = rb_arena_take(l->arena, 1, sizeof *tree);
	struct rb_joint_tree_link *const link = rb_arena_take(l->arena, count, sizeof *link);
	struct rb_freedom *const freedom = rb_arena_take(l->arena, 3 * count, sizeof *freedom);
	int *const link_of = rb_arena_take(l->arena, count, sizeof *link_of);

	if (!tree || !link || !freedom || !link_of)
		return false;
	*tree = (struct rb_joint_tree){.model = l->model,
	                               .state = l->world->joint,
	                               .body = rows->body,
	                               .pose = rows->pose,
	                               .body_count = rows->body_count,
	                               .place = l->place,
	                               .placed = l->n,
	                               .fixed_pose = fixed_pose,
	                               .user = l,
	                               .link = link,
	                               .freedom = freedom};
	rb_joint_tree_grow(tree, link_of);
	*found = tree;
	return true;
}
