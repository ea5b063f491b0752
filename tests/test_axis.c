/* SPDX-License-Identifier: MIT */
/* src/sweep/axis.c: the values of one parameter, from what the command line says of them */
#include "support.h"

#include <inttypes.h>

#include "math/random.h"
#include "sweep/axis.h"

enum { MOST = 100000 };

/* k * 10^-places as a decimal text, by its digits. */
static const char *decimal(int64_t k, int places, char out[64])
{
	char digits[32];
	int size = snprintf(digits, sizeof digits, "%0*" PRId64, places + 1, k < 0 ? -k : k);

	snprintf(out, 64, "%s%.*s%s%s", k < 0 ? "-" : "", size - places, digits,
	         places > 0 ? "." : "", digits + size - places);
	return out;
}

/* The text of a decimal number times 10^places, exactly; fails where it is no such number. */
static int64_t scaled(const char *text, int places)
{
	const char *at = text + (*text == '-');
	int64_t value = 0;
	int behind = -1;

	for (; *at; at++) {
		if (*at == '.' && behind < 0) {
			behind = 0;
			continue;
		}
		if (*at < '0' || *at > '9')
			fail_msg("'%s' is no decimal number", text);
		value = 10 * value + (*at - '0');
		behind += behind >= 0;
	}
	for (int i = behind > 0 ? behind : 0; i < places; i++)
		value *= 10;
	return *text == '-' ? -value : value;
}

/* All in whole numbers: low + k step, as long as it is not beyond high. */
static void ranges_are_counted_without_rounding(void **state)
{
	char text[300], a[64], b[64], c[64], out[RB_AXIS_NUMBER_SIZE];
	struct rb_axis axis;
	struct rb_error err;

	(void)state;
	for (uint64_t k = 0; k < 400; k++) {
		const int places = (int)(rb_random_bits(1, k, 0) % 10);
		const int64_t low = (int64_t)(rb_random_bits(1, k, 1) % 2000001) - 1000000,
			      size = 1 + (int64_t)(rb_random_bits(1, k, 2) % 20000),
			      step = k % 2 ? size : -size,
			      way = (int64_t)(rb_random_bits(1, k, 3) % 1000000),
			      high = k % 2 ? low + way : low - way;

		snprintf(text, sizeof text, "x=%s:%s:%s", decimal(low, places, a),
		         decimal(high, places, b), decimal(step, places, c));
		if (rb_axis_init(&axis, text, 2000000, &err) != RB_OK)
			fail_msg("%s: %s", text, err.text);
		assert_int_equal(axis.count, way / size + 1);
		for (uint64_t i = 0; i < axis.count; i += 1 + axis.count / 50) {
			const char *value = rb_axis_value(&axis, i, out);

			assert_int_equal(scaled(value, places), low + (int64_t)i * step);
			assert_true(strlen(value) < axis.room);
			/* no zeros that say nothing */
			assert_false(strchr(value, '.') && value[strlen(value) - 1] == '0');
		}
		rb_axis_release(&axis);
	}
}

/* A value reads back as the number whose shortest text it is: 0.3 and not 0.30000000000000004. */
static void values_are_the_doubles_that_a_scene_would_write(void **state)
{
	char out[RB_AXIS_NUMBER_SIZE];
	struct rb_axis axis;
	struct rb_error err;

	(void)state;
	assert_ok(rb_axis_init(&axis, "x=0:1:0.001", MOST, &err));
	assert_int_equal(axis.count, 1001);
	for (uint64_t k = 0; k <= 1000; k++)
		assert_true(strtod(rb_axis_value(&axis, k, out), NULL) == (double)k / 1000);
	rb_axis_release(&axis);

	static const double values[] = {1e-250, 2e-250, 3e-250};
	assert_ok(rb_axis_init(&axis, "x=1e-250:3e-250:1e-250", MOST, &err));
	for (uint64_t k = 0; k < 3; k++)
		assert_true(strtod(rb_axis_value(&axis, k, out), NULL) == values[k]);
	rb_axis_release(&axis);
	assert_ok(rb_axis_init(&axis, "x=-1.5E3:+1500:7.5e2", MOST, &err));
	assert_int_equal(axis.count, 5);
	assert_string_equal(rb_axis_value(&axis, 0, out), "-1500");
	assert_string_equal(rb_axis_value(&axis, 2, out), "0");
	assert_string_equal(rb_axis_value(&axis, 4, out), "1500");
	rb_axis_release(&axis);
}

static void texts_are_kept_as_they_are(void **state)
{
	char out[RB_AXIS_NUMBER_SIZE];
	struct rb_axis axis;
	struct rb_error err;

	(void)state;
	assert_ok(rb_axis_init(&axis, "s=a, b ,1:2:x,-,1:,:1,1:2:3:4", MOST, &err));
	assert_string_equal(axis.name, "s");
	assert_string_equal(axis.text, "s=a, b ,1:2:x,-,1:,:1,1:2:3:4");
	assert_int_equal(axis.count, 7);
	assert_string_equal(rb_axis_value(&axis, 0, out), "a");
	assert_string_equal(rb_axis_value(&axis, 1, out), " b ");
	assert_string_equal(rb_axis_value(&axis, 2, out), "1:2:x");
	assert_string_equal(rb_axis_value(&axis, 3, out), "-");
	assert_string_equal(rb_axis_value(&axis, 4, out), "1:");
	assert_string_equal(rb_axis_value(&axis, 5, out), ":1");
	assert_string_equal(rb_axis_value(&axis, 6, out), "1:2:3:4");
	rb_axis_release(&axis);
	/* numbers that are not ranges stay as they were written */
	assert_ok(rb_axis_init(&axis, "s=1.50,0x1p3,1e400,nan", MOST, &err));
	assert_string_equal(rb_axis_value(&axis, 0, out), "1.50");
	assert_string_equal(rb_axis_value(&axis, 1, out), "0x1p3");
	assert_string_equal(rb_axis_value(&axis, 3, out), "nan");
	rb_axis_release(&axis);
	/* a value that is longer than any number has its room */
	char text[200] = "s=";
	memset(text + 2, 'y', 150);
	assert_ok(rb_axis_init(&axis, text, MOST, &err));
	assert_int_equal(axis.room, 151);
	assert_string_equal(rb_axis_value(&axis, 0, out), text + 2);
	rb_axis_release(&axis);
}

static void a_share_of_the_way_is_one_of_the_values(void **state)
{
	char out[RB_AXIS_NUMBER_SIZE];
	struct rb_axis axis;
	struct rb_error err;
	int seen[5] = {0};

	(void)state;
	assert_ok(rb_axis_init(&axis, "x=10:13:1,last", MOST, &err));
	assert_int_equal(axis.count, 5);
	for (int k = 0; k < 1000; k++) {
		const char *value = rb_axis_at(&axis, k / 1000.0, out);
		const int place = strcmp(value, "last") == 0 ? 4 : atoi(value) - 10;

		assert_int_equal(place, k / 200);
		seen[place]++;
	}
	for (int i = 0; i < 5; i++)
		assert_int_equal(seen[i], 200);
	assert_string_equal(rb_axis_at(&axis, 1 - 0x1p-53, out), "last");
	assert_string_equal(rb_axis_at(&axis, 1, out), "last");
	rb_axis_release(&axis);
}

static void between_two_numbers_all_can_be_drawn(void **state)
{
	char out[RB_AXIS_NUMBER_SIZE];
	struct rb_axis axis;
	struct rb_error err;

	(void)state;
	assert_ok(rb_axis_init(&axis, "x=-2.5:7.5", MOST, &err));
	assert_int_equal(axis.count, 0);
	assert_near(axis.low, -2.5, 0);
	assert_near(axis.high, 7.5, 0);
	assert_string_equal(rb_axis_at(&axis, 0, out), "-2.5");
	assert_string_equal(rb_axis_at(&axis, 0.5, out), "2.5");
	for (uint64_t k = 0; k < 500; k++) {
		const double unit = rb_random_unit(3, 0, k);

		/* what is written is the number itself */
		assert_true(strtod(rb_axis_at(&axis, unit, out), NULL) == -2.5 + unit * 10);
	}
	rb_axis_release(&axis);
}

static void what_makes_no_axis_is_told(void **state)
{
	static const char *const cases[][2] = {
		{"", "is not of the form NAME=VALUES"},
		{"x", "is not of the form NAME=VALUES"},
		{"=1:2:1", "is not of the form NAME=VALUES"},
		{"x=1,", "has an empty value in its list"},
		{"x=,1", "has an empty value in its list"},
		{"x=2:1", "the range must rise (got 2 and 1)"},
		{"x=-1e308:1e308", "the range must rise"}, /* its length is infinite */
		{"x=a,1:2", "has a range without a step in a list"},
		{"x=1:2:0", "a step of 0 does not lead from 1 to 2"},
		{"x=1:2:-0.5", "a step of -0.5 does not lead"},
		{"x=2:1:0.5", "does not lead from 2 to 1"},
		{"x=1:2:0.0000000000000000001", "is too long a way"},
		{"x=1e18:2e18:1e-5", "is too long a way"},
		{"x=1:2:1e-401", "more than 18 digits"},
		{"x=1:1234567890123456789:1", "more than 18 digits"},
		{"x=1:100001:1", "has more than 100000 values"},
		{"x=1:50000:1,1:50001:1", "has more than 100000 values"},
		{"x=a\tb", "holds a line break or another control character"},
	};
	struct rb_axis axis;
	struct rb_error err;

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const enum rb_status status = rb_axis_init(&axis, cases[i][0], MOST, &err);

		assert_int_equal(status, RB_ERR_USAGE);
		if (!strstr(err.text, cases[i][1]))
			fail_msg("'%s': '%s'", cases[i][0], err.text);
		rb_axis_release(&axis);
		rb_axis_release(&axis);
	}
}

static void no_memory_is_told_as_such(void **state)
{
	struct rb_axis axis;
	struct rb_error err;

	(void)state;
	for (uint64_t k = 1; k <= 4; k++) {
		rb_memory_fail_at(k);
		const enum rb_status status = rb_axis_init(&axis, "x=1,2", MOST, &err);
		rb_memory_fail_at(0);
		assert_int_equal(status, RB_ERR_MEMORY);
		assert_non_null(strstr(err.text, "out of memory"));
		rb_axis_release(&axis);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ranges_are_counted_without_rounding),
		cmocka_unit_test(values_are_the_doubles_that_a_scene_would_write),
		cmocka_unit_test(texts_are_kept_as_they_are),
		cmocka_unit_test(a_share_of_the_way_is_one_of_the_values),
		cmocka_unit_test(between_two_numbers_all_can_be_drawn),
		cmocka_unit_test(what_makes_no_axis_is_told),
		cmocka_unit_test(no_memory_is_told_as_such),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
