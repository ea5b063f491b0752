/* SPDX-License-Identifier: MIT */
#include "stepped/nets.h"

#include <string.h>

#include "base/error.h"
#include "base/forest.h"
#include "force/spring.h"
#include "model/joints.h"
#include "stepped/tally.h"
#include "world/joint_state.h"

/* ---- finding nets ---- */

struct search {
	struct rb_world *world;
	const struct rb_elements *springs;
	const unsigned char *here, *given;
	int *parent;                 /* [bodies] */
	unsigned char *stiff, *held; /* [bodies]: by root */
};

static bool is_solved_for(const struct search *search, int i)
{
	return rb_stepped_is_dynamic(search->world, i) && search->here[i];
}

static bool is_held(const struct rb_world *world, int i)
{
	const struct rb_joints *joints = world->model->joints;

	for (int e = joints ? joints->first[i] : 0; joints && e < joints->first[i + 1]; e++)
		if (!world->joint[joints->of[e]].released)
			return true;
	return false;
}

/* A body of it that is solved for; -1: none. */
static int owner_of(const struct search *search, int spring)
{
	const int *end = search->springs->end[spring];

	return is_solved_for(search, end[0]) ? end[0] : is_solved_for(search, end[1]) ? end[1] : -1;
}

static void connect(const struct search *search)
{
	const int n = search->world->model->body_count;

	for (int i = 0; i < n; i++)
		search->parent[i] = i;
	for (int k = 0; k < search->springs->count; k++) {
		const int *end = search->springs->end[k];

		if (is_solved_for(search, end[0]) && is_solved_for(search, end[1]))
			rb_forest_join(search->parent, end[0], end[1], false);
	}
	for (int k = 0; k < search->springs->count; k++) {
		const int owner = search->given[k] ? owner_of(search, k) : -1;

		if (owner >= 0)
			search->stiff[rb_forest_root(search->parent, owner)] = 1;
	}
	for (int i = 0; i < n; i++)
		if (search->world->model->joints && search->here[i] && is_held(search->world, i))
			search->held[rb_forest_root(search->parent, i)] = 1;
}

/* Numbers nets in the order of their first bodies, and counts their bodies and springs. */
static enum rb_status number(const struct search *search, struct rb_nets *nets,
                             struct rb_error *err)
{
	struct rb_arena *arena = &search->world->arena[0];
	const int n = search->world->model->body_count;

	for (int i = 0; i < n; i++) {
		const int root = rb_forest_root(search->parent, i);

		nets->of[i] = -1;
		if (!is_solved_for(search, i) || !search->stiff[root] || search->held[root])
			continue;
		nets->of[i] = root == i ? nets->count++ : nets->of[root];
	}
	nets->net = rb_arena_take(arena, (size_t)nets->count + 1, sizeof *nets->net);
	if (!nets->net)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the springs of a step");
	memset(nets->net, 0, (size_t)nets->count * sizeof *nets->net);
	for (int i = 0; i < n; i++)
		if (nets->of[i] >= 0)
			nets->at[i] = nets->net[nets->of[i]].body_count++;
	for (int k = 0; k < search->springs->count; k++) {
		const int owner = owner_of(search, k);

		nets->of_spring[k] = owner < 0 ? -1 : nets->of[owner];
		if (nets->of_spring[k] >= 0)
			nets->at_spring[k] = nets->net[nets->of_spring[k]].spring_count++;
	}
	for (int k = 0; k < nets->count; k++) {
		struct rb_net *net = &nets->net[k];

		net->body = rb_arena_take(arena, (size_t)net->body_count, sizeof *net->body);
		net->spring = rb_arena_take(arena, (size_t)net->spring_count, sizeof *net->spring);
		if (!net->body || !net->spring)
			return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the springs of a step");
	}
	return RB_OK;
}

/* m: displacement of a point of a body that is not solved for. */
static rb_vec3 displacement_of(const struct rb_pose *pose, rb_vec3 arm, double h)
{
	const rb_vec3 turn = rb_vec3_scale(h, pose->spin);

	return rb_vec3_add(
		rb_vec3_scale(h, pose->velocity),
		rb_vec3_sub(rb_quat_rotate(rb_quat_turned(rb_quat_identity, turn), arm), arm));
}

static void fill_spring(const struct search *search, const struct rb_nets *nets, int k, double h)
{
	const struct rb_world *world = search->world;
	const struct rb_spring_def *def = rb_elements_row(search->springs, k);
	struct rb_net *net = &nets->net[nets->of_spring[k]];
	struct rb_net_spring *spring = &net->spring[nets->at_spring[k]];
	const rb_vec3 at[2] = {def->at_a, def->at_b};
	struct rb_pose pose[2];

	*spring = (struct rb_net_spring){.number = k,
	                                 .resolved = true,
	                                 .stiffness = def->stiffness,
	                                 .damping = def->damping,
	                                 .rest = def->rest_length_m};
	for (int e = 0; e < 2; e++) {
		const int i = search->springs->end[k][e];

		pose[e] = rb_world_pose(world, &world->state, i);
		spring->arm[e] = rb_element_arm(world->model, i, pose[e].orientation, at[e]);
		spring->body[e] = -1;
		if (!is_solved_for(search, i)) {
			spring->displacement[e] = displacement_of(&pose[e], spring->arm[e], h);
			continue;
		}
		spring->body[e] = nets->at[i];
		if (world->state.spin && rb_vec3_max_abs(spring->arm[e]) > 0)
			net->body[nets->at[i]].turns = true;
	}
	spring->from = rb_vec3_add(rb_pose_between(&pose[0], &pose[1]),
	                           rb_vec3_sub(spring->arm[1], spring->arm[0]));
	spring->length = rb_vec3_length(spring->from);
}

static void fill(const struct search *search, const struct rb_nets *nets, double h)
{
	const struct rb_model *model = search->world->model;
	const struct rb_solver *solver = &search->world->stepped->solver;

	for (int i = 0; i < model->body_count; i++) {
		if (nets->of[i] < 0)
			continue;
		struct rb_net_body *body = &nets->net[nets->of[i]].body[nets->at[i]];

		*body = (struct rb_net_body){
			.index = i, .mass = model->mass[i], .scalar = (double)NAN};
		if (!search->world->state.spin)
			continue;
		body->tensor = rb_model_inertia(model, i);
		if (!isnan(model->inverse_inertia_scalar[i]))
			body->scalar = rb_model_inertia(model, i)->m[0][0];
		body->from = rb_world_orientation_at(search->world, &search->world->state, i);
	}
	for (int k = 0; k < search->springs->count; k++)
		if (nets->of_spring[k] >= 0)
			fill_spring(search, nets, k, h);
	for (int k = 0; k < solver->spring_count; k++) {
		const int row = solver->spring[k].row;

		if (nets->of_spring[row] >= 0)
			nets->net[nets->of_spring[row]].spring[nets->at_spring[row]].resolved =
				false;
	}
}

static int first_element_of(const struct rb_model *model)
{
	int first = 0;

	for (int k = 0; model->elements[k].kind != &rb_force_spring; k++)
		first += model->elements[k].end ? model->elements[k].count : 0;
	return first;
}

enum rb_status rb_nets_find(struct rb_world *world, const unsigned char *here,
                            const unsigned char *stiff, double h, struct rb_error *err)
{
	struct rb_arena *arena = &world->arena[0];
	const size_t n = (size_t)world->model->body_count;
	struct search search = {.world = world,
	                        .springs = rb_model_elements(world->model, &rb_force_spring),
	                        .here = here,
	                        .given = stiff};

	RB_ASSERT(h > 0);
	const size_t count = (size_t)search.springs->count;
	struct rb_nets *nets = rb_arena_take(arena, 1, sizeof *nets);
	int *numbers = rb_arena_take(arena, 3 * n + 2 * count, sizeof *numbers);

	search.stiff = rb_arena_take(arena, 2 * n, 1);
	if (!nets || !numbers || !search.stiff)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the springs of a step");
	memset(search.stiff, 0, 2 * n);
	search.held = search.stiff + n;
	search.parent = numbers;
	*nets = (struct rb_nets){.of = numbers + n,
	                         .at = numbers + 2 * n,
	                         .of_spring = numbers + 3 * n,
	                         .at_spring = numbers + 3 * n + count,
	                         .first_element = first_element_of(world->model)};
	connect(&search);
	const enum rb_status status = number(&search, nets, err);
	if (status != RB_OK)
		return status;
	fill(&search, nets, h);
	world->stepped->nets = nets;
	return RB_OK;
}

bool rb_nets_record(struct rb_stepped *s, int spring, rb_vec3 alone)
{
	struct rb_nets *nets = s->nets;

	if (!nets || nets->of_spring[spring] < 0)
		return false;
	nets->net[nets->of_spring[spring]].spring[nets->at_spring[spring]].alone = alone;
	return true;
}

/* ---- results ---- */

static void add_motion(struct rb_world *world, const struct rb_net_body *body, rb_vec3 linear,
                       rb_vec3 angular)
{
	const size_t row = 3 * (size_t)body->index;

	rb_vec3_to(world->state.velocity + row,
	           rb_vec3_add(rb_vec3_from(world->state.velocity + row), linear));
	if (body->turns)
		rb_vec3_to(world->state.spin + row,
		           rb_vec3_add(rb_vec3_from(world->state.spin + row), angular));
}

/* Reports its impulses to the ledger: as solved, or each alone. */
static void report(struct rb_world *world, const struct rb_net *net, bool alone)
{
	struct rb_tally *tally = world->stepped->tally;

	for (int k = 0; tally && k < net->spring_count; k++) {
		const struct rb_net_spring *spring = &net->spring[k];
		struct rb_tally_element *element =
			&tally->element[world->stepped->nets->first_element + spring->number];
		const rb_vec3 p = alone ? spring->alone
		                        : rb_vec3_add(spring->impulse, spring->stopping);

		for (int e = 0; e < 2; e++) {
			element->on[e].force = e == 0 ? rb_vec3_neg(p) : p;
			element->on[e].torque = rb_vec3_cross(spring->arm[e], element->on[e].force);
		}
		element->damped = alone ? (double)NAN : spring->damped;
	}
}

static void release(struct rb_world *world, struct rb_net *net)
{
	struct rb_stepped *s = world->stepped;

	net->released = true;
	for (int k = 0; k < net->spring_count; k++) {
		const struct rb_net_spring *spring = &net->spring[k];

		for (int e = 0; e < 2; e++) {
			if (spring->body[e] < 0)
				continue;
			const struct rb_net_body *body = &net->body[spring->body[e]];
			const rb_vec3 p = e == 0 ? rb_vec3_neg(spring->alone) : spring->alone;
			const rb_vec3 v = rb_vec3_scale(1 / body->mass, p);
			rb_vec3 w = {0, 0, 0};

			if (body->turns)
				w = rb_world_turn(world, &world->state, body->index,
				                  rb_vec3_cross(spring->arm[e], p));
			add_motion(world, body, v, w);
			double *const varied = s->varied + 3 * (size_t)body->index;
			rb_vec3_to(varied, rb_vec3_add(rb_vec3_from(varied), v));
		}
	}
	report(world, net, true);
}

void rb_nets_release(struct rb_world *world, int k)
{
	struct rb_net *net = &world->stepped->nets->net[k];

	if (net->released)
		return;
	for (int b = 0; b < net->body_count; b++) {
		const struct rb_net_body *body = &net->body[b];
		const rb_vec3 v = rb_vec3_add(body->linear, body->constant);

		add_motion(world, body, rb_vec3_sub(v, body->end[0]),
		           rb_vec3_sub(body->angular, body->end[1]));
	}
	release(world, net);
}

static void begin(const struct rb_world *world, struct rb_net_body *body)
{
	const int i = body->index;

	body->linear = rb_vec3_add(rb_world_row3(world->mark.velocity, i),
	                           rb_world_row3(world->stepped->varied, i));
	body->constant = rb_vec3_sub(rb_world_row3(world->state.velocity, i), body->linear);
	if (world->state.spin)
		body->angular = rb_world_row3(world->state.spin, i);
}

void rb_nets_solve(struct rb_world *world, double h)
{
	struct rb_stepped *s = world->stepped;
	struct rb_arena *arena = &world->arena[0];

	for (int k = 0; s->nets && k < s->nets->count; k++) {
		struct rb_net *net = &s->nets->net[k];
		const rb_arena_mark here = rb_arena_here(arena);

		for (int b = 0; b < net->body_count; b++)
			begin(world, &net->body[b]);
		net->solved = rb_net_solve(net, h, arena);
		rb_arena_back(arena, here);
		if (!net->solved) {
			release(world, net);
			continue;
		}
		for (int b = 0; b < net->body_count; b++) {
			const struct rb_net_body *body = &net->body[b];
			const size_t row = 3 * (size_t)body->index;

			rb_vec3_to(world->state.velocity + row, body->end[0]);
			if (body->turns)
				rb_vec3_to(world->state.spin + row, body->end[1]);
			if (s->tally)
				s->tally->body[body->index].carry = rb_vec3_scale(0.5 * h,
				                                                  body->mean[0]);
		}
		report(world, net, false);
	}
}

bool rb_nets_turn(struct rb_world *world, int i)
{
	const struct rb_stepped *s = world->stepped;
	const int net = rb_nets_of(s, i);

	if (net < 0)
		return false;
	const struct rb_net_body *body = &s->nets->net[net].body[s->nets->at[i]];
	if (!body->turns)
		return false;
	rb_quat_to(world->state.orientation + 4 * (size_t)i, body->to);
	return true;
}

void rb_nets_end(struct rb_world *world)
{
	const struct rb_nets *nets = world->stepped->nets;

	for (int k = 0; nets && k < nets->count; k++) {
		const struct rb_net *net = &nets->net[k];

		for (int b = 0; !net->released && b < net->body_count; b++) {
			const struct rb_net_body *body = &net->body[b];

			add_motion(world, body, rb_vec3_sub(body->damped[0], body->end[0]),
			           rb_vec3_sub(body->damped[1], body->end[1]));
		}
	}
}

void rb_nets_blame(struct rb_world *world)
{
	const struct rb_nets *nets = world->stepped->nets;

	for (int k = 0; nets && k < nets->count; k++)
		for (int b = 0; !nets->net[k].solved && b < nets->net[k].body_count; b++)
			rb_stepped_blame(world->stepped, nets->net[k].body[b].index);
}
