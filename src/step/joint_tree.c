/* SPDX-License-Identifier: MIT */
#include "step/joint_tree.h"

#include "base/error.h"
#include "math/quat.h"

/* Vectors of three, the last lane a copy of the third or derived from it; matrices by columns. */
typedef rb_lanes matrix[3];

/* ---- vectors ---- */

RB_LANES_INLINE void load(rb_vec3 v, rb_lanes *to)
{
	*to = (rb_lanes){v.x, v.y, v.z, v.z};
}

RB_LANES_INLINE rb_vec3 stored(const rb_lanes *v)
{
	return (rb_vec3){(*v)[0], (*v)[1], (*v)[2]};
}

RB_LANES_INLINE double dot(const rb_lanes *a, const rb_lanes *b)
{
	const rb_lanes all = *a * *b;

	return all[0] + all[1] + all[2];
}

RB_LANES_INLINE double product(const struct rb_screw *x, const struct rb_screw *y)
{
	return dot(&x->linear, &y->linear) + dot(&x->angular, &y->angular);
}

RB_LANES_INLINE void cross(const rb_lanes *a, const rb_lanes *b, rb_lanes *to)
{
	const rb_lanes x = {(*a)[1], (*a)[2], (*a)[0], (*a)[3]};
	const rb_lanes y = {(*b)[1], (*b)[2], (*b)[0], (*b)[3]};
	const rb_lanes all = *a * y - x * *b;

	*to = (rb_lanes){all[1], all[2], all[0], all[3]};
}

/* a x (a x b) */
RB_LANES_INLINE void cross_twice(const rb_lanes *a, const rb_lanes *b, rb_lanes *to)
{
	rb_lanes once;

	cross(a, b, &once);
	cross(a, &once, to);
}

RB_LANES_INLINE void apply(const rb_lanes *m, const rb_lanes *v, rb_lanes *to)
{
	*to = m[0] * (*v)[0] + m[1] * (*v)[1] + m[2] * (*v)[2];
}

RB_LANES_INLINE void transpose(const rb_lanes *m, rb_lanes *to)
{
	to[0] = (rb_lanes){m[0][0], m[1][0], m[2][0], m[2][3]};
	to[1] = (rb_lanes){m[0][1], m[1][1], m[2][1], m[2][3]};
	to[2] = (rb_lanes){m[0][2], m[1][2], m[2][2], m[2][3]};
}

/* m v x way, for any v */
RB_LANES_INLINE void cross_of(const rb_lanes *m, const rb_lanes *way, rb_lanes *to)
{
	const double x = (*way)[0], y = (*way)[1], z = (*way)[2];

	to[0] = y * m[2] - z * m[1];
	to[1] = z * m[0] - x * m[2];
	to[2] = x * m[1] - y * m[0];
}

RB_LANES_INLINE void multiply(const struct rb_joint_tree_inertia *on, const struct rb_screw *a,
                              struct rb_screw *to)
{
	rb_lanes by_turning;

	apply(on->mass, &a->linear, &to->linear);
	apply(on->cross, &a->angular, &by_turning);
	to->linear += by_turning;
	apply(on->back, &a->linear, &to->angular);
	apply(on->turning, &a->angular, &by_turning);
	to->angular += by_turning;
}

/* ---- from leaves to roots ---- */

/* Eliminates a degree of freedom from the articulated inertia and bias. */
RB_LANES_INLINE void eliminate_freedom(struct rb_joint_tree_link *link, struct rb_freedom *f)
{
	struct rb_joint_tree_inertia *const on = &link->whole;

	multiply(on, &f->motion, &f->answer);
	f->inverse = 1 / product(&f->motion, &f->answer);
	f->force = product(&f->motion, &link->bias);
	const rb_lanes a = f->answer.linear, b = f->answer.angular;

	for (int k = 0; k < 3; k++) {
		const double x = f->inverse * a[k], y = f->inverse * b[k];

		on->mass[k] -= x * a;
		on->back[k] -= x * b;
		on->cross[k] -= y * a;
		on->turning[k] -= y * b;
	}
	link->bias.linear -= f->force * f->inverse * a;
	link->bias.angular -= f->force * f->inverse * b;
}

/*
 * Adds the inertia to that of a body whose centre of mass is `way` before: accelerations there are
 * a + b x way. With R b = b x way
 *
 *     cross' = cross + mass R,  turning' = turning + back R + (back R)^T + (mass R)^T R
 */
RB_LANES_INLINE void add_moved(const struct rb_joint_tree_inertia *on, const rb_lanes *way,
                               struct rb_joint_tree_inertia *to)
{
	matrix more, back, once, again, twice;

	cross_of(on->mass, way, more);
	transpose(more, back);
	cross_of(on->back, way, once);
	transpose(once, again);
	cross_of(back, way, twice);
	for (int k = 0; k < 3; k++) {
		to->mass[k] += on->mass[k];
		to->cross[k] += on->cross[k] + more[k];
		to->back[k] += on->back[k] + back[k];
		to->turning[k] += on->turning[k] + (once[k] + again[k]) + twice[k];
	}
}

/* Eliminates degrees of freedom and adds the rest to the parents. */
RB_LANES_INLINE void eliminate_freedoms(struct rb_joint_tree *tree)
{
	for (int k = tree->count; k-- > 0;) {
		struct rb_joint_tree_link *const link = &tree->link[k];
		struct rb_screw given;
		rb_lanes turned;

		if (link->joint < 0)
			continue;
		for (int f = 0; f < link->freedom_count; f++)
			eliminate_freedom(link, &link->freedom[f]);
		multiply(&link->whole, &link->given, &given);
		link->bias.linear += given.linear;
		link->bias.angular += given.angular;
		if (link->parent < 0)
			continue;
		struct rb_joint_tree_link *const parent = &tree->link[link->parent];

		add_moved(&link->whole, &link->from_parent, &parent->whole);
		cross(&link->from_parent, &link->bias.linear, &turned);
		parent->bias.linear += link->bias.linear;
		parent->bias.angular += link->bias.angular + turned;
	}
}

/* ---- from roots to leaves ---- */

/* Acceleration of a free root, on which no external force acts. */
static void accelerate_root(const struct rb_joint_tree_link *link, struct rb_screw *to)
{
	const struct rb_joint_tree_inertia *const on = &link->whole;
	double a[6][6], x[6];

	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3; k++) {
			a[i][k] = on->mass[k][i];
			a[i][k + 3] = on->cross[k][i];
			a[i + 3][k] = on->back[k][i];
			a[i + 3][k + 3] = on->turning[k][i];
		}
		x[i] = -link->bias.linear[i];
		x[i + 3] = -link->bias.angular[i];
	}
	for (int j = 0; j < 6; j++)
		for (int i = j + 1; i < 6; i++) {
			const double share = a[i][j] / a[j][j];

			for (int k = j + 1; k < 6; k++)
				a[i][k] -= share * a[j][k];
			x[i] -= share * x[j];
		}
	for (int j = 6; j-- > 0;) {
		for (int k = j + 1; k < 6; k++)
			x[j] -= a[j][k] * x[k];
		x[j] /= a[j][j];
	}
	load(rb_vec3_from(x), &to->linear);
	load(rb_vec3_from(x + 3), &to->angular);
}

RB_LANES_INLINE void propagate(struct rb_joint_tree *tree, rb_vec3 *linear, rb_vec3 *angular)
{
	for (int k = 0; k < tree->count; k++) {
		struct rb_joint_tree_link *const link = &tree->link[k];
		struct rb_screw a = link->given;

		if (link->joint < 0) {
			accelerate_root(link, &a);
		} else if (link->parent >= 0) {
			const struct rb_screw *const by = &tree->link[link->parent].added;
			rb_lanes turned;

			cross(&by->angular, &link->from_parent, &turned);
			a.linear += by->linear + turned;
			a.angular += by->angular;
		}
		for (int f = link->freedom_count; f-- > 0;) {
			struct rb_freedom *const free = &link->freedom[f];

			free->rate = -free->inverse * (product(&free->answer, &a) + free->force);
			a.linear += free->rate * free->motion.linear;
			a.angular += free->rate * free->motion.angular;
		}
		link->added = a;
		linear[link->place] = rb_vec3_add(linear[link->place], stored(&a.linear));
		angular[link->place] = rb_vec3_add(angular[link->place], stored(&a.angular));
	}
}

/* ---- at poses ---- */

RB_LANES_INLINE void add_freedom(struct rb_joint_tree_link *link, const rb_lanes *axis,
                                 const rb_lanes *arm)
{
	struct rb_screw *const to = &link->freedom[link->freedom_count++].motion;

	cross(arm, axis, &to->linear);
	to->angular = *axis;
}

/* Degrees of freedom of the joint at the poses; `arm`, axes: in the world. */
RB_LANES_INLINE void find_freedoms(struct rb_joint_tree_link *link, const rb_lanes *arm,
                                   const rb_lanes *axis, const rb_lanes *parent_axis)
{
	link->freedom_count = 0;
	if (link->free & RB_FREE_ALONG)
		link->freedom[link->freedom_count++].motion = (struct rb_screw){*axis, 0 * *axis};
	if (link->free & (RB_FREE_ABOUT | RB_FREE_ABOUT_BOTH))
		add_freedom(link, axis, arm);
	if (link->free & RB_FREE_ABOUT_BOTH)
		add_freedom(link, parent_axis, arm);
	for (int k = 0; (link->free & RB_FREE_TURNING) && k < 3; k++) {
		rb_lanes unit;

		load((rb_vec3){k == 0, k == 1, k == 2}, &unit);
		add_freedom(link, &unit, arm);
	}
}

/*
 * Velocity-dependent part of the acceleration relative to the parent, at the link's centre of mass:
 * the joint's point is common to both bodies, except for the displacement along the axis; rotation
 * axes rotate with the body that they belong to.
 */
RB_LANES_INLINE void find_velocity_terms(struct rb_joint_tree_link *link, const struct rb_pose *own,
                                         const struct rb_pose *parent, const rb_lanes *arm,
                                         const rb_lanes *axis, const rb_lanes *parent_axis)
{
	const rb_lanes reach = link->from_parent + *arm;
	rb_lanes w, v, at_own, at_parent, turning = {0, 0, 0, 0};

	load(own->spin, &w);
	load(parent->spin, &v);
	cross_twice(&w, arm, &at_own);
	cross_twice(&v, &reach, &at_parent);
	at_parent -= at_own;
	if (link->free & RB_FREE_ALONG) {
		rb_lanes rate, turned, by_parent;

		load(rb_vec3_sub(own->velocity, parent->velocity), &rate);
		cross(&w, arm, &turned);
		cross(&v, &reach, &by_parent);
		rate += turned - by_parent;
		cross(&v, &rate, &turned);
		at_parent += 2 * turned;
	}
	if (link->free & RB_FREE_ABOUT)
		cross(&v, &w, &turning);
	if (link->free & RB_FREE_ABOUT_BOTH) {
		const rb_lanes spin = w - v;
		rb_lanes x, y;

		cross(&w, axis, &x);
		cross(&v, parent_axis, &y);
		turning = dot(&spin, axis) * x + dot(&spin, parent_axis) * y;
	}
	cross(arm, &turning, &link->given.linear);
	link->given.linear += at_parent;
	link->given.angular = turning;
}

struct rb_pose rb_joint_tree_parent(const struct rb_joint_tree *tree,
                                    const struct rb_joint_tree_link *link, double t)
{
	const struct rb_joint *joint = &tree->model->joints->joint[link->joint];
	const int body = link->is_b ? joint->a : joint->b;

	if (link->parent >= 0)
		return tree->pose[tree->link[link->parent].place];
	return body < 0 ? rb_linkage_world() : tree->fixed_pose(tree->user, body, t);
}

/* The joint of a link at the poses; `turn`: the link's orientation. */
RB_LANES_INLINE void place_joint(const struct rb_joint_tree *tree, struct rb_joint_tree_link *link,
                                 const rb_lanes *turn, const struct rb_pose *parent,
                                 const rb_vec3 *linear, const rb_vec3 *angular)
{
	const struct rb_pose *const own = &tree->pose[link->place];
	rb_lanes object, arm, axis, parent_axis, free_linear, free_angular;

	load(link->arm, &object);
	apply(turn, &object, &arm);
	load(link->axis, &object);
	apply(turn, &object, &axis);
	parent_axis = axis;
	if (link->free & RB_FREE_ABOUT_BOTH)
		load(rb_quat_rotate(parent->orientation, link->parent_axis), &parent_axis);
	load(rb_pose_between(parent, own), &link->from_parent);
	find_freedoms(link, &arm, &axis, &parent_axis);
	find_velocity_terms(link, own, parent, &arm, &axis, &parent_axis);
	/* relative to accelerations without joints */
	load(linear[link->place], &free_linear);
	load(angular[link->place], &free_angular);
	if (link->parent >= 0) {
		const int place = tree->link[link->parent].place;
		rb_lanes by, turned;

		load(angular[place], &by);
		free_angular -= by;
		cross(&by, &link->from_parent, &turned);
		load(linear[place], &by);
		free_linear -= by + turned;
	}
	link->given.linear -= free_linear;
	link->given.angular -= free_angular;
}

/* Inertia of a single body. */
RB_LANES_INLINE void place_inertia(struct rb_joint_tree_link *link, const rb_lanes *turn)
{
	const rb_lanes none = {0, 0, 0, 0};
	const double mass = link->mass;
	struct rb_joint_tree_inertia *const to = &link->whole;
	matrix half, back;

	for (int k = 0; k < 3; k++) {
		to->mass[k] = (rb_lanes){k == 0 ? mass : 0, k == 1 ? mass : 0, k == 2 ? mass : 0,
		                         0};
		to->cross[k] = to->back[k] = none;
		to->turning[k] = link->own[k];
	}
	link->bias = (struct rb_screw){none, none};
	if (link->is_isotropic)
		return;
	transpose(turn, back);
	for (int k = 0; k < 3; k++)
		apply(turn, &link->own[k], &half[k]);
	for (int k = 0; k < 3; k++)
		apply(half, &back[k], &to->turning[k]);
}

RB_LANES_INLINE void accelerate(struct rb_joint_tree *tree, double t, rb_vec3 *linear,
                                rb_vec3 *angular)
{
	for (int k = 0; k < tree->count; k++) {
		struct rb_joint_tree_link *const link = &tree->link[k];
		const rb_mat3 rotation = rb_quat_to_mat3(tree->pose[link->place].orientation);
		matrix turn;

		for (int i = 0; i < 3; i++)
			load((rb_vec3){rotation.m[0][i], rotation.m[1][i], rotation.m[2][i]},
			     &turn[i]);
		place_inertia(link, turn);
		if (link->joint < 0)
			continue;
		struct rb_pose fixed;
		const struct rb_pose *parent = &fixed;

		if (link->parent < 0)
			fixed = rb_joint_tree_parent(tree, link, t);
		else
			parent = &tree->pose[tree->link[link->parent].place];
		place_joint(tree, link, turn, parent, linear, angular);
	}
	eliminate_freedoms(tree);
	propagate(tree, linear, angular);
}

RB_LANES_AVX2 static void accelerate_avx2(struct rb_joint_tree *tree, double t, rb_vec3 *linear,
                                          rb_vec3 *angular)
{
	accelerate(tree, t, linear, angular);
}

void rb_joint_tree_accelerate(struct rb_joint_tree *tree, double t, rb_vec3 *linear,
                              rb_vec3 *angular)
{
	if (rb_lanes_avx2())
		accelerate_avx2(tree, t, linear, angular);
	else
		accelerate(tree, t, linear, angular);
}

void rb_joint_tree_enter(const struct rb_joint_tree *tree, struct rb_entries *rate)
{
	for (int k = 0; k < tree->count; k++) {
		const struct rb_joint_tree_link *const link = &tree->link[k];
		const rb_vec3 force = stored(&link->bias.linear);

		/* force that holds a root: its bias includes the actual acceleration */
		if (link->joint >= 0 && link->parent < 0)
			rb_entries_momentum(
				rate, RB_MOMENTUM_STATIC, force,
				rb_vec3_add(
					stored(&link->bias.angular),
					rb_vec3_cross(tree->pose[link->place].position, force)));
	}
}

/* ---- building trees ---- */

static void describe(const struct rb_joint_tree *tree, struct rb_joint_tree_link *link)
{
	const struct rb_model *const model = tree->model;
	const int body = tree->body[link->place];

	link->mass = model->mass[body];
	link->is_isotropic = !isnan(model->inverse_inertia_scalar[body]);
	for (int k = 0; k < 3; k++)
		load(rb_vec3_from(rb_model_inertia(model, body)->m[k]),
		     &link->own[k]); /* symmetric */
	link->freedom = tree->freedom + 3 * (link - tree->link);
	if (link->joint < 0)
		return;
	const struct rb_joint *const joint = &model->joints->joint[link->joint];
	const struct rb_linkage *const on = &joint->link;
	const rb_vec3 axis_a = rb_quat_rotate(on->frame_a, (rb_vec3){0, 0, 1});
	const rb_vec3 axis_b = rb_quat_rotate(on->frame_b, (rb_vec3){0, 0, 1});

	link->is_b = joint->b == body;
	link->free = on->type->free;
	link->arm = link->is_b ? on->at_b : on->at_a;
	link->axis = link->is_b ? axis_b : axis_a;
	link->parent_axis = link->is_b ? axis_a : axis_b;
}

static bool is_member(const struct rb_joint_tree *tree, int body)
{
	if (body < 0 || body >= tree->placed)
		return false;
	const int place = tree->place[body];

	return place >= 0 && place < tree->body_count && tree->body[place] == body;
}

static void add_link(struct rb_joint_tree *tree, int place, int parent, int joint, int *link_of)
{
	link_of[place] = tree->count;
	tree->link[tree->count++] = (struct rb_joint_tree_link){
		.place = place, .parent = parent, .joint = joint};
}

/*
 * Adds the children of a body, or the body itself as a root on a static or driven one, by the
 * joints in effect.
 */
static void add_children(struct rb_joint_tree *tree, int place, bool as_root, int *link_of)
{
	const struct rb_joints *const joints = tree->model->joints;
	const int body = tree->body[place], parent = link_of[place];

	for (int e = joints->first[body]; e < joints->first[body + 1]; e++) {
		const int number = joints->of[e];
		const struct rb_joint *const joint = &joints->joint[number];
		const int other = joint->a == body ? joint->b : joint->a;
		const bool moves_too = is_member(tree, other);

		if (tree->state[number].released || joint->link.type->one_sided)
			continue;
		if (as_root && !moves_too && link_of[place] < 0)
			add_link(tree, place, -1, number, link_of);
		else if (!as_root && moves_too && link_of[tree->place[other]] < 0)
			add_link(tree, tree->place[other], parent, number, link_of);
	}
}

/* Builds trees from static and driven bodies, then free ones. */
void rb_joint_tree_grow(struct rb_joint_tree *tree, int *link_of)
{
	tree->count = 0;
	for (int k = 0; k < tree->body_count; k++)
		link_of[k] = -1;
	for (int k = 0; k < tree->body_count; k++)
		add_children(tree, k, true, link_of);
	for (int done = 0, place = 0; done < tree->body_count; done++) {
		while (done == tree->count && link_of[place] >= 0)
			place++;
		if (done == tree->count)
			add_link(tree, place, -1, -1, link_of);
		add_children(tree, tree->link[done].place, false, link_of);
	}
	RB_ASSERT(tree->count == tree->body_count);
	for (int k = 0; k < tree->count; k++)
		describe(tree, &tree->link[k]);
}
