/* SPDX-License-Identifier: MIT */
/* src/sink/h5input.c: what is read from a file that nobody vouches for, and what is not */
#include "h5place.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "math/random.h"
#include "sink/h5input.h"

/* The file closed, and open for reading. */
static void open_input(struct file *file, struct rb_input *input)
{
	struct rb_error err;

	if (file->h5.status)
		fail_msg("%s", file->h5.error.text);
	assert_true(H5Fclose(file->h5.file) >= 0);
	file->h5.file = -1;
	assert_ok(rb_input_open(input, file->path, &err));
}

static void close_input(struct file *file, struct rb_input *input)
{
	rb_input_close(input);
	rb_input_close(input);
	assert_int_equal(H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_ALL), 0);
	assert_int_equal(unlink(file->path), 0);
	assert_int_equal(rmdir(file->folder), 0);
}

static void numbers_come_back_in_the_kind_that_is_asked_for(void **state)
{
	static const double numbers[2][3] = {{1, 2.5, -3}, {4, 5, 1e300}};
	struct file file;
	struct rb_input input;
	double back[2][3] = {{0}}, one = 0;
	int32_t whole[4] = {0};
	hsize_t rows = 0;

	(void)state;
	open_file(&file);
	rb_h5_put(&file.h5, "/a/m", RB_H5_F64, (rb_h5_shape){2, {2, 3}}, numbers);
	rb_h5_put(&file.h5, "/n", RB_H5_I64, (rb_h5_shape){1, {4}}, (const int64_t[]){1, -2, 3, 4});
	rb_h5_put_f64(&file.h5, "/s", 0.1);
	open_input(&file, &input);
	assert_true(rb_input_numbers(&input, "/a/m", RB_H5_F64, (rb_h5_shape){2, {2, 3}}, back));
	assert_memory_equal(back, numbers, sizeof back);
	assert_true(rb_input_numbers(&input, "/n", RB_H5_I32, (rb_h5_shape){1, {4}}, whole));
	assert_true(whole[0] == 1 && whole[1] == -2 && whole[3] == 4);
	assert_true(rb_input_numbers(&input, "/s", RB_H5_F64, (rb_h5_shape){0}, &one));
	assert_true(one == 0.1);
	/* of another shape, or none at all */
	assert_false(rb_input_numbers(&input, "/a/m", RB_H5_F64, (rb_h5_shape){2, {3, 2}}, back));
	assert_false(rb_input_numbers(&input, "/a/m", RB_H5_F64, (rb_h5_shape){1, {6}}, back));
	assert_false(rb_input_numbers(&input, "/s", RB_H5_F64, (rb_h5_shape){1, {1}}, back));
	assert_false(rb_input_numbers(&input, "/a", RB_H5_F64, (rb_h5_shape){0}, back));
	assert_false(rb_input_numbers(&input, "/a/x", RB_H5_F64, (rb_h5_shape){0}, back));

	/* row by row; the sizes that are not known are filled in */
	rb_h5_shape row = {1, {0}};
	const hid_t dataset = rb_input_dataset(&input, "/a/m", true, &row, &rows);
	assert_true(dataset >= 0);
	assert_true(rows == 2 && row.size[0] == 3);
	assert_true(rb_input_rows(dataset, RB_H5_F64, row, (const hsize_t[]){1, 1}, back));
	assert_memory_equal(back[0], numbers[1], sizeof back[0]);
	assert_true(rb_input_rows(dataset, RB_H5_F64, row, (const hsize_t[]){5, 0}, back));
	assert_false(rb_input_rows(dataset, RB_H5_F64, row, (const hsize_t[]){1, 2}, back));
	assert_false(
		rb_input_rows(dataset, RB_H5_F64, row, (const hsize_t[]){UINT64_MAX, 2}, back));
	rb_h5_done(dataset);
	assert_int_equal(rb_input_row_count(&input, "/n"), 4);
	assert_int_equal(rb_input_row_count(&input, "/a/m"), 0); /* no list */
	assert_int_equal(rb_input_row_count(&input, "/none"), 0);
	close_input(&file, &input);
}

static void texts_end_and_stay_within_their_memory(void **state)
{
	static const char *const names[] = {"one", "", "three"};
	struct file file;
	struct rb_input input;
	struct rb_arena arena = {0};
	struct rb_error err;
	char again[8];
	size_t room = 0;

	(void)state;
	open_file(&file);
	rb_h5_text(&file.h5, "/full", "no zero", 7);
	rb_h5_text(&file.h5, "/short", "x", 7);
	rb_h5_texts(&file.h5, "/list", names, 3);
	rb_h5_put(&file.h5, "/bytes", RB_H5_U8, (rb_h5_shape){1, {3}}, "a\0b");
	rb_h5_put(&file.h5, "/signed", RB_H5_I8, (rb_h5_shape){1, {3}}, "a\0b");
	rb_h5_put_f64(&file.h5, "/number", 1);
	rb_h5_attribute_text(&file.h5, "/full", "units", "m/s");
	rb_h5_attribute(&file.h5, "/full", "n", RB_H5_I64, 0, &(int64_t){1});
	open_input(&file, &input);
	assert_string_equal(rb_input_text(&input, "/full", &arena, &room), "no zero");
	assert_int_equal(room, 7);
	assert_string_equal(rb_input_text(&input, "/short", &arena, NULL), "x");
	assert_null(rb_input_text(&input, "/number", &arena, NULL));
	assert_null(rb_input_text(&input, "/list", &arena, NULL));
	assert_null(rb_input_text(&input, "/none", &arena, NULL));
	assert_true(rb_input_text_again(&input, "/full", again, 7));
	assert_string_equal(again, "no zero");
	assert_false(rb_input_text_again(&input, "/full", again, 6)); /* it had another length */

	const char **list = rb_input_texts(&input, "/list", 3, &arena);
	assert_non_null(list);
	for (int i = 0; i < 3; i++)
		assert_string_equal(list[i], names[i]);
	list = rb_input_texts(&input, "/list", 4, &arena); /* not so many: none */
	assert_non_null(list);
	for (int i = 0; i < 4; i++)
		assert_string_equal(list[i], "");

	char *bytes = rb_input_bytes(&input, "/bytes", &arena, &room);
	assert_non_null(bytes);
	assert_int_equal(room, 3);
	assert_memory_equal(bytes, "a\0b", 4);
	assert_null(rb_input_bytes(&input, "/signed", &arena, &room));
	assert_int_equal(room, 0);
	assert_string_equal(rb_input_attribute(&input, "/full", "units", &arena), "m/s");
	assert_null(rb_input_attribute(&input, "/full", "n", &arena));
	assert_null(rb_input_attribute(&input, "/full", "none", &arena));
	assert_null(rb_input_attribute(&input, "/none", "units", &arena));

	assert_int_equal(rb_input_no_text(&input, "/number", "r.h5", &err), RB_ERR_INPUT);
	assert_string_equal(err.text, "'r.h5' is not a recording of rbsim: '/number' is missing or "
	                              "no text");
	assert_int_equal(rb_input_no_text(&input, "/full", "r.h5", &err), RB_ERR_INPUT);
	assert_string_equal(err.text, "'r.h5' is damaged: cannot read '/full'");
	rb_memory_fail_at(1);
	assert_int_equal(rb_input_no_text(&input, "/full", "r.h5", &err), RB_ERR_MEMORY);
	rb_memory_fail_at(0);
	rb_arena_release(&arena);
	close_input(&file, &input);
}

static void members_come_in_the_order_they_were_made(void **state)
{
	struct file file;
	struct rb_input input;
	struct rb_arena arena = {0};
	const char **names;
	char path[2000];

	(void)state;
	open_file(&file);
	rb_h5_group_ordered(&file.h5, "/made");
	rb_h5_put_f64(&file.h5, "/made/z", 1);
	rb_h5_put_f64(&file.h5, "/made/a", 1);
	rb_h5_put_f64(&file.h5, "/made/m", 1);
	rb_h5_put_f64(&file.h5, "/named/z", 1);
	rb_h5_put_f64(&file.h5, "/named/a", 1);
	/* a name that is too long for us is passed over */
	strcpy(path, "/made/");
	memset(path + 6, 'x', 1500);
	path[1506] = '\0';
	rb_h5_put_f64(&file.h5, path, 1);
	open_input(&file, &input);
	assert_int_equal(rb_input_members(&input, "/made", 10, &names, &arena), 3);
	assert_string_equal(names[0], "z");
	assert_string_equal(names[1], "a");
	assert_string_equal(names[2], "m");
	assert_int_equal(rb_input_members(&input, "/made", 2, &names, &arena), 2);
	assert_int_equal(rb_input_members(&input, "/named", 10, &names, &arena), 2);
	assert_string_equal(names[0], "a"); /* without an order: by name */
	assert_int_equal(rb_input_members(&input, "/none", 10, &names, &arena), 0);
	assert_int_equal(rb_input_members(&input, "/made/z", 10, &names, &arena), 0);
	assert_false(rb_input_has(&input, path));
	rb_arena_release(&arena);
	close_input(&file, &input);
}

/* Another file may be anything: the password file, or one that lies on a slow network. */
static void no_link_leads_out_of_the_file(void **state)
{
	struct file file;
	struct rb_input input;
	char other[300];
	double x = 0;

	(void)state;
	open_file(&file);
	rb_h5_put_f64(&file.h5, "/a/x", 7);
	rb_h5_link_soft(&file.h5, "/a/x", "/soft");
	rb_h5_link_soft(&file.h5, "/a", "/way");
	rb_h5_link_soft(&file.h5, "/lost", "/a/lost");
	rb_h5_link(&file.h5, "/a/x", "/hard");
	snprintf(other, sizeof other, "%s/f.h5", file.folder);
	assert_true(H5Lcreate_external(other, "/a", file.h5.file, "/out", H5P_DEFAULT,
	                               H5P_DEFAULT) >= 0);
	open_input(&file, &input);
	assert_true(rb_input_has(&input, "/a/x") && rb_input_has(&input, "/a"));
	assert_true(rb_input_numbers(&input, "/hard", RB_H5_F64, (rb_h5_shape){0}, &x));
	assert_true(x == 7);
	static const char *const none[] = {"/soft", "/way",   "/way/x", "/a/lost",
	                                   "/out",  "/out/x", "/a/x/y", "/b"};
	for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
		assert_false(rb_input_has(&input, none[i]));
		assert_false(rb_input_numbers(&input, none[i], RB_H5_F64, (rb_h5_shape){0}, &x));
	}
	close_input(&file, &input);
}

/* A dataset of numbers by other properties than ours. */
static void put_with(struct file *file, const char *path, hid_t properties, hid_t type,
                     hsize_t size)
{
	const hid_t space = H5Screate_simple(1, &size, NULL);
	const hid_t dataset = H5Dcreate2(file->h5.file, path, type, space, H5P_DEFAULT, properties,
	                                 H5P_DEFAULT);

	assert_true(dataset >= 0);
	rb_h5_done(dataset);
	rb_h5_done(space);
	rb_h5_done(properties);
}

static void data_elsewhere_or_of_other_types_is_not_read(void **state)
{
	const hsize_t ten = 10, large = (hsize_t)1 << 40, chunk = (hsize_t)1 << 27;
	struct file file;
	struct rb_input input;
	double x[10];

	(void)state;
	open_file(&file);
	hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
	H5Pset_external(properties, "/etc/hostname", 0, H5F_UNLIMITED);
	put_with(&file, "/external", properties, H5T_IEEE_F64LE, 10);
	properties = H5Pcreate(H5P_DATASET_CREATE);
	const hid_t space = H5Screate_simple(1, &ten, NULL);
	H5Pset_virtual(properties, space, "/etc/hostname", "/x", space);
	put_with(&file, "/virtual", properties, H5T_IEEE_F64LE, 10);
	rb_h5_done(space);
	properties = H5Pcreate(H5P_DATASET_CREATE);
	H5Pset_chunk(properties, 1, &ten);
	H5Pset_scaleoffset(properties, H5Z_SO_INT, 0);
	put_with(&file, "/filter", properties, H5T_STD_I32LE, 10);
	/* more than the file can hold: nothing is taken for it */
	properties = H5Pcreate(H5P_DATASET_CREATE);
	H5Pset_chunk(properties, 1, &ten);
	put_with(&file, "/large", properties, H5T_IEEE_F64LE, large);
	properties = H5Pcreate(H5P_DATASET_CREATE);
	H5Pset_chunk(properties, 1, &chunk);
	H5Pset_deflate(properties, 1);
	put_with(&file, "/chunk", properties, H5T_IEEE_F64LE, chunk);
	put_with(&file, "/enum", H5Pcreate(H5P_DATASET_CREATE), H5T_STD_REF_OBJ, 10);
	/* and so that one is right */
	properties = H5Pcreate(H5P_DATASET_CREATE);
	H5Pset_chunk(properties, 1, &ten);
	H5Pset_shuffle(properties);
	H5Pset_deflate(properties, 1);
	H5Pset_fletcher32(properties);
	put_with(&file, "/right", properties, H5T_IEEE_F64BE, 10);
	const hid_t text = H5Tcopy(H5T_C_S1);
	H5Tset_size(text, H5T_VARIABLE);
	put_with(&file, "/text", H5Pcreate(H5P_DATASET_CREATE), text, 10);
	rb_h5_done(text);
	open_input(&file, &input);
	static const char *const none[] = {"/external", "/virtual", "/filter", "/large",
	                                   "/chunk",    "/enum",    "/text"};
	for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
		rb_h5_shape shape = {1, {0}};
		hsize_t rows;

		assert_true(rb_input_has(&input, none[i]));
		if (rb_input_dataset(&input, none[i], false, &shape, &rows) >= 0)
			fail_msg("'%s' is read", none[i]);
		assert_int_equal(rb_input_row_count(&input, none[i]), 0);
	}
	assert_true(rb_input_numbers(&input, "/right", RB_H5_F64, (rb_h5_shape){1, {10}}, x));
	struct rb_arena arena = {0};
	const char **texts = rb_input_texts(&input, "/text", 10, &arena);
	assert_non_null(texts);
	assert_string_equal(texts[9], "");
	rb_arena_release(&arena);
	close_input(&file, &input);
}

static void assert_refused(const char *path, const char *part)
{
	struct rb_input input;
	struct rb_error err;

	if (rb_input_open(&input, path, &err) != RB_ERR_INPUT)
		fail_msg("%s: wanted %s", path, part);
	if (!strstr(err.text, part))
		fail_msg("'%s' has no '%s'", err.text, part);
	rb_input_close(&input);
}

static void what_is_no_whole_hdf5_file_is_refused(void **state)
{
	struct file file;
	unsigned char bytes[4096];
	ssize_t size;

	(void)state;
	open_file(&file);
	rb_h5_put_f64(&file.h5, "/x", 7);
	assert_true(H5Fclose(file.h5.file) >= 0);
	const int fd = open(file.path, O_RDWR);
	size = pread(fd, bytes, sizeof bytes, 0);
	assert_true(size > 96);
	static const size_t cuts[] = {0, 1, 7, 8, 20, 47, 48, 95};
	for (size_t i = 0; i < sizeof cuts / sizeof *cuts; i++) {
		assert_int_equal(ftruncate(fd, (off_t)cuts[i]), 0);
		assert_refused(file.path, cuts[i] == 0  ? "is empty"
		                          : cuts[i] < 8 ? "is not an HDF5 file"
		                                        : "is cut off: ");
		assert_int_equal(pwrite(fd, bytes, (size_t)size, 0), size);
	}
	assert_int_equal(pwrite(fd, "x", 1, 3), 1);
	assert_refused(file.path, "is not an HDF5 file");
	close(fd);
	unlink(file.path);
	assert_refused(file.path, "No such file");
	assert_refused(file.folder, "it is a folder");
	assert_int_equal(mkfifo(file.path, 0600), 0);
	assert_refused(file.path, "it is not a regular file");
	unlink(file.path);
	assert_int_equal(rmdir(file.folder), 0);
}

/* One byte changed, and all read; false: an answer that cannot be. */
static bool read_changed(const struct file *file, int fd, const unsigned char *bytes, size_t size,
                         uint64_t k)
{
	const off_t at = (off_t)(48 + rb_random_bits(1, k, 0) % (size - 48));
	const unsigned char other = (unsigned char)rb_random_bits(1, k, 1);
	struct rb_arena arena = {0};
	struct rb_input input;
	struct rb_error err;
	const char **names;
	double m[6];
	size_t count;
	bool right = pwrite(fd, bytes, size, 0) == (ssize_t)size && pwrite(fd, &other, 1, at) == 1;

	if (rb_input_open(&input, file->path, &err) == RB_OK) {
		(void)rb_input_numbers(&input, "/a/m", RB_H5_F64, (rb_h5_shape){2, {2, 3}}, m);
		const char *text = rb_input_text(&input, "/a/t", &arena, &count);
		right = right && (!text || strlen(text) <= count);
		text = rb_input_bytes(&input, "/a/b", &arena, &count);
		right = right && (!text || text[count] == '\0');
		const char **texts = rb_input_texts(&input, "/a/list", 2, &arena);
		right = right && texts && strlen(texts[0]) <= size && strlen(texts[1]) <= size;
		(void)rb_input_attribute(&input, "/a/m", "units", &arena);
		const int members = rb_input_members(&input, "/a", 10, &names, &arena);
		right = right && members >= 0 && members <= 10;
		for (int i = 0; i < members; i++)
			right = right && strlen(names[i]) > 0;
	} else {
		right = right && err.status == RB_ERR_INPUT && *err.text;
	}
	rb_input_close(&input);
	rb_arena_release(&arena);
	return right;
}

/* In a child: the library itself may lose memory over a damaged file. */
static void damaged_files_are_read_without_harm(void **state)
{
	struct file file;
	int status = -1;

	(void)state;
	open_file(&file);
	rb_h5_put(&file.h5, "/a/m", RB_H5_F64, (rb_h5_shape){2, {2, 3}}, (const double[6]){1});
	rb_h5_text(&file.h5, "/a/t", "a text", 9);
	rb_h5_put(&file.h5, "/a/b", RB_H5_U8, (rb_h5_shape){1, {3}}, "abc");
	rb_h5_texts(&file.h5, "/a/list", (const char *const[]){"a", "b"}, 2);
	rb_h5_attribute_text(&file.h5, "/a/m", "units", "m");
	assert_int_equal(file.h5.status, RB_OK);
	assert_true(H5Fclose(file.h5.file) >= 0);
	const int fd = open(file.path, O_RDWR);
	const size_t size = (size_t)lseek(fd, 0, SEEK_END);
	unsigned char *const bytes = rb_memory_take(size, 1);
	assert_int_equal(pread(fd, bytes, size, 0), size);
	fflush(NULL);
	const pid_t child = fork();
	if (child == 0) {
		bool right = true;

		for (uint64_t k = 0; k < 400; k++)
			right = read_changed(&file, fd, bytes, size, k) && right;
		_exit(!right);
	}
	assert_int_equal(waitpid(child, &status, 0), child);
	assert_int_equal(status, 0);
	close(fd);
	rb_memory_free(bytes);
	unlink(file.path);
	assert_int_equal(rmdir(file.folder), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(numbers_come_back_in_the_kind_that_is_asked_for),
		cmocka_unit_test(texts_end_and_stay_within_their_memory),
		cmocka_unit_test(members_come_in_the_order_they_were_made),
		cmocka_unit_test(no_link_leads_out_of_the_file),
		cmocka_unit_test(data_elsewhere_or_of_other_types_is_not_read),
		cmocka_unit_test(what_is_no_whole_hdf5_file_is_refused),
		cmocka_unit_test(damaged_files_are_read_without_harm),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
