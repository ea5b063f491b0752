/* SPDX-License-Identifier: MIT */
/* src/sink/reader.c and src/sink/h5input.c: what a recording says, and files that are none. */
#include "own_folder.h"

#include "force/drag.h"
#include "force/spring.h"

#include "h5support.h"

#include <fcntl.h>
#include <hdf5.h>
#include <sys/stat.h>
#include <sys/wait.h>

static void add_texts(struct fake *fake)
{
	const struct rb_param_def e = {.name = "e",
	                               .help = "restitution",
	                               .type = RB_PARAM_NUMBER,
	                               .default_text = "0.8",
	                               .value_text = "0.5",
	                               .value = 0.5,
	                               .min = 0,
	                               .max = 1};
	const struct rb_param_def odd = {.name = "a/b.%",
	                                 .help = "",
	                                 .type = RB_PARAM_TEXT,
	                                 .default_text = "",
	                                 .value_text = "\xc3\xa9t\xc3\xa9",
	                                 .min = (double)NAN,
	                                 .max = (double)NAN};

	assert_int_equal(rb_scene_add_param(&fake->scene, &e, NULL), RB_OK);
	assert_int_equal(rb_scene_add_param(&fake->scene, &odd, NULL), RB_OK);
	assert_int_equal(rb_scene_add_file(&fake->scene, "scene.lua", "world {}\n", 9, "", NULL),
	                 RB_OK);
	assert_int_equal(rb_scene_add_file(&fake->scene, "rbsim.zeta", "return 1", 8, "", NULL),
	                 RB_OK);
	assert_int_equal(rb_scene_add_file(&fake->scene, "parts/alpha", "", 0, "", NULL), RB_OK);
}

/* A small recording with everything in it. */
static void record(const char *path, int bodies, uint64_t frames)
{
	struct fake fake;
	struct rb_error err;

	unlink(path);
	fake_init(&fake, bodies, frames, true);
	add_texts(&fake);
	fake.scene.record.fields |= RB_FIELD_CONTACTS | RB_FIELD_EVENTS;
	assert_ok(fake_record(&fake, path, &err));
	fake_release(&fake);
}

static void a_recording_says_how_it_was_made(void **slot)
{
	char path[512];
	struct rb_reader *reader;
	struct rb_error err;

	(void)slot;
	record(in_folder(path, "a.h5"), 3, 20);
	assert_ok(rb_reader_open(&reader, path, &err));
	const struct rb_reading *const r = rb_reader_reading(reader);
	assert_int_equal(r->body_count, 3);
	assert_int_equal(r->static_count, 1);
	assert_int_equal(r->frame_count, 20);
	assert_string_equal(r->status, "complete");
	assert_string_equal(r->reason, "");
	assert_string_equal(r->state_hash, "0123456789abcdef");
	assert_int_equal(strlen(r->ended), 27);
	assert_string_equal(r->started, "2026-01-01T00:00:00Z");
	assert_string_equal(r->version, "0.0.0");
	assert_string_equal(r->command, "rbsim scene.lua");
	assert_string_equal(r->title, "made by hand");
	assert_string_equal(r->method, "classic");
	assert_int_equal(r->seed, 1);
	assert_true(r->frame_rate == 60 && r->tolerance_m == 1e-6 && r->time_step_s == 1.0 / 240);
	assert_int_equal(r->fields, RB_FIELD_DEFAULT | RB_FIELD_CONTACTS | RB_FIELD_EVENTS);
	assert_int_equal(r->id[0], 0);
	assert_int_equal(r->id[1], 2);
	assert_string_equal(r->names[0], "body 0");
	assert_string_equal(r->names[1], "");
	assert_int_equal(r->param_count, 2);
	assert_string_equal(r->param_names[0], "e");
	assert_string_equal(r->param_values[0], "0.5");
	assert_string_equal(r->param_names[1], "a/b.%");
	assert_string_equal(r->param_values[1], "\xc3\xa9t\xc3\xa9");
	assert_int_equal(r->file_count, 3);
	assert_string_equal(r->file_names[0], "scene.lua");
	assert_string_equal(r->file_texts[0], "world {}\n");
	assert_string_equal(r->file_names[1],
	                    "rbsim.zeta"); /* in the order of the scene, not of names */
	assert_string_equal(r->file_names[2], "parts/alpha");
	assert_string_equal(r->file_texts[2], "");
	rb_reader_close(reader);
}

static void a_recording_tells_of_springs_and_driven_bodies(void **slot)
{
	char path[512], kinds[200] = "";
	struct rb_reader *reader;
	struct rb_error err;
	struct fake fake;
	unsigned char driven[3] = {0, 1, 1};
	int index_of[4] = {0, 3, 1, 2};
	struct rb_spring_def spring = rb_spring_def_default();
	const struct rb_drag_def drag = {.linear = 2};
	const struct rb_field_def field = {.function = 1};

	(void)slot;
	fake_init(&fake, 3, 2, true);
	fake.model.driven = driven;
	fake.model.mass[1] = fake.model.mass[2] = (double)INFINITY;
	fake.scene.record.fields |= RB_FIELD_EVENTS;
	spring.a = 0;
	spring.b = 2;
	spring.stiffness = 7;
	for (int i = 0; i < 4; i++)
		assert_ok(rb_scene_add_spring(&fake.scene, &spring, &err));
	assert_ok(rb_scene_add_drag(&fake.scene, &drag, &err));
	for (int i = 0; i < 2; i++)
		assert_ok(rb_scene_add_field(&fake.scene, &field, &err));
	fake.model.index_of = index_of;
	assert_ok(rb_elements_create(&fake.model, &err));
	unlink(in_folder(path, "springs.h5"));
	assert_ok(fake_record(&fake, path, &err));
	rb_elements_destroy(&fake.model);
	fake_release(&fake);

	assert_ok(rb_reader_open(&reader, path, &err));
	const struct rb_reading *const r = rb_reader_reading(reader);
	assert_int_equal(r->driven_count, 2);
	assert_int_equal(r->element_counts[rb_element_place(&rb_force_spring)], 4);
	assert_int_equal(r->element_counts[rb_element_place(&rb_force_drag)], 1);
	assert_int_equal(r->field_count, 2);
	rb_reader_close(reader);

	const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
	double stiffness[4];
	signed char by_id[4]; /* id 1 is the static plane */
	hid_t dataset = H5Dopen2(file, "/rbsim/springs/stiffness", H5P_DEFAULT);
	assert_true(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, stiffness) >=
	            0);
	assert_near(stiffness[3], 7, 0);
	H5Dclose(dataset);
	dataset = H5Dopen2(file, "/rbsim/shapes/driven", H5P_DEFAULT);
	assert_true(H5Dread(dataset, H5T_NATIVE_SCHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, by_id) >= 0);
	assert_true(!by_id[0] && !by_id[1] && by_id[2] && by_id[3]);
	H5Dclose(dataset);
	const hid_t attribute = H5Aopen_by_name(file, "/rbsim/events/kind", "kinds", H5P_DEFAULT,
	                                        H5P_DEFAULT);
	const hid_t type = H5Aget_type(attribute);
	assert_true(H5Tget_size(type) < sizeof kinds);
	assert_true(H5Aread(attribute, type, kinds) >= 0);
	assert_string_equal(kinds, "0 collision, 1 rest, 2 slide, 3 roll, 4 lift, 5 edge, 6 merge, "
	                           "7 impulse, 8 angular_impulse, 9 displacement, 10 limit, "
	                           "11 taut, 12 slack, 13 drives, 14 slips");
	H5Tclose(type);
	H5Aclose(attribute);
	H5Fclose(file);

	/* a scene without them has no word of them */
	record(in_folder(path, "plain.h5"), 3, 2);
	const hid_t plain = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
	assert_true(H5Lexists(plain, "/rbsim/springs", H5P_DEFAULT) == 0);
	assert_true(H5Lexists(plain, "/rbsim/shapes/driven", H5P_DEFAULT) == 0);
	assert_true(H5Lexists(plain, "/rbsim/shapes/collides_with", H5P_DEFAULT) == 0);
	assert_true(H5Lexists(plain, "/rbsim/forces", H5P_DEFAULT) == 0);
	H5Fclose(plain);
}

static void read_column(hid_t file, const char *path, hid_t type, void *out)
{
	const hid_t dataset = H5Dopen2(file, path, H5P_DEFAULT);

	assert_true(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out) >= 0);
	H5Dclose(dataset);
}

static void a_recording_tells_who_meets_whom_and_what_pulls(void **slot)
{
	char path[512];
	struct rb_error err;
	struct fake fake;
	uint64_t group[4] = {1, 2, 4, 8}, collides[4] = {8, 4, UINT64_MAX, 1};
	const struct rb_force_def force = {.vector = {0, 3, 1}, .start_s = 2, .duration_s = 5};
	uint64_t of_group[4], with[4];
	int body[2];
	double vector[2][3];

	(void)slot;
	fake_init(&fake, 3, 2, true);
	fake.model.group_bit = group;
	fake.model.collides = collides;
	for (int id = 0; id < 4; id += 3) { /* the first and the last of the scene */
		struct rb_body_def *const def = &fake.scene.bodies[id];
		assert_ok(rb_scene_add_force(&fake.scene, &force, &err));
		def->force_first = fake.scene.force_count - 1;
		def->force_count = 1;
	}
	unlink(in_folder(path, "meets.h5"));
	assert_ok(fake_record(&fake, path, &err));
	fake_release(&fake);

	const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
	read_column(file, "/rbsim/shapes/group", H5T_NATIVE_UINT64, of_group);
	read_column(file, "/rbsim/shapes/collides_with", H5T_NATIVE_UINT64, with);
	read_column(file, "/rbsim/forces/body", H5T_NATIVE_INT, body);
	read_column(file, "/rbsim/forces/vector", H5T_NATIVE_DOUBLE, vector);
	/* by id: the static plane, the last of the columns, has id 1 */
	assert_true(of_group[0] == 1 && of_group[1] == 8 && of_group[2] == 2 && of_group[3] == 4);
	assert_true(with[0] == 8 && with[1] == 1 && with[2] == 4 && with[3] == UINT64_MAX);
	assert_true(body[0] == 0 && body[1] == 3 && vector[1][1] == 3 && vector[1][2] == 1);
	H5Fclose(file);
}

static void an_event_of_no_kind_is_damage(void **slot)
{
	char path[512];
	struct rb_reader *reader;
	struct rb_error err;
	struct rb_frame frame;
	int kinds[19];

	(void)slot;
	record(in_folder(path, "kind.h5"), 3, 20);
	const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
	const hid_t dataset = H5Dopen2(file, "/rbsim/events/kind", H5P_DEFAULT);
	for (int i = 0; i < 19; i++)
		kinds[i] = i == 10 ? -1 : 0;
	const hid_t space = H5Screate_simple(1, (const hsize_t[]){19}, NULL);
	assert_true(H5Dwrite(dataset, H5T_NATIVE_INT, space, H5S_ALL, H5P_DEFAULT, kinds) >= 0);
	H5Sclose(space);
	H5Dclose(dataset);
	H5Fclose(file);
	assert_ok(rb_reader_open(&reader, path, &err));
	enum rb_status status = RB_OK;
	for (uint64_t k = 0; k < 20 && status == RB_OK; k++)
		status = rb_reader_frame(reader, k, &frame, &err);
	assert_int_equal(status, RB_ERR_INPUT);
	assert_non_null(strstr(err.text, "has kind -1"));
	rb_reader_close(reader);
}

static void observables_are_read_whole(void **slot)
{
	char path[512];
	struct rb_reader *reader;
	struct rb_error err;
	double values[60];

	(void)slot;
	record(in_folder(path, "a.h5"), 3, 20);
	assert_ok(rb_reader_open(&reader, path, &err));
	assert_ok(rb_reader_observable(reader, "kinetic_energy", 1, values, &err));
	for (int k = 0; k < 20; k++)
		assert_true(values[k] == k);
	assert_ok(rb_reader_observable(reader, "momentum", 3, values, &err));
	assert_true(values[57] == 1 && values[58] == 2 && values[59] == 19);
	assert_ok(rb_reader_observable(reader, "contacts", 1, values, &err));
	assert_true(values[7] == 3);
	assert_int_equal(rb_reader_observable(reader, "momentum", 1, values, &err), RB_ERR_INPUT);
	assert_int_equal(rb_reader_observable(reader, "entropy", 1, values, &err), RB_ERR_INPUT);
	rb_reader_close(reader);
}

static void a_row_beyond_the_end_is_refused(void **slot)
{
	char path[512];
	struct rb_reader *reader;
	struct rb_frame frame;
	struct rb_error err;

	(void)slot;
	record(in_folder(path, "a.h5"), 3, 20);
	assert_ok(rb_reader_open(&reader, path, &err));
	assert_int_equal(rb_reader_frame(reader, 20, &frame, &err), RB_ERR_INPUT);
	assert_null(frame.position);
	rb_reader_close(reader);
}

static void write_bytes(const char *path, const void *bytes, size_t size)
{
	FILE *file = fopen(path, "w");

	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, size, file), size);
	fclose(file);
}

static unsigned char *load_bytes(const char *path, size_t *size)
{
	struct stat found;
	FILE *file = fopen(path, "r");

	assert_non_null(file);
	assert_int_equal(fstat(fileno(file), &found), 0);
	*size = (size_t)found.st_size;
	unsigned char *bytes = malloc(*size);
	assert_int_equal(fread(bytes, 1, *size, file), *size);
	fclose(file);
	return bytes;
}

static void assert_refused(const char *path, const char *text)
{
	struct rb_reader *reader = (struct rb_reader *)1;
	struct rb_error err;

	assert_int_equal(rb_reader_open(&reader, path, &err), RB_ERR_INPUT);
	assert_null(reader);
	if (!strstr(err.text, text) || strstr(err.text, "h5clear"))
		fail_msg("'%s' should say '%s'", err.text, text);
}

static void files_that_are_no_recordings_are_refused_by_name(void **slot)
{
	char path[512];

	(void)slot;
	assert_refused(in_folder(path, "absent.h5"), "No such file");
	assert_refused(folder, "it is a folder");
	assert_refused("/dev/null", "not a regular file");
	write_bytes(in_folder(path, "empty.h5"), "", 0);
	assert_refused(path, "is empty");
	write_bytes(in_folder(path, "text.h5"), "world { duration = 1 }", 22);
	assert_refused(path, "is not an HDF5 file");
	rb_h5_quiet();
	H5Fclose(H5Fcreate(in_folder(path, "foreign.h5"), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
	assert_refused(path, "is not a recording of rbsim");
}

static void a_file_that_was_cut_off_is_refused_clearly(void **slot)
{
	char path[512];
	size_t size;

	(void)slot;
	record(in_folder(path, "a.h5"), 3, 20);
	unsigned char *const bytes = load_bytes(path, &size);
	for (size_t part = 1; part < 40; part++) {
		write_bytes(in_folder(path, "cut.h5"), bytes, size * part / 40);
		assert_refused(path, "is cut off");
	}
	write_bytes(path, bytes, 20);
	assert_refused(path, "is cut off");
	free(bytes);
}

/* Something else in the place of an object of the recording. */
static void replace(const char *path, const char *object, hid_t type, int rank, const hsize_t *size)
{
	const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
	const hsize_t chunk[4] = {1, 1, 1, 1};
	const hid_t space = rank > 0 ? H5Screate_simple(rank, size, NULL) : H5Screate(H5S_SCALAR);
	const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);

	assert_true(file >= 0 && H5Ldelete(file, object, H5P_DEFAULT) >= 0);
	if (rank > 0)
		H5Pset_chunk(properties, rank, chunk);
	assert_true(H5Dcreate2(file, object, type, space, H5P_DEFAULT, properties, H5P_DEFAULT) >=
	            0);
	H5Pclose(properties);
	H5Sclose(space);
	/* closes what is open in it */
	const ssize_t open = H5Fget_obj_count(file, H5F_OBJ_DATASET);
	hid_t ids[4];
	H5Fget_obj_ids(file, H5F_OBJ_DATASET, 4, ids);
	for (ssize_t i = 0; i < open; i++)
		H5Dclose(ids[i]);
	H5Fclose(file);
}

static void wrong_shapes_and_types_are_refused(void **slot)
{
	static const hsize_t huge[] = {1ull << 60, 3, 3}, other[] = {20, 4, 3}, flat[] = {20},
			     none[] = {0};
	char path[512];

	(void)slot;
	rb_h5_quiet();
	const hid_t text = H5Tcopy(H5T_C_S1), endless = H5Tcopy(H5T_C_S1);
	H5Tset_size(text, 8);
	H5Tset_size(endless, H5T_VARIABLE);
	const struct {
		const char *object;
		hid_t type;
		int rank;
		const hsize_t *size;
	} cases[] = {
		{"/particles/bodies/position/value", H5T_NATIVE_DOUBLE, 3, huge},
		{"/particles/bodies/position/value", H5T_NATIVE_DOUBLE, 3, other},
		{"/particles/bodies/velocity/value", H5T_NATIVE_DOUBLE, 1, flat},
		{"/particles/bodies/orientation/value", text, 3, (const hsize_t[]){20, 3, 4}},
		{"/particles/bodies/position/step", H5T_NATIVE_DOUBLE, 2, other},
		{"/particles/bodies/id", H5T_NATIVE_INT, 1, huge},
		{"/particles/bodies/id", H5T_NATIVE_INT, 1, flat},
		{"/particles/statics/id", H5T_NATIVE_INT, 1, huge},
		{"/observables/momentum/value", H5T_NATIVE_DOUBLE, 2, (const hsize_t[]){20, 2}},
		{"/rbsim/events/point", H5T_NATIVE_DOUBLE, 1, flat},
		{"/rbsim/frames/contact_end", text, 1, flat},
		{"/rbsim/version", endless, 0, NULL},
		{"/rbsim/version", H5T_NATIVE_DOUBLE, 0, NULL},
		{"/rbsim/status", text, 1, flat},
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		record(in_folder(path, "wrong.h5"), 3, 20);
		replace(path, cases[i].object, cases[i].type, cases[i].rank, cases[i].size);
		assert_refused(path, "wrong.h5");
	}

	/* no frame is what the shortest column has */
	struct rb_reader *reader;
	struct rb_error err;
	record(path, 3, 20);
	replace(path, "/particles/bodies/position/step", H5T_NATIVE_INT64, 1, none);
	assert_ok(rb_reader_open(&reader, path, &err));
	assert_int_equal(rb_reader_reading(reader)->frame_count, 0);
	rb_reader_close(reader);
	H5Tclose(text);
	H5Tclose(endless);
}

static void links_out_of_the_file_are_not_followed(void **slot)
{
	char path[512], other[512];

	(void)slot;
	record(in_folder(other, "other.h5"), 3, 20);
	for (int soft = 0; soft < 2; soft++) {
		record(in_folder(path, "linked.h5"), 3, 20);
		const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
		assert_true(H5Ldelete(file, "/rbsim/version", H5P_DEFAULT) >= 0);
		if (soft)
			assert_true(H5Lcreate_soft("/rbsim/build", file, "/rbsim/version",
			                           H5P_DEFAULT, H5P_DEFAULT) >= 0);
		else
			assert_true(H5Lcreate_external(other, "/rbsim/version", file,
			                               "/rbsim/version", H5P_DEFAULT,
			                               H5P_DEFAULT) >= 0);
		H5Fclose(file);
		assert_refused(path, "'/rbsim/version' is missing");
	}
}

/* All that can be asked of a file, whatever comes back. */
static void read_everything(const char *path)
{
	static const char *const names[] = {"kinetic_energy", "momentum", "contacts", "time"};
	struct rb_reader *reader;
	struct rb_error err;
	struct rb_frame frame;
	double sum = 0;
	size_t length = 0;

	if (rb_reader_open(&reader, path, &err) != RB_OK)
		return;
	const struct rb_reading *const r = rb_reader_reading(reader);
	for (uint64_t row = 0; row < r->frame_count && row < 100; row++) {
		if (rb_reader_frame(reader, row, &frame, &err) != RB_OK)
			continue;
		for (int i = 0; frame.position && i < 3 * frame.body_count; i++)
			sum += frame.position[i];
		for (int i = 0; i < frame.event_count; i++)
			sum += frame.events[i].time_s;
		for (int i = 0; i < frame.contact_count; i++)
			sum += frame.contacts[i].gap;
	}
	double *const values = calloc((size_t)r->frame_count * 3 + 1, sizeof *values);
	for (size_t i = 0; values && i < sizeof names / sizeof names[0]; i++)
		length += rb_reader_observable(reader, names[i], i == 1 ? 3 : 1, values, &err) ==
		          RB_OK;
	free(values);
	for (int i = 0; i < r->body_count + r->static_count; i++)
		length += strlen(r->names[i]);
	for (int i = 0; i < r->param_count; i++)
		length += strlen(r->param_names[i]) + strlen(r->param_values[i]);
	for (int i = 0; i < r->file_count; i++)
		length += strlen(r->file_names[i]) + strlen(r->file_texts[i]);
	length += rb_reader_refresh(reader, &err) == RB_OK;
	rb_reader_close(reader);
	if (sum == 0.1 && length == 1) /* so that nothing is optimised away */
		print_message("\n");
}

/* The same, but its writer is killed: marked as being written. */
static void record_and_die(const char *path, int bodies, uint64_t frames)
{
	struct fake fake;
	int status;

	fflush(NULL);
	const pid_t child = fork();
	if (child == 0) {
		fake_init(&fake, bodies, frames, true);
		fake.scene.record.fields |= RB_FIELD_CONTACTS | RB_FIELD_EVENTS;
		_exit(fake_open(&fake, path, true, NULL) != RB_OK ||
		      fake_push(&fake, 0, frames, NULL) != RB_OK ||
		      fake.sink.idle(fake.sink.self, NULL) != RB_OK);
	}
	waitpid(child, &status, 0);
	assert_int_equal(status, 0);
}

/* Its tables hold less than its frames say: what all hold is read, whatever is missing. */
/* The column of events' kinds with its first rows alone. */
static void cut_short(hid_t file, hid_t dataset, hsize_t rows)
{
	const hid_t type = H5Dget_type(dataset), space = H5Screate_simple(1, &rows, NULL);
	unsigned char value[1024];

	assert_true(34 * H5Tget_size(type) <= sizeof value);
	assert_true(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value) >= 0);
	assert_true(H5Ldelete(file, "/rbsim/events/kind", H5P_DEFAULT) >= 0);
	const hid_t made = H5Dcreate2(file, "/rbsim/events/kind", type, space, H5P_DEFAULT,
	                              H5P_DEFAULT, H5P_DEFAULT);
	assert_true(rows == 0 || H5Dwrite(made, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value) >= 0);
	H5Dclose(made);
	H5Sclose(space);
	H5Tclose(type);
}

static void of_tables_that_are_cut_short_whole_frames_are_read(void **slot)
{
	char path[512];
	struct rb_reader *reader;
	struct rb_error err;
	uint64_t whole = 0, last = 1;

	(void)slot;
	for (hsize_t left = 0; left < 34; left++) {
		record(in_folder(path, "short.h5"), 3, 30);
		const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
		const hid_t dataset = H5Dopen2(file, "/rbsim/events/kind", H5P_DEFAULT);
		const hid_t space = H5Dget_space(dataset);
		hsize_t size;
		H5Sget_simple_extent_dims(space, &size, NULL);
		if (left <= size)
			cut_short(file, dataset, left);
		H5Sclose(space);
		H5Dclose(dataset);
		H5Fclose(file);
		assert_ok(rb_reader_open(&reader, path, &err));
		const struct rb_reading *const r = rb_reader_reading(reader);
		/* a frame has as many events as its number, modulo three */
		uint64_t rows = 0, frames = 0;
		while (frames < 30 && rows + frames % 3 <= left)
			rows += frames++ % 3;
		assert_int_equal(r->frame_count, frames);
		whole += r->frame_count == 30;
		last = r->frame_count;
		rb_reader_close(reader);
	}
	assert_true(whole > 0 && last == 30);
}

/* A crash of the library would end the child, not the test; how many there are is said. */
static void flip(const char *path, const unsigned char *bytes, size_t size)
{
	const int batches = getenv("TEST_LONG") ? 200 : 6, each = 50;
	int crashed = 0;

	for (int batch = 0; batch < batches; batch++) {
		fflush(NULL);
		const pid_t child = fork();
		if (child == 0) {
			srand(1000u + (unsigned)batch);
			alarm(60);
			for (int i = 0; i < each; i++) {
				unsigned char *const copy = malloc(size);
				memcpy(copy, bytes, size);
				for (int k = 1 + i % 5; k > 0; k--)
					copy[(size_t)rand() * 7 % size] ^=
						(unsigned char)(1u << rand() % 8);
				write_bytes(path, copy, size);
				free(copy);
				read_everything(path);
			}
			_exit(0);
		}
		int status;
		waitpid(child, &status, 0);
		if (status != 0) {
			print_message("batch %d: status %#x\n", batch, (unsigned)status);
			crashed++;
		}
	}
	assert_int_equal(crashed, 0);
}

static void flipped_bytes_do_not_crash_the_reader(void **slot)
{
	char path[512];
	size_t size;

	(void)slot;
	for (int killed = 0; killed < 2; killed++) {
		in_folder(path, "flipped.h5");
		if (killed)
			record_and_die(path, 2, 5);
		else
			record(path, 2, 5);
		unsigned char *const bytes = load_bytes(path, &size);
		flip(path, bytes, size);
		free(bytes);
	}
}

static void no_memory_is_an_error(void **slot)
{
	char path[512];
	struct rb_reader *reader;
	struct rb_error err;
	int successes = 0;

	(void)slot;
	record(in_folder(path, "a.h5"), 3, 20);
	for (uint64_t k = 1; successes == 0 && k < 500; k++) {
		rb_memory_fail_at(k);
		const enum rb_status status = rb_reader_open(&reader, path, &err);
		rb_memory_fail_at(0);
		if (status != RB_OK)
			assert_true(status == RB_ERR_MEMORY || status == RB_ERR_INPUT);
		/* texts that are only for information may be missing */
		successes += status == RB_OK && rb_reader_reading(reader)->file_count == 3 &&
		             rb_reader_reading(reader)->file_texts[0][0] == 'w';
		rb_reader_close(reader);
	}
	assert_int_equal(successes, 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(of_tables_that_are_cut_short_whole_frames_are_read),
		cmocka_unit_test(flipped_bytes_do_not_crash_the_reader),
		cmocka_unit_test(a_recording_says_how_it_was_made),
		cmocka_unit_test(a_recording_tells_of_springs_and_driven_bodies),
		cmocka_unit_test(a_recording_tells_who_meets_whom_and_what_pulls),
		cmocka_unit_test(an_event_of_no_kind_is_damage),
		cmocka_unit_test(observables_are_read_whole),
		cmocka_unit_test(a_row_beyond_the_end_is_refused),
		cmocka_unit_test(files_that_are_no_recordings_are_refused_by_name),
		cmocka_unit_test(a_file_that_was_cut_off_is_refused_clearly),
		cmocka_unit_test(wrong_shapes_and_types_are_refused),
		cmocka_unit_test(links_out_of_the_file_are_not_followed),
		cmocka_unit_test(no_memory_is_an_error),
	};

	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
