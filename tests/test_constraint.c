/* SPDX-License-Identifier: MIT */
/* constraint/row, effective_mass; sweeps, factors and constraint/cone on rows of every set: small systems with known answers. */
#include "support.h"

#include "base/memory.h"
#include "constraint/coulomb.h"
#include "constraint/effective_mass.h"
#include "stepped/direct.h"
#include "stepped/gauss_seidel.h"

enum { BODIES_MAX = 48, ROWS_MAX = 160 };

/* The last body is static. Bodies have tensors, or moments of one size. */
struct machine {
	struct rb_row_system rows;
	struct rb_solver_body body[BODIES_MAX + 1], free[BODIES_MAX + 1];
	rb_mat3 tensor[BODIES_MAX + 1];
	rb_vec3 place[BODIES_MAX + 1];
	struct rb_constraint row[ROWS_MAX];
	int member[BODIES_MAX], local[BODIES_MAX + 1];
	int count;
	bool short_of_memory; /* while solve_cones goes on */
	long products;        /* out of solve_cones */
	struct rb_arena arena;
};

static const double mass = 2, moment = 0.4;

static void open_machine(struct machine *m, int count)
{
	assert_true(count <= BODIES_MAX);
	*m = (struct machine){.count = count};
	m->rows = (struct rb_row_system){.bodies = {.body = m->body, .tensor = m->tensor},
	                                 .row = m->row};
	for (int i = 0; i < count; i++) {
		m->body[i] = (struct rb_solver_body){.inverse_mass = 1 / mass,
		                                     .inverse_inertia = 1 / moment};
		m->member[i] = i;
	}
}

static void as_tensor(struct machine *m, int i)
{
	m->body[i].inverse_inertia = (double)NAN;
	m->tensor[i] = (rb_mat3){{{2, 0.3, 0}, {0.3, 3, -0.2}, {0, -0.2, 2.5}}};
}

static struct rb_constraint *add(struct machine *m, int a, int b, rb_vec3 at,
                                 struct rb_constraint row)
{
	struct rb_constraint *const to = &m->row[m->rows.row_count++];

	assert_true(m->rows.row_count <= ROWS_MAX);
	*to = row;
	to->a = a;
	to->b = b;
	if (!row.couple) {
		to->arm_a = rb_vec3_sub(at, m->place[a]);
		to->arm_b = rb_vec3_sub(at, m->place[b]);
	}
	if (rb_vec3_max_abs(to->normal) == 0)
		to->normal = (rb_vec3){0, 0, 1};
	return to;
}

static void add_ball_joint(struct machine *m, int a, int b, rb_vec3 at)
{
	add(m, a, b, at, (struct rb_constraint){.set = RB_CONSTRAINT_FREE});
}

/* About an axis; the lever is half a metre. */
static struct rb_constraint *add_couple(struct machine *m, int a, int b, rb_vec3 axis, double low,
                                        double high)
{
	return add(m, a, b, axis,
	           (struct rb_constraint){.set = RB_CONSTRAINT_INTERVAL,
	                                  .couple = true,
	                                  .normal = axis,
	                                  .arm_a = {0.5, 0, 0},
	                                  .low = low,
	                                  .high = high});
}

enum way { SWEEPS, FACTORS, CONES, WAYS };

/* H with H^T H = the tensor of every body that has one, by Cholesky: H is the transposed factor. */
static void fill_roots(const struct machine *m, rb_mat3 *root)
{
	for (int i = 0; i < m->count; i++) {
		root[i] = (rb_mat3){{{0}}};
		for (int c = 0; c < 3 && isnan(m->body[i].inverse_inertia); c++)
			for (int r = c; r < 3; r++) {
				double sum = m->tensor[i].m[r][c];

				for (int k = 0; k < c; k++)
					sum -= root[i].m[k][r] * root[i].m[k][c];
				root[i].m[c][r] = r == c ? sqrt(sum) : sum / root[i].m[c][c];
			}
	}
}

/* The rows in an order of their own: `step` is prime to their number. */
static double solve_cones(struct machine *m, int step)
{
	static struct rb_cone_row row[ROWS_MAX];
	static rb_mat3 root[BODIES_MAX + 1];
	const int count = m->rows.row_count;
	struct rb_cone cone = {.bodies = {.body = m->body, .root = root},
	                       .body_count = m->count + 1,
	                       .row = row,
	                       .row_count = count,
	                       .arena = &m->arena};

	fill_roots(m, root);
	for (int k = 0; k < count; k++)
		row[k] = (struct rb_cone_row){.base = m->row[k * step % count]};
	assert_true(rb_cone_open(&cone));
	rb_memory_fail_at(m->short_of_memory);
	const double left = rb_cone_resolve(&cone, 10);
	rb_memory_fail_at(0);
	for (int k = 0; k < count; k++)
		m->row[k * step % count].impulse = row[k].base.impulse;
	m->products = cone.iterations;
	return left;
}

/* From velocities as they are; returns what is left, m/s. */
static double solve(struct machine *m, enum way way, double tolerance)
{
	double left;

	for (int k = 0; k < m->rows.row_count; k++)
		rb_effective_mass_fill(&m->rows.bodies, &m->row[k]);
	memcpy(m->free, m->body, sizeof m->free);
	assert_true(rb_row_system_is_sound(&m->rows, m->count + 1));
	rb_sweep_warm(&m->rows);
	if (way == SWEEPS) {
		struct rb_sweep sweep = {.dense = &m->rows, .tolerance = tolerance, .max = 20000};

		assert_true(rb_sweep_take(&sweep, &m->arena));
		left = rb_sweep_solve(&sweep).residual;
	} else if (way == CONES) {
		left = solve_cones(m, 1);
	} else {
		for (int i = 0; i <= m->count; i++)
			m->local[i] = -1;
		const struct rb_direct direct = {.dense = &m->rows,
		                                 .free = m->free,
		                                 .member = m->member,
		                                 .member_count = m->count,
		                                 .local = m->local,
		                                 .tolerance = tolerance,
		                                 .slip_tolerance = tolerance,
		                                 .steps_max = 1000,
		                                 .max = 1e9,
		                                 .arena = &m->arena};
		const struct rb_direct_result result = rb_direct_solve(&direct);

		assert_true(result.tried);
		left = result.residual;
	}
	assert_true(rb_row_system_is_sound(&m->rows, m->count + 1));
	rb_arena_release(&m->arena);
	return left;
}

static rb_vec3 off(const struct machine *m, int k)
{
	return rb_vec3_sub(rb_constraint_velocity(&m->rows.bodies, &m->row[k]),
	                   rb_constraint_joined(&m->row[k], m->row[k].target));
}

static void assert_vec_near(rb_vec3 v, rb_vec3 w, double tolerance)
{
	assert_near(v.x, w.x, tolerance);
	assert_near(v.y, w.y, tolerance);
	assert_near(v.z, w.z, tolerance);
}

/* Momentum, and angular momentum about the origin: by inverses, as solvers have them. */
static void momenta(const struct machine *m, rb_vec3 *linear, rb_vec3 *angular)
{
	*linear = *angular = (rb_vec3){0, 0, 0};
	for (int i = 0; i < m->count; i++) {
		const rb_vec3 p = rb_vec3_scale(1 / m->body[i].inverse_mass, m->body[i].linear);
		rb_mat3 inertia = rb_mat3_diagonal(moment, moment, moment);

		if (isnan(m->body[i].inverse_inertia))
			assert_true(rb_mat3_inverse(&m->tensor[i], &inertia));
		*linear = rb_vec3_add(*linear, p);
		*angular = rb_vec3_add(*angular,
		                       rb_vec3_add(rb_mat3_apply(&inertia, m->body[i].angular),
		                                   rb_vec3_cross(m->place[i], p)));
	}
}

/* Two rods in line, hinged at the origin, one struck at its far end: impulses by K of the joint, by hand in the plane. */
static void a_ball_joint_carries_a_blow_on_as_its_effective_mass_says(void **state)
{
	(void)state;
	for (enum way way = SWEEPS; way < WAYS; way++) {
		static struct machine m;
		rb_vec3 linear[2], angular[2];
		const double half = 0.5, blow = 3;

		open_machine(&m, 2);
		m.place[0] = (rb_vec3){-half, 0, 0};
		m.place[1] = (rb_vec3){half, 0, 0};
		add_ball_joint(&m, 0, 1, (rb_vec3){0, 0, 0});
		m.body[1].linear.y = blow / mass;
		m.body[1].angular.z = half * blow / moment;
		momenta(&m, &linear[0], &angular[0]);
		assert_true(solve(&m, way, 1e-13) <= 1e-12);
		/* u_y = blow (1/m - l^2/I) at the joint; it gives way by 2 (1/m + l^2/I) */
		const double u = blow * (1 / mass - half * half / moment);
		const double k = 2 * (1 / mass + half * half / moment);
		assert_near(rb_constraint_impulse(&m.row[0]).y, -u / k, 1e-12);
		assert_near(m.body[0].linear.y, u / k / mass, 1e-12);
		assert_near(m.body[0].angular.z, half * u / k / moment, 1e-12);
		assert_vec_near(off(&m, 0), (rb_vec3){0, 0, 0}, 1e-12);
		momenta(&m, &linear[1], &angular[1]);
		assert_vec_near(linear[1], linear[0], 1e-13);
		assert_vec_near(angular[1], angular[0], 1e-13);
	}
}

/* One constraint alone is p = K^-1 (w - u), whatever the bodies. */
static void a_ball_joint_of_any_bodies_comes_to_its_target_at_once(void **state)
{
	(void)state;
	for (enum way way = SWEEPS; way < WAYS; way++) {
		static struct machine m;
		rb_vec3 linear[2], angular[2];
		rb_mat3 inverse;

		open_machine(&m, 2);
		as_tensor(&m, 0);
		m.place[1] = (rb_vec3){1, 0.5, 0.2};
		add_ball_joint(&m, 0, 1, (rb_vec3){0.4, 0.3, -0.6});
		m.row[0].target = (rb_along_across){0.3, {0.1, -0.2, 0}};
		m.body[0].linear = (rb_vec3){1, 2, 3};
		m.body[0].angular = (rb_vec3){-1, 0.5, 2};
		m.body[1].angular = (rb_vec3){3, -1, 1};
		momenta(&m, &linear[0], &angular[0]);
		const rb_mat3 k = rb_effective_mass_of(&m.rows.bodies, &m.row[0],
		                                       rb_effective_mass_world);
		assert_true(rb_mat3_inverse(&k, &inverse));
		const rb_vec3 wanted = rb_mat3_apply(&inverse, rb_vec3_neg(off(&m, 0)));
		assert_true(solve(&m, way, 1e-12) <= 1e-11);
		assert_vec_near(rb_constraint_impulse(&m.row[0]), wanted, 1e-11);
		assert_vec_near(off(&m, 0), (rb_vec3){0, 0, 0}, 1e-11);
		momenta(&m, &linear[1], &angular[1]);
		assert_vec_near(linear[1], linear[0], 1e-12);
		assert_vec_near(angular[1], angular[0], 1e-12);
	}
}

/* In closed form as by their tensors, which say the same. */
static void bodies_of_one_moment_give_way_as_their_tensors_say(void **state)
{
	(void)state;
	for (int k = 0; k < 64; k++) {
		static struct machine m;
		struct rb_constraint *const row = &m.row[0];
		const double angle = 0.37 * k;
		const rb_vec3 n = rb_vec3_unit((rb_vec3){cos(angle), sin(2 * angle), 0.3},
		                               (rb_vec3){0, 0, 0});

		open_machine(&m, 2);
		m.place[1] = (rb_vec3){1, 0.5, 0.2};
		add_ball_joint(&m, 0, 1, (rb_vec3){0.4, sin(angle), cos(3 * angle)});
		m.body[1].inverse_inertia = k % 3; /* 0: does not turn */
		row->normal = n;
		rb_effective_mass_fill(&m.rows.bodies, row);
		const rb_mat3 all = rb_effective_mass_of(&m.rows.bodies, row,
		                                         rb_effective_mass_world);
		const double along = rb_vec3_dot(n, rb_mat3_apply(&all, n));
		const double across = rb_effective_mass_tangent(&all, n);

		assert_near(row->inverse_mass_n, along, 1e-13 * along);
		assert_near(row->inverse_mass_t, across, 1e-13 * across);
	}
}

/* A motor on a static axle: the spin asked for, or what its greatest impulse makes. */
static void a_motor_reaches_its_speed_or_its_bound(void **state)
{
	const double lever = 0.5, bound = 0.1;

	(void)state;
	for (enum way way = SWEEPS; way < WAYS; way++)
		for (int strong = 0; strong <= 1; strong++) {
			static struct machine m;
			const double speed = 10, high = strong ? 100 : bound;
			const rb_vec3 axis = {0, 0, 1};

			open_machine(&m, 1);
			struct rb_constraint *const motor = add_couple(&m, 0, 1, axis, -high, high);

			m.body[0].angular = (rb_vec3){0.5, 0, 1};
			motor->target.n = -lever * speed; /* of the static b, seen from a */
			assert_true(solve(&m, way, 1e-12) <= 1e-11);
			const double reached = strong ? speed : 1 + lever * bound / moment;
			assert_near(m.body[0].angular.z, reached, 1e-10);
			assert_near(m.body[0].angular.x, 0.5, 0);
			assert_near(m.row[0].impulse.n, -(reached - 1) * moment / lever, 1e-10);
		}
}

/* The friction of a joint holds what is slower than its bound can stop, and slows what is faster. */
static void friction_of_a_joint_stops_or_slows(void **state)
{
	const double lever = 0.5, bound = 0.2, slow = 0.1, fast = 3;

	(void)state;
	for (enum way way = SWEEPS; way < WAYS; way++)
		for (int k = 0; k <= 1; k++) {
			static struct machine m;
			const double spin = k ? fast : slow,
				     left = k ? fast - 2 * lever * bound / moment : 0;

			open_machine(&m, 2);
			add_couple(&m, 0, 1, (rb_vec3){1, 0, 0}, -bound, bound);
			m.body[1].angular.x = spin;
			assert_true(solve(&m, way, 1e-12) <= 1e-11);
			assert_near(m.body[1].angular.x - m.body[0].angular.x, left, 1e-10);
			assert_near(m.body[1].angular.x + m.body[0].angular.x, spin, 1e-12);
		}
}

/* A rope pulls but never pushes. */
static void a_limit_acts_on_one_side_only(void **state)
{
	(void)state;
	for (enum way way = SWEEPS; way < WAYS; way++)
		for (int apart = 0; apart <= 1; apart++) {
			static struct machine m;
			const double speed = apart ? 1 : -1;

			open_machine(&m, 2);
			m.place[1] = (rb_vec3){0, 0, 2};
			add(&m, 0, 1, (rb_vec3){0, 0, 1},
			    (struct rb_constraint){.set = RB_CONSTRAINT_INTERVAL,
			                           .high = (double)INFINITY});
			m.body[1].linear.z = speed;
			assert_true(solve(&m, way, 1e-13) <= 1e-12);
			assert_near(m.row[0].impulse.n, apart ? 0 : 0.5 * mass, 1e-12);
			assert_near(m.body[1].linear.z - m.body[0].linear.z, apart ? 1 : 0, 1e-12);
		}
}

/* Links of a chain that hangs from a static body: each carries the weight of what is below it. */
static void a_chain_of_ball_joints_hangs(void **state)
{
	(void)state;
	for (enum way way = SWEEPS; way < WAYS; way++) {
		static struct machine m;
		const int links = way == SWEEPS ? 6 : 24;
		const double kick = 9.81 / 240;

		open_machine(&m, links);
		for (int i = 0; i < links; i++) {
			m.place[i] = (rb_vec3){0, 0, -0.5 - i};
			m.body[i].linear.z = -kick;
			if (i > 0)
				add_ball_joint(&m, i - 1, i, (rb_vec3){0, 0, -i});
		}
		add_ball_joint(&m, 0, links, (rb_vec3){0, 0, 0});
		assert_true(solve(&m, way, 1e-11) <= 1e-10);
		for (int i = 0; i + 1 < links; i++)
			assert_vec_near(rb_constraint_impulse(&m.row[i]),
			                (rb_vec3){0, 0, (links - 1 - i) * mass * kick}, 1e-7);
		for (int i = 0; i < links; i++)
			assert_vec_near(m.body[i].linear, (rb_vec3){0, 0, 0}, 1e-8);
		assert_vec_near(rb_constraint_impulse(&m.row[links - 1]),
		                (rb_vec3){0, 0, -links * mass * kick}, 1e-7);
	}
}

/* A hinge is a ball joint and two couples without bounds: what is left is the turn about its axis. */
static void a_hinge_leaves_the_turn_about_its_axis(void **state)
{
	(void)state;
	for (enum way way = SWEEPS; way < WAYS; way++) {
		static struct machine m;
		rb_vec3 linear[2], angular[2];

		open_machine(&m, 2);
		as_tensor(&m, 1);
		m.place[1] = (rb_vec3){1, 0, 0};
		add_ball_joint(&m, 0, 1, (rb_vec3){0.5, 0.1, 0});
		add_couple(&m, 0, 1, (rb_vec3){1, 0, 0}, -(double)INFINITY, (double)INFINITY);
		add_couple(&m, 0, 1, (rb_vec3){0, 1, 0}, -(double)INFINITY, (double)INFINITY);
		m.body[0].angular = (rb_vec3){1, 2, 3};
		m.body[1].linear = (rb_vec3){0, 1, -1};
		momenta(&m, &linear[0], &angular[0]);
		assert_true(solve(&m, way, 1e-12) <= 1e-10);
		const rb_vec3 w = rb_vec3_sub(m.body[1].angular, m.body[0].angular);
		assert_near(w.x, 0, 1e-9);
		assert_near(w.y, 0, 1e-9);
		assert_true(fabs(w.z) > 0.1);
		assert_vec_near(off(&m, 0), (rb_vec3){0, 0, 0}, 1e-9);
		momenta(&m, &linear[1], &angular[1]);
		assert_vec_near(linear[1], linear[0], 1e-11);
		assert_vec_near(angular[1], angular[0], 1e-11);
	}
}

/* A jointed pair on a floor with friction: sweeps and factors end with the same velocities. */
static void joints_and_contacts_are_solved_together(void **state)
{
	static struct machine m[WAYS];

	(void)state;
	for (enum way way = SWEEPS; way < WAYS; way++) {
		open_machine(&m[way], 2);
		as_tensor(&m[way], 1);
		m[way].place[0] = (rb_vec3){0, 0, 0.5};
		m[way].place[1] = (rb_vec3){1, 0, 0.5};
		add_ball_joint(&m[way], 0, 1, (rb_vec3){0.5, 0, 0.5});
		for (int i = 0; i < 2; i++)
			add(&m[way], i, 2, (rb_vec3){i, 0, 0},
			    (struct rb_constraint){.normal = {0, 0, -1}, .friction = 0.3});
		m[way].body[0].linear = (rb_vec3){0.1, 0, -1};
		m[way].body[1].linear = (rb_vec3){0, 2, 0.2};
		/* factors end before the last digits of a slip's shift */
		assert_true(solve(&m[way], way, 1e-12) <= 1e-6);
		assert_vec_near(off(&m[way], 0), (rb_vec3){0, 0, 0}, 1e-9);
		assert_true(m[way].row[1].impulse.n > 0);
	}
	for (int i = 0; i < 2; i++) {
		assert_vec_near(m[0].body[i].linear, m[1].body[i].linear, 1e-6);
		assert_vec_near(m[0].body[i].angular, m[1].body[i].angular, 1e-6);
	}
}

/*
 * A body of four corners lands on them, skidding and turning, while they are to part at up to a million times its speed: by
 * friction of up to 1e10. Factors that say that they have ended have left no contact closing without a push, and no friction
 * outside its cone.
 */
static void huge_friction_is_within_its_cone_and_holds_no_contact_open(void **state)
{
	static struct machine m;
	int ended = 0;

	(void)state;
	srand(7);
	for (int k = 0; k < 200; k++) {
		double noise[8], scale = 1;

		for (int i = 0; i < 8; i++)
			noise[i] = 2.0 * rand() / RAND_MAX - 1;
		open_machine(&m, 1);
		as_tensor(&m, 0);
		m.place[0] = (rb_vec3){0, 0, 0.4};
		m.body[0].linear = (rb_vec3){noise[0], noise[1], -0.2};
		m.body[0].angular = (rb_vec3){noise[2], noise[3], noise[4]};
		for (int i = 0; i < 4; i++) {
			const double parts = k % 4 == 0 ? 0
			                                : pow(10, k % 7) * (1 + noise[5] * i / 4);

			add(&m, 0, 1, (rb_vec3){i % 2 - 0.5, i / 2 - 0.5, 0.1 * noise[6]},
			    (struct rb_constraint){.normal = {0, 0, -1},
			                           .friction = pow(10, 5 + 5 * noise[7]),
			                           .target.n = parts});
			scale = fmax(scale, parts);
		}
		const double tolerance = 1e-6 * scale;
		if (!(solve(&m, FACTORS, tolerance) <= tolerance))
			continue;
		ended++;
		for (int i = 0; i < 4; i++) {
			const struct rb_constraint *const row = &m.row[i];

			if (row->impulse.n == 0)
				assert_true(rb_vec3_dot(off(&m, i), row->normal) >= -4 * tolerance);
			assert_true(rb_vec3_length(row->impulse.t) <=
			            row->friction * row->impulse.n * (1 + 1e-12));
		}
	}
	assert_true(ended >= 10);
}

/* Work of a row is its impulse times the mean of its velocity before and after: what kinetic energy changes by. */
static void a_joint_takes_energy_and_gives_none(void **state)
{
	static struct machine m;
	double energy[2];

	(void)state;
	open_machine(&m, 2);
	m.place[1] = (rb_vec3){0, 1, 0};
	add_ball_joint(&m, 0, 1, (rb_vec3){0.2, 0.5, 0});
	m.body[0].linear = (rb_vec3){1, 0, 2};
	m.body[1].angular = (rb_vec3){0, 0, 4};
	for (int e = 0; e < 2; e++) {
		const rb_vec3 before = off(&m, 0);

		energy[e] = 0;
		for (int i = 0; i < 2; i++)
			energy[e] += 0.5 * mass * rb_vec3_dot(m.body[i].linear, m.body[i].linear) +
			             0.5 * moment *
			                     rb_vec3_dot(m.body[i].angular, m.body[i].angular);
		if (e == 0) {
			solve(&m, FACTORS, 1e-13);
			energy[0] += 0.5 * rb_vec3_dot(rb_constraint_impulse(&m.row[0]), before);
		}
	}
	assert_near(energy[1], energy[0], 1e-12);
}

/* Sums are exact and steps simultaneous: to the bit, in any order of rows. */
static void the_cone_problem_does_not_know_which_row_comes_first(void **state)
{
	static struct machine m[3];

	(void)state;
	for (int k = 0; k < 3; k++) {
		open_machine(&m[k], 4);
		as_tensor(&m[k], 2);
		for (int i = 0; i < 4; i++) {
			m[k].place[i] = (rb_vec3){i, 0.1 * i, 0.5};
			m[k].body[i].linear = (rb_vec3){0.3 * i, 1 - i, -1};
			m[k].body[i].angular = (rb_vec3){1, i, 0.5};
		}
		for (int i = 0; i < 3; i++)
			add_ball_joint(&m[k], i, i + 1, (rb_vec3){i + 0.5, 0, 0.4});
		add_couple(&m[k], 1, 2, (rb_vec3){0, 1, 0}, -0.05, 0.05);
		for (int i = 0; i < 3; i++)
			add(&m[k], i, 4, (rb_vec3){i, 0.1 * i, 0},
			    (struct rb_constraint){.normal = {0, 0, -1}, .friction = 0.2});
		for (int r = 0; r < m[k].rows.row_count; r++)
			rb_effective_mass_fill(&m[k].rows.bodies, &m[k].row[r]);
		assert_int_equal(m[k].rows.row_count, 7);
		assert_true(solve_cones(&m[k], 1 + 2 * k) <= 1e-12);
		assert_true(rb_row_system_is_sound(&m[k].rows, 5));
		for (int i = 0; i < 3; i++)
			assert_vec_near(off(&m[k], i), (rb_vec3){0, 0, 0}, 1e-12);
		assert_memory_equal(m[k].body, m[0].body, sizeof m[k].body);
		rb_arena_release(&m[k].arena);
	}
	assert_near(fabs(m[0].row[3].impulse.n), 0.05, 0);
}

/* A ring of hinges in a plane, three of whose rows follow from the others, falls on two of its bodies. */
static void open_ring(struct machine *m, int count)
{
	open_machine(m, count);
	for (int i = 0; i < count; i++) {
		const double angle = 6.283185307179586 * i / count;

		m->place[i] = (rb_vec3){3 * sin(angle), 0, -3 * cos(angle)};
		m->body[i].linear.z = -1;
		if (i % 3 == 0)
			m->body[i].inverse_mass *= 1000;
	}
	for (int i = 0; i < count; i++) {
		const int next = (i + 1) % count;
		const rb_vec3 sum = rb_vec3_add(m->place[i], m->place[next]);

		add_ball_joint(m, i, next, rb_vec3_scale(0.5, sum));
		add_couple(m, i, next, (rb_vec3){1, 0, 0}, -(double)INFINITY, (double)INFINITY);
		add_couple(m, i, next, (rb_vec3){0, 0, 1}, -(double)INFINITY, (double)INFINITY);
	}
	for (int i = 0; i < 2; i++)
		add(m, i, count, rb_vec3_add(m->place[i], (rb_vec3){0, 0, -0.1}),
		    (struct rb_constraint){.normal = {0, 0, -1}});
	for (int r = 0; r < m->rows.row_count; r++)
		rb_effective_mass_fill(&m->rows.bodies, &m->row[r]);
}

/* What joints hold is eliminated: rounds are about as many as other rows, not as links. Without memory it takes longer. */
static void a_closed_linkage_on_contacts_takes_few_products(void **state)
{
	(void)state;
	for (int short_of_memory = 0; short_of_memory <= 1; short_of_memory++) {
		static struct machine m;
		rb_vec3 linear, angular;

		open_ring(&m, BODIES_MAX);
		m.short_of_memory = short_of_memory;
		assert_true(solve_cones(&m, 1) <= 1e-12);
		momenta(&m, &linear, &angular);
		assert_true(linear.z > -BODIES_MAX * mass);
		for (int r = 0; r < m.rows.row_count - 2; r++) {
			const rb_vec3 u = off(&m, r), axis = m.row[r].normal;

			assert_near(m.row[r].couple ? rb_vec3_dot(u, axis) : rb_vec3_length(u), 0,
			            1e-12);
		}
		assert_true(short_of_memory ? m.products > 200 : m.products < 120);
		rb_arena_release(&m.arena);
	}
}

/* Of rows that ask for different things of the same bodies there is no solution, and no end of looking for one. */
static void rows_that_contradict_each_other_are_given_up(void **state)
{
	static struct machine m;

	(void)state;
	open_ring(&m, BODIES_MAX);
	add_ball_joint(&m, 3, 4, rb_vec3_scale(0.5, rb_vec3_add(m.place[3], m.place[4])));
	m.row[m.rows.row_count - 1].target.n = 1e-6;
	rb_effective_mass_fill(&m.rows.bodies, &m.row[m.rows.row_count - 1]);
	const double left = solve_cones(&m, 1);

	assert_true(left > 1e-9 && left < 1e-5);
	assert_true(m.products < 500);
	rb_arena_release(&m.arena);
}

static void an_impulse_outside_its_set_is_not_sound(void **state)
{
	static struct machine m;
	const struct rb_along_across_case {
		enum rb_constraint_set set;
		rb_along_across impulse;
		bool sound;
	} cases[] = {
		{RB_CONSTRAINT_CONE, {1, {0.2, 0, 0}}, true},
		{RB_CONSTRAINT_CONE, {1, {0.4, 0, 0}}, false},
		{RB_CONSTRAINT_CONE, {-1, {0, 0, 0}}, false},
		{RB_CONSTRAINT_FREE, {-5, {7, 0, 0}}, true},
		{RB_CONSTRAINT_FREE, {0, {0, 0, 1}}, false},
		{RB_CONSTRAINT_INTERVAL, {-1, {0, 0, 0}}, true},
		{RB_CONSTRAINT_INTERVAL, {1.1, {0, 0, 0}}, false},
		{RB_CONSTRAINT_INTERVAL, {0, {0.1, 0, 0}}, false},
	};

	(void)state;
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		open_machine(&m, 1);
		add(&m, 0, 1, (rb_vec3){0, 0, 1},
		    (struct rb_constraint){
			    .set = cases[k].set, .friction = 0.3, .low = -1, .high = 1});
		rb_effective_mass_fill(&m.rows.bodies, &m.row[0]);
		m.row[0].impulse = cases[k].impulse;
		assert_int_equal(rb_row_system_is_sound(&m.rows, 2), cases[k].sound);
		m.row[0].impulse = rb_constraint_project(&m.row[0], m.row[0].impulse);
		if (cases[k].set != RB_CONSTRAINT_FREE)
			assert_true(rb_row_system_is_sound(&m.rows, 2));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_ball_joint_carries_a_blow_on_as_its_effective_mass_says),
		cmocka_unit_test(a_ball_joint_of_any_bodies_comes_to_its_target_at_once),
		cmocka_unit_test(bodies_of_one_moment_give_way_as_their_tensors_say),
		cmocka_unit_test(a_motor_reaches_its_speed_or_its_bound),
		cmocka_unit_test(friction_of_a_joint_stops_or_slows),
		cmocka_unit_test(a_limit_acts_on_one_side_only),
		cmocka_unit_test(a_chain_of_ball_joints_hangs),
		cmocka_unit_test(a_hinge_leaves_the_turn_about_its_axis),
		cmocka_unit_test(joints_and_contacts_are_solved_together),
		cmocka_unit_test(huge_friction_is_within_its_cone_and_holds_no_contact_open),
		cmocka_unit_test(a_joint_takes_energy_and_gives_none),
		cmocka_unit_test(the_cone_problem_does_not_know_which_row_comes_first),
		cmocka_unit_test(a_closed_linkage_on_contacts_takes_few_products),
		cmocka_unit_test(rows_that_contradict_each_other_are_given_up),
		cmocka_unit_test(an_impulse_outside_its_set_is_not_sound),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
