/* SPDX-License-Identifier: MIT */
/*
 * Two passes: sizes first, because a virtual dataset needs its whole shape when it is made; then
 * one virtual dataset for each quantity, whose rows are the datasets of the recordings. Recordings
 * that are shorter, or missing, read as NAN. Names of the files are relative to the collection, so
 * that folder and collection can be moved together.
 */
#include "sink/h5collect.h"

#include "base/error.h"
#include "base/memory.h"
#include "sink/h5input.h"
#include "sink/h5output.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define BODIES "/particles/bodies/"

/* What is linked, and under which name; of bodies also the last frame, as /end/NAME. */
static const struct {
	const char *source, *path, *end, *units;
} views[] = {
	{"/observables/kinetic_energy/time", "/time", NULL, "s"},
	{"/observables/kinetic_energy/value", "/observables/kinetic_energy", NULL, "J"},
	{"/observables/potential_energy/value", "/observables/potential_energy", NULL, "J"},
	{"/observables/momentum/value", "/observables/momentum", NULL, "kg m/s"},
	{"/observables/angular_momentum/value", "/observables/angular_momentum", NULL, "kg m^2/s"},
	{"/observables/max_penetration/value", "/observables/max_penetration", NULL, "m"},
	{"/observables/contacts/value", "/observables/contacts", NULL, NULL},
	{"/observables/collisions/value", "/observables/collisions", NULL, NULL},
	{"/observables/rollbacks/value", "/observables/rollbacks", NULL, NULL},
	{"/observables/substeps/value", "/observables/substeps", NULL, NULL},
	{"/observables/smallest_step/value", "/observables/smallest_step", NULL, "s"},
	{"/observables/stepped/value", "/observables/stepped", NULL, "s"},
	{BODIES "position/value", BODIES "position", "/end/position", "m"},
	{BODIES "orientation/value", BODIES "orientation", "/end/orientation", NULL},
	{BODIES "velocity/value", BODIES "velocity", "/end/velocity", "m/s"},
	{BODIES "angular_velocity/value", BODIES "angular_velocity", "/end/angular_velocity",
         "rad/s"},
};
enum { VIEW_COUNT = sizeof views / sizeof *views, RANK_MAX = 3 };

/* Sizes of a recording's datasets; rank 0: it has none. */
struct sizes {
	int rank[VIEW_COUNT];
	hsize_t size[VIEW_COUNT][RANK_MAX];
};

struct collect {
	const struct rb_collection *collection;
	struct rb_h5 h5;
	struct sizes *sizes; /* owned: [rows] */
	struct sizes most;
	uint64_t linked;
};

/* ---- what the recordings have ---- */

/* Sizes of the datasets of a recording; rank 0 where there is none. */
static void measure(struct sizes *sizes, const char *name)
{
	struct rb_input input;

	if (rb_input_open(&input, name, NULL) == RB_OK)
		for (int i = 0; i < VIEW_COUNT; i++) {
			const hid_t dataset = rb_input_has(&input, views[i].source)
			                              ? H5Dopen2(input.file, views[i].source,
			                                         H5P_DEFAULT)
			                              : -1;
			const hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);
			const int rank = space < 0 ? 0 : H5Sget_simple_extent_ndims(space);
			if (rank >= 1 && rank <= RANK_MAX &&
			    H5Sget_simple_extent_dims(space, sizes->size[i], NULL) == rank &&
			    sizes->size[i][0] > 0)
				sizes->rank[i] = rank;
			rb_h5_done(space);
			rb_h5_done(dataset);
		}
	rb_input_close(&input);
}

/* Measures all recordings, and the largest size of each dataset. */
static void measure_all(struct collect *collect)
{
	const struct rb_collection *const c = collect->collection;

	for (uint64_t row = 0; row < c->table->rows; row++) {
		struct sizes *const one = &collect->sizes[row];
		if (!c->table->has_recording[row])
			continue;
		measure(one, c->file(c->user, row));
		collect->linked += one->rank[0] > 0;
		for (int i = 0; i < VIEW_COUNT; i++) {
			if (collect->most.rank[i] == 0)
				collect->most.rank[i] = one->rank[i];
			for (int k = 0; k < one->rank[i]; k++)
				if (one->size[i][k] > collect->most.size[i][k])
					collect->most.size[i][k] = one->size[i][k];
		}
	}
}

/* ---- tables ---- */

/* Writes the tables of the sweep. */
static void put_tables(struct collect *collect)
{
	const struct rb_table *const table = collect->collection->table;

	rb_h5_attribute_text(&collect->h5, "/", "creator", "rbsim");
	rb_h5_attribute_text(&collect->h5, "/", "version", collect->collection->version);
	rb_h5_attribute_text(&collect->h5, "/", "scene", collect->collection->scene);
	for (int i = 0; i < table->column_count; i++) {
		const struct rb_table_column *const column = &table->columns[i];
		char name[700], path[800];
		snprintf(path, sizeof path, "/%s/%s", column->group,
		         rb_h5_escape(column->name, name, sizeof name));
		if (column->texts)
			rb_h5_texts(&collect->h5, path, (const char *const *)column->texts,
			            table->rows);
		else
			rb_h5_put(&collect->h5, path, RB_H5_F64, (rb_h5_shape){1, {table->rows}},
			          column->numbers);
		if (column->units && *column->units)
			rb_h5_units(&collect->h5, path, column->units);
	}
}

/* ---- views ---- */

/* Maps a recording's dataset, or its last frame, to a row of a view. False: the library failed. */
static bool add_source(struct collect *collect, hid_t properties, hid_t whole, int view, bool last,
                       uint64_t row)
{
	const struct rb_collection *const c = collect->collection;
	const struct sizes *const one = &collect->sizes[row];
	const hsize_t *const size = one->size[view];
	const int rank = one->rank[view], first = last ? 1 : 0;
	hsize_t from[RANK_MAX + 1] = {row}, count[RANK_MAX + 1] = {1}, part[RANK_MAX];
	const hsize_t begin[RANK_MAX] = {last ? size[0] - 1 : 0};

	RB_ASSERT(view >= 0 && view < VIEW_COUNT && row < collect->collection->table->rows);
	for (int k = 0; k < rank; k++)
		part[k] = size[k];
	for (int k = first; k < rank; k++)
		count[1 + k - first] = size[k];
	if (last)
		part[0] = 1;
	const hid_t source = H5Screate_simple(rank, size, NULL);
	const bool right = H5Sselect_hyperslab(source, H5S_SELECT_SET, begin, NULL, part, NULL) >=
	                           0 &&
	                   H5Sselect_hyperslab(whole, H5S_SELECT_SET, from, NULL, count, NULL) >=
	                           0 &&
	                   H5Pset_virtual(properties, whole, c->link(c->user, row),
	                                  views[view].source, source) >= 0;
	rb_h5_done(source);
	return right;
}

/* Makes one view; `last`: of the last frames. Nothing where no recording has such a dataset. */
static void put_view(struct collect *collect, int view, bool last)
{
	const char *const path = last ? views[view].end : views[view].path;
	const double none = (double)NAN;
	const int rank = collect->most.rank[view], first = last ? 1 : 0;
	hsize_t all[RANK_MAX + 1] = {collect->collection->table->rows};

	RB_ASSERT(view >= 0 && view < VIEW_COUNT);
	if (rank == 0 || !path || collect->h5.status)
		return;
	for (int k = first; k < rank; k++)
		all[1 + k - first] = collect->most.size[view][k];
	const hid_t space = H5Screate_simple(rank + 1 - first, all, NULL);
	const hid_t links = rb_h5_link_properties(), properties = rb_h5_dataset_properties();
	bool right = H5Pset_fill_value(properties, H5T_NATIVE_DOUBLE, &none) >= 0;
	for (uint64_t row = 0; row < all[0] && right; row++)
		if (collect->sizes[row].rank[view] == rank)
			right = add_source(collect, properties, space, view, last, row);
	H5Sselect_all(space);
	const hid_t dataset = right ? H5Dcreate2(collect->h5.file, path, H5T_IEEE_F64LE, space,
	                                         links, properties, H5P_DEFAULT)
	                            : -1;
	if (dataset < 0)
		rb_h5_fail(&collect->h5, "make", path);
	rb_h5_done(dataset);
	rb_h5_done(properties);
	rb_h5_done(links);
	rb_h5_done(space);
	rb_h5_units(&collect->h5, path, views[view].units);
}

/* Makes the whole file. */
static void put_all(struct collect *collect, const char *partial)
{
	struct rb_h5 *const h5 = &collect->h5;
	const hid_t access = rb_h5_access(1);

	h5->file = H5Fcreate(partial, H5F_ACC_EXCL, H5P_DEFAULT, access);
	rb_h5_done(access);
	if (h5->file < 0) {
		rb_h5_fail(h5, "create", collect->collection->path);
		return;
	}
	put_tables(collect);
	for (int i = 0; i < VIEW_COUNT; i++) {
		put_view(collect, i, false);
		put_view(collect, i, true);
	}
	if (H5Fclose(h5->file) < 0)
		rb_h5_fail(h5, "write", collect->collection->path);
}

enum rb_status rb_h5_collect(const struct rb_collection *collection, uint64_t *linked,
                             struct rb_error *err)
{
	struct collect collect = {.collection = collection,
	                          .h5 = {.file = -1, .name = collection->path}};
	struct rb_output output;

	rb_h5_quiet();
	*linked = 0;
	enum rb_status status = rb_output_open(&output, collection->path, collection->replace, err);
	if (status)
		return status;
	collect.sizes = rb_memory_take((size_t)collection->table->rows + 1, sizeof *collect.sizes);
	if (!collect.sizes) {
		rb_output_release(&output);
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot collect into '%s': out of memory",
		               collection->path);
	}
	measure_all(&collect);
	put_all(&collect, output.library);
	rb_memory_free(collect.sizes);
	status = collect.h5.status;
	if (status && err)
		*err = collect.h5.error;
	if (!status)
		status = rb_output_publish(&output, err);
	*linked = collect.linked;
	rb_output_release(&output);
	return status;
}

/* ---- reading ---- */

/* Writes "e, small: ok, small: measured, frames, ...", as far as there is room. */
static char *list_columns(hid_t file, char *out, size_t size)
{
	static const char *const groups[] = {"/parameters", "/expectations", "/results", "/probes"};
	const char *comma = "";
	char name[256];
	size_t at = 0;

	out[0] = '\0';
	for (size_t g = 0; g < sizeof groups / sizeof *groups; g++)
		for (hsize_t i = 0; H5Lexists(file, groups[g], H5P_DEFAULT) > 0; i++) {
			if (H5Lget_name_by_idx(file, groups[g], H5_INDEX_NAME, H5_ITER_INC, i, name,
			                       sizeof name, H5P_DEFAULT) < 0)
				break;
			rb_h5_unescape(name);
			const size_t length = strlen(comma) + strlen(name);
			if (at + length + sizeof ", ..." > size) {
				memcpy(out + at, ", ...", sizeof ", ...");
				return out;
			}
			at += (size_t)snprintf(out + at, size - at, "%s%s", comma, name);
			comma = ", ";
		}
	return out;
}

/* Copies the units of a column, "" where it has none. */
static void read_units(const struct rb_input *input, const char *path, char *out)
{
	struct rb_arena arena = {0};
	const char *const text = rb_input_attribute(input, path, "units", &arena);

	snprintf(out, RB_COLUMN_UNITS_SIZE, "%s", text ? text : "");
	rb_arena_release(&arena);
}

enum rb_status rb_h5_column(const struct rb_column_name *column, double **values, uint64_t *count,
                            char *units, struct rb_error *err)
{
	const char *const file = column->file, *const name = column->name;
	struct rb_input input;
	char escaped[700], path[800], names[120];
	rb_h5_shape row = {0};
	hsize_t rows = 0;

	*values = NULL;
	*count = 0;
	rb_h5_quiet();
	enum rb_status status = rb_input_open(&input, file, err);
	if (status)
		return status;
	snprintf(path, sizeof path, "/%s/%s", column->group,
	         rb_h5_escape(name, escaped, sizeof escaped));
	const hid_t dataset = rb_input_dataset(&input, path, true, &row, &rows);
	if (dataset < 0)
		status = RB_FAIL(err, RB_ERR_INPUT, "'%s' has no numbers '%s' (wanted: %s)", file,
		                 name, list_columns(input.file, names, sizeof names));
	if (!status && !(*values = rb_memory_take((size_t)rows + 1, sizeof **values)))
		status = RB_FAIL(err, RB_ERR_MEMORY, "cannot read '%s': out of memory", file);
	if (!status && !rb_input_rows(dataset, RB_H5_F64, row, (hsize_t[]){0, rows}, *values)) {
		status = RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s' in '%s'", name, file);
		rb_memory_free(*values);
		*values = NULL;
	}
	*count = status ? 0 : rows;
	if (!status && units)
		read_units(&input, path, units);
	rb_h5_done(dataset);
	rb_input_close(&input);
	return status;
}
