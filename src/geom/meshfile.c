/* SPDX-License-Identifier: MIT */
/*
 * A binary STL file is known by its length, 84 bytes and 50 for each of the triangles that it says
 * it has, because many such files begin with "solid" like those of text. Sorting is done in place:
 * whoever calls owns the memory (Lua, which may jump), and nothing is taken here.
 */
#include "geom/meshfile.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/error.h"

/* STL: bytes before the triangles, of each, before its corners. */
enum { STL_HEAD = 84, STL_TRIANGLE = 50, STL_NORMAL = 12, STL_COUNT_AT = 80 };
/* Text: "v 0 0 0\n" and "vertex 0 0 0\n" at least. */
enum { OBJ_LINE = 8 };

enum rb_meshfile_kind rb_meshfile_kind(const char *name)
{
	const char *const dot = strrchr(name, '.');

	if (dot && strcasecmp(dot, ".stl") == 0)
		return RB_MESHFILE_STL;
	return dot && strcasecmp(dot, ".obj") == 0 ? RB_MESHFILE_OBJ : RB_MESHFILE_NONE;
}

size_t rb_meshfile_corners_max(enum rb_meshfile_kind kind, size_t size)
{
	/* a corner of a binary file takes more than 16 bytes, of text more than 12 */
	return kind == RB_MESHFILE_NONE ? 0 : size / OBJ_LINE + 1;
}

/* Four bytes as STL has them. */
static uint32_t little_endian(const char *bytes)
{
	uint32_t value = 0;

	for (int i = 3; i >= 0; i--)
		value = value << 8 | (unsigned char)bytes[i];
	return value;
}

static bool is_binary(const char *bytes, size_t size)
{
	return size >= STL_HEAD &&
	       (uint64_t)size ==
	               STL_HEAD + (uint64_t)STL_TRIANGLE * little_endian(bytes + STL_COUNT_AT);
}

static enum rb_status read_binary(const char *bytes, size_t size, rb_vec3 *points, size_t *count,
                                  struct rb_error *err)
{
	for (size_t at = STL_HEAD; at + STL_TRIANGLE <= size; at += STL_TRIANGLE)
		for (int corner = 0; corner < 3; corner++) {
			double p[3];
			for (int k = 0; k < 3; k++) {
				const size_t offset = at + STL_NORMAL +
				                      (size_t)(12 * corner + 4 * k);
				const uint32_t word = little_endian(bytes + offset);
				float single;

				memcpy(&single, &word, sizeof single);
				p[k] = (double)single;
				if (!isfinite(p[k]))
					return RB_FAIL(
						err, RB_ERR_SCENE,
						"triangle %zu has a corner that is not finite",
						(at - STL_HEAD) / STL_TRIANGLE + 1);
			}
			points[(*count)++] = (rb_vec3){p[0], p[1], p[2]};
		}
	return RB_OK;
}

/* Three finite numbers at `*text`, which goes on behind them; false: there are none. */
static bool read_corner(const char **text, rb_vec3 *point)
{
	double p[3];

	for (int k = 0; k < 3; k++) {
		const char *const from = *text + strspn(*text, " \t");
		char *end;

		/* strtod would pass over the end of the line, and take what is no number of STL */
		if (!strchr("+-.0123456789", *from) || *from == '\0')
			return false;
		p[k] = strtod(from, &end);
		if (end == from || !isfinite(p[k]))
			return false;
		*text = end;
	}
	*point = (rb_vec3){p[0], p[1], p[2]};
	return true;
}

/* Reads the lines that begin with a word. */
static enum rb_status read_text(const char *word, const char *bytes, size_t size, rb_vec3 *points,
                                size_t *count, struct rb_error *err)
{
	const char *const end = bytes + size;
	const size_t length = strlen(word);
	size_t line = 1;

	for (const char *at = bytes; at < end; line++) {
		at += strspn(at, " \t");
		if (strncmp(at, word, length) == 0 && (at[length] == ' ' || at[length] == '\t')) {
			RB_ASSERT(*count < rb_meshfile_corners_max(RB_MESHFILE_OBJ, size));
			at += length;
			if (!read_corner(&at, &points[*count]))
				return RB_FAIL(err, RB_ERR_SCENE,
				               "line %zu has not three finite numbers behind '%s'",
				               line, word);
			++*count;
		}
		/* a zero among the bytes ends no line */
		const char *const newline = memchr(at, '\n', (size_t)(end - at));
		at = newline ? newline + 1 : end;
	}
	return RB_OK;
}

static bool is_before(rb_vec3 a, rb_vec3 b)
{
	return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

/* Restores the heap's order below `root`. */
static void sift(rb_vec3 *heap, size_t root, size_t count)
{
	for (size_t child; (child = 2 * root + 1) < count; root = child) {
		if (child + 1 < count && is_before(heap[child], heap[child + 1]))
			child++;
		if (!is_before(heap[root], heap[child]))
			return;
		const rb_vec3 other = heap[root];
		heap[root] = heap[child];
		heap[child] = other;
	}
}

/* Sorts, and keeps one of equal corners; heapsort, in place. How many stay. */
static size_t make_distinct(rb_vec3 *points, size_t count)
{
	size_t kept = 0;

	for (size_t k = count / 2; k-- > 0;)
		sift(points, k, count);
	for (size_t last = count; last-- > 1;) {
		const rb_vec3 top = points[0];
		points[0] = points[last];
		points[last] = top;
		sift(points, 0, last);
	}
	for (size_t k = 0; k < count; k++)
		if (kept == 0 || is_before(points[kept - 1], points[k]))
			points[kept++] = points[k];
	return kept;
}

enum rb_status rb_meshfile_read(enum rb_meshfile_kind kind, const char *bytes, size_t size,
                                rb_vec3 *points, size_t *count, struct rb_error *err)
{
	enum rb_status status;

	RB_ASSERT(kind != RB_MESHFILE_NONE && bytes[size] == '\0');
	*count = 0;
	if (kind == RB_MESHFILE_STL && is_binary(bytes, size))
		status = read_binary(bytes, size, points, count, err);
	else if (kind == RB_MESHFILE_STL && strncmp(bytes, "solid", 5) != 0)
		return RB_FAIL(err, RB_ERR_SCENE,
		               "it is no STL file, or cut off: it has %zu bytes and neither begins "
		               "with 'solid' nor says so many triangles",
		               size);
	else
		status = read_text(kind == RB_MESHFILE_STL ? "vertex" : "v", bytes, size, points,
		                   count, err);
	if (status)
		return status;
	if (*count == 0)
		return RB_FAIL(err, RB_ERR_SCENE, "it has no corners");
	*count = make_distinct(points, *count);
	return RB_OK;
}
