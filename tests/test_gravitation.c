/* SPDX-License-Identifier: MIT */
/*
 * Gravitation of worlds: what impacts leave alone, relative motion on one piece, what pieces pass on,
 * centres and ledger, momenta of steps.
 */
#include "sanitized.h"
#include "worlds.h"

#include <float.h>

#include "located/piece_warm_start.h"
#include "located/relative.h"
#include "math/random.h"

static const rb_vec3 none = {0, 0, 0};

static void open_attracting(struct lab *lab, double duration, double frame_rate)
{
	lab_open_located(lab, duration, frame_rate);
	lab->scene.world.gravitation.given = true;
	lab->scene.world.gravitation.constant = 1;
	lab_surface(lab, 0, 1);
}

static void step_all(struct lab *lab)
{
	while (rb_world_time(lab->world) < lab->model->duration_s)
		lab_step(lab);
}

static rb_vec3 velocity(const struct lab *lab, int i)
{
	return rb_world_row3(lab->world->state.velocity, i);
}

static rb_vec3 position(const struct lab *lab, int i)
{
	return rb_world_row3(lab->world->state.position, i);
}

/*
 * Two pairs far from each other, the first of which collides: the other's orbit is that of a world
 * in which it does not, but for what the first pair's other places do.
 */
static void an_impact_leaves_alone_what_it_does_not_touch(void **state)
{
	struct lab lab[2];

	(void)state;
	for (int k = 0; k < 2; k++) {
		open_attracting(&lab[k], 2, 8);
		/* of next to no mass: their places are felt by nobody */
		lab_sphere(&lab[k], 0.1, 1e-30, (rb_vec3){0, 0, 0}, (rb_vec3){k ? 1 : -1, 0, 0});
		lab_sphere(&lab[k], 0.1, 1e-30, (rb_vec3){1, 0, 0}, none);
		lab_sphere(&lab[k], 0.1, 1, (rb_vec3){99.5, 0, 0}, (rb_vec3){0, -0.7, 0});
		lab_sphere(&lab[k], 0.1, 1, (rb_vec3){100.5, 0, 0}, (rb_vec3){0, 0.7, 0});
		lab_seal(&lab[k], 1);
		step_all(&lab[k]);
	}
	assert_int_equal(rb_world_totals(lab[0].world).collisions, 0);
	assert_int_equal(rb_world_totals(lab[1].world).collisions, 1);
	for (int i = 2; i < 4; i++) {
		const rb_vec3 off = rb_vec3_sub(position(&lab[1], i), position(&lab[0], i));

		assert_true(rb_vec3_length(off) <= 64 * DBL_EPSILON);
	}
	for (int k = 0; k < 2; k++)
		lab_close(&lab[k]);
}

/* Inside a frame all are on one piece: what is said of a pair holds at every moment of it. */
static void what_is_said_of_a_pair_on_one_piece_holds_all_along_it(void **state)
{
	struct lab lab;
	int said = 0, unsaid = 0;

	(void)state;
	open_attracting(&lab, 20, 4);
	lab_sphere(&lab, 0.05, 1, (rb_vec3){-0.5, 0, 0}, (rb_vec3){0, -0.5, 0});
	lab_sphere(&lab, 0.05, 1, (rb_vec3){0.5, 0, 0.1}, (rb_vec3){0, 0.5, 0});
	lab_sphere(&lab, 0.05, 0.1, (rb_vec3){0, 3, 0}, (rb_vec3){0.8, 0, 0});
	lab_seal(&lab, 1);
	while (rb_world_time(lab.world) < 20) {
		lab_step(&lab);
		const struct rb_located *const l = lab.world->located;
		const struct rb_piece_of *const p = &l->piece[0];

		assert_true(rb_relative_is(l, 0, 1) && rb_relative_is(l, 2, 0));
		for (int k = 1; k < 40; k++) {
			const double least = 0.05 * k;
			double nearest = HUGE_VAL, external, jerk, max = 0;

			rb_relative_bounds(l, 0, 1, &external, &jerk);
			for (int s = 0; s <= 100; s++) {
				const double t = p->origin_s + (p->until_s - p->origin_s) * s / 100;
				const rb_vec3 a = rb_arc_acceleration(l, 0, t),
					      b = rb_arc_acceleration(l, 1, t);

				nearest = fmin(nearest, rb_vec3_length(rb_vec3_sub(
								rb_arc_position(l, 1, t),
								rb_arc_position(l, 0, t))));
				max = fmax(max, rb_vec3_length(rb_vec3_sub(b, a)));
			}
			assert_true(max <= external);
			const bool apart = rb_relative_is_separated(l, 0, 1, p->origin_s,
			                                            p->until_s, least);
			if (rb_relative_began_far(l, 0, 1, p->until_s, least))
				assert_true(nearest > least);
			if (apart)
				assert_true(nearest > least);
			said += apart;
			/* it is said where there is a little room */
			unsaid += !apart && nearest > 1.2 * least;
		}
	}
	assert_true(said > 100);
	assert_true(unsaid * 10 < said);
	lab_close(&lab);
}

/* What is kept of a piece is what it says at that moment, until the next event. */
static void a_body_leaves_its_piece_with_what_rounding_has_left(void **state)
{
	struct lab lab;

	(void)state;
	open_attracting(&lab, 10, 4);
	lab_sphere(&lab, 0.05, 1, (rb_vec3){-0.5, 0, 0}, (rb_vec3){0, -0.6, 0});
	lab_sphere(&lab, 0.05, 1, (rb_vec3){0.5, 0, 0}, (rb_vec3){0, 0.6, 0});
	lab_seal(&lab, 1);
	lab_step(&lab);
	struct rb_located *const l = lab.world->located;
	const struct rb_piece_of piece = l->piece[1];
	const double t = lab.world->state.time_s;
	double value[6];

	l->moment++;
	assert_null(rb_piece_warm_start_at(l, 1, t));
	rb_piece_warm_start_keep(l, 1, t);
	const struct rb_piece_warm_start *const past = rb_piece_warm_start_at(l, 1, t);
	assert_non_null(past);
	assert_null(rb_piece_warm_start_at(l, 1, nextafter(t, 99)));
	assert_null(rb_piece_warm_start_at(l, 0, t)); /* another body */
	rb_gauss_some(&piece.piece, piece.first, 6, t - piece.origin_s, value);
	for (int m = 0; m < 6; m++) {
		assert_true(past->value[m] == value[m]);
		assert_true(fabs(past->rest[m]) <= 4 * DBL_EPSILON);
	}
	assert_true(past->left_s == t && past->origin_s == piece.origin_s &&
	            past->length_s == piece.piece.length_s);
	/* position and what it leaves out are the base and the value, exactly */
	const long double sum = (long double)piece.base.x + value[0];
	assert_true((long double)past->position.x + past->left_out.x == sum);
	for (int k = 0; k < RB_GAUSS_NODES; k++)
		for (int m = 0; m < 6; m++)
			assert_true(past->coefficient[k][m] ==
			            piece.piece.coefficient[k * piece.piece.n + piece.first + m]);
	/* kept once in an event: from another piece nothing is taken */
	l->piece[1].base.x += 1;
	rb_piece_warm_start_keep(l, 1, t);
	assert_true(rb_piece_warm_start_at(l, 1, t)->position.x == past->position.x);
	l->piece[1].base.x -= 1;
	l->moment++;
	assert_null(rb_piece_warm_start_at(l, 1, t));
	lab_close(&lab);
}

static enum rb_status lead(void *user, int id, double t, struct rb_driven_pose *pose,
                           struct rb_error *err)
{
	(void)user, (void)id, (void)err;
	/* a piece of it is far shorter than one of the others */
	pose->position = (rb_vec3){-3 + 0.5 * sin(20 * t), 0, 0};
	pose->velocity = (rb_vec3){10 * cos(20 * t), 0, 0};
	pose->has_velocity = true;
	return RB_OK;
}

/* The ledger explains energy and momentum with a driven and a fixed centre and a test body. */
static void the_ledger_knows_who_does_not_yield_and_who_does_not_answer(void **state)
{
	const struct rb_world_hooks hooks = {.motion = lead};
	const struct rb_world_options options = {.threads = 1};
	struct lab lab;

	(void)state;
	open_attracting(&lab, 3, 8);
	lab.scene.record.ledger = lab.scene.record.ledger_given = true;
	struct rb_body_def def = lab_sphere_def(0.1, (double)NAN, (rb_vec3){-3, 0, 0}, none);
	def.motion = 0;
	def.motion_gives_velocity = true;
	def.gravitational_mass = 2;
	lab_add(&lab, &def);
	def = lab_sphere_def(0.1, (double)NAN, (rb_vec3){0, -3, 0}, none);
	def.is_static = true;
	def.gravitational_mass = 1;
	lab_add(&lab, &def);
	lab_sphere(&lab, 0.1, 0.5, (rb_vec3){1, 1, 0}, (rb_vec3){0, 0.5, 0.5});
	def = lab_sphere_def(0.1, 2, (rb_vec3){2, 0, 1}, none);
	def.gravitational_mass = 0;
	lab_add(&lab, &def);
	lab_seal_with(&lab, &options, &hooks);
	assert_int_equal(lab.model->center_count, 2);
	assert_int_equal(lab.model->attractor_count, 3);
	assert_false(lab.model->attracts_by_mass);
	while (rb_world_time(lab.world) < 3) {
		lab_step(&lab);
		const struct rb_frame_numbers now = rb_world_totals(lab.world);

		assert_true(now.has_ledger);
		/* a driven body's polynomial is right to 1e-11 of its velocity */
		assert_true(fabs(now.ledger.energy[RB_ENERGY_CAUSES]) <= 1e-9);
		for (int m = 0; m < 2; m++)
			assert_true(rb_vec3_max_abs(now.ledger.momentum[RB_MOMENTUM_CAUSES][m]) <=
			            1e-12);
		if (rb_world_time(lab.world) > 1) {
			assert_true(fabs(now.ledger.energy[RB_ENERGY_DRIVEN]) > 1e-3);
			assert_true(fabs(now.ledger.energy[RB_ENERGY_APPLIED]) > 1e-3);
		}
	}
	lab_close(&lab);
}

/* A ball falls to a fixed one, bounces and stands; then nothing is computed any more. */
static void what_rests_on_a_fixed_centre_stands_and_the_ledger_holds(void **state)
{
	struct lab lab;

	(void)state;
	open_attracting(&lab, 60, 4);
	lab_surface(&lab, 0.5, 0.5);
	lab.scene.record.ledger = lab.scene.record.ledger_given = true;
	struct rb_body_def def = lab_sphere_def(2, (double)NAN, (rb_vec3){1, 2, 3}, none);
	def.is_static = true;
	def.gravitational_mass = 4;
	lab_add(&lab, &def);
	lab_sphere(&lab, 0.5, 2, (rb_vec3){1, 2, 9}, none);
	lab_seal(&lab, 1);
	step_all(&lab);
	const struct rb_frame_numbers now = rb_world_totals(lab.world);

	assert_true(rb_vec3_length(velocity(&lab, 0)) == 0);
	assert_true(fabs(position(&lab, 0).z - 5.5) <= 8 * DBL_EPSILON * 5.5);
	assert_true(lab.world->located->cluster[lab.world->located->cluster_of[0]].at_rest);
	/* forces of centre and contact cancel for 50 s: 3.2 N s a second */
	assert_true(rb_vec3_length(now.ledger.momentum[RB_MOMENTUM_CAUSES][0]) <= 1e-12);
	assert_true(rb_vec3_length(now.ledger.momentum[RB_MOMENTUM_CAUSES][1]) <= 1e-12);
	assert_true(fabs(now.ledger.energy[RB_ENERGY_CAUSES]) <= 1e-13);
	lab_close(&lab);
}

/* Two balls that lie on each other for 1e3 s, drifting as one: how far they have moved apart, m. */
static double lie_on_each_other(int method, double drift)
{
	double max = 0;
	struct lab lab;

	open_attracting(&lab, 1000, 0.02);
	lab_surface(&lab, 0.5, 0.5);
	lab.scene.world.method = (enum rb_method_kind)method;
	lab.scene.world.time_step_s = 0.05;
	lab_sphere(&lab, 2, 1, (rb_vec3){-2, 0, 0}, (rb_vec3){0, drift, drift / 2});
	lab_sphere(&lab, 1, 3, (rb_vec3){1, 0, 0}, (rb_vec3){0, drift, drift / 2});
	lab_seal(&lab, 1);
	while (rb_world_time(lab.world) < 1000) {
		lab_step(&lab);
		const rb_vec3 apart = rb_vec3_sub(position(&lab, 1), position(&lab, 0));

		max = fmax(max, fabs(rb_vec3_length(apart) - 3));
		max = fmax(max, rb_vec3_max_abs(rb_vec3_sub(apart, (rb_vec3){3, 0, 0})));
	}
	lab_close(&lab);
	return max;
}

static void two_balls_that_lie_on_each_other_neither_sink_nor_part(void **state)
{
	static const int methods[] = {RB_METHOD_LOCATED, RB_METHOD_AUTO, RB_METHOD_STEPPED};

	(void)state;
	for (int k = 0; k < 3; k++) {
		assert_true(lie_on_each_other(methods[k], 0) <= 4 * DBL_EPSILON);
		/* at 128 m two coordinates are rounded by 2^-47; so is what each of 2e4 steps adds */
		const double steps = methods[k] == RB_METHOD_STEPPED ? 2e4 : 2;
		assert_true(lie_on_each_other(methods[k], 0.125) <= steps * ldexp(1, -46));
	}
}

/* By steps, pairs give each other what they take, however coarse the step. */
static void steps_keep_linear_and_angular_momentum(void **state)
{
	enum { N = 40 };
	struct lab lab;

	(void)state;
	open_attracting(&lab, 4, 4);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.time_step_s = 0.05;
	for (int i = 0; i < N; i++) {
		double x[6];

		for (int m = 0; m < 6; m++)
			x[m] = 2 * rb_random_unit(5, (uint64_t)m, (uint64_t)i) - 1;
		lab_sphere(&lab, 1e-4, 0.1, (rb_vec3){x[0], x[1], x[2]},
		           (rb_vec3){x[3], x[4], x[5]});
	}
	lab_seal(&lab, 2);
	const struct rb_frame_numbers begin = rb_world_totals(lab.world);
	step_all(&lab);
	const struct rb_frame_numbers end = rb_world_totals(lab.world);

	assert_true(rb_vec3_length(rb_vec3_sub(end.momentum, begin.momentum)) <=
	            80 * 8 * N * DBL_EPSILON);
	assert_true(rb_vec3_length(rb_vec3_sub(end.angular_momentum, begin.angular_momentum)) <=
	            80 * 64 * N * DBL_EPSILON);
	assert_true(rb_vec3_length(rb_vec3_sub(velocity(&lab, 0), none)) > 0);
	lab_close(&lab);
}

/* So do sums by a tree, whose forces are as wrong as a part in 10,000, and not along one line. */
static void steps_by_a_tree_keep_angular_momentum(void **state)
{
	enum { N = 1600, STEPS = 3 };
	struct lab lab;

	(void)state;
	open_attracting(&lab, 0.05 * STEPS, 20);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.time_step_s = 0.05;
	lab.scene.world.gravitation.opening_angle = 0.5;
	for (int i = 0; i < N; i++) {
		const uint64_t k = (uint64_t)i;

		lab_sphere(&lab, 1e-9, 1.0 / N,
		           (rb_vec3){rb_random_unit(5, 0, k), rb_random_unit(5, 1, k),
		                     rb_random_unit(5, 2, k)},
		           none);
	}
	lab_seal(&lab, 2);
	step_all(&lab);
	const struct rb_frame_numbers end = rb_world_totals(lab.world);

	/* places of about 1, speeds of about 0.1: N sums of both roundings */
	assert_true(rb_vec3_length(end.angular_momentum) <= STEPS * 0.1 * N * DBL_EPSILON);
	assert_true(rb_vec3_length(end.momentum) <= STEPS * 0.1 * N * DBL_EPSILON);
	lab_close(&lab);
}

static void add_grains(struct lab *lab, int count, double radius)
{
	const double apart = 3 * radius;
	rb_vec3 place[64];

	assert_true(count <= 64);
	for (int i = 0, tries = 0; i < count; tries++) {
		double x[3];
		bool fits = true;

		for (int m = 0; m < 3; m++)
			x[m] = 2 * rb_random_unit(7, (uint64_t)m, (uint64_t)tries) - 1;
		place[i] = (rb_vec3){x[0], x[1], x[2]};
		for (int k = 0; k < i && fits; k++)
			fits = rb_vec3_length(rb_vec3_sub(place[i], place[k])) > apart;
		if (!fits)
			continue;
		lab_sphere(lab, radius, 1.0 / count, place[i], none);
		i++;
	}
}

static rb_vec3 centre(const struct lab *lab, int count)
{
	rb_vec3 sum = none;

	for (int i = 0; i < count; i++)
		sum = rb_vec3_add_scaled(sum, 1.0 / count, position(lab, i));
	return sum;
}

/*
 * A cloud falls in on itself, and steps of groups that meet are taken in parts: neither moves the
 * whole, and no frame shows an overlap.
 */
static void the_centre_of_a_cloud_that_falls_in_stays(void **state)
{
	enum { N = 60 };
	struct lab lab;
	uint64_t rollbacks = 0;

	(void)state;
	open_attracting(&lab, 2.5, 20);
	lab_surface(&lab, 0, 0.5);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.time_step_s = 5e-3;
	add_grains(&lab, N, 0.05);
	lab_seal(&lab, 2);
	const rb_vec3 from = centre(&lab, N);
	while (rb_world_time(lab.world) < tried(2.5, 2.5, 1.25)) {
		lab_step(&lab);
		rollbacks += lab.world->frame_counts.rollbacks;
		assert_true(lab.world->frame_counts.max_penetration_m <= lab.model->tolerance_m);
	}
	const struct rb_frame_numbers end = rb_world_totals(lab.world);

	assert_true(rollbacks > 0);
	assert_true(end.collisions > tried(1000, 1000, 10));
	assert_true(rb_vec3_length(end.momentum) <= 1e-14);
	/* steps of parts as well, of which there are as many as impacts */
	assert_true(rb_vec3_length(end.angular_momentum) <= 1e-14);
	/* 625 steps, each of which rounds places below 1 */
	assert_true(rb_vec3_length(rb_vec3_sub(centre(&lab, N), from)) <= 625 * DBL_EPSILON);
	lab_close(&lab);
}

/* Balls and boxes that come together, turning; what contacts change their angular momentum by. */
static double turning_changes_by(double friction, double restitution, bool attract)
{
	enum { N = 8 };
	struct lab lab;
	double max = 0;

	open_attracting(&lab, 1, 25);
	lab.scene.world.gravitation.given = attract;
	lab_surface(&lab, friction, restitution);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.time_step_s = 0.02;
	for (int i = 0; i < N; i++) {
		const rb_vec3 at = {(i & 1) ? 0.7 : -0.75, (i & 2) ? 0.72 : -0.8,
		                    (i & 4) ? 0.76 : -0.71};
		struct rb_body_def def = i % 3 ? lab_sphere_def(0.4, 1 + 0.1 * i, at, none)
		                               : lab_box_def((rb_vec3){0.6, 0.7, 0.8}, 1 + 0.1 * i,
		                                             at);

		def.velocity = (rb_vec3){-at.x - 0.7 * at.y, -at.y + 0.7 * at.x, -at.z};
		def.angular_velocity = (rb_vec3){0.3 * i, 1 - 0.2 * i, 0.5};
		lab_add(&lab, &def);
	}
	lab_seal(&lab, 2);
	const rb_vec3 begin = rb_world_totals(lab.world).angular_momentum;
	while (rb_world_time(lab.world) < lab.model->duration_s) {
		lab_step(&lab);
		const rb_vec3 now = rb_world_totals(lab.world).angular_momentum;

		max = fmax(max, rb_vec3_length(rb_vec3_sub(now, begin)));
	}
	assert_true(rb_world_totals(lab.world).collisions > 4);
	assert_true(rb_vec3_length(begin) > 1);
	lab_close(&lab);
	return max;
}

/*
 * An impulse acts at one point, whatever moment of the step its gap or its time of impact was found
 * for: in 50 steps the shares of 8 bodies, of about 2 kg m^2/s, are rounded some 64 times each.
 */
static void contacts_by_steps_leave_the_angular_momentum(void **state)
{
	(void)state;
	for (int k = 0; k < 8; k++)
		assert_true(turning_changes_by(k & 1 ? 0.3 : 0, k & 2 ? 0.5 : 0, k & 4) <=
		            50.0 * 8 * 2 * 64 * DBL_EPSILON);
}

/* Whoever sums it, each body has its own sum. */
static void many_attract_each_other_alike_by_one_thread_and_by_three(void **state)
{
	enum { COUNT = 300 };
	struct lab lab[2];

	(void)state;
	for (int k = 0; k < 2; k++) {
		open_attracting(&lab[k], 0.25, 4);
		for (int i = 0; i < COUNT; i++)
			lab_sphere(&lab[k], 1e-6, 1.0 / COUNT,
			           (rb_vec3){rb_random_unit(5, 0, 3 * (uint64_t)i),
			                     rb_random_unit(5, 0, 3 * (uint64_t)i + 1),
			                     rb_random_unit(5, 0, 3 * (uint64_t)i + 2)},
			           none);
		lab[k].scene.world.gravitation.softening_m = 0.25;
		lab_seal(&lab[k], k ? 3 : 1);
		step_all(&lab[k]);
	}
	for (int i = 0; i < COUNT; i++)
		lab_assert_vector(position(&lab[0], i), position(&lab[1], i), 0, "position",
		                  __FILE__, __LINE__);
	for (int k = 0; k < 2; k++)
		lab_close(&lab[k]);
}

int main(void)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_impact_leaves_alone_what_it_does_not_touch),
		cmocka_unit_test(what_is_said_of_a_pair_on_one_piece_holds_all_along_it),
		cmocka_unit_test(a_body_leaves_its_piece_with_what_rounding_has_left),
		cmocka_unit_test(the_ledger_knows_who_does_not_yield_and_who_does_not_answer),
		cmocka_unit_test(what_rests_on_a_fixed_centre_stands_and_the_ledger_holds),
		cmocka_unit_test(two_balls_that_lie_on_each_other_neither_sink_nor_part),
		cmocka_unit_test(steps_keep_linear_and_angular_momentum),
		cmocka_unit_test(steps_by_a_tree_keep_angular_momentum),
		cmocka_unit_test(the_centre_of_a_cloud_that_falls_in_stays),
		cmocka_unit_test(contacts_by_steps_leave_the_angular_momentum),
		cmocka_unit_test(many_attract_each_other_alike_by_one_thread_and_by_three),
	};

	return run_tests_of_threads(tests, "steps", "cloud", "thread");
}
