/* SPDX-License-Identifier: MIT */
/* src/geom/meshfile.c: corners from STL and OBJ files, and from bytes that are none. */
#include "support.h"

#include "geom/meshfile.h"
#include "math/random.h"

/* A tetrahedron of four triangles, as binary STL whose header reads like one of text. */
static size_t tetrahedron(char *out)
{
	static const float corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3.5f}};
	static const int face[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
	size_t at = 84;

	memset(out, 0, 84);
	memcpy(out, "solid of some program", 21);
	out[80] = 4;
	for (int k = 0; k < 4; k++) {
		memset(out + at, 0, 50);
		for (int i = 0; i < 3; i++)
			memcpy(out + at + 12 + 12 * i, corner[face[k][i]], 12);
		at += 50;
	}
	out[at] = '\0';
	return at;
}

static void corners_of_a_binary_file_are_distinct_and_in_order(void **state)
{
	char bytes[300];
	rb_vec3 points[100];
	struct rb_error err;
	size_t count;
	const size_t size = tetrahedron(bytes);
	(void)state;

	assert_true(rb_meshfile_corners_max(RB_MESHFILE_STL, size) <= 100);
	assert_int_equal(rb_meshfile_read(RB_MESHFILE_STL, bytes, size, points, &count, &err),
	                 RB_OK);
	assert_int_equal(count, 4);
	assert_true(points[0].x == 0 && points[0].y == 0 && points[0].z == 0);
	assert_true(points[1].z == 3.5 && points[2].y == 2 && points[3].x == 1);
}

static void text_is_read_as_written(void **state)
{
	static const char stl[] = "solid x\nfacet normal 0 0 1\nouter loop\n vertex 0 0 0\n"
				  "\tvertex 1e0 0 0\r\nvertex +0.0 -2. 0\nendloop\nendfacet\n"
				  "vertex 0 0 .125\nendsolid x\n";
	static const char obj[] = "# a comment\nv 1 2 3 1.0\nvn 0 0 1\nvt 0 0\nv -1 0 0\nf 1 2 2\n"
				  "v 1 2 3\nv 0 0 0";
	rb_vec3 points[64];
	struct rb_error err;
	size_t count;
	(void)state;

	assert_int_equal(
		rb_meshfile_read(RB_MESHFILE_STL, stl, sizeof stl - 1, points, &count, &err),
		RB_OK);
	assert_int_equal(count, 4);
	assert_true(points[0].y == -2 && points[2].z == 0.125 && points[3].x == 1);
	assert_int_equal(
		rb_meshfile_read(RB_MESHFILE_OBJ, obj, sizeof obj - 1, points, &count, &err),
		RB_OK);
	assert_int_equal(count, 3);
	assert_true(points[0].x == -1 && points[2].z == 3);
}

static void what_is_wrong_is_told(void **state)
{
	static const struct {
		enum rb_meshfile_kind kind;
		const char *bytes, *told;
	} wrong[] = {
		{RB_MESHFILE_STL, "", "it is no STL file"},
		{RB_MESHFILE_STL, "solid x\nendsolid x\n", "it has no corners"},
		{RB_MESHFILE_STL, "solid\nvertex 1 2\nvertex 3 4 5\n", "line 2 has not three"},
		{RB_MESHFILE_STL, "solid\nvertex 1 2 nan\n", "line 2 has not three"},
		{RB_MESHFILE_STL, "solid\nvertex 1 2 1e999\n", "line 2 has not three"},
		{RB_MESHFILE_OBJ, "v 0 0 0\nv 1 0\n2\n", "line 2 has not three"},
		{RB_MESHFILE_OBJ, "f 1 2 3\n", "it has no corners"},
		{RB_MESHFILE_OBJ, "v infinity 0 0\n", "line 1 has not three"},
	};
	rb_vec3 points[64];
	struct rb_error err;
	size_t count;
	(void)state;

	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		assert_int_equal(rb_meshfile_read(wrong[i].kind, wrong[i].bytes,
		                                  strlen(wrong[i].bytes), points, &count, &err),
		                 RB_ERR_SCENE);
		assert_non_null(strstr(err.text, wrong[i].told));
	}
	assert_int_equal(rb_meshfile_kind("a/b.STL"), RB_MESHFILE_STL);
	assert_int_equal(rb_meshfile_kind("b.obj"), RB_MESHFILE_OBJ);
	assert_int_equal(rb_meshfile_kind("stl"), RB_MESHFILE_NONE);
	assert_int_equal(rb_meshfile_kind("a.stl/b"), RB_MESHFILE_NONE);
}

/* Cut off and changed files in memory of exactly their size: nothing beside it is touched. */
static void damaged_files_are_refused_or_read(void **state)
{
	char whole[300];
	const size_t size = tetrahedron(whole);
	(void)state;

	for (uint64_t k = 0; k < 4000; k++) {
		const size_t cut = k < size ? (size_t)k : size;
		const enum rb_meshfile_kind kind = k % 3 ? RB_MESHFILE_STL : RB_MESHFILE_OBJ;
		char *const bytes = rb_memory_take(cut + 1, 1);
		rb_vec3 *const points = rb_memory_take(rb_meshfile_corners_max(kind, cut),
		                                       sizeof *points);
		struct rb_error err = {0};
		size_t count = 0;

		memcpy(bytes, whole, cut);
		for (int i = 0; i < 3 && k >= size; i++)
			bytes[rb_random_bits(k, 1, (uint64_t)i) % cut] = (char)(unsigned char)
				rb_random_bits(k, 2, (uint64_t)i);
		if (k % 7 == 0 && cut > 20)
			memcpy(bytes, "\nv 1 2 3\nvertex 0 0 0", 20);
		const enum rb_status status = rb_meshfile_read(kind, bytes, cut, points, &count,
		                                               &err);
		assert_true(status == RB_OK ? count >= 1 : status == RB_ERR_SCENE && *err.text);
		for (size_t i = 1; i < count && !status; i++)
			assert_false(points[i].x == points[i - 1].x &&
			             points[i].y == points[i - 1].y &&
			             points[i].z == points[i - 1].z);
		rb_memory_free(points);
		rb_memory_free(bytes);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(corners_of_a_binary_file_are_distinct_and_in_order),
		cmocka_unit_test(text_is_read_as_written),
		cmocka_unit_test(what_is_wrong_is_told),
		cmocka_unit_test(damaged_files_are_refused_or_read),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
