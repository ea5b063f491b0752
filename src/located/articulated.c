/* SPDX-License-Identifier: MIT */
#include "located/articulated.h"

#include <float.h>

#include "base/error.h"
#include "located/arc.h"
#include "math/lanes.h"
#include "math/quat.h"

/*
 * Of the largest acceleration: by so much, for each body, those by rows may be others. Rounding is
 * well below it, but where what is many orders of magnitude heavier hangs on something light.
 */
static const double agrees = 64 * DBL_EPSILON;

/* Vectors of three, the last one twice or what follows from it; of matrices the columns. */
typedef rb_lanes matrix[3];

/* Velocity (or acceleration) of the centre of mass and spin; or force and torque about it. */
struct screw {
	rb_lanes linear, angular;
};

/* Force = mass a + cross b, torque = back a + turning b; symmetric: back is cross transposed. */
struct inertia {
	matrix mass, cross, back, turning;
};

/* A motion that a joint leaves free, and what the inertia is to it. */
struct freedom {
	struct screw motion, answer;
	double inverse; /* of motion . answer */
	double force;   /* motion . bias */
};

/* A body, and the joint to the one that it hangs on. */
struct link {
	int place, parent; /* parent: a link before it, -1: none, or what stands still */
	int joint;         /* of the model; -1: it hangs on nothing */
	bool is_b;         /* of the joint */
	bool is_isotropic;
	unsigned free;       /* enum rb_linkage_freedom */
	rb_vec3 arm;         /* to the joint's point, m, object axes */
	rb_vec3 axis;        /* of the joint, object axes */
	rb_vec3 parent_axis; /* that of the parent, its object axes */
	double mass;
	matrix own; /* kg m^2, object axes */
	/* at the poses, world axes */
	struct freedom *freedom;
	int freedom_count;
	struct screw given;   /* acceleration against the parent, but for what is free */
	rb_lanes from_parent; /* m: from its centre of mass to the link's */
	struct inertia whole; /* articulated */
	struct screw bias;    /* the force that it takes without any acceleration */
	struct screw added;   /* accelerations by joints */
};

struct rb_articulated {
	const struct rb_joint_rows *rows; /* bodies and poses */
	struct link *link;                /* [count]: after those that they hang on */
	int count;
	struct freedom *freedom; /* [3 count] */
};

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

RB_LANES_INLINE double product(const struct screw *x, const struct screw *y)
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

RB_LANES_INLINE void answer(const struct inertia *on, const struct screw *a, struct screw *to)
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

/* Takes away what a freedom leaves without force. */
RB_LANES_INLINE void set_free(struct link *link, struct freedom *f)
{
	struct inertia *const on = &link->whole;

	answer(on, &f->motion, &f->answer);
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
RB_LANES_INLINE void add_moved(const struct inertia *on, const rb_lanes *way, struct inertia *to)
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

/* What is free is taken away, and the rest is the parent's. */
RB_LANES_INLINE void gather(struct rb_articulated *tree)
{
	for (int k = tree->count; k-- > 0;) {
		struct link *const link = &tree->link[k];
		struct screw given;
		rb_lanes turned;

		if (link->joint < 0)
			continue;
		for (int f = 0; f < link->freedom_count; f++)
			set_free(link, &link->freedom[f]);
		answer(&link->whole, &link->given, &given);
		link->bias.linear += given.linear;
		link->bias.angular += given.angular;
		if (link->parent < 0)
			continue;
		struct link *const parent = &tree->link[link->parent];

		add_moved(&link->whole, &link->from_parent, &parent->whole);
		cross(&link->from_parent, &link->bias.linear, &turned);
		parent->bias.linear += link->bias.linear;
		parent->bias.angular += link->bias.angular + turned;
	}
}

/* ---- from roots to leaves ---- */

/* The acceleration of a root that hangs on nothing, which no force acts on. */
static void float_freely(const struct link *link, struct screw *to)
{
	const struct inertia *const on = &link->whole;
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

RB_LANES_INLINE void spread(struct rb_articulated *tree, rb_vec3 *linear, rb_vec3 *angular)
{
	for (int k = 0; k < tree->count; k++) {
		struct link *const link = &tree->link[k];
		struct screw a = link->given;

		if (link->joint < 0) {
			float_freely(link, &a);
		} else if (link->parent >= 0) {
			const struct screw *const by = &tree->link[link->parent].added;
			rb_lanes turned;

			cross(&by->angular, &link->from_parent, &turned);
			a.linear += by->linear + turned;
			a.angular += by->angular;
		}
		for (int f = link->freedom_count; f-- > 0;) {
			const struct freedom *const free = &link->freedom[f];
			const double rate = -free->inverse *
			                    (product(&free->answer, &a) + free->force);

			a.linear += rate * free->motion.linear;
			a.angular += rate * free->motion.angular;
		}
		link->added = a;
		linear[link->place] = rb_vec3_add(linear[link->place], stored(&a.linear));
		angular[link->place] = rb_vec3_add(angular[link->place], stored(&a.angular));
	}
}

/* ---- at poses ---- */

RB_LANES_INLINE void add_freedom(struct link *link, const rb_lanes *axis, const rb_lanes *arm)
{
	struct screw *const to = &link->freedom[link->freedom_count++].motion;

	cross(arm, axis, &to->linear);
	to->angular = *axis;
}

/* What the joint leaves free at the poses; `arm`, axes: in the world. */
RB_LANES_INLINE void find_freedoms(struct link *link, const rb_lanes *arm, const rb_lanes *axis,
                                   const rb_lanes *parent_axis)
{
	link->freedom_count = 0;
	if (link->free & RB_FREE_ALONG)
		link->freedom[link->freedom_count++].motion = (struct screw){*axis, 0 * *axis};
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
 * What of the acceleration against the parent the velocities make, at the link's centre of mass:
 * the joint's point is one of both bodies, but for the way along the axis; axes that it turns about
 * turn with the body that they belong to.
 */
RB_LANES_INLINE void find_given(struct link *link, const struct rb_pose *own,
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

static struct rb_pose fixed_pose(const struct rb_joint_rows *rows, const struct link *link,
                                 double t)
{
	const struct rb_joint *joint = &rows->l->model->joints->joint[link->joint];
	const int body = link->is_b ? joint->a : joint->b;

	return body < 0 ? rb_linkage_world() : rb_arc_pose(rows->l, body, t);
}

/* The joint of a link at the poses; `turn`: the link's orientation. */
RB_LANES_INLINE void place_joint(const struct rb_articulated *tree, struct link *link,
                                 const rb_lanes *turn, const struct rb_pose *parent,
                                 const rb_vec3 *linear, const rb_vec3 *angular)
{
	const struct rb_pose *const own = &tree->rows->pose[link->place];
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
	find_given(link, own, parent, &arm, &axis, &parent_axis);
	/* against what bodies do without joints */
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

/* The inertia of a body alone. */
RB_LANES_INLINE void place_inertia(struct link *link, const rb_lanes *turn)
{
	const rb_lanes none = {0, 0, 0, 0};
	const double mass = link->mass;
	struct inertia *const to = &link->whole;
	matrix half, back;

	for (int k = 0; k < 3; k++) {
		to->mass[k] = (rb_lanes){k == 0 ? mass : 0, k == 1 ? mass : 0, k == 2 ? mass : 0,
		                         0};
		to->cross[k] = to->back[k] = none;
		to->turning[k] = link->own[k];
	}
	link->bias = (struct screw){none, none};
	if (link->is_isotropic)
		return;
	transpose(turn, back);
	for (int k = 0; k < 3; k++)
		apply(turn, &link->own[k], &half[k]);
	for (int k = 0; k < 3; k++)
		apply(half, &back[k], &to->turning[k]);
}

RB_LANES_INLINE void accelerate(struct rb_articulated *tree, double t, rb_vec3 *linear,
                                rb_vec3 *angular)
{
	for (int k = 0; k < tree->count; k++) {
		struct link *const link = &tree->link[k];
		const rb_mat3 rotation = rb_quat_to_mat3(tree->rows->pose[link->place].orientation);
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
			fixed = fixed_pose(tree->rows, link, t);
		else
			parent = &tree->rows->pose[tree->link[link->parent].place];
		place_joint(tree, link, turn, parent, linear, angular);
	}
	gather(tree);
	spread(tree, linear, angular);
}

RB_LANES_AVX2 static void accelerate_avx2(struct rb_articulated *tree, double t, rb_vec3 *linear,
                                          rb_vec3 *angular)
{
	accelerate(tree, t, linear, angular);
}

void rb_articulated_accelerate(struct rb_articulated *tree, double t, rb_vec3 *linear,
                               rb_vec3 *angular)
{
	if (rb_lanes_avx2())
		accelerate_avx2(tree, t, linear, angular);
	else
		accelerate(tree, t, linear, angular);
}

void rb_articulated_enter(const struct rb_articulated *tree, struct rb_entries *rate)
{
	for (int k = 0; k < tree->count; k++) {
		const struct link *const link = &tree->link[k];
		const rb_vec3 force = stored(&link->bias.linear);

		/* what holds a root: its bias is with the acceleration that it has */
		if (link->joint >= 0 && link->parent < 0)
			rb_entries_momentum(
				rate, RB_MOMENTUM_STATIC, force,
				rb_vec3_add(stored(&link->bias.angular),
			                    rb_vec3_cross(tree->rows->pose[link->place].position,
			                                  force)));
	}
}

/* ---- which bodies hang on which ---- */

static bool is_static(const struct rb_located *l, int body)
{
	return body < 0 || body >= l->n;
}

static bool is_member(const struct rb_joint_rows *rows, int body)
{
	const int place = rows->l->place[body];

	return place >= 0 && place < rows->body_count && rows->body[place] == body;
}

static void describe(const struct rb_articulated *tree, struct link *link)
{
	const struct rb_model *const model = tree->rows->l->model;
	const int body = tree->rows->body[link->place];

	link->mass = model->mass[body];
	link->is_isotropic = !isnan(model->inverse_inertia_scalar[body]);
	for (int k = 0; k < 3; k++)
		load(rb_vec3_from(model->inertia[body].m[k]), &link->own[k]); /* symmetric */
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

static void add_link(struct rb_articulated *tree, int place, int parent, int joint, int *link_of)
{
	link_of[place] = tree->count;
	tree->link[tree->count++] = (struct link){.place = place, .parent = parent, .joint = joint};
}

/* Adds what a link's body has joints with, but for what it hangs on itself. */
static void hang(struct rb_articulated *tree, int parent, int *link_of)
{
	const struct rb_located *const l = tree->rows->l;
	const struct rb_joints *const joints = l->model->joints;
	const int body = tree->rows->body[tree->link[parent].place];

	for (int e = joints->first[body]; e < joints->first[body + 1]; e++) {
		const struct rb_joint *const joint = &joints->joint[joints->of[e]];
		const int other = joint->a == body ? joint->b : joint->a;

		if (rb_joint_rows_holds(l, joints->of[e]) && !joint->link.type->one_sided &&
		    !is_static(l, other) && link_of[l->place[other]] < 0)
			add_link(tree, l->place[other], parent, joints->of[e], link_of);
	}
}

/* Is each joint one that a tree may have, and nothing else holds? */
static bool may_hang(const struct rb_joint_rows *rows)
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

/* Trees from what stands still, then those that hang on nothing. */
static void grow(struct rb_articulated *tree, int *link_of)
{
	const struct rb_joint_rows *const rows = tree->rows;
	const struct rb_located *const l = rows->l;

	for (int k = 0; k < rows->body_count; k++)
		link_of[k] = -1;
	for (int k = 0; k < rows->joint_count; k++) {
		const struct rb_joint *const joint = &l->model->joints->joint[rows->joint[k]];
		const bool by_b = is_static(l, joint->a);

		if (!joint->link.type->one_sided && (by_b || is_static(l, joint->b)))
			add_link(tree, l->place[by_b ? joint->b : joint->a], -1, rows->joint[k],
			         link_of);
	}
	for (int done = 0, place = 0; done < rows->body_count; done++) {
		while (done == tree->count && link_of[place] >= 0)
			place++;
		if (done == tree->count)
			add_link(tree, place, -1, -1, link_of);
		hang(tree, done, link_of);
	}
	RB_ASSERT(tree->count == rows->body_count);
	for (int k = 0; k < tree->count; k++)
		describe(tree, &tree->link[k]);
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
		if (!isfinite(by)) /* an inertia is nothing */
			return false;
		off = fmax(off, by);
	}
	return off <= agrees * count * max;
}

bool rb_articulated_take(const struct rb_joint_rows *rows, struct rb_articulated **found)
{
	struct rb_arena *const arena = rows->l->arena;
	const size_t count = (size_t)rows->body_count;

	*found = NULL;
	if (!rows->l->top || rows->joint_count == 0 || !may_hang(rows) ||
	    rb_joint_rows_is_closed(rows))
		return true;
	struct rb_articulated *const tree = rb_arena_take(arena, 1, sizeof *tree);
	struct link *const link = rb_arena_take(arena, count, sizeof *link);
	struct freedom *const freedom = rb_arena_take(arena, 3 * count, sizeof *freedom);
	int *const link_of = rb_arena_take(arena, count, sizeof *link_of);

	if (!tree || !link || !freedom || !link_of)
		return false;
	*tree = (struct rb_articulated){.rows = rows, .link = link, .freedom = freedom};
	grow(tree, link_of);
	*found = tree;
	return true;
}
