/* SPDX-License-Identifier: MIT */
/* src/geom/manifold.h, and with it patch, overlay */
#include "shapes.h"

#include "geom/manifold.h"
#include "geom/patch_overlap.h"

static const double band = 1e-9;

/* Points of round bodies that are nearly parallel may be off sideways by the root of the band times their radii. */
static const double aside = 4e-5;

static rb_manifold touch(const shape *a, rb_vec3 at, rb_mat3 turn, const rb_placed *b)
{
	const rb_placed p = {&a->core, at, turn};
	rb_manifold m;

	rb_manifold_of(&m, &p, b, band);
	for (int i = 0; i < m.count; i++) {
		const rb_vec3 d = rb_vec3_sub(m.point[i].on_b, m.point[i].on_a);
		const rb_vec3 off = rb_vec3_add_scaled(d, -m.point[i].gap, m.normal);
		assert_near(rb_vec3_dot(off, m.normal), 0, 1e-14);
		assert_near(rb_vec3_length(off), 0, aside);
		assert_true(m.point[i].gap <= m.gap + 2 * band);
		for (int j = 0; j < i; j++)
			assert_true(m.point[i].key != m.point[j].key);
	}
	return m;
}

/* Is there a point at x, y? */
static bool has(const rb_manifold *m, double x, double y, double tol)
{
	for (int i = 0; i < m->count; i++)
		if (fabs(m->point[i].on_a.x - x) <= tol && fabs(m->point[i].on_a.y - y) <= tol)
			return true;
	return false;
}

static rb_core half_space;

static rb_placed ground(void)
{
	half_space = rb_core_of_half_space();
	return (rb_placed){&half_space, {0, 0, 0}, shapes_upright};
}

static void a_box_flat_on_a_plane_has_four_corners_mirrored_to_the_bit(void **slot)
{
	const rb_placed plane = ground();
	shape box = shapes_box(0.3, 0.7, 0.1);

	(void)slot;
	const rb_manifold m = touch(&box, (rb_vec3){0, 0, 0.1}, shapes_upright, &plane);
	assert_int_equal(m.count, 4);
	assert_near(m.gap, 0, 0);
	for (int i = 0; i < 4; i++) {
		assert_near(m.point[i].gap, 0, 0);
		assert_near(fabs(m.point[i].on_a.x), 0.3, 0);
		assert_near(fabs(m.point[i].on_a.y), 0.7, 0);
	}
	assert_true(has(&m, 0.3, 0.7, 0) && has(&m, -0.3, 0.7, 0));
	assert_true(has(&m, 0.3, -0.7, 0) && has(&m, -0.3, -0.7, 0));
	shapes_release(&box);
}

/* Bands as wide as a way in a step is: low, narrow and thin bodies keep what they lie on. */
static void a_wide_band_hides_no_lower_corner(void **slot)
{
	const rb_placed plane = ground();
	shape low = shapes_box(0.3, 0.7, 0.025), narrow = shapes_box(0.015, 0.7, 0.1);
	shape table = shapes_box(2, 2, 0.1), rod = shapes_cylinder(0.005, 0.25);
	const rb_placed top = {&table.core, {0.01, 0.02, -0.1}, shapes_upright};
	const rb_placed *const below[] = {&plane, &top};
	rb_manifold m;

	(void)slot;
	for (int k = 0; k < 2; k++) {
		for (double tilt = 0; tilt < 0.02; tilt += 0.004) {
			const rb_placed p = {&low.core,
			                     {0, 0, 0.025 + 0.7 * sin(tilt)},
			                     shapes_turned((rb_vec3){tilt, 0, 0})};
			rb_manifold_of(&m, &p, below[k], 0.1);
			int corners = 0;
			for (int i = 0; i < m.count; i++)
				corners += m.point[i].gap < 0.04;
			assert_int_equal(corners, 4);
		}
		const rb_placed p = {&narrow.core, {0, 0, 0.1}, shapes_upright};
		rb_manifold_of(&m, &p, below[k], 0.05);
		assert_int_equal(m.count, 4);
		const rb_placed lying = {&rod.core,
		                         {0, 0, 0.005},
		                         shapes_turned((rb_vec3){1.5707963267948966, 0, 0})};
		rb_manifold_of(&m, &lying, below[k], 0.02);
		assert_true(has(&m, 0, 0.25, 1e-12) && has(&m, 0, -0.25, 1e-12));
		for (int i = 0; i < m.count; i++)
			assert_near(m.point[i].gap, 0, 1e-12);
	}
	shapes_release(&low);
	shapes_release(&narrow);
	shapes_release(&table);
	shapes_release(&rod);
}

/*
 * A turned box comes with its edge towards a face, near the border of that: the edge is what
 * touches, not the border, which is within the band of it. As boxes and as hulls.
 */
static void a_wide_band_takes_no_border_beside_for_what_touches(void **slot)
{
	const double c = cos(0.58), s = sin(0.58);
	const rb_mat3 turn = {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
	shape box = shapes_box(0.5, 0.5, 0.5), wall = shapes_box(0.5, 0.5, 0.6);
	struct rb_polytope other = *wall.core.polytope;

	(void)slot;
	other.box = false;
	rb_core hull = wall.core;
	hull.polytope = &other;
	for (double off = -0.5; off <= 0.5; off += 0.03125) {
		/* the edge is at this height of the wall's face */
		const rb_placed p = {&box.core, {-1.24, off - 0.5 * (s - c), 0}, turn};

		for (int k = 0; k < 2; k++) {
			const rb_placed q = {k ? &hull : &wall.core, {0, 0, 0}, shapes_upright};
			rb_manifold m;
			int low = 0;

			rb_manifold_with_nearest(&m, &p, &q, 0.1, 1e-6, 1);
			assert_near(m.normal.x, 1, 1e-12);
			for (int i = 0; i < m.count; i++) {
				if (m.point[i].gap > m.gap + 1e-9)
					continue;
				low++;
				assert_near(m.point[i].on_a.y, off, 1e-9);
			}
			assert_int_equal(low, 2);
		}
	}
	shapes_release(&box);
	shapes_release(&wall);
}

static void a_leaning_box_has_the_edge_or_the_corner_that_touches(void **slot)
{
	const rb_placed plane = ground();
	shape box = shapes_box(0.3, 0.7, 0.1);

	(void)slot;
	rb_manifold m = touch(&box, (rb_vec3){0, 0, 0.4}, shapes_turned((rb_vec3){0, 0.5, 0}),
	                      &plane);
	assert_int_equal(m.count, 2);
	assert_near(fabs(m.point[0].on_a.y), 0.7, 1e-15);
	assert_near(m.point[0].gap, m.point[1].gap, 1e-15);
	m = touch(&box, (rb_vec3){0, 0, 0.4}, shapes_turned((rb_vec3){0.4, 0.5, 0}), &plane);
	assert_int_equal(m.count, 1);
	shapes_release(&box);
}

static void boxes_face_on_face_share_the_corners_of_their_overlap(void **slot)
{
	shape under = shapes_box(1, 1, 0.5), over = shapes_box(0.5, 0.5, 0.5);
	const rb_placed b = {&under.core, {0, 0, -0.5}, shapes_upright};

	(void)slot;
	/* inside: its own corners */
	rb_manifold m = touch(&over, (rb_vec3){0.25, 0, 0.5}, shapes_upright, &b);
	assert_int_equal(m.count, 4);
	assert_true(has(&m, 0.75, 0.5, 1e-15) && has(&m, -0.25, -0.5, 1e-15));
	/* over the edge: two of its own, two where its edges cross the other's edge */
	m = touch(&over, (rb_vec3){1, 0, 0.5}, shapes_upright, &b);
	assert_int_equal(m.count, 4);
	assert_true(has(&m, 1, 0.5, 1e-15) && has(&m, 1, -0.5, 1e-15));
	assert_true(has(&m, 0.5, 0.5, 1e-15) && has(&m, 0.5, -0.5, 1e-15));
	/* crosswise: an octagon */
	m = touch(&under, (rb_vec3){0, 0, 0.5}, shapes_turned((rb_vec3){0, 0, 0.78539816339744828}),
	          &b);
	assert_int_equal(m.count, 8);
	assert_true(has(&m, 1, sqrt(2) - 1, 1e-14));
	shapes_release(&under);
	shapes_release(&over);
}

static void equal_boxes_one_on_the_other_have_four_points_whatever_rounding_says(void **slot)
{
	shape box = shapes_box(0.1, 0.1, 0.1);

	(void)slot;
	for (uint64_t k = 0; k < 500; k++) {
		const rb_mat3 turn = shapes_turn(1, k);
		const rb_vec3 at = shapes_vector(2, k, 10);
		const rb_vec3 up = rb_mat3_apply(&turn, (rb_vec3){0, 0, 0.2});
		const rb_placed b = {&box.core, at, turn};
		const rb_manifold m = touch(&box, rb_vec3_add(at, up), turn, &b);
		assert_int_equal(m.count, 4);
		assert_near(m.gap, 0, 1e-14);
	}
	shapes_release(&box);
}

static void edges_that_cross_touch_in_one_point_and_parallel_ones_in_two(void **slot)
{
	shape box = shapes_box(1, 1, 1);
	const double s = sqrt(2);
	const rb_placed b = {
		&box.core, {0, 0, -s}, shapes_turned((rb_vec3){0.78539816339744828, 0, 0})};

	(void)slot;
	/* the lower one's edge is along x, the upper one's along y */
	rb_manifold m = touch(&box, (rb_vec3){0.2, 0.1, s},
	                      shapes_turned((rb_vec3){0, 0.78539816339744828, 0}), &b);
	assert_int_equal(m.count, 1);
	assert_near(m.gap, 0, 4e-15);
	assert_true(has(&m, 0.2, 0, 1e-14));
	assert_int_equal(m.point[0].key >> 56, RB_PART_EDGE);
	m = touch(&box, (rb_vec3){0.5, 0, s}, shapes_turned((rb_vec3){0.78539816339744828, 0, 0}),
	          &b);
	assert_int_equal(m.count, 2);
	assert_true(has(&m, 1, 0, 1e-14) && has(&m, -0.5, 0, 1e-14));
	shapes_release(&box);
}

/* From x = low to x = high at a height, its ends and the whole by names of their own. */
static rb_patch line_of(double low, double high, double z, int name)
{
	rb_patch patch = {.kind = RB_PATCH_SEGMENT,
	                  .count = 2,
	                  .feature = rb_part_of(RB_PART_EDGE, name),
	                  .normal = {0, 0, z > 0 ? -1 : 1}};

	patch.point[0] = (rb_vec3){low, 0, z}, patch.point[1] = (rb_vec3){high, 0, z};
	patch.id[0] = rb_part_of(RB_PART_VERTEX, name + 1);
	patch.id[1] = rb_part_of(RB_PART_VERTEX, name + 2);
	patch.side[0] = patch.side[1] = patch.feature;
	return patch;
}

/* Where one ends over the other, the point is the end of the one and anywhere on the other. */
static void lines_that_overlap_are_named_by_their_ends(void **slot)
{
	static const double rows[][4] = {
		{0, 2, 1, 3}, {1, 3, 0, 2}, {0, 3, 1, 2}, {1, 2, 0, 3}, {0, 2, 0, 2}};
	const rb_overlay_def def = {.n = {0, 0, 1}, .aside = 1e-9, .along = 1e-9};

	(void)slot;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		const rb_patch a = line_of(rows[i][0], rows[i][1], 0, 10);
		const rb_patch b = line_of(rows[i][2], rows[i][3], 0.5, 20);
		rb_overlay_point points[RB_OVERLAY_MAX];

		assert_int_equal(rb_overlay(&a, &b, &def, points), 2);
		for (int k = 0; k < 2; k++) {
			const double x = points[k].on_a.x;
			assert_near(points[k].on_b.x, x, 1e-12);
			assert_near(points[k].gap, 0.5, 1e-12);
			const rb_part of_a = x == rows[i][0]   ? a.id[0]
			                     : x == rows[i][1] ? a.id[1]
			                                       : a.feature;
			const rb_part of_b = x == rows[i][2]   ? b.id[0]
			                     : x == rows[i][3] ? b.id[1]
			                                       : b.feature;
			assert_int_equal(points[k].a, of_a);
			assert_int_equal(points[k].b, of_b);
		}
		assert_near(fabs(points[0].on_a.x - points[1].on_a.x),
		            fmin(rows[i][1], rows[i][3]) - fmax(rows[i][0], rows[i][2]), 1e-12);
	}
}

static void a_corner_on_a_corner_touches_in_one_point(void **slot)
{
	shape box = shapes_box(1, 1, 1);
	const rb_vec3 diagonal = {1, 1, 1}, up = {0, 0, 1};
	const rb_vec3 turn = rb_vec3_scale(acos(1 / sqrt(3)),
	                                   rb_vec3_unit(rb_vec3_cross(diagonal, up), up));
	const rb_placed b = {&box.core, {0, 0, -sqrt(3)}, shapes_turned(turn)};
	const rb_placed a = {&box.core, {0, 0, sqrt(3) + 1e-6}, shapes_turned(turn)};

	(void)slot;
	const rb_convex_touch t = rb_convex_gap(&a, &b);
	assert_near(t.gap, 1e-6, 4e-15);
	assert_near(t.normal.z, -1, 1e-15);
	assert_int_equal(t.a >> 24, RB_PART_VERTEX);
	assert_int_equal(t.b >> 24, RB_PART_VERTEX);
	const rb_manifold m = touch(&box, a.at, a.turn, &b);
	assert_int_equal(m.count, 1);
	shapes_release(&box);
}

static void a_cylinder_stands_on_four_points_that_do_not_turn_with_it(void **slot)
{
	const rb_placed plane = ground();
	const shape drum = shapes_cylinder(0.5, 0.25);
	const rb_manifold m = touch(&drum, (rb_vec3){1, 2, 0.25}, shapes_upright, &plane);

	(void)slot;
	assert_int_equal(m.count, 4);
	assert_true(has(&m, 1.5, 2, 0) && has(&m, 0.5, 2, 0));
	assert_true(has(&m, 1, 2.5, 0) && has(&m, 1, 1.5, 0));
	for (int k = 1; k < 20; k++) {
		const rb_manifold turned = touch(&drum, (rb_vec3){1, 2, 0.25},
		                                 shapes_turned((rb_vec3){0, 0, 0.3 * k}), &plane);
		assert_int_equal(turned.count, 4);
		for (int i = 0; i < 4; i++) {
			assert_true(turned.point[i].key == m.point[i].key);
			assert_near(turned.point[i].on_a.x, m.point[i].on_a.x, 1e-15);
			assert_near(turned.point[i].on_a.y, m.point[i].on_a.y, 1e-15);
		}
	}
}

static void a_cylinder_lies_on_a_line_and_leans_on_its_rim(void **slot)
{
	const rb_placed plane = ground();
	const shape drum = shapes_cylinder(0.5, 0.25);

	(void)slot;
	rb_manifold m = touch(&drum, (rb_vec3){0, 0, 0.5},
	                      shapes_turned((rb_vec3){0, 1.5707963267948966, 0}), &plane);
	assert_int_equal(m.count, 2);
	assert_true(has(&m, 0.25, 0, 1e-15) && has(&m, -0.25, 0, 1e-15));
	m = touch(&drum, (rb_vec3){0, 0, 0.5}, shapes_turned((rb_vec3){0, 0.7, 0}), &plane);
	assert_int_equal(m.count, 1);
	assert_near(m.gap, 0.5 - 0.5 * sin(0.7) - 0.25 * cos(0.7), 1e-15);
}

static void a_cylinder_over_the_edge_of_a_box_keeps_what_of_its_disc_is_over_it(void **slot)
{
	shape box = shapes_box(1, 1, 1);
	const shape drum = shapes_cylinder(0.5, 0.25);
	const rb_placed b = {&box.core, {0, 0, -1}, shapes_upright};

	(void)slot;
	const rb_manifold m = touch(&drum, (rb_vec3){1, 0, 0.25}, shapes_upright, &b);
	/* two quarters on the edge, one within: (1, -0.5), (1, 0.5), (0.5, 0) */
	assert_int_equal(m.count, 3);
	assert_true(has(&m, 1, 0.5, 1e-15) && has(&m, 1, -0.5, 1e-15) && has(&m, 0.5, 0, 1e-15));
	const rb_manifold out = touch(&drum, (rb_vec3){1.3, 0, 0.25}, shapes_upright, &b);
	assert_int_equal(out.count, 3);
	assert_true(has(&out, 1, 0.4, 1e-15) && has(&out, 1, -0.4, 1e-15) &&
	            has(&out, 0.8, 0, 1e-15));
	shapes_release(&box);
}

static void stacked_cylinders_share_their_discs(void **slot)
{
	const shape wide = shapes_cylinder(1, 0.25), thin = shapes_cylinder(0.5, 0.25);
	const rb_placed b = {&wide.core, {0, 0, -0.25}, shapes_upright};

	(void)slot;
	assert_int_equal(touch(&thin, (rb_vec3){0, 0, 0.25}, shapes_upright, &b).count, 4);
	assert_int_equal(touch(&wide, (rb_vec3){0, 0, 0.25}, shapes_upright, &b).count, 4);
	/* two quarters of each and two crossings; the quarters along the shift lie within the other */
	const rb_manifold m = touch(&wide, (rb_vec3){1, 0, 0.25}, shapes_upright, &b);
	assert_true(m.count >= 4);
	assert_true(has(&m, 0.5, sqrt(0.75), 1e-14) && has(&m, 0.5, -sqrt(0.75), 1e-14));
	assert_true(has(&m, 0, 0, 1e-14) && has(&m, 1, 0, 1e-14));
}

static void parallel_rounds_touch_along_a_line(void **slot)
{
	shape capsule = shapes_capsule(1, 0.25);
	const shape drum = shapes_cylinder(0.25, 1);
	const shape *const both[2] = {&capsule, &drum};

	(void)slot;
	for (int i = 0; i < 4; i++) {
		const rb_placed b = {&both[i % 2]->core, {0, 0, 0}, shapes_upright};
		const rb_manifold m = touch(both[i / 2], (rb_vec3){0.5, 0, 0.5}, shapes_upright,
		                            &b);
		assert_int_equal(m.count, 2);
		assert_near(m.gap, 0, 1e-16);
		assert_near(fmin(m.point[0].on_a.z, m.point[1].on_a.z), -0.5, 1e-15);
		assert_near(fmax(m.point[0].on_a.z, m.point[1].on_a.z), 1, 1e-15);
		/* turned by less than the band shows, still two; by more, one */
		const rb_manifold turned = touch(both[i / 2], (rb_vec3){0.5, 0, 0},
		                                 shapes_turned((rb_vec3){1e-6, 0, 0}), &b);
		assert_int_equal(turned.count, 2);
		const rb_manifold crossed = touch(both[i / 2], (rb_vec3){0.5, 0, 0},
		                                  shapes_turned((rb_vec3){0.01, 0, 0}), &b);
		assert_int_equal(crossed.count, 1);
	}
	shapes_release(&capsule);
}

static void a_capsule_lies_on_two_points_and_a_sphere_on_one(void **slot)
{
	shape box = shapes_box(1, 1, 1), capsule = shapes_capsule(0.5, 0.25);
	shape sphere = shapes_capsule(0, 0.25);
	const rb_placed plane = ground(), b = {&box.core, {0, 0, -1}, shapes_upright};
	const rb_mat3 lying = shapes_turned((rb_vec3){0, 1.5707963267948966, 0});

	(void)slot;
	assert_int_equal(touch(&capsule, (rb_vec3){0, 0, 0.25}, lying, &plane).count, 2);
	assert_int_equal(touch(&sphere, (rb_vec3){0, 0, 0.25}, lying, &plane).count, 1);
	assert_int_equal(touch(&sphere, (rb_vec3){0, 0, 0.25}, lying, &b).count, 1);
	const rb_manifold m = touch(&capsule, (rb_vec3){0.8, 0, 0.25}, lying, &b);
	assert_int_equal(m.count, 2);
	assert_true(has(&m, 1, 0, 1e-15) && has(&m, 0.3, 0, 1e-15));
	shapes_release(&box);
	shapes_release(&capsule);
	shapes_release(&sphere);
}

/* Motions a thousand times smaller than the band change neither keys nor order, and points by no more than they are. */
static void keys_and_points_stay_under_tiny_motions(void **slot)
{
	shape shapes[5] = {shapes_box(0.5, 0.5, 0.5), shapes_box(0.5, 0.5, 0.5),
	                   shapes_capsule(0.4, 0.1), shapes_cylinder(0.4, 0.5),
	                   shapes_rectangle(0.4, 0.3)};
	const rb_vec3 at[5] = {{0, 0, 1}, {0.3, 0.2, 1}, {0, 0.1, 0.6}, {0.1, 0, 1}, {0.1, 0, 0.5}};
	const rb_vec3 lie[5] = {
		{0, 0, 0}, {0, 0, 0.3}, {1.5707963267948966, 0, 0}, {0, 0, 0}, {0, 0, 0}};
	const rb_placed b = {&shapes[0].core, {0, 0, 0}, shapes_upright};

	(void)slot;
	for (int i = 0; i < 5; i++) {
		const rb_manifold still = touch(&shapes[i], at[i], shapes_turned(lie[i]), &b);
		assert_true(still.count >= 2);
		for (uint64_t k = 0; k < 200; k++) {
			const rb_vec3 shift = shapes_vector(5, k, 1e-12);
			const rb_mat3 first = shapes_turned(lie[i]);
			const rb_mat3 little = shapes_turned(shapes_vector(6, k, 1e-12));
			const rb_manifold m = touch(&shapes[i], rb_vec3_add(at[i], shift),
			                            rb_mat3_multiply(&little, &first), &b);
			assert_int_equal(m.count, still.count);
			for (int j = 0; j < m.count; j++) {
				const rb_vec3 d = rb_vec3_sub(m.point[j].on_a, still.point[j].on_a);
				assert_true(m.point[j].key == still.point[j].key);
				assert_near(rb_vec3_length(d), 0, 1e-11);
			}
		}
	}
	for (int i = 0; i < 5; i++)
		shapes_release(&shapes[i]);
}

/* A prism of 40 sides on its end: more corners than a manifold holds. */
static void of_many_corners_those_farthest_out_stay(void **slot)
{
	enum { SIDES = 40 };
	rb_vec3 points[2 * SIDES];
	int counts[SIDES + 2], loop[6 * SIDES], at = 0;
	struct rb_error err = {0};
	const rb_placed plane = ground();
	shape s;

	(void)slot;
	for (int i = 0; i < SIDES; i++) {
		const double angle = 2 * 3.141592653589793 * i / SIDES;
		points[i] = (rb_vec3){cos(angle), sin(angle), -1};
		points[SIDES + i] = (rb_vec3){cos(angle), sin(angle), 1};
	}
	for (int i = 0; i < SIDES; i++) {
		const int j = (i + 1) % SIDES;
		const int side[4] = {i, j, SIDES + j, SIDES + i};
		memcpy(loop + at, side, sizeof side);
		counts[i] = 4;
		at += 4;
	}
	for (int i = 0; i < SIDES; i++)
		loop[at++] = SIDES - 1 - i;
	for (int i = 0; i < SIDES; i++)
		loop[at++] = SIDES + i;
	counts[SIDES] = counts[SIDES + 1] = SIDES;
	const rb_polytope_def def = {2 * SIDES, SIDES + 2, points, counts, loop};
	assert_ok(rb_polytope_create(&s.polytope, &def, &err));
	s.core = rb_core_of_polytope(s.polytope, 0);
	const rb_manifold m = touch(&s, (rb_vec3){0, 0, 1}, shapes_upright, &plane);
	assert_true(m.count >= 12 && m.count <= RB_MANIFOLD_MAX);
	assert_true(has(&m, 1, 0, 1e-15) && has(&m, -1, 0, 1e-15) && has(&m, 0, 1, 1e-15));
	shapes_release(&s);
}

static double lowest_of(const rb_manifold *m)
{
	double least = HUGE_VAL;

	for (int i = 0; i < m->count; i++)
		least = fmin(least, m->point[i].gap);
	return least;
}

static void a_disc_that_tilts_within_a_wide_band_has_its_lowest_point_too(void **slot)
{
	const rb_placed plane = ground();
	const double wide = 0.05;
	shape drum = shapes_cylinder(0.5, 0.2), block = shapes_box(1, 1, 0.1);
	rb_manifold m;

	(void)slot;
	/* a disc that tilts half way between two of its quarters */
	const rb_mat3 lean = shapes_turned((rb_vec3){0.03, 0.03, 0});
	const rb_placed disc = {&drum.core, {0, 0, 0.25}, lean};
	const rb_placed below[2] = {plane, {&block.core, {0.2, 0.1, -0.1}, shapes_upright}};
	for (int k = 0; k < 2; k++) {
		rb_manifold_with_nearest(&m, &disc, &below[k], wide, 1e-9, (double)INFINITY);
		assert_near(lowest_of(&m), m.gap, 1e-9);
		const int count = m.count;
		rb_manifold_of(&m, &disc, &below[k], wide);
		assert_true(lowest_of(&m) > m.gap + 1e-4);
		assert_true(m.count < count);
	}
	shapes_release(&block);
}

/* One whose border it crosses: the band is as wide as it is, and a corner of the box lies beside it by less. */
static void a_capsule_has_no_points_beside_its_line_within_a_wide_band(void **slot)
{
	shape box = shapes_box(0.5, 0.5, 0.5), capsule = shapes_capsule(0.15, 0.1);
	const rb_placed below = {&box.core, {0, 0, -0.5}, shapes_upright};
	const double c = cos(0.3), s = sin(0.3), fine = 1e-6;
	/* its axis along (-s, c, 0) */
	const rb_mat3 lying = {{{c, 0, -s}, {s, 0, c}, {0, -1, 0}}};
	const rb_placed p = {&capsule.core, {0.4, 0.45, 0.1}, lying};
	rb_manifold m;

	(void)slot;
	rb_manifold_with_nearest(&m, &p, &below, 0.12, fine, (double)INFINITY);
	assert_int_equal(m.count, 2);
	for (int k = 0; k < m.count; k++) {
		const rb_vec3 d = rb_vec3_sub(m.point[k].on_a, p.at);
		/* so far aside a circle of this radius is higher by `fine` */
		assert_near(d.x * c + d.y * s, 0, sqrt(2 * 0.1 * fine));
	}
	shapes_release(&box);
	shapes_release(&capsule);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_box_flat_on_a_plane_has_four_corners_mirrored_to_the_bit),
		cmocka_unit_test(a_wide_band_hides_no_lower_corner),
		cmocka_unit_test(a_wide_band_takes_no_border_beside_for_what_touches),
		cmocka_unit_test(a_leaning_box_has_the_edge_or_the_corner_that_touches),
		cmocka_unit_test(boxes_face_on_face_share_the_corners_of_their_overlap),
		cmocka_unit_test(
			equal_boxes_one_on_the_other_have_four_points_whatever_rounding_says),
		cmocka_unit_test(edges_that_cross_touch_in_one_point_and_parallel_ones_in_two),
		cmocka_unit_test(lines_that_overlap_are_named_by_their_ends),
		cmocka_unit_test(a_corner_on_a_corner_touches_in_one_point),
		cmocka_unit_test(a_cylinder_stands_on_four_points_that_do_not_turn_with_it),
		cmocka_unit_test(a_cylinder_lies_on_a_line_and_leans_on_its_rim),
		cmocka_unit_test(
			a_cylinder_over_the_edge_of_a_box_keeps_what_of_its_disc_is_over_it),
		cmocka_unit_test(stacked_cylinders_share_their_discs),
		cmocka_unit_test(parallel_rounds_touch_along_a_line),
		cmocka_unit_test(a_capsule_lies_on_two_points_and_a_sphere_on_one),
		cmocka_unit_test(keys_and_points_stay_under_tiny_motions),
		cmocka_unit_test(of_many_corners_those_farthest_out_stay),
		cmocka_unit_test(a_disc_that_tilts_within_a_wide_band_has_its_lowest_point_too),
		cmocka_unit_test(a_capsule_has_no_points_beside_its_line_within_a_wide_band),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
