/* SPDX-License-Identifier: MIT */
/*
 * Text, because the protocol is lines that people can read and any language can split; base64 of
 * single precision for the columns, because a viewer draws pixels and 4 bytes a number are a third
 * of what 17 digits take. Numbers that are compared (energies, counts) are in full.
 *
 * Bytes are composed by shifts, so that the order does not depend on the machine. Reading accepts
 * exactly what writing makes: one text for one frame.
 */
#include "control/wire.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "flow/frame.h"

/*
 * NUMBERS_SIZE: all words before the columns; numbers take at most 24 bytes, counts 20. WORD_SIZE:
 * the longest of them, and a zero.
 */
enum { NUMBERS_SIZE = 640, WORD_SIZE = 40 };

static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/* ---- base64 ---- */

size_t rb_wire_base64_size(size_t bytes)
{
	return (bytes + 2) / 3 * 4;
}

void rb_wire_base64_write(char *text, const void *bytes, size_t size)
{
	const unsigned char *const in = bytes;

	for (size_t i = 0; i < size; i += 3) {
		const size_t left = size - i;
		const unsigned group = (unsigned)in[i] << 16 |
		                       (left > 1 ? (unsigned)in[i + 1] << 8 : 0) |
		                       (left > 2 ? (unsigned)in[i + 2] : 0);
		*text++ = digits[group >> 18];
		*text++ = digits[group >> 12 & 63];
		*text++ = left > 1 ? digits[group >> 6 & 63] : '=';
		*text++ = left > 2 ? digits[group & 63] : '=';
	}
}

/* Value of a digit of base64, 64 where it is none. */
static unsigned value_of(char digit)
{
	if (digit >= 'A' && digit <= 'Z')
		return (unsigned)(digit - 'A');
	if (digit >= 'a' && digit <= 'z')
		return (unsigned)(digit - 'a') + 26;
	if (digit >= '0' && digit <= '9')
		return (unsigned)(digit - '0') + 52;
	return digit == '+' ? 62 : digit == '/' ? 63 : 64;
}

bool rb_wire_base64_read(void *bytes, size_t size, const char *text, size_t text_size)
{
	unsigned char *const out = bytes;

	/* the bound keeps the computed size from wrapping */
	if (size > SIZE_MAX / 2 || text_size != rb_wire_base64_size(size))
		return false;
	for (size_t i = 0; i < size; i += 3, text += 4) {
		const size_t left = size - i;
		const unsigned a = value_of(text[0]), b = value_of(text[1]);
		const unsigned c = left > 1 ? value_of(text[2]) : 0;
		const unsigned d = left > 2 ? value_of(text[3]) : 0;
		if ((a | b | c | d) > 63 || (left < 2 && text[2] != '=') ||
		    (left < 3 && text[3] != '='))
			return false;
		/* bits behind the last byte would make two texts of the same bytes */
		if ((left == 1 && b & 15) || (left == 2 && c & 3))
			return false;
		out[i] = (unsigned char)(a << 2 | b >> 4);
		if (left > 1)
			out[i + 1] = (unsigned char)(b << 4 | c >> 2);
		if (left > 2)
			out[i + 2] = (unsigned char)(c << 6 | d);
	}
	return true;
}

/* ---- columns ---- */

/* The columns in the order of the protocol, with their numbers for each body. */
enum { COLUMN_COUNT = 4 };
static const struct {
	char letter;
	int width;
} columns[COLUMN_COUNT] = {{'p', 3}, {'o', 4}, {'v', 3}, {'w', 3}};

/* Address of the k-th column of a frame. */
static double **column_of(struct rb_frame *frame, int k)
{
	double **const all[COLUMN_COUNT] = {&frame->position, &frame->orientation, &frame->velocity,
	                                    &frame->angular_velocity};

	RB_ASSERT(k >= 0 && k < COLUMN_COUNT);
	return all[k];
}

/* The k-th column, NULL where the frame has none. */
static const double *values_of(const struct rb_frame *frame, int k)
{
	const double *const all[COLUMN_COUNT] = {frame->position, frame->orientation,
	                                         frame->velocity, frame->angular_velocity};

	RB_ASSERT(k >= 0 && k < COLUMN_COUNT);
	return all[k];
}

/*
 * Writes a value as IEEE 754 single precision, little endian. What is larger than that holds is as
 * far away as it goes.
 */
static void put_single(unsigned char out[4], double value)
{
	const float single = (float)fmin(fmax(value, -(double)FLT_MAX), (double)FLT_MAX);
	uint32_t bits;

	memcpy(&bits, &single, sizeof bits);
	for (int i = 0; i < 4; i++)
		out[i] = (unsigned char)(bits >> 8 * i & 255);
}

/* False where the bytes are no finite number. */
static bool get_single(const unsigned char in[4], double *value)
{
	uint32_t bits = 0;
	float single;

	for (int i = 0; i < 4; i++)
		bits |= (uint32_t)in[i] << 8 * i;
	memcpy(&single, &bits, sizeof single);
	*value = (double)single;
	return isfinite(single);
}

/* ---- writing ---- */

/* Writes the words before the columns; returns their size, always below NUMBERS_SIZE. */
static int put_head(char out[NUMBERS_SIZE], const struct rb_frame *frame)
{
	const struct rb_frame_numbers *const n = &frame->numbers;
	char letters[COLUMN_COUNT + 1] = "-";
	int count = 0;

	for (int k = 0; k < COLUMN_COUNT; k++)
		if (values_of(frame, k))
			letters[count++] = columns[k].letter;
	return snprintf(
		out, NUMBERS_SIZE,
		"frame %" PRIu64 " %.17g %d %s %.17g %.17g %.17g %.17g %.17g %.17g %.17g "
		"%.17g %.17g %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 " %.17g %.17g %.17g "
		"%.17g ",
		frame->index, frame->time_s, frame->body_count, letters, n->kinetic_energy,
		n->potential_energy, n->momentum.x, n->momentum.y, n->momentum.z,
		n->angular_momentum.x, n->angular_momentum.y, n->angular_momentum.z,
		n->max_penetration, n->contacts, n->collisions, n->rollbacks, n->substeps,
		n->smallest_step, n->stepped, n->gravitation_error, n->gravitation_energy_error);
}

/* Values on their way to base64, by threes of bytes. */
struct packer {
	char *out;
	unsigned char bytes[12];
	size_t count;
};

/* Adds a value; 12 bytes at a time become 16 digits without padding. */
static void pack(struct packer *packer, double value)
{
	RB_ASSERT_COSTLY(packer->count < sizeof packer->bytes);
	put_single(packer->bytes + packer->count, value);
	packer->count += 4;
	if (packer->count < sizeof packer->bytes)
		return;
	rb_wire_base64_write(packer->out, packer->bytes, sizeof packer->bytes);
	packer->out += rb_wire_base64_size(sizeof packer->bytes);
	packer->count = 0;
}

enum rb_status rb_wire_write_frame(char **text, size_t *capacity, size_t *size,
                                   const struct rb_frame *frame, struct rb_error *err)
{
	char head[NUMBERS_SIZE];
	const size_t head_size = (size_t)put_head(head, frame);
	RB_ASSERT(head_size < NUMBERS_SIZE);
	const size_t bodies = (size_t)frame->body_count;
	size_t bytes = 0;

	*size = 0;
	for (int k = 0; k < COLUMN_COUNT; k++)
		bytes += values_of(frame, k) ? 4 * (size_t)columns[k].width * bodies : 0;
	const size_t needed = head_size + rb_wire_base64_size(bytes) + 2;
	if (!rb_memory_reserve(text, capacity, needed, 1))
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "cannot send a frame of %d bodies: out of memory",
		               frame->body_count);
	memcpy(*text, head, head_size);
	struct packer packer = {.out = *text + head_size};
	for (int k = 0; k < COLUMN_COUNT; k++) {
		const double *const values = values_of(frame, k);
		for (size_t i = 0; values && i < (size_t)columns[k].width * bodies; i++)
			pack(&packer, values[i]);
	}
	rb_wire_base64_write(packer.out, packer.bytes, packer.count);
	packer.out += rb_wire_base64_size(packer.count);
	if (bytes == 0)
		*packer.out++ = '-';
	*packer.out = '\0';
	*size = (size_t)(packer.out - *text);
	RB_ASSERT(*size < needed);
	return RB_OK;
}

/* ---- reading ---- */

/* A line as words; nothing behind `end` is looked at. */
struct reader {
	const char *at, *end;
};

/*
 * The next word of at most WORD_SIZE - 1 bytes; one space parts words. False: there is none, or it
 * is longer, or it holds a zero.
 */
static bool take_word(struct reader *reader, char word[WORD_SIZE])
{
	const size_t left = (size_t)(reader->end - reader->at);
	const char *const space = left > 0 ? memchr(reader->at, ' ', left) : NULL;
	const size_t size = space ? (size_t)(space - reader->at) : 0;

	RB_ASSERT(reader->at <= reader->end);
	if (size == 0 || size >= WORD_SIZE)
		return false;
	memcpy(word, reader->at, size);
	word[size] = '\0';
	reader->at = space + 1;
	return memchr(word, '\0', size) == NULL;
}

/* A whole number of at most 19 digits, which fit 64 bits. */
static bool take_count(struct reader *reader, uint64_t *value)
{
	char word[WORD_SIZE];

	if (!take_word(reader, word) || word[strspn(word, "0123456789")] != '\0' ||
	    strlen(word) > 19)
		return false;
	*value = strtoull(word, NULL, 10);
	return true;
}

/*
 * A number as C prints it. Numbers of the scene may be infinite or NAN, as in a run that has gone
 * wrong; hexadecimal ones are refused.
 */
static bool take_number(struct reader *reader, double *value)
{
	char word[WORD_SIZE], *end;

	if (!take_word(reader, word) || word[strspn(word, "+-.0123456789einfa")] != '\0')
		return false;
	*value = strtod(word, &end);
	return end != word && *end == '\0';
}

/* The numbers of the scene, in the order of put_head. */
static bool take_numbers(struct reader *reader, struct rb_frame_numbers *n)
{
	double *const before[] = {
		&n->kinetic_energy,     &n->potential_energy,   &n->momentum.x,
		&n->momentum.y,         &n->momentum.z,         &n->angular_momentum.x,
		&n->angular_momentum.y, &n->angular_momentum.z, &n->max_penetration};
	uint64_t *const counts[] = {&n->contacts, &n->collisions, &n->rollbacks, &n->substeps};
	bool right = true;

	for (size_t i = 0; i < sizeof before / sizeof *before; i++)
		right = right && take_number(reader, before[i]);
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		right = right && take_count(reader, counts[i]);
	double *const after[] = {&n->smallest_step, &n->stepped, &n->gravitation_error,
	                         &n->gravitation_energy_error};
	for (size_t i = 0; i < sizeof after / sizeof *after; i++)
		right = right && take_number(reader, after[i]);
	return right;
}

/* Which columns the letters name, in their order and once each. False: they are none. */
static bool take_columns(struct reader *reader, bool has[COLUMN_COUNT])
{
	char word[WORD_SIZE];

	if (!take_word(reader, word))
		return false;
	const char *at = strcmp(word, "-") == 0 ? "" : word;
	for (int k = 0; k < COLUMN_COUNT; k++) {
		has[k] = *at == columns[k].letter;
		at += has[k];
	}
	return *at == '\0';
}

/*
 * Gives the frame the columns that the line has; one that stays keeps its memory. False: no memory.
 */
static bool shape(struct rb_frame *frame, int body_count, const bool has[COLUMN_COUNT])
{
	RB_ASSERT(body_count >= 0);
	if (frame->body_count != body_count)
		rb_frame_release(frame);
	frame->body_count = body_count;
	for (int k = 0; k < COLUMN_COUNT; k++) {
		double **const column = column_of(frame, k);
		if (!has[k]) {
			rb_memory_free(*column);
			*column = NULL;
		} else if (!*column) {
			*column = rb_memory_take((size_t)body_count,
			                         (size_t)columns[k].width * sizeof **column);
			if (!*column)
				return false;
		}
	}
	return true;
}

/*
 * Reads all columns from the base64 text that is left of the line. False where its size or a digit
 * is wrong, or a value is not finite.
 */
static bool take_values(struct reader *reader, struct rb_frame *frame)
{
	const size_t bodies = (size_t)frame->body_count;
	size_t bytes = 0, at = 0;
	unsigned char group[12];

	for (int k = 0; k < COLUMN_COUNT; k++)
		bytes += values_of(frame, k) ? 4 * (size_t)columns[k].width * bodies : 0;
	const size_t left = (size_t)(reader->end - reader->at);
	if (bytes == 0)
		return left == 1 && *reader->at == '-';
	if (left != rb_wire_base64_size(bytes))
		return false;
	for (int k = 0; k < COLUMN_COUNT; k++) {
		double *const values = *column_of(frame, k);
		for (size_t i = 0; values && i < (size_t)columns[k].width * bodies; i++, at += 4) {
			const size_t in = at % sizeof group;
			if (in == 0) {
				const size_t size = bytes - at < sizeof group ? bytes - at
				                                              : sizeof group;
				if (!rb_wire_base64_read(group, size, reader->at + at / 3 * 4,
				                         rb_wire_base64_size(size)))
					return false;
			}
			if (!get_single(group + in, &values[i]))
				return false;
		}
	}
	return true;
}

enum rb_status rb_wire_read_frame(struct rb_frame *frame, int body_count, const char *line,
                                  size_t size, struct rb_error *err)
{
	struct reader reader = {.at = line, .end = line + size};
	char word[WORD_SIZE];
	bool has[COLUMN_COUNT];
	uint64_t index, bodies;
	double time_s;

	if (!take_word(&reader, word) || strcmp(word, "frame") != 0 ||
	    !take_count(&reader, &index) || !take_number(&reader, &time_s) || !isfinite(time_s) ||
	    !take_count(&reader, &bodies) || !take_columns(&reader, has))
		return RB_FAIL(err, RB_ERR_INPUT, "a line of %zu bytes is not a frame", size);
	if (body_count < 0 || bodies != (uint64_t)body_count)
		return RB_FAIL(err, RB_ERR_INPUT, "a frame has %" PRIu64 " bodies, wanted %d",
		               bodies, body_count);
	if (!shape(frame, body_count, has))
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "cannot hold a frame of %d bodies: out of memory", body_count);
	frame->index = index;
	frame->time_s = time_s;
	frame->event_count = frame->contact_count = frame->shot_count = 0;
	if (!take_numbers(&reader, &frame->numbers) || !take_values(&reader, frame))
		return RB_FAIL(err, RB_ERR_INPUT,
		               "frame %" PRIu64 " does not contain numbers of %d bodies", index,
		               body_count);
	return RB_OK;
}
