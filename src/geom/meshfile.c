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

/* Reads all corners, as often as the file has them. */
static enum rb_status read_corners(enum rb_meshfile_kind kind, const char *bytes, size_t size,
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
	return *count > 0 ? RB_OK : RB_FAIL(err, RB_ERR_SCENE, "it has no corners");
}

enum rb_status rb_meshfile_read(enum rb_meshfile_kind kind, const char *bytes, size_t size,
                                rb_vec3 *points, size_t *count, struct rb_error *err)
{
	const enum rb_status status = read_corners(kind, bytes, size, points, count, err);

	if (status == RB_OK)
		*count = make_distinct(points, *count);
	return status;
}

/* ---- triangles ---- */

static enum rb_status too_many(const struct rb_meshfile_triangles *mesh, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_SCENE, "it has more than %zu triangles", mesh->triangles_max);
}

/* Place of a point among distinct ones in order (bisection). */
static int place_of(const rb_vec3 *points, size_t count, rb_vec3 point)
{
	size_t from = 0, to = count;

	while (to - from > 1) {
		const size_t middle = from + (to - from) / 2;
		if (is_before(point, points[middle]))
			to = middle;
		else
			from = middle;
	}
	return (int)from;
}

/* Three corners in a row are a triangle of STL. */
static enum rb_status join_corners(struct rb_meshfile_triangles *mesh, struct rb_error *err)
{
	const size_t all_count = mesh->count;
	rb_vec3 *const all = mesh->points + all_count;

	if (all_count % 3 != 0)
		return RB_FAIL(err, RB_ERR_SCENE,
		               "it is cut off: its last triangle has %zu corner%s", all_count % 3,
		               all_count % 3 == 1 ? "" : "s");
	if (all_count / 3 > mesh->triangles_max)
		return too_many(mesh, err);
	memcpy(all, mesh->points, all_count * sizeof *all);
	mesh->count = make_distinct(mesh->points, all_count);
	for (size_t k = 0; k < all_count; k++)
		mesh->corners[k / 3][k % 3] = place_of(mesh->points, mesh->count, all[k]);
	mesh->triangle_count = all_count / 3;
	return RB_OK;
}

/*
 * A corner of a face, `7`, `7/1`, `7//2` or `-1`, counted from 1, or back from the last vertex that
 * the file has had so far; it becomes counted from 0. False: it is none.
 */
static bool read_index(const char **text, size_t so_far, int *index)
{
	const char *const from = *text + strspn(*text, " \t");
	char *end;

	if (!strchr("+-0123456789", *from) || *from == '\0')
		return false;
	const long long number = strtoll(from, &end, 10);
	const long long place = number < 0 ? (long long)so_far + number : number - 1;
	if (end == from || place < 0 || place >= (long long)so_far)
		return false;
	*text = end + strcspn(end, " \t\r\n");
	*index = (int)place;
	return true;
}

/* Reads the corners of a face, behind its `f`; how many, as far as there was room. */
static int read_face(const char **at, size_t so_far, struct rb_meshfile_triangles *mesh, bool *full)
{
	int first = 0, before = 0, now, found = 0;

	for (; read_index(at, so_far, &now); found++) {
		*full = found >= 2 && mesh->triangle_count == mesh->triangles_max;
		if (*full)
			return found;
		if (found >= 2) {
			int *const corner = mesh->corners[mesh->triangle_count++];
			corner[0] = first;
			corner[1] = before;
			corner[2] = now;
		}
		first = found == 0 ? now : first;
		before = now;
	}
	return found;
}

/* Reads the faces of OBJ. */
static enum rb_status read_faces(const char *bytes, size_t size, struct rb_meshfile_triangles *mesh,
                                 struct rb_error *err)
{
	const char *const end = bytes + size;
	size_t line = 1, so_far = 0;
	bool full = false;

	for (const char *at = bytes; at < end; line++) {
		at += strspn(at, " \t");
		const char *const newline = memchr(at, '\n', (size_t)(end - at));
		const bool is_word = at < end && (at[1] == ' ' || at[1] == '\t');
		so_far += is_word && at[0] == 'v';
		if (is_word && at[0] == 'f') {
			at++;
			const int found = read_face(&at, so_far, mesh, &full);
			if (full)
				return too_many(mesh, err);
			at += strspn(at, " \t\r");
			if (found < 3 || (*at != '\n' && *at != '\0' && *at != '#'))
				return RB_FAIL(err, RB_ERR_SCENE,
				               "line %zu is no face of three vertices or more, all "
				               "of which stand above it",
				               line);
		}
		at = newline ? newline + 1 : end;
	}
	return RB_OK;
}

enum rb_status rb_meshfile_read_triangles(enum rb_meshfile_kind kind, const char *bytes,
                                          size_t size, struct rb_meshfile_triangles *mesh,
                                          struct rb_error *err)
{
	enum rb_status status = read_corners(kind, bytes, size, mesh->points, &mesh->count, err);

	mesh->triangle_count = 0;
	if (status)
		return status;
	status = kind == RB_MESHFILE_STL ? join_corners(mesh, err)
	                                 : read_faces(bytes, size, mesh, err);
	if (!status && mesh->triangle_count == 0)
		status = RB_FAIL(err, RB_ERR_SCENE, "it has no triangles");
	return status;
}
