/* SPDX-License-Identifier: MIT */
/* src/base/field_list.c */
#include "support.h"

#include "base/field_list.h"
#include "base/memory.h"

#include <math.h>
#include <rbsim/math.h>

enum { LIMIT_ITEM = 1, LIMITS };
enum colour { RED, GREEN, BLUE };

#define THING_FIELDS(X)                                                         \
	X(double, time_s, , "s", "of its event", RB_TIME)                       \
	X(rb_vec3, way, , "m", "how far it has come", RB_FINITE)                \
	X(double, any, [2], "1", "may be anything", RB_NUMBER)                  \
	X(uint64_t, key, , "", "its name", RB_ANY_BITS)                         \
	X(int64_t, cell, [2], "", "where it is", RB_LONG_WITHIN(-1, 1ll << 40)) \
	X(int, item, , "", "index", RB_UP_TO(LIMIT_ITEM))                       \
	X(int, partner, , "", "index, -1: none", RB_NONE_UP_TO(LIMIT_ITEM))     \
	X(enum colour, colour, , "", "how it looks", RB_WITHIN(RED, BLUE))      \
	X(bool, on, , "", "whether it is", RB_FLAG)                             \
	X(void *, room, , "", "scratch", RB_DERIVED)                            \
	X(double, last, , "kg", "stands apart from the others", RB_FINITE)
struct thing {
	THING_FIELDS(RB_FIELD_MEMBER)
};
static RB_FIELDS_DECLARE(thing_fields);
static RB_FIELDS_DEFINE(thing_fields, struct thing, THING_FIELDS);

/* What a thing takes without padding and without what is derived. */
enum { THING_BYTES = 8 + 24 + 16 + 8 + 16 + 4 + 4 + 4 + 1 + 8 };

static const int limits[LIMITS] = {[LIMIT_ITEM] = 9};
static int scratch;

static struct thing thing_of(int k)
{
	struct thing thing;

	memset(&thing, 0xa5 + k, sizeof thing);
	thing.time_s = k == 0 ? (double)INFINITY : 0.1 * k;
	thing.way = (rb_vec3){0.3, -k, 1e300};
	thing.any[0] = (double)NAN;
	thing.any[1] = k;
	thing.key = UINT64_MAX - (uint64_t)k;
	thing.cell[0] = -1;
	thing.cell[1] = 1ll << 40;
	thing.item = 9 - k;
	thing.partner = -1 + k;
	thing.colour = (enum colour)(k % 3);
	thing.on = k % 2 == 1;
	thing.room = &scratch;
	thing.last = 1.0 / (k + 1);
	return thing;
}

static void fill(struct thing things[4])
{
	for (int k = 0; k < 4; k++)
		things[k] = thing_of(k);
}

static struct rb_pack reading(const struct rb_pack *saved, size_t size)
{
	return (struct rb_pack){.loading = true, .bytes = saved->bytes, .size = size};
}

static void objects_come_back_field_by_field(void **state)
{
	struct rb_pack saved = {0};
	struct thing things[4], back[4];

	(void)state;
	fill(things);
	memset(back, 0, sizeof back);
	rb_fields_pack(thing_fields(), things, 4, limits, &saved);
	assert_int_equal(saved.size, 4 * THING_BYTES);
	assert_int_equal(rb_fields_bytes(thing_fields()), THING_BYTES);
	struct rb_pack pack = reading(&saved, saved.size);
	assert_non_null(rb_fields_differ(thing_fields(), things, back, 4));
	rb_fields_pack(thing_fields(), back, 4, limits, &pack);
	assert_false(pack.failed);
	assert_int_equal(pack.at, pack.size);
	assert_null(rb_fields_differ(thing_fields(), things, back, 4));
	assert_true(rb_fields_hash(thing_fields(), things, 4, 1) ==
	            rb_fields_hash(thing_fields(), back, 4, 1));
	assert_null(back[3].room);
	rb_pack_release(&saved);
}

static void padding_and_what_is_derived_leave_no_trace(void **state)
{
	struct rb_pack saved = {0}, again = {0};
	struct thing one, other;

	(void)state;
	memset(&one, 0, sizeof one);
	memset(&other, 0xff, sizeof other);
#define X(type, name, dimensions, ...) memcpy(&other.name, &one.name, sizeof other.name);
	THING_FIELDS(X)
#undef X
	other.room = &scratch;
	rb_fields_pack(thing_fields(), &one, 1, limits, &saved);
	rb_fields_pack(thing_fields(), &other, 1, limits, &again);
	assert_int_equal(saved.size, again.size);
	assert_memory_equal(saved.bytes, again.bytes, saved.size);
	assert_true(rb_fields_hash(thing_fields(), &one, 1, 1) ==
	            rb_fields_hash(thing_fields(), &other, 1, 1));
	rb_pack_release(&saved);
	rb_pack_release(&again);
}

/* Saved from the third of four things, then loaded. */
static void assert_refused(const struct thing *third, const char *field)
{
	struct rb_pack saved = {0};
	struct thing things[4];
	struct rb_error err;
	size_t which = 0;

	fill(things);
	things[2] = *third;
	const struct rb_field *bad = rb_fields_bad(thing_fields(), things, 4, limits, &which);
	assert_non_null(bad);
	assert_string_equal(bad->name, field);
	assert_int_equal(which, 2);
	rb_fields_pack(thing_fields(), things, 4, limits, &saved);
	struct rb_pack pack = reading(&saved, saved.size);
	rb_fields_pack(thing_fields(), things, 4, limits, &pack);
	assert_int_equal(rb_pack_status(&pack, "it", &err), RB_ERR_INPUT);
	assert_non_null(strstr(err.text, field));
	/* nothing of what was bad is left, nor of the others */
	for (int k = 0; k < 4; k++) {
		assert_int_equal(things[k].item, 0);
		assert_true(things[k].last == 0);
		assert_ptr_equal(things[k].room, &scratch);
	}
	rb_pack_release(&saved);
}

static void a_field_out_of_its_range_is_refused_by_name(void **state)
{
	struct thing thing;
	const unsigned char two = 2;

	(void)state;
#define REFUSED(field, value) \
	thing = thing_of(2);  \
	thing.field = value;  \
	assert_refused(&thing, name_of(#field))
#define name_of(text) strtok((char[]){text}, ".[")
	REFUSED(time_s, (double)NAN);
	REFUSED(way.z, (double)INFINITY);
	REFUSED(cell[1], (1ll << 40) + 1);
	REFUSED(cell[0], -2);
	REFUSED(item, 10);
	REFUSED(item, -1);
	REFUSED(partner, -2);
	REFUSED(colour, (enum colour)3);
	REFUSED(last, -(double)INFINITY);
#undef name_of
#undef REFUSED
	thing = thing_of(2);
	memcpy(&thing.on, &two, 1);
	assert_refused(&thing, "on");
	struct thing good[4];
	fill(good);
	assert_null(rb_fields_bad(thing_fields(), good, 4, limits, NULL));
}

static void bytes_that_end_within_an_object_read_as_zeros(void **state)
{
	struct rb_pack saved = {0};
	struct thing things[4];

	(void)state;
	fill(things);
	rb_fields_pack(thing_fields(), things, 4, limits, &saved);
	for (size_t size = 0; size < saved.size; size += 7) {
		struct rb_pack pack = reading(&saved, size);

		fill(things);
		rb_fields_pack(thing_fields(), things, 4, limits, &pack);
		assert_true(pack.failed);
		assert_true(things[0].last == 0 && things[3].key == 0);
		assert_int_equal(rb_pack_status(&pack, "it", NULL), RB_ERR_INPUT);
	}
	rb_pack_release(&saved);
}

static void a_difference_is_found_in_any_field_that_is_kept(void **state)
{
	const struct rb_fields *const fields = thing_fields();
	const struct thing thing = thing_of(1);

	(void)state;
	for (int r = 0; r < fields->count; r++)
		for (size_t byte = 0; byte < fields->row[r].size; byte++) {
			const struct rb_field *const row = &fields->row[r];
			struct thing other = thing;

			((unsigned char *)&other)[row->offset + byte] ^= 1;
			const struct rb_field *differs = rb_fields_differ(fields, &thing, &other,
			                                                  1);
			const bool same_hash = rb_fields_hash(fields, &thing, 1, 1) ==
			                       rb_fields_hash(fields, &other, 1, 1);
			assert_ptr_equal(differs, row->kind == RB_FIELD_DERIVED ? NULL : row);
			assert_int_equal(same_hash, row->kind == RB_FIELD_DERIVED);
		}
}

static void saving_without_memory_fails(void **state)
{
	struct rb_pack saved = {0};
	struct thing things[4];

	(void)state;
	fill(things);
	rb_memory_fail_at(1);
	rb_fields_pack(thing_fields(), things, 4, limits, &saved);
	rb_memory_fail_at(0);
	assert_int_equal(rb_pack_status(&saved, "it", NULL), RB_ERR_MEMORY);
	rb_pack_release(&saved);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(objects_come_back_field_by_field),
		cmocka_unit_test(padding_and_what_is_derived_leave_no_trace),
		cmocka_unit_test(a_field_out_of_its_range_is_refused_by_name),
		cmocka_unit_test(bytes_that_end_within_an_object_read_as_zeros),
		cmocka_unit_test(a_difference_is_found_in_any_field_that_is_kept),
		cmocka_unit_test(saving_without_memory_fails),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
