/* SPDX-License-Identifier: MIT */
/*
 * libpng with its own error, memory and read functions. Files are outside input: width and height
 * are checked by hand first, memory is bounded by what deflate can expand the file to, and every
 * chunk but the picture's own is skipped undecoded.
 */
#include "film/png.h"

#include <errno.h>
#include <limits.h>
#include <png.h>
#include <zlib.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/outfile.h"

/* CHUNKS and their bytes: limits for libpng, far above what a texture has. */
enum { SIGNATURE_SIZE = 8, CHUNK_BYTES_MAX = 1 << 16, CHUNKS_MAX = 64, WRITE_BUFFER = 1 << 16 };

/*
 * Largest expansion by deflate (zlib's documentation, "maximum expansion factor"): a file that
 * claims more pixels is cut off or hostile.
 */
static const uint64_t expansion_max = 1032;

/*
 * One use of libpng, which reports errors by longjmp to its user. What that one needs afterwards is
 * in here and not in locals, whose values would be indeterminate.
 */
struct job {
	png_structp png;
	png_infop info;
	jmp_buf failed;
	char why[120]; /* what libpng complained of */
	bool memory_out;

	const uint8_t *bytes; /* of what is read */
	size_t size, at;
	FILE *file; /* that is written */
	struct rb_pixmap pixmap;
};

/* libpng's error function: keeps the text and jumps. */
static void complain(png_structp png, png_const_charp text)
{
	struct job *const job = png_get_error_ptr(png);

	snprintf(job->why, sizeof job->why, "%s", text);
	longjmp(job->failed, 1);
}

/* Warnings are dropped. */
static void overlook(png_structp png, png_const_charp text)
{
	(void)png, (void)text;
}

static png_voidp take_memory(png_structp png, png_alloc_size_t size)
{
	struct job *const job = png_get_mem_ptr(png);
	void *const block = rb_memory_take(size, 1);

	job->memory_out |= !block;
	return block;
}

static void give_memory(png_structp png, png_voidp block)
{
	(void)png;
	rb_memory_free(block);
}

/* ---- reading ---- */

/* libpng's read function, from memory. */
static void read_bytes(png_structp png, png_bytep to, size_t count)
{
	struct job *const job = png_get_io_ptr(png);

	if (count > job->size - job->at)
		png_error(png, "cut off");
	RB_ASSERT(job->at + count <= job->size);
	memcpy(to, job->bytes + job->at, count);
	job->at += count;
}

/* Skips texts and profiles undecoded and limits what libpng allocates. */
static void leave_out_rest(png_structp png)
{
	static const png_byte names[] = "bKGD\0cHRM\0eXIf\0hIST\0iCCP\0iTXt\0oFFs\0pCAL\0pHYs\0"
					"sCAL\0sPLT\0tEXt\0tIME\0zTXt";

	png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, names, (int)(sizeof names / 5));
	png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, NULL, 0);
	png_set_user_limits(png, RB_TEXTURE_SIDE_MAX, RB_TEXTURE_SIDE_MAX);
	png_set_chunk_cache_max(png, CHUNKS_MAX);
	png_set_chunk_malloc_max(png, CHUNK_BYTES_MAX);
}

static uint32_t big_endian(const uint8_t *p)
{
	return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

/* Checks the header by hand, so that the message has the numbers. */
static enum rb_status check_head(const char *name, const uint8_t *bytes, size_t size,
                                 struct rb_error *err)
{
	if (size < SIGNATURE_SIZE || png_sig_cmp(bytes, 0, SIGNATURE_SIZE) != 0)
		return RB_FAIL(err, RB_ERR_SCENE, "cannot read '%s': it is not a PNG file", name);
	if (size < 33 || memcmp(bytes + 12, "IHDR", 4) != 0)
		return RB_FAIL(err, RB_ERR_SCENE, "cannot read '%s': the PNG file is cut off",
		               name);
	const uint32_t width = big_endian(bytes + 16), height = big_endian(bytes + 20);
	if (width == 0 || height == 0 || width > RB_TEXTURE_SIDE_MAX ||
	    height > RB_TEXTURE_SIDE_MAX)
		return RB_FAIL(err, RB_ERR_SCENE,
		               "cannot read '%s': the picture has %lu x %lu pixels (1 to %d a side "
		               "are possible)",
		               name, (unsigned long)width, (unsigned long)height,
		               RB_TEXTURE_SIDE_MAX);
	return RB_OK;
}

/* Converts every kind of PNG to 8-bit sRGB with alpha. */
static void want_rgba(struct job *job)
{
	png_structp png = job->png;

	png_set_gamma(png, PNG_DEFAULT_sRGB, PNG_DEFAULT_sRGB);
	png_set_expand(png);
	png_set_scale_16(png);
	png_set_gray_to_rgb(png);
	png_set_add_alpha(png, 255, PNG_FILLER_AFTER);
}

/* Decodes; leaves by longjmp on errors. */
static void read_picture(struct job *job)
{
	png_structp png = job->png;

	png_set_read_fn(png, job, read_bytes);
	leave_out_rest(png);
	png_read_info(png, job->info);
	const uint32_t width = png_get_image_width(png, job->info);
	const uint32_t height = png_get_image_height(png, job->info);
	if ((png_get_rowbytes(png, job->info) + 1) * (uint64_t)height >
	    expansion_max * (uint64_t)job->size)
		png_error(png, "cut off");
	want_rgba(job);
	const int passes = png_set_interlace_handling(png);
	png_read_update_info(png, job->info);
	if (png_get_rowbytes(png, job->info) != 4 * (size_t)width)
		png_error(png, "unknown kind of pixels");
	if (rb_pixmap_init(&job->pixmap, (int)width, (int)height, NULL)) {
		job->memory_out = true;
		png_error(png, "out of memory");
	}
	for (int pass = 0; pass < passes; pass++)
		for (uint32_t y = 0; y < height; y++)
			png_read_row(png, job->pixmap.rgba + 4 * (size_t)width * y, NULL);
	png_read_end(png, NULL);
}

static enum rb_status memory_out(const char *doing, const char *name, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot %s '%s': out of memory", doing, name);
}

enum rb_status rb_png_decode(struct rb_pixmap *pixmap, const char *name, const void *bytes,
                             size_t size, struct rb_error *err)
{
	struct job job = {.bytes = bytes, .size = size};

	*pixmap = (struct rb_pixmap){0};
	const enum rb_status status = check_head(name, bytes, size, err);
	if (status)
		return status;
	job.png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &job, complain, overlook, &job,
	                                   take_memory, give_memory);
	job.info = job.png ? png_create_info_struct(job.png) : NULL;
	if (!job.info) {
		png_destroy_read_struct(&job.png, NULL, NULL);
		return memory_out("read", name, err);
	}
	if (setjmp(job.failed) == 0)
		read_picture(&job);
	png_destroy_read_struct(&job.png, &job.info, NULL);
	if (job.why[0] == '\0') {
		*pixmap = job.pixmap;
		return RB_OK;
	}
	rb_pixmap_release(&job.pixmap);
	if (job.memory_out)
		return memory_out("read", name, err);
	return RB_FAIL(err, RB_ERR_SCENE, "cannot read '%s': the PNG file is %s%s", name,
	               strcmp(job.why, "cut off") == 0 ? "" : "damaged: ", job.why);
}

/* ---- writing ---- */

static void write_bytes(png_structp png, png_bytep from, size_t count)
{
	struct job *const job = png_get_io_ptr(png);

	if (fwrite(from, 1, count, job->file) != count)
		png_error(png, strerror(errno));
}

static void flush_nothing(png_structp png)
{
	(void)png;
}

static bool is_ascii(const char *text)
{
	for (; *text; text++)
		if ((unsigned char)*text >= 0x80)
			return false;
	return true;
}

/* A text chunk: tEXt for ASCII, else iTXt (UTF-8). */
static void write_text(struct job *job, const struct rb_png_text *text)
{
	/* libpng takes pointers that it does not write through */
	png_text one = {.compression = is_ascii(text->text) ? PNG_TEXT_COMPRESSION_NONE
	                                                    : PNG_ITXT_COMPRESSION_NONE};

	memcpy(&one.key, &text->key, sizeof one.key);
	memcpy(&one.text, &text->text, sizeof one.text);
	png_set_text(job->png, job->info, &one, 1);
}

/* Encodes as RGB; leaves by longjmp on errors. */
static void write_picture(struct job *job, const struct rb_pixmap *pixmap,
                          const struct rb_png_text *texts)
{
	png_structp png = job->png;
	const size_t row_size = 4 * (size_t)pixmap->width;

	png_set_write_fn(png, job, write_bytes, flush_nothing);
	/*
	 * A fifth of the time of libpng's own choice: differences along a row, repetitions of one
	 * byte only. Pictures of a thousand balls are 4 % smaller than with the row above and level
	 * 1, which takes a quarter longer.
	 */
	png_set_compression_level(png, 1);
	png_set_compression_strategy(png, Z_RLE);
	png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
	png_set_compression_buffer_size(png, WRITE_BUFFER);
	png_set_IHDR(png, job->info, (png_uint_32)pixmap->width, (png_uint_32)pixmap->height, 8,
	             PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
	             PNG_FILTER_TYPE_DEFAULT);
	png_set_sRGB(png, job->info, PNG_sRGB_INTENT_PERCEPTUAL);
	for (; texts && texts->key; texts++)
		write_text(job, texts);
	png_write_info(png, job->info);
	png_set_filler(png, 0, PNG_FILLER_AFTER);
	for (int y = 0; y < pixmap->height; y++)
		png_write_row(png, pixmap->rgba + row_size * (size_t)y);
	png_write_end(png, NULL);
}

/* Runs libpng's writer. */
static enum rb_status encode(struct job *job, const char *path, const struct rb_pixmap *pixmap,
                             const struct rb_png_text *texts, struct rb_error *err)
{
	job->png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, job, complain, overlook, job,
	                                     take_memory, give_memory);
	job->info = job->png ? png_create_info_struct(job->png) : NULL;
	if (!job->info) {
		png_destroy_write_struct(&job->png, NULL);
		return memory_out("write", path, err);
	}
	if (setjmp(job->failed) == 0)
		write_picture(job, pixmap, texts);
	png_destroy_write_struct(&job->png, &job->info);
	if (job->memory_out)
		return memory_out("write", path, err);
	if (job->why[0] != '\0')
		return RB_FAIL(err, RB_ERR_IO, "cannot write '%s': %s", path, job->why);
	return RB_OK;
}

enum rb_status rb_png_write(const char *path, unsigned how, const struct rb_pixmap *pixmap,
                            const struct rb_png_text *texts, size_t *bytes, struct rb_error *err)
{
	struct rb_outfile out;
	struct job job = {0};
	enum rb_status status = rb_outfile_open(&out, path, how, err);

	if (status)
		return status;
	job.file = out.file;
	status = encode(&job, path, pixmap, texts, err);
	if (status) {
		rb_outfile_release(&out);
		return status;
	}
	const long size = ftell(out.file);
	if (bytes)
		*bytes = size > 0 ? (size_t)size : 0;
	return rb_outfile_publish(&out, err);
}
