/* SPDX-License-Identifier: MIT */
/* src/sweep/axis.c, sample.c, plan.c, folder.c, status.c, and the line of src/app/overview.c */
#include "support.h"

#include <sys/stat.h>

#include "app/overview.h"
#include "base/hash.h"
#include "base/memory.h"
#include "sweep/folder.h"
#include "sweep/status.h"
#include "sweep/point_report.h"

/* ---- axes ---- */

/* "a b c": all values of an axis */
static void assert_values(const char *text, const char *wanted)
{
	struct rb_axis axis;
	struct rb_error err;
	char number[RB_AXIS_NUMBER_SIZE], all[1024] = "";

	assert_ok(rb_axis_init(&axis, text, 1000, &err));
	for (uint64_t k = 0; k < axis.count; k++) {
		strcat(all, k > 0 ? " " : "");
		strcat(all, rb_axis_value(&axis, k, number));
	}
	if (strcmp(all, wanted) != 0)
		fail_msg("'%s' has '%s', wanted '%s'", text, all, wanted);
	rb_axis_release(&axis);
}

static void assert_wrong(const char *text, const char *message)
{
	struct rb_axis axis;
	struct rb_error err;

	if (rb_axis_init(&axis, text, 1000, &err) != RB_ERR_USAGE)
		fail_msg("'%s' was accepted", text);
	if (!strstr(err.text, message))
		fail_msg("'%s': said \"%s\", wanted \"%s\"", text, err.text, message);
	rb_axis_release(&axis);
}

static void ranges_count_in_decimals_with_both_ends(void **state)
{
	(void)state;
	assert_values("mu=0:1:0.1", "0 0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9 1");
	assert_values("mu=0:1:0.3", "0 0.3 0.6 0.9");
	assert_values("x=-1:1:0.5", "-1 -0.5 0 0.5 1");
	assert_values("x=1:-1:-1", "1 0 -1");
	assert_values("n=8:64:8", "8 16 24 32 40 48 56 64");
	assert_values("x=1e-9:4e-9:1e-9", "0.000000001 0.000000002 0.000000003 0.000000004");
	assert_values("x=1e-30:3e-30:1e-30", "1e-30 2e-30 3e-30");
	assert_values("x=1e20:3e20:1e20", "1e20 2e20 3e20");
	assert_values("x=100:300:100", "100 200 300");
	assert_values("x=0.05:0.2:.05", "0.05 0.1 0.15 0.2");
	assert_values("x=2:2:1", "2");
	assert_values("x=0:0:1", "0");
	assert_values("x=1.50:2.0:0.250", "1.5 1.75 2");
}

static void lists_hold_texts_numbers_and_ranges(void **state)
{
	(void)state;
	assert_values("e=0.5,0.8", "0.5 0.8");
	assert_values("kind=a,b c,d", "a b c d");
	assert_values("kind=", "");
	assert_values("x=0:2:1,10,20:22:2", "0 1 2 10 20 22");
	assert_values("at=12:30:noon", "12:30:noon");
	assert_values("x=a=b", "a=b");
}

static void what_is_no_range_is_told(void **state)
{
	(void)state;
	assert_wrong("=1", "NAME=VALUES");
	assert_wrong("mu", "NAME=VALUES");
	assert_wrong("mu=0:1:0", "does not lead from 0 to 1");
	assert_wrong("mu=0:1:-0.1", "does not lead");
	assert_wrong("mu=1:0:0.1", "does not lead");
	assert_wrong("mu=0:1:1e-4", "more than 1000 values");
	assert_wrong("mu=0:1:1e-300", "too long a way");
	assert_wrong("mu=0:1:0.12345678901234567891", "more than 18 digits");
	assert_wrong("mu=0,,1", "empty value");
	assert_wrong("mu=0:1,5", "without a step");
	assert_wrong("mu=1:1", "must rise");
	assert_wrong("mu=1\n2", "control character");
}

/* ---- plans ---- */

static struct rb_plan_wish wish_of(const char *const *params, int count)
{
	return (struct rb_plan_wish){.version = "1",
	                             .scene = "s.lua",
	                             .params = params,
	                             .param_count = count,
	                             .seeds = 1,
	                             .base_seed = 7,
	                             .records = true};
}

static struct rb_source_file scene_file(const char *text)
{
	struct rb_source_file file = {.name = "s.lua", .text = text, .size_bytes = strlen(text)};

	rb_hash_sha256(text, file.size_bytes, file.sha256);
	return file;
}

static void a_grid_has_every_combination_once(void **state)
{
	const char *const params[] = {"a=1,2,3", "b=0:1:0.5"};
	struct rb_plan_wish wish = wish_of(params, 2);
	struct rb_plan plan;
	struct rb_error err;
	int seen[3][3] = {{0}};
	char label[64], a[RB_AXIS_NUMBER_SIZE], b[RB_AXIS_NUMBER_SIZE];

	(void)state;
	wish.seeds = 4;
	assert_ok(rb_plan_init(&plan, &wish, NULL, 0, &err));
	assert_int_equal(plan.count, 36);
	for (uint64_t i = 0; i < plan.count; i++) {
		const int x = atoi(rb_plan_value(&plan, i, 0, a)) - 1;
		const int y = (int)(2 * atof(rb_plan_value(&plan, i, 1, b)));
		seen[x][y]++;
		for (uint64_t k = 0; k < i; k++)
			assert_true(rb_plan_seed(&plan, k) != rb_plan_seed(&plan, i));
		assert_true(rb_plan_seed(&plan, i) <= INT64_MAX);
	}
	for (int i = 0; i < 9; i++)
		assert_int_equal(seen[i / 3][i % 3], 4);
	assert_int_equal(
		strncmp(rb_plan_label(&plan, 4, label, sizeof label), "a=1, b=0.5, seed ", 17), 0);
	rb_plan_release(&plan);
}

static void a_latin_hypercube_has_one_point_in_each_part_of_each_axis(void **state)
{
	enum { COUNT = 101 };
	const char *const params[] = {"x=-1:1", "y=0:1", "z=10:100:10"};
	struct rb_plan_wish wish = wish_of(params, 3);
	struct rb_plan plan, again, other;
	struct rb_error err;
	int parts[2][COUNT] = {{0}}, tens[11] = {0}, same = 0;
	char text[RB_AXIS_NUMBER_SIZE], more[RB_AXIS_NUMBER_SIZE];

	(void)state;
	wish.sample = "latin:101";
	assert_ok(rb_plan_init(&plan, &wish, NULL, 0, &err));
	assert_ok(rb_plan_init(&again, &wish, NULL, 0, &err));
	wish.base_seed++;
	assert_ok(rb_plan_init(&other, &wish, NULL, 0, &err));
	assert_int_equal(plan.count, COUNT);
	double product = 0;
	for (uint64_t i = 0; i < COUNT; i++) {
		const double x = atof(rb_plan_value(&plan, i, 0, text));
		const double y = atof(rb_plan_value(&plan, i, 1, text));
		assert_true(x >= -1 && x < 1 && y >= 0 && y < 1);
		parts[0][(int)((x + 1) / 2 * COUNT)]++;
		parts[1][(int)(y * COUNT)]++;
		tens[atoi(rb_plan_value(&plan, i, 2, text)) / 10]++;
		product += x * (y - 0.5);
		for (int axis = 0; axis < 3; axis++)
			assert_string_equal(rb_plan_value(&plan, i, axis, text),
			                    rb_plan_value(&again, i, axis, more));
		same += strcmp(rb_plan_value(&plan, i, 0, text),
		               rb_plan_value(&other, i, 0, more)) == 0;
	}
	for (int k = 0; k < COUNT; k++) {
		assert_int_equal(parts[0][k], 1);
		assert_int_equal(parts[1][k], 1);
	}
	for (int k = 1; k <= 10; k++)
		assert_true(tens[k] >= 9 && tens[k] <= 12); /* 10.1 parts, those at the ends cut */
	/* axes are shuffled apart: their correlation, of deviation 1 / sqrt(101) */
	assert_near(product / COUNT * 6, 0, 0.4);
	assert_int_equal(same, 0);
	rb_plan_release(&plan);
	rb_plan_release(&again);
	rb_plan_release(&other);
}

static void plans_without_sense_are_refused(void **state)
{
	const char *const twice[] = {"a=1", "a=2"}, *const many[] = {"a=1:1000:1", "b=1:1000:1",
	                                                             "c=1:1000:1"};
	const char *const open[] = {"a=1:2"};
	const struct {
		struct rb_plan_wish wish;
		const char *sample, *message;
	} cases[] = {{wish_of(twice, 2), NULL, "'a' is given twice"},
	             {wish_of(many, 3), NULL, "would have 1e+09 points (at most 10000000)"},
	             {wish_of(open, 1), NULL, "a range without a step"},
	             {wish_of(open, 1), "latin:0", "is not latin:N"},
	             {wish_of(open, 1), "latin:10000001", "is not latin:N"},
	             {wish_of(open, 1), "sobol:4", "is not latin:N"}};
	struct rb_plan plan;
	struct rb_error err;

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct rb_plan_wish wish = cases[i].wish;
		wish.sample = cases[i].sample;
		assert_int_equal(rb_plan_init(&plan, &wish, NULL, 0, &err), RB_ERR_USAGE);
		if (!strstr(err.text, cases[i].message))
			fail_msg("said '%s', wanted '%s'", err.text, cases[i].message);
		rb_plan_release(&plan);
	}
}

static void a_plan_survives_any_lack_of_memory(void **state)
{
	const char *const params[] = {"a=1,2", "b=0:1"};
	struct rb_plan_wish wish = wish_of(params, 2);
	const struct rb_source_file file = scene_file("x");
	const uint64_t before = rb_memory_counts().taken - rb_memory_counts().freed;
	struct rb_plan plan;
	struct rb_error err;
	enum rb_status status = RB_ERR_MEMORY;

	(void)state;
	wish.sample = "latin:5";
	for (uint64_t k = 1; status; k++) {
		rb_memory_fail_at(k);
		status = rb_plan_init(&plan, &wish, &file, 1, &err);
		rb_memory_fail_at(0);
		assert_true(status == RB_OK || status == RB_ERR_MEMORY);
		rb_plan_release(&plan);
		assert_int_equal(rb_memory_counts().taken - rb_memory_counts().freed, before);
	}
}

/* ---- folders ---- */

static void put_file(const char *folder, const char *name, const char *text)
{
	char path[RB_FOLDER_PATH_SIZE];

	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *const file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

static void a_plan_comes_back_from_its_folder(void **state)
{
	const char *const params[] = {"a=1,2", "name=x \"y\",#z", "b=0:2:0.5"};
	const char *const words[] = {"--duration=3"};
	struct rb_plan_wish wish = wish_of(params, 3);
	struct rb_source_file files[] = {scene_file("return 1"), scene_file("return 2"),
	                                 scene_file("return 3")};
	struct rb_plan plan, back;
	struct rb_error err;
	char top[256], folder[300], path[400];
	bool there;

	(void)state;
	snprintf(folder, sizeof folder, "%s/new/sweep", support_folder(top));
	files[1].name = "parts.wall";
	files[2].name = "rbsim.lattice";
	wish.words = words;
	wish.word_count = 1;
	wish.seeds = 2;
	assert_ok(rb_plan_init(&plan, &wish, files, 3, &err));
	assert_false(rb_folder_has_plan(folder));
	assert_ok(rb_folder_write(folder, &plan, files, &there, &err));
	assert_false(there);
	assert_true(rb_folder_has_plan(folder));
	const char *const copies[] = {"scene/s.lua", "scene/parts/wall.lua",
	                              "lua/rbsim/lattice.lua"};
	for (int i = 0; i < 3; i++) {
		snprintf(path, sizeof path, "%s/%s", folder, copies[i]);
		assert_int_equal(access(path, F_OK), 0);
	}
	assert_ok(rb_folder_load(folder, &back, "1", &err));
	assert_ok(rb_folder_check(folder, &back, true, &err));
	assert_int_equal(back.count, plan.count);
	assert_string_equal(back.words[0], "--duration=3");
	for (uint64_t i = 0; i < plan.count; i++) {
		char row[400], same[400];
		rb_plan_row(&plan, i, row);
		rb_plan_row(&back, i, same);
		assert_string_equal(row, same);
	}
	rb_plan_release(&back);

	/* another version, a copy that was edited, a row that was edited, another plan */
	assert_int_equal(rb_folder_load(folder, &back, "2", &err), RB_ERR_INPUT);
	assert_non_null(strstr(err.text, "of rbsim 1, this is 2"));
	rb_plan_release(&back);
	put_file(folder, "scene/parts/wall.lua", "return 4");
	assert_int_equal(rb_folder_load(folder, &back, "1", &err), RB_ERR_INPUT);
	assert_non_null(strstr(err.text, "parts/wall.lua' has changed"));
	rb_plan_release(&back);
	struct rb_plan_wish other = wish;
	other.seeds = 3;
	assert_ok(rb_plan_init(&back, &other, files, 3, &err));
	assert_int_equal(rb_folder_check(folder, &back, false, &err), RB_ERR_INPUT);
	assert_non_null(strstr(err.text, "it has '# seeds 2' where this one has '# seeds 3'"));
	/* who comes second is told that there is a plan, and what is not a sweep's stays alone */
	assert_ok(rb_folder_write(folder, &back, files, &there, &err));
	assert_true(there);
	rb_plan_release(&back);
	put_file(top, "mine.txt", "");
	assert_int_equal(rb_folder_write(top, &plan, files, &there, &err), RB_ERR_CREATE);
	assert_non_null(strstr(err.text, "no plan of a sweep"));
	rb_plan_release(&plan);
}

static void damaged_plans_are_refused(void **state)
{
	static const char *const texts[] = {
		"",
		"\n",
		"index,seed\n0,1\n",
		"# sweep of rbsim 1\n",
		"#\n#\n# scene\n",
		"# sweep of rbsim 1\n# scene s\n# seeds 99999999999999999999\n# file x\n",
		"# sweep of rbsim 1\n# scene s\n# seeds 0\n",
		"# sweep of rbsim 1\n# scene s\n# file "
		"0000000000000000000000000000000000000000000000000000000000000000 s\n# seeds 1\n# "
		"param a=1:2\n",
		"# sweep of rbsim 1\n# scene s\n# file "
		"0000000000000000000000000000000000000000000000000000000000000000 s\n# seeds 1\n# "
		"points 7\n"};
	struct rb_plan plan;
	struct rb_error err;
	char folder[256];

	(void)state;
	support_folder(folder);
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		put_file(folder, RB_FOLDER_PLAN, texts[i]);
		const enum rb_status status = rb_folder_load(folder, &plan, "1", &err);
		if (status != RB_ERR_INPUT)
			fail_msg("plan %zu: status %d", i, (int)status);
		rb_plan_release(&plan);
	}
}

/* ---- shares and lists ---- */

static void shares_list_every_point_that_is_due_once(void **state)
{
	const char *const params[] = {"a=0:11:1"};
	struct rb_plan_wish wish = wish_of(params, 1);
	const struct rb_source_file file = scene_file("x");
	struct rb_sweep_status status;
	struct rb_plan plan;
	struct rb_error err;
	char top[256], folder[300], name[80];
	bool there;

	(void)state;
	wish.records = false;
	snprintf(folder, sizeof folder, "%s/sweep", support_folder(top));
	assert_ok(rb_plan_init(&plan, &wish, &file, 1, &err));
	assert_ok(rb_folder_write(folder, &plan, &file, &there, &err));
	struct rb_status_wish ask = {.folder = folder, .plan = &plan};
	assert_ok(rb_status_take(&status, &ask, &err));
	assert_string_equal(status.array, "0-11");
	assert_int_equal(status.points[RB_POINT_MISSING], 12);
	rb_status_release(&status);

	/* 0 and 4 are done, 1 is half written, 5 has failed for good, 6 may mend, 7 stopped at a checkpoint */
	static const struct {
		int index;
		const char *text;
	} ends[] = {
		{0, "{\"status\":\"complete\",\"exit_status\":0}\n"},
		{1, "{\"status\":\"complete\",\"exit_status\":0"},
		{4, "{\"status\":\"complete\",\"exit_status\":0}\n"},
		{5,
	         "{\"status\":\"failed\",\"exit_status\":76,\"error\":\"so \\\"it\\\" went\"}\n"},
		{6, "{\"status\":\"failed\",\"exit_status\":74}\n"},
		{7, "{\"status\":\"interrupted\",\"exit_status\":75}\n"}};
	for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
		snprintf(name, sizeof name, "point-%05d.log", ends[i].index);
		put_file(folder, name, "");
		snprintf(name, sizeof name, "point-%05d.json", ends[i].index);
		put_file(folder, name, ends[i].text);
	}
	assert_ok(rb_status_take(&status, &ask, &err));
	assert_string_equal(status.array, "1-3,6-11");
	assert_int_equal(status.points[RB_POINT_DONE], 2);
	assert_int_equal(status.points[RB_POINT_FAILED], 2);
	assert_int_equal(status.points[RB_POINT_BEGUN], 2);
	assert_int_equal(status.due, 9);
	rb_status_release(&status);
	ask.retry = true;
	assert_ok(rb_status_take(&status, &ask, &err));
	assert_string_equal(status.array, "1-3,5-11");
	rb_status_release(&status);
	ask.retry = false;
	ask.tasks = 4; /* of task 0 only point 8 is left */
	assert_ok(rb_status_take(&status, &ask, &err));
	assert_string_equal(status.array, "0-3");
	assert_int_equal(status.tasks, 4);
	rb_status_release(&status);

	struct rb_point point;
	assert_ok(rb_point_look(folder, &plan, 5, NULL, &point, &err));
	assert_string_equal(point.reason, "so \"it\" went");
	assert_int_equal(point.exit_code, 76);
	rb_plan_release(&plan);
}

static void a_locked_point_is_running_and_is_not_locked_twice(void **state)
{
	const char *const params[] = {"a=0:1:1"};
	struct rb_plan_wish wish = wish_of(params, 1);
	struct rb_plan plan;
	struct rb_point point;
	struct rb_error err;
	char folder[256];
	int first, second;

	(void)state;
	support_folder(folder);
	assert_ok(rb_plan_init(&plan, &wish, NULL, 0, &err));
	assert_ok(rb_point_lock(folder, &plan, 1, &first, &err));
	assert_true(first >= 0);
	assert_ok(rb_point_lock(folder, &plan, 1, &second, &err));
	assert_int_equal(second, -1);
	assert_ok(rb_point_look(folder, &plan, 1, NULL, &point, &err));
	assert_int_equal(point.state, RB_POINT_RUNNING);
	/* a process that is about to be another program still has a copy of it */
	const int copy = dup(first);
	rb_point_unlock(first);
	assert_ok(rb_point_look(folder, &plan, 1, NULL, &point, &err));
	assert_int_equal(point.state, RB_POINT_BEGUN);
	close(copy);
	rb_plan_release(&plan);
}

static void what_a_run_has_told_is_read_as_it_was_meant(void **state)
{
	static const char json[] =
		"{\"error\":\"line 1\\nsays \\\"no\\\" to "
		"C:\\\\n\",\"empty\":\"\",\"n\":2.5,\"yes\":true,\"none\":null}\n";
	char text[64], little[7];

	(void)state;
	rb_point_report_text(json, "error", text, sizeof text);
	assert_string_equal(text, "line 1 says \"no\" to C:\\n");
	rb_point_report_text(json, "error", little, sizeof little);
	assert_string_equal(little, "line 1");
	rb_point_report_text(json, "empty", text, sizeof text);
	assert_string_equal(text, "");
	rb_point_report_text(json, "nothing", text, sizeof text);
	assert_string_equal(text, "");
	rb_point_report_text(json, "n", text, sizeof text);
	assert_string_equal(text, "");
	assert_true(rb_point_report_number(json, "n") == 2.5);
	assert_true(rb_point_report_number(json, "yes") == 1);
	assert_true(isnan(rb_point_report_number(json, "none")));
	assert_true(isnan(rb_point_report_number(json, "nothing")));
}

static void the_overview_fits_and_tells_what_is_left(void **state)
{
	const struct rb_jobs_tally tally = {.total = 1000,
	                                    .done = 250,
	                                    .failed = 2,
	                                    .running = 2,
	                                    .due = 746,
	                                    .ended = 252,
	                                    .wall_s = 25.2};
	char line[256];

	(void)state;
	rb_overview_line(line, sizeof line, 100, &tally);
	assert_string_equal(line, "[=======                       ] 250 of 1000 done, 2 running, 2 "
	                          "failed, 75 s left");
	for (int width = 20; width < 120; width++) {
		rb_overview_line(line, sizeof line, width, &tally);
		assert_true((int)strlen(line) <= width);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ranges_count_in_decimals_with_both_ends),
		cmocka_unit_test(lists_hold_texts_numbers_and_ranges),
		cmocka_unit_test(what_is_no_range_is_told),
		cmocka_unit_test(a_grid_has_every_combination_once),
		cmocka_unit_test(a_latin_hypercube_has_one_point_in_each_part_of_each_axis),
		cmocka_unit_test(plans_without_sense_are_refused),
		cmocka_unit_test(a_plan_survives_any_lack_of_memory),
		cmocka_unit_test(a_plan_comes_back_from_its_folder),
		cmocka_unit_test(damaged_plans_are_refused),
		cmocka_unit_test(shares_list_every_point_that_is_due_once),
		cmocka_unit_test(a_locked_point_is_running_and_is_not_locked_twice),
		cmocka_unit_test(what_a_run_has_told_is_read_as_it_was_meant),
		cmocka_unit_test(the_overview_fits_and_tells_what_is_left),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
