/* SPDX-License-Identifier: MIT */
/* src/constraint/contact_name: names of contact points, and what methods share of them. */
#include "support.h"

#include "constraint/contact_name.h"
#include "geom/patch.h"

static uint64_t key_of(rb_part a, rb_part b)
{
	return (uint64_t)a << 32 | b;
}

static rb_part rim(int which, int place)
{
	return rb_part_of(RB_PART_RIM, which | place << 1);
}

static const rb_part corner = (rb_part)RB_PART_VERTEX << 24 | 5,
		     edge = (rb_part)RB_PART_EDGE << 24 | 3,
		     floor_part = (rb_part)RB_PART_SURFACE << 24;

static struct rb_contact_name name_of(uint64_t key)
{
	return (struct rb_contact_name){.a = 1, .b = 7, .parts = 0x20003, .key = key};
}

static void names_are_ordered_by_pair_then_parts_then_features(void **state)
{
	const struct rb_contact_name least = name_of(key_of(corner, floor_part));
	struct rb_contact_name more[5];

	(void)state;
	for (int k = 0; k < 5; k++)
		more[k] = least;
	more[0].a++;
	more[1].b++;
	more[2].parts++;
	more[3].key++;
	more[4].half.x = 1;
	for (int k = 0; k < 5; k++) {
		assert_true(rb_contact_name_compare(&least, &more[k]) < 0);
		assert_true(rb_contact_name_compare(&more[k], &least) > 0);
		assert_int_equal(rb_contact_name_is(&least, &more[k]), k == 4);
	}
	/* the earlier decides */
	more[1].parts = 0;
	assert_true(rb_contact_name_compare(&least, &more[1]) < 0);
	assert_int_equal(rb_contact_name_compare(&least, &least), 0);
}

static void points_on_opposite_halves_of_a_rim_are_two(void **state)
{
	struct rb_contact_name x = name_of(key_of(rim(1, 0), floor_part)), y = x;

	(void)state;
	x.half = (rb_vec3){1, 0, 0};
	y.half = (rb_vec3){0.1, 0.9, 0};
	assert_true(rb_contact_name_is(&x, &y));
	y.half.x = -0.1;
	assert_false(rb_contact_name_is(&x, &y));
}

static void swapping_twice_changes_nothing(void **state)
{
	const struct rb_contact_name name = name_of(key_of(corner, edge));
	const struct rb_contact_name swapped = rb_contact_name_swapped(&name);
	const struct rb_contact_name again = rb_contact_name_swapped(&swapped);

	(void)state;
	assert_int_equal(swapped.a, 7);
	assert_int_equal(swapped.b, 1);
	assert_int_equal(swapped.parts, 0x30002);
	assert_true(swapped.key == key_of(edge, corner));
	assert_int_equal(rb_contact_name_compare(&name, &again), 0);
}

static void what_methods_share_has_neither_mark_nor_half(void **state)
{
	const uint64_t plain[] = {0, key_of(corner, floor_part), key_of(edge, edge),
	                          key_of(rim(0, 3), floor_part), key_of(edge, rim(1, 6))};

	(void)state;
	for (size_t k = 0; k < sizeof plain / sizeof *plain; k++) {
		const struct rb_contact_name name = name_of(plain[k]);
		struct rb_contact_name marked = name;

		marked.key |= (uint64_t)6 << RB_CONTACT_KEY_MARK;
		marked = rb_contact_name_shared(&marked);
		assert_int_equal(rb_contact_name_compare(&marked, &name), 0);
	}
}

/*
 * A rim that tilts has one lowest point, whichever half it is counted from; of a flat one places
 * are of no use to others.
 */
static void points_counted_from_a_half_are_of_the_whole_rim(void **state)
{
	(void)state;
	for (int place = 0; place < 3; place++) {
		struct rb_contact_name name = name_of(key_of(rim(1, place), floor_part));

		name.half = (rb_vec3){0, -1, 0};
		assert_true(rb_contact_name_shared(&name).key ==
		            key_of(rim(1, place == 0 ? 0 : RB_CONTACT_ALL_ROUND), floor_part));
	}
}

static void all_points_of_a_rim_on_one_feature_have_one_key_all_round(void **state)
{
	const uint64_t wanted = key_of(floor_part, rim(1, RB_CONTACT_ALL_ROUND));

	(void)state;
	for (int place = 0; place < 16; place++)
		assert_true(rb_contact_key_all_round(key_of(floor_part, rim(1, place))) == wanted);
	assert_false(rb_contact_key_all_round(key_of(floor_part, rim(0, 1))) == wanted);
	assert_false(rb_contact_key_all_round(key_of(edge, rim(1, 1))) == wanted);
	assert_true(rb_contact_key_all_round(key_of(corner, edge)) == 0);
	assert_true(rb_contact_key_all_round(0) == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(names_are_ordered_by_pair_then_parts_then_features),
		cmocka_unit_test(points_on_opposite_halves_of_a_rim_are_two),
		cmocka_unit_test(swapping_twice_changes_nothing),
		cmocka_unit_test(what_methods_share_has_neither_mark_nor_half),
		cmocka_unit_test(points_counted_from_a_half_are_of_the_whole_rim),
		cmocka_unit_test(all_points_of_a_rim_on_one_feature_have_one_key_all_round),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
