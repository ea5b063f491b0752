/* SPDX-License-Identifier: MIT */
/* src/world/invariants.c */
#include "invariants.h"

static struct lab lab;

static int setup(void **state)
{
	(void)state;
	lab_open_pile(&lab, RB_METHOD_STEPPED);
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	lab_close(&lab);
	return 0;
}

/* Puts a wrong number into the world, and the right one back. */
static void assert_number(double *number, double wrong, const char *reason)
{
	const double right = *number;

	*number = wrong;
	lab_assert_wrong(&lab, reason);
	*number = right;
	assert_int_equal(rb_world_validate(lab.world, &lab.error), RB_OK);
}

static void rows_that_are_not_numbers_are_found(void **state)
{
	struct rb_state *const s = &lab.world->state;

	(void)state;
	assert_number(&s->position[7], (double)NAN, "position or velocity of body 2");
	assert_number(&s->velocity[0], (double)INFINITY, "position or velocity of body 0");
	assert_number(&s->spin[3], (double)NAN, "the spin of body 1");
	assert_number(&s->orientation[4], 0.5, "the orientation of body 1");
	assert_number(&s->time_s, -1, "the state's time");
}

static void contacts_that_cannot_be_are_found(void **state)
{
	struct rb_contacts *const all = &lab.world->contacts;
	struct rb_contact *const first = &all->row[0];

	(void)state;
	assert_true(all->count >= 3);
	assert_number(&first->normal.x, 0.3, "the normal of bodies");
	assert_number(&first->gap, (double)NAN, "'gap' is out of its range");
	assert_number(&first->normal_force, -1, "pull at each other");
	assert_number(&first->tangent_force.z, 0.1 + first->normal_force, "along the normal");
	const struct rb_contact kept = *first;
	first->b = first->a;
	lab_assert_wrong(&lab, "a contact of bodies");
	*first = all->row[all->count - 1];
	lab_assert_wrong(&lab, "not sorted");
	*first = kept;
	assert_int_equal(rb_world_validate(lab.world, &lab.error), RB_OK);
}

static void events_out_of_order_are_found(void **state)
{
	struct rb_event rows[2] = {{.time_s = 1, .a = 0, .b = 1}, {.time_s = 0.5, .a = 0, .b = 1}};
	const struct rb_events kept = lab.world->events;

	(void)state;
	lab.world->events = (struct rb_events){.row = rows, .count = 2};
	lab_assert_wrong(&lab, "out of order");
	rows[1].time_s = 2;
	rows[1].b = 77;
	lab_assert_wrong(&lab, "event 1 of 2: 'b' is out of its range");
	lab.world->events = kept;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(rows_that_are_not_numbers_are_found, setup,
	                                        teardown),
		cmocka_unit_test_setup_teardown(contacts_that_cannot_be_are_found, setup, teardown),
		cmocka_unit_test_setup_teardown(events_out_of_order_are_found, setup, teardown),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
