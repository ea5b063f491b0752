/* SPDX-License-Identifier: MIT */
/* src/app/balance.c: the ledger over a whole run */
#include "support.h"

#include "app/balance.h"

/* A frame with a ledger in which these are unexplained. */
static struct rb_frame_numbers frame_of(double energy, rb_vec3 linear, rb_vec3 angular,
                                        double scale)
{
	struct rb_frame_numbers numbers = {.has_ledger = true};

	numbers.ledger.energy[RB_ENERGY_CAUSES] = energy;
	numbers.ledger.energy_scale = scale;
	numbers.ledger.momentum[RB_MOMENTUM_CAUSES][0] = linear;
	numbers.ledger.momentum[RB_MOMENTUM_CAUSES][1] = angular;
	numbers.ledger.momentum_scale[0] = 2 * scale;
	numbers.ledger.momentum_scale[1] = 4 * scale;
	return numbers;
}

static struct rb_balance two_frames(void)
{
	const struct rb_frame_numbers first = frame_of(-3, (rb_vec3){3, 4, 0}, (rb_vec3){0, 0, 1},
	                                               10);
	const struct rb_frame_numbers last = frame_of(2, (rb_vec3){1, 0, 0}, (rb_vec3){0, 6, 8},
	                                              20);
	struct rb_balance balance = {0};

	rb_balance_take(&balance, &first);
	rb_balance_take(&balance, &last);
	return balance;
}

static void the_most_of_all_frames_counts(void **state)
{
	const struct rb_balance balance = two_frames();

	(void)state;
	assert_true(balance.kept);
	assert_near(balance.unexplained, 3, 0); /* lost or gained */
	assert_near(balance.gained, 2, 0);      /* gained alone */
	assert_near(balance.energy_scale, 20, 0);
	assert_near(balance.momentum_unexplained[0], 5, 0);
	assert_near(balance.momentum_unexplained[1], 10, 0);
	assert_near(rb_balance_energy_share(&balance), 3 / 20.0, 1e-16);
	/* the worse of both momenta: 5 of 40, 10 of 80 */
	assert_near(rb_balance_momentum_share(&balance), 0.125, 1e-16);
}

static void a_frame_without_a_ledger_changes_nothing(void **state)
{
	struct rb_frame_numbers none = frame_of(99, (rb_vec3){99, 0, 0}, (rb_vec3){99, 0, 0}, 99);
	struct rb_balance balance = {0};

	(void)state;
	none.has_ledger = false;
	rb_balance_take(&balance, &none);
	assert_false(balance.kept);
	assert_near(balance.unexplained + balance.energy_scale + balance.momentum_scale[1], 0, 0);
	assert_near(rb_balance_energy_share(&balance), 0, 0); /* nothing of nothing */
	assert_near(rb_balance_momentum_share(&balance), 0, 0);
}

/* A maximum that passes over it would call a run right that is lost. */
static void what_is_no_number_stays_one(void **state)
{
	const struct rb_frame_numbers bad = frame_of((double)NAN, (rb_vec3){(double)NAN, 0, 0},
	                                             (rb_vec3){0, 0, 0}, 10);
	const struct rb_frame_numbers good = frame_of(1, (rb_vec3){1, 0, 0}, (rb_vec3){1, 0, 0},
	                                              10);
	struct rb_balance balance = {0};

	(void)state;
	rb_balance_take(&balance, &good);
	rb_balance_take(&balance, &bad);
	rb_balance_take(&balance, &good);
	assert_true(isnan(balance.unexplained));
	assert_true(isnan(rb_balance_energy_share(&balance)));
	assert_true(isnan(rb_balance_momentum_share(&balance)));
}

/* What print writes. */
static const char *printed(const struct rb_balance *balance, const struct rb_ledger_values *last,
                           bool as_json)
{
	static char text[2048];
	char *made = NULL;
	size_t size = 0;
	FILE *const file = open_memstream(&made, &size);
	struct rb_json json = {.file = file};

	assert_non_null(file);
	if (as_json)
		rb_balance_print_json(&json, balance, last);
	else
		rb_balance_print(file, balance, last);
	fclose(file);
	snprintf(text, sizeof text, "%s", made);
	free(made);
	return text;
}

/* Causes that take are shown as what they took: negative. */
static void causes_are_told_with_the_sign_of_what_bodies_got(void **state)
{
	const struct rb_balance balance = two_frames();
	struct rb_ledger_values last = {
		.energy = {[RB_ENERGY_APPLIED] = 5, [RB_ENERGY_SLIDING] = 2}};

	(void)state;
	const char *text = printed(&balance, &last, false);
	assert_non_null(strstr(text, "applied 5 J, sliding -2 J\n"));
	assert_non_null(strstr(
		text,
		"3 J at most, 0.15 of what moved; of momentum 0.12, of angular momentum 0.12"));
	last = (struct rb_ledger_values){.energy = {0}};
	assert_non_null(strstr(printed(&balance, &last, false), "nothing gave or took energy\n"));
	/* and what is rounding of what moved, 20 J here */
	last.energy[RB_ENERGY_SLIDING] = 4e-15;
	assert_non_null(strstr(printed(&balance, &last, false), "nothing gave or took energy\n"));
	last.energy[RB_ENERGY_SLIDING] = 5e-15;
	assert_non_null(strstr(printed(&balance, &last, false), "sliding -5e-15 J\n"));
	last.energy[RB_ENERGY_SLIDING] = 0;
	assert_string_equal(printed(&(struct rb_balance){0}, &last, false), "");
	assert_string_equal(printed(&(struct rb_balance){0}, &last, true), "\"ledger\":null");
}

static void a_resumed_run_has_it_as_it_was(void **state)
{
	struct rb_balance saved = two_frames(), loaded = {0};
	struct rb_pack pack = {0};
	struct rb_error err;

	(void)state;
	rb_balance_pack(&saved, &pack);
	struct rb_pack from = {.loading = true, .bytes = pack.bytes, .size = pack.size};
	rb_balance_pack(&loaded, &from);
	assert_ok(rb_pack_status(&from, "a balance", &err));
	assert_true(from.at == from.size);
	assert_true(loaded.kept && loaded.unexplained == 3 && loaded.gained == 2);
	assert_true(loaded.momentum_unexplained[1] == 10 && loaded.momentum_scale[0] == 40);
	assert_near(rb_balance_energy_share(&loaded), rb_balance_energy_share(&saved), 0);
	rb_pack_release(&pack);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_most_of_all_frames_counts),
		cmocka_unit_test(a_frame_without_a_ledger_changes_nothing),
		cmocka_unit_test(what_is_no_number_stays_one),
		cmocka_unit_test(causes_are_told_with_the_sign_of_what_bodies_got),
		cmocka_unit_test(a_resumed_run_has_it_as_it_was),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
