/* SPDX-License-Identifier: MIT */
/* src/world/ledger.c */
#include "support.h"

#include "world/ledger.h"

static void assert_vectors(rb_vec3 a, double x, double y, double z, double tolerance)
{
	assert_near(a.x, x, tolerance);
	assert_near(a.y, y, tolerance);
	assert_near(a.z, z, tolerance);
}

/* A number of its own for each cause, part and direction; every one is exact in binary. */
static rb_vec3 vector_of(int cause, int part)
{
	const double first = 1 + cause + 0.5 * part;

	return (rb_vec3){first, 64 * first, -4096 * first};
}

static void each_cause_is_kept_by_itself_and_together_they_explain_the_change(void **state)
{
	const struct rb_frame_numbers start = {.kinetic_energy = 8,
	                                       .potential_energy = -32,
	                                       .momentum = {1, 2, 4},
	                                       .angular_momentum = {-8, 16, -32}};
	struct rb_frame_numbers now = start;
	struct rb_ledger ledger = {.kept = true};
	double scale = 0, length[2] = {0, 0};

	(void)state;
	rb_ledger_start(&ledger, &start);
	for (int k = 0; k < RB_ENERGY_CAUSES; k++) {
		struct rb_entries one = {0};
		const double value = (k % 3 == 1 ? -1 : 1) * (1 << k);
		rb_entries_energy(&one, (enum rb_ledger_energy)k, value);
		rb_ledger_enter(&ledger, &one);
		now.kinetic_energy += rb_ledger_takes(k) ? -2 * value : 2 * value;
		now.potential_energy += rb_ledger_takes(k) ? value : -value;
		scale += fabs(value);
	}
	for (int k = 0; k < RB_MOMENTUM_CAUSES; k++) {
		struct rb_entries one = {0};
		const rb_vec3 linear = vector_of(k, 0), angular = vector_of(k, 1);
		rb_entries_momentum(&one, (enum rb_ledger_momentum)k, linear, angular);
		rb_ledger_enter(&ledger, &one);
		now.momentum = rb_vec3_add(now.momentum, linear);
		now.angular_momentum = rb_vec3_add(now.angular_momentum, angular);
		length[0] += rb_vec3_length(linear);
		length[1] += rb_vec3_length(angular);
	}

	struct rb_ledger_values v = rb_ledger_values(&ledger, &now);
	for (int k = 0; k < RB_ENERGY_CAUSES; k++)
		assert_near(v.energy[k], (k % 3 == 1 ? -1 : 1) * (1 << k), 0);
	for (int k = 0; k < RB_MOMENTUM_CAUSES; k++)
		for (int part = 0; part < 2; part++) {
			const rb_vec3 wanted = vector_of(k, part);
			assert_vectors(v.momentum[k][part], wanted.x, wanted.y, wanted.z, 0);
		}
	assert_near(v.energy[RB_ENERGY_CAUSES], 0, 0);
	for (int part = 0; part < 2; part++) {
		assert_vectors(v.momentum[RB_MOMENTUM_CAUSES][part], 0, 0, 0, 0);
		assert_near(v.momentum_scale[part], length[part], 1e-12 * length[part]);
	}
	assert_near(v.energy_scale,
	            now.kinetic_energy + fabs(now.potential_energy - start.potential_energy) +
	                    scale,
	            1e-9);

	/* what nobody entered is unexplained, with its sign */
	now.kinetic_energy += 0.5, now.potential_energy += 0.25;
	now.momentum = rb_vec3_add(now.momentum, (rb_vec3){1, -2, 3});
	now.angular_momentum = rb_vec3_add(now.angular_momentum, (rb_vec3){-4, 5, -6});
	v = rb_ledger_values(&ledger, &now);
	assert_near(v.energy[RB_ENERGY_CAUSES], 0.75, 0);
	assert_vectors(v.momentum[RB_MOMENTUM_CAUSES][0], 1, -2, 3, 0);
	assert_vectors(v.momentum[RB_MOMENTUM_CAUSES][1], -4, 5, -6, 0);
}

/* Neumaier's sum: what a large entry hides comes out again when it is taken back, whichever was there first. */
static void small_entries_are_not_lost_beside_large_ones(void **state)
{
	const struct rb_frame_numbers none = {0};

	(void)state;
	for (int large_first = 0; large_first < 2; large_first++) {
		struct rb_ledger ledger = {.kept = true};
		double wanted = 0;

		rb_ledger_start(&ledger, &none);
		for (int i = -1; i <= 1000; i++) {
			struct rb_entries one = {0};
			const double value = i < 0       ? (large_first ? 0x1p60 : 0)
			                     : i == 500  ? (large_first ? -0x1p60 : 0x1p60)
			                     : i == 1000 ? (large_first ? 0 : -0x1p60)
			                                 : i + 0.5;
			rb_entries_energy(&one, RB_ENERGY_DRAG, value);
			rb_entries_momentum(&one, RB_MOMENTUM_DRAG, (rb_vec3){value, -value, 0},
			                    (rb_vec3){0, 0, value});
			rb_ledger_enter(&ledger, &one);
			wanted += i >= 0 && i != 500 && i != 1000 ? i + 0.5 : 0;
		}
		const struct rb_ledger_values v = rb_ledger_values(&ledger, &none);
		assert_near(v.energy[RB_ENERGY_DRAG], wanted, 0);
		assert_vectors(v.momentum[RB_MOMENTUM_DRAG][0], wanted, -wanted, 0, 0);
		assert_vectors(v.momentum[RB_MOMENTUM_DRAG][1], 0, 0, wanted, 0);
	}
}

static void an_impulse_turns_about_the_origin(void **state)
{
	struct rb_entries one = {0};

	(void)state;
	rb_entries_impulse(&one, RB_MOMENTUM_STATIC, (rb_vec3){0, 0, 2}, (rb_vec3){3, 5, 7});
	rb_entries_twist(&one, RB_MOMENTUM_STATIC, (rb_vec3){1, 1, 1});
	const int at = 3 * RB_MOMENTUM_STATIC;
	assert_vectors(rb_vec3_from(one.row + RB_ENTRY_LINEAR + at), 0, 0, 2, 0);
	assert_vectors(rb_vec3_from(one.row + RB_ENTRY_ANGULAR + at), 11, -5, 1, 0);
}

static void entries_are_added_with_their_share(void **state)
{
	struct rb_entries sum = {0}, drag = {0}, slide = {0};
	const struct rb_frame_numbers none = {0};
	struct rb_ledger ledger = {.kept = true};

	(void)state;
	rb_entries_energy(&sum, RB_ENERGY_SLIDING, 1);
	rb_entries_energy(&slide, RB_ENERGY_SLIDING, 8);
	rb_entries_energy(&drag, RB_ENERGY_DRAG, 16);
	rb_entries_momentum(&drag, RB_MOMENTUM_DRAG, (rb_vec3){4, 0, 0}, (rb_vec3){0, 0, 8});
	rb_entries_add(&sum, 0.5, &slide);
	rb_entries_add(&sum, -0.25, &drag);
	rb_ledger_enter(&ledger, &sum);
	const struct rb_ledger_values v = rb_ledger_values(&ledger, &none);
	assert_near(v.energy[RB_ENERGY_SLIDING], 5, 0);
	assert_near(v.energy[RB_ENERGY_DRAG], -4, 0);
	assert_vectors(v.momentum[RB_MOMENTUM_DRAG][0], -1, 0, 0, 0);
	assert_vectors(v.momentum[RB_MOMENTUM_DRAG][1], 0, 0, -2, 0);
}

static void a_ledger_goes_through_a_checkpoint_whole(void **state)
{
	struct rb_ledger ledger = {.kept = true}, back = {0};
	struct rb_frame_numbers now = {.kinetic_energy = 1,
	                               .potential_energy = 2,
	                               .momentum = {3, 4, 5},
	                               .angular_momentum = {6, 7, 8}};

	(void)state;
	rb_ledger_start(&ledger, &now);
	for (int i = 0; i < 2; i++) { /* the second finds rounding to keep */
		struct rb_entries all = {.causes = ~0u};
		for (int k = 0; k < RB_ENTRIES; k++)
			all.row[k] = i ? 0x1p-60 * (k + 1) : k + 1;
		rb_ledger_enter(&ledger, &all);
	}
	struct rb_pack out = {0};
	rb_fields_pack(rb_ledger_fields(), &ledger, 1, NULL, &out);
	struct rb_pack in = {.loading = true, .bytes = out.bytes, .size = out.size};
	rb_fields_pack(rb_ledger_fields(), &back, 1, NULL, &in);
	assert_false(in.failed);
	assert_int_equal(in.at, in.size);
	assert_true(back.kept);
	now.kinetic_energy = 100, now.momentum.y = 100;
	const struct rb_ledger_values a = rb_ledger_values(&ledger, &now);
	const struct rb_ledger_values b = rb_ledger_values(&back, &now);
	assert_memory_equal(&a, &b, sizeof a);
	assert_memory_equal(ledger.rest, back.rest, sizeof back.rest);
	rb_pack_release(&out);
}

static void causes_have_names_of_their_own(void **state)
{
	(void)state;
	for (int k = 0; k <= RB_ENERGY_CAUSES; k++)
		for (int j = 0; j < k; j++)
			assert_string_not_equal(rb_ledger_energy_name(k), rb_ledger_energy_name(j));
	for (int k = 0; k <= RB_MOMENTUM_CAUSES; k++)
		for (int j = 0; j < k; j++)
			assert_string_not_equal(rb_ledger_momentum_name(k),
			                        rb_ledger_momentum_name(j));
	assert_string_equal(rb_ledger_energy_name(RB_ENERGY_CAUSES), "unexplained");
	assert_string_equal(rb_ledger_momentum_name(RB_MOMENTUM_CAUSES), "unexplained");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_cause_is_kept_by_itself_and_together_they_explain_the_change),
		cmocka_unit_test(small_entries_are_not_lost_beside_large_ones),
		cmocka_unit_test(an_impulse_turns_about_the_origin),
		cmocka_unit_test(entries_are_added_with_their_share),
		cmocka_unit_test(a_ledger_goes_through_a_checkpoint_whole),
		cmocka_unit_test(causes_have_names_of_their_own),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
