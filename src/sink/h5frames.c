/* SPDX-License-Identifier: MIT */
#include "sink/h5frames.h"

#include "base/error.h"
#include "base/memory.h"
#include "flow/frame.h"
#include "force/gravitation.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/*
 * Chunks hold so much of a column of three numbers a body; buffers hold so much of a whole frame,
 * in whole chunks where these are not longer. With few bodies a chunk spans many frames, or the
 * calls for each would cost more than the bytes.
 *
 * A column has at most CHUNKS_MAX chunks where that can be: its index is then made of blocks of 64
 * addresses at most (HDF5's extensible array: 4 + 1*16 + 1*32 + 2*32 + 2*64 + 4*64 = 500), which
 * are shorter than the alignment and are never torn by a kill (recorder.c). An address takes 8
 * bytes, with a filter 16.
 */
static const double chunk_bytes = 256 * 1024, chunk_bytes_long = 1 << 20, chunk_bytes_max = 1 << 30,
		    buffer_bytes = 2 << 20;
enum { CHUNK_SHARE = 128 };
enum { CHUNKS_MAX = 500, ALIGNMENT = 1024, ALIGNMENT_FILTER = 2048 };
enum {
	NUMBERS_CHUNK_ROWS = 1024,
	TABLE_CHUNK_ROWS = 4096, /* at most; of a run with few frames of few bodies so many: */
	TABLE_CHUNK_ROWS_LEAST = 256,
	CHUNK_BODIES = 1 << 20
};
/*
 * With compression: frames that a chunk spans at least, for what changes little in time, if the
 * buffers allow it.
 */
enum { COMPRESSED_FRAMES = 16 };
static const double compressed_buffer_bytes = 64 << 20;

#define COLUMN(member) offsetof(struct rb_frame, member)
#define NUMBER(member) offsetof(struct rb_frame_numbers, member)
#define ROWS(path, units, field, width, member)                                           \
	{                                                                                 \
		path, units, field, RB_H5_F64, width, COLUMN(member), 0, RB_FRAMES_ALWAYS \
	}
#define OBSERVED(name, units, kind, width, where)                                    \
	{                                                                            \
		"/observables/" #name, units, 0, kind, width, NUMBER(name), 0, where \
	}
#define ENERGY(name, cause)                                                                   \
	{                                                                                     \
		"/observables/ledger/" name, "J", 0, RB_H5_F64, 1,                            \
			NUMBER(ledger.energy) + (cause) * sizeof(double), 0, RB_FRAMES_LEDGER \
	}
#define MOMENTUM(name, cause)                                                                      \
	{                                                                                          \
		"/observables/ledger/momentum/" name, "kg m/s, kg m^2/s", 0, RB_H5_F64, 3,         \
			NUMBER(ledger.momentum) + (cause)*2 * sizeof(rb_vec3), 2, RB_FRAMES_LEDGER \
	}
/*
 * Observables are there for every frame, also where a scene cannot change them: H5MD would have
 * them as plain datasets then, but MDAnalysis takes every member of /observables for a group.
 */
static const struct rb_frames_source sources[RB_FRAMES_SOURCE_COUNT] = {
	ROWS("/particles/bodies/position", "m", RB_FIELD_POSITION, 3, position),
	ROWS("/particles/bodies/orientation", NULL, RB_FIELD_ORIENTATION, 4, orientation),
	ROWS("/particles/bodies/velocity", "m/s", RB_FIELD_VELOCITY, 3, velocity),
	ROWS("/particles/bodies/angular_velocity", "rad/s", RB_FIELD_ANGULAR_VELOCITY, 3,
             angular_velocity),
	ROWS("/particles/bodies/acceleration", "m/s^2", RB_FIELD_ACCELERATION, 3, acceleration),
	ROWS("/particles/bodies/angular_acceleration", "rad/s^2", RB_FIELD_ANGULAR_ACCELERATION, 3,
             angular_acceleration),
	ROWS("/particles/bodies/force", "N", RB_FIELD_FORCE, 3, force),
	ROWS("/particles/bodies/torque", "N m", RB_FIELD_TORQUE, 3, torque),
	ROWS("/joints/angle", "rad, m", RB_FIELD_JOINTS, 1, joint_value),
	ROWS("/joints/speed", "rad/s, m/s", RB_FIELD_JOINTS, 1, joint_speed),
	ROWS("/joints/force", "N", RB_FIELD_JOINTS, 3, joint_force),
	ROWS("/joints/torque", "N m", RB_FIELD_JOINTS, 3, joint_torque),
	OBSERVED(kinetic_energy, "J", RB_H5_F64, 1, RB_FRAMES_ALWAYS),
	OBSERVED(potential_energy, "J", RB_H5_F64, 1, RB_FRAMES_ALWAYS),
	OBSERVED(momentum, "kg m/s", RB_H5_F64, 3, RB_FRAMES_ALWAYS),
	OBSERVED(angular_momentum, "kg m^2/s", RB_H5_F64, 3, RB_FRAMES_ALWAYS),
	OBSERVED(max_penetration, "m", RB_H5_F64, 1, RB_FRAMES_ALWAYS),
	OBSERVED(contacts, NULL, RB_H5_U64, 1, RB_FRAMES_ALWAYS),
	OBSERVED(collisions, NULL, RB_H5_U64, 1, RB_FRAMES_ALWAYS),
	OBSERVED(rollbacks, NULL, RB_H5_U64, 1, RB_FRAMES_ALWAYS),
	OBSERVED(substeps, NULL, RB_H5_U64, 1, RB_FRAMES_ALWAYS),
	OBSERVED(smallest_step, "s", RB_H5_F64, 1, RB_FRAMES_ALWAYS),
	OBSERVED(stepped, "s", RB_H5_F64, 1, RB_FRAMES_ALWAYS),
	OBSERVED(gravitation_error, NULL, RB_H5_F64, 1, RB_FRAMES_TREE),
	ENERGY("applied", RB_ENERGY_APPLIED),
	ENERGY("driven", RB_ENERGY_DRIVEN),
	ENERGY("callbacks", RB_ENERGY_CALLBACKS),
	ENERGY("impacts", RB_ENERGY_IMPACTS),
	ENERGY("impact_friction", RB_ENERGY_IMPACT_FRICTION),
	ENERGY("sliding", RB_ENERGY_SLIDING),
	ENERGY("rolling", RB_ENERGY_ROLLING),
	ENERGY("joint_friction", RB_ENERGY_JOINT_FRICTION),
	ENERGY("drag", RB_ENERGY_DRAG),
	ENERGY("damping", RB_ENERGY_DAMPING),
	ENERGY("unexplained", RB_ENERGY_CAUSES),
	MOMENTUM("applied", RB_MOMENTUM_APPLIED),
	MOMENTUM("drag", RB_MOMENTUM_DRAG),
	MOMENTUM("callbacks", RB_MOMENTUM_CALLBACKS),
	MOMENTUM("driven", RB_MOMENTUM_DRIVEN),
	MOMENTUM("static", RB_MOMENTUM_STATIC),
	MOMENTUM("unexplained", RB_MOMENTUM_CAUSES),
};
_Static_assert(RB_FRAMES_SOURCE_COUNT + 4 <= RB_FRAMES_COLUMNS_MAX,
               "room for step, time and the ends");

#define EVENT(member) offsetof(struct rb_event, member)
static const struct rb_table_cell event_cells[RB_EVENT_CELL_COUNT] = {
	{"/rbsim/events/time", "s", RB_H5_F64, 1, EVENT(time_s)},
	{"/rbsim/events/kind", NULL, RB_H5_I32, 1, EVENT(kind)},
	{"/rbsim/events/a", NULL, RB_H5_I32, 1, EVENT(a)},
	{"/rbsim/events/b", NULL, RB_H5_I32, 1, EVENT(b)},
	{"/rbsim/events/point", "m", RB_H5_F64, 3, EVENT(point)},
	{"/rbsim/events/normal", NULL, RB_H5_F64, 3, EVENT(normal)},
	{"/rbsim/events/impulse", "N s", RB_H5_F64, 3, EVENT(impulse)},
	{"/rbsim/events/approach_speed", "m/s", RB_H5_F64, 1, EVENT(approach_speed)},
	{"/rbsim/events/joint", NULL, RB_H5_I32, 1, EVENT(joint)},
};

#define CONTACT(member) offsetof(struct rb_contact_row, member)
static const struct rb_table_cell contact_cells[RB_CONTACT_CELL_COUNT] = {
	{"/rbsim/contacts/step", NULL, RB_H5_I64, 1, CONTACT(step)},
	{"/rbsim/contacts/a", NULL, RB_H5_I32, 1, CONTACT(contact.a)},
	{"/rbsim/contacts/b", NULL, RB_H5_I32, 1, CONTACT(contact.b)},
	{"/rbsim/contacts/point", "m", RB_H5_F64, 3, CONTACT(contact.point)},
	{"/rbsim/contacts/normal", NULL, RB_H5_F64, 3, CONTACT(contact.normal)},
	{"/rbsim/contacts/force", "N", RB_H5_F64, 3, CONTACT(contact.force)},
	{"/rbsim/contacts/gap", "m", RB_H5_F64, 1, CONTACT(contact.gap)},
};
_Static_assert(sizeof(enum rb_event_kind) == 4, "recorded as a 32-bit integer");

const struct rb_frames_source *rb_frames_sources(void)
{
	return sources;
}

const struct rb_table_cell *rb_event_cells(void)
{
	return event_cells;
}

const struct rb_table_cell *rb_contact_cells(void)
{
	return contact_cells;
}

uint64_t rb_frames_expected(const struct rb_run_info *info)
{
	const uint64_t every = info->scene->record.every > 1 ? (uint64_t)info->scene->record.every
	                                                     : 1;
	const uint64_t last = info->model->frame_count > 0 ? info->model->frame_count - 1 : 0;

	return last / every + 1 + (last % every != 0);
}

/* RB_FIELD_* that the recording asks for and the model can change. */
static unsigned stored_fields(const struct rb_run_info *info)
{
	return rb_frame_fields(info->model, info->scene->record.fields);
}

/* How the chunks and buffers of this run are cut. */
struct cut {
	hsize_t chunk_rows, chunk_bodies, numbers_rows, table_rows, capacity;
};

/* A number of rows from 1 to `most`. */
static hsize_t whole(double rows, hsize_t most)
{
	RB_ASSERT(most >= 1);
	return rows < 1 ? 1 : rows > (double)most ? most : (hsize_t)rows;
}

unsigned rb_frames_alignment(const struct rb_run_info *info)
{
	return info->scene->record.compression > 0 ? ALIGNMENT_FILTER : ALIGNMENT;
}

/* Chooses chunks and buffers from the number of bodies and the length of the run. */
static struct cut plan_cut(const struct rb_run_info *info)
{
	const bool compressed = info->scene->record.compression > 0;
	const uint64_t expected = rb_frames_expected(info);
	const double bodies = info->model->body_count > 0 ? info->model->body_count : 1;
	const double frame_bytes = (double)rb_frame_bytes(info->model, info->scene->record.fields) +
	                           18 * sizeof(double);
	const double pieces = ceil(bodies / CHUNK_BODIES);
	struct cut cut;

	cut.chunk_bodies = pieces > 1 ? (hsize_t)ceil(bodies / pieces)
	                              : (hsize_t)info->model->body_count;
	/* never longer than the run: a chunk takes its whole space with its first row */
	const double few = ceil((double)expected * pieces / CHUNKS_MAX);
	/* a long run can spare longer chunks for its first frame: their writes cost less a byte */
	const double spared = fmin(24 * bodies * (double)expected / CHUNK_SHARE, chunk_bytes_long);
	double rows = fmax(ceil(fmax(chunk_bytes, spared) / (24 * bodies)), few);
	/* what is packed as a whole must be buffered as a whole */
	const double most = compressed ? compressed_buffer_bytes / frame_bytes
	                               : chunk_bytes_max / (32 * (double)(cut.chunk_bodies + 1));
	if (compressed)
		rows = fmax(rows, COMPRESSED_FRAMES);
	cut.chunk_rows = whole(fmin(rows, most), expected);
	/* as many chunks of the same length leave less of the last one empty */
	const hsize_t chunks = (expected + cut.chunk_rows - 1) / cut.chunk_rows;
	cut.chunk_rows = (expected + chunks - 1) / chunks;

	cut.table_rows = (hsize_t)fmin(fmax((double)expected * bodies, TABLE_CHUNK_ROWS_LEAST),
	                               TABLE_CHUNK_ROWS);
	const double numbers = fmax(fmax((double)cut.chunk_rows, NUMBERS_CHUNK_ROWS), few);
	cut.numbers_rows = whole(numbers, expected);
	const hsize_t buffered = whole(buffer_bytes / frame_bytes, expected);
	if (compressed || buffered >= cut.chunk_rows)
		cut.capacity = cut.chunk_rows *
		               whole((double)(buffered / cut.chunk_rows), expected);
	else
		cut.capacity = buffered;
	return cut;
}

/* Makes the dataset ELEMENT/NAME. */
static struct rb_frames_column *add_column(struct rb_h5 *h5, struct rb_frames *frames,
                                           const char *element, const char *name,
                                           const struct rb_h5_layout *layout)
{
	struct rb_frames_column *const column = &frames->columns[frames->column_count++];

	RB_ASSERT(frames->column_count <=
	          RB_FRAMES_COLUMNS_MAX + frames->model->scene->probe_count);
	snprintf(column->path, sizeof column->path, "%s/%s", element, name);
	rb_h5_column_create(h5, &column->column, column->path, layout);
	return column;
}

rb_h5_shape rb_frames_shape(const struct rb_frames_source *source, hsize_t bodies, hsize_t joints)
{
	const hsize_t width = (hsize_t)source->width;

	if (source->field == RB_FIELD_JOINTS)
		return width > 1 ? (rb_h5_shape){2, {joints, width}} : (rb_h5_shape){1, {joints}};
	if (source->field != 0)
		return (rb_h5_shape){2, {bodies, width}};
	if (source->rows > 0)
		return (rb_h5_shape){2, {(hsize_t)source->rows, width}};
	return width > 1 ? (rb_h5_shape){1, {width}} : (rb_h5_shape){0};
}

/* Makes the dataset of a column of frames. */
static void add_source(struct rb_h5 *h5, struct rb_frames *frames,
                       const struct rb_frames_source *source, const struct rb_run_info *info,
                       const struct cut *cut)
{
	const struct rb_record_def *const record = &info->scene->record;
	const bool bodies = source->field != 0;
	struct rb_h5_layout layout = {.kind = source->kind,
	                              .row = rb_frames_shape(source,
	                                                     (hsize_t)info->model->body_count,
	                                                     (hsize_t)info->scene->joint_count),
	                              .chunk_rows = bodies ? cut->chunk_rows : cut->numbers_rows};

	if (bodies) {
		if (source->field != RB_FIELD_JOINTS)
			layout.chunk_first = cut->chunk_bodies;
		layout.compression = record->compression;
		if (record->single_precision)
			layout.kind = RB_H5_F32;
	}
	struct rb_frames_column *column = add_column(h5, frames, source->path, "value", &layout);
	column->source = source;
	column->of_bodies = bodies;
	rb_h5_units(h5, column->path, source->units);
}

const char *rb_frames_probe_path(const char *name, char out[RB_FRAMES_PATH_SIZE])
{
	static const char folder[] = "/observables/probes/";

	memcpy(out, folder, sizeof folder);
	rb_h5_escape(name, out + sizeof folder - 1, RB_FRAMES_PATH_SIZE - sizeof folder - 8);
	return out;
}

/* Makes the datasets of the scene's probes. */
static void add_probes(struct rb_h5 *h5, struct rb_frames *frames, const struct cut *cut)
{
	const struct rb_scene *const scene = frames->model->scene;
	const struct rb_h5_layout layout = {.kind = RB_H5_F64, .chunk_rows = cut->numbers_rows};
	char path[RB_FRAMES_PATH_SIZE];

	if (scene->probe_count > 0 && !h5->there)
		rb_h5_group_ordered(h5, "/observables/probes");
	for (int i = 0; i < scene->probe_count; i++) {
		rb_frames_probe_path(scene->probes[i].name, path);
		struct rb_frames_column *const column = add_column(h5, frames, path, "value",
		                                                   &layout);
		column->of_probe = true;
		column->probe = i;
		rb_h5_units(h5, column->path, scene->probes[i].units);
		rb_h5_attribute_text(h5, column->path, "description", scene->probes[i].description);
	}
}

/* Every element has its step and time: one dataset each under many names. */
static void link_steps(struct rb_h5 *h5, const struct rb_frames *frames)
{
	char element[RB_FRAMES_PATH_SIZE], path[RB_FRAMES_PATH_SIZE + 8];

	for (int i = 0; i < frames->column_count; i++) {
		const struct rb_frames_column *const column = &frames->columns[i];
		if (!column->source && !column->of_probe)
			continue;
		snprintf(element, sizeof element, "%s", column->path);
		*strrchr(element, '/') = '\0';
		if (strncmp(frames->step->path, element, strlen(element)) == 0 &&
		    frames->step->path[strlen(element)] == '/')
			continue;
		snprintf(path, sizeof path, "%s/step", element);
		rb_h5_link(h5, frames->step->path, path);
		snprintf(path, sizeof path, "%s/time", element);
		rb_h5_link(h5, frames->time->path, path);
	}
}

/* Makes the datasets of a table. */
static void add_table(struct rb_h5 *h5, struct rb_frames_table *table,
                      const struct rb_table_cell *cells, int count, hsize_t chunk_rows)
{
	RB_ASSERT(count <= RB_TABLE_COLUMNS_MAX);
	table->on = true;
	table->cells = cells;
	for (int i = 0; i < count; i++) {
		struct rb_h5_layout layout = {.kind = cells[i].kind, .chunk_rows = chunk_rows};
		if (cells[i].width > 1)
			layout.row = (rb_h5_shape){1, {(hsize_t)cells[i].width}};
		rb_h5_column_create(h5, &table->columns[i], cells[i].path, &layout);
		rb_h5_units(h5, cells[i].path, cells[i].units);
	}
	table->column_count = count;
}

/* Writes "0 collision, 1 rest, ..." at the column of kinds. */
static void name_kinds(struct rb_h5 *h5)
{
	char text[320];
	size_t used = 0;

	for (int kind = 0; kind < RB_EVENT_KIND_COUNT; kind++)
		used += (size_t)snprintf(text + used, sizeof text - used, "%s%d %s",
		                         kind == 0 ? "" : ", ", kind,
		                         rb_event_kind_name((enum rb_event_kind)kind));
	rb_h5_attribute_text(h5, "/rbsim/events/kind", "kinds", text);
}

void rb_frames_create(struct rb_h5 *h5, struct rb_frames *frames, const struct rb_run_info *info)
{
	const struct cut cut = plan_cut(info);
	const struct rb_model *const model = info->model;

	*frames = (struct rb_frames){.model = model,
	                             .fields = stored_fields(info),
	                             .chunk_rows = cut.chunk_rows,
	                             .capacity = cut.capacity,
	                             .numbers_capacity = cut.numbers_rows > cut.capacity
	                                                         ? cut.numbers_rows
	                                                         : cut.capacity};
	frames->every = info->scene->record.every > 1 ? (uint64_t)info->scene->record.every : 1;
	if (model->body_count == 0)
		frames->fields &= ~(unsigned)(RB_FIELD_DEFAULT | RB_FIELD_LOADS);
	frames->columns = rb_memory_take(RB_FRAMES_COLUMNS_MAX + (size_t)model->scene->probe_count,
	                                 sizeof *frames->columns);
	if (!frames->columns) {
		if (!h5->status)
			h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY,
			                     "cannot record frames: out of memory");
		return;
	}

	const char *first = NULL; /* the element that step and time are made in */
	for (int i = 0; i < RB_FRAMES_SOURCE_COUNT; i++) {
		if (sources[i].field != 0 && !(frames->fields & sources[i].field))
			continue;
		if ((sources[i].where == RB_FRAMES_LEDGER && !model->keeps_ledger) ||
		    (sources[i].where == RB_FRAMES_TREE && !rb_gravitation_by_tree(model)))
			continue;
		add_source(h5, frames, &sources[i], info, &cut);
		first = first ? first : sources[i].path;
	}
	add_probes(h5, frames, &cut);
	const struct rb_h5_layout end = {.kind = RB_H5_U64, .chunk_rows = cut.numbers_rows};
	if (frames->fields & RB_FIELD_EVENTS) {
		frames->events.row_size = sizeof(struct rb_event);
		add_table(h5, &frames->events, event_cells,
		          RB_EVENT_CELL_COUNT - (info->scene->joint_count == 0), cut.table_rows);
		name_kinds(h5);
		frames->event_end = add_column(h5, frames, "/rbsim/frames", "event_end", &end);
	}
	if (frames->fields & RB_FIELD_CONTACTS) {
		frames->contacts.row_size = sizeof(struct rb_contact_row);
		add_table(h5, &frames->contacts, contact_cells, RB_CONTACT_CELL_COUNT,
		          cut.table_rows);
		frames->contact_end = add_column(h5, frames, "/rbsim/frames", "contact_end", &end);
	}
	struct rb_h5_layout clock = {.kind = RB_H5_F64, .chunk_rows = cut.numbers_rows};
	frames->time = add_column(h5, frames, first, "time", &clock);
	rb_h5_units(h5, frames->time->path, "s");
	clock.kind = RB_H5_I64;
	frames->step = add_column(h5, frames, first, "step", &clock);
	link_steps(h5, frames);
	if (model->keeps_ledger) { /* MDAnalysis wants a value in a group that holds others */
		rb_h5_link(h5, "/observables/momentum/value", "/observables/ledger/momentum/value");
		rb_h5_link(h5, "/observables/momentum/step", "/observables/ledger/momentum/step");
		rb_h5_link(h5, "/observables/momentum/time", "/observables/ledger/momentum/time");
	}
}

/*
 * Whether columns of bodies are written from the frames that they came in: as they are, and where
 * so few frames as are kept make a write that is worth its call.
 */
static bool can_keep(const struct rb_frames *frames, hsize_t rows)
{
	const struct rb_record_def *const record = &frames->model->scene->record;
	const double bytes = 24 * (double)rows * frames->model->body_count;

	return frames->every == 1 && record->compression == 0 && !record->single_precision &&
	       rows > 0 &&
	       bytes >= fmin(chunk_bytes / 2,
	                     24 * (double)frames->chunk_rows * frames->model->body_count);
}

void rb_frames_take_buffers(struct rb_h5 *h5, struct rb_frames *frames, int keep_most)
{
	const hsize_t most = (hsize_t)keep_most < frames->chunk_rows ? (hsize_t)keep_most
	                                                             : frames->chunk_rows;
	bool failed = false;

	if (h5->status)
		return;
	RB_ASSERT(frames->capacity > 0 && keep_most >= 0);
	if (can_keep(frames, most)) {
		/* equal parts of a chunk */
		const hsize_t parts = (frames->chunk_rows + most - 1) / most;
		frames->capacity = (frames->chunk_rows + parts - 1) / parts;
		frames->kept = rb_memory_take((size_t)frames->capacity, sizeof *frames->kept);
		failed = !frames->kept;
	}
	for (int i = 0; i < frames->column_count; i++) {
		struct rb_frames_column *const column = &frames->columns[i];
		const hsize_t rows = column->of_bodies ? frames->capacity
		                                       : frames->numbers_capacity;
		if (frames->kept && column->of_bodies)
			continue;
		column->buffer = rb_memory_take((size_t)rows, column->column.row_bytes);
		failed |= !column->buffer;
	}
	if (failed)
		h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY,
		                     "cannot buffer %d bodies: out of memory",
		                     frames->model->body_count);
}

/* The last of `rows` numbers; false when it cannot be had. */
static bool last_of(const struct rb_h5_column *column, hsize_t rows, void *number)
{
	const hsize_t start[1] = {rows - 1}, count[1] = {1};
	const hid_t space = rows <= column->there ? H5Dget_space(column->dataset) : -1;
	const hid_t memory = H5Screate_simple(1, count, NULL);
	const bool good = space >= 0 &&
	                  H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >=
	                          0 &&
	                  H5Dread(column->dataset, column->type, memory, space, H5P_DEFAULT,
	                          number) >= 0;

	RB_ASSERT(rows > 0);
	rb_h5_done(memory);
	rb_h5_done(space);
	return good;
}

/* Sets a table to where the frames before it end; false: it is shorter than that. */
static bool go_on_table(struct rb_frames_table *table, const struct rb_frames_column *end,
                        hsize_t rows)
{
	uint64_t count = 0;

	if (!table->on)
		return true;
	if (rows > 0 && !last_of(&end->column, rows, &count))
		return false;
	for (int i = 0; i < table->column_count; i++) {
		if (table->columns[i].there < count)
			return false;
		table->columns[i].rows = count;
	}
	table->rows_written = count;
	return true;
}

void rb_frames_go_on(struct rb_h5 *h5, struct rb_frames *frames, hsize_t rows, uint64_t frame)
{
	int64_t step = -1;
	bool good = true;

	RB_ASSERT(h5->there || h5->status);
	if (h5->status)
		return;
	frames->there = frames->step->column.there;
	for (int i = 0; i < frames->column_count; i++) {
		struct rb_h5_column *const column = &frames->columns[i].column;

		good = good && rows <= column->there;
		frames->there = column->there < frames->there ? column->there : frames->there;
		column->rows = rows;
	}
	frames->written = frames->bodies_written = rows;
	good = good && go_on_table(&frames->events, frames->event_end, rows) &&
	       go_on_table(&frames->contacts, frames->contact_end, rows);
	if (good && rows > 0)
		good = last_of(&frames->step->column, rows, &step) && step == (int64_t)frame;
	if (!good)
		h5->status = RB_FAIL(&h5->error, RB_ERR_INPUT,
		                     "'%s' does not hold the frames up to %llu", h5->name,
		                     (unsigned long long)frame);
}

/* Calls `act` for every dataset, that of `step` last. */
static void each_column(struct rb_frames *frames,
                        void (*act)(void *user, struct rb_h5_column *column), void *user)
{
	for (int i = 0; i < frames->events.column_count; i++)
		act(user, &frames->events.columns[i]);
	for (int i = 0; i < frames->contacts.column_count; i++)
		act(user, &frames->contacts.columns[i]);
	for (int i = 0; i < frames->column_count; i++)
		act(user, &frames->columns[i].column);
}

static void detach(void *user, struct rb_h5_column *column)
{
	(void)user;
	rb_h5_column_detach(column);
}

static void attach(void *user, struct rb_h5_column *column)
{
	rb_h5_column_attach(user, column);
}

static void forget(void *user, struct rb_h5_column *column)
{
	(void)user;
	column->dataset = -1;
}

static void close_column(void *user, struct rb_h5_column *column)
{
	(void)user;
	rb_h5_column_close(column);
}

void rb_frames_detach(struct rb_frames *frames)
{
	each_column(frames, detach, NULL);
}

void rb_frames_forget(struct rb_frames *frames)
{
	each_column(frames, forget, NULL);
}

void rb_frames_attach(struct rb_h5 *h5, struct rb_frames *frames)
{
	each_column(frames, attach, h5);
}

void rb_frames_release(struct rb_frames *frames)
{
	each_column(frames, close_column, NULL);
	for (int i = 0; i < frames->column_count; i++)
		rb_memory_free(frames->columns[i].buffer);
	rb_memory_free(frames->columns);
	rb_memory_free(frames->kept);
	rb_memory_free(frames->events.rows);
	rb_memory_free(frames->events.cells_out);
	rb_memory_free(frames->contacts.rows);
	rb_memory_free(frames->contacts.cells_out);
	*frames = (struct rb_frames){0};
}

uint64_t rb_frames_plain(const struct rb_frames *frames, uint64_t count)
{
	uint64_t bytes = 0;

	for (int i = 0; i < frames->column_count; i++)
		bytes += rb_h5_column_plain(&frames->columns[i].column, count);
	return bytes;
}

uint64_t rb_frames_pretend(struct rb_h5 *h5, struct rb_frames *frames, uint64_t count)
{
	uint64_t bytes = 0;

	for (int i = 0; i < frames->column_count; i++) {
		rb_h5_column_extend(h5, &frames->columns[i].column, count);
		bytes += rb_h5_column_bytes(&frames->columns[i].column, count);
	}
	frames->written = frames->bodies_written = count;
	return bytes;
}
