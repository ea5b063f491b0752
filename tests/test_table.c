/* SPDX-License-Identifier: MIT */
/* src/sweep/table.c: what all runs of a sweep have come to, as columns and as text */
#include "support.h"

#include <inttypes.h>

#include "sweep/table.h"

enum { POINTS = 6 };

/* A sweep of six points, whose runs have told what `ends` says. */
struct sweep {
	char folder[256];
	struct rb_plan plan;
	struct rb_table table;
	struct rb_error err;
};

static const char *const ends[POINTS] = {
	"{\"status\":\"complete\",\"exit_status\":0,\"state_hash\":\"00112233aabbccdd\","
	"\"frames\":61,\"time\":1.5,\"stepped\":true,\"energy_drift\":1e-300,"
	"\"first\":{\"kinetic_energy\":7},\"last\":{\"kinetic_energy\":0.1,\"potential_energy\":-2}"
	","
	"\"expectations\":[{\"text\":\"it falls\",\"ok\":true,\"measured\":3,\"bound\":4}]}\n",
	"{\"status\":\"failed\",\"exit_status\":1,\"frames\":61,\"time\":null,"
	"\"expectations\":[{\"text\":\"it, \\\"too\\\"\",\"ok\":false,\"measured\":5,\"bound\":4},"
	"{\"text\":\"it falls\",\"ok\":true}],"
	"\"results\":{\"mu\":{\"value\":8,\"unit\":\"m\"},"
	"\"state\":{\"value\":9,\"unit\":\"\"},"
	"\"time\":{\"value\":10,\"unit\":\"s\"}}}\n",
	NULL,                                         /* never begun */
	"{\"status\":\"complete\",\"exit_status\":0", /* not whole */
	"{\"status\":\"failed\",\"exit_status\":76,\"error\":\"blew up\",\"collisions\":12,"
	"\"expectations\":[{\"text\":\"each\",\"ok\":true,\"measured\":1,\"bound\":2},"
	"{\"text\":\"each\",\"ok\":false,\"measured\":3,\"bound\":2},"
	"{\"text\":\"each\",\"ok\":false,\"measured\":4,\"bound\":2},"
	"{\"text\":\"each\",\"ok\":true,\"measured\":0,\"bound\":2}]}\n",
	"{\"status\":\"interrupted\",\"exit_status\":75,\"frames\":3}\n"};

static void put(const struct sweep *sweep, uint64_t index, const char *ending, const char *text)
{
	char path[RB_FOLDER_PATH_SIZE];
	FILE *file = fopen(rb_folder_path(&sweep->plan, sweep->folder, index, ending, path), "w");

	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

static void open_sweep(struct sweep *sweep, bool records)
{
	static const char *const params[] = {"mu=0.1:0.3:0.1", "kind=a,\"b\" 1"};
	const struct rb_plan_wish wish = {.version = "1",
	                                  .scene = "s.lua",
	                                  .params = params,
	                                  .param_count = 2,
	                                  .seeds = 1,
	                                  .base_seed = 2,
	                                  .records = records};

	*sweep = (struct sweep){0};
	support_folder(sweep->folder);
	if (rb_plan_init(&sweep->plan, &wish, NULL, 0, &sweep->err) != RB_OK)
		fail_msg("%s", sweep->err.text);
	assert_int_equal(sweep->plan.count, POINTS);
	for (uint64_t k = 0; k < POINTS; k++) {
		if (!ends[k])
			continue;
		put(sweep, k, ".log", "");
		put(sweep, k, ".json", ends[k]);
		if (records)
			put(sweep, k, ".h5", "");
	}
}

static void close_sweep(struct sweep *sweep)
{
	static const char *const endings[] = {".log", ".json", ".h5"};
	char path[RB_FOLDER_PATH_SIZE];

	rb_table_release(&sweep->table);
	for (uint64_t k = 0; k < POINTS; k++)
		for (int i = 0; i < 3; i++)
			unlink(rb_folder_path(&sweep->plan, sweep->folder, k, endings[i], path));
	assert_int_equal(rmdir(sweep->folder), 0);
	rb_plan_release(&sweep->plan);
}

static const struct rb_table_column *column(const struct sweep *sweep, const char *group,
                                            const char *name)
{
	const struct rb_table_column *found = NULL;

	for (int i = 0; i < sweep->table.column_count; i++) {
		const struct rb_table_column *one = &sweep->table.columns[i];
		if (strcmp(one->group, group) != 0 || strcmp(one->name, name) != 0)
			continue;
		assert_null(found);
		found = one;
	}
	if (!found)
		fail_msg("no column '%s' of '%s'", name, group);
	return found;
}

static double number(const struct sweep *sweep, const char *group, const char *name, int row)
{
	const struct rb_table_column *found = column(sweep, group, name);

	assert_non_null(found->numbers);
	return found->numbers[row];
}

static void every_point_has_a_row_with_its_state(void **state)
{
	static const char *const states[POINTS] = {"done",       "failed", "missing",
	                                           "unfinished", "failed", "unfinished"};
	static const double codes[POINTS] = {0, 1, (double)NAN, (double)NAN, 76, (double)NAN};
	struct sweep sweep;
	struct rb_error err;

	(void)state;
	open_sweep(&sweep, true);
	assert_ok(rb_table_init(&sweep.table, sweep.folder, &sweep.plan, &err));
	assert_int_equal(sweep.table.rows, POINTS);
	for (int k = 0; k < POINTS; k++) {
		const double code = number(&sweep, "points", "exit_status", k);
		char seed[24];

		assert_true(number(&sweep, "points", "index", k) == k);
		assert_string_equal(column(&sweep, "points", "state")->texts[k], states[k]);
		assert_true(isnan(codes[k]) ? isnan(code) : code == codes[k]);
		snprintf(seed, sizeof seed, "%" PRIu64, rb_plan_seed(&sweep.plan, (uint64_t)k));
		assert_string_equal(column(&sweep, "points", "seed")->texts[k], seed);
		assert_int_equal(sweep.table.has_recording[k], k < 2);
	}
	assert_string_equal(column(&sweep, "points", "state_hash")->texts[0], "00112233aabbccdd");
	assert_string_equal(column(&sweep, "points", "state_hash")->texts[1], "");
	close_sweep(&sweep);
	open_sweep(&sweep, false);
	assert_ok(rb_table_init(&sweep.table, sweep.folder, &sweep.plan, &err));
	for (int k = 0; k < POINTS; k++)
		assert_false(sweep.table.has_recording[k]);
	close_sweep(&sweep);
}

static void parameters_are_numbers_where_all_their_values_are(void **state)
{
	struct sweep sweep;
	struct rb_error err;

	(void)state;
	open_sweep(&sweep, false);
	assert_ok(rb_table_init(&sweep.table, sweep.folder, &sweep.plan, &err));
	for (int k = 0; k < POINTS; k++) {
		assert_near(number(&sweep, "parameters", "mu", k), (1 + k / 2) / 10.0, 1e-16);
		assert_null(column(&sweep, "parameters", "kind")->numbers);
		assert_string_equal(column(&sweep, "parameters", "kind")->texts[k],
		                    k % 2 ? "\"b\" 1" : "a");
	}
	close_sweep(&sweep);
}

static void results_come_from_where_they_are_told(void **state)
{
	struct sweep sweep;
	struct rb_error err;

	(void)state;
	open_sweep(&sweep, false);
	assert_ok(rb_table_init(&sweep.table, sweep.folder, &sweep.plan, &err));
	assert_true(number(&sweep, "results", "frames", 0) == 61);
	assert_true(number(&sweep, "results", "time", 0) == 1.5);
	assert_true(number(&sweep, "results", "stepped", 0) == 1);
	assert_true(number(&sweep, "results", "energy_drift", 0) == 1e-300);
	/* of the last frame, not of the first */
	assert_true(number(&sweep, "results", "kinetic_energy", 0) == 0.1);
	assert_true(number(&sweep, "results", "potential_energy", 0) == -2);
	assert_true(isnan(number(&sweep, "results", "time", 1)));
	assert_true(isnan(number(&sweep, "results", "kinetic_energy", 1)));
	assert_true(number(&sweep, "results", "collisions", 4) == 12);
	/* one that goes on has no results yet */
	assert_true(isnan(number(&sweep, "results", "frames", 5)));
	assert_true(isnan(number(&sweep, "results", "frames", 2)));

	assert_true(number(&sweep, "expectations", "it falls: ok", 0) == 1);
	assert_true(number(&sweep, "expectations", "it falls: measured", 0) == 3);
	assert_true(number(&sweep, "expectations", "it falls: bound", 0) == 4);
	assert_true(number(&sweep, "expectations", "it falls: ok", 1) == 1);
	assert_true(isnan(number(&sweep, "expectations", "it falls: measured", 1)));
	assert_true(number(&sweep, "expectations", "it, \"too\": ok", 1) == 0);
	/* of several with one text: whether all hold, and the first that does not */
	assert_true(number(&sweep, "expectations", "each: ok", 4) == 0);
	assert_true(number(&sweep, "expectations", "each: measured", 4) == 3);
	/* names of other columns are not used again */
	assert_true(number(&sweep, "results", "mu: result", 1) == 8);
	assert_true(number(&sweep, "results", "state: result", 1) == 9);
	assert_true(number(&sweep, "results", "time: result", 1) == 10);
	assert_true(isnan(number(&sweep, "expectations", "it, \"too\": ok", 0)));
	close_sweep(&sweep);
}

/* Cells of CSV as RFC 4180 has them: how many in the line, its end, and the k-th. */
static char *cell(char *line, int k, char out[100], int *count)
{
	char *at = line;

	for (*count = 0;; (*count)++, at++) {
		const bool quoted = *at == '"';
		size_t used = 0;

		for (at += quoted; quoted || (*at != ',' && *at != '\n'); at++) {
			if (quoted && *at == '"' && *++at != '"')
				break;
			assert_true(used < 99);
			if (*count == k)
				out[used] = *at;
			used++;
		}
		if (*count == k)
			out[used] = '\0';
		if (*at == '\n')
			break;
		assert_int_equal(*at, ',');
	}
	++*count;
	return at + 1;
}

static void the_text_has_every_column_and_row(void **state)
{
	struct sweep sweep;
	struct rb_error err;
	char *text = NULL, out[100];
	size_t size;
	int count;

	(void)state;
	open_sweep(&sweep, false);
	assert_ok(rb_table_init(&sweep.table, sweep.folder, &sweep.plan, &err));
	FILE *file = open_memstream(&text, &size);
	assert_non_null(file);
	rb_table_print_csv(&sweep.table, file);
	fclose(file);
	for (int i = 0; i < sweep.table.column_count; i++) {
		const struct rb_table_column *one = &sweep.table.columns[i];
		char *line = cell(text, i, out, &count);

		assert_int_equal(count, sweep.table.column_count);
		assert_string_equal(out, one->name);
		for (int k = 0; k < POINTS; k++) {
			assert_true(*line);
			line = cell(line, i, out, &count);
			assert_int_equal(count, sweep.table.column_count);
			if (one->texts)
				assert_string_equal(out, one->texts[k]);
			else if (isnan(one->numbers[k]))
				assert_string_equal(out, "");
			else
				assert_true(strtod(out, NULL) == one->numbers[k]);
		}
		assert_int_equal(*line, '\0');
	}
	/* with the digits that it needs, and no more */
	assert_non_null(strstr(text, ",0.1,a,"));
	free(text);
	close_sweep(&sweep);
}

static void any_lack_of_memory_is_told(void **state)
{
	struct sweep sweep;
	enum rb_status status = RB_ERR_MEMORY;
	uint64_t k;

	(void)state;
	open_sweep(&sweep, false);
	for (k = 1; status != RB_OK; k++) {
		rb_memory_fail_at(k);
		status = rb_table_init(&sweep.table, sweep.folder, &sweep.plan, &sweep.err);
		rb_memory_fail_at(0);
		assert_true(status == RB_OK || status == RB_ERR_MEMORY);
		rb_table_release(&sweep.table);
	}
	assert_true(k > 50);
	close_sweep(&sweep);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_point_has_a_row_with_its_state),
		cmocka_unit_test(parameters_are_numbers_where_all_their_values_are),
		cmocka_unit_test(results_come_from_where_they_are_told),
		cmocka_unit_test(the_text_has_every_column_and_row),
		cmocka_unit_test(any_lack_of_memory_is_told),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
