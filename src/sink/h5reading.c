/* SPDX-License-Identifier: MIT */
#include "sink/h5reading.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/hash.h"
#include "model/element.h"
#include "sink/h5solids.h"

enum { MEMBERS_MAX = 100000, PATH_SIZE = 600 };

static enum rb_status no_memory(const struct rb_reading_source *from, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot read '%s': out of memory", from->path);
}

/* For texts that are there only for information. */
static const char *text_or_empty(const struct rb_reading_source *from, const char *path)
{
	const char *const text = rb_input_text(from->input, path, from->arena, NULL);

	return text ? text : "";
}

double rb_reading_number(const struct rb_reading_source *from, const char *path)
{
	double value;

	if (!rb_input_numbers(from->input, path, RB_H5_F64, (rb_h5_shape){0}, &value))
		value = (double)NAN;
	return value;
}

void rb_reading_run(const struct rb_reading_source *from)
{
	struct rb_reading *const reading = from->reading;
	int64_t threads = 0;

	reading->build = text_or_empty(from, "/rbsim/build");
	reading->command = text_or_empty(from, "/rbsim/command");
	reading->host = text_or_empty(from, "/rbsim/host");
	reading->started = text_or_empty(from, "/rbsim/started");
	reading->method = text_or_empty(from, "/rbsim/method");
	reading->rollback = text_or_empty(from, "/rbsim/rollback");
	reading->title = text_or_empty(from, "/rbsim/title");
	reading->time_step_s = rb_reading_number(from, "/rbsim/time_step");
	reading->tolerance_m = rb_reading_number(from, "/rbsim/tolerance");
	reading->stepped_tolerance_m = rb_reading_number(from, "/rbsim/stepped_tolerance");
	if (isnan(reading->stepped_tolerance_m)) /* a recording of one tolerance for all */
		reading->stepped_tolerance_m = reading->tolerance_m;
	reading->frame_rate = rb_reading_number(from, "/rbsim/frame_rate");
	reading->duration_s = rb_reading_number(from, "/rbsim/duration");
	if (!rb_input_numbers(from->input, "/rbsim/seed", RB_H5_U64, (rb_h5_shape){0},
	                      &reading->seed))
		reading->seed = 0;
	if (rb_input_numbers(from->input, "/rbsim/threads", RB_H5_I64, (rb_h5_shape){0},
	                     &threads) &&
	    threads > 0 && threads < 1000000)
		reading->threads = (int)threads;
}

enum rb_status rb_reading_params(const struct rb_reading_source *from, struct rb_error *err)
{
	struct rb_reading *const reading = from->reading;
	const char **names;
	char path[PATH_SIZE];

	const int count = rb_input_members(from->input, "/rbsim/parameters", MEMBERS_MAX, &names,
	                                   from->arena);
	reading->param_names = names;
	reading->param_values = rb_arena_take(from->arena, (size_t)count + 1,
	                                      sizeof *reading->param_values);
	if (!reading->param_values)
		return no_memory(from, err);
	for (int i = 0; i < count; i++) {
		snprintf(path, sizeof path, "/rbsim/parameters/%s", names[i]);
		const char *text = rb_input_attribute(from->input, path, "text", from->arena);
		reading->param_values[i] = text ? text : text_or_empty(from, path);
		rb_h5_unescape((char *)(uintptr_t)names[i]); /* ours, in the arena */
	}
	reading->param_count = count;
	return RB_OK;
}

/* A file of the scene: a text, or bytes where it holds zeros, then those that were recorded. */
static enum rb_status read_file(const struct rb_reading_source *from, const char *path,
                                const char **text, size_t *size, struct rb_error *err)
{
	char sha256[65];

	*text = rb_input_text(from->input, path, from->arena, NULL);
	*size = *text ? strlen(*text) : 0;
	if (*text)
		return RB_OK;
	*text = rb_input_bytes(from->input, path, from->arena, size);
	if (!*text) {
		*text = "";
		return RB_OK;
	}
	const char *const stated = rb_input_attribute(from->input, path, "sha256", from->arena);
	rb_hash_sha256(*text, *size, sha256);
	if (stated && strcmp(stated, sha256) == 0)
		return RB_OK;
	return RB_FAIL(err, RB_ERR_INPUT,
	               "'%s' in '%s' is damaged: its bytes are not those of its 'sha256'", path,
	               from->path);
}

enum rb_status rb_reading_files(const struct rb_reading_source *from, struct rb_error *err)
{
	struct rb_reading *const reading = from->reading;
	const char **names;
	char path[PATH_SIZE];

	const int count = rb_input_members(from->input, "/rbsim/files", MEMBERS_MAX, &names,
	                                   from->arena);
	const size_t room = (size_t)count + 1;
	size_t *const sizes = rb_arena_take(from->arena, room, sizeof *sizes);
	reading->file_names = rb_arena_take(from->arena, room, sizeof *reading->file_names);
	reading->file_texts = rb_arena_take(from->arena, room, sizeof *reading->file_texts);
	reading->file_sizes = sizes;
	if (!sizes || !reading->file_names || !reading->file_texts)
		return no_memory(from, err);
	const char *const scene = rb_input_attribute(from->input, "/rbsim/scene", "name",
	                                             from->arena);
	reading->file_names[0] = scene ? scene : "";
	enum rb_status status = read_file(from, "/rbsim/scene", &reading->file_texts[0], &sizes[0],
	                                  err);
	for (int i = 0; i < count && status == RB_OK; i++) {
		snprintf(path, sizeof path, "/rbsim/files/%s", names[i]);
		status = read_file(from, path, &reading->file_texts[i + 1], &sizes[i + 1], err);
		rb_h5_unescape((char *)(uintptr_t)names[i]);
		reading->file_names[i + 1] = names[i];
	}
	reading->file_count = count + 1;
	return status;
}

/* Who is who. */
enum rb_status rb_reading_bodies(const struct rb_reading_source *from, struct rb_error *err)
{
	static const char *const paths[] = {"/particles/bodies/id", "/particles/statics/id"};
	struct rb_reading *const reading = from->reading;
	int *const counts[] = {&reading->body_count, &reading->static_count};

	for (int i = 0; i < 2; i++) {
		rb_h5_shape shape = {1, {0}};
		hsize_t rows = 0;
		const hid_t dataset = rb_input_dataset(from->input, paths[i], false, &shape, &rows);
		rb_h5_done(dataset);
		if (dataset < 0 || rows > INT32_MAX / 4)
			return RB_FAIL(
				err, RB_ERR_INPUT,
				"'%s' is not a recording of rbsim: '%s' is missing or misshapen",
				from->path, paths[i]);
		*counts[i] = (int)rows;
	}
	const size_t bodies = (size_t)reading->body_count;
	int *const id = rb_arena_take(from->arena, bodies + 1, sizeof *id);
	reading->id = id;
	reading->names = rb_input_texts(from->input, "/rbsim/names",
	                                bodies + (size_t)reading->static_count, from->arena);
	if (!id || !reading->names)
		return no_memory(from, err);
	if (bodies > 0 &&
	    !rb_input_numbers(from->input, paths[0], RB_H5_I32, (rb_h5_shape){1, {bodies}}, id))
		return RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s' in '%s'", paths[0], from->path);
	for (size_t i = 0; i < bodies; i++)
		if (id[i] < 0 || id[i] >= reading->body_count + reading->static_count)
			return RB_FAIL(err, RB_ERR_INPUT,
			               "'%s' in '%s' is damaged: body %zu has id %d", paths[0],
			               from->path, i, id[i]);
	return RB_OK;
}

/* Elements of a kind: rows of the first of its keys that is one number. */
static int element_rows(const struct rb_reading_source *from, const struct rb_element_kind *kind)
{
	const struct rb_row *key = kind->keys.rows;
	char path[160];

	while (key->type == RB_ROW_VECTOR && key + 1 < kind->keys.rows + kind->keys.count)
		key++;
	snprintf(path, sizeof path, "/rbsim/%ss/%s", kind->name, key->key);
	return rb_input_row_count(from->input, path);
}

enum rb_status rb_reading_forces(const struct rb_reading_source *from, struct rb_error *err)
{
	static const char path[] = "/rbsim/shapes/driven", fields[] = "/rbsim/fields";
	struct rb_reading *const reading = from->reading;
	const size_t count = (size_t)reading->body_count + (size_t)reading->static_count;
	int64_t field_count = 0;

	int *const kind = rb_arena_take(from->arena, count + 1, sizeof *kind);
	if (!kind)
		return no_memory(from, err);
	if (!rb_solids_tally(from->input, count, kind, reading->shape_counts))
		return RB_FAIL(err, RB_ERR_INPUT, "cannot read the shapes in '%s'", from->path);
	for (int place = 0; place < rb_element_kind_count; place++)
		reading->element_counts[place] = element_rows(from, rb_element_kinds[place]);
	if (rb_input_has(from->input, fields) &&
	    rb_input_numbers(from->input, fields, RB_H5_I64, (rb_h5_shape){0}, &field_count) &&
	    field_count > 0 && field_count < INT32_MAX)
		reading->field_count = (int)field_count;
	if (!rb_input_has(from->input, path))
		return RB_OK;
	signed char *driven = (signed char *)kind; /* which are no longer needed */
	if (!rb_input_numbers(from->input, path, RB_H5_I8, (rb_h5_shape){1, {count}}, driven))
		return RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s' in '%s'", path, from->path);
	for (size_t i = 0; i < count; i++)
		reading->driven_count += driven[i] != 0;
	return RB_OK;
}

int rb_reading_measures(const struct rb_reading_source *from, const char *folder, const char *tail,
                        const char ***names, const char ***units)
{
	char path[PATH_SIZE];
	const int count = rb_input_members(from->input, folder, RB_MEASURES_MAX, names,
	                                   from->arena);

	*units = rb_arena_take(from->arena, (size_t)count + 1, sizeof **units);
	for (int i = 0; *units && i < count; i++) {
		snprintf(path, sizeof path, "%s/%s%s", folder, (*names)[i], tail);
		const char *const text = rb_input_attribute(from->input, path, "units",
		                                            from->arena);
		(*units)[i] = text ? text : "";
	}
	return count;
}

enum rb_status rb_reading_joints(const struct rb_reading_source *from, struct rb_error *err)
{
	static const char path[] = "/joints/kind";
	struct rb_reading *const reading = from->reading;
	rb_h5_shape shape = {1, {0}};
	hsize_t rows = 0;

	if (!rb_input_has(from->input, path))
		return RB_OK;
	rb_h5_done(rb_input_dataset(from->input, path, false, &shape, &rows));
	if (rows == 0 || rows > INT32_MAX / 4)
		return RB_FAIL(err, RB_ERR_INPUT, "'%s' in '%s' is damaged", path, from->path);
	int *const kind = rb_arena_take(from->arena, rows, sizeof *kind);
	reading->joint_names = rb_input_texts(from->input, "/joints/name", rows, from->arena);
	if (!kind || !reading->joint_names)
		return no_memory(from, err);
	if (!rb_input_numbers(from->input, path, RB_H5_I32, (rb_h5_shape){1, {rows}}, kind))
		return RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s' in '%s'", path, from->path);
	for (hsize_t i = 0; i < rows; i++)
		if (kind[i] < 0 || kind[i] >= RB_JOINT_KIND_COUNT)
			return RB_FAIL(err, RB_ERR_INPUT,
			               "'%s' in '%s' is damaged: joint %llu has kind %d", path,
			               from->path, (unsigned long long)i, kind[i]);
	reading->joint_kind = kind;
	reading->joint_count = (int)rows;
	return RB_OK;
}
