/* SPDX-License-Identifier: MIT */
#include "stepped/energy.h"

#include <string.h>

#include "base/error.h"

/* Rounding of sums over an island, in ulp. */
enum { NOISE_ULP = 16 };

/*
 * Largest ratio of impulses to momentum. Levers and wedges need ratios that leave twelve digits;
 * larger ones are accepted only if they also result without separation, and then up to a ratio that
 * leaves ten.
 */
static const double impulse_max = 1e4, impulse_max_held = 1e6;

static inline rb_vec3 angular_momentum(const struct rb_solver *solver, int i, rb_vec3 turn)
{
	const double inverse = solver->dense.bodies.body[i].inverse_inertia;
	rb_mat3 inertia;

	if (!isnan(inverse))
		return rb_vec3_scale(inverse > 0 ? 1 / inverse : 0, turn);
	(void)rb_mat3_inverse(&solver->tensor[i], &inertia);
	return rb_mat3_apply(&inertia, turn);
}

struct rb_solver_body rb_energy_momentum_of(const struct rb_solver *solver, int i,
                                            const struct rb_solver_body *motion)
{
	return (struct rb_solver_body){
		.linear = rb_vec3_scale(1 / solver->dense.bodies.body[i].inverse_mass,
	                                motion->linear),
		.angular = angular_momentum(solver, i, motion->angular)};
}

static struct rb_solver_body difference(const struct rb_solver_body *x,
                                        const struct rb_solver_body *y)
{
	return (struct rb_solver_body){.linear = rb_vec3_sub(x->linear, y->linear),
	                               .angular = rb_vec3_sub(x->angular, y->angular)};
}

/* Velocities at the beginning of the step, after the impacts in it. */
static struct rb_solver_body motion_before(const struct rb_solver *solver, int i)
{
	const struct rb_state *before = solver->before;
	struct rb_solver_body motion = {.linear = rb_vec3_from(before->velocity + 3 * (size_t)i)};

	if (before->spin)
		motion.angular = rb_vec3_from(before->spin + 3 * (size_t)i);
	if (solver->kicks) {
		const struct rb_kick *const kick = rb_kick_of(solver->kicks, i);

		motion.linear = rb_vec3_add(motion.linear, kick->linear);
		motion.angular = rb_vec3_add(motion.angular, kick->angular);
	}
	return motion;
}

/* Work of driven bodies on an island by its impulses, J. */
static double driven_work(const struct rb_solver *solver, const struct rb_island *island)
{
	const struct rb_row_system rows = rb_islands_rows(solver, island);

	return island->is_driven ? rb_row_system_work(&rows) : 0;
}

/* Whether the row is bilateral and rigid. */
static bool is_bilateral(const struct rb_constraint *row)
{
	return row->set == RB_CONSTRAINT_FREE ||
	       (row->softness == 0 && isinf(row->low) && isinf(row->high));
}

/*
 * Work of joints, J, at the velocities solved for: on a curved path the constraint direction turns,
 * and its work is returned later. For bilateral rows, at the target velocities, since a residual
 * within the tolerance times a large force is no work. Motors, springs and friction are not
 * contacts either. Limits and ropes dissipate as contacts do, by closing a gap.
 */
static double joint_work(const struct rb_solver *solver, const struct rb_island *island)
{
	const struct rb_solver_bodies *bodies = &solver->dense.bodies;
	double sum = 0;

	for (int k = island->contact_count; k < island->row_count; k++) {
		const struct rb_constraint *row = &solver->dense.row[island->first_row + k];
		const rb_vec3 at = is_bilateral(row) ? rb_constraint_joined(row, row->target)
		                                     : rb_constraint_velocity(bodies, row);
		const double work = rb_vec3_dot(rb_constraint_impulse(row), at);

		sum += rb_constraint_side(row) != 0 ? fmax(0, work) : work;
	}
	return sum;
}

/*
 * A body's terms of the sums, from the changes of its motion by forces and by impulses. A body
 * without an impulse may move as a free one, and contributes nothing.
 */
static inline void add_body(struct rb_energy *energy, const struct rb_solver *solver, int i)
{
	const struct rb_solver_body *now = &solver->dense.bodies.body[i], *free = &solver->free[i];
	const struct rb_solver_body before = motion_before(solver, i);
	RB_ASSERT_COSTLY(now->inverse_mass > 0);
	const double mass = 1 / now->inverse_mass;
	const rb_vec3 force = rb_vec3_sub(free->linear, before.linear);
	const rb_vec3 change = rb_vec3_sub(now->linear, free->linear);
	double square = mass * rb_vec3_dot(change, change);
	double mixed = mass * rb_vec3_dot(change, before.linear);
	double lost = mass * rb_vec3_dot(force, force);
	const rb_vec3 turn = rb_vec3_sub(now->angular, free->angular);

	if (rb_vec3_max_abs(change) == 0 && rb_vec3_max_abs(turn) == 0)
		return;
	if (now->inverse_inertia != 0) {
		const rb_vec3 twist = rb_vec3_sub(free->angular, before.angular);
		const rb_vec3 momentum = angular_momentum(solver, i, turn);

		square += rb_vec3_dot(momentum, turn);
		mixed += rb_vec3_dot(momentum, before.angular);
		if (rb_vec3_max_abs(twist) > 0)
			lost += rb_vec3_dot(angular_momentum(solver, i, twist), twist);
	}
	energy->square += square;
	energy->mixed += mixed;
	energy->lost += lost;
	energy->noise += square + fabs(mixed) + lost;
}

/*
 * Sums over a large island, which has a team, are formed by blocks, in order: they do not depend on
 * the workers.
 */
enum { PER_BLOCK = 512 };

struct bound {
	double momentum, max; /* of impulses, N s */
};

struct sums {
	const struct rb_solver *solver;
	const struct rb_island *island;
	const struct rb_row_system *dense;
	struct rb_energy *energy; /* by blocks of members */
	struct bound *bound;      /* by blocks of rows, then of members */
	int row_blocks;
};

static int blocks_of(int count)
{
	return (count + PER_BLOCK - 1) / PER_BLOCK;
}

static int end_of(int block, int count)
{
	return (block + 1) * PER_BLOCK < count ? (block + 1) * PER_BLOCK : count;
}

static inline void add_members(const struct sums *sums, int first, int end,
                               struct rb_energy *energy)
{
	const struct rb_island *island = sums->island;
	struct rb_energy sum = *energy;

	for (int k = first; k < end; k++)
		add_body(&sum, sums->solver, sums->solver->member[island->first_member + k]);
	*energy = sum;
}

static void add_members_block(void *user, int block, int worker)
{
	const struct sums *sums = user;

	(void)worker;
	sums->energy[block] = (struct rb_energy){0};
	add_members(sums, block * PER_BLOCK, end_of(block, sums->island->member_count),
	            &sums->energy[block]);
}

static void add_energy(struct rb_energy *sum, const struct rb_energy *part)
{
	sum->square += part->square;
	sum->mixed += part->mixed;
	sum->lost += part->lost;
	sum->noise += part->noise;
}

struct rb_energy rb_energy_of(const struct rb_solver *solver, const struct rb_island *island,
                              struct rb_team *team, struct rb_arena *arena)
{
	struct rb_energy energy = {.mixed = -driven_work(solver, island)};
	struct sums sums = {.solver = solver, .island = island};

	energy.noise = fabs(energy.mixed);
	if (island->row_count > island->contact_count) {
		const double given = joint_work(solver, island);

		energy.mixed -= given;
		energy.noise += fabs(given);
	}
	const int blocks = team ? blocks_of(island->member_count) : 0;
	/* the arena is released with the whole island */
	if (team)
		sums.energy = rb_arena_take(arena, (size_t)blocks, sizeof *sums.energy);
	if (sums.energy)
		rb_team_run(team, blocks, add_members_block, &sums);
	else
		add_members(&sums, 0, island->member_count, &energy);
	for (int b = 0; sums.energy && b < blocks; b++)
		add_energy(&energy, &sums.energy[b]);
	energy.noise *= NOISE_ULP * DBL_EPSILON;
	return energy;
}

/* Root, up to 1, of c s^2 + 2 b s - a, which is not positive at 0, without cancellation. */
static double root_of(double c, double b, double a)
{
	RB_ASSERT(!(a < 0));
	if (!(c + 2 * b > a))
		return 1;
	const double root = sqrt(b * b + c * a);
	return fmin(1, b > 0 ? a / (b + root) : (root - b) / c);
}

double rb_energy_share(const struct rb_energy *energy)
{
	return root_of(energy->square, energy->mixed, energy->lost);
}

double rb_energy_interpolation_share(const struct rb_solver *solver, const struct rb_island *island,
                                     const struct rb_energy *now,
                                     const struct rb_saved_solution *kept)
{
	double mixed = driven_work(solver, island) - kept->driven_work;
	double square = 0;

	for (int k = 0; k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];
		const struct rb_solver_body before = motion_before(solver, i);
		const struct rb_solver_body change = difference(&kept->body[k],
		                                                &solver->dense.bodies.body[i]);
		const struct rb_solver_body momentum = rb_energy_momentum_of(solver, i, &change);
		const struct rb_solver_body impulse = difference(&solver->dense.bodies.body[i],
		                                                 &solver->free[i]);

		square += rb_energy_product(&momentum, &change);
		mixed += rb_energy_product(&momentum, &before) +
		         rb_energy_product(&momentum, &impulse);
	}
	return root_of(square, mixed, fmax(0, -2 * rb_energy_gain(now)));
}

static inline struct bound bound_of_rows(const struct sums *sums, int first, int end)
{
	struct bound bound = {0};

	for (int k = first; k < end; k++) {
		const struct rb_constraint *row = &sums->dense->row[k];

		bound.max = fmax(bound.max, rb_constraint_side(row) * row->impulse.n);
		if (isfinite(row->target.n))
			bound.momentum += fabs(row->target.n) / row->inverse_mass_n;
	}
	return bound;
}

static inline struct bound bound_of_members(const struct sums *sums, int first, int end)
{
	const struct rb_solver *solver = sums->solver;
	const struct rb_island *island = sums->island;
	struct bound bound = {0};

	for (int k = first; k < end; k++) {
		const int i = solver->member[island->first_member + k];
		const struct rb_solver_body *motion[2] = {&solver->free[i],
		                                          &sums->dense->bodies.body[i]};

		for (int m = 0; m < 2; m++) {
			const struct rb_solver_body weight = rb_energy_momentum_of(solver, i,
			                                                           motion[m]);

			bound.momentum += sqrt(rb_energy_product(&weight, motion[m]) /
			                       motion[m]->inverse_mass);
		}
	}
	return bound;
}

static void bound_block(void *user, int block, int worker)
{
	const struct sums *sums = user;

	(void)worker;
	const int rows = sums->dense->row_count, members = sums->island->member_count;
	const int of_members = block - sums->row_blocks;

	sums->bound[block] = of_members < 0
	                             ? bound_of_rows(sums, block * PER_BLOCK, end_of(block, rows))
	                             : bound_of_members(sums, of_members * PER_BLOCK,
	                                                end_of(of_members, members));
}

bool rb_energy_bounds(const struct rb_solver *solver, const struct rb_island *island,
                      const struct rb_row_system *dense, bool held, struct rb_team *team,
                      struct rb_arena *arena)
{
	struct sums sums = {.solver = solver, .island = island, .dense = dense};
	struct bound all = {0};

	if (team) {
		sums.row_blocks = blocks_of(dense->row_count);
		const int blocks = sums.row_blocks + blocks_of(island->member_count);
		sums.bound = rb_arena_take(arena, (size_t)blocks, sizeof *sums.bound);
		if (sums.bound)
			rb_team_run(team, blocks, bound_block, &sums);
		for (int b = 0; sums.bound && b < blocks; b++) {
			all.momentum += sums.bound[b].momentum;
			all.max = fmax(all.max, sums.bound[b].max);
		}
	}
	if (!sums.bound) {
		all = bound_of_rows(&sums, 0, dense->row_count);
		all.momentum += bound_of_members(&sums, 0, island->member_count).momentum;
	}
	return all.max <= (held ? impulse_max_held : impulse_max) * all.momentum;
}

bool rb_energy_has_impulse(const struct rb_row_system *dense)
{
	for (int k = 0; k < dense->row_count; k++)
		if (rb_constraint_side(&dense->row[k]) * dense->row[k].impulse.n > 0)
			return true;
	return false;
}

/* Whether the row's target is to separate an overlap, or to draw back a limit or rope. */
static inline bool separates(const struct rb_constraint *row)
{
	return rb_constraint_side(row) * row->target.n > 0;
}

bool rb_energy_has_separation(const struct rb_row_system *dense)
{
	for (int k = 0; k < dense->row_count; k++)
		if (separates(&dense->row[k]) && dense->row[k].impulse.n != 0)
			return true;
	return false;
}

void rb_energy_clear_separation(const struct rb_row_system *dense)
{
	for (int k = 0; k < dense->row_count; k++)
		if (separates(&dense->row[k]))
			dense->row[k].target.n = 0;
}

bool rb_energy_save(const struct rb_solver *solver, const struct rb_island *island,
                    struct rb_arena *arena, struct rb_saved_solution *kept)
{
	const struct rb_row_system dense = rb_islands_rows(solver, island);

	kept->row = rb_arena_take(arena, (size_t)dense.row_count, sizeof *kept->row);
	kept->body = rb_arena_take(arena, (size_t)island->member_count, sizeof *kept->body);
	if (!kept->row || !kept->body)
		return false;
	for (int k = 0; k < dense.row_count; k++)
		kept->row[k] = (struct rb_saved_row){dense.row[k].target.n, dense.row[k].impulse};
	kept->driven_work = driven_work(solver, island);
	for (int k = 0; k < island->member_count; k++)
		kept->body[k] = dense.bodies.body[solver->member[island->first_member + k]];
	return true;
}

/* Interpolates from one motion to another. */
static void interpolate(struct rb_solver_body *body, double share, const struct rb_solver_body *to)
{
	body->linear = rb_vec3_add_scaled(body->linear, share,
	                                  rb_vec3_sub(to->linear, body->linear));
	body->angular = rb_vec3_add_scaled(body->angular, share,
	                                   rb_vec3_sub(to->angular, body->angular));
}

void rb_energy_interpolate(const struct rb_solver *solver, const struct rb_island *island,
                           const struct rb_saved_solution *kept, double share)
{
	const struct rb_row_system dense = rb_islands_rows(solver, island);

	RB_ASSERT(share >= 0 && share <= 1);
	for (int k = 0; k < dense.row_count; k++) {
		struct rb_constraint *row = &dense.row[k];
		const struct rb_saved_row *before = &kept->row[k];

		row->target.n = before->target_n;
		row->impulse.n += share * (before->impulse.n - row->impulse.n);
		row->impulse.t = rb_vec3_add_scaled(row->impulse.t, share,
		                                    rb_vec3_sub(before->impulse.t, row->impulse.t));
	}
	for (int k = 0; k < island->member_count; k++)
		interpolate(&dense.bodies.body[solver->member[island->first_member + k]], share,
		            &kept->body[k]);
}

static double off_target(const struct rb_constraint *row, rb_vec3 now)
{
	const rb_vec3 off = rb_vec3_sub(now, rb_constraint_joined(row, row->target));

	return row->set == RB_CONSTRAINT_FREE ? rb_vec3_length(off)
	                                      : fabs(rb_vec3_dot(off, row->normal));
}

void rb_energy_scale_impulses(const struct rb_solver *solver, struct rb_island *island,
                              double share)
{
	const struct rb_row_system dense = rb_islands_rows(solver, island);

	RB_ASSERT(share >= 0 && share <= 1);
	for (int k = 0; k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];

		interpolate(&dense.bodies.body[i], 1 - share, &solver->free[i]);
	}
	for (int k = 0; k < dense.row_count; k++) {
		struct rb_constraint *row = &dense.row[k];
		const rb_vec3 now = rb_constraint_velocity(&dense.bodies, row);
		const int side = rb_constraint_side(row);

		row->impulse.n *= share;
		row->impulse.t = rb_vec3_scale(share, row->impulse.t);
		if (side != 0)
			island->residual = fmax(island->residual,
			                        fmin(side * row->target.n, 0) -
			                                side * rb_vec3_dot(now, row->normal));
		else if (is_bilateral(row))
			island->residual = fmax(island->residual, off_target(row, now));
	}
}

/* ---- rebound ---- */

struct rb_solver_body rb_energy_rebound_change(const struct rb_solver *solver,
                                               const struct rb_world *world, int i)
{
	const struct rb_solver_body *body = &solver->dense.bodies.body[i],
				    *before = &solver->free[i];
	struct rb_solver_body change = {.linear = rb_vec3_sub(body->linear, before->linear),
	                                .angular = rb_vec3_sub(body->angular, before->angular)};

	if (isnan(body->inverse_inertia))
		change.angular = rb_world_turn(world, &world->state, i,
		                               rb_energy_momentum_of(solver, i, &change).angular);
	return change;
}

double rb_energy_rebound(const struct rb_solver *solver, const struct rb_world *world,
                         struct rb_island *island)
{
	const struct rb_row_system rows = rb_islands_rows(solver, island);
	struct rb_energy energy = {.lost = island->energy_budget,
	                           .mixed = -rb_row_system_work(&rows)};

	for (int k = 0; k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];
		const struct rb_solver_body change = {
			.linear = rb_vec3_sub(solver->dense.bodies.body[i].linear,
		                              solver->free[i].linear),
			.angular = rb_vec3_sub(solver->dense.bodies.body[i].angular,
		                               solver->free[i].angular)};
		const struct rb_solver_body momentum = rb_energy_momentum_of(solver, i, &change);
		const struct rb_solver_body now = rb_energy_rebound_change(solver, world, i);
		const struct rb_solver_body state = {
			.linear = rb_world_row3(world->state.velocity, i),
			.angular = world->state.spin ? rb_world_row3(world->state.spin, i)
		                                     : (rb_vec3){0, 0, 0}};

		energy.mixed += rb_energy_product(&momentum, &state);
		energy.square += rb_energy_product(&momentum, &now);
	}
	const double share = rb_energy_share(&energy);
	RB_ASSERT(share >= 0 && share <= 1);
	island->energy_budget = fmax(0, island->energy_budget -
	                                        share * (2 * energy.mixed + share * energy.square));
	return share;
}
