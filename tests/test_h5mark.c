/* SPDX-License-Identifier: MIT */
/* src/sink/h5mark.c: the marks that a killed writer leaves, beside those of the library */
#include "support.h"

#include <errno.h>
#include <fcntl.h>

#include "math/random.h"
#include "sink/h5file.h"
#include "sink/h5mark.h"

enum { FLAGS_AT = 11, END_AT = 28, SUM_AT = 44, HEAD = 48 };

struct place {
	char folder[256], path[300], copy[300];
	struct rb_error err;
};

static void open_place(struct place *place)
{
	*place = (struct place){0};
	rb_h5_quiet();
	support_folder(place->folder);
	snprintf(place->path, sizeof place->path, "%s/f.h5", place->folder);
	snprintf(place->copy, sizeof place->copy, "%s/copy.h5", place->folder);
}

static void close_place(struct place *place)
{
	unlink(place->path);
	unlink(place->copy);
	assert_int_equal(rmdir(place->folder), 0);
}

/* A file with a column of `rows` numbers, each its place. */
static hid_t make_file(const struct place *place, hsize_t rows)
{
	const hid_t access = rb_h5_access(1), properties = H5Pcreate(H5P_DATASET_CREATE);
	const hid_t file = H5Fcreate(place->path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
	const hsize_t size[1] = {rows}, most[1] = {H5S_UNLIMITED}, chunk[1] = {64};
	const hid_t space = H5Screate_simple(1, size, most);

	H5Pset_chunk(properties, 1, chunk);
	const hid_t dataset = H5Dcreate2(file, "/x", H5T_NATIVE_INT, space, H5P_DEFAULT, properties,
	                                 H5P_DEFAULT);
	int *numbers = rb_memory_take(rows, sizeof *numbers);
	assert_true(file >= 0 && dataset >= 0 && numbers);
	for (hsize_t i = 0; i < rows; i++)
		numbers[i] = (int)i;
	assert_true(H5Dwrite(dataset, H5T_NATIVE_INT, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) >= 0);
	rb_memory_free(numbers);
	rb_h5_done(dataset);
	rb_h5_done(space);
	rb_h5_done(properties);
	rb_h5_done(access);
	return file;
}

/* Whether the library opens it to write, and finds all numbers. */
static bool is_sound(const char *path, hsize_t rows)
{
	const hid_t access = rb_h5_access(1);
	const hid_t file = H5Fopen(path, H5F_ACC_RDWR, access);
	const hid_t dataset = file < 0 ? -1 : H5Dopen2(file, "/x", H5P_DEFAULT);
	int *numbers = rb_memory_take(rows, sizeof *numbers);
	bool sound = dataset >= 0 &&
	             H5Dread(dataset, H5T_NATIVE_INT, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) >= 0;

	for (hsize_t i = 0; sound && i < rows; i++)
		sound = numbers[i] == (int)i;
	rb_memory_free(numbers);
	rb_h5_done(dataset);
	if (file >= 0)
		H5Fclose(file);
	rb_h5_done(access);
	return sound;
}

/* All bytes of a file as they are now, to be freed. */
static unsigned char *bytes_of(const char *path, size_t *size)
{
	const int fd = open(path, O_RDONLY);

	assert_true(fd >= 0);
	*size = (size_t)lseek(fd, 0, SEEK_END);
	unsigned char *const bytes = rb_memory_take(*size + 1, 1);
	assert_int_equal(pread(fd, bytes, *size, 0), *size);
	close(fd);
	return bytes;
}

static int put_bytes(const char *path, const unsigned char *bytes, size_t size)
{
	const int fd = open(path, O_RDWR | O_CREAT | O_TRUNC, 0600);

	assert_true(fd >= 0);
	assert_int_equal(write(fd, bytes, size), size);
	return fd;
}

/* A file as a writer that is killed leaves it, in memory, to be freed. */
static unsigned char *killed(struct place *place, hsize_t rows, size_t *size)
{
	const hid_t file = make_file(place, rows);

	assert_true(H5Fstart_swmr_write(file) >= 0);
	assert_true(H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0);
	unsigned char *const bytes = bytes_of(place->path, size);
	H5Fclose(file);
	return bytes;
}

static void a_killed_writers_file_can_be_written_again(void **state)
{
	struct place place;
	struct rb_error err;
	bool was = false;
	size_t size;

	(void)state;
	open_place(&place);
	unsigned char *const bytes = killed(&place, 1000, &size);
	const int fd = put_bytes(place.copy, bytes, size);
	assert_false(is_sound(place.copy, 1000)); /* somebody writes it, says its mark */
	assert_ok(rb_mark_clear(fd, "copy.h5", &was, &err));
	assert_true(was);
	assert_true(is_sound(place.copy, 1000));
	assert_ok(rb_mark_clear(fd, "copy.h5", &was, &err));
	assert_false(was);
	close(fd);
	rb_memory_free(bytes);
	close_place(&place);
}

/* Whatever stands behind the end that the file knows of: nothing of it is given out once more. */
static void the_end_comes_behind_all_that_is_there(void **state)
{
	struct place place;
	struct rb_error err;
	unsigned char head[HEAD];
	size_t size;
	bool was;

	(void)state;
	open_place(&place);
	unsigned char *const bytes = killed(&place, 100, &size);
	const int fd = put_bytes(place.copy, bytes, size);
	assert_int_equal(pwrite(fd, "tail", 4, (off_t)size + 5000), 4);
	assert_ok(rb_mark_clear(fd, "copy.h5", &was, &err));
	assert_int_equal(pread(fd, head, HEAD, 0), HEAD);
	uint64_t end = 0;
	for (int i = 7; i >= 0; i--)
		end = end << 8 | head[END_AT + i];
	assert_int_equal(end, size + 5004);
	assert_int_equal(head[FLAGS_AT], 0);
	/* only the marks were written */
	assert_int_equal(lseek(fd, 0, SEEK_END), size + 5004);
	unsigned char *const after = rb_memory_take(size, 1);
	assert_int_equal(pread(fd, after, size, 0), size);
	assert_memory_equal(after, bytes, FLAGS_AT);
	assert_memory_equal(after + FLAGS_AT + 1, bytes + FLAGS_AT + 1, END_AT - FLAGS_AT - 1);
	assert_memory_equal(after + END_AT + 8, bytes + END_AT + 8, SUM_AT - END_AT - 8);
	assert_memory_equal(after + HEAD, bytes + HEAD, size - HEAD);
	rb_memory_free(after);
	close(fd);
	assert_true(is_sound(place.copy, 100));
	rb_memory_free(bytes);
	close_place(&place);
}

static void a_changed_byte_of_the_marks_is_found(void **state)
{
	struct place place;
	size_t size;

	(void)state;
	open_place(&place);
	unsigned char *const bytes = killed(&place, 100, &size);
	for (int at = 0; at < HEAD; at++) {
		for (int bit = 0; bit < 8; bit++) {
			unsigned char head[HEAD];
			bool was = true;

			bytes[at] ^= (unsigned char)(1 << bit);
			const int fd = put_bytes(place.copy, bytes, size);
			assert_int_equal(rb_mark_clear(fd, "f", &was, &place.err), RB_ERR_INPUT);
			assert_non_null(strstr(place.err.text, at < 8    ? "'f' is not an HDF5 file"
			                                       : at < 11 ? "'f' is"
			                                                 : "'f' is damaged"));
			assert_false(was);
			assert_int_equal(pread(fd, head, HEAD, 0), HEAD);
			assert_memory_equal(head, bytes, HEAD);
			close(fd);
			bytes[at] ^= (unsigned char)(1 << bit);
		}
	}
	rb_memory_free(bytes);
	close_place(&place);
}

/* For every length of a file and in every state: the sum is what the library would have written. */
static void images_get_the_marks_of_a_closed_file(void **state)
{
	struct place place;

	(void)state;
	open_place(&place);
	for (uint64_t k = 0; k < 30; k++) {
		const hsize_t rows = 1 + rb_random_bits(1, 0, k) % 5000;
		size_t size;

		H5Fclose(make_file(&place, rows));
		unsigned char *const wanted = bytes_of(place.path, &size);
		unsigned char *const image = bytes_of(place.path, &size);
		image[FLAGS_AT] = 5;
		for (int i = 0; i < 4; i++)
			image[SUM_AT + i] ^= 0x5a;
		for (int i = 0; i < 8; i++)
			image[END_AT + i] = 0xff;
		rb_mark_image(image, size);
		assert_memory_equal(image, wanted, size);
		rb_memory_free(image);
		rb_memory_free(wanted);
	}
	close_place(&place);
}

static void what_cannot_be_written_is_told(void **state)
{
	struct place place;
	size_t size;
	bool was;

	(void)state;
	open_place(&place);
	unsigned char *const bytes = killed(&place, 100, &size);
	close(put_bytes(place.copy, bytes, size));
	const int fd = open(place.copy, O_RDONLY);
	assert_int_equal(rb_mark_clear(fd, "f", &was, &place.err), RB_ERR_IO);
	assert_string_equal(place.err.text, "cannot write 'f': Bad file descriptor");
	close(fd);
	assert_int_equal(rb_mark_clear(-1, "f", &was, &place.err), RB_ERR_INPUT);
	rb_memory_free(bytes);
	close_place(&place);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_killed_writers_file_can_be_written_again),
		cmocka_unit_test(the_end_comes_behind_all_that_is_there),
		cmocka_unit_test(a_changed_byte_of_the_marks_is_found),
		cmocka_unit_test(images_get_the_marks_of_a_closed_file),
		cmocka_unit_test(what_cannot_be_written_is_told),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
