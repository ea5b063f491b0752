/* SPDX-License-Identifier: MIT */
#include "stepped/net_system.h"

#include <math.h>
#include <string.h>

#include "base/error.h"

/* Most multiplications of one factorization: a sheet of 100,000 bodies takes a tenth of it. */
static const double work_max = 1e12;

/* ---- unknowns ---- */

/* Assigns unknowns. A body that does not turn has half a block: neighbours share one. */
static int place_bodies(struct rb_net *net)
{
	int blocks = 0;

	for (int k = 0; k < net->body_count; k++)
		net->body[k].block = -1;
	for (int k = 0; k < net->spring_count; k++) {
		const int *end = net->spring[k].body;

		if (end[0] < 0 || end[1] < 0 || net->body[end[0]].turns ||
		    net->body[end[1]].turns || net->body[end[0]].block >= 0 ||
		    net->body[end[1]].block >= 0)
			continue;
		for (int e = 0; e < 2; e++) {
			net->body[end[e]].block = blocks;
			net->body[end[e]].offset = 3 * e;
		}
		blocks++;
	}
	for (int k = 0; k < net->body_count; k++)
		if (net->body[k].block < 0) {
			net->body[k].block = blocks++;
			net->body[k].offset = 0;
		}
	return blocks;
}

bool rb_net_plan(struct rb_net_system *s, struct rb_arena *arena)
{
	struct rb_net *net = s->net;
	const int count = place_bodies(net);
	int(*pair)[2] = rb_arena_take(arena, (size_t)net->spring_count, sizeof *pair);
	const size_t krylov = 2 * (RB_NET_SPACE + 1), past = 2 * RB_NET_PAST;
	const size_t space = krylov > past ? krylov : past;
	int pairs = 0;

	s->size = RB_BLOCK * (size_t)count;
	s->rest = rb_arena_take(arena, (6 + space) * s->size, sizeof *s->x);
	if (!pair || !s->rest)
		return false;
	s->x = s->rest + s->size;
	s->trial_rest = s->x + s->size;
	s->trial = s->trial_rest + s->size;
	s->scratch = s->trial + s->size;
	s->step = s->scratch + s->size;
	s->space = s->step + s->size;
	for (int k = 0; k < net->spring_count; k++) {
		const int *end = net->spring[k].body;

		if (end[0] < 0 || end[1] < 0 || net->body[end[0]].block == net->body[end[1]].block)
			continue;
		pair[pairs][0] = net->body[end[0]].block;
		pair[pairs++][1] = net->body[end[1]].block;
	}
	return rb_blocks_plan(&s->blocks, count, (const int(*)[2])pair, pairs, work_max, arena);
}

double *rb_net_unknown(double *x, const struct rb_net_body *body)
{
	return x + RB_BLOCK * body->block + body->offset;
}

/* ---- matrices ---- */

rb_mat3 rb_net_inertia(const struct rb_net_body *body, rb_quat q)
{
	if (!isnan(body->scalar))
		return rb_mat3_diagonal(body->scalar, body->scalar, body->scalar);
	const rb_mat3 r = rb_quat_to_mat3(q), t = rb_mat3_transposed(&r);
	const rb_mat3 half = rb_mat3_multiply(&r, body->tensor);

	return rb_mat3_multiply(&half, &t);
}

/* Three unknowns that move an end, and their Jacobian. */
struct node {
	int block, offset;
	rb_mat3 jacobian;
};

static int nodes_of(const struct rb_net *net, const struct rb_net_spring *spring,
                    const rb_vec3 arm[2], struct node node[4])
{
	int count = 0;

	for (int e = 0; e < 2; e++) {
		if (spring->body[e] < 0)
			continue;
		const struct rb_net_body *body = &net->body[spring->body[e]];
		const double s = e == 0 ? -1 : 1;
		const rb_vec3 r = arm[e];

		node[count++] = (struct node){body->block, body->offset, rb_mat3_diagonal(s, s, s)};
		if (body->turns)
			node[count++] = (struct node){body->block,
			                              3,
			                              {{{0, s * r.z, -s * r.y},
			                                {-s * r.z, 0, s * r.x},
			                                {s * r.y, -s * r.x, 0}}}};
	}
	return count;
}

static void add_part(struct rb_blocks *blocks, const struct node *p, const struct node *q,
                     const rb_mat3 *k)
{
	bool transposed;
	rb_block *block = rb_blocks_at(blocks, p->block, q->block, &transposed);
	const bool same = p->block == q->block;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			if (!transposed || same)
				block->m[p->offset + i][q->offset + j] += k->m[i][j];
			if ((transposed && !same) || (same && p != q))
				block->m[q->offset + j][p->offset + i] += k->m[i][j];
		}
}

static bool turns(const struct rb_net *net, const struct rb_net_spring *spring)
{
	return (spring->body[0] >= 0 && net->body[spring->body[0]].turns) ||
	       (spring->body[1] >= 0 && net->body[spring->body[1]].turns);
}

/* The same if both ends are centres, with fewer operations. */
static void add_straight(struct rb_net_system *s, const struct rb_net_spring *spring, double scale,
                         const rb_mat3 *stiff)
{
	static const rb_mat3 none;
	struct node node[2];
	rb_mat3 own, other;
	int count = 0;

	for (int i = 0; i < 9; i++) {
		own.m[i / 3][i % 3] = scale * stiff->m[i / 3][i % 3];
		other.m[i / 3][i % 3] = -own.m[i / 3][i % 3];
	}
	for (int e = 0; e < 2; e++) {
		if (spring->body[e] < 0)
			continue;
		const struct rb_net_body *body = &s->net->body[spring->body[e]];

		node[count] = (struct node){body->block, body->offset, none};
		add_part(&s->blocks, &node[count], &node[count], &own);
		count++;
	}
	if (count == 2)
		add_part(&s->blocks, &node[0], &node[1], &other);
}

void rb_net_add_spring(struct rb_net_system *s, const struct rb_net_spring *spring, double scale,
                       const rb_mat3 *stiff, const rb_vec3 arm[2])
{
	struct node node[4];

	if (!turns(s->net, spring)) {
		add_straight(s, spring, scale, stiff);
		return;
	}
	const int count = nodes_of(s->net, spring, arm, node);

	for (int q = 0; q < count; q++) {
		const rb_mat3 right = rb_mat3_multiply(stiff, &node[q].jacobian);

		for (int p = 0; p <= q; p++) {
			const rb_mat3 left = rb_mat3_transposed(&node[p].jacobian);
			rb_mat3 k = rb_mat3_multiply(&left, &right);

			for (int i = 0; i < 9; i++)
				k.m[i / 3][i % 3] *= scale;
			add_part(&s->blocks, &node[p], &node[q], &k);
		}
	}
}

/* Sets scale times masses, also in halves of blocks without a body. */
void rb_net_add_masses(struct rb_net_system *s, double scale, bool at_end)
{
	const struct rb_net *net = s->net;

	rb_blocks_clear(&s->blocks);
	for (int k = 0; k < net->body_count; k++) {
		const struct rb_net_body *body = &net->body[k];
		bool transposed;
		rb_block *d = rb_blocks_at(&s->blocks, body->block, body->block, &transposed);

		for (int i = 0; i < 3; i++) {
			d->m[body->offset + i][body->offset + i] += scale * body->mass;
			if (body->offset == 0 && !body->turns && d->m[3 + i][3 + i] == 0)
				d->m[3 + i][3 + i] = scale * body->mass;
			if (body->offset == 3) /* the body at offset 0 may have put its own here */
				d->m[3 + i][3 + i] = scale * body->mass;
		}
		if (!body->turns)
			continue;
		const rb_mat3 inertia = rb_net_inertia(body, at_end ? body->to : body->from);
		for (int i = 0; i < 9; i++)
			d->m[3 + i / 3][3 + i % 3] = scale * inertia.m[i / 3][i % 3];
	}
}

rb_mat3 rb_net_stiffness(rb_vec3 n, double along, double across)
{
	const double x[3] = {n.x, n.y, n.z}, square = rb_vec3_dot(n, n);
	const double dyad = along - (square > 0 ? across / square : 0);
	rb_mat3 k;

	for (int i = 0; i < 9; i++)
		k.m[i / 3][i % 3] = dyad * (x[i / 3] * x[i % 3]) + (i % 4 == 0 ? across : 0);
	return k;
}

/* ---- springs ---- */

/* Displacement by rotation in the step of a point at that arm. */
static rb_vec3 rotation_of(rb_vec3 turn, rb_vec3 arm)
{
	const rb_vec3 once = rb_vec3_cross(turn, arm);

	return rb_vec3_scale(1 / (1 + 0.25 * rb_vec3_dot(turn, turn)),
	                     rb_vec3_add_scaled(once, 0.5, rb_vec3_cross(turn, once)));
}

void rb_net_place_ends(const struct rb_net *net, struct rb_net_spring *spring, double h)
{
	rb_vec3 displacement[2];

	for (int e = 0; e < 2; e++) {
		rb_vec3 bend = {0, 0, 0};

		displacement[e] = spring->displacement[e];
		if (spring->body[e] >= 0) {
			const struct rb_net_body *body = &net->body[spring->body[e]];

			if (body->turns)
				bend = rotation_of(rb_vec3_scale(h, body->mean[1]), spring->arm[e]);
			displacement[e] = rb_vec3_add_scaled(bend, h, body->mean[0]);
		}
		spring->arm_to[e] = rb_vec3_add(spring->arm[e], bend);
		spring->arm_mean[e] = rb_vec3_add_scaled(spring->arm[e], 0.5, bend);
	}
	const rb_vec3 relative = rb_vec3_sub(displacement[1], displacement[0]);

	spring->to = rb_vec3_add(spring->from, relative);
	const rb_vec3 sum = rb_vec3_add(spring->from, spring->to);
	const double length = rb_vec3_length(spring->to) + spring->length;

	/* without cancellation */
	spring->length_to = spring->length + (length > 0 ? rb_vec3_dot(relative, sum) / length : 0);
}

/*
 * Mean direction, not of unit length: its length is the cosine of half of the angle that it turns
 * by.
 */
static rb_vec3 direction_of(const struct rb_net_spring *spring)
{
	const double length = spring->length + spring->length_to;

	return length > 0 ? rb_vec3_scale(1 / length, rb_vec3_add(spring->from, spring->to))
	                  : (rb_vec3){0, 0, 0};
}

static double tension_of(const struct rb_net_spring *spring, double h)
{
	const double longer = spring->length_to - spring->length;
	const double share = spring->resolved ? 0.5 : 1;

	return spring->stiffness * (spring->length - spring->rest + share * longer) +
	       spring->damping * longer / h;
}

/* Impulse of a spring for the present ends; `stiff`: its stiffness. */
static void act(struct rb_net_spring *spring, double h, rb_mat3 *stiff)
{
	const rb_vec3 n = direction_of(spring);
	const double share = spring->resolved ? 0.5 : 1;
	const double damper = spring->damping / h;

	if (spring->rest > 0) {
		const double tension = tension_of(spring, h);
		const double length = spring->length + spring->length_to;

		spring->impulse = rb_vec3_scale(-h * tension, n);
		if (stiff)
			*stiff = rb_net_stiffness(n, share * spring->stiffness + damper,
			                          length > 0 ? fmax(0, tension) / length : 0);
		return;
	}
	const rb_vec3 relative = rb_vec3_sub(spring->to, spring->from);
	const rb_vec3 at = rb_vec3_add_scaled(spring->from, share, relative);
	const double rate = spring->length_to - spring->length;

	spring->impulse = rb_vec3_add_scaled(rb_vec3_scale(-h * spring->stiffness, at),
	                                     -h * damper * rate, n);
	if (stiff) {
		*stiff = rb_net_stiffness(n, damper, 0);
		for (int i = 0; i < 3; i++)
			stiff->m[i][i] += share * spring->stiffness;
	}
}

void rb_net_add_impulse(struct rb_net *net, const struct rb_net_spring *spring, rb_vec3 p,
                        const rb_vec3 arm[2])
{
	for (int e = 0; e < 2; e++) {
		const rb_vec3 on = e == 0 ? rb_vec3_neg(p) : p;

		if (spring->body[e] < 0)
			continue;
		struct rb_net_body *body = &net->body[spring->body[e]];

		body->impulse = rb_vec3_add(body->impulse, on);
		if (body->turns)
			body->turn = rb_vec3_add(body->turn, rb_vec3_cross(arm[e], on));
	}
}

/* ---- equations ---- */

rb_quat rb_net_turned(const struct rb_net_body *body, double h)
{
	const rb_vec3 t = rb_vec3_scale(0.5 * h, body->mean[1]);

	return rb_quat_unit(rb_quat_multiply((rb_quat){1, t.x, t.y, t.z}, body->from));
}

rb_vec3 rb_net_momentum(const struct rb_net_body *body, rb_quat q, rb_vec3 spin)
{
	return isnan(body->scalar) ? rb_quat_rotate(q, rb_mat3_apply(body->tensor,
	                                                             rb_quat_rotate_back(q, spin)))
	                           : rb_vec3_scale(body->scalar, spin);
}

/* kg m^2/s: angular momentum at the end for this mean spin. */
static rb_vec3 momentum_at_end(const struct rb_net_body *body, double h)
{
	const rb_vec3 mean = body->mean[1];

	if (!isnan(body->scalar))
		return rb_vec3_scale(body->scalar,
		                     rb_vec3_sub(rb_vec3_scale(2, mean), body->angular));
	/* rotation about the mean spin leaves that unchanged in body axes */
	const rb_vec3 local = rb_vec3_sub(rb_vec3_scale(2, rb_quat_rotate_back(body->from, mean)),
	                                  rb_quat_rotate_back(body->from, body->angular));

	return rb_quat_rotate(rb_net_turned(body, h), rb_mat3_apply(body->tensor, local));
}

void rb_net_clear_sums(struct rb_net *net)
{
	for (int k = 0; k < net->body_count; k++)
		net->body[k].impulse = net->body[k].turn = (rb_vec3){0, 0, 0};
}

void rb_net_evaluate(struct rb_net_system *s, double *x)
{
	struct rb_net *net = s->net;

	rb_net_clear_sums(net);
	for (int k = 0; k < net->spring_count; k++) {
		struct rb_net_spring *spring = &net->spring[k];

		rb_net_place_ends(net, spring, s->h);
		act(spring, s->h, NULL);
		rb_net_add_impulse(net, spring, spring->impulse, spring->arm_mean);
	}
	memset(x, 0, s->size * sizeof *x);
	for (int k = 0; k < net->body_count; k++) {
		const struct rb_net_body *body = &net->body[k];
		const rb_vec3 change = rb_vec3_sub(
			rb_vec3_scale(2, rb_vec3_sub(body->mean[0], body->linear)), body->constant);

		rb_vec3_to(rb_net_unknown(x, body),
		           rb_vec3_sub(body->impulse, rb_vec3_scale(body->mass, change)));
		if (body->turns)
			rb_vec3_to(rb_net_unknown(x, body) + 3,
			           rb_vec3_sub(body->turn, rb_vec3_sub(momentum_at_end(body, s->h),
			                                               body->spin_momentum)));
	}
}

/* An outward tension stiffens rotation: by half, since the arm is a mean. */
static void add_lever(struct rb_net_system *s, const struct rb_net_spring *spring, int e)
{
	if (spring->body[e] < 0 || !s->net->body[spring->body[e]].turns)
		return;
	const struct rb_net_body *body = &s->net->body[spring->body[e]];
	const rb_vec3 r = spring->arm_to[e];
	const double x[3] = {r.x, r.y, r.z}, square = rb_vec3_dot(r, r);
	const double out = (e == 0 ? -1 : 1) * rb_vec3_dot(spring->impulse, r);
	bool transposed;
	rb_block *d = rb_blocks_at(&s->blocks, body->block, body->block, &transposed);

	for (int i = 0; out > 0 && square > 0 && i < 9; i++)
		d->m[3 + i / 3][3 + i % 3] += 0.5 * s->h * out *
		                              ((i % 4 == 0) - x[i / 3] * x[i % 3] / square);
}

bool rb_net_factor(struct rb_net_system *s)
{
	struct rb_net *net = s->net;

	rb_net_add_masses(s, 2, false);
	for (int k = 0; k < net->spring_count; k++) {
		struct rb_net_spring *spring = &net->spring[k];
		const rb_vec3 impulse = spring->impulse;

		act(spring, s->h, &spring->stiff);
		spring->impulse = impulse;
		memcpy(spring->stiff_arm, spring->arm_mean, sizeof spring->stiff_arm);
		rb_net_add_spring(s, spring, s->h * s->h, &spring->stiff, spring->stiff_arm);
		for (int e = 0; e < 2; e++)
			add_lever(s, spring, e);
	}
	net->factors++;
	return rb_blocks_factor(&s->blocks);
}

void rb_net_move_means(struct rb_net *net, double part, double *x)
{
	for (int k = 0; k < net->body_count; k++) {
		struct rb_net_body *body = &net->body[k];
		const double *at = rb_net_unknown(x, body);

		body->mean[0] = rb_vec3_add_scaled(body->mean[0], part, rb_vec3_from(at));
		if (body->turns)
			body->mean[1] = rb_vec3_add_scaled(body->mean[1], part,
			                                   rb_vec3_from(at + 3));
	}
}

rb_vec3 rb_net_relative_velocity(const struct rb_net *net, const struct rb_net_spring *spring,
                                 double *x, const rb_vec3 arm[2])
{
	rb_vec3 u = {0, 0, 0};

	for (int e = 0; e < 2; e++) {
		if (spring->body[e] < 0)
			continue;
		const struct rb_net_body *body = &net->body[spring->body[e]];
		const double *at = rb_net_unknown(x, body);
		rb_vec3 v = rb_vec3_from(at);

		if (body->turns)
			v = rb_vec3_add(v, rb_vec3_cross(rb_vec3_from(at + 3), arm[e]));
		u = rb_vec3_add_scaled(u, e == 0 ? -1 : 1, v);
	}
	return u;
}
