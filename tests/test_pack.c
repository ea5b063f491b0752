/* SPDX-License-Identifier: MIT */
/* src/base/pack.c: values to bytes and back */
#include "support.h"

#include "base/pack.h"

struct thing {
	uint64_t u64;
	uint32_t u32;
	int64_t i64;
	bool yes, no;
	int number;
	double any[3], time[2], finite[2];
	size_t count;
};

static void keep(struct rb_pack *pack, struct thing *thing)
{
	rb_pack_u64(pack, &thing->u64);
	rb_pack_u32(pack, &thing->u32);
	rb_pack_i64(pack, &thing->i64);
	rb_pack_bool(pack, &thing->yes);
	rb_pack_bool(pack, &thing->no);
	rb_pack_int(pack, &thing->number, -5, 5);
	rb_pack_doubles(pack, thing->any, 3);
	rb_pack_times(pack, thing->time, 2);
	rb_pack_finite(pack, thing->finite, 2);
	rb_pack_count(pack, &thing->count, 100, 0);
}

static const struct thing some = {
	.u64 = UINT64_MAX - 3,
	.u32 = 4000000000u,
	.i64 = INT64_MIN,
	.yes = true,
	.number = -5,
	.any = {(double)NAN, -0.0, 5e-324},
	.time = {(double)INFINITY, -1},
	.finite = {1.7976931348623157e308, 3},
	.count = 99,
};

static void assert_same(const struct thing *a, const struct thing *b)
{
	assert_true(a->u64 == b->u64 && a->u32 == b->u32 && a->i64 == b->i64);
	assert_true(a->yes == b->yes && a->no == b->no && a->number == b->number);
	assert_memory_equal(a->any, b->any, sizeof a->any);
	assert_memory_equal(a->time, b->time, sizeof a->time);
	assert_memory_equal(a->finite, b->finite, sizeof a->finite);
	assert_true(a->count == b->count);
}

static void what_is_loaded_is_what_was_saved_to_the_bit(void **state)
{
	struct thing saved = some, loaded = {0};
	struct rb_pack pack = {0};
	struct rb_error err;

	(void)state;
	keep(&pack, &saved);
	assert_ok(rb_pack_status(&pack, "a thing", &err));
	assert_same(&saved, &some); /* saving changes nothing */
	struct rb_pack from = {.loading = true, .bytes = pack.bytes, .size = pack.size};
	keep(&from, &loaded);
	assert_ok(rb_pack_status(&from, "a thing", &err));
	assert_true(from.at == from.size);
	assert_same(&loaded, &some);
	/* again, into the same memory */
	const size_t capacity = pack.capacity, size = pack.size;
	rb_pack_restart(&pack);
	keep(&pack, &saved);
	assert_true(pack.capacity == capacity && pack.size == size);
	rb_pack_release(&pack);
}

static void bytes_that_end_too_early_fail_and_read_as_zeros(void **state)
{
	struct thing saved = some;
	struct rb_pack pack = {0};

	(void)state;
	keep(&pack, &saved);
	for (size_t size = 0; size < pack.size; size++) {
		struct rb_pack from = {.loading = true, .bytes = pack.bytes, .size = size};
		struct thing loaded = some;
		struct rb_error err;

		keep(&from, &loaded);
		assert_int_equal(rb_pack_status(&from, "a thing", &err), RB_ERR_INPUT);
		assert_string_equal(err.text, "a thing can't be right: it ends too early");
		assert_true(from.at <= size);
		assert_true(loaded.count == 0); /* the last one was not there */
	}
	rb_pack_release(&pack);
}

/* `size` bytes are read by one of the calls below. */
static const char *why_of(const void *bytes, size_t size, void (*read)(struct rb_pack *pack))
{
	struct rb_pack from = {
		.loading = true, .bytes = (unsigned char *)(uintptr_t)bytes, .size = size};

	read(&from);
	return from.failed ? from.why : "";
}

static void read_bool(struct rb_pack *pack)
{
	bool value = false;

	rb_pack_bool(pack, &value);
	assert_false(pack->failed && value);
}

static void read_digit(struct rb_pack *pack)
{
	int value = 0;

	rb_pack_int(pack, &value, 1, 9);
	assert_in_range(value, 1, 9); /* also where it has failed */
}

static void read_time(struct rb_pack *pack)
{
	double value = 0;

	rb_pack_times(pack, &value, 1);
}

static void read_finite(struct rb_pack *pack)
{
	double value = 0;

	rb_pack_finite(pack, &value, 1);
}

static void read_count(struct rb_pack *pack)
{
	size_t value = 0;

	rb_pack_count(pack, &value, 1000, 8);
	assert_true(pack->failed ? value == 0 : value <= 1);
}

static void read_too_many(struct rb_pack *pack)
{
	double value = 1;

	rb_pack_doubles(pack, &value, SIZE_MAX / 2);
	assert_true(value == 1);
}

static void values_out_of_their_range_are_refused(void **state)
{
	const unsigned char bytes[] = {0, 1, 2, 255};
	const int32_t numbers[] = {0, 1, 9, 10, -1, INT32_MIN};
	const double doubles[] = {(double)NAN, (double)INFINITY, -(double)INFINITY, 1e308};
	const uint64_t counts[][2] = {{1, 0}, {2, 0}, {1001, 0}, {UINT64_MAX, 0}};

	(void)state;
	for (int i = 0; i < 4; i++)
		assert_string_equal(why_of(&bytes[i], 1, read_bool),
		                    i < 2 ? "" : "neither true nor false");
	for (int i = 0; i < 6; i++)
		assert_string_equal(why_of(&numbers[i], 4, read_digit),
		                    i == 1 || i == 2 ? "" : "a number out of its range");
	for (int i = 0; i < 4; i++) {
		assert_string_equal(why_of(&doubles[i], 8, read_time),
		                    i == 0 ? "not a number" : "");
		assert_string_equal(why_of(&doubles[i], 8, read_finite),
		                    i < 3 ? "a number that is not finite" : "");
	}
	/* 8 bytes are left behind the count: one of 8, not two */
	for (int i = 0; i < 4; i++)
		assert_string_equal(why_of(counts[i], 16, read_count),
		                    i == 0 ? "" : "a count that is too large");
	assert_string_equal(why_of(doubles, 32, read_too_many), "a count that is too large");
}

static void the_first_failure_stays_and_saving_stops(void **state)
{
	struct rb_pack pack = {0};
	struct rb_error err;
	uint64_t value = 7;

	(void)state;
	rb_pack_u64(&pack, &value);
	assert_true(rb_pack_check(&pack, false, "not asked while saving"));
	rb_pack_fail(&pack, "first");
	rb_pack_fail(&pack, "second");
	rb_pack_u64(&pack, &value);
	assert_true(pack.size == 8);
	assert_false(rb_pack_check(&pack, true, "third"));
	assert_int_equal(rb_pack_status(&pack, "it", &err), RB_ERR_INPUT);
	assert_string_equal(err.text, "it can't be right: first");
	rb_pack_restart(&pack);
	assert_ok(rb_pack_status(&pack, "it", &err));
	rb_pack_release(&pack);
	assert_null(pack.bytes);
}

static void running_out_of_memory_is_told_apart(void **state)
{
	struct rb_pack pack = {0};
	struct rb_error err;
	uint64_t value = 7;

	(void)state;
	rb_memory_fail_at(1);
	rb_pack_u64(&pack, &value);
	rb_memory_fail_at(0);
	assert_int_equal(rb_pack_status(&pack, "a checkpoint", &err), RB_ERR_MEMORY);
	assert_string_equal(err.text, "no memory for a checkpoint");
	rb_pack_release(&pack);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_loaded_is_what_was_saved_to_the_bit),
		cmocka_unit_test(bytes_that_end_too_early_fail_and_read_as_zeros),
		cmocka_unit_test(values_out_of_their_range_are_refused),
		cmocka_unit_test(the_first_failure_stays_and_saving_stops),
		cmocka_unit_test(running_out_of_memory_is_told_apart),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
