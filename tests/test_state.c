/* SPDX-License-Identifier: MIT */
/* src/world/state.c: all that a step changes */
#include "support.h"

#include "world/state.h"

enum { BODIES = 5 };

static const rb_features all = RB_FEATURE_ROTATION | RB_FEATURE_PUSHES;

static struct rb_state made(rb_features features)
{
	struct rb_state state;
	struct rb_error err;

	assert_ok(rb_state_init(&state, BODIES, features, &err));
	state.frame = 3;
	state.time_s = 0.25;
	return state;
}

/* Every number another one. */
static void fill(struct rb_state *state, double first)
{
	int count;
	const struct rb_state_column *const column = rb_state_columns(&count);
	double *const columns[] = {state->position, state->velocity, state->orientation,
	                           state->spin,     state->push,     state->twist};

	for (int k = 0; k < count; k++)
		for (int i = 0; columns[k] && i < column[k].columns * BODIES; i++)
			columns[k][i] = first++;
}

static void columns_that_no_feature_needs_are_not_there(void **slot)
{
	struct rb_state state = made(0);

	(void)slot;
	assert_true(state.position && state.velocity);
	assert_true(!state.orientation && !state.spin && !state.push && !state.twist);
	assert_int_equal(rb_state_row_size(&state), 6);
	rb_state_release(&state);
	state = made(RB_FEATURE_ROTATION);
	assert_true(state.orientation && state.spin && !state.push);
	assert_int_equal(rb_state_row_size(&state), 13);
	rb_state_release(&state);
	state = made(all);
	assert_true(state.push && state.twist);
	assert_int_equal(rb_state_row_size(&state), 19);
	rb_state_release(&state);
	assert_null(state.block);
	rb_state_release(&state); /* safe once more */
}

static void the_table_of_columns_agrees_with_the_rows(void **slot)
{
	int count, width = 0;
	const struct rb_state_column *const column = rb_state_columns(&count);
	struct rb_state state = made(all);

	(void)slot;
	for (int k = 0; k < count; k++) {
		assert_true(*column[k].name && *column[k].unit && *column[k].what);
		width += column[k].columns;
	}
	assert_int_equal(width, rb_state_row_size(&state));
	rb_state_release(&state);
}

static void a_copy_has_the_same_hash_and_every_number_counts_in_it(void **slot)
{
	struct rb_state a = made(all), b = made(all);

	(void)slot;
	fill(&a, 1);
	rb_state_copy(&b, &a);
	assert_true(rb_state_hash(&a) == rb_state_hash(&b));
	assert_true(b.frame == a.frame && b.time_s == a.time_s);
	double *const columns[] = {b.position, b.velocity, b.orientation, b.spin, b.push, b.twist};
	const int width[] = {3, 3, 4, 3, 3, 3};
	for (int k = 0; k < 6; k++)
		for (int i = 0; i < width[k] * BODIES; i++) {
			const double kept = columns[k][i];

			columns[k][i] = nextafter(kept, 1e9);
			assert_true(rb_state_hash(&a) != rb_state_hash(&b));
			columns[k][i] = kept;
		}
	assert_true(rb_state_hash(&a) == rb_state_hash(&b));
	rb_state_release(&a);
	rb_state_release(&b);
}

/* Whether callbacks could push is no part of where bodies are. */
static void pushes_of_zero_do_not_show_in_the_hash(void **slot)
{
	struct rb_state with = made(all), without = made(RB_FEATURE_ROTATION);

	(void)slot;
	fill(&with, 1);
	fill(&without, 1);
	assert_true(rb_state_hash(&with) != rb_state_hash(&without));
	memset(with.push, 0, 3 * BODIES * sizeof *with.push);
	memset(with.twist, 0, 3 * BODIES * sizeof *with.twist);
	assert_true(rb_state_hash(&with) == rb_state_hash(&without));
	rb_state_release(&with);
	rb_state_release(&without);
}

static void rows_are_copied_for_the_members_alone(void **slot)
{
	const int member[] = {1, 4};
	struct rb_state a = made(all), b = made(all);

	(void)slot;
	fill(&a, 1);
	fill(&b, 1000);
	rb_state_copy_rows(&b, &a, member, 2);
	for (int i = 0; i < BODIES; i++) {
		const bool is_member = i == 1 || i == 4;

		assert_int_equal(memcmp(a.position + 3 * i, b.position + 3 * i, 24) == 0,
		                 is_member);
		assert_int_equal(memcmp(a.orientation + 4 * i, b.orientation + 4 * i, 32) == 0,
		                 is_member);
		assert_int_equal(memcmp(a.twist + 3 * i, b.twist + 3 * i, 24) == 0, is_member);
	}
	rb_state_release(&a);
	rb_state_release(&b);
}

static void rows_that_are_saved_and_loaded_are_as_before(void **slot)
{
	const int member[] = {3, 0};
	struct rb_state a = made(all);
	double buffer[2 * 19 + 1];

	(void)slot;
	fill(&a, 1);
	const uint64_t hash = rb_state_hash(&a);
	buffer[2 * 19] = -7;
	rb_state_save_rows(&a, member, 2, buffer);
	assert_true(buffer[2 * 19] == -7);
	for (int k = 0; k < 2; k++) {
		a.position[3 * member[k] + 2] = a.spin[3 * member[k]] = -1;
		a.orientation[4 * member[k] + 3] = a.push[3 * member[k]] = -1;
	}
	assert_true(rb_state_hash(&a) != hash);
	rb_state_load_rows(&a, member, 2, buffer);
	assert_true(rb_state_hash(&a) == hash);
	rb_state_release(&a);
}

static void without_memory_there_is_an_error_and_nothing_to_release(void **slot)
{
	struct rb_state state;
	struct rb_error err;

	(void)slot;
	rb_memory_fail_at(1);
	assert_int_equal(rb_state_init(&state, BODIES, all, &err), RB_ERR_MEMORY);
	rb_memory_fail_at(0);
	assert_null(state.block);
	rb_state_release(&state);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(columns_that_no_feature_needs_are_not_there),
		cmocka_unit_test(the_table_of_columns_agrees_with_the_rows),
		cmocka_unit_test(a_copy_has_the_same_hash_and_every_number_counts_in_it),
		cmocka_unit_test(pushes_of_zero_do_not_show_in_the_hash),
		cmocka_unit_test(rows_are_copied_for_the_members_alone),
		cmocka_unit_test(rows_that_are_saved_and_loaded_are_as_before),
		cmocka_unit_test(without_memory_there_is_an_error_and_nothing_to_release),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
