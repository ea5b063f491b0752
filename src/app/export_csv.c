/* SPDX-License-Identifier: MIT */
/*
 * Tables of comma-separated values (RFC 4180), a file each: NAME-bodies.csv has a row for each body
 * and frame, NAME-frames.csv one for each frame, NAME-events.csv and NAME-contacts.csv what was
 * recorded of these, NAME-results.csv the scene's results. SI units; a body is named by its id and
 * its name. What the recording does not have is left out.
 */
#include "app/exported.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "sweep/table.h"

/* Columns of bodies, where the recording has them. */
static const struct {
	const char *names[4];
	int width;
	size_t offset; /* of the column in struct rb_frame */
} columns[] = {
	{{"x", "y", "z"}, 3, offsetof(struct rb_frame, position)},
	{{"qw", "qx", "qy", "qz"}, 4, offsetof(struct rb_frame, orientation)},
	{{"vx", "vy", "vz"}, 3, offsetof(struct rb_frame, velocity)},
	{{"wx", "wy", "wz"}, 3, offsetof(struct rb_frame, angular_velocity)},
	{{"ax", "ay", "az"}, 3, offsetof(struct rb_frame, acceleration)},
	{{"alx", "aly", "alz"}, 3, offsetof(struct rb_frame, angular_acceleration)},
	{{"fx", "fy", "fz"}, 3, offsetof(struct rb_frame, force)},
	{{"tx", "ty", "tz"}, 3, offsetof(struct rb_frame, torque)},
};
enum { COLUMN_COUNT = sizeof columns / sizeof *columns };

/* Numbers of a frame. */
#define NUMBER(member) offsetof(struct rb_frame_numbers, member)
static const struct {
	const char *name;
	bool whole; /* an uint64_t, else a double */
	size_t offset;
} numbers[] = {
	{"kinetic_energy", false, NUMBER(kinetic_energy)},
	{"potential_energy", false, NUMBER(potential_energy)},
	{"momentum_x", false, NUMBER(momentum.x)},
	{"momentum_y", false, NUMBER(momentum.y)},
	{"momentum_z", false, NUMBER(momentum.z)},
	{"angular_momentum_x", false, NUMBER(angular_momentum.x)},
	{"angular_momentum_y", false, NUMBER(angular_momentum.y)},
	{"angular_momentum_z", false, NUMBER(angular_momentum.z)},
	{"max_penetration", false, NUMBER(max_penetration)},
	{"contacts", true, NUMBER(contacts)},
	{"collisions", true, NUMBER(collisions)},
	{"rollbacks", true, NUMBER(rollbacks)},
	{"substeps", true, NUMBER(substeps)},
	{"smallest_step", false, NUMBER(smallest_step)},
	{"stepped", false, NUMBER(stepped)},
};
enum { NUMBER_COUNT = sizeof numbers / sizeof *numbers };

static const double *column_of(const struct rb_frame *frame, int column)
{
	const double *values;

	memcpy(&values, (const char *)frame + columns[column].offset, sizeof values);
	return values;
}

/* Cells with commas before them. */
static void print_numbers(FILE *file, const double *values, int count)
{
	for (int k = 0; k < count; k++) {
		putc(',', file);
		rb_exported_number(file, values[k]);
	}
}

static void print_vector(FILE *file, rb_vec3 v)
{
	print_numbers(file, (const double[]){v.x, v.y, v.z}, 3);
}

/* ",ID,NAME" */
static void print_body(const struct rb_exported *exported, FILE *file, int id)
{
	fprintf(file, ",%d,", id);
	rb_table_print_cell(file, exported->reading->names[id]);
}

static void print_head(const struct rb_exported *exported, FILE *file, const struct rb_frame *frame)
{
	(void)exported;
	fputs("frame,time,id,name", file);
	for (int c = 0; c < COLUMN_COUNT; c++)
		for (int k = 0; column_of(frame, c) && k < columns[c].width; k++)
			fprintf(file, ",%s", columns[c].names[k]);
	putc('\n', file);
}

static int print_bodies(const struct rb_exported *exported, FILE *file,
                        const struct rb_frame *frame)
{
	for (int i = 0; i < frame->body_count; i++) {
		fprintf(file, "%" PRIu64 ",", frame->index);
		rb_exported_number(file, frame->time_s);
		print_body(exported, file, exported->reading->id[i]);
		for (int c = 0; c < COLUMN_COUNT; c++) {
			const double *const from = column_of(frame, c);
			if (from)
				print_numbers(file, from + (size_t)i * (size_t)columns[c].width,
				              columns[c].width);
		}
		putc('\n', file);
	}
	return frame->body_count;
}

/* Whether the table of frames has such a column of its own. */
static bool is_column(const char *name)
{
	bool is = strcmp(name, "frame") == 0 || strcmp(name, "time") == 0;

	for (int k = 0; k < NUMBER_COUNT; k++)
		is = is || strcmp(numbers[k].name, name) == 0;
	return is;
}

static void print_frames_head(const struct rb_exported *exported, FILE *file,
                              const struct rb_frame *frame)
{
	(void)frame;
	fputs("frame,time", file);
	for (int k = 0; k < NUMBER_COUNT; k++)
		fprintf(file, ",%s", numbers[k].name);
	for (int k = 0; k < exported->reading->probe_count; k++) {
		const char *const name = exported->reading->probe_names[k];
		char own[RB_EXPORT_NAME_SIZE];

		snprintf(own, sizeof own, "%s%s", name, is_column(name) ? ": probe" : "");
		putc(',', file);
		rb_table_print_cell(file, own);
	}
	putc('\n', file);
}

static int print_frame(const struct rb_exported *exported, FILE *file, const struct rb_frame *frame)
{
	const char *const from = (const char *)&frame->numbers;

	(void)exported;
	fprintf(file, "%" PRIu64, frame->index);
	print_numbers(file, &frame->time_s, 1);
	for (int k = 0; k < NUMBER_COUNT; k++) {
		uint64_t count;
		double value;
		memcpy(&count, from + numbers[k].offset, sizeof count);
		memcpy(&value, from + numbers[k].offset, sizeof value);
		if (numbers[k].whole)
			fprintf(file, ",%" PRIu64, count);
		else
			print_numbers(file, &value, 1);
	}
	print_numbers(file, frame->probes, frame->probe_count);
	putc('\n', file);
	return 1;
}

static void print_events_head(const struct rb_exported *exported, FILE *file,
                              const struct rb_frame *frame)
{
	(void)exported;
	(void)frame;
	fputs("time,frame,kind,a,name_a,b,name_b,px,py,pz,nx,ny,nz,jx,jy,jz,approach_speed\n",
	      file);
}

static int print_events(const struct rb_exported *exported, FILE *file,
                        const struct rb_frame *frame)
{
	for (int k = 0; k < frame->event_count; k++) {
		const struct rb_event *const event = &frame->events[k];
		rb_exported_number(file, event->time_s);
		fprintf(file, ",%" PRIu64 ",%s", frame->index, rb_event_kind_name(event->kind));
		print_body(exported, file, event->a);
		print_body(exported, file, event->b);
		print_vector(file, event->point);
		print_vector(file, event->normal);
		print_vector(file, event->impulse);
		print_numbers(file, &event->approach_speed, 1);
		putc('\n', file);
	}
	return frame->event_count;
}

static void print_contacts_head(const struct rb_exported *exported, FILE *file,
                                const struct rb_frame *frame)
{
	(void)exported;
	(void)frame;
	fputs("frame,time,a,name_a,b,name_b,px,py,pz,nx,ny,nz,fx,fy,fz,gap\n", file);
}

static int print_contacts(const struct rb_exported *exported, FILE *file,
                          const struct rb_frame *frame)
{
	const int bodies = exported->reading->body_count + exported->reading->static_count;
	int count = 0;

	for (int k = 0; k < frame->contact_count; k++) {
		const struct rb_frame_contact *const contact = &frame->contacts[k];
		if (contact->a < 0 || contact->a >= bodies || contact->b < 0 ||
		    contact->b >= bodies)
			continue; /* of a damaged file */
		fprintf(file, "%" PRIu64, frame->index);
		print_numbers(file, &frame->time_s, 1);
		print_body(exported, file, contact->a);
		print_body(exported, file, contact->b);
		print_vector(file, contact->point);
		print_vector(file, contact->normal);
		print_vector(file, contact->force);
		print_numbers(file, &contact->gap, 1);
		putc('\n', file);
		count++;
	}
	return count;
}

/* The tables with rows of frames. */
static const struct {
	const char *name;
	unsigned field; /* RB_FIELD_* that must be recorded; 0: none */
	void (*head)(const struct rb_exported *, FILE *, const struct rb_frame *);
	int (*rows)(const struct rb_exported *, FILE *, const struct rb_frame *); /* how many */
	const char *one, *many; /* what a row is of */
} tables[] = {
	{"bodies", 0, print_head, print_bodies, "row", "rows"},
	{"frames", 0, print_frames_head, print_frame, "frame", "frames"},
	{"events", RB_FIELD_EVENTS, print_events_head, print_events, "event", "events"},
	{"contacts", RB_FIELD_CONTACTS, print_contacts_head, print_contacts, "row", "rows"},
};
enum { TABLE_COUNT = sizeof tables / sizeof *tables };

static void table_name(const char *name, const char *table, char out[RB_EXPORT_NAME_SIZE])
{
	const size_t size = strlen(name);
	const bool ends = size > 4 && strcmp(name + size - 4, ".csv") == 0;

	snprintf(out, RB_EXPORT_NAME_SIZE, "%.*s-%s.csv", (int)(size - (ends ? 4 : 0)), name,
	         table);
}

static enum rb_status write_table(struct rb_exported *exported, int table, const char *name,
                                  struct rb_error *err)
{
	struct rb_export_content content = {0, tables[table].one, tables[table].many};
	struct rb_outfile out;
	struct rb_frame frame;
	enum rb_status status = rb_exported_begin(exported, &out, name, err);

	if (status)
		return status;
	for (uint64_t row = 0; row < exported->reading->frame_count && !status; row++) {
		status = exported->module->reader_frame(exported->reader, row, &frame, err);
		if (status)
			break;
		if (row == 0)
			tables[table].head(exported, out.file, &frame);
		content.count += (uint64_t)tables[table].rows(exported, out.file, &frame);
	}
	if (!status)
		return rb_exported_publish(exported, &out, name, &content, err);
	rb_outfile_release(&out);
	return status;
}

static enum rb_status write_results(struct rb_exported *exported, const char *name,
                                    struct rb_error *err)
{
	const struct rb_reading *const reading = exported->reading;
	struct rb_outfile out;
	const enum rb_status status = rb_exported_begin(exported, &out, name, err);

	if (status)
		return status;
	fputs("name,value,unit\n", out.file);
	for (int i = 0; i < reading->result_count; i++) {
		rb_table_print_cell(out.file, reading->result_names[i]);
		print_numbers(out.file, &reading->results[i], 1);
		putc(',', out.file);
		rb_table_print_cell(out.file, reading->result_units[i]);
		putc('\n', out.file);
	}
	return rb_exported_publish(
		exported, &out, name,
		&(struct rb_export_content){(uint64_t)reading->result_count, "result", "results"},
		err);
}

static enum rb_status write_csv(struct rb_exported *exported, const char *name,
                                struct rb_error *err)
{
	char table[RB_EXPORT_NAME_SIZE];
	enum rb_status status = RB_OK;

	if (strlen(name) + 20 >= RB_EXPORT_NAME_SIZE)
		return RB_FAIL(err, RB_ERR_CREATE, "the name '%s' is too long", name);
	/* all or none: what may not be replaced is told before anything is made */
	for (int k = 0; k < TABLE_COUNT && !status; k++) {
		table_name(name, tables[k].name, table);
		status = rb_outfile_check(table, exported->options->force, err);
	}
	for (int k = 0; k < TABLE_COUNT && !status; k++) {
		if (tables[k].field && !(exported->reading->fields & tables[k].field))
			continue;
		table_name(name, tables[k].name, table);
		status = write_table(exported, k, table, err);
	}
	if (status || exported->reading->result_count == 0)
		return status;
	table_name(name, "results", table);
	return write_results(exported, table, err);
}

const struct rb_export_form rb_export_csv = {"csv", "", write_csv, false};
