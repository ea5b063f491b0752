/* SPDX-License-Identifier: MIT */
#include "app/collect.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "app/json.h"
#include "app/planned.h"
#include "base/error.h"
#include "base/outfile.h"
#include "base/visible.h"
#include "sweep/table.h"

/* All of one call of the verb. */
struct collect {
	const struct rb_options *options;
	struct rb_planned sweep;
	struct rb_table table;
	char output[RB_FOLDER_PATH_SIZE]; /* "": standard output */
	/* from the folder of the output to that of the sweep, with a '/' at its end */
	char way[RB_FOLDER_PATH_SIZE];
	char name[RB_FOLDER_PATH_SIZE + 80];
};

/* Whether the table is wanted as CSV, by option or name. */
static bool is_csv(const struct collect *collect)
{
	const size_t size = strlen(collect->output);

	return collect->options->csv ||
	       (size > 4 && strcmp(collect->output + size - 4, ".csv") == 0);
}

/*
 * The way from one absolute folder to another: up as far as they differ, then down, with a '/' at
 * its end.
 */
static enum rb_status find_way(const char *from, const char *to, char out[RB_FOLDER_PATH_SIZE],
                               struct rb_error *err)
{
	size_t same = 0, used = 0;

	RB_ASSERT(from[0] == '/' && to[0] == '/');
	for (size_t i = 0;; i++) {
		const bool end_from = from[i] == '\0' || from[i] == '/';
		const bool end_to = to[i] == '\0' || to[i] == '/';
		if (end_from && end_to)
			same = i;
		if (from[i] != to[i] || from[i] == '\0')
			break;
	}
	out[0] = '\0';
	for (const char *at = from + same; *at; at++)
		if (*at == '/' && at[1] && used + 4 < RB_FOLDER_PATH_SIZE)
			used += (size_t)snprintf(out + used, RB_FOLDER_PATH_SIZE - used, "../");
	const char *const down = to + same + (to[same] == '/');
	if (used + strlen(down) + 64 >= RB_FOLDER_PATH_SIZE)
		return RB_FAIL(err, RB_ERR_CREATE, "the name '%s' is too long", to);
	snprintf(out + used, RB_FOLDER_PATH_SIZE - used, "%s%s", down, *down ? "/" : "");
	return RB_OK;
}

/* Decides where the table goes, and how recordings are named from there. */
static enum rb_status settle_output(struct collect *collect, struct rb_error *err)
{
	const struct rb_options *const options = collect->options;
	char folder[RB_FOLDER_PATH_SIZE], real[PATH_MAX];
	enum rb_status status = RB_OK;

	if (options->output && strcmp(options->output, "-") == 0 && !options->csv)
		return RB_FAIL(err, RB_ERR_USAGE, "'-o -' prints a table: it wants '--csv'");
	if (options->output && strcmp(options->output, "-") != 0)
		snprintf(collect->output, sizeof collect->output, "%s", options->output);
	else if (!options->csv)
		status = rb_folder_name(collect->sweep.shown, "sweep.h5", collect->output, err);
	if (!status && *collect->output)
		status = rb_outfile_check(collect->output, options->force, err);
	if (status || !*collect->output)
		return status;
	snprintf(folder, sizeof folder, "%s", collect->output);
	char *const slash = strrchr(folder, '/');
	if (slash)
		slash[slash == folder] = '\0';
	if (!realpath(slash ? folder : ".", real))
		return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': there is no such folder",
		               collect->output);
	return find_way(real, collect->sweep.folder, collect->way, err);
}

/* rb_collection.file. */
static const char *file_of(void *user, uint64_t row)
{
	struct collect *const collect = user;

	return rb_folder_path(&collect->sweep.plan, collect->sweep.folder, row, ".h5",
	                      collect->name);
}

/* rb_collection.link. */
static const char *link_of(void *user, uint64_t row)
{
	struct collect *const collect = user;
	char point[RB_FOLDER_PATH_SIZE];

	rb_folder_path(&collect->sweep.plan, NULL, row, ".h5", point);
	snprintf(collect->name, sizeof collect->name, "%s%.60s", collect->way, point);
	return collect->name;
}

/* Writes the table as CSV. */
static enum rb_status write_csv(const struct collect *collect, struct rb_error *err)
{
	struct rb_outfile out;

	if (!*collect->output) {
		rb_table_print_csv(&collect->table, stdout);
		return RB_OK;
	}
	const enum rb_status status = rb_outfile_open(&out, collect->output,
	                                              collect->options->force, err);
	if (status)
		return status;
	rb_table_print_csv(&collect->table, out.file);
	return rb_outfile_publish(&out, err);
}

/* Writes the table in the form that is wanted. */
static enum rb_status write_all(struct collect *collect, uint64_t *linked, struct rb_error *err)
{
	const struct rb_hdf5_module *module;
	const struct rb_collection collection = {.path = collect->output,
	                                         .replace = collect->options->force,
	                                         .version = RB_VERSION,
	                                         .scene = collect->sweep.plan.scene,
	                                         .table = &collect->table,
	                                         .file = file_of,
	                                         .link = link_of,
	                                         .user = collect};

	if (is_csv(collect))
		return write_csv(collect, err);
	const enum rb_status status = rb_module_hdf5(&module, err);
	return status ? status : module->collect(&collection, linked, err);
}

/* Prints what was collected. Column 2 is the state (sweep/table). */
static void tell(const struct collect *collect, uint64_t linked)
{
	const uint64_t points = collect->table.rows;
	struct rb_json json = {.file = stdout};
	uint64_t done = 0;

	RB_ASSERT(collect->table.column_count > 2);
	for (uint64_t i = 0; i < points; i++)
		done += strcmp(collect->table.columns[2].texts[i], "done") == 0;
	if (collect->options->json) {
		rb_json_open(&json, NULL, '{');
		rb_json_text(&json, "sweep", collect->sweep.shown);
		rb_json_text(&json, "output", collect->output);
		rb_json_count(&json, "points", points);
		rb_json_count(&json, "done", done);
		rb_json_count(&json, "recordings", linked);
		rb_json_count(&json, "exit_status", 0);
		rb_json_close(&json, '}');
		putchar('\n');
	} else if (!collect->options->quiet && *collect->output) {
		rb_print(stdout, "%s: %" PRIu64 " %s, %" PRIu64 " done", collect->output, points,
		         rb_text_plural(points, "point", "points"), done);
		if (!is_csv(collect))
			rb_print(stdout, ", %" PRIu64 " %s", linked,
			         rb_text_plural(linked, "recording", "recordings"));
		putchar('\n');
	}
}

int rb_collect_main(const struct rb_options *options)
{
	struct collect collect = {.options = options};
	struct rb_error err;
	uint64_t linked = 0;
	int exit_code = 0;
	enum rb_status status = rb_planned_open(&collect.sweep, options, options->operand[0], &err);

	if (!status)
		status = settle_output(&collect, &err);
	if (!status && options->csv && options->json && !*collect.output)
		status = RB_FAIL(&err, RB_ERR_USAGE, "'--csv' and '--json' cannot both be printed");
	if (!status)
		status = rb_table_init(&collect.table, collect.sweep.folder, &collect.sweep.plan,
		                       &err);
	if (!status)
		status = write_all(&collect, &linked, &err);
	if (status)
		exit_code = rb_app_refuse(options, &err);
	else
		tell(&collect, linked);
	rb_table_release(&collect.table);
	rb_planned_release(&collect.sweep);
	return rb_app_finish(options, exit_code);
}
