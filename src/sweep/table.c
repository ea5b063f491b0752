/* SPDX-License-Identifier: MIT */
/*
 * Built in one pass over the points, by columns: the fixed ones of a point first, then parameters,
 * then results, then expectations, whose columns appear as the runs are read, since only runs know
 * them. Columns of expectations are found by name in linear time; there are few, and the same scene
 * asks the same ones in every run.
 */
#include "sweep/table.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "sweep/status.h"
#include "sweep/point_report.h"

/*
 * NAME_SIZE: a column's name in HDF5 and CSV, longer texts are cut. EXPECTATIONS_MAX: bounds the
 * number of columns, each of which has all rows.
 */
enum { NAME_SIZE = 200, EXPECTATIONS_MAX = 1000 };
/* As in sweep/point.c: more is not a result. */
static const size_t result_bytes_max = (size_t)64 << 20;

/* Numbers that a run tells at its end, and the object in which they are; NULL: the top level. */
static const struct {
	const char *name, *key, *object, *units;
} told[] = {
	{"frames", "frames", NULL, NULL},
	{"time", "time", NULL, "s"},
	{"wall_time", "wall_time", NULL, "s"},
	{"collisions", "collisions", NULL, NULL},
	{"rollbacks", "rollbacks", NULL, NULL},
	{"substeps", "substeps", NULL, NULL},
	{"smallest_step", "smallest_step", NULL, "s"},
	{"stepped", "stepped", NULL, "s"},
	{"max_penetration", "max_penetration", NULL, "m"},
	{"kinetic_energy_max", "kinetic_energy_max", NULL, "J"},
	{"energy_drift", "energy_drift", NULL, "J"},
	{"momentum_drift", "momentum_drift", NULL, "kg m/s"},
	{"angular_momentum_drift", "angular_momentum_drift", NULL, "kg m^2/s"},
	{"kinetic_energy", "kinetic_energy", "last", "J"},
	{"potential_energy", "potential_energy", "last", "J"},
};
enum { TOLD_COUNT = sizeof told / sizeof *told };

static enum rb_status no_memory(struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot collect the sweep: out of memory");
}

/*
 * Appends a column for all rows with a name of its own, of texts (NULL at first) or of numbers (NAN
 * at first). NULL: no memory; rb_table_release frees what was made. Pointers to other columns
 * become invalid.
 */
static struct rb_table_column *add_column(struct rb_table *table, const char *group,
                                          const char *name, bool texts)
{
	struct rb_table_column *const grown = rb_memory_grow(
		table->columns, (size_t)table->column_count, (size_t)table->column_count + 1,
		sizeof *grown);

	if (!grown)
		return NULL;
	table->columns = grown;
	struct rb_table_column *const column = &grown[table->column_count++];
	*column = (struct rb_table_column){.group = group, .name = rb_memory_copy_text(name)};
	if (texts)
		column->texts = rb_memory_take((size_t)table->rows + 1, sizeof *column->texts);
	else
		column->numbers = rb_memory_take((size_t)table->rows + 1, sizeof *column->numbers);
	for (uint64_t i = 0; column->numbers && i < table->rows; i++)
		column->numbers[i] = (double)NAN;
	return column->name && (column->texts || column->numbers) ? column : NULL;
}

/* The column of that group and name; NULL: there is none. The names of two groups may be equal. */
static struct rb_table_column *column_named(struct rb_table *table, const char *group,
                                            const char *name)
{
	for (int i = 0; i < table->column_count; i++)
		if (strcmp(table->columns[i].group, group) == 0 &&
		    strcmp(table->columns[i].name, name) == 0)
			return &table->columns[i];
	return NULL;
}

/* ---- parameters ---- */

/* Whether all of the text is a finite number, which goes to `*value`. */
static bool is_number(const char *text, double *value)
{
	char *end;

	*value = strtod(text, &end);
	return end != text && *end == '\0' && isfinite(*value);
}

/*
 * Adds the column of a parameter: of numbers where every value is one, else of texts, so that
 * "on,off,2" stays as it was given.
 */
static enum rb_status take_parameter(struct rb_table *table, const struct rb_plan *plan, int axis,
                                     struct rb_error *err)
{
	char number[RB_AXIS_NUMBER_SIZE];
	bool numbers = true;
	double value;

	RB_ASSERT(axis >= 0 && axis < plan->axis_count);
	for (uint64_t i = 0; i < table->rows && numbers; i++)
		numbers = is_number(rb_plan_value(plan, i, axis, number), &value);
	struct rb_table_column *const column = add_column(table, "parameters",
	                                                  plan->axes[axis].name, !numbers);
	if (!column)
		return no_memory(err);
	for (uint64_t i = 0; i < table->rows; i++) {
		const char *const text = rb_plan_value(plan, i, axis, number);
		if (numbers)
			(void)is_number(text, &column->numbers[i]);
		else if (!(column->texts[i] = rb_memory_copy_text(text)))
			return no_memory(err);
	}
	return RB_OK;
}

/* ---- results ---- */

/*
 * Reads the expectations of a result into three columns for each text, made when first met; runs
 * without them keep NAN. A scene may ask several under one text, as of each of its bodies: the
 * first of them that fails stands for all.
 */
static enum rb_status take_expectations(struct rb_table *table, uint64_t row, const char *json,
                                        struct rb_error *err)
{
	static const char *const parts[] = {"ok", "measured", "bound"};

	RB_ASSERT(row < table->rows);
	for (int k = 0; k < EXPECTATIONS_MAX; k++) {
		const char *const one = rb_point_report_expectation(json, k);
		char text[NAME_SIZE], name[NAME_SIZE + 16];
		if (!one)
			break;
		rb_point_report_text(one, "text", text, sizeof text);
		snprintf(name, sizeof name, "%s: %s", text, parts[0]);
		const struct rb_table_column *const ok = column_named(table, "expectations", name);
		if (ok && ok->numbers[row] == 0)
			continue;
		for (int i = 0; i < 3; i++) {
			snprintf(name, sizeof name, "%s: %s", text, parts[i]);
			struct rb_table_column *column = column_named(table, "expectations", name);
			if (!column)
				column = add_column(table, "expectations", name, false);
			if (!column)
				return no_memory(err);
			column->numbers[row] = rb_point_report_number(one, parts[i]);
		}
	}
	return RB_OK;
}

/*
 * A column of numbers by name, made when first met, with its units. A result of the scene that has
 * the name of one of `told`, a parameter or a number of the point is told apart: a table has no
 * groups.
 */
static struct rb_table_column *measure_column(struct rb_table *table, const char *group,
                                              const char *name, const char *json)
{
	char own[NAME_SIZE + 16], units[RB_COLUMN_UNITS_SIZE];
	bool taken = column_named(table, "points", name) || column_named(table, "parameters", name);

	for (int i = 0; i < TOLD_COUNT; i++)
		taken = taken || strcmp(told[i].name, name) == 0;
	taken = taken && strcmp(group, "results") == 0;
	snprintf(own, sizeof own, "%s%s", name, taken ? ": result" : "");
	struct rb_table_column *column = column_named(table, group, own);
	if (!column)
		column = add_column(table, group, own, false);
	if (column && !column->units) {
		rb_point_report_text(json, "unit", units, sizeof units);
		column->units = rb_memory_copy_text(units);
	}
	return column && column->units ? column : NULL;
}

/* Reads the scene's results, a column each, and its probes, three columns each. */
static enum rb_status take_measures(struct rb_table *table, uint64_t row, const char *json,
                                    struct rb_error *err)
{
	static const char *const parts[] = {"last", "smallest", "largest"};
	char name[NAME_SIZE], own[NAME_SIZE + 16];

	RB_ASSERT(row < table->rows);
	for (const char *at = NULL;
	     (at = rb_point_report_member(json, "results", at, name, sizeof name)) != NULL;) {
		struct rb_table_column *const column = measure_column(table, "results", name, at);
		if (!column)
			return no_memory(err);
		column->numbers[row] = rb_point_report_number(at, "value");
	}
	for (const char *at = NULL;
	     (at = rb_point_report_member(json, "probes", at, name, sizeof name)) != NULL;)
		for (int i = 0; i < 3; i++) {
			snprintf(own, sizeof own, "%s: %s", name, parts[i]);
			struct rb_table_column *const column = measure_column(table, "probes", own,
			                                                      at);
			if (!column)
				return no_memory(err);
			column->numbers[row] = rb_point_report_number(at, parts[i]);
		}
	return RB_OK;
}

/*
 * Reads the numbers of `told` into their columns, which rb_table_init has made; absent ones become
 * NAN.
 */
static void take_numbers(struct rb_table *table, uint64_t row, const char *json)
{
	RB_ASSERT(row < table->rows);
	for (int i = 0; i < TOLD_COUNT; i++) {
		struct rb_table_column *const column = column_named(table, "results", told[i].name);
		const char *const from = told[i].object
		                                 ? rb_point_report_value(json, told[i].object)
		                                 : json;
		RB_ASSERT(column != NULL);
		if (from)
			column->numbers[row] = rb_point_report_number(from, told[i].key);
	}
}

/*
 * Fills all columns of a row from the files of the point. A run that has not ended has only the
 * columns of group "points".
 */
static enum rb_status take_row(struct rb_table *table, const char *folder,
                               const struct rb_plan *plan, uint64_t row, struct rb_error *err)
{
	struct rb_table_column *const columns = table->columns;
	char path[RB_FOLDER_PATH_SIZE];
	struct rb_point point;
	char *json;
	size_t size;
	enum rb_status status = rb_point_look(folder, plan, row, NULL, &point, err);

	RB_ASSERT(row < table->rows && table->column_count >= 5);
	if (status)
		return status;
	/*
	 * the first five columns in the order in which rb_table_init adds them; `columns` is not
	 * used any more once expectations may have moved it
	 */
	columns[0].numbers[row] = (double)row;
	columns[1].texts[row] = rb_memory_take(24, 1);
	columns[2].texts[row] = rb_memory_copy_text(rb_point_state_names[point.state]);
	columns[4].texts[row] = rb_memory_copy_text(point.state_hash);
	if (!columns[1].texts[row] || !columns[2].texts[row] || !columns[4].texts[row])
		return no_memory(err);
	snprintf(columns[1].texts[row], 24, "%" PRIu64, rb_plan_seed(plan, row));
	if (point.state != RB_POINT_DONE && point.state != RB_POINT_FAILED)
		return RB_OK;
	columns[3].numbers[row] = point.exit_code;
	status = rb_folder_read(rb_folder_path(plan, folder, row, ".json", path), result_bytes_max,
	                        &json, &size, err);
	if (status)
		return status;
	take_numbers(table, row, json);
	status = take_measures(table, row, json, err);
	if (!status)
		status = take_expectations(table, row, json, err);
	rb_memory_free(json);
	/* failed expectations or a run that broke off: there is a recording all the same */
	table->has_recording[row] = plan->records &&
	                            (point.state == RB_POINT_DONE || point.exit_code == 1);
	return status;
}

enum rb_status rb_table_init(struct rb_table *table, const char *folder, const struct rb_plan *plan,
                             struct rb_error *err)
{
	enum rb_status status = RB_OK;

	*table = (struct rb_table){.rows = plan->count};
	table->has_recording = rb_memory_take((size_t)plan->count + 1, 1);
	/* the order is known in take_row */
	if (!table->has_recording || !add_column(table, "points", "index", false) ||
	    !add_column(table, "points", "seed", true) ||
	    !add_column(table, "points", "state", true) ||
	    !add_column(table, "points", "exit_status", false) ||
	    !add_column(table, "points", "state_hash", true))
		return no_memory(err);
	for (int i = 0; i < plan->axis_count && !status; i++)
		status = take_parameter(table, plan, i, err);
	for (int i = 0; i < TOLD_COUNT && !status; i++) {
		struct rb_table_column *const column = add_column(table, "results", told[i].name,
		                                                  false);
		if (column && told[i].units)
			column->units = rb_memory_copy_text(told[i].units);
		if (!column || (told[i].units && !column->units))
			return no_memory(err);
	}
	for (uint64_t i = 0; i < plan->count && !status; i++)
		status = take_row(table, folder, plan, i, err);
	return status;
}

void rb_table_release(struct rb_table *table)
{
	for (int i = 0; i < table->column_count; i++) {
		struct rb_table_column *const column = &table->columns[i];
		for (uint64_t k = 0; column->texts && k < table->rows; k++)
			rb_memory_free(column->texts[k]);
		rb_memory_free(column->texts);
		rb_memory_free(column->numbers);
		rb_memory_free(column->name);
		rb_memory_free(column->units);
	}
	rb_memory_free(table->columns);
	rb_memory_free(table->has_recording);
	*table = (struct rb_table){0};
}

/* ---- CSV ---- */

void rb_table_print_cell(FILE *file, const char *text)
{
	const bool quoted = text[strcspn(text, ",\"\r\n")] != '\0';

	if (quoted)
		putc('"', file);
	for (; *text; text++) {
		if (*text == '"')
			putc('"', file);
		putc(*text, file);
	}
	if (quoted)
		putc('"', file);
}

/*
 * The shortest of 15, 16 or 17 significant digits that reads back as the same double; 17 always do.
 */
static void print_number(FILE *file, double value)
{
	char text[40];

	RB_ASSERT(isfinite(value));
	for (int digits = 15; digits <= 17; digits++) {
		snprintf(text, sizeof text, "%.*g", digits, value);
		if (strtod(text, NULL) == value)
			break;
	}
	fputs(text, file);
}

void rb_table_print_csv(const struct rb_table *table, FILE *file)
{
	for (int i = 0; i < table->column_count; i++) {
		if (i > 0)
			putc(',', file);
		rb_table_print_cell(file, table->columns[i].name);
	}
	putc('\n', file);
	for (uint64_t row = 0; row < table->rows; row++) {
		for (int i = 0; i < table->column_count; i++) {
			const struct rb_table_column *const column = &table->columns[i];
			if (i > 0)
				putc(',', file);
			if (column->texts)
				rb_table_print_cell(file,
				                    column->texts[row] ? column->texts[row] : "");
			else if (!isnan(column->numbers[row]))
				print_number(file, column->numbers[row]);
		}
		putc('\n', file);
	}
}
