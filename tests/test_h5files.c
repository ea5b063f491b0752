/* SPDX-License-Identifier: MIT */
/* Files of a scene in its recording, to the last byte, and the scene that they give again. */
#include "own_folder.h"

#include "h5support.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <rbsim/model.h>

#include "flow/frame.h"
#include "script/load.h"
#include "sink/h5mark.h"
#include "sink/h5output.h"

static void put_file(const char *name, const void *bytes, size_t size)
{
	char path[512];
	FILE *const file = fopen(in_folder(path, name), "w");

	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, size, file), size);
	fclose(file);
}

/* Zeros at either end and in between, and what is no UTF-8. */
static const char bytes[] = "\0a\0\xff\xfe\0\0";

static void record_bytes(const char *path)
{
	struct fake fake;
	struct rb_error err;

	fake_init(&fake, 2, 3, false);
	assert_ok(rb_scene_add_file(&fake.scene, "t.lua", "-- \0 --", 7, NULL, &err));
	assert_ok(
		rb_scene_add_file(&fake.scene, "pictures/a.png", bytes, sizeof bytes, NULL, &err));
	assert_ok(rb_scene_add_file(&fake.scene, "part", "\xc3\xa9\n", 3, NULL, &err));
	assert_ok(rb_scene_add_file(&fake.scene, "void", "", 0, NULL, &err));
	unlink(path);
	assert_ok(fake_record(&fake, path, &err));
	fake_release(&fake);
}

static void files_come_back_to_the_last_byte(void **state)
{
	char path[512];
	struct rb_reader *reader;
	struct rb_error err;

	(void)state;
	record_bytes(in_folder(path, "a.h5"));
	assert_ok(rb_reader_open(&reader, path, &err));
	const struct rb_reading *const r = rb_reader_reading(reader);
	assert_int_equal(r->file_count, 4);
	assert_string_equal(r->file_names[0], "t.lua");
	assert_int_equal(r->file_sizes[0], 7);
	assert_memory_equal(r->file_texts[0], "-- \0 --", 8);
	assert_string_equal(r->file_names[1], "pictures/a.png");
	assert_int_equal(r->file_sizes[1], sizeof bytes);
	assert_memory_equal(r->file_texts[1], bytes, sizeof bytes);
	assert_string_equal(r->file_names[2], "part");
	assert_int_equal(r->file_sizes[2], 3);
	assert_string_equal(r->file_texts[2], "\xc3\xa9\n");
	assert_int_equal(r->file_sizes[3], 0);
	assert_string_equal(r->file_texts[3], "");
	rb_reader_close(reader);
}

/* A stored file that was changed, or is of another type or shape, by the HDF5 library itself. */
static void files_that_were_changed_are_refused(void **state)
{
	static const char name[] = "/rbsim/files/pictures%2Fa.png";
	char path[512];
	struct rb_reader *reader;
	struct rb_error err;
	unsigned char changed[sizeof bytes];

	(void)state;
	record_bytes(in_folder(path, "a.h5"));
	memcpy(changed, bytes, sizeof bytes);
	changed[3] ^= 1;
	const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
	const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
	assert_true(H5Dwrite(dataset, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, changed) >=
	            0);
	H5Dclose(dataset);
	H5Fclose(file);
	assert_int_equal(rb_reader_open(&reader, path, &err), RB_ERR_INPUT);
	assert_non_null(strstr(err.text, "/rbsim/files/pictures%2Fa.png' in '"));
	assert_non_null(strstr(err.text, "is damaged: its bytes are not those of its 'sha256'"));

	/* nobody says what the bytes must be */
	record_bytes(path);
	const hid_t again = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
	assert_true(H5Adelete_by_name(again, name, "sha256", H5P_DEFAULT) >= 0);
	H5Fclose(again);
	assert_int_equal(rb_reader_open(&reader, path, &err), RB_ERR_INPUT);

	/* numbers that are no bytes are no file: its text is empty */
	record_bytes(path);
	const hid_t third = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
	assert_true(H5Ldelete(third, name, H5P_DEFAULT) >= 0);
	const hid_t space = H5Screate_simple(1, (const hsize_t[]){4}, NULL);
	const hid_t other = H5Dcreate2(third, name, H5T_STD_I32LE, space, H5P_DEFAULT, H5P_DEFAULT,
	                               H5P_DEFAULT);
	assert_true(other >= 0);
	H5Dclose(other);
	H5Sclose(space);
	H5Fclose(third);
	assert_ok(rb_reader_open(&reader, path, &err));
	assert_int_equal(rb_reader_reading(reader)->file_count, 4);
	for (int i = 0; i < 4; i++)
		if (strcmp(rb_reader_reading(reader)->file_names[i], "pictures/a.png") == 0)
			assert_int_equal(rb_reader_reading(reader)->file_sizes[i], 0);
	rb_reader_close(reader);
}

/* One byte changed, and what came of it: 0 refused, 1 opened with texts that can be read to their ends, 2 neither. */
static int open_changed(const char *path, FILE *file, long at)
{
	struct rb_reader *reader;
	struct rb_error err;
	int result = 1;

	fseek(file, at, SEEK_SET);
	const int byte = fgetc(file);
	fseek(file, at, SEEK_SET);
	fputc(byte ^ 0x41, file);
	fflush(file);
	if (rb_reader_open(&reader, path, &err) == RB_OK) {
		const struct rb_reading *const r = rb_reader_reading(reader);
		for (int i = 0; i < r->file_count; i++)
			if (r->file_texts[i][r->file_sizes[i]] != '\0')
				result = 2;
		rb_reader_close(reader);
	} else {
		result = err.status == RB_ERR_INPUT ? 0 : 2;
	}
	fseek(file, at, SEEK_SET);
	fputc(byte, file);
	fflush(file);
	return result;
}

/* In a child: the library itself may lose memory over a damaged file. */
static void damaged_files_do_no_harm(void **state)
{
	enum { STRIDE = 211, SIGNATURE = 8 };
	char path[512];
	int status;

	(void)state;
	record_bytes(in_folder(path, "a.h5"));
	fflush(NULL);
	const pid_t child = fork();
	if (child == 0) {
		int results[3] = {0};
		FILE *const file = fopen(path, "r+");
		if (!file || fseek(file, 0, SEEK_END) != 0)
			_exit(3);
		const long size = ftell(file);
		alarm(100);
		for (long at = SIGNATURE; at < size; at += STRIDE)
			results[open_changed(path, file, at)]++;
		_exit(!(results[0] > 0 && results[1] > 0 && results[2] == 0));
	}
	waitpid(child, &status, 0);
	assert_int_equal(status, 0);
}

/* ---- the scene again ---- */

static const char scene_text[] =
	"local e = param('e', 0.1, 'restitution', {min = 0, max = 1})\n"
	"local n = param('n', 3, 'balls')\n"
	"local deep = param('deep', false, 'below')\n"
	"local word = param('word', 'x', 'a text')\n"
	"local part = require 'part'\n"
	"local r = math.random()\n"
	"world { duration = 1, gravity = {0, 0, -10}, title = word }\n"
	"local m = material { name = 'm', restitution = e, texture = 'worn.png', color = '#102030' "
	"}\n"
	"for i = 1, n do\n"
	"  sphere { name = i > 1 and 'ball' .. i or nil, radius = part.radius, material = m,\n"
	"           position = {i * 3 + math.random(), r, deep and -5 or 5}, static = i == 2,\n"
	"           texture = i == 3 and 'worn.png' or nil, visible = #word > 250 }\n"
	"end\n"
	"camera { name = 'main', position = function(t) return {t, e, n} end, look_at = body "
	"'ball3' }\n";

struct loaded {
	struct rb_script *script;
	struct rb_scene scene;
	struct rb_model *model;
	struct rb_mistakes mistakes;
};

static void load(struct loaded *loaded, const struct rb_script_options *options)
{
	struct rb_error err;

	*loaded = (struct loaded){0};
	assert_ok(
		rb_script_load(&loaded->script, &loaded->scene, &loaded->mistakes, options, &err));
	assert_ok(rb_model_create(&loaded->model, &loaded->scene, &loaded->mistakes, &err));
}

static void unload(struct loaded *loaded)
{
	rb_model_destroy(loaded->model);
	rb_script_destroy(loaded->script);
	rb_scene_release(&loaded->scene);
	rb_mistakes_release(&loaded->mistakes);
}

/* One frame, with the recorder that a run would have. */
static void record(const struct loaded *loaded, const char *path)
{
	struct rb_recorder *recorder;
	struct rb_sink sink;
	struct rb_error err;
	const struct rb_run_info info = {.version = "0",
	                                 .build = "",
	                                 .command = "",
	                                 .host = "",
	                                 .author = "",
	                                 .started = "",
	                                 .threads = 1,
	                                 .method = "",
	                                 .rollback = "",
	                                 .model = loaded->model,
	                                 .scene = &loaded->scene};
	const struct rb_recorder_options options = {.path = path, .how = RB_PLACE_REPLACE};

	assert_ok(rb_recorder_create(&recorder, &sink, &info, &options, &err));
	struct rb_frame frame;
	assert_ok(rb_frame_init(&frame, loaded->model, sink.fields, &err));
	assert_ok(sink.open(sink.self, &err));
	assert_ok(sink.frame(sink.self, &frame, &err));
	assert_ok(sink.close(sink.self, &(struct rb_outcome){.reason = ""}, &err));
	rb_recorder_destroy(recorder);
	rb_frame_release(&frame);
}

static void assert_same_vector(rb_vec3 a, rb_vec3 b)
{
	assert_memory_equal(&a, &b, sizeof a);
}

static void assert_same_scene(const struct rb_scene *a, const struct rb_scene *b)
{
	assert_int_equal(a->body_count, b->body_count);
	for (int i = 0; i < a->body_count; i++) {
		const struct rb_body_def *x = &a->bodies[i], *y = &b->bodies[i];
		assert_true(!x->name == !y->name);
		if (x->name)
			assert_string_equal(x->name, y->name);
		assert_string_equal(x->texture ? x->texture : "", y->texture ? y->texture : "");
		assert_same_vector(x->position, y->position);
		assert_true(x->shape.radius == y->shape.radius && x->is_static == y->is_static &&
		            x->visible == y->visible && x->material == y->material);
	}
	assert_true(a->materials[1].restitution == b->materials[1].restitution);
	assert_true(a->world.seed == b->world.seed);
	assert_string_equal(a->world.title, b->world.title);
	assert_int_equal(a->file_count, b->file_count);
	for (int i = 0; i < a->file_count; i++) {
		assert_string_equal(a->files[i].name, b->files[i].name);
		assert_string_equal(a->files[i].sha256, b->files[i].sha256);
	}
}

static void a_recording_gives_its_scene_again(void **state)
{
	static const unsigned char png[33] =
		"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\1\0\0\0\1\x08\2";
	char path[512], file[512], word[400], word_param[420];
	const char *params[] = {"e=0.30000000000000004", "n=4", "deep=true", word_param};
	const char *names[4] = {0}, *given[4];
	char stored[4][460];
	struct rb_source_file files[8];
	struct rb_reader *reader;
	struct rb_error err;
	struct loaded first, again;

	(void)state;
	memset(word, 'w', sizeof word - 1);
	word[sizeof word - 1] = '\0';
	snprintf(word_param, sizeof word_param, "word=%s", word);
	put_file("t.lua", scene_text, sizeof scene_text - 1);
	put_file("part.lua", "return { radius = 1.25 } -- \0", 29);
	put_file("worn.png", png, sizeof png);
	load(&first, &(struct rb_script_options){.path = in_folder(path, "t.lua"),
	                                         .params = params,
	                                         .param_count = 4,
	                                         .has_seed = true,
	                                         .seed = 77});
	record(&first, in_folder(file, "run.h5"));
	unlink(path);
	unlink(in_folder(path, "part.lua"));
	unlink(in_folder(path, "worn.png"));

	assert_ok(rb_reader_open(&reader, file, &err));
	const struct rb_reading *const r = rb_reader_reading(reader);
	assert_int_equal(r->param_count, 4);
	assert_int_equal(r->file_count, 3);
	for (int i = 0; i < 4; i++) {
		names[i] = r->param_names[i];
		snprintf(stored[i], sizeof stored[i], "%s=%s", names[i], r->param_values[i]);
		given[i] = stored[i];
	}
	for (int i = 0; i < r->file_count; i++)
		files[i] = (struct rb_source_file){.name = r->file_names[i],
		                                   .text = r->file_texts[i],
		                                   .size_bytes = r->file_sizes[i]};
	load(&again, &(struct rb_script_options){.path = r->file_names[0],
	                                         .params = given,
	                                         .param_count = r->param_count,
	                                         .has_seed = true,
	                                         .seed = r->seed,
	                                         .files = files,
	                                         .file_count = r->file_count});
	assert_int_equal(first.scene.body_count, 4);
	assert_true(first.scene.bodies[0].visible);
	assert_same_scene(&first.scene, &again.scene);
	assert_true(r->duration_s == again.model->duration_s &&
	            r->frame_rate == again.model->frame_rate &&
	            r->time_step_s == again.model->time_step_s &&
	            r->tolerance_m == again.model->tolerance_m);
	for (int i = 0; i < 3; i++)
		assert_int_equal(r->id[i], again.model->id_of[i]);
	rb_reader_close(reader);
	unload(&first);
	unload(&again);
}

static herr_t innermost(unsigned depth, const H5E_error2_t *entry, void *user)
{
	(void)depth;
	snprintf(user, 150, "%s", entry->desc);
	return 0;
}

/* Of all that the library says of a failure, what failed first. */
static void a_failure_is_told_by_what_failed_first(void **state)
{
	char first[150] = "", last[150] = "", said[160], wanted[170];

	(void)state;
	rb_h5_quiet();
	assert_true(H5Dopen2(H5P_DEFAULT, "nowhere", H5P_DEFAULT) < 0);
	assert_true(H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, innermost, first) >= 0);
	snprintf(wanted, sizeof wanted, "HDF5: %s", first);
	assert_string_equal(rb_h5_reason(said), wanted);
	assert_true(H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, innermost, last) >= 0);
	assert_string_not_equal(first, last);
}

/* Cut before its end, or of another kind by a single byte: it is no HDF5 file, and stays as it is. */
static void what_is_no_hdf5_file_is_not_marked(void **state)
{
	char path[512], before[4096], after[4096];

	(void)state;
	record_bytes(in_folder(path, "a.h5"));
	for (int k = 0; k < 9; k++) {
		const int fd = open(path, O_RDWR);
		struct rb_error err = {0};
		bool was = true;

		assert_int_equal(pread(fd, before, sizeof before, 0), sizeof before);
		const char other = (char)(before[k % 8] + 1);
		if (k < 8)
			assert_int_equal(pwrite(fd, &other, 1, k), 1);
		else
			assert_int_equal(ftruncate(fd, 40), 0);
		assert_int_equal(rb_mark_clear(fd, "a.h5", &was, &err), RB_ERR_INPUT);
		assert_string_equal(err.text, "'a.h5' is not an HDF5 file");
		assert_false(was);
		if (k < 8) {
			assert_int_equal(pwrite(fd, before + k, 1, k), 1);
			assert_int_equal(pread(fd, after, sizeof after, 0), sizeof after);
			assert_memory_equal(before, after, sizeof before);
			assert_ok(rb_mark_clear(fd, "a.h5", &was, &err));
			assert_false(was);
		}
		close(fd);
	}
}

/* Whatever end is asked for: bytes that are there stay. */
static void a_file_is_lengthened_and_never_cut(void **state)
{
	static const uint64_t ends[] = {10, 4096, 100, 5000, 5000, 0};
	struct rb_output output;
	struct rb_error err;
	struct stat found;
	char path[512];
	uint64_t most = 0;

	(void)state;
	assert_ok(rb_output_open(&output, in_folder(path, "long"), true, &err));
	const int file = open(output.library, O_RDWR | O_CREAT, 0666);
	assert_true(file >= 0);
	close(file);
	assert_ok(rb_output_attach(&output, &err));
	for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
		rb_output_lengthen(&output, ends[i]);
		most = ends[i] > most ? ends[i] : most;
		assert_int_equal(fstat(output.fd, &found), 0);
		assert_int_equal(found.st_size, most);
	}
	rb_output_release(&output);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(files_come_back_to_the_last_byte),
		cmocka_unit_test(files_that_were_changed_are_refused),
		cmocka_unit_test(damaged_files_do_no_harm),
		cmocka_unit_test(a_recording_gives_its_scene_again),
		cmocka_unit_test(a_failure_is_told_by_what_failed_first),
		cmocka_unit_test(what_is_no_hdf5_file_is_not_marked),
		cmocka_unit_test(a_file_is_lengthened_and_never_cut),
	};

	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
