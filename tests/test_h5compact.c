/* SPDX-License-Identifier: MIT */
/* src/sink/h5compact.c: the same file without the room that its growing took */
#include "h5place.h"

#include "math/random.h"
#include "sink/h5column.h"
#include "sink/h5compact.h"

enum { ROWS = 300 };

static void append(struct rb_h5 *h5, const char *path, const struct rb_h5_layout *layout,
                   hsize_t count)
{
	struct rb_h5_column column;

	rb_h5_column_create(h5, &column, path, layout);
	for (hsize_t i = 0; i < count; i++) {
		double row[6];

		for (uint64_t k = 0; k < 6; k++)
			row[k] = rb_random_unit(1, i, k);
		rb_h5_column_append(h5, &column, 1, row);
	}
	rb_h5_column_close(&column);
}

/* All that recordings have: columns that grew, packed ones, texts, attributes, links. */
static void fill(struct file *file)
{
	static const struct rb_h5_layout plain = {.kind = RB_H5_F64,
	                                          .row = {2, {2, 3}},
	                                          .chunk_rows = 64},
					 packed = {.kind = RB_H5_F32,
	                                           .row = {1, {3}},
	                                           .chunk_rows = 64,
	                                           .compression = 3},
					 empty = {.kind = RB_H5_I64, .chunk_rows = 1000};
	static const char *const texts[] = {"a", "bcd"};
	struct rb_h5 *const h5 = &file->h5;

	append(h5, "/particles/position", &plain, ROWS);
	append(h5, "/particles/packed", &packed, ROWS);
	append(h5, "/particles/none", &empty, 0);
	rb_h5_units(h5, "/particles/position", "m");
	rb_h5_link(h5, "/particles/position", "/other/names/of");
	rb_h5_link_soft(h5, "/particles/packed", "/other/soft");
	rb_h5_link_soft(h5, "/nowhere", "/other/lost");
	rb_h5_group_ordered(h5, "/list");
	rb_h5_text(h5, "/list/z", "last in the alphabet", 30);
	rb_h5_texts(h5, "/list/a", texts, 2);
	rb_h5_put(h5, "/list/m", RB_H5_U8, (rb_h5_shape){1, {0}}, NULL);
	rb_h5_attribute_text(h5, "/list", "what", "ordered");
	rb_h5_attribute(h5, "/", "version", RB_H5_I64, 2, (const int64_t[]){1, 2});
	for (int i = 0; i < 80; i++) { /* more links than a header takes */
		char path[20];
		snprintf(path, sizeof path, "/many/%d", i);
		rb_h5_put_i64(h5, path, i);
	}
}

/* The image as a file of its own, opened. */
static hid_t open_image(const struct file *file, const unsigned char *image, size_t size,
                        char path[320])
{
	const hid_t access = rb_h5_access(1);

	snprintf(path, 320, "%s/image.h5", file->folder);
	FILE *out = fopen(path, "wb");
	assert_non_null(out);
	assert_int_equal(fwrite(image, 1, size, out), size);
	fclose(out);
	const hid_t opened = H5Fopen(path, H5F_ACC_RDONLY, access);
	assert_true(opened >= 0);
	rb_h5_done(access);
	return opened;
}

/* Bytes of the dataset with its shape, class and size behind; NULL: it is none. To be freed. */
static unsigned char *contents(hid_t file, const char *path, size_t *size)
{
	const hid_t dataset = H5Dopen2(file, path, H5P_DEFAULT);
	const hid_t type = dataset < 0 ? -1 : H5Dget_type(dataset);
	const hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);
	hsize_t shape[H5S_MAX_RANK] = {0};
	unsigned char *bytes = NULL;

	*size = 0;
	if (space >= 0) {
		const size_t cells = (size_t)H5Sget_simple_extent_npoints(space);
		const size_t data = cells * H5Tget_size(type);
		const int rank = H5Sget_simple_extent_dims(space, shape, NULL);

		*size = data + 8 * (size_t)rank + 3;
		bytes = rb_memory_take(*size, 1);
		if (cells > 0)
			assert_true(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes) >=
			            0);
		memcpy(bytes + data, shape, 8 * (size_t)rank);
		bytes[*size - 1] = (unsigned char)rank;
		bytes[*size - 2] = (unsigned char)H5Tget_class(type);
		bytes[*size - 3] = (unsigned char)H5Tget_size(type);
	}
	rb_h5_done(space);
	rb_h5_done(type);
	rb_h5_done(dataset);
	return bytes;
}

static void assert_same_dataset(hid_t a, hid_t b, const char *path)
{
	size_t size_a, size_b;
	unsigned char *const bytes_a = contents(a, path, &size_a), *const bytes_b = contents(
									   b, path, &size_b);

	if (!bytes_a || size_a != size_b || memcmp(bytes_a, bytes_b, size_a) != 0)
		fail_msg("'%s' is not the same", path);
	rb_memory_free(bytes_a);
	rb_memory_free(bytes_b);
}

static void assert_text(hid_t file, const char *object, const char *name, const char *wanted)
{
	const hid_t attribute = H5Aopen_by_name(file, object, name, H5P_DEFAULT, H5P_DEFAULT);
	const hid_t type = H5Aget_type(attribute);
	char text[40] = "";

	assert_true(attribute >= 0 && H5Tget_size(type) < sizeof text);
	assert_true(H5Aread(attribute, type, text) >= 0);
	assert_string_equal(text, wanted);
	rb_h5_done(type);
	rb_h5_done(attribute);
}

static void all_that_is_in_a_file_is_in_its_image(void **state)
{
	static const char *const paths[] = {"/particles/position",
	                                    "/particles/packed",
	                                    "/particles/none",
	                                    "/other/names/of",
	                                    "/other/soft",
	                                    "/list/z",
	                                    "/list/a",
	                                    "/list/m",
	                                    "/many/0",
	                                    "/many/79"};
	struct file file;
	struct rb_error err;
	unsigned char *image;
	char path[320], name[20];
	int64_t version[2] = {0};
	size_t size;

	(void)state;
	open_file(&file);
	fill(&file);
	turn_file(&file, H5F_ACC_RDONLY);
	assert_ok(rb_compact_image(file.h5.file, "f.h5", NULL, &image, &size, &err));
	/* nothing is left open */
	assert_int_equal(H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_ALL), 1);
	const hid_t copy = open_image(&file, image, size, path);
	rb_memory_free(image);
	for (size_t i = 0; i < sizeof paths / sizeof *paths; i++)
		assert_same_dataset(file.h5.file, copy, paths[i]);
	assert_text(copy, "/particles/position", "units", "m");
	assert_text(copy, "/list", "what", "ordered");
	const hid_t attribute = H5Aopen_by_name(copy, "/", "version", H5P_DEFAULT, H5P_DEFAULT);
	assert_true(H5Aread(attribute, H5T_NATIVE_INT64, version) >= 0);
	assert_true(version[0] == 1 && version[1] == 2);
	rb_h5_done(attribute);
	const hid_t list = H5Gopen2(copy, "/list", H5P_DEFAULT);
	for (hsize_t i = 0; i < 3; i++) {
		assert_true(H5Lget_name_by_idx(list, ".", H5_INDEX_CRT_ORDER, H5_ITER_INC, i, name,
		                               sizeof name, H5P_DEFAULT) == 1);
		assert_int_equal(*name, "zam"[i]);
	}
	rb_h5_done(list);
	H5Fclose(copy);
	unlink(path);
	close_file(&file);
}

static void links_stay_links(void **state)
{
	struct file file;
	struct rb_error err;
	unsigned char *image;
	char path[320], text[40] = "";
	H5L_info_t link;
	H5O_info_t object;
	size_t size;

	(void)state;
	open_file(&file);
	fill(&file);
	turn_file(&file, H5F_ACC_RDONLY);
	assert_ok(rb_compact_image(file.h5.file, "f.h5", NULL, &image, &size, &err));
	const hid_t copy = open_image(&file, image, size, path);
	rb_memory_free(image);
	/* two names of one dataset, which is there once */
#if H5_VERSION_GE(1, 12, 0)
	assert_true(H5Oget_info_by_name(copy, "/other/names/of", &object, H5O_INFO_BASIC,
	                                H5P_DEFAULT) >= 0);
#else
	assert_true(H5Oget_info_by_name(copy, "/other/names/of", &object, H5P_DEFAULT) >= 0);
#endif
	assert_int_equal(object.rc, 2);
	assert_true(H5Lget_info(copy, "/other/soft", &link, H5P_DEFAULT) >= 0);
	assert_int_equal(link.type, H5L_TYPE_SOFT);
	assert_true(H5Lget_val(copy, "/other/lost", text, sizeof text, H5P_DEFAULT) >= 0);
	assert_string_equal(text, "/nowhere");
	H5Fclose(copy);
	unlink(path);
	close_file(&file);
}

/* Chunks of 64 rows of which one is used, and their indices. */
static void the_image_is_smaller_and_its_columns_grow_no_more(void **state)
{
	static const struct rb_h5_layout layout = {
		.kind = RB_H5_F64, .row = {2, {2, 3}}, .chunk_rows = 64};
	struct file file;
	struct rb_error err;
	unsigned char *image;
	char path[320];
	hsize_t before, shape[3], most[3];
	size_t size;

	(void)state;
	open_file(&file);
	append(&file.h5, "/x", &layout, 65);
	turn_file(&file, H5F_ACC_RDONLY);
	assert_true(H5Fget_filesize(file.h5.file, &before) >= 0);
	assert_ok(rb_compact_image(file.h5.file, "f.h5", NULL, &image, &size, &err));
	/* 65 rows instead of 128, of 48 bytes, and headers of less than 1 KiB */
	assert_in_range(size, 65 * 48, 65 * 48 + 1024);
	assert_true(size < before);
	const hid_t copy = open_image(&file, image, size, path);
	rb_memory_free(image);
	const hid_t dataset = H5Dopen2(copy, "/x", H5P_DEFAULT);
	const hid_t space = H5Dget_space(dataset);
	assert_int_equal(H5Sget_simple_extent_dims(space, shape, most), 3);
	assert_int_equal(shape[0], 65);
	assert_int_equal(most[0], 65);
	rb_h5_done(space);
	rb_h5_done(dataset);
	assert_same_dataset(file.h5.file, copy, "/x");
	H5Fclose(copy);
	unlink(path);
	close_file(&file);
}

/* An image of an image is the same: there is nothing more to be gained. */
static void a_second_time_changes_nothing(void **state)
{
	struct file file;
	struct rb_error err;
	unsigned char *image, *again;
	char path[320];
	size_t size, size_again;

	(void)state;
	open_file(&file);
	fill(&file);
	turn_file(&file, H5F_ACC_RDONLY);
	assert_ok(rb_compact_image(file.h5.file, "f.h5", NULL, &image, &size, &err));
	const hid_t copy = open_image(&file, image, size, path);
	assert_ok(rb_compact_image(copy, "image.h5", NULL, &again, &size_again, &err));
	assert_int_equal(size, size_again);
	assert_memory_equal(image, again, size);
	rb_memory_free(image);
	rb_memory_free(again);
	H5Fclose(copy);
	unlink(path);
	close_file(&file);
}

static void what_cannot_be_copied_is_told_and_leaves_nothing(void **state)
{
	struct file file;
	struct rb_error err;
	enum rb_status status = RB_ERR_MEMORY;
	unsigned char *image;
	size_t size;
	int failed = 0;

	(void)state;
	open_file(&file);
	fill(&file);
	turn_file(&file, H5F_ACC_RDWR);
	for (uint64_t k = 1; status != RB_OK; k += 1 + k / 8) {
		rb_memory_fail_at(k);
		status = rb_compact_image(file.h5.file, "f.h5", NULL, &image, &size, &err);
		rb_memory_fail_at(0);
		assert_int_equal(H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_ALL), 1);
		if (status != RB_OK) {
			assert_int_equal(status, RB_ERR_MEMORY);
			assert_null(image);
			failed++;
		}
	}
	assert_true(failed > 10);
	rb_memory_free(image);
	/* a link that leads out of the file */
	H5Lcreate_external("other.h5", "/x", file.h5.file, "/outside", H5P_DEFAULT, H5P_DEFAULT);
	assert_int_equal(rb_compact_image(file.h5.file, "f.h5", NULL, &image, &size, &err),
	                 RB_ERR_IO);
	assert_non_null(strstr(err.text, "cannot copy '/outside' in 'f.h5'"));
	assert_null(image);
	close_file(&file);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(all_that_is_in_a_file_is_in_its_image),
		cmocka_unit_test(links_stay_links),
		cmocka_unit_test(the_image_is_smaller_and_its_columns_grow_no_more),
		cmocka_unit_test(a_second_time_changes_nothing),
		cmocka_unit_test(what_cannot_be_copied_is_told_and_leaves_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
