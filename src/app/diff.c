/* SPDX-License-Identifier: MIT */
#include "app/diff.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "app/common.h"
#include "app/json.h"
#include "base/error.h"
#include "base/visible.h"
#include "sink/module.h"

static const struct {
	unsigned field;
	const char *name, *unit;
	int width;
	size_t offset; /* of the column in struct rb_frame */
} columns[] = {
	{RB_FIELD_POSITION, "position", "m", 3, offsetof(struct rb_frame, position)},
	{RB_FIELD_ORIENTATION, "orientation", "", 4, offsetof(struct rb_frame, orientation)},
	{RB_FIELD_VELOCITY, "velocity", "m/s", 3, offsetof(struct rb_frame, velocity)},
	{RB_FIELD_ANGULAR_VELOCITY, "angular_velocity", "rad/s", 3,
         offsetof(struct rb_frame, angular_velocity)},
	{RB_FIELD_ACCELERATION, "acceleration", "m/s^2", 3,
         offsetof(struct rb_frame, acceleration)},
	{RB_FIELD_ANGULAR_ACCELERATION, "angular_acceleration", "rad/s^2", 3,
         offsetof(struct rb_frame, angular_acceleration)},
	{RB_FIELD_FORCE, "force", "N", 3, offsetof(struct rb_frame, force)},
	{RB_FIELD_TORQUE, "torque", "N m", 3, offsetof(struct rb_frame, torque)},
};
enum { COLUMN_COUNT = sizeof columns / sizeof *columns };

enum kind { SAME, BODIES, FIELDS, TIMES, VALUES, PROBES, FRAME_COUNTS, HASHES, RESULTS };
static const char *const kind_names[] = {
	[SAME] = "none",         [BODIES] = "bodies", [FIELDS] = "columns",
	[TIMES] = "times",       [VALUES] = "values", [FRAME_COUNTS] = "frames",
	[HASHES] = "state_hash", [PROBES] = "probes", [RESULTS] = "results",
};

/* What was found first. */
struct difference {
	enum kind kind;
	uint64_t frame[2];       /* of TIMES, VALUES and PROBES: their numbers, not their rows */
	int body, column;        /* of VALUES */
	double time[2];          /* of TIMES and VALUES */
	double value[2][4];      /* of VALUES */
	double largest;          /* of VALUES: |a - b| of that body's column */
	double largest_in_frame; /* over all bodies of that column */
	unsigned only[2];        /* of FIELDS: columns that the other one has not */
	const char *name;        /* of PROBES and RESULTS, with value[][0]; a reader's */
};

struct side {
	const char *path;
	struct rb_reader *reader;
	const struct rb_reading *reading;
	struct rb_frame frame;
};

/* A column of the frame at hand, NULL: it has none. */
static const double *column_of(const struct side *side, int column)
{
	const double *values;

	RB_ASSERT(column >= 0 && column < COLUMN_COUNT);
	memcpy(&values, (const char *)&side->frame + columns[column].offset, sizeof values);
	return values;
}

/* The largest difference of a component; NAN where one has NAN. */
static double distance(const double *a, const double *b, int width)
{
	double largest = 0;

	for (int i = 0; i < width; i++) {
		const double d = fabs(a[i] - b[i]);
		largest = d > largest || isnan(d) ? d : largest;
	}
	return largest;
}

/*
 * The first body, in its first column, that differs in the two frames that were read. Compared as
 * bytes: 0 and -0, or two NAN, are different bits.
 */
static bool compare_frames(const struct side *side, struct difference *found)
{
	int body_count = side[0].frame.body_count;

	found->column = -1;
	for (int c = 0; c < COLUMN_COUNT; c++) {
		const double *a = column_of(&side[0], c), *b = column_of(&side[1], c);
		const size_t width = (size_t)columns[c].width;
		if (!a || !b ||
		    memcmp(a, b, (size_t)side[0].frame.body_count * width * sizeof *a) == 0)
			continue;
		for (int k = 0; k < body_count; k++)
			if (memcmp(a + width * (size_t)k, b + width * (size_t)k,
			           width * sizeof *a) != 0) {
				found->body = k;
				found->column = c;
				body_count =
					k; /* a later column counts only with an earlier body */
			}
	}
	if (found->column < 0)
		return false;

	const int width = columns[found->column].width;
	const double *a = column_of(&side[0], found->column),
		     *b = column_of(&side[1], found->column);
	memcpy(found->value[0], a + width * found->body, (size_t)width * sizeof *a);
	memcpy(found->value[1], b + width * found->body, (size_t)width * sizeof *b);
	found->largest = distance(found->value[0], found->value[1], width);
	for (int k = 0; k < side[0].frame.body_count; k++)
		found->largest_in_frame = fmax(found->largest_in_frame,
		                               distance(a + width * k, b + width * k, width));
	found->kind = VALUES;
	return true;
}

/* Names and numbers of both sides: results, or probes of the frames that were read. */
struct measures {
	const char **name[2];
	const double *value[2];
	int count[2];
};

/* The first number that both have, by name, and that differs. */
static bool compare_measures(const struct measures *m, enum kind kind, struct difference *found)
{
	for (int i = 0; i < m->count[0]; i++)
		for (int k = 0; k < m->count[1]; k++) {
			if (strcmp(m->name[0][i], m->name[1][k]) != 0 ||
			    memcmp(&m->value[0][i], &m->value[1][k], sizeof(double)) == 0)
				continue;
			found->kind = kind;
			found->name = m->name[0][i];
			found->value[0][0] = m->value[0][i];
			found->value[1][0] = m->value[1][k];
			return true;
		}
	return false;
}

static bool compare_probes(const struct side *side, struct difference *found)
{
	const struct measures probes = {
		{side[0].reading->probe_names, side[1].reading->probe_names},
		{side[0].frame.probes, side[1].frame.probes},
		{side[0].frame.probe_count, side[1].frame.probe_count}};

	return compare_measures(&probes, PROBES, found);
}

static bool compare_results(const struct side *side, struct difference *found)
{
	const struct measures results = {
		{side[0].reading->result_names, side[1].reading->result_names},
		{side[0].reading->results, side[1].reading->results},
		{side[0].reading->result_count, side[1].reading->result_count}};

	return compare_measures(&results, RESULTS, found);
}

/*
 * Finds the first difference of two recordings; frames in the order of rows, then what only one of
 * them has.
 */
static enum rb_status compare(const struct rb_hdf5_module *module, struct side *side,
                              struct difference *found, struct rb_error *err)
{
	const struct rb_reading *const a = side[0].reading, *const b = side[1].reading;
	const uint64_t rows = a->frame_count < b->frame_count ? a->frame_count : b->frame_count;

	*found = (struct difference){0};
	if (a->body_count != b->body_count || a->static_count != b->static_count) {
		found->kind = BODIES;
		return RB_OK;
	}
	for (uint64_t row = 0; row < rows; row++) {
		for (int i = 0; i < 2; i++) {
			const enum rb_status status = module->reader_frame(side[i].reader, row,
			                                                   &side[i].frame, err);
			if (status)
				return status;
			found->frame[i] = side[i].frame.index;
			found->time[i] = side[i].frame.time_s;
		}
		if (memcmp(&found->time[0], &found->time[1], sizeof(double)) != 0) {
			found->kind = TIMES;
			return RB_OK;
		}
		if (compare_frames(side, found) || compare_probes(side, found))
			return RB_OK;
	}
	found->only[0] = a->fields & ~b->fields;
	found->only[1] = b->fields & ~a->fields;
	if (found->only[0] | found->only[1])
		found->kind = FIELDS;
	else if (a->frame_count != b->frame_count)
		found->kind = FRAME_COUNTS;
	else if (strcmp(a->state_hash, b->state_hash) != 0 && strcmp(a->status, b->status) == 0)
		found->kind = HASHES;
	else if (strcmp(a->status, b->status) == 0)
		(void)compare_results(side, found);
	return RB_OK;
}

/* A body's name in quotes, or #ID. */
static const char *label_of(const struct side *side, int body, char out[64])
{
	const int id = side->reading->id[body];

	if (*side->reading->names[id])
		snprintf(out, 64, "'%s'", side->reading->names[id]);
	else
		snprintf(out, 64, "#%d", id);
	return out;
}

/* NAN without a sign, which would be printed. */
static double plain_nan(double x)
{
	return isnan(x) ? (double)NAN : x;
}

/* Prints the values of one side. */
static void print_vector(const struct side *side, const struct difference *found, int i)
{
	rb_print(stdout, "  %s:", side[i].path);
	for (int k = 0; k < columns[found->column].width; k++)
		rb_print(stdout, " %.17g", plain_nan(found->value[i][k]));
	putchar('\n');
}

/* Prints the columns that only one of them has. */
static void print_fields(const struct side *side, const struct difference *found)
{
	for (int i = 0; i < 2; i++)
		for (int c = 0; c < COLUMN_COUNT; c++)
			if (found->only[i] & columns[c].field)
				rb_print(stdout,
				         "only '%s' has the column '%s'; what both have is the "
				         "same\n",
				         side[i].path, columns[c].name);
	if ((found->only[0] | found->only[1]) &
	    (RB_FIELD_CONTACTS | RB_FIELD_EVENTS | RB_FIELD_JOINTS))
		rb_print(stdout, "only one of them has contacts, events or joints; the bodies are "
		                 "the same\n");
}

static void print_text(const struct side *side, const struct difference *found)
{
	const struct rb_reading *const a = side[0].reading, *const b = side[1].reading;
	char label[64];

	switch (found->kind) {
	case SAME:
		rb_print(stdout, "the same to the bit: %" PRIu64 " %s of %d %s\n", a->frame_count,
		         rb_text_plural(a->frame_count, "frame", "frames"), a->body_count,
		         rb_text_plural((uint64_t)a->body_count, "body", "bodies"));
		break;
	case BODIES:
		rb_print(
			stdout,
			"the bodies differ: '%s' has %d moving and %d static, '%s' has %d and %d\n",
			side[0].path, a->body_count, a->static_count, side[1].path, b->body_count,
			b->static_count);
		break;
	case FIELDS:
		print_fields(side, found);
		break;
	case TIMES:
		rb_print(stdout,
		         "the times of frames differ: '%s' has frame %" PRIu64
		         " at %.17g s where '%s' has frame %" PRIu64 " at %.17g s\n",
		         side[0].path, found->frame[0], found->time[0], side[1].path,
		         found->frame[1], found->time[1]);
		break;
	case VALUES:
		rb_print(stdout,
		         "frame %" PRIu64 " (%.9g s): body %s: %s differs by %.3g%s%s (the largest "
		         "difference of any body: %.3g)\n",
		         found->frame[0], found->time[0], label_of(&side[0], found->body, label),
		         columns[found->column].name, plain_nan(found->largest),
		         *columns[found->column].unit ? " " : "", columns[found->column].unit,
		         plain_nan(found->largest_in_frame));
		print_vector(side, found, 0);
		print_vector(side, found, 1);
		break;
	case PROBES:
		rb_print(stdout,
		         "frame %" PRIu64 " (%.9g s): probe '%s' is %.17g in '%s' and %.17g in "
		         "'%s'\n",
		         found->frame[0], found->time[0], found->name,
		         plain_nan(found->value[0][0]), side[0].path, plain_nan(found->value[1][0]),
		         side[1].path);
		break;
	case RESULTS:
		rb_print(stdout,
		         "the frames are the same, but result '%s' is %.17g in '%s' and %.17g in "
		         "'%s'\n",
		         found->name, plain_nan(found->value[0][0]), side[0].path,
		         plain_nan(found->value[1][0]), side[1].path);
		break;
	case FRAME_COUNTS:
		rb_print(stdout,
		         "the same as far as both go, but '%s' has %" PRIu64
		         " frames and '%s' has %" PRIu64 "\n",
		         side[0].path, a->frame_count, side[1].path, b->frame_count);
		break;
	case HASHES:
		rb_print(stdout,
		         "the frames are the same, but the states at the end differ: %s and %s\n",
		         a->state_hash, b->state_hash);
		break;
	}
}

static int exit_code_of(const struct difference *found)
{
	return rb_status_exit_code(found->kind == SAME ? RB_OK : RB_ERR_EXPECT);
}

static void print_json(const struct side *side, const struct difference *found)
{
	struct rb_json json = {.file = stdout};

	rb_json_open(&json, NULL, '{');
	rb_json_text(&json, "a", side[0].path);
	rb_json_text(&json, "b", side[1].path);
	rb_json_bool(&json, "same", found->kind == SAME);
	rb_json_text(&json, "difference", kind_names[found->kind]);
	rb_json_count(&json, "frames_a", side[0].reading->frame_count);
	rb_json_count(&json, "frames_b", side[1].reading->frame_count);
	rb_json_count(&json, "bodies_a", (uint64_t)side[0].reading->body_count);
	rb_json_count(&json, "bodies_b", (uint64_t)side[1].reading->body_count);
	if (found->kind == TIMES || found->kind == VALUES || found->kind == PROBES) {
		rb_json_count(&json, "frame", found->frame[0]);
		rb_json_vector(&json, "time", found->time, 2);
	}
	if (found->kind == PROBES || found->kind == RESULTS) {
		rb_json_text(&json, "name", found->name);
		rb_json_number(&json, "value_a", found->value[0][0]);
		rb_json_number(&json, "value_b", found->value[1][0]);
	}
	if (found->kind == VALUES) {
		const int id = side[0].reading->id[found->body];
		rb_json_count(&json, "id", (uint64_t)id);
		rb_json_text(&json, "name",
		             *side[0].reading->names[id] ? side[0].reading->names[id] : NULL);
		rb_json_text(&json, "column", columns[found->column].name);
		rb_json_vector(&json, "value_a", found->value[0], columns[found->column].width);
		rb_json_vector(&json, "value_b", found->value[1], columns[found->column].width);
		rb_json_number(&json, "by", found->largest);
		rb_json_number(&json, "largest", found->largest_in_frame);
	}
	rb_json_count(&json, "exit_status", (uint64_t)exit_code_of(found));
	rb_json_close(&json, '}');
	putchar('\n');
}

static enum rb_status diff(const struct rb_options *options, struct difference *found,
                           struct rb_error *err)
{
	const struct rb_hdf5_module *module;
	struct side side[2] = {{.path = options->operand[0]}, {.path = options->operand[1]}};
	enum rb_status status = rb_module_hdf5(&module, err);

	for (int i = 0; i < 2 && !status; i++) {
		status = module->reader_open(&side[i].reader, side[i].path, err);
		if (!status)
			side[i].reading = module->reader_reading(side[i].reader);
	}
	if (!status)
		status = compare(module, side, found, err);
	if (!status && options->json)
		print_json(side, found);
	else if (!status && !options->quiet)
		print_text(side, found);
	for (int i = 0; i < 2; i++)
		if (side[i].reader)
			module->reader_close(side[i].reader);
	return status;
}

int rb_diff_main(const struct rb_options *options)
{
	struct difference found;
	struct rb_error err;
	const enum rb_status status = diff(options, &found, &err);
	int exit_code;

	if (status)
		exit_code = rb_app_refuse(options, &err);
	else
		exit_code = exit_code_of(&found);
	return rb_app_finish(options, exit_code);
}
