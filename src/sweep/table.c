/* SPDX-License-Identifier: MIT */
#include "sweep/table.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "sweep/status.h"
#include "sweep/told.h"

enum { NAME_SIZE = 200, EXPECTATIONS_MAX = 1000 };
static const size_t result_bytes_max = (size_t)64 << 20;

/* Numbers that a run tells at its end, and the object in which they are; NULL: the top level. */
static const struct {
	const char *name, *key, *object;
} told[] = {
	{"frames", "frames", NULL},
	{"time", "time", NULL},
	{"wall_time", "wall_time", NULL},
	{"collisions", "collisions", NULL},
	{"rollbacks", "rollbacks", NULL},
	{"substeps", "substeps", NULL},
	{"smallest_step", "smallest_step", NULL},
	{"stepped", "stepped", NULL},
	{"max_penetration", "max_penetration", NULL},
	{"kinetic_energy_max", "kinetic_energy_max", NULL},
	{"energy_drift", "energy_drift", NULL},
	{"momentum_drift", "momentum_drift", NULL},
	{"angular_momentum_drift", "angular_momentum_drift", NULL},
	{"kinetic_energy", "kinetic_energy", "last"},
	{"potential_energy", "potential_energy", "last"},
};
enum { TOLD_COUNT = sizeof told / sizeof *told };

static enum rb_status no_memory(struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot collect the sweep: out of memory");
}

/* A column with a name of its own; NULL: no memory. */
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

static bool is_number(const char *text, double *value)
{
	char *end;

	*value = strtod(text, &end);
	return end != text && *end == '\0' && isfinite(*value);
}

/* Numbers where all values are. */
static enum rb_status take_parameter(struct rb_table *table, const struct rb_plan *plan, int axis,
                                     struct rb_error *err)
{
	char number[RB_AXIS_NUMBER_SIZE];
	bool numbers = true;
	double value;

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

static enum rb_status take_expectations(struct rb_table *table, uint64_t row, const char *json,
                                        struct rb_error *err)
{
	static const char *const parts[] = {"ok", "measured", "bound"};

	for (int k = 0; k < EXPECTATIONS_MAX; k++) {
		const char *const one = rb_told_expectation(json, k);
		char text[NAME_SIZE], name[NAME_SIZE + 16];
		if (!one)
			break;
		rb_told_text(one, "text", text, sizeof text);
		for (int i = 0; i < 3; i++) {
			snprintf(name, sizeof name, "%s: %s", text, parts[i]);
			struct rb_table_column *column = column_named(table, "expectations", name);
			if (!column)
				column = add_column(table, "expectations", name, false);
			if (!column)
				return no_memory(err);
			column->numbers[row] = rb_told_number(one, parts[i]);
		}
	}
	return RB_OK;
}

static void take_numbers(struct rb_table *table, uint64_t row, const char *json)
{
	for (int i = 0; i < TOLD_COUNT; i++) {
		struct rb_table_column *const column = column_named(table, "results", told[i].name);
		const char *const from = told[i].object ? rb_told_value(json, told[i].object)
		                                        : json;
		if (from)
			column->numbers[row] = rb_told_number(from, told[i].key);
	}
}

static enum rb_status take_row(struct rb_table *table, const char *folder,
                               const struct rb_plan *plan, uint64_t row, struct rb_error *err)
{
	struct rb_table_column *const columns = table->columns;
	char path[RB_FOLDER_PATH_SIZE];
	struct rb_point point;
	char *json;
	size_t size;
	enum rb_status status = rb_point_look(folder, plan, row, NULL, &point, err);

	if (status)
		return status;
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
	for (int i = 0; i < TOLD_COUNT && !status; i++)
		if (!add_column(table, "results", told[i].name, false))
			return no_memory(err);
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
	}
	rb_memory_free(table->columns);
	rb_memory_free(table->has_recording);
	*table = (struct rb_table){0};
}

/* ---- CSV ---- */

static void print_cell(FILE *file, const char *text)
{
	const bool quoted = text[strcspn(text, ",\"\n")] != '\0';

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

/* The shortest digits that read back as the same number. */
static void print_number(FILE *file, double value)
{
	char text[40];

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
		print_cell(file, table->columns[i].name);
	}
	putc('\n', file);
	for (uint64_t row = 0; row < table->rows; row++) {
		for (int i = 0; i < table->column_count; i++) {
			const struct rb_table_column *const column = &table->columns[i];
			if (i > 0)
				putc(',', file);
			if (column->texts)
				print_cell(file, column->texts[row] ? column->texts[row] : "");
			else if (!isnan(column->numbers[row]))
				print_number(file, column->numbers[row]);
		}
		putc('\n', file);
	}
}
