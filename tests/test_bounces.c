/* SPDX-License-Identifier: MIT */
/* src/located/bounces: the end of infinitely many bounces, under attraction and gravity, disturbed or not. */
#include "worlds.h"

#include <float.h>

#include "located/bounces.h"

static const rb_vec3 none = {0, 0, 0};

/*
 * Two spheres of together 1 kg with G = 1, 10 m apart, the sum of their radii 1 m: fall, then all
 * flights between bounces on Kepler's lines, summed with 40 digits.
 */
static void an_infall_ends_when_closed_forms_say(void **state)
{
	struct bench bench;

	(void)state;
	bench_open(&bench, 40, 1);
	bench.lab.scene.world.gravity = none;
	bench.lab.scene.world.gravitation.given = true;
	bench.lab.scene.world.gravitation.constant = 1;
	lab_surface(&bench.lab, 0, 0.5);
	lab_sphere(&bench.lab, 0.5, 0.5, (rb_vec3){-5, 0, 0}, none);
	lab_sphere(&bench.lab, 0.5, 0.5, (rb_vec3){5, 0, 0}, none);
	bench_seal(&bench);
	lab_run(&bench.lab);
	assert_near(bench_event(&bench, RB_EVENT_REST, 0)->time_s, 37.93059394252601, 1e-11);
	bench_close(&bench);
}

/* From h the bounces end after sqrt(2 h/g) (1 + e)/(1 - e). */
static void bounces_on_a_floor_end_to_rounding(void **state)
{
	static const double restitution[] = {0.3, 0.8, 0.95};

	(void)state;
	for (int k = 0; k < 3; k++) {
		const double e = restitution[k];
		struct bench bench;

		bench_open(&bench, 30, 1);
		lab_surface(&bench.lab, 0, e);
		lab_sphere(&bench.lab, 0.1, 1, (rb_vec3){0, 0, 1.1}, none);
		lab_plane(&bench.lab, none, (rb_vec3){0, 0, 1});
		bench_seal(&bench);
		lab_run(&bench.lab);
		const double end = sqrt(2 / 9.81) * (1 + e) / (1 - e);
		assert_near(bench_event(&bench, RB_EVENT_REST, 0)->time_s, end, 1e-13 * end);
		bench_close(&bench);
	}
}

/* A world of a ball and a floor, whose contact bounces as the tests say. */
static void open_floor(struct lab *lab, struct rb_contact_point *m)
{
	lab_open_located(lab, 1, 1);
	lab_surface(lab, 0, 0.5);
	lab_sphere(lab, 0.1, 1, (rb_vec3){0, 0, 1}, none);
	lab_plane(lab, none, (rb_vec3){0, 0, 1});
	lab_seal(lab, 1);
	lab_step(lab);
	*m = (struct rb_contact_point){.a = 0, .b = 1};
}

/* Restitution 1/2, 2 m/s^2: a flight takes as many seconds as the rebound has metres a second. */
static void what_disturbs_a_flight_begins_a_new_series(void **state)
{
	struct rb_contact_point m;
	struct lab lab;

	(void)state;
	open_floor(&lab, &m);
	struct rb_located *const l = lab.world->located;
	rb_bounces_note(l, &m, 0, 1, 2, 0.5);
	rb_bounces_note(l, &m, 1, 0.5, 2, 0.5);
	assert_near(rb_bounces_left(l, &m, 1), 1, 1e-14);
	/* thrown down in its flight: it is back much too early */
	rb_bounces_note(l, &m, 1.125, 0.25, 2, 0.5);
	assert_near(rb_bounces_left(l, &m, 1.125), 0.5, 1e-14);
	rb_bounces_note(l, &m, 1.375, 0.125, 2, 0.5);
	assert_near(rb_bounces_left(l, &m, 1.375), 0.25, 1e-14);
	lab_close(&lab);
}

/* A tenth of a flight's time is no sign of a disturbance, until the next one contradicts. */
static void later_estimates_overrule_what_contradicts_them(void **state)
{
	struct rb_contact_point m;
	struct lab lab;

	(void)state;
	open_floor(&lab, &m);
	struct rb_located *const l = lab.world->located;
	rb_bounces_note(l, &m, 0, 1, 2, 0.5);
	rb_bounces_note(l, &m, 1, 0.5, 2, 0.5);
	rb_bounces_note(l, &m, 1.55, 0.25, 2, 0.5);
	rb_bounces_note(l, &m, 1.8, 0.125, 2, 0.5);
	assert_near(rb_bounces_left(l, &m, 1.8), 0.25, 1e-13);
	/* another partner has a series of its own */
	m.b = 0;
	rb_bounces_note(l, &m, 1.9, 0.5, 2, 0.5);
	assert_near(rb_bounces_left(l, &m, 1.9), 1, 1e-13);
	lab_close(&lab);
}

int main(void)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_infall_ends_when_closed_forms_say),
		cmocka_unit_test(bounces_on_a_floor_end_to_rounding),
		cmocka_unit_test(what_disturbs_a_flight_begins_a_new_series),
		cmocka_unit_test(later_estimates_overrule_what_contradicts_them),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
