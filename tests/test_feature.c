/* SPDX-License-Identifier: MIT */
/* src/located/feature.c */
#include "shapes.h"

#include "located/feature.h"

typedef struct rb_feature_side side;

static side still(const shape *s, rb_vec3 at, rb_mat3 turn)
{
	return (side){.core = &s->core, .at = at, .turn = turn};
}

/* Where a side is a little later. */
static side later(const side *s, double h)
{
	const rb_mat3 turn = shapes_turned(rb_vec3_scale(h, s->spin));
	side out = *s;

	out.at = rb_vec3_add_scaled(s->at, h, s->velocity);
	out.turn = rb_mat3_multiply(&turn, &s->turn);
	return out;
}

/* Brings b to where the gap is zero. */
static void bring_together(side *a, side *b)
{
	const rb_placed pa = rb_feature_placed(a);

	for (int k = 0; k < 4; k++) {
		const rb_placed pb = rb_feature_placed(b);
		const rb_convex_touch touch = rb_convex_gap(&pa, &pb);
		b->at = rb_vec3_add_scaled(b->at, -touch.gap, touch.normal);
	}
}

static double apart(rb_vec3 a, rb_vec3 b)
{
	return rb_vec3_length(rb_vec3_sub(a, b));
}

static bool meet(struct rb_feature_point *out, const side *a, const side *b, uint64_t key,
                 rb_vec3 near)
{
	return rb_feature_contact(out, a, b, key) || rb_feature_curves(out, a, b, key, near);
}

static void assert_rates(const side *a, const side *b, uint64_t key, rb_vec3 near)
{
	const double h = 1e-5;
	const side a0 = later(a, -h), a1 = later(a, h), b0 = later(b, -h), b1 = later(b, h);
	struct rb_feature_point p, p0, p1;

	assert_true(meet(&p, a, b, key, near));
	assert_true(meet(&p0, &a0, &b0, key, near));
	assert_true(meet(&p1, &a1, &b1, key, near));
	const rb_vec3 n = rb_vec3_scale(0.5 / h, rb_vec3_sub(p1.normal, p0.normal));
	const rb_vec3 x = rb_vec3_scale(0.5 / h, rb_vec3_sub(p1.point, p0.point));
	const double scale = 1 + rb_vec3_length(p.point_rate) + rb_vec3_length(p.normal_rate);
	assert_true(apart(n, p.normal_rate) <= 1e-5 * scale * scale * scale);
	assert_true(apart(x, p.point_rate) <= 1e-5 * scale * scale * scale);
	/* not where another end has become the nearest */
	if (isfinite(p.inside) && fabs(p1.inside - 2 * p.inside + p0.inside) < 1e-8 * scale)
		assert_true(fabs((p1.inside - p0.inside) / (2 * h) - p.inside_rate) <=
		            1e-3 * scale * scale * scale);
}

/* Each point that a manifold finds is where its features say. Returns how many have a closed form. */
static int assert_like_manifold(const side *a, const side *b)
{
	const rb_placed pa = rb_feature_placed(a), pb = rb_feature_placed(b);
	const double band = 1e-12;
	rb_manifold manifold;
	int known = 0;

	rb_manifold_of(&manifold, &pa, &pb, band);
	for (int k = 0; k < manifold.count; k++) {
		const rb_manifold_point *m = &manifold.point[k];
		const uint64_t key = rb_feature_name(a, b, &manifold, k, band);
		struct rb_feature_point p;

		if (!meet(&p, a, b, key, m->on_a))
			continue;
		known++;
		assert_near(p.gap, m->gap, 1e-12);
		assert_true(apart(p.normal, manifold.normal) <= 1e-8);
		assert_true(apart(p.point, m->on_a) <= 1e-8);
		assert_true(apart(p.point, m->on_b) <= 1e-8);
		assert_true(p.inside >= -1e-8);
		assert_rates(a, b, key, m->on_a);
	}
	return known;
}

static side move(side s, uint64_t stream, uint64_t index)
{
	s.velocity = shapes_vector(stream, index, 1);
	s.spin = shapes_vector(stream + 1, index, 1);
	return s;
}

static void points_of_bodies_in_any_place_are_where_their_features_say(void **slot)
{
	enum { KINDS = 6, PAIRS = 60 };
	shape kind[KINDS] = {shapes_box(0.5, 0.7, 1),   shapes_capsule(0.8, 0.3),
	                     shapes_capsule(0, 0.5),    shapes_cylinder(0.6, 0.5),
	                     shapes_random_hull(3, 14), shapes_rectangle(1.5, 1)};
	int known = 0, all = 0;

	(void)slot;
	for (int i = 0; i < KINDS; i++)
		for (int j = 0; j < KINDS; j++)
			for (uint64_t k = 0; k < PAIRS; k++) {
				const uint64_t index = k + PAIRS * (uint64_t)(i * KINDS + j);
				side a = still(&kind[i], shapes_vector(1, index, 1),
				               shapes_turn(2, index));
				side b = still(&kind[j], shapes_vector(3, index, 4),
				               shapes_turn(4, index));
				bring_together(&a, &b);
				a = move(a, 5, index);
				b = move(b, 7, index);
				known += assert_like_manifold(&a, &b) > 0;
				all++;
			}
	assert_true(known > 0.99 * all);
	for (int i = 0; i < KINDS; i++)
		rb_polytope_destroy(kind[i].polytope);
}

/*
 * A rim that crosses a mantle twice, in places near each other: rounding makes more of them then than of the numbers they are
 * made of.
 */
static void a_rim_that_crosses_a_mantle_at_a_small_angle_has_a_point(void **slot)
{
	enum { FIRST_CROSSING = 5, SECOND_CROSSING = 6 };
	shape log = shapes_cylinder(0.03, 0.06), disc = shapes_cylinder(0.04, 0.05);

	(void)slot;
	for (uint64_t k = 0; k < 400; k++) {
		const double off = ldexp(0.1, -(int)(k % 20)), tilt = 0.2 + 0.002 * (double)k;
		const double along = disc.core.round * (1 - off), up = log.core.round;
		const rb_mat3 turn = shapes_turn(1, k);
		/* its axis is x, that of the disc is tilted in the plane across */
		const rb_mat3 lie = shapes_turned((rb_vec3){0, asin(1), 0});
		const rb_mat3 lean = shapes_turned((rb_vec3){tilt, 0, 0});
		const double high = up + disc.core.half_height;
		const double half = disc.core.round * sqrt(off * (2 - off));
		const rb_vec3 centre = {0.01, along * cos(tilt) - high * sin(tilt),
		                        along * sin(tilt) + high * cos(tilt)};
		const side a = still(&log, (rb_vec3){0, 0, 0}, rb_mat3_multiply(&turn, &lie));
		const side b = still(&disc, rb_mat3_apply(&turn, centre),
		                     rb_mat3_multiply(&turn, &lean));

		for (int which = FIRST_CROSSING; which <= SECOND_CROSSING; which++) {
			const uint64_t rim = rb_part_of(RB_PART_RIM, which << 1 | 1);
			const uint64_t key = (uint64_t)rb_part_of(RB_PART_MANTLE, 0) << 32 | rim;
			struct rb_feature_point p;

			assert_true(rb_feature_curves(&p, &a, &b, key, b.at));
			const rb_vec3 place = rb_mat3_apply_transposed(&turn, p.point);
			const double from_middle = place.x - 0.01;

			assert_true(fabs(fabs(from_middle) / half - 1) < 1e-3);
			assert_true((from_middle < 0) == (which == FIRST_CROSSING));
			assert_near(p.gap, 0, 1e-15);
		}
	}
}

/* Where a cylinder and a box of such sizes touch, over the scale; how many points. */
static int meet_at_scale(double scale, uint64_t index, struct rb_feature_point out[RB_MANIFOLD_MAX])
{
	shape tin = shapes_cylinder(0.6 * scale, 0.5 * scale);
	shape brick = shapes_box(0.5 * scale, 0.7 * scale, scale);
	side a = still(&tin, shapes_vector(1, index, scale), shapes_turn(2, index));
	side b = still(&brick, shapes_vector(3, index, 4 * scale), shapes_turn(4, index));
	rb_manifold manifold;
	int count = 0;

	bring_together(&a, &b);
	const rb_placed pa = rb_feature_placed(&a), pb = rb_feature_placed(&b);
	rb_manifold_of(&manifold, &pa, &pb, 1e-12 * scale);
	for (int k = 0; k < manifold.count; k++) {
		const uint64_t key = rb_feature_name(&a, &b, &manifold, k, 1e-12 * scale);
		struct rb_feature_point *const p = &out[count];

		if (!meet(p, &a, &b, key, manifold.point[k].on_a))
			continue;
		p->point = rb_vec3_scale(1 / scale, p->point);
		p->gap /= scale;
		count++;
	}
	rb_polytope_destroy(brick.polytope);
	return count;
}

/* Powers of two change no digit of what follows from lengths alone. */
static void rims_and_edges_meet_alike_at_every_size(void **slot)
{
	struct rb_feature_point p[RB_MANIFOLD_MAX], q[RB_MANIFOLD_MAX];

	(void)slot;
	for (uint64_t index = 0; index < 300; index++)
		for (int k = -24; k <= 24; k += 16) {
			const int count = meet_at_scale(1, index, p);

			assert_int_equal(meet_at_scale(ldexp(1, k), index, q), count);
			for (int i = 0; i < count; i++) {
				assert_true(apart(p[i].point, q[i].point) == 0);
				assert_true(apart(p[i].normal, q[i].normal) == 0);
			}
		}
}

/* Upright on a face, turned about its normal. */
static void bodies_on_faces_touch_at_all_their_points(void **slot)
{
	const rb_mat3 lying = shapes_turned((rb_vec3){acos(0.0), 0, 0});
	shape plate = shapes_box(2, 1.5, 0.5), ground = {NULL, rb_core_of_half_space()};
	shape brick = shapes_box(0.5, 0.7, 0.25), rod = shapes_capsule(0.8, 0.25);
	shape tin = shapes_cylinder(0.6, 0.25), drum = shapes_cylinder(0.25, 0.6);
	const struct {
		shape *what;
		bool lies;
		double z;
		int points;
	} row[] = {{&brick, false, 0.25, 4},
	           {&rod, true, 0.25, 2},
	           {&tin, false, 0.25, 4},
	           {&drum, true, 0.25, 2}};

	(void)slot;
	for (size_t k = 0; k < sizeof row / sizeof row[0]; k++)
		for (int place = 0; place < 4; place++) {
			const rb_mat3 yaw = shapes_turned((rb_vec3){0, 0, 0.3 + place});
			const rb_mat3 turn = row[k].lies ? rb_mat3_multiply(&yaw, &lying) : yaw;
			/* in the middle, and over a side */
			const rb_vec3 at = {place < 2 ? 0.1 : 1.9, 0.2, row[k].z};
			side a = move(still(row[k].what, at, turn), 11, k);
			side low = move(still(&plate, (rb_vec3){0, 0, -0.5}, shapes_upright), 13,
			                k);
			side flat = move(still(&ground, (rb_vec3){0, 0, 0}, shapes_upright), 15, k);
			const int on_ground = assert_like_manifold(&a, &flat);
			assert_int_equal(on_ground, row[k].points);
			assert_int_equal(assert_like_manifold(&flat, &a), row[k].points);
			const int on_plate = assert_like_manifold(&a, &low);
			if (place < 2)
				assert_int_equal(on_plate, row[k].points);
			else
				assert_true(on_plate >= 1);
			assert_int_equal(assert_like_manifold(&low, &a), on_plate);
		}
	rb_polytope_destroy(plate.polytope);
	rb_polytope_destroy(brick.polytope);
	rb_polytope_destroy(rod.polytope);
}

static void crossing_of_nearly_parallel_edges_keeps_the_normal_of_the_face(void **slot)
{
	shape low = shapes_box(1, 1, 0.5), high = shapes_box(1, 1, 0.5);
	side a = still(&low, (rb_vec3){0, 0, -0.5}, shapes_upright);
	side b = still(&high, (rb_vec3){0, 0, 0.5}, shapes_turned((rb_vec3){0, 0, 1e-7}));
	const rb_placed pa = rb_feature_placed(&a), pb = rb_feature_placed(&b);
	rb_manifold manifold;
	int crossings = 0;

	(void)slot;
	rb_manifold_of(&manifold, &pa, &pb, 1e-15);
	for (int k = 0; k < manifold.count; k++) {
		const uint64_t key = rb_feature_name(&a, &b, &manifold, k, 1e-15);
		struct rb_feature_point p;

		crossings += key != manifold.point[k].key;
		assert_true(rb_feature_contact(&p, &a, &b, key));
		assert_true(p.normal.z == 1 && p.normal.x == 0 && p.normal.y == 0);
	}
	assert_true(crossings >= 4);
	rb_polytope_destroy(low.polytope);
	rb_polytope_destroy(high.polytope);
}

static void a_corner_that_passes_the_side_of_a_face_is_outside(void **slot)
{
	shape low = shapes_box(1, 1, 0.5), high = shapes_box(0.25, 0.25, 0.25);
	struct rb_feature_point p;

	(void)slot;
	for (int k = 0; k < 2; k++) {
		side a = still(&low, (rb_vec3){0, 0, -0.5}, shapes_upright);
		side b = still(&high, (rb_vec3){k ? 0.875 : 0.625, 0, 0.25}, shapes_upright);
		b.velocity = (rb_vec3){3, 0, 0};
		/* box faces: the one along +z of `low`, the corner (+, +, -) of `high` */
		int up = -1;
		for (int f = 0; f < low.polytope->face_count; f++)
			if (low.polytope->faces[f].normal.z > 0.5)
				up = f;
		const uint64_t key = (uint64_t)rb_part_of(RB_PART_FACE, up) << 32 |
		                     rb_part_of(RB_PART_VERTEX, 4);
		assert_true(rb_feature_contact(&p, &a, &b, key));
		assert_near(p.inside, k ? -0.125 : 0.125, 1e-15);
		assert_near(p.inside_rate, -3, 1e-15);
	}
	rb_polytope_destroy(low.polytope);
	rb_polytope_destroy(high.polytope);
}

/*
 * A ball about a box, near its border or not: from whichever feature of it one begins, those that take over lead to the one
 * that is nearest.
 */
static void what_takes_over_leads_to_the_feature_that_is_nearest(void **slot)
{
	shape box = shapes_box(0.5, 0.7, 1), ball = shapes_capsule(0, 0.5);
	side a = still(&ball, (rb_vec3){0, 0, 0}, shapes_turn(31, 0));

	(void)slot;
	for (uint64_t index = 0; index < 400; index++) {
		side b = still(&box, shapes_vector(32, index, 3), shapes_turn(33, index));
		bring_together(&a, &b);
		const rb_placed pa = rb_feature_placed(&a), pb = rb_feature_placed(&b);
		const rb_convex_touch touch = rb_convex_gap(&pa, &pb);

		for (int face = 0; face < 6; face++) {
			uint64_t key = (uint64_t)rb_part_of(RB_PART_VERTEX, 0) << 32 |
			               rb_part_of(RB_PART_FACE, face);
			struct rb_feature_point p;
			int steps = 0;

			assert_true(rb_feature_contact(&p, &a, &b, key));
			for (; p.inside < 0 && steps < 12; steps++) {
				key = rb_feature_beyond(&a, &b, key, &p);
				assert_true(key != 0);
				assert_true(rb_feature_contact(&p, &a, &b, key));
			}
			/* the far side of a body is no neighbour of what is nearest */
			if (rb_vec3_dot(p.normal, touch.normal) < 0.5)
				continue;
			assert_true(p.inside >= 0);
			assert_near(p.gap, touch.gap, 1e-14);
			assert_true(apart(p.normal, touch.normal) <= 1e-14);
		}
	}
	rb_polytope_destroy(box.polytope);
	rb_polytope_destroy(ball.polytope);
}

/*
 * The lowest point of a rim over a plane, however little it is tilted: r sin(tilt) below the middle of its end, which comes
 * down by r w where it turns by w about a line across both axes.
 */
static void the_lowest_point_of_a_rim_is_exact_at_every_tilt(void **slot)
{
	const double r = 0.6, half = 0.25, w = 3;
	shape tin = shapes_cylinder(r, half), ground = {NULL, rb_core_of_half_space()};
	const uint64_t key = (uint64_t)rb_part_of(RB_PART_RIM, 1) << 32 |
	                     rb_part_of(RB_PART_SURFACE, 0);

	(void)slot;
	for (int k = 0; k < 60; k++) {
		const double tilt = 1e-7 * pow(10, 0.1 * k);
		const rb_vec3 way = {cos(0.7 * k), sin(0.7 * k), 0};
		const rb_vec3 yaw = {0, 0, 1.3 * k};
		const rb_mat3 lean = shapes_turned(rb_vec3_scale(tilt, way));
		const rb_mat3 spun = shapes_turned(yaw);
		side a = still(&tin, (rb_vec3){0, 0, 1}, rb_mat3_multiply(&lean, &spun));
		const side b = still(&ground, (rb_vec3){0, 0, 0},
		                     shapes_turned((rb_vec3){0, 0, 0}));
		struct rb_feature_point p;

		a.spin = rb_vec3_scale(w, way);
		assert_true(rb_feature_contact(&p, &a, &b, key));
		assert_near(p.gap, 1 - half * cos(tilt) - r * sin(tilt), 2e-15);
		assert_near(p.point_rate.z, w * (half * sin(tilt) - r * cos(tilt)), 1e-14);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(points_of_bodies_in_any_place_are_where_their_features_say),
		cmocka_unit_test(a_rim_that_crosses_a_mantle_at_a_small_angle_has_a_point),
		cmocka_unit_test(bodies_on_faces_touch_at_all_their_points),
		cmocka_unit_test(rims_and_edges_meet_alike_at_every_size),
		cmocka_unit_test(the_lowest_point_of_a_rim_is_exact_at_every_tilt),
		cmocka_unit_test(crossing_of_nearly_parallel_edges_keeps_the_normal_of_the_face),
		cmocka_unit_test(a_corner_that_passes_the_side_of_a_face_is_outside),
		cmocka_unit_test(what_takes_over_leads_to_the_feature_that_is_nearest),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
