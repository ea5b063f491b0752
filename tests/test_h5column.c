/* SPDX-License-Identifier: MIT */
/* src/sink/h5column.c: datasets that grow by rows, and what room they need */
#include "h5place.h"

#include "math/random.h"
#include "sink/h5column.h"

/* Cell c of row r. */
static double value(hsize_t r, hsize_t c)
{
	return (double)(r * 1000 + c) * 0.125;
}

/* A block of memory with rows [from, from + count), to be freed. */
static double *rows_of(hsize_t from, hsize_t count, hsize_t cells)
{
	double *rows = rb_memory_take(count * cells + 1, sizeof *rows);

	assert_non_null(rows);
	for (hsize_t r = 0; r < count; r++)
		for (hsize_t c = 0; c < cells; c++)
			rows[r * cells + c] = value(from + r, c);
	return rows;
}

/* All of the dataset is as `value` says, and of so many rows. */
static void check_rows(struct file *file, const char *path, hsize_t count, hsize_t cells)
{
	const hid_t dataset = H5Dopen2(file->h5.file, path, H5P_DEFAULT);
	const hid_t space = H5Dget_space(dataset);
	hsize_t size[RB_H5_RANK_MAX];

	assert_true(H5Sget_simple_extent_dims(space, size, NULL) >= 1);
	assert_int_equal(size[0], count);
	assert_int_equal(H5Sget_simple_extent_npoints(space), count * cells);
	double *found = rb_memory_take(count * cells + 1, sizeof *found);
	assert_true(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, found) >= 0);
	for (hsize_t r = 0; r < count; r++)
		for (hsize_t c = 0; c < cells; c++)
			assert_true(found[r * cells + c] == value(r, c));
	rb_memory_free(found);
	rb_h5_done(space);
	rb_h5_done(dataset);
}

/* Of one number, of bodies, of bodies in parts that do not divide, packed. */
static const struct rb_h5_layout layouts[] = {
	{.kind = RB_H5_F64, .chunk_rows = 7},
	{.kind = RB_H5_F64, .row = {1, {3}}, .chunk_rows = 1},
	{.kind = RB_H5_F64, .row = {2, {5, 3}}, .chunk_rows = 4},
	{.kind = RB_H5_F64, .row = {2, {5, 3}}, .chunk_rows = 4, .chunk_first = 2},
	{.kind = RB_H5_F64,
         .row = {2, {64, 3}},
         .chunk_rows = 16,
         .chunk_first = 10,
         .compression = 4},
};
enum { LAYOUTS = sizeof layouts / sizeof *layouts };

static hsize_t cells_of(const struct rb_h5_layout *layout)
{
	hsize_t cells = 1;

	for (int i = 0; i < layout->row.rank; i++)
		cells *= layout->row.size[i];
	return cells;
}

static void rows_come_back_however_they_were_appended(void **state)
{
	struct file file;
	char path[20];

	(void)state;
	open_file(&file);
	for (int k = 0; k < LAYOUTS; k++) {
		const hsize_t cells = cells_of(&layouts[k]);
		struct rb_h5_column column;
		hsize_t count = 0;

		snprintf(path, sizeof path, "/deep/c%d", k);
		rb_h5_column_create(&file.h5, &column, path, &layouts[k]);
		assert_int_equal(column.row_bytes, cells * 8);
		for (uint64_t i = 0; i < 12; i++) {
			const hsize_t more = rb_random_bits(1, (uint64_t)k, i) % 9;
			double *rows = rows_of(count, more, cells);

			rb_h5_column_append(&file.h5, &column, more, rows);
			rb_memory_free(rows);
			count += more;
			assert_int_equal(column.rows, count);
			if (i == 5) { /* closed, and opened again */
				rb_h5_column_detach(&column);
				rb_h5_column_attach(&file.h5, &column);
			}
		}
		rb_h5_column_close(&column);
		rb_h5_column_close(&column);
		turn_file(&file, H5F_ACC_RDWR);
		check_rows(&file, path, count, cells);
	}
	close_file(&file);
}

/* Before a row is written it is known how much the file can grow by it. */
static void no_append_takes_more_than_was_said(void **state)
{
	struct file file;
	char path[20];

	(void)state;
	open_file(&file);
	for (int k = 0; k < LAYOUTS; k++) {
		const hsize_t cells = cells_of(&layouts[k]);
		struct rb_h5_column column;

		snprintf(path, sizeof path, "/c%d", k);
		rb_h5_column_create(&file.h5, &column, path, &layouts[k]);
		for (uint64_t i = 0; i < 40; i++) {
			const hsize_t more = 1 + rb_random_bits(2, (uint64_t)k, i) % 50;
			double *rows = rows_of(column.rows, more, cells);
			const uint64_t need = rb_h5_column_need(&column, more);
			hsize_t before, after;

			H5Fflush(file.h5.file, H5F_SCOPE_LOCAL);
			assert_true(H5Fget_filesize(file.h5.file, &before) >= 0);
			rb_h5_column_append(&file.h5, &column, more, rows);
			rb_memory_free(rows);
			H5Fflush(file.h5.file, H5F_SCOPE_LOCAL);
			assert_true(H5Fget_filesize(file.h5.file, &after) >= 0);
			if (after > before + need)
				fail_msg("column %d: %d bytes, and %d were said", k,
				         (int)(after - before), (int)need);
			/* nor is it several times what it takes: the disk would seem full */
			assert_true(need <= 4 * (rb_h5_column_plain(&column, more) + 65536));
		}
		/* a chunk without a filter is there to its end */
		if (layouts[k].compression == 0) {
			const hsize_t rows = column.rows, chunk = layouts[k].chunk_rows;
			const hsize_t whole = (rows + chunk - 1) / chunk * chunk;
			const hsize_t first = layouts[k].chunk_first;
			const hsize_t padded = first ? (5 + first - 1) / first * first * 3 : cells;

			assert_int_equal(H5Dget_storage_size(column.dataset), whole * padded * 8);
			assert_true(rb_h5_column_bytes(&column, rows) >=
			            H5Dget_storage_size(column.dataset));
		}
		assert_int_equal(rb_h5_column_plain(&column, 10), 80 * cells);
		if (layouts[k].compression == 0)
			assert_int_equal(rb_h5_column_need(&column, 0), 0);
		rb_h5_column_close(&column);
	}
	turn_file(&file, H5F_ACC_RDONLY);
	close_file(&file);
}

/* A run that goes on writes over what stands behind its last frame, and cuts nothing off. */
static void a_column_that_is_there_is_written_over(void **state)
{
	const struct rb_h5_layout *const layout = &layouts[2];
	const hsize_t cells = cells_of(layout);
	struct rb_h5_column column;
	struct file file;

	(void)state;
	open_file(&file);
	rb_h5_column_create(&file.h5, &column, "/c", layout);
	double *rows = rows_of(0, 10, cells);
	rb_h5_column_append(&file.h5, &column, 10, rows);
	/* a wrong row 7 */
	for (hsize_t i = 7 * cells; i < 8 * cells; i++)
		rows[i] = -1;
	column.rows = 7;
	column.there = 10;
	rb_h5_column_append(&file.h5, &column, 1, rows + 7 * cells);
	rb_memory_free(rows);
	rb_h5_column_close(&column);
	turn_file(&file, H5F_ACC_RDWR);

	file.h5.there = true;
	rb_h5_column_create(&file.h5, &column, "/c", layout);
	assert_int_equal(file.h5.status, RB_OK);
	assert_int_equal(column.there, 10);
	assert_int_equal(column.rows, 0);
	column.rows = 7;
	assert_int_equal(rb_h5_column_need(&column, 3), 0); /* it has that room */
	rows = rows_of(7, 1, cells);
	rb_h5_column_append(&file.h5, &column, 1, rows);
	rb_memory_free(rows);
	check_rows(&file, "/c", 10, cells);
	rows = rows_of(8, 5, cells);
	rb_h5_column_append(&file.h5, &column, 5, rows);
	rb_memory_free(rows);
	assert_int_equal(column.rows, 13);
	rb_h5_column_close(&column);
	turn_file(&file, H5F_ACC_RDONLY);
	check_rows(&file, "/c", 13, cells);
	close_file(&file);
}

static void a_column_of_another_kind_is_not_written_to(void **state)
{
	static const struct rb_h5_layout others[] = {
		{.kind = RB_H5_F32, .row = {2, {5, 3}}, .chunk_rows = 4},
		{.kind = RB_H5_I64, .row = {2, {5, 3}}, .chunk_rows = 4},
		{.kind = RB_H5_F64, .row = {2, {6, 3}}, .chunk_rows = 4},
		{.kind = RB_H5_F64, .row = {2, {5, 4}}, .chunk_rows = 4},
		{.kind = RB_H5_F64, .row = {1, {5}}, .chunk_rows = 4},
		{.kind = RB_H5_F64, .row = {3, {5, 3, 1}}, .chunk_rows = 4},
	};
	struct rb_h5_column column;
	struct file file;

	(void)state;
	open_file(&file);
	rb_h5_column_create(&file.h5, &column, "/c", &layouts[2]);
	rb_h5_column_close(&column);
	turn_file(&file, H5F_ACC_RDWR);
	file.h5.there = true;
	for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
		rb_h5_column_create(&file.h5, &column, "/c", &others[k]);
		assert_int_equal(file.h5.status, RB_ERR_INPUT);
		assert_string_equal(file.h5.error.text,
		                    "'/c' in 'f.h5' is not what this run would record");
		assert_int_equal(column.there, 0);
		rb_h5_column_close(&column);
		file.h5.status = RB_OK;
	}
	rb_h5_column_create(&file.h5, &column, "/other", &layouts[2]);
	assert_int_equal(file.h5.status, RB_ERR_IO);
	assert_non_null(strstr(file.h5.error.text, "cannot open '/other' in 'f.h5'"));
	rb_h5_column_close(&column);
	file.h5.status = RB_OK;
	turn_file(&file, H5F_ACC_RDONLY);
	close_file(&file);
}

static void rows_can_be_pretended(void **state)
{
	struct rb_h5_column column;
	struct file file;

	(void)state;
	open_file(&file);
	rb_h5_column_create(&file.h5, &column, "/c", &layouts[3]);
	rb_h5_column_extend(&file.h5, &column, 1000000);
	assert_int_equal(column.rows, 1000000);
	assert_int_equal(H5Dget_storage_size(column.dataset), 0);
	/* 3 parts of a row of 5 bodies, chunks of 4 rows and 2 bodies of 3 numbers */
	const uint64_t data = (uint64_t)250000 * 3 * 4 * 2 * 3 * 8;
	assert_in_range(rb_h5_column_bytes(&column, 1000000), data, data + data / 10);
	rb_h5_column_close(&column);
	turn_file(&file, H5F_ACC_RDONLY);
	/* what was never written fails for those who cannot write */
	file.h5.there = true;
	rb_h5_column_create(&file.h5, &column, "/c", &layouts[3]);
	column.rows = column.there;
	rb_h5_column_extend(&file.h5, &column, 1);
	assert_int_equal(file.h5.status, RB_ERR_IO);
	assert_non_null(strstr(file.h5.error.text, "cannot extend '/c'"));
	rb_h5_column_close(&column);
	close_file(&file);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rows_come_back_however_they_were_appended),
		cmocka_unit_test(no_append_takes_more_than_was_said),
		cmocka_unit_test(a_column_that_is_there_is_written_over),
		cmocka_unit_test(a_column_of_another_kind_is_not_written_to),
		cmocka_unit_test(rows_can_be_pretended),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
