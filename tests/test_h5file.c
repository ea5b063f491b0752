/* SPDX-License-Identifier: MIT */
/* src/sink/h5file.c: objects of an HDF5 file, read back by the library itself */
#include "h5place.h"

#include "math/random.h"
#include "sink/h5file.h"

/* Whatever the numbers are in memory, on disk they are little-endian. */
static void numbers_of_every_kind_come_back(void **state)
{
	static const size_t sizes[RB_H5_KIND_COUNT] = {8, 4, 8, 8, 4, 1, 1};
	unsigned char out[6 * 8], back[6 * 8];
	struct file file;
	char path[40];

	(void)state;
	open_file(&file);
	for (int k = 0; k < RB_H5_KIND_COUNT; k++) {
		const enum rb_h5_kind kind = (enum rb_h5_kind)k;

		assert_int_equal(rb_h5_size(kind), sizes[k]);
		assert_int_equal(H5Tget_size(rb_h5_type(kind)), sizes[k]);
		assert_int_equal(H5Tget_size(rb_h5_type_file(kind)), sizes[k]);
		assert_int_equal(H5Tget_class(rb_h5_type(kind)), k < 2 ? H5T_FLOAT : H5T_INTEGER);
		if (sizes[k] > 1)
			assert_int_equal(H5Tget_order(rb_h5_type_file(kind)), H5T_ORDER_LE);
		memset(out, k + 1, sizeof out);
		out[0] = 0x80;
		snprintf(path, sizeof path, "/a/b%d/value", k);
		rb_h5_put(&file.h5, path, kind, (rb_h5_shape){2, {2, 3}}, out);
		turn_file(&file, H5F_ACC_RDWR);
		const hid_t dataset = H5Dopen2(file.h5.file, path, H5P_DEFAULT);
		const hid_t space = H5Dget_space(dataset);
		hsize_t size[2];
		assert_int_equal(H5Sget_simple_extent_dims(space, size, NULL), 2);
		assert_true(size[0] == 2 && size[1] == 3);
		assert_true(H5Dread(dataset, rb_h5_type(kind), H5S_ALL, H5S_ALL, H5P_DEFAULT,
		                    back) >= 0);
		assert_memory_equal(out, back, 6 * sizes[k]);
		rb_h5_done(space);
		rb_h5_done(dataset);
	}
	rb_h5_put_f64(&file.h5, "/pi", 3.25);
	rb_h5_put_i64(&file.h5, "/n", INT64_MIN);
	rb_h5_put(&file.h5, "/none", RB_H5_F64, (rb_h5_shape){2, {0, 3}}, NULL);
	turn_file(&file, H5F_ACC_RDONLY);
	double pi = 0;
	int64_t n = 0;
	hid_t dataset = H5Dopen2(file.h5.file, "/pi", H5P_DEFAULT);
	assert_true(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &pi) >= 0);
	rb_h5_done(dataset);
	dataset = H5Dopen2(file.h5.file, "/n", H5P_DEFAULT);
	assert_true(H5Dread(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &n) >= 0);
	rb_h5_done(dataset);
	assert_true(pi == 3.25 && n == INT64_MIN);
	close_file(&file);
}

/* The text at `path`, and the bytes that it has on disk. */
static size_t read_text(struct file *file, const char *path, char out[100])
{
	const hid_t dataset = H5Dopen2(file->h5.file, path, H5P_DEFAULT);
	const hid_t type = H5Dget_type(dataset);
	const size_t size = H5Tget_size(type);

	assert_int_equal(H5Tget_class(type), H5T_STRING);
	assert_int_equal(H5Tget_cset(type), H5T_CSET_UTF8);
	assert_true(size < 100);
	memset(out, 0, 100);
	assert_true(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out) >= 0);
	rb_h5_done(type);
	rb_h5_done(dataset);
	return size;
}

static void texts_are_cut_between_characters(void **state)
{
	static const char word[] = "a\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80"; /* 1, 2, 3, 4 bytes */
	static const size_t whole[] = {1, 1, 1, 3, 3, 3, 6, 6, 6, 6, 10, 10};
	struct file file;
	char out[100], path[20];

	(void)state;
	open_file(&file);
	for (size_t room = 2; room < 12; room++) {
		snprintf(path, sizeof path, "/t%d", (int)room);
		rb_h5_text(&file.h5, path, word, room);
		assert_int_equal(read_text(&file, path, out), room);
		assert_int_equal(strlen(out), whole[room]);
		assert_memory_equal(out, word, strlen(out));
	}
	rb_h5_text(&file.h5, "/exact", "four", 0);
	assert_int_equal(read_text(&file, "/exact", out), 4);
	assert_string_equal(out, "four");
	rb_h5_text(&file.h5, "/empty", NULL, 0);
	assert_int_equal(read_text(&file, "/empty", out), 1);
	assert_string_equal(out, "");
	rb_h5_text_sized(&file.h5, "/sized", "a\0b", 3);
	assert_int_equal(read_text(&file, "/sized", out), 3);
	assert_memory_equal(out, "a\0b", 3);
	/* later texts, longer and shorter: nothing of the one before is left */
	rb_h5_text(&file.h5, "/status", "running", 12);
	rb_h5_retext(&file.h5, "/status", word);
	read_text(&file, "/status", out);
	assert_string_equal(out, word);
	rb_h5_retext(&file.h5, "/status", "0123456789\xe2\x82\xac");
	read_text(&file, "/status", out);
	assert_string_equal(out, "0123456789");
	rb_h5_retext(&file.h5, "/status", "x");
	read_text(&file, "/status", out);
	assert_memory_equal(out, "x\0\0\0\0\0\0\0\0\0\0\0", 12);
	turn_file(&file, H5F_ACC_RDONLY);
	close_file(&file);
}

static void lists_of_texts_have_one_length(void **state)
{
	static const char *const texts[] = {"one", NULL, "three", ""};
	struct file file;
	char out[20] = "";

	(void)state;
	open_file(&file);
	rb_h5_texts(&file.h5, "/list", texts, 4);
	rb_h5_texts(&file.h5, "/none", NULL, 0);
	turn_file(&file, H5F_ACC_RDONLY);
	const hid_t dataset = H5Dopen2(file.h5.file, "/list", H5P_DEFAULT);
	const hid_t type = H5Dget_type(dataset);
	assert_int_equal(H5Tget_size(type), 5);
	assert_true(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out) >= 0);
	assert_memory_equal(out, "one\0\0\0\0\0\0\0three\0\0\0\0\0", 20);
	rb_h5_done(type);
	rb_h5_done(dataset);
	close_file(&file);
}

static void the_first_failure_sticks(void **state)
{
	struct file file;

	(void)state;
	open_file(&file);
	rb_h5_put_f64(&file.h5, "/x", 1);
	rb_h5_put_f64(&file.h5, "/x/y", 2); /* a dataset holds none */
	assert_int_equal(file.h5.status, RB_ERR_IO);
	assert_ptr_equal(strstr(file.h5.error.text, "cannot write '/x/y' in 'f.h5': "),
	                 file.h5.error.text);
	const struct rb_error first = file.h5.error;
	rb_h5_put_f64(&file.h5, "/z", 3);
	rb_h5_group(&file.h5, "/g");
	rb_h5_text(&file.h5, "/t", "x", 0);
	rb_h5_retext(&file.h5, "/nowhere", "x");
	rb_h5_units(&file.h5, "/x", "m");
	rb_h5_link(&file.h5, "/x", "/l");
	rb_h5_link_soft(&file.h5, "/x", "/s");
	rb_h5_fail(&file.h5, "make", "/other");
	assert_string_equal(file.h5.error.text, first.text);
	static const char *const none[] = {"/z", "/g", "/t", "/l", "/s"};
	for (size_t i = 0; i < sizeof none / sizeof *none; i++)
		assert_int_equal(H5Lexists(file.h5.file, none[i], H5P_DEFAULT), 0);
	file.h5.status = RB_OK;
	rb_h5_retext(&file.h5, "/nowhere", "x");
	assert_int_equal(file.h5.status, RB_ERR_IO);
	file.h5.status = RB_OK;
	rb_memory_fail_at(1);
	rb_h5_text(&file.h5, "/t", "x", 0);
	rb_memory_fail_at(0);
	assert_int_equal(file.h5.status, RB_ERR_MEMORY);
	assert_string_equal(file.h5.error.text, "cannot record '/t': out of memory");
	file.h5.status = RB_OK;
	turn_file(&file, H5F_ACC_RDONLY);
	close_file(&file);
}

static void attributes_and_links_say_what_they_should(void **state)
{
	static const int64_t version[2] = {2, 7};
	struct file file;
	int64_t back[2] = {0};
	H5O_info_t a, b;
	char text[20] = "";

	(void)state;
	open_file(&file);
	rb_h5_put_f64(&file.h5, "/a/x", 1);
	rb_h5_units(&file.h5, "/a/x", "m/s^2");
	rb_h5_units(&file.h5, "/a/x", NULL); /* a pure number has none */
	rb_h5_attribute(&file.h5, "/a", "version", RB_H5_I64, 2, version);
	rb_h5_attribute_text(&file.h5, "/a", "author", "Zo\xc3\xab");
	rb_h5_link(&file.h5, "/a/x", "/b/c/x");
	rb_h5_link_soft(&file.h5, "/a/x", "/b/soft");
	turn_file(&file, H5F_ACC_RDONLY);
	hid_t attribute = H5Aopen_by_name(file.h5.file, "/a/x", "units", H5P_DEFAULT, H5P_DEFAULT);
	hid_t type = H5Aget_type(attribute);
	assert_int_equal(H5Tget_cset(type), H5T_CSET_ASCII);
	assert_int_equal(H5Tget_size(type), 5);
	assert_true(H5Aread(attribute, type, text) >= 0);
	assert_string_equal(text, "m/s^2");
	rb_h5_done(type);
	rb_h5_done(attribute);
	attribute = H5Aopen_by_name(file.h5.file, "/a", "author", H5P_DEFAULT, H5P_DEFAULT);
	type = H5Aget_type(attribute);
	assert_int_equal(H5Tget_cset(type), H5T_CSET_UTF8);
	rb_h5_done(type);
	rb_h5_done(attribute);
	attribute = H5Aopen_by_name(file.h5.file, "/a", "version", H5P_DEFAULT, H5P_DEFAULT);
	assert_true(H5Aread(attribute, H5T_NATIVE_INT64, back) >= 0);
	assert_true(back[0] == 2 && back[1] == 7);
	rb_h5_done(attribute);
#if H5_VERSION_GE(1, 12, 0)
	assert_true(H5Oget_info_by_name(file.h5.file, "/a/x", &a, H5O_INFO_BASIC, H5P_DEFAULT) >=
	            0);
	assert_true(H5Oget_info_by_name(file.h5.file, "/b/c/x", &b, H5O_INFO_BASIC, H5P_DEFAULT) >=
	            0);
	assert_memory_equal(&a.token, &b.token, sizeof a.token);
#else
	assert_true(H5Oget_info_by_name(file.h5.file, "/a/x", &a, H5P_DEFAULT) >= 0);
	assert_true(H5Oget_info_by_name(file.h5.file, "/b/c/x", &b, H5P_DEFAULT) >= 0);
	assert_true(a.addr == b.addr);
#endif
	assert_int_equal(a.rc, 2);
	assert_true(H5Oexists_by_name(file.h5.file, "/b/soft", H5P_DEFAULT) > 0);
	close_file(&file);
}

static void members_keep_their_order_where_that_is_asked_for(void **state)
{
	static const char *const names[] = {"zebra", "ape", "mole"};
	struct file file;
	char name[20];

	(void)state;
	open_file(&file);
	rb_h5_group_ordered(&file.h5, "/deep/list");
	for (int i = 0; i < 3; i++) {
		char path[40];
		snprintf(path, sizeof path, "/deep/list/%s", names[i]);
		rb_h5_put_i64(&file.h5, path, i);
	}
	turn_file(&file, H5F_ACC_RDONLY);
	const hid_t group = H5Gopen2(file.h5.file, "/deep/list", H5P_DEFAULT);
	for (hsize_t i = 0; i < 3; i++) {
		assert_true(H5Lget_name_by_idx(group, ".", H5_INDEX_CRT_ORDER, H5_ITER_INC, i, name,
		                               sizeof name, H5P_DEFAULT) > 0);
		assert_string_equal(name, names[i]);
	}
	rb_h5_done(group);
	close_file(&file);
}

/* Any name can be the last part of a path, and comes back from it. */
static void names_become_parts_of_paths_and_come_back(void **state)
{
	static const char *const cases[][2] = {{"ball", "ball"}, {"a/b", "a%2Fb"}, {".", "%2E"},
	                                       {"..", "%2E."},   {"a.b", "a.b"},   {"50%", "50%25"},
	                                       {"", "%"},        {"%2F", "%252F"}, {"%", "%25"}};
	static const char bytes[] = "a/%.2F\xc3\xa9";
	char out[100];

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		assert_string_equal(rb_h5_escape(cases[i][0], out, sizeof out), cases[i][1]);
	for (uint64_t k = 0; k < 5000; k++) {
		char name[20];
		const size_t size = rb_random_bits(1, k, 0) % 16;

		for (size_t i = 0; i < size; i++)
			name[i] = bytes[rb_random_bits(1, k, i + 1) % (sizeof bytes - 1)];
		name[size] = '\0';
		rb_h5_escape(name, out, sizeof out);
		assert_null(strchr(out, '/'));
		assert_true(*out && *out != '.');
		rb_h5_unescape(out);
		assert_string_equal(out, name);
		/* cut, it is still one, within its room */
		for (size_t room = 4; room < 9; room++) {
			memset(out, 'x', sizeof out);
			rb_h5_escape(name, out, room);
			assert_true(strlen(out) < room);
			assert_null(strchr(out, '/'));
		}
	}
}

static hid_t open_object(struct file *file, const char *path)
{
	const hid_t object = H5Oopen(file->h5.file, path, H5P_DEFAULT);

	assert_true(object >= 0);
	return object;
}

/* Times of making would make two equal runs differ. */
static void nothing_says_when_it_was_made(void **state)
{
	static const char *const paths[] = {"/g", "/g/o", "/g/x", "/g/t", "/g/list"};
	struct file file;

	(void)state;
	open_file(&file);
	rb_h5_group(&file.h5, "/g");
	rb_h5_group_ordered(&file.h5, "/g/o");
	rb_h5_put_f64(&file.h5, "/g/x", 2.5);
	rb_h5_text(&file.h5, "/g/t", "text", 9);
	rb_h5_texts(&file.h5, "/g/list", (const char *const[]){"a"}, 1);
	rb_h5_attribute_text(&file.h5, "/g", "a", "b");
	turn_file(&file, H5F_ACC_RDONLY);
	for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
		const hid_t object = open_object(&file, paths[i]);
		H5O_info_t info;

#if H5_VERSION_GE(1, 12, 0)
		assert_true(H5Oget_info(object, &info, H5O_INFO_TIME) >= 0);
#else
		assert_true(H5Oget_info(object, &info) >= 0);
#endif
		assert_true(info.mtime == 0 && info.ctime == 0 && info.btime == 0);
		rb_h5_done(object);
	}
	close_file(&file);
}

/* H5close ends all that the library has: a host of librbsim may call it between two runs. */
static void the_library_may_be_closed_between_files(void **state)
{
	struct file file;

	(void)state;
	for (int round = 0; round < 3; round++) {
		open_file(&file);
		rb_h5_put_f64(&file.h5, "/of/a/group", 1);
		rb_h5_attribute_text(&file.h5, "/of/a/group", "units", "m");
		if (file.h5.status)
			fail_msg("%s", file.h5.error.text);
		close_file(&file);
		assert_true(H5close() >= 0);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(numbers_of_every_kind_come_back),
		cmocka_unit_test(texts_are_cut_between_characters),
		cmocka_unit_test(lists_of_texts_have_one_length),
		cmocka_unit_test(the_first_failure_sticks),
		cmocka_unit_test(attributes_and_links_say_what_they_should),
		cmocka_unit_test(members_keep_their_order_where_that_is_asked_for),
		cmocka_unit_test(names_become_parts_of_paths_and_come_back),
		cmocka_unit_test(nothing_says_when_it_was_made),
		cmocka_unit_test(the_library_may_be_closed_between_files),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
