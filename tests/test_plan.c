/* SPDX-License-Identifier: MIT */
/* src/sweep/plan.c: the points of a sweep, and how they are written down */
#include "support.h"

#include <inttypes.h>

#include "math/random.h"
#include "sweep/plan.h"

static struct rb_plan_wish wish_of(const char *const *params, int count)
{
	return (struct rb_plan_wish){.version = "1.2",
	                             .scene = "s.lua",
	                             .params = params,
	                             .param_count = count,
	                             .seeds = 1,
	                             .base_seed = 9};
}

static const struct rb_source_file file = {
	.name = "s.lua", .text = "x", .size_bytes = 1, .sha256 = "0123456789abcdef"};

/* The next cell as RFC 4180 has it, into `out`; what is behind its comma, NULL: it is the last. */
static const char *take_cell(const char *at, char *out)
{
	const bool quoted = *at == '"';

	for (at += quoted; *at && (quoted || *at != ','); at++) {
		if (quoted && *at == '"' && *++at != '"')
			break;
		*out++ = *at;
	}
	*out = '\0';
	if (*at && *at != ',')
		fail_msg("'%s' behind a cell", at);
	return *at ? at + 1 : NULL;
}

/* The last parameter changes first, and seeds before it. */
static void combinations_come_in_the_order_of_an_odometer(void **state)
{
	const char *const params[] = {"a=x,y", "b=1:3:1", "c=u,v"};
	struct rb_plan_wish wish = wish_of(params, 3);
	char out[RB_AXIS_NUMBER_SIZE];
	struct rb_plan plan;
	struct rb_error err;
	uint64_t index = 0;

	(void)state;
	wish.seeds = 2;
	assert_ok(rb_plan_init(&plan, &wish, &file, 1, &err));
	assert_int_equal(plan.count, 24);
	for (int a = 0; a < 2; a++)
		for (int b = 1; b <= 3; b++)
			for (int c = 0; c < 2; c++)
				for (int seed = 0; seed < 2; seed++, index++) {
					assert_int_equal(*rb_plan_value(&plan, index, 0, out),
					                 "xy"[a]);
					assert_int_equal(atoi(rb_plan_value(&plan, index, 1, out)),
					                 b);
					assert_int_equal(*rb_plan_value(&plan, index, 2, out),
					                 "uv"[c]);
					assert_int_equal(rb_plan_seed(&plan, index),
					                 rb_sample_seed(9, index));
				}
	rb_plan_release(&plan);
	rb_plan_release(&plan);
}

/* Whatever stands in names and values, a row has its cells, and room for them. */
static void rows_read_back_cell_by_cell(void **state)
{
	static const char bytes[] = "a1\"# =;\\'\xc3\xa9";
	char params[3][80], out[RB_AXIS_NUMBER_SIZE], cell[400];
	const char *texts[3] = {params[0], params[1], params[2]};
	struct rb_plan plan;
	struct rb_error err;

	(void)state;
	for (uint64_t k = 0; k < 300; k++) {
		for (uint64_t i = 0; i < 3; i++) {
			size_t size = (size_t)snprintf(params[i], 80, "%c", (char)('p' + i));
			const size_t name = rb_random_bits(1, k, 100 * i) % 20,
				     value = rb_random_bits(2, k, 100 * i) % 40;

			for (size_t c = 0; c < name; c++)
				params[i][size++] =
					"q\"# ,"[rb_random_bits(1, k, 100 * i + c + 1) % 5];
			params[i][size++] = '=';
			for (size_t c = 0; c < value; c++)
				params[i][size++] = bytes[rb_random_bits(2, k, 100 * i + c + 1) %
				                          (sizeof bytes - 1)];
			params[i][size] = '\0';
		}
		const struct rb_plan_wish wish = wish_of(texts, 3);
		assert_ok(rb_plan_init(&plan, &wish, &file, 1, &err));
		char *const row = rb_memory_take(plan.row_size, 1); /* its end is watched */
		rb_plan_titles(&plan, row);
		const char *at = take_cell(row, cell);
		assert_string_equal(cell, "index");
		at = take_cell(at, cell);
		assert_string_equal(cell, "seed");
		for (int i = 0; i < 3; i++) {
			assert_non_null(at);
			at = take_cell(at, cell);
			assert_string_equal(cell, plan.axes[i].name);
		}
		assert_null(at);
		rb_plan_row(&plan, 0, row);
		at = take_cell(row, cell);
		assert_string_equal(cell, "0");
		at = take_cell(at, cell);
		assert_true(strtoull(cell, NULL, 10) == rb_plan_seed(&plan, 0));
		for (int i = 0; i < 3; i++) {
			assert_non_null(at);
			at = take_cell(at, cell);
			assert_string_equal(cell, rb_plan_value(&plan, 0, i, out));
		}
		assert_null(at);
		rb_memory_free(row);
		rb_plan_release(&plan);
	}
}

static bool has_line(const struct rb_plan *plan, const char *line)
{
	for (int i = 0; i < plan->line_count; i++)
		if (strcmp(plan->lines[i], line) == 0)
			return true;
	return false;
}

static void the_head_tells_all_that_was_asked_for(void **state)
{
	const char *const params[] = {"mu=0:1:0.5", "e=0.2:0.9"}, *const words[] = {
									  "--duration=3",
									  "--method=located"};
	struct rb_plan_wish wish = wish_of(params, 2);
	const struct rb_source_file files[] = {file, {.name = "rbsim.pile", .sha256 = "ff"}};
	struct rb_plan plan;
	struct rb_error err;

	(void)state;
	wish.sample = "latin:17";
	wish.seeds = 3;
	wish.words = words;
	wish.word_count = 2;
	wish.records = true;
	assert_ok(rb_plan_init(&plan, &wish, files, 2, &err));
	assert_int_equal(plan.count, 51);
	assert_string_equal(plan.lines[0], "# sweep of rbsim 1.2");
	static const char *const lines[] = {"# scene s.lua",
	                                    "# file 0123456789abcdef s.lua",
	                                    "# file ff rbsim.pile",
	                                    "# param mu=0:1:0.5",
	                                    "# param e=0.2:0.9",
	                                    "# sample latin:17",
	                                    "# seeds 3",
	                                    "# seed 9",
	                                    "# option --duration=3",
	                                    "# option --method=located",
	                                    "# recordings yes",
	                                    "# films no",
	                                    "# points 51"};
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
		if (!has_line(&plan, lines[i]))
			fail_msg("no '%s'", lines[i]);
	assert_int_equal(plan.line_count, 1 + sizeof lines / sizeof *lines);
	rb_plan_release(&plan);
}

static void labels_name_the_point_and_are_cut(void **state)
{
	const char *const params[] = {"mu=0.25,0.5", "e=a,b"};
	struct rb_plan_wish wish = wish_of(params, 2);
	char label[80], wanted[80], small[9];
	struct rb_plan plan;
	struct rb_error err;

	(void)state;
	assert_ok(rb_plan_init(&plan, &wish, &file, 1, &err));
	assert_string_equal(rb_plan_label(&plan, 3, label, sizeof label), "mu=0.5, e=b");
	for (size_t size = 1; size < 14; size++) {
		memset(label, '?', sizeof label);
		rb_plan_label(&plan, 3, label, size);
		assert_int_equal(strlen(label), size - 1 < 11 ? size - 1 : 11);
		assert_memory_equal(label, "mu=0.5, e=b", strlen(label));
	}
	rb_plan_release(&plan);

	wish.seeds = 2;
	assert_ok(rb_plan_init(&plan, &wish, &file, 1, &err));
	snprintf(wanted, sizeof wanted, "mu=0.5, e=b, seed %" PRIu64, rb_plan_seed(&plan, 7));
	assert_string_equal(rb_plan_label(&plan, 7, label, sizeof label), wanted);
	assert_string_equal(rb_plan_label(&plan, 7, small, sizeof small), "mu=0.5, ");
	rb_plan_release(&plan);

	wish = wish_of(NULL, 0);
	wish.seeds = 3;
	assert_ok(rb_plan_init(&plan, &wish, &file, 1, &err));
	assert_int_equal(plan.count, 3);
	snprintf(wanted, sizeof wanted, "seed %" PRIu64, rb_plan_seed(&plan, 2));
	assert_string_equal(rb_plan_label(&plan, 2, label, sizeof label), wanted);
	rb_plan_release(&plan);
}

/* With a sample every seed of a point has the same values. */
static void seeds_of_a_point_share_its_values(void **state)
{
	const char *const params[] = {"x=0:1", "k=a,b,c"};
	struct rb_plan_wish wish = wish_of(params, 2);
	char a[RB_AXIS_NUMBER_SIZE], b[RB_AXIS_NUMBER_SIZE];
	struct rb_plan plan;
	struct rb_error err;

	(void)state;
	wish.sample = "latin:6";
	wish.seeds = 4;
	assert_ok(rb_plan_init(&plan, &wish, &file, 1, &err));
	assert_int_equal(plan.count, 24);
	for (uint64_t i = 0; i < 24; i++)
		for (int axis = 0; axis < 2; axis++)
			assert_string_equal(rb_plan_value(&plan, i, axis, a),
			                    rb_plan_value(&plan, i - i % 4, axis, b));
	assert_string_not_equal(rb_plan_value(&plan, 0, 0, a), rb_plan_value(&plan, 4, 0, b));
	rb_plan_release(&plan);
}

static void the_number_of_points_is_bounded(void **state)
{
	const char *const ten[] = {"a=1:10:1", "b=1:1000:1", "c=1:1000:1"},
			  *const control[] = {"--duration=3\n--force"};
	struct rb_plan_wish wish = wish_of(ten, 3);
	struct rb_plan plan;
	struct rb_error err;

	(void)state;
	assert_ok(rb_plan_init(&plan, &wish, &file, 1, &err));
	assert_int_equal(plan.count, RB_PLAN_POINTS_MAX);
	rb_plan_release(&plan);
	wish.seeds = 2;
	assert_int_equal(rb_plan_init(&plan, &wish, &file, 1, &err), RB_ERR_USAGE);
	assert_string_equal(err.text, "the sweep would have 20000000 points (at most 10000000)");
	rb_plan_release(&plan);
	wish.seeds = UINT64_MAX;
	assert_int_equal(rb_plan_init(&plan, &wish, &file, 1, &err), RB_ERR_USAGE);
	rb_plan_release(&plan);

	wish = wish_of(NULL, 0);
	wish.words = control;
	wish.word_count = 1;
	assert_int_equal(rb_plan_init(&plan, &wish, &file, 1, &err), RB_ERR_USAGE);
	assert_string_equal(err.text, "option '--duration' holds a line break or another control "
	                              "character");
	rb_plan_release(&plan);
	wish = wish_of(NULL, 0);
	struct rb_source_file odd = file;
	odd.name = "a\nb.lua";
	assert_int_equal(rb_plan_init(&plan, &wish, &odd, 1, &err), RB_ERR_USAGE);
	assert_string_equal(err.text,
	                    "cannot sweep 'a\nb.lua': its name holds a line break or another "
	                    "control character");
	rb_plan_release(&plan);
	static const char *const samples[] = {"latin:",
	                                      "latin:-1",
	                                      "latin:1x",
	                                      "latin:01",
	                                      "Latin:3",
	                                      "",
	                                      "latin:99999999999999999999999"};
	for (size_t i = 0; i < sizeof samples / sizeof *samples; i++) {
		wish = wish_of(NULL, 0);
		wish.sample = samples[i];
		assert_int_equal(rb_plan_init(&plan, &wish, &file, 1, &err), RB_ERR_USAGE);
		assert_non_null(strstr(err.text, "is not latin:N, with N from 1 to 10000000"));
		rb_plan_release(&plan);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(combinations_come_in_the_order_of_an_odometer),
		cmocka_unit_test(rows_read_back_cell_by_cell),
		cmocka_unit_test(the_head_tells_all_that_was_asked_for),
		cmocka_unit_test(labels_name_the_point_and_are_cut),
		cmocka_unit_test(seeds_of_a_point_share_its_values),
		cmocka_unit_test(the_number_of_points_is_bounded),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
