/* SPDX-License-Identifier: MIT */
/* src/stepped/redundant_contacts: who bears how much, where that is open. */
#include "solids.h"
#include "support.h"

#include "stepped/redundant_contacts.h"

enum { CORNERS = 4 };

/*
 * A box of 2 kg on what does not yield, at four corners: pushes at random, friction within the
 * cones, at one of them at its edge.
 */
struct sleep {
	struct rb_solver_body body[2];
	struct rb_constraint row[CORNERS];
	struct rb_row_system dense;
};

static void lay(struct sleep *sleep, uint64_t series)
{
	*sleep = (struct sleep){
		.body = {{.inverse_mass = 0}, {.inverse_mass = 0.5, .inverse_inertia = 0.8}}};
	for (int k = 0; k < CORNERS; k++) {
		const uint64_t of = 100 + 4 * (uint64_t)k;
		struct rb_constraint *const row = &sleep->row[k];
		const double normal_impulse = solids_random(series, of, 0.1, 1);
		const double share = k == 0 ? 1 : solids_random(series, of + 1, 0, 1);
		const double way = solids_random(series, of + 2, -3, 3);

		*row = (struct rb_constraint){.a = 0,
		                              .b = 1,
		                              .normal = {0, 0, 1},
		                              .arm_b = {k % 2 ? 1 : -1, k / 2 ? 0.7 : -0.7, -0.5},
		                              .inverse_mass_n = 1,
		                              .inverse_mass_t = 1,
		                              .friction = 0.4,
		                              .impulse.n = normal_impulse};
		row->impulse.t = rb_vec3_scale(share * 0.4 * normal_impulse,
		                               (rb_vec3){cos(way), sin(way), 0});
	}
	sleep->dense = (struct rb_row_system){
		.bodies.body = sleep->body, .row = sleep->row, .row_count = CORNERS};
}

/* What the impulses are to the box: force, and torque about its centre. */
static void load_of(const struct sleep *sleep, rb_vec3 *force, rb_vec3 *torque)
{
	*force = *torque = (rb_vec3){0, 0, 0};
	for (int k = 0; k < CORNERS; k++) {
		const struct rb_constraint *const row = &sleep->row[k];
		const rb_vec3 impulse = rb_constraint_impulse(row);

		*force = rb_vec3_add(*force, impulse);
		*torque = rb_vec3_add(*torque, rb_vec3_cross(row->arm_b, impulse));
	}
}

static void assert_same(rb_vec3 a, rb_vec3 b)
{
	assert_near(a.x, b.x, 1e-14);
	assert_near(a.y, b.y, 1e-14);
	assert_near(a.z, b.z, 1e-14);
}

static double closing(const struct sleep *sleep, int k)
{
	return rb_constraint_velocity(&sleep->dense.bodies, &sleep->row[k]).z;
}

/* Of the loads that are open the corners have 1 -1 -1 1. */
static double open_part(const struct rb_constraint *row)
{
	return row[0].impulse.n - row[1].impulse.n - row[2].impulse.n + row[3].impulse.n;
}

/*
 * The gaps close as before with the smallest squares. Nothing leaves its cone; where that has cut
 * friction, gaps are for the next time.
 */
static void pushes_become_even_and_do_the_same(void **state)
{
	struct rb_arena arena = {0};
	int cut = 0, whole = 0;

	(void)state;
	for (uint64_t series = 0; series < 100; series++) {
		rb_vec3 force[2], torque[2];
		struct sleep sleep, before;
		bool is_cut = false;
		double least = 1;

		lay(&sleep, series);
		before = sleep;
		assert_true(rb_redundant_contacts(&sleep.dense, 1e-9, 0, 1e9, &arena));
		for (int k = 0; k < CORNERS; k++) {
			const struct rb_constraint *const row = &sleep.row[k];
			const double friction_impulse = rb_vec3_length(row->impulse.t);
			const rb_vec3 off = rb_vec3_cross(row->impulse.t, before.row[k].impulse.t);

			least = fmin(least, row->impulse.n);
			assert_true(friction_impulse <= row->friction * row->impulse.n + 1e-15);
			assert_near(rb_vec3_length(off), 0, 1e-15);
			is_cut = is_cut ||
			         (k > 0 &&
			          friction_impulse < rb_vec3_length(before.row[k].impulse.t));
		}
		cut += is_cut;
		whole += !is_cut && least > 0;
		assert_true(least >= 0);
		if (least > 0)
			assert_near(open_part(sleep.row), 0, 1e-14);
		for (int k = 0; k < CORNERS && !is_cut && least > 0; k++)
			assert_near(closing(&sleep, k), 0, 1e-14);
		assert_near(rb_vec3_length(sleep.row[0].impulse.t), 0.4 * sleep.row[0].impulse.n,
		            1e-15);
		/* the bodies have what the impulses have changed by */
		load_of(&before, &force[0], &torque[0]);
		load_of(&sleep, &force[1], &torque[1]);
		assert_same(sleep.body[1].linear,
		            rb_vec3_scale(0.5, rb_vec3_sub(force[1], force[0])));
		assert_same(sleep.body[1].angular,
		            rb_vec3_scale(0.8, rb_vec3_sub(torque[1], torque[0])));
		rb_arena_reset(&arena);
	}
	assert_true(cut > 10 && whole > 10);
	rb_arena_release(&arena);
}

/* All corners slide along x; loads differ from a series' own by what is open, as far as that goes. */
static void lay_sliding(struct sleep *sleep, uint64_t series, bool other_way)
{
	const double open[CORNERS] = {1, -1, -1, 1};
	double more = (double)INFINITY;

	lay(sleep, series);
	sleep->dense.bodies.body = sleep->body;
	sleep->dense.row = sleep->row;
	sleep->body[1].linear.x = 1;
	for (int k = 0; k < CORNERS; k++) {
		const double n = sleep->row[k].impulse.n;

		more = (open[k] < 0) != other_way ? fmin(more, n) : more;
	}
	for (int k = 0; k < CORNERS; k++) {
		struct rb_constraint *const row = &sleep->row[k];

		row->impulse.n = fmax(0, row->impulse.n + (other_way ? -more : more) * open[k]);
		row->impulse.t = (rb_vec3){-row->friction * row->impulse.n, 0, 0};
	}
}

/* With targets that no motion of the box meets, by so much at each corner. */
static struct sleep *contradict(struct sleep *sleep, const struct sleep *of, double by)
{
	*sleep = *of;
	sleep->dense.bodies.body = sleep->body;
	sleep->dense.row = sleep->row;
	for (int k = 0; k < CORNERS; k++)
		sleep->row[k].target.n = k == 0 || k == 3 ? by : -by;
	return sleep;
}

/*
 * One corner or another has borne nothing: the same comes of it, since all do the same to the box.
 * So it does where the targets of corners contradict each other within the slack: they become what
 * is next to them. Beyond it they stay.
 */
static void who_had_borne_nothing_makes_no_difference(void **state)
{
	const double slack = 1e-4;
	struct rb_arena arena = {0};
	int all_bear = 0;

	(void)state;
	for (uint64_t series = 0; series < 40; series++) {
		struct sleep one, other, near, far;
		double least = 1;

		lay_sliding(&one, series, false);
		lay_sliding(&other, series, true);
		(void)contradict(&near, &other, (1 - 1e-9) * slack);
		(void)contradict(&far, &other, 2 * slack);
		/* one of both may have been it */
		(void)rb_redundant_contacts(&one.dense, 1e-9, slack, 1e9, &arena);
		(void)rb_redundant_contacts(&other.dense, 1e-9, slack, 1e9, &arena);
		(void)rb_redundant_contacts(&near.dense, 1e-9, slack, 1e9, &arena);
		(void)rb_redundant_contacts(&far.dense, 1e-9, slack, 1e9, &arena);
		for (int k = 0; k < CORNERS; k++) {
			assert_near(one.row[k].impulse.n, other.row[k].impulse.n, 1e-13);
			assert_near(one.row[k].impulse.t.x, -0.4 * one.row[k].impulse.n, 1e-14);
			assert_near(closing(&one, k), 0, 1e-13);
			least = fmin(least, one.row[k].impulse.n);
		}
		all_bear += least > 0;
		for (int k = 0; k < CORNERS && least > 0; k++) {
			assert_near(near.row[k].impulse.n, one.row[k].impulse.n, 1e-13);
			assert_near(near.row[k].target.n, 0, 1e-13);
			assert_near(fabs(far.row[k].target.n), 2 * slack, 1e-18);
		}
		if (least > 0)
			assert_near(open_part(one.row), 0, 1e-13);
		rb_arena_reset(&arena);
	}
	assert_true(all_bear > 10);
	rb_arena_release(&arena);
}

enum { PAIRS = 3 };

/*
 * Boxes on top of each other, and in a ring: the pairs between share bodies, but what is open of
 * each, 1 -1 -1 1, is its own. Three corners leave nothing open, and stay as they are.
 */
static void pairs_of_a_tower_and_of_a_ring_become_even(void **state)
{
	const int ends[2][PAIRS][2] = {{{0, 1}, {1, 2}, {2, 3}}, {{1, 2}, {1, 3}, {2, 3}}};
	struct rb_arena arena = {0};
	int whole = 0;

	(void)state;
	for (uint64_t series = 0; series < 60; series++) {
		struct rb_solver_body body[4] = {{.inverse_mass = 0}};
		struct rb_constraint row[PAIRS * CORNERS], before[PAIRS * CORNERS];
		struct sleep sleep;
		/* one pair of the tower has three corners */
		const int less = series % 2 ? PAIRS : (int)(series / 2 % PAIRS);
		int count = 0, first[PAIRS + 1];

		for (int i = 1; i < 4; i++)
			body[i] = (struct rb_solver_body){.inverse_mass = 0.5,
			                                  .inverse_inertia = 0.8};
		for (int p = 0; p < PAIRS; p++) {
			first[p] = count;
			lay(&sleep, 7 + PAIRS * series + (uint64_t)p);
			for (int k = 0; k < CORNERS - (p == less); k++, count++) {
				row[count] = sleep.row[k];
				row[count].a = ends[series % 2][p][0];
				row[count].b = ends[series % 2][p][1];
				row[count].arm_a = rb_vec3_add(row[count].arm_b,
				                               (rb_vec3){0.1, 0.2, 1});
			}
		}
		first[PAIRS] = count;
		memcpy(before, row, sizeof row);
		const struct rb_row_system dense = {
			.bodies.body = body, .row = row, .row_count = count};

		assert_true(rb_redundant_contacts(&dense, 1e-9, 1e-9, 1e9, &arena));
		double least = 1;
		for (int k = 0; k < count; k++)
			least = fmin(least, row[k].impulse.n);
		assert_true(least >= 0);
		for (int p = 0; p < PAIRS && least > 0; p++) {
			const struct rb_constraint *const r = &row[first[p]],
							  *const b = &before[first[p]];

			whole++;
			if (p == less)
				for (int k = 0; k < CORNERS - 1; k++)
					assert_near(r[k].impulse.n, b[k].impulse.n, 1e-14);
			else
				assert_near(open_part(r), 0, 1e-14);
		}
		rb_arena_reset(&arena);
	}
	assert_true(whole > 40);
	rb_arena_release(&arena);
}

static void what_does_not_slide_or_would_take_too_long_is_left(void **state)
{
	struct rb_arena arena = {0};
	struct sleep sleep, before;

	(void)state;
	lay(&sleep, 1);
	before = sleep;
	assert_false(rb_redundant_contacts(&sleep.dense, 1e-9, 1e-9, 10, &arena));
	assert_memory_equal(sleep.row, before.row, sizeof sleep.row);
	sleep.row[0].impulse.t = (rb_vec3){0, 0, 0};
	before = sleep;
	assert_false(rb_redundant_contacts(&sleep.dense, 1e-9, 1e-9, 1e9, &arena));
	assert_memory_equal(sleep.row, before.row, sizeof sleep.row);
	rb_arena_release(&arena);
}

enum { WHEELS = 4 };

/*
 * Four wheels in ball joints below a body, each with one contact at random loads, of which one
 * slides: body 1, wheels from 2 on.
 */
struct car {
	struct rb_solver_body body[2 + WHEELS];
	struct rb_constraint row[2 * WHEELS];
	struct rb_row_system dense;
};

static void lay_car(struct car *car, uint64_t series)
{
	*car = (struct car){.body = {{.inverse_mass = 0}}};
	for (int k = 0; k <= WHEELS; k++)
		car->body[1 + k] = (struct rb_solver_body){.inverse_mass = k > 0 ? 0.1 : 0.01,
		                                           .inverse_inertia = k > 0 ? 3 : 0.02};
	for (int k = 0; k < WHEELS; k++) {
		const double normal_impulse = solids_random(series, (uint64_t)k, 0.5, 1);

		car->row[k] = (struct rb_constraint){.a = 0,
		                                     .b = 2 + k,
		                                     .normal = {0, 0, 1},
		                                     .arm_b = {0, 0, -0.3},
		                                     .inverse_mass_n = 1,
		                                     .inverse_mass_t = 1,
		                                     .friction = 0.4,
		                                     .impulse.n = normal_impulse};
		car->row[WHEELS + k] = (struct rb_constraint){
			.a = 1,
			.b = 2 + k,
			.set = RB_CONSTRAINT_FREE,
			.normal = {0, 0, 1},
			.arm_a = {k % 2 ? 1 : -1, k / 2 ? 0.7 : -0.7, -0.4},
			.inverse_mass_n = 1,
			.inverse_mass_t = 1};
	}
	car->row[0].impulse.t = (rb_vec3){0.4 * car->row[0].impulse.n, 0, 0};
	car->dense = (struct rb_row_system){
		.bodies.body = car->body, .row = car->row, .row_count = 2 * WHEELS};
}

/* Force and torques about x and y that the wheels hand on to the body. */
static void lever_of(const struct car *car, double sum[3])
{
	sum[0] = sum[1] = sum[2] = 0;
	for (int k = 0; k < WHEELS; k++) {
		const double n = car->row[k].impulse.n;

		sum[0] += n;
		sum[1] += n * car->row[WHEELS + k].arm_a.x;
		sum[2] += n * car->row[WHEELS + k].arm_a.y;
	}
}

/* Loads are open along 1 -1 -1 1 only, through the joints; if no joint holds, not at all. */
static void joints_hand_loads_on(void **state)
{
	struct rb_arena arena = {0};

	(void)state;
	for (uint64_t series = 0; series < 20; series++) {
		double before[3], after[3];
		struct car car;

		lay_car(&car, series);
		lever_of(&car, before);
		assert_true(rb_redundant_contacts(&car.dense, 1e-9, 1e-9, 1e9, &arena));
		lever_of(&car, after);
		for (int k = 0; k < 3; k++)
			assert_near(after[k], before[k], 1e-14);
		assert_near(car.row[0].impulse.n - car.row[1].impulse.n - car.row[2].impulse.n +
		                    car.row[3].impulse.n,
		            0, 1e-14);
		assert_near(car.row[0].impulse.t.x, 0.4 * car.row[0].impulse.n, 1e-15);
		lay_car(&car, series);
		for (int k = 0; k < WHEELS; k++) {
			car.row[WHEELS + k].set = RB_CONSTRAINT_INTERVAL;
			car.row[WHEELS + k].high = 1;
		}
		assert_false(rb_redundant_contacts(&car.dense, 1e-9, 1e-9, 1e9, &arena));
		rb_arena_reset(&arena);
	}
	rb_arena_release(&arena);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pushes_become_even_and_do_the_same),
		cmocka_unit_test(who_had_borne_nothing_makes_no_difference),
		cmocka_unit_test(pairs_of_a_tower_and_of_a_ring_become_even),
		cmocka_unit_test(what_does_not_slide_or_would_take_too_long_is_left),
		cmocka_unit_test(joints_hand_loads_on),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
