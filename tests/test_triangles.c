/* SPDX-License-Identifier: MIT */
/* src/geom/triangles.c: which facets are near, and which touches at their edges are real. */
#include "support.h"

#include "geom/triangles.h"
#include "math/random.h"
#include "math/vec3.h"

enum { SIDE = 9, VERTICES = (SIDE + 1) * (SIDE + 1), FACETS = 2 * SIDE * SIDE };

struct sheet {
	rb_vec3 vertices[VERTICES];
	int corners[FACETS][3];
	struct rb_terrain *terrain;
};

/* A grid of unit cells, heights by a profile. */
static void make(struct sheet *sheet, double (*height)(double x, double y))
{
	struct rb_error err;
	int count = 0;

	for (int j = 0; j <= SIDE; j++)
		for (int i = 0; i <= SIDE; i++)
			sheet->vertices[j * (SIDE + 1) + i] = (rb_vec3){i, j, height(i, j)};
	for (int j = 0; j < SIDE; j++)
		for (int i = 0; i < SIDE; i++) {
			const int low = j * (SIDE + 1) + i, high = low + SIDE + 1;
			const int two[2][3] = {{low, low + 1, high + 1}, {low, high + 1, high}};
			memcpy(sheet->corners[count], two, sizeof two);
			count += 2;
		}
	assert_int_equal(rb_terrain_create(&sheet->terrain, sheet->vertices, VERTICES,
	                                   (const int(*)[3])sheet->corners, FACETS, &err),
	                 RB_OK);
}

static double flat(double x, double y)
{
	(void)x, (void)y;
	return 0;
}

static double waves(double x, double y)
{
	return sin(x) * cos(2 * y);
}

/* A ridge along y at x = 4, and a valley at x = 7. */
static double folds(double x, double y)
{
	(void)y;
	return x < 4 ? x : x < 7 ? 8 - x : x - 6;
}

static double uniform(uint64_t *n, double low, double high)
{
	return low + (high - low) * rb_random_unit(7, 0, (*n)++);
}

static void a_walk_misses_no_facet_within_its_distance(void **state)
{
	static struct sheet sheet;
	uint64_t n = 0;
	(void)state;

	make(&sheet, waves);
	for (int try = 0; try < 300; try++) {
		const rb_vec3 at = {uniform(&n, -3, 12), uniform(&n, -3, 12), uniform(&n, -4, 4)};
		const double within = uniform(&n, 0, 3);
		bool seen[FACETS] = {false};
		struct rb_terrain_walk walk;
		int visits = 0;

		rb_terrain_walk_begin(&walk, sheet.terrain, at, within);
		for (int f; (f = rb_terrain_walk_next(&walk)) >= 0; visits++) {
			assert_false(seen[f]);
			seen[f] = true;
		}
		for (int f = 0; f < FACETS; f++) {
			const int *const c = sheet.corners[f];
			const double d = rb_terrain_distance(&sheet.vertices[c[0]],
			                                     &sheet.vertices[c[1]],
			                                     &sheet.vertices[c[2]], at);
			assert_true(d > within || seen[f]);
		}
		/* boxes of unit cells: none that is farther than its own diagonal is asked */
		assert_true(visits <= 8 * (within + 2) * (within + 2));
	}
	rb_terrain_destroy(sheet.terrain);
}

/* The lowest distance that a walk finds if it goes no farther than what it has found. */
static void a_walk_that_is_cut_short_finds_the_nearest(void **state)
{
	static struct sheet sheet;
	uint64_t n = 0;
	int asked = 0;
	(void)state;

	make(&sheet, waves);
	for (int try = 0; try < 300; try++) {
		const rb_vec3 at = {uniform(&n, -3, 12), uniform(&n, -3, 12), uniform(&n, -4, 4)};
		double found = HUGE_VAL, least = HUGE_VAL;
		struct rb_terrain_walk walk;

		rb_terrain_walk_begin(&walk, sheet.terrain, at, HUGE_VAL);
		for (int f; (f = rb_terrain_walk_next(&walk)) >= 0; asked++) {
			const int *const c = sheet.corners[f];
			found = fmin(found, rb_terrain_distance(&sheet.vertices[c[0]],
			                                        &sheet.vertices[c[1]],
			                                        &sheet.vertices[c[2]], at));
			walk.within = found;
		}
		for (int f = 0; f < FACETS; f++) {
			const int *const c = sheet.corners[f];
			least = fmin(least, rb_terrain_distance(&sheet.vertices[c[0]],
			                                        &sheet.vertices[c[1]],
			                                        &sheet.vertices[c[2]], at));
		}
		assert_true(found == least);
	}
	/* far fewer than the 162 that there are */
	assert_true(asked < 300 * 40);
	rb_terrain_destroy(sheet.terrain);
}

/* A sphere of radius 1 at a place, which touches the facet's point nearest to it. */
static bool touches(const struct sheet *sheet, int facet, rb_vec3 on, rb_vec3 centre)
{
	const rb_vec3 zero = {0, 0, 0};

	return rb_terrain_touch_is_real(sheet->terrain, facet, on,
	                                rb_vec3_unit(rb_vec3_sub(centre, on), zero), &zero);
}

/* Facet of the cell at (i, j): the one below its diagonal, or above. */
static int facet_at(int i, int j, bool above)
{
	return 2 * (j * SIDE + i) + above;
}

static void edges_in_a_plane_are_not_felt(void **state)
{
	static struct sheet sheet;
	(void)state;

	make(&sheet, flat);
	/* over its own middle */
	assert_true(touches(&sheet, facet_at(4, 4, false), (rb_vec3){4.6, 4.3, 0},
	                    (rb_vec3){4.6, 4.3, 1}));
	/* over the cell beside it: an edge, a diagonal and a corner ahead */
	assert_false(touches(&sheet, facet_at(4, 4, true), (rb_vec3){4, 4.5, 0},
	                     (rb_vec3){3.9, 4.5, 1}));
	assert_false(touches(&sheet, facet_at(4, 4, true), (rb_vec3){4.4, 4.4, 0},
	                     (rb_vec3){4.5, 4.3, 1}));
	assert_false(
		touches(&sheet, facet_at(4, 4, true), (rb_vec3){4, 4, 0}, (rb_vec3){3.9, 3.95, 1}));
	/* just over the edge, whichever side rounding takes */
	assert_true(
		touches(&sheet, facet_at(4, 4, true), (rb_vec3){4, 4.5, 0}, (rb_vec3){4, 4.5, 1}));
	assert_true(
		touches(&sheet, facet_at(3, 4, false), (rb_vec3){4, 4.5, 0}, (rb_vec3){4, 4.5, 1}));
	/* from below as from above */
	assert_false(touches(&sheet, facet_at(4, 4, true), (rb_vec3){4, 4.5, 0},
	                     (rb_vec3){3.9, 4.5, -1}));
	/* the rim is felt: there is nothing beyond */
	assert_true(touches(&sheet, facet_at(0, 4, true), (rb_vec3){0, 4.5, 0},
	                    (rb_vec3){-0.5, 4.5, 0.5}));
	rb_terrain_destroy(sheet.terrain);
}

static void ridges_are_felt_and_valleys_are_not(void **state)
{
	static struct sheet sheet;
	(void)state;

	make(&sheet, folds);
	const rb_vec3 ridge = {4, 4.5, 4}, valley = {7, 4.5, 1};
	/* on top of the ridge it is the edge of both slopes */
	assert_true(touches(&sheet, facet_at(3, 4, false), ridge, (rb_vec3){4, 4.5, 5}));
	assert_true(touches(&sheet, facet_at(4, 4, true), ridge, (rb_vec3){4.2, 4.5, 5}));
	/* beside it, over one slope, the other one has nothing to say */
	assert_false(touches(&sheet, facet_at(4, 4, true), ridge, (rb_vec3){3, 4.5, 4.8}));
	/* from below the ridge is a valley, and the valley a ridge */
	assert_false(touches(&sheet, facet_at(3, 4, false), ridge, (rb_vec3){4.3, 4.5, 3}));
	assert_false(touches(&sheet, facet_at(6, 4, false), valley, (rb_vec3){7.1, 4.5, 2}));
	assert_true(touches(&sheet, facet_at(6, 4, false), valley, (rb_vec3){7, 4.5, 0}));
	rb_terrain_destroy(sheet.terrain);
}

static void a_straight_side_that_lies_on_a_facet_touches_within_it(void **state)
{
	static struct sheet sheet;
	const rb_vec3 axis = {0, 1, 0};
	(void)state;

	make(&sheet, flat);
	/* tilted along its axis by the tolerance of a step */
	assert_true(rb_terrain_touch_is_real(sheet.terrain, facet_at(4, 4, true),
	                                     (rb_vec3){4.2, 4.7, 0}, (rb_vec3){0, 1e-6, 1}, &axis));
	/* but over the next one the edge ahead, along which it would touch, is not real */
	assert_false(rb_terrain_touch_is_real(sheet.terrain, facet_at(4, 4, true),
	                                      (rb_vec3){4.2, 4.7, 0}, (rb_vec3){-0.1, 0, 1},
	                                      &axis));
	rb_terrain_destroy(sheet.terrain);
}

static void a_plane_goes_on_over_edges_and_corners_within_it(void **state)
{
	static struct sheet sheet;
	(void)state;

	make(&sheet, flat);
	const int above = facet_at(4, 4, true);
	assert_false(rb_terrain_goes_on(sheet.terrain, above, (rb_vec3){4.2, 4.7, 0}));
	assert_true(rb_terrain_goes_on(sheet.terrain, above, (rb_vec3){4, 4.5, 0}));
	assert_true(rb_terrain_goes_on(sheet.terrain, above, (rb_vec3){4.4, 4.4, 0}));
	assert_true(rb_terrain_goes_on(sheet.terrain, above, (rb_vec3){4, 4, 0}));
	assert_false(rb_terrain_goes_on(sheet.terrain, facet_at(0, 4, true), (rb_vec3){0, 4.5, 0}));
	assert_false(rb_terrain_goes_on(sheet.terrain, facet_at(0, 4, true), (rb_vec3){0, 4, 0}));
	rb_terrain_destroy(sheet.terrain);

	/* the ridge at x = 4, and beside it the diagonal of a slope */
	make(&sheet, folds);
	assert_false(rb_terrain_goes_on(sheet.terrain, above, (rb_vec3){4, 4.5, 4}));
	assert_false(rb_terrain_goes_on(sheet.terrain, above, (rb_vec3){4, 4, 4}));
	assert_true(rb_terrain_goes_on(sheet.terrain, above, (rb_vec3){4.5, 4.5, 3.5}));
	rb_terrain_destroy(sheet.terrain);
}

static void no_memory_is_told(void **state)
{
	static struct sheet sheet;
	const int one[1][3] = {{0, 1, 2}};
	const rb_vec3 v[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
	struct rb_error err;
	int k = 1;
	(void)state;

	for (; k < 20; k++) {
		rb_memory_fail_at((uint64_t)k);
		const enum rb_status status = rb_terrain_create(&sheet.terrain, v, 3, one, 1, &err);
		rb_memory_fail_at(0);
		if (status == RB_OK)
			break;
		assert_int_equal(status, RB_ERR_MEMORY);
		assert_null(sheet.terrain);
	}
	assert_true(k > 3 && k < 20);
	rb_terrain_destroy(sheet.terrain);
	rb_terrain_destroy(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_walk_misses_no_facet_within_its_distance),
		cmocka_unit_test(a_walk_that_is_cut_short_finds_the_nearest),
		cmocka_unit_test(edges_in_a_plane_are_not_felt),
		cmocka_unit_test(ridges_are_felt_and_valleys_are_not),
		cmocka_unit_test(a_straight_side_that_lies_on_a_facet_touches_within_it),
		cmocka_unit_test(a_plane_goes_on_over_edges_and_corners_within_it),
		cmocka_unit_test(no_memory_is_told),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
