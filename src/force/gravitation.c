/* SPDX-License-Identifier: MIT */
#include "force/gravitation.h"

#include <math.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/quat.h"
#include "math/random.h"

enum rb_status rb_gravitation_create(struct rb_gravitation *made, const struct rb_model *model,
                                     struct rb_error *err)
{
	const size_t n = (size_t)(model->body_count + model->static_count);

	*made = (struct rb_gravitation){.model = model};
	if (!model->attraction)
		return RB_OK;
	made->block = rb_memory_take(9 * n, sizeof *made->block);
	if (!made->block)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the gravitation of %zu bodies",
		               n);
	made->all = (struct rb_attract){.count = (int)n,
	                                .mu = model->attraction,
	                                .inertial = model->mass,
	                                .softening2 = model->softening2_m2};
	for (size_t m = 0; m < 3; m++) {
		made->all.x[m] = made->block + m * n;
		made->all.rest[m] = made->block + (3 + m) * n;
		made->acceleration[m] = made->block + (6 + m) * n;
	}
	for (int i = model->body_count; i < (int)n; i++) {
		const rb_vec3 center = model->scene->bodies[model->id_of[i]].center_of_mass;

		rb_gravitation_place(made, i,
		                     rb_vec3_add(model->position[i],
		                                 rb_quat_rotate(model->orientation[i], center)),
		                     (rb_vec3){0, 0, 0});
	}
	return RB_OK;
}

void rb_gravitation_release(struct rb_gravitation *gravitation)
{
	rb_memory_free(gravitation->block);
	rb_tree_destroy(gravitation->tree);
	rb_memory_free(gravitation->tree_block);
	*gravitation = (struct rb_gravitation){0};
}

void rb_gravitation_find(struct rb_gravitation *gravitation)
{
	RB_ASSERT(gravitation->block != NULL);
	rb_attract_some(&gravitation->all, 0, gravitation->model->body_count,
	                gravitation->acceleration);
}

/* Bodies of a block, and from how many on blocks are shared: some hundred microseconds of sums. */
enum { BODIES_PER_BLOCK = 64, SHARED_FROM = 256 };

static void find_block(void *user, int block, int worker)
{
	const struct rb_gravitation *const gravitation = user;
	const int n = gravitation->model->body_count, first = block * BODIES_PER_BLOCK;
	const int end = first + BODIES_PER_BLOCK < n ? first + BODIES_PER_BLOCK : n;

	(void)worker;
	rb_attract_some(&gravitation->all, first, end, gravitation->acceleration);
}

void rb_gravitation_find_by(struct rb_gravitation *gravitation, struct rb_team *team)
{
	const int n = gravitation->model->body_count;

	if (n < SHARED_FROM)
		rb_gravitation_find(gravitation);
	else
		rb_team_run(team, (n + BODIES_PER_BLOCK - 1) / BODIES_PER_BLOCK, find_block,
		            gravitation);
}

/* ---- by a tree ---- */

/* Does this moving body attract neither by its mass nor not at all? */
static bool is_odd(const struct rb_model *model, int i)
{
	const double by_mass = model->scene->world.gravitation.constant * model->mass[i];

	return model->inverse_mass[i] > 0 && model->attraction[i] > 0 &&
	       model->attraction[i] != by_mass;
}

bool rb_gravitation_by_tree(const struct rb_model *model)
{
	double attracted = 0;

	if (!model->attraction || model->method == RB_METHOD_LOCATED ||
	    model->scene->world.gravitation.opening_angle == 0)
		return false;
	for (int i = 0; i < model->body_count; i++) {
		if (is_odd(model, i))
			return false;
		attracted += rb_gravitation_attracts(model, i);
	}
	return attracted * model->attractor_count > RB_GRAVITATION_PAIRS_MAX;
}

enum rb_status rb_gravitation_plant(struct rb_gravitation *gravitation, struct rb_error *err)
{
	const struct rb_model *const model = gravitation->model;
	const size_t n = (size_t)gravitation->all.count;

	if (gravitation->tree || !rb_gravitation_by_tree(model))
		return RB_OK;
	gravitation->tree_block = rb_memory_take(5 * n, sizeof *gravitation->tree_block);
	if (!gravitation->tree_block)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the gravitation of %zu bodies",
		               n);
	gravitation->potential = gravitation->tree_block;
	gravitation->free_strength = gravitation->tree_block + n;
	for (size_t m = 0; m < 3; m++)
		gravitation->seen[m] = gravitation->tree_block + (2 + m) * n;
	for (int i = 0; i < model->body_count; i++)
		if (model->inverse_mass[i] > 0)
			gravitation->free_strength[i] = model->attraction[i];
	return rb_tree_create(&gravitation->tree, err);
}

/*
 * Of the largest moment of inertia: what is added to all, so that points on a line have an inverse.
 * Twelve digits of a correction are right.
 */
static const double least_inertia = 1e-12;

static rb_vec3 row_of(double *const column[3], int i)
{
	return (rb_vec3){column[0][i], column[1][i], column[2][i]};
}

/*
 * Takes the torque off that cells leave: what they give each other is opposite, but not along one
 * line, by as much as their forces are wrong. The accelerations of a turn of all about their centre
 * of mass, which are less than those errors, keep the angular momentum, and have no sum.
 */
static void take_torque(const struct rb_gravitation *gravitation, const struct rb_attract *all,
                        double *const acceleration[3])
{
	const struct rb_model *const model = gravitation->model;
	rb_vec3 moment = {0, 0, 0}, torque = {0, 0, 0};
	rb_mat3 inertia = {{{0}}}, inverse;
	double mass = 0;

	for (int i = 0; i < model->body_count; i++) {
		moment = rb_vec3_add_scaled(moment, model->mass[i], row_of(all->x, i));
		mass += model->mass[i];
	}
	const rb_vec3 center = rb_vec3_scale(1 / mass, moment);
	for (int i = 0; i < model->body_count; i++) {
		const rb_vec3 r = rb_vec3_sub(row_of(all->x, i), center);
		const double m = model->mass[i], square = m * rb_vec3_dot(r, r);
		const double x[3] = {r.x, r.y, r.z};

		torque = rb_vec3_add_scaled(torque, m, rb_vec3_cross(r, row_of(acceleration, i)));
		for (int j = 0; j < 3; j++)
			for (int k = 0; k < 3; k++)
				inertia.m[j][k] += (j == k ? square : 0) - m * x[j] * x[k];
	}
	const double some = least_inertia * (inertia.m[0][0] + inertia.m[1][1] + inertia.m[2][2]);
	for (int k = 0; k < 3; k++)
		inertia.m[k][k] += some;
	if (!rb_mat3_inverse(&inertia, &inverse))
		return;
	const rb_vec3 turn = rb_mat3_apply(&inverse, torque);
	for (int i = 0; i < model->body_count; i++) {
		const rb_vec3 r = rb_vec3_sub(row_of(all->x, i), center);
		const rb_vec3 more = rb_vec3_cross(turn, r);

		acceleration[0][i] -= more.x;
		acceleration[1][i] -= more.y;
		acceleration[2][i] -= more.z;
	}
}

/* Accelerations and potentials of all by the tree. */
static enum rb_status ask_tree(const struct rb_gravitation *gravitation,
                               const struct rb_attract *all, struct rb_team *team,
                               double *const acceleration[3], struct rb_error *err)
{
	double *const result[4] = {acceleration[0], acceleration[1], acceleration[2],
	                           gravitation->potential};

	const struct rb_model *const model = gravitation->model;
	const enum rb_status status = rb_tree_attract(gravitation->tree, all,
	                                              model->scene->world.gravitation.opening_angle,
	                                              team, result, err);

	/* all yield */
	if (status == RB_OK && all == &gravitation->all && model->attracts_by_mass &&
	    model->static_count == 0 && !model->driven)
		take_torque(gravitation, all, acceleration);
	return status;
}

enum rb_status rb_gravitation_sum(struct rb_gravitation *gravitation, struct rb_team *team,
                                  struct rb_error *err)
{
	if (gravitation->tree)
		return ask_tree(gravitation, &gravitation->all, team, gravitation->acceleration,
		                err);
	rb_gravitation_find_by(gravitation, team);
	return RB_OK;
}

/* A share of `of`; 0 where that is nothing. */
static double share(double difference, double of)
{
	return of > 0 ? difference / of : 0;
}

/* Compares the tree's last sums of some bodies with those of all pairs. */
static struct rb_gravitation_error compare(const struct rb_gravitation *gravitation, uint64_t draw)
{
	enum { SAMPLE = RB_GRAVITATION_SAMPLE, STREAM = 0x67726176 };
	const struct rb_model *const model = gravitation->model;
	double exact[3][SAMPLE];
	double *const to[3] = {exact[0], exact[1], exact[2]};
	struct rb_gravitation_error error = {0, 0};
	int list[SAMPLE], count = 0;

	for (uint64_t k = 0; k < SAMPLE; k++) {
		const double unit = rb_random_unit(draw, STREAM, k);
		const int i = (int)(unit * model->body_count);

		if (rb_gravitation_attracts(model, i))
			list[count++] = i;
	}
	if (count > 0)
		rb_attract_listed(&gravitation->all, list, count, to);
	for (int k = 0; k < count; k++) {
		const rb_vec3 a = {exact[0][k], exact[1][k], exact[2][k]};
		const rb_vec3 found = {gravitation->seen[0][list[k]], gravitation->seen[1][list[k]],
		                       gravitation->seen[2][list[k]]};
		double depth;

		(void)rb_attract_distance(&gravitation->all, list[k], &depth);
		error.acceleration = fmax(
			error.acceleration,
			share(rb_vec3_length(rb_vec3_sub(found, a)), rb_vec3_length(a)));
		error.potential = fmax(error.potential,
		                       share(fabs(gravitation->potential[list[k]] - depth), depth));
	}
	return error;
}

/*
 * Adds `weight` times the energy of all free bodies in the potentials that the tree has found last,
 * to the sum and what rounding leaves of it; `tests`: only of those that attract nobody, or only of
 * the others.
 */
static void add_energies(const struct rb_gravitation *gravitation, double weight, bool tests,
                         double sum[2])
{
	const struct rb_model *const model = gravitation->model;

	for (int i = 0; i < model->body_count; i++) {
		if (!(model->inverse_mass[i] > 0) || (model->attraction[i] > 0) == tests)
			continue;
		const double term = -weight * model->mass[i] * gravitation->potential[i];
		const double value = sum[0] + term, back = value - sum[0];

		sum[1] += (sum[0] - (value - back)) + (term - back);
		sum[0] = value;
	}
}

/*
 * Pairs of free bodies that attract count once, though both are in each other's potential; with
 * centres that do not yield, and of test bodies, all of the potential counts.
 */
enum rb_status rb_gravitation_energy(struct rb_gravitation *gravitation, struct rb_team *team,
                                     uint64_t draw, double *energy,
                                     struct rb_gravitation_error *error, struct rb_error *err)
{
	double sum[2] = {0, 0};

	*error = (struct rb_gravitation_error){0, 0};
	*energy = 0;
	if (!gravitation->tree) {
		*energy = rb_attract_energy(&gravitation->all);
		return RB_OK;
	}
	enum rb_status status = ask_tree(gravitation, &gravitation->all, team, gravitation->seen,
	                                 err);
	if (status != RB_OK)
		return status;
	const bool centres = gravitation->model->center_count > 0;
	*error = compare(gravitation, draw);
	add_energies(gravitation, 1, true, sum);
	add_energies(gravitation, centres ? 1 : 0.5, false, sum);
	if (centres) {
		struct rb_attract free = gravitation->all;

		free.mu = gravitation->free_strength;
		status = ask_tree(gravitation, &free, team, gravitation->seen, err);
		add_energies(gravitation, -0.5, false, sum);
	}
	*energy = sum[0] + sum[1];
	return status;
}

rb_vec3 rb_gravitation_surplus(const struct rb_gravitation *gravitation, int i, int j)
{
	const struct rb_attract *const all = &gravitation->all;
	double factor;
	const rb_vec3 d = rb_attract_between(all, i, j, &factor);

	return rb_vec3_scale(
		factor * (all->inertial[i] * all->mu[j] - rb_attract_strength(all, i, j)), d);
}

double rb_gravitation_weight(const struct rb_model *model)
{
	const int n = model->body_count + model->static_count;
	double least = (double)INFINITY, max = 0;

	if (!model->attraction)
		return 0;
	for (int i = 0; i < model->body_count; i++)
		if (model->inverse_mass[i] > 0)
			least = fmin(least, rb_model_reach(model, i));
	for (int j = 0; j < n; j++) {
		const double distance = rb_model_reach(model, j) + least;

		max = fmax(max,
		           model->attraction[j] / (distance * distance + model->softening2_m2));
	}
	return max;
}
