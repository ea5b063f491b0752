/* SPDX-License-Identifier: MIT */
/* src/film/png.c, src/base/outfile.c */
#include "support.h"

#include "base/memory.h"
#include "base/outfile.h"
#include "film/png.h"

#include <dirent.h>
#include <png.h>
#include <sys/stat.h>

struct file {
	uint8_t bytes[400000];
	size_t size;
};

static void keep(png_structp png, png_bytep from, size_t count)
{
	struct file *file = png_get_io_ptr(png);

	assert_true(file->size + count <= sizeof file->bytes);
	memcpy(file->bytes + file->size, from, count);
	file->size += count;
}

static void no_flush(png_structp png)
{
	(void)png;
}

enum { W = 13, H = 11 };

/* A picture in one of PNG's kinds; each kind's red is x, as far as it can tell. */
static void make_png(struct file *file, int color_type, int depth, int interlace)
{
	static const png_color palette[16] = {
		{0, 9, 5},  {10, 9, 5}, {20, 9, 5}, {30, 9, 5}, {40, 9, 5},  {50, 9, 5}, {60, 9, 5},
		{70, 9, 5}, {80, 9, 5}, {90, 9, 5}, {99, 9, 5}, {110, 9, 5}, {120, 9, 5}};
	static const png_byte clear[3] = {0, 128, 255};
	png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
	png_infop info = png_create_info_struct(png);
	png_byte row[W * 8];

	file->size = 0;
	png_set_write_fn(png, file, keep, no_flush);
	png_set_IHDR(png, info, W, H, depth, color_type, interlace, PNG_COMPRESSION_TYPE_DEFAULT,
	             PNG_FILTER_TYPE_DEFAULT);
	if (color_type == PNG_COLOR_TYPE_PALETTE) {
		png_set_PLTE(png, info, palette, 16);
		png_set_tRNS(png, info, clear, 3, NULL);
	}
	png_write_info(png, info);
	const int passes = png_set_interlace_handling(png);
	for (int pass = 0; pass < passes; pass++)
		for (int y = 0; y < H; y++) {
			const int channels = png_get_channels(png, info);
			memset(row, 0, sizeof row);
			for (int x = 0; x < W; x++)
				for (int c = 0; c < channels; c++) {
					const int value = c == 0 ? 10 * x : c == 1 ? 20 * y : 200;
					if (color_type == PNG_COLOR_TYPE_PALETTE)
						row[x / 2] |= (png_byte)(x << (x % 2 ? 0 : 4));
					else if (depth == 16)
						row[2 * (channels * x + c)] =
							row[2 * (channels * x + c) + 1] = (png_byte)
								value;
					else if (depth == 8)
						row[channels * x + c] = (png_byte)value;
					else
						row[x / 8] |= (png_byte)(x % 2 << (7 - x % 8));
				}
			png_write_row(png, row);
		}
	png_write_end(png, NULL);
	png_destroy_write_struct(&png, &info);
}

static void put_number(uint8_t *at, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		at[i] = (uint8_t)(value >> (24 - 8 * i));
}

/* The sum over the chunk's name and data is made right again (PNG specification, annex D). */
static void make_sum_right(uint8_t *chunk)
{
	const uint32_t size = (uint32_t)chunk[0] << 24 | (uint32_t)chunk[1] << 16 |
	                      (uint32_t)chunk[2] << 8 | chunk[3];
	uint32_t sum = 0xffffffff;

	for (uint32_t i = 4; i < 8 + size; i++) {
		sum ^= chunk[i];
		for (int bit = 0; bit < 8; bit++)
			sum = sum & 1 ? 0xedb88320 ^ sum >> 1 : sum >> 1;
	}
	put_number(chunk + 8 + size, ~sum);
}

static const uint8_t *pixel(const struct rb_pixmap *pixmap, int x, int y)
{
	return pixmap->rgba + 4 * ((size_t)y * (size_t)pixmap->width + (size_t)x);
}

static void assert_pixel(const struct rb_pixmap *pixmap, int x, int y, const int expected[4])
{
	const uint8_t *p = pixel(pixmap, x, y);

	for (int c = 0; c < 4; c++)
		if (abs(p[c] - expected[c]) > 1)
			fail_msg("pixel %d,%d: %d %d %d %d", x, y, p[0], p[1], p[2], p[3]);
}

static void every_kind_of_png_becomes_the_same_red_green_blue_and_alpha(void **state)
{
	static struct file file;
	struct rb_pixmap pixmap;
	struct rb_error err;

	(void)state;
	for (int interlace = 0; interlace < 2; interlace++) {
		for (int depth = 8; depth <= 16; depth += 8) {
			make_png(&file, PNG_COLOR_TYPE_RGB, depth, interlace);
			assert_ok(rb_png_decode(&pixmap, "a.png", file.bytes, file.size, &err));
			assert_true(pixmap.width == W && pixmap.height == H);
			assert_pixel(&pixmap, 12, 3, (int[]){120, 60, 200, 255});
			assert_pixel(&pixmap, 2, 10, (int[]){20, 200, 200, 255});
			rb_pixmap_release(&pixmap);

			make_png(&file, PNG_COLOR_TYPE_RGBA, depth, interlace);
			assert_ok(rb_png_decode(&pixmap, "a.png", file.bytes, file.size, &err));
			assert_pixel(&pixmap, 2, 10, (int[]){20, 200, 200, 200});
			rb_pixmap_release(&pixmap);

			make_png(&file, PNG_COLOR_TYPE_GRAY_ALPHA, depth, interlace);
			assert_ok(rb_png_decode(&pixmap, "a.png", file.bytes, file.size, &err));
			assert_pixel(&pixmap, 7, 4, (int[]){70, 70, 70, 80});
			rb_pixmap_release(&pixmap);
		}
		make_png(&file, PNG_COLOR_TYPE_PALETTE, 4, interlace);
		assert_ok(rb_png_decode(&pixmap, "a.png", file.bytes, file.size, &err));
		assert_pixel(&pixmap, 1, 5, (int[]){10, 9, 5, 128});
		assert_pixel(&pixmap, 12, 5, (int[]){120, 9, 5, 255});
		rb_pixmap_release(&pixmap);

		make_png(&file, PNG_COLOR_TYPE_GRAY, 1, interlace);
		assert_ok(rb_png_decode(&pixmap, "a.png", file.bytes, file.size, &err));
		assert_pixel(&pixmap, 8, 5, (int[]){0, 0, 0, 255});
		assert_pixel(&pixmap, 9, 5, (int[]){255, 255, 255, 255});
		rb_pixmap_release(&pixmap);
	}
}

static void assert_refused(const void *bytes, size_t size, const char *why)
{
	const struct rb_memory_counts before = rb_memory_counts();
	struct rb_pixmap pixmap;
	struct rb_error err;

	assert_int_equal(rb_png_decode(&pixmap, "ball.png", bytes, size, &err), RB_ERR_SCENE);
	if (!strstr(err.text, why) || !strstr(err.text, "'ball.png'"))
		fail_msg("'%s' instead of '%s'", err.text, why);
	assert_null(pixmap.rgba);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_int_equal(after.taken - before.taken, after.freed - before.freed);
}

static void what_is_no_picture_is_refused_by_name(void **state)
{
	static struct file file;

	(void)state;
	assert_refused("", 0, "not a PNG");
	assert_refused("GIF89a, this is something else altogether", 40, "not a PNG");
	make_png(&file, PNG_COLOR_TYPE_RGB, 8, 0);
	for (size_t size = 8; size < file.size; size++)
		assert_refused(file.bytes, size, "cut off");
	for (size_t at = 41; at < file.size - 12; at += 7) {
		file.bytes[at] ^= 0x55;
		assert_refused(file.bytes, file.size, "");
		file.bytes[at] ^= 0x55;
	}
}

/* A few hundred bytes must not take gigabytes, nor the time to fill them. */
static void a_picture_that_is_too_large_is_refused_before_memory_is_taken_for_it(void **state)
{
	static struct file file;
	const uint32_t sizes[][2] = {{60000, 11}, {13, 60000}, {0, 11}, {13, 0}, {1u << 31, 11}};

	(void)state;
	for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
		make_png(&file, PNG_COLOR_TYPE_RGB, 8, 0);
		put_number(file.bytes + 16, sizes[i][0]);
		put_number(file.bytes + 20, sizes[i][1]);
		make_sum_right(file.bytes + 8);
		assert_refused(file.bytes, file.size, "pixels (1 to 8192 a side are possible)");
	}
	/* possible, but these bytes can't be so much */
	make_png(&file, PNG_COLOR_TYPE_RGB, 8, 0);
	put_number(file.bytes + 16, 8192);
	put_number(file.bytes + 20, 8192);
	make_sum_right(file.bytes + 8);
	const struct rb_memory_counts before = rb_memory_counts();
	assert_refused(file.bytes, file.size, "cut off");
	assert_true(rb_memory_counts().bytes_peak < before.bytes_now + (1 << 20));
}

static void memory_that_runs_out_while_reading_is_told_and_given_back(void **state)
{
	static struct file file;
	struct rb_pixmap pixmap;
	int failures = 0;

	(void)state;
	make_png(&file, PNG_COLOR_TYPE_RGB, 8, 1);
	const struct rb_memory_counts before = rb_memory_counts();
	for (uint64_t k = 1;; k++, failures++) {
		rb_memory_fail_at(k);
		const enum rb_status status = rb_png_decode(&pixmap, "a.png", file.bytes, file.size,
		                                            NULL);
		rb_memory_fail_at(0);
		rb_pixmap_release(&pixmap);
		if (!status)
			break;
		assert_int_equal(status, RB_ERR_MEMORY);
	}
	assert_true(failures >= 3);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_int_equal(after.taken - before.taken, after.freed - before.freed);
}

/* ---- writing ---- */

static void draw_slope(struct rb_pixmap *pixmap, int width, int height)
{
	assert_int_equal(rb_pixmap_init(pixmap, width, height, NULL), RB_OK);
	for (int i = 0; i < width * height; i++) {
		pixmap->rgba[4 * i] = (uint8_t)(i % width);
		pixmap->rgba[4 * i + 1] = (uint8_t)(i / width);
		pixmap->rgba[4 * i + 2] = 77;
		pixmap->rgba[4 * i + 3] = 33;
	}
}

static void load(struct file *file, const char *path)
{
	FILE *stream = fopen(path, "rb");

	if (!stream)
		fail_msg("no file '%s'", path);
	file->size = fread(file->bytes, 1, sizeof file->bytes, stream);
	fclose(stream);
}

static bool holds(const struct file *file, const char *text, size_t size)
{
	for (size_t i = 0; i + size <= file->size; i++)
		if (memcmp(file->bytes + i, text, size) == 0)
			return true;
	return false;
}

static void a_picture_comes_back_as_it_was_opaque_and_with_its_texts(void **state)
{
	static struct file file, again;
	const struct rb_png_text texts[] = {
		{"Simulated time", "1.25 s"}, {"Title", "Kugel f\xc3\xa4llt"}, {0}};
	struct rb_pixmap pixmap, back;
	struct rb_error err;
	char folder[256], path[300];
	size_t bytes = 0;

	(void)state;
	snprintf(path, sizeof path, "%s/a.png", support_folder(folder));
	draw_slope(&pixmap, 201, 103);
	assert_ok(rb_png_write(path, false, &pixmap, texts, &bytes, &err));
	load(&file, path);
	assert_int_equal(bytes, file.size);
	assert_true(holds(&file, "sRGB", 4));
	assert_true(holds(&file,
	                  "tEXtSimulated time\0"
	                  "1.25 s",
	                  25));
	assert_true(holds(&file, "iTXtTitle\0\0\0\0\0Kugel f\xc3\xa4llt", 26));
	assert_ok(rb_png_decode(&back, path, file.bytes, file.size, &err));
	assert_true(back.width == 201 && back.height == 103);
	for (int i = 0; i < 201 * 103; i++) {
		assert_memory_equal(back.rgba + 4 * i, pixmap.rgba + 4 * i, 3);
		assert_int_equal(back.rgba[4 * i + 3], 255);
	}
	rb_pixmap_release(&back);

	/* and always as the same bytes */
	assert_ok(rb_png_write(path, true, &pixmap, texts, NULL, &err));
	load(&again, path);
	assert_int_equal(file.size, again.size);
	assert_memory_equal(file.bytes, again.bytes, file.size);
	assert_int_equal(support_count_files(folder), 1);
	rb_pixmap_release(&pixmap);
}

static void what_is_there_is_replaced_only_when_asked_for(void **state)
{
	static struct file file;
	struct rb_pixmap pixmap;
	struct rb_error err;
	char folder[256], path[300];

	(void)state;
	snprintf(path, sizeof path, "%s/a.png", support_folder(folder));
	FILE *stream = fopen(path, "w");
	fputs("dear", stream);
	fclose(stream);
	draw_slope(&pixmap, 5, 5);
	assert_int_equal(rb_png_write(path, false, &pixmap, NULL, NULL, &err), RB_ERR_CREATE);
	assert_non_null(strstr(err.text, "exists"));
	load(&file, path);
	assert_int_equal(file.size, 4);
	assert_ok(rb_png_write(path, true, &pixmap, NULL, NULL, &err));
	load(&file, path);
	assert_true(file.size > 4);
	assert_int_equal(support_count_files(folder), 1);
	rb_pixmap_release(&pixmap);
}

static void what_cannot_be_written_leaves_nothing(void **state)
{
	const struct rb_memory_counts before = rb_memory_counts();
	struct rb_pixmap pixmap;
	struct rb_error err;
	char folder[256], path[300];
	int failures = 0;

	(void)state;
	draw_slope(&pixmap, 50, 50);
	snprintf(path, sizeof path, "%s/none/a.png", support_folder(folder));
	assert_int_equal(rb_png_write(path, false, &pixmap, NULL, NULL, &err), RB_ERR_CREATE);
	assert_int_equal(rb_png_write(folder, true, &pixmap, NULL, NULL, &err), RB_ERR_CREATE);
	assert_non_null(strstr(err.text, "it is a folder"));
	snprintf(path, sizeof path, "%s/a.png", folder);
	for (uint64_t k = 1;; k++, failures++) {
		rb_memory_fail_at(k);
		const enum rb_status status = rb_png_write(path, false, &pixmap, NULL, NULL, NULL);
		rb_memory_fail_at(0);
		if (!status)
			break;
		assert_int_equal(status, RB_ERR_MEMORY);
		assert_int_equal(support_count_files(folder), 0);
	}
	assert_true(failures >= 3);
	rb_pixmap_release(&pixmap);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_int_equal(after.taken - before.taken, after.freed - before.freed);
}

static void a_full_disk_is_told_and_leaves_nothing_under_the_name(void **state)
{
	static struct file file;
	struct rb_error err;
	char folder[256], path[300];
	struct rb_outfile out;

	(void)state;
	snprintf(path, sizeof path, "%s/a.txt", support_folder(folder));
	assert_ok(rb_outfile_open(&out, path, false, &err));
	FILE *full = fopen("/dev/full", "w");
	if (!full)
		skip();
	fclose(out.file);
	out.file = full;
	fputs("text", out.file);
	assert_int_equal(rb_outfile_publish(&out, &err), RB_ERR_IO);
	assert_non_null(strstr(err.text, "No space left"));
	assert_int_equal(support_count_files(folder), 0);
	(void)file;
}

static void folders_that_are_missing_are_made_and_a_probe_leaves_none(void **state)
{
	struct rb_error err;
	char folder[256], path[300];
	struct stat found;

	(void)state;
	snprintf(path, sizeof path, "%s/a/b//c/d.png", support_folder(folder));
	assert_ok(rb_outfile_probe(path, false, &err));
	assert_int_equal(support_count_files(folder), 0);
	assert_ok(rb_outfile_folders(path, 0, &err));
	assert_ok(rb_outfile_folders(path, 0, &err));
	snprintf(path, sizeof path, "%s/a/b/c", folder);
	assert_int_equal(stat(path, &found), 0);
	assert_true(S_ISDIR(found.st_mode));
	snprintf(path, sizeof path, "%s/a/b/c/d.png", folder);
	assert_ok(rb_outfile_probe(path, false, &err));
	FILE *stream = fopen(path, "w");
	fclose(stream);
	assert_int_equal(rb_outfile_probe(path, false, &err), RB_ERR_CREATE);
	assert_ok(rb_outfile_probe(path, true, &err));
	/* a file where a folder is wanted */
	snprintf(path, sizeof path, "%s/a/b/c/d.png/e/f.png", folder);
	assert_int_equal(rb_outfile_probe(path, false, &err), RB_ERR_CREATE);
	assert_int_equal(rb_outfile_folders(path, 0, &err), RB_ERR_CREATE);
	if (geteuid() == 0)
		return; /* who may write everywhere */
	snprintf(path, sizeof path, "%s/a", folder);
	chmod(path, 0500);
	snprintf(path, sizeof path, "%s/a/new/f.png", folder);
	assert_int_equal(rb_outfile_probe(path, false, &err), RB_ERR_CREATE);
	assert_int_equal(rb_outfile_folders(path, 0, &err), RB_ERR_CREATE);
	snprintf(path, sizeof path, "%s/a", folder);
	chmod(path, 0700);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_kind_of_png_becomes_the_same_red_green_blue_and_alpha),
		cmocka_unit_test(what_is_no_picture_is_refused_by_name),
		cmocka_unit_test(
			a_picture_that_is_too_large_is_refused_before_memory_is_taken_for_it),
		cmocka_unit_test(memory_that_runs_out_while_reading_is_told_and_given_back),
		cmocka_unit_test(a_picture_comes_back_as_it_was_opaque_and_with_its_texts),
		cmocka_unit_test(what_is_there_is_replaced_only_when_asked_for),
		cmocka_unit_test(what_cannot_be_written_leaves_nothing),
		cmocka_unit_test(a_full_disk_is_told_and_leaves_nothing_under_the_name),
		cmocka_unit_test(folders_that_are_missing_are_made_and_a_probe_leaves_none),
	};

	return cmocka_run_group_tests_name("film_png", tests, NULL, NULL);
}
