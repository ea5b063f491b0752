/* SPDX-License-Identifier: MIT */
/* src/geom/convex.h, and with it polytope, core, gjk, facets, rims, separation */
#include "shapes.h"

#include "base/memory.h"

enum { KINDS = 8 };

static shape kinds[KINDS];

static int make_kinds(void **slot)
{
	(void)slot;
	kinds[0] = shapes_box(0.5, 0.3, 0.8);
	kinds[1] = shapes_capsule(0, 0.4);
	kinds[2] = shapes_capsule(0.7, 0.2);
	kinds[3] = shapes_cylinder(0.4, 0.6);
	kinds[4] = shapes_random_hull(1, 14);
	kinds[5] = shapes_rectangle(0.6, 0.4);
	kinds[6] = shapes_cylinder(0.9, 0.05);
	kinds[7] = (shape){NULL, rb_core_of_half_space()};
	return 0;
}

static int release_kinds(void **slot)
{
	(void)slot;
	for (int i = 0; i < KINDS; i++)
		shapes_release(&kinds[i]);
	return 0;
}

static double size_of(const rb_placed *a, const rb_placed *b)
{
	return rb_vec3_length(rb_vec3_sub(b->at, a->at)) + a->core->reach + b->core->reach +
	       a->core->radius + b->core->radius;
}

/* What must hold of any answer: a unit normal that proves the gap, and points that have it. */
static void assert_consistent(const rb_placed *a, const rb_placed *b, const rb_convex_touch *t)
{
	const double tol = 64 * DBL_EPSILON * size_of(a, b);
	const double place = tol +
	                     8 * DBL_EPSILON * (rb_vec3_max_abs(a->at) + rb_vec3_max_abs(b->at));

	assert_near(rb_vec3_length(t->normal), 1, 4 * DBL_EPSILON);
	if (a->core->kind != RB_CORE_HALF_SPACE && b->core->kind != RB_CORE_HALF_SPACE)
		assert_near(shapes_proof(a, b, t->normal), t->gap, tol);
	const rb_vec3 d = rb_vec3_sub(t->on_b, t->on_a);
	assert_near(rb_vec3_length(rb_vec3_add_scaled(d, -t->gap, t->normal)), 0, place);
	/* a normal an ulp off slides a rim's point along the rim by an ulp over its angle to the axis */
	const bool round = a->core->kind == RB_CORE_CYLINDER || b->core->kind == RB_CORE_CYLINDER;
	if (t->gap > 0) {
		assert_true(shapes_outside(a, t->on_a) <= (round ? 100 : 1) * place);
		assert_true(shapes_outside(b, t->on_b) <= (round ? 100 : 1) * place);
	}
}

static rb_placed place(const shape *s, uint64_t stream, uint64_t k, double spread)
{
	return (rb_placed){&s->core, shapes_vector(stream, k, spread), shapes_turn(stream + 1, k)};
}

static void a_gap_is_proved_by_its_normal_and_had_by_its_points(void **slot)
{
	(void)slot;
	for (int i = 0; i < KINDS; i++)
		for (int j = 0; j < KINDS - (i == KINDS - 1); j++)
			for (uint64_t k = 0; k < 400; k++) {
				const double spread = k % 2 ? 0.8 : 2.5;
				const rb_placed a = place(&kinds[i], 30, k, spread);
				const rb_placed b = place(&kinds[j], 40, k, spread);
				const rb_convex_touch t = rb_convex_gap(&a, &b);
				assert_consistent(&a, &b, &t);
			}
}

/*
 * Moved along their normal until they nearly touch they have the gap that they are moved to, and
 * overlap by no more: a direction that is only nearly the best gives less.
 */
static void what_is_moved_to_a_touch_has_that_gap(void **slot)
{
	static const double gaps[] = {1e-5, 1e-8, -1e-8};

	(void)slot;
	for (int i = 0; i < KINDS - 1; i++)
		for (int j = 0; j < KINDS - 1; j++)
			for (uint64_t k = 0; k < 300; k++) {
				const double gap = gaps[k % 3];
				const rb_placed a = place(&kinds[i], 170, k, 1.5);
				rb_placed b = place(&kinds[j], 180, k, 1.5);
				const rb_convex_touch t = rb_convex_gap(&a, &b);

				if (!(t.gap > 0.01))
					continue;
				b.at = rb_vec3_add_scaled(b.at, gap - t.gap, t.normal);
				const double now = rb_convex_gap(&a, &b).gap;
				assert_near(gap > 0 ? now : fmin(now, gap), gap,
				            64 * DBL_EPSILON * size_of(&a, &b));
			}
}

static void polytopes_have_the_gap_that_every_direction_tried_gives(void **slot)
{
	static const int which[] = {0, 1, 2, 4, 5};

	(void)slot;
	for (int i = 0; i < 5; i++)
		for (int j = 0; j < 5; j++)
			for (uint64_t k = 0; k < 100; k++) {
				const rb_placed a = place(&kinds[which[i]], 50, k,
				                          k % 2 ? 0.6 : 1.5);
				const rb_placed b = place(&kinds[which[j]], 60, k,
				                          k % 2 ? 0.6 : 1.5);
				const rb_convex_touch t = rb_convex_gap(&a, &b);
				assert_near(t.gap, shapes_gap(&a, &b),
				            64 * DBL_EPSILON * size_of(&a, &b));
			}
}

/* Turned and shifted together, and exchanged, two bodies keep their gap. */
static void the_gap_does_not_depend_on_the_order_nor_on_the_frame(void **slot)
{
	(void)slot;
	for (int i = 0; i < KINDS - 1; i++)
		for (int j = 0; j < KINDS; j++)
			for (uint64_t k = 0; k < 100; k++) {
				const rb_placed a = place(&kinds[i], 70, k, 1);
				const rb_placed b = place(&kinds[j], 80, k, 1);
				const rb_mat3 turn = shapes_turn(90, k);
				const rb_vec3 shift = shapes_vector(91, k, 3);
				const double tol = 128 * DBL_EPSILON * (size_of(&a, &b) + 6);
				const rb_convex_touch t = rb_convex_gap(&a, &b);
				const rb_convex_touch back = rb_convex_gap(&b, &a);
				const rb_placed c = {a.core,
				                     rb_vec3_add(shift, rb_mat3_apply(&turn, a.at)),
				                     rb_mat3_multiply(&turn, &a.turn)};
				const rb_placed d = {b.core,
				                     rb_vec3_add(shift, rb_mat3_apply(&turn, b.at)),
				                     rb_mat3_multiply(&turn, &b.turn)};
				const rb_convex_touch moved = rb_convex_gap(&c, &d);
				assert_near(back.gap, t.gap, tol);
				assert_near(moved.gap, t.gap, tol);
				if (t.gap > 0.01) {
					const rb_vec3 n = rb_mat3_apply(&turn, t.normal);
					assert_near(
						rb_vec3_length(rb_vec3_add(back.normal, t.normal)),
						0, 1e-12);
					assert_near(rb_vec3_length(rb_vec3_sub(moved.normal, n)), 0,
					            1e-11);
				}
			}
}

/* Boxes along the axes have a closed form: the gaps along x, y, z, of which the positive ones add as squares. */
static void boxes_along_the_axes_have_their_closed_form(void **slot)
{
	shape p = shapes_box(0.5, 0.7, 0.2), q = shapes_box(0.1, 0.4, 0.9);

	(void)slot;
	for (uint64_t k = 0; k < 2000; k++) {
		const rb_vec3 d = shapes_vector(100, k, k % 2 ? 2 : 1);
		const rb_placed a = {&p.core, {0, 0, 0}, shapes_upright};
		const rb_placed b = {&q.core, d, shapes_upright};
		const double x = fabs(d.x) - 0.6, y = fabs(d.y) - 1.1, z = fabs(d.z) - 1.1;
		const double inner = fmax(x, fmax(y, z));
		const rb_vec3 out = {fmax(x, 0), fmax(y, 0), fmax(z, 0)};
		const double gap = inner > 0 ? rb_vec3_length(out) : inner;
		assert_near(rb_convex_gap(&a, &b).gap, gap, 16 * DBL_EPSILON);
	}
	shapes_release(&p);
	shapes_release(&q);
}

/* The sharp upper edge of one box across that of the other, at any angle: the gap is how high one is above the other. */
static void crossed_edges_have_the_gap_of_their_lines_at_any_angle(void **slot)
{
	shape box = shapes_box(1, 1, 1);
	const double s = sqrt(2), eighth = 0.78539816339744828;
	const rb_mat3 up = shapes_turned((rb_vec3){eighth, 0, 0});

	(void)slot;
	for (uint64_t k = 0; k < 500; k++) {
		const double height = k % 2 ? 0.3 * shapes_random(110, k)
		                            : -1e-3 * shapes_random(111, k);
		const rb_mat3 about = shapes_turned(
			(rb_vec3){0, 0, 0.1 + 2.9 * shapes_random(112, k)});
		const rb_placed a = {&box.core, {0, 0, -s}, up};
		const rb_placed b = {
			&box.core, {0.05, 0.03, s + height}, rb_mat3_multiply(&about, &up)};
		const rb_convex_touch t = rb_convex_gap(&a, &b);
		assert_near(t.gap, height, 32 * DBL_EPSILON);
		assert_near(t.normal.z, 1, 1e-14);
		assert_int_equal(t.a >> 24, RB_PART_EDGE);
		assert_int_equal(t.b >> 24, RB_PART_EDGE);
	}
	shapes_release(&box);
}

static void spheres_and_cylinders_have_their_closed_forms(void **slot)
{
	const rb_placed drum = {&kinds[3].core, {0, 0, 0}, shapes_upright};

	(void)slot;
	for (uint64_t k = 0; k < 500; k++) {
		const rb_vec3 c = shapes_vector(120, k, 2);
		const rb_placed sphere = {&kinds[1].core, c, shapes_turn(121, k)};
		const double aside = hypot(c.x, c.y) - 0.4, above = fabs(c.z) - 0.6;
		const double gap = aside > 0 && above > 0 ? hypot(aside, above)
		                                          : fmax(aside, above);
		assert_near(rb_convex_gap(&drum, &sphere).gap, gap - 0.4, 32 * DBL_EPSILON);
	}
	/* skew mantles: the distance of the axes less the radii */
	for (uint64_t k = 0; k < 100; k++) {
		const rb_placed other = {
			&kinds[3].core,
			{1 + 0.5 * shapes_random(122, k), 0.1, 0.05},
			shapes_turned((rb_vec3){0.5 + 2.1 * shapes_random(123, k), 0, 0})};
		const double distance = other.at.x;
		assert_near(rb_convex_gap(&drum, &other).gap, distance - 0.8, 32 * DBL_EPSILON);
	}
}

/* The most that directions prove, by trying: wide at first, then around the best. */
static double proved(const rb_placed *a, const rb_placed *b, uint64_t k)
{
	rb_vec3 best = {0, 0, 1};
	double most = shapes_proof(a, b, best), step = 1;

	for (uint64_t m = 0; m < 3000; m++) {
		step = m < 1000 ? 4 : fmax(step * 0.99, 1e-6);
		const rb_vec3 n = rb_vec3_unit(
			rb_vec3_add(best, shapes_vector(150, 3000 * k + m, step)), best);
		const double proof = shapes_proof(a, b, n);

		if (proof > most) {
			most = proof;
			best = n;
		}
	}
	return most;
}

/* Against directions all over the sphere, improved by going uphill: none proves more. */
static void no_direction_proves_more_than_the_gap_of_cylinders(void **slot)
{
	(void)slot;
	for (int i = 0; i < KINDS - 1; i++)
		for (uint64_t k = 0; k < 60; k++) {
			const rb_placed a = place(&kinds[k % 2 ? 3 : 6], 130, k, 0.6);
			const rb_placed b = place(&kinds[i], 140, k, 0.6);
			const double gap = rb_convex_gap(&a, &b).gap;
			assert_true(proved(&a, &b, k) <= gap + 1e-12);
		}
}

/* Deep in one another, nearly across: the slopes of rims turn fast there, and Newton's steps leave their brackets. */
static void a_rod_that_is_stuck_in_a_drum_comes_out_the_shortest_way(void **slot)
{
	(void)slot;
	for (uint64_t k = 0; k < 200; k++) {
		const double half = 9 + 6 * shapes_random(300, k),
			     tilt = 0.2 * shapes_random(301, k);
		const shape rod = shapes_cylinder(0.01 + 4 * shapes_random(302, k), half);
		const shape drum = shapes_cylinder(0.8 * half, 0.7);
		const rb_mat3 turn = shapes_turn(303, k);
		const rb_mat3 across = shapes_turned(
			(rb_vec3){acos(-1) / 2 + (k % 2 ? tilt : -tilt), 0, 0});
		const rb_placed a = {&rod.core, {0, 0, 0}, turn};
		const rb_placed b = {&drum.core, shapes_vector(304, k, 1.5),
		                     rb_mat3_multiply(&turn, &across)};
		const double gap = rb_convex_gap(&a, &b).gap;

		assert_near(rb_convex_gap(&b, &a).gap, gap, 128 * DBL_EPSILON * size_of(&a, &b));
		assert_true(proved(&a, &b, k) <= gap + 1e-12);
	}
}

/* Along a straight line through a touch the gap has no jump, and its slope is the normal's share of the motion. */
static void the_gap_is_continuous_through_zero_and_the_normal_is_its_gradient(void **slot)
{
	(void)slot;
	for (int i = 0; i < KINDS - 1; i++)
		for (int j = 0; j < KINDS; j++)
			for (uint64_t k = 0; k < 40; k++) {
				const rb_placed a = place(&kinds[i], 160, k, 1);
				rb_placed b = place(&kinds[j], 170, k, 1);
				const rb_convex_touch from = rb_convex_gap(&a, &b);
				const rb_vec3 start = b.at, push = shapes_vector(180, k, 1);
				const double h = 1e-7;
				b.at = rb_vec3_add_scaled(start, h, push);
				const double forth = rb_convex_gap(&a, &b).gap;
				b.at = rb_vec3_add_scaled(start, -h, push);
				const double back = rb_convex_gap(&a, &b).gap;
				/* a kink of an overlap, where the best direction changes, is no gradient */
				if (from.gap > 1e-3)
					assert_near((forth - back) / (2 * h),
					            rb_vec3_dot(from.normal, push), 1e-6);
				assert_true(fabs(forth - back) <=
				            2 * h * rb_vec3_length(push) + 1e-14);
				if (from.gap < 0)
					continue;
				/* to touching, to just apart, to just overlapping; the normal stays */
				for (int side = -2; side <= 2; side++) {
					const double gap = side * 1e-13;
					b.at = rb_vec3_add_scaled(start, gap - from.gap,
					                          from.normal);
					const double found = rb_convex_gap(&a, &b).gap;
					/* a corner in a corner has a shorter way out than it came in, out at the other side for flats */
					assert_true(found >= gap - 4e-15 &&
					            found <= (i == 5 && j == 5 ? fabs(gap)
					                                       : fmax(gap, 0)) +
					                             4e-15);
				}
			}
}

static void needles_foils_and_discs_have_their_gaps(void **slot)
{
	shape needle = shapes_box(1e-6, 1e-6, 1), foil = shapes_box(1, 1, 1e-6);
	shape thread = shapes_capsule(1, 1e-6);
	const shape coin = shapes_cylinder(1, 1e-6), rod = shapes_cylinder(1e-6, 1);
	const shape *const thin[5] = {&needle, &foil, &thread, &coin, &rod};

	(void)slot;
	for (int i = 0; i < 5; i++)
		for (int j = 0; j < 5; j++)
			for (uint64_t k = 0; k < 200; k++) {
				const rb_placed a = place(thin[i], 190, k, 0.7);
				const rb_placed b = place(thin[j], 200, k, 0.7);
				const rb_convex_touch t = rb_convex_gap(&a, &b);
				assert_consistent(&a, &b, &t);
				if (i < 3 && j < 3)
					assert_near(t.gap, shapes_gap(&a, &b),
					            64 * DBL_EPSILON * size_of(&a, &b));
			}
	/* the point of a needle over a foil */
	const rb_placed a = {&foil.core, {0, 0, 0}, shapes_turned((rb_vec3){0.3, 0.2, 0.1})};
	const rb_placed b = {&needle.core, rb_mat3_apply(&a.turn, (rb_vec3){0.2, 0.1, 1.5}),
	                     a.turn};
	assert_near(rb_convex_gap(&a, &b).gap, 0.5 - 1e-6, 8 * DBL_EPSILON);
	shapes_release(&needle);
	shapes_release(&foil);
	shapes_release(&thread);
}

/* Far from the origin only the coordinates' own rounding is left; sizes scale without a trace. */
static void places_far_away_and_sizes_do_not_matter(void **slot)
{
	(void)slot;
	for (uint64_t k = 0; k < 200; k++) {
		const rb_vec3 d = shapes_vector(210, k, 1);
		/* multiples of 2^-20, which 1e8 does not round */
		const rb_vec3 at = {ldexp(rint(ldexp(d.x, 20)), -20),
		                    ldexp(rint(ldexp(d.y, 20)), -20),
		                    ldexp(rint(ldexp(d.z, 20)), -20)};
		const rb_placed a = {&kinds[0].core, {0, 0, 0}, shapes_turn(211, k)};
		const rb_placed b = {&kinds[4].core, at, shapes_turn(212, k)};
		const rb_vec3 far = {1e8, -1e8, 1e8};
		const rb_placed c = {a.core, far, a.turn};
		const rb_placed e = {b.core, rb_vec3_add(far, at), b.turn};
		const rb_convex_touch near = rb_convex_gap(&a, &b), away = rb_convex_gap(&c, &e);
		assert_near(away.gap, near.gap, 0);
		assert_near(away.normal.x, near.normal.x, 0);
	}
	for (int e = -300; e <= 300; e += 100) {
		shape p = shapes_box(ldexp(0.5, e), ldexp(0.3, e), ldexp(0.8, e));
		const rb_placed a = {&p.core, {0, 0, 0}, shapes_turn(213, 1)};
		const rb_placed b = {&p.core, {0, 0, ldexp(1.7, e)}, shapes_turn(214, 1)};
		const rb_placed unit_a = {&kinds[0].core, a.at, a.turn};
		const rb_placed unit_b = {&kinds[0].core, {0, 0, 1.7}, b.turn};
		assert_near(ldexp(rb_convex_gap(&a, &b).gap, -e),
		            rb_convex_gap(&unit_a, &unit_b).gap, 1e-15);
		shapes_release(&p);
	}
}

static void bodies_in_one_another_part_along_the_shortest_way(void **slot)
{
	shape big = shapes_box(2, 3, 4);

	(void)slot;
	for (uint64_t k = 0; k < 50; k++) {
		const rb_placed a = {&big.core, {1, 2, 3}, shapes_turn(220, k)};
		const rb_placed same = rb_convex_gap(&a, &a).gap < 0 ? a : (rb_placed){0};
		assert_near(rb_convex_gap(&a, &same).gap, -4, 32 * DBL_EPSILON * 4);
		/* a ball within: out through the nearest face */
		const rb_placed ball = {&kinds[1].core, rb_placed_point(&a, (rb_vec3){0, 0, 3.5}),
		                        shapes_upright};
		const rb_convex_touch t = rb_convex_gap(&a, &ball);
		assert_near(t.gap, -0.9, 1e-14);
		assert_near(rb_vec3_dot(t.normal, rb_placed_axis(&a)), 1, 4e-15);
	}
	/* points and lines in one another: any way across, but a unit one */
	for (int i = 1; i <= 2; i++)
		for (int j = 1; j <= 2; j++) {
			const rb_placed a = {&kinds[i].core, {0, 0, 0}, shapes_upright};
			const rb_placed b = {&kinds[j].core, {0, 0, 0}, shapes_upright};
			const rb_convex_touch t = rb_convex_gap(&a, &b);
			assert_near(t.gap, -a.core->radius - b.core->radius, 1e-15);
			assert_near(rb_vec3_length(t.normal), 1, 1e-15);
		}
	shapes_release(&big);
}

static void nothing_touches_before_the_safe_time(void **slot)
{
	(void)slot;
	assert_near(rb_convex_safe_time(1, 2, 0, 0), 0.5, 0);
	assert_near(rb_convex_safe_time(1, 1, 1, 0), 0.5, 0);
	assert_near(rb_convex_safe_time(1, 0, 0, 2), 1, 1e-15);
	assert_near(rb_convex_safe_time(1e-20, 1, 0, 10), 1e-20, 1e-35);
	assert_true(isinf(rb_convex_safe_time(1, -1, 0.5, 0)));
	assert_near(rb_convex_safe_time(-1, 1, 1, 0), 0, 0);
	assert_near(rb_convex_safe_time((double)NAN, 1, 1, 0), 0, 0);
	/* flights of boxes that turn: at no moment before it do they overlap */
	for (uint64_t k = 0; k < 300; k++) {
		const rb_placed a = place(&kinds[0], 230, k, 1.5),
				b = place(&kinds[4], 240, k, 1.5);
		const rb_vec3 velocity = shapes_vector(250, k, 2);
		const rb_vec3 spin_a = shapes_vector(251, k, 3), spin_b = shapes_vector(252, k, 3);
		const rb_convex_touch t = rb_convex_gap(&a, &b);
		const double turning = rb_vec3_length(rb_vec3_cross(t.normal, spin_a)) *
		                               rb_convex_reach(a.core) +
		                       rb_vec3_length(rb_vec3_cross(t.normal, spin_b)) *
		                               rb_convex_reach(b.core);
		const double safe = rb_convex_safe_time(t.gap, -rb_vec3_dot(t.normal, velocity),
		                                        turning, 0);
		for (int i = 0; t.gap > 0 && i <= 20; i++) {
			const double time = fmin(safe, 5) * i / 20;
			const rb_mat3 turn_a = shapes_turned(rb_vec3_scale(time, spin_a));
			const rb_mat3 turn_b = shapes_turned(rb_vec3_scale(time, spin_b));
			const rb_placed c = {a.core, a.at, rb_mat3_multiply(&turn_a, &a.turn)};
			const rb_placed d = {b.core, rb_vec3_add_scaled(b.at, time, velocity),
			                     rb_mat3_multiply(&turn_b, &b.turn)};
			assert_true(rb_convex_gap(&c, &d).gap >= -1e-14);
		}
	}
}

static bool holds(const rb_aabb *box, rb_vec3 p)
{
	return p.x >= box->low.x && p.x <= box->high.x && p.y >= box->low.y && p.y <= box->high.y &&
	       p.z >= box->low.z && p.z <= box->high.z;
}

static void boxes_hold_the_body_on_its_whole_way_and_fit(void **slot)
{
	(void)slot;
	for (int i = 0; i < KINDS - 1; i++)
		for (uint64_t k = 0; k < 100; k++) {
			const rb_placed a = place(&kinds[i], 260, k, 3);
			const rb_vec3 to = rb_vec3_add(a.at, shapes_vector(261, k, 2));
			const rb_vec3 turn = shapes_vector(262, k, k % 2 ? 0.1 : 4);
			const rb_aabb swept = rb_convex_swept_bounds(&a, to, rb_vec3_length(turn));
			const rb_aabb box = rb_convex_bounds(&a);
			const double up = a.at.x + rb_placed_height(&a, (rb_vec3){1, 0, 0}) +
			                  a.core->radius;
			assert_near(box.high.x, up, 1e-13);
			assert_true(holds(
				&box, rb_vec3_add_scaled(rb_placed_support(&a, (rb_vec3){1, 0, 0}),
			                                 a.core->radius, (rb_vec3){1, 0, 0})));
			for (uint64_t m = 0; m <= 20; m++) {
				const double s = (double)m / 20;
				const rb_mat3 now = shapes_turned(rb_vec3_scale(s, turn));
				const rb_placed p = {
					a.core, rb_vec3_add_scaled(a.at, s, rb_vec3_sub(to, a.at)),
					rb_mat3_multiply(&now, &a.turn)};
				const rb_vec3 n = rb_vec3_unit(shapes_vector(263, m, 1), to);
				assert_true(
					holds(&swept, rb_vec3_add_scaled(rb_placed_support(&p, n),
				                                         a.core->radius, n)));
			}
		}
}

static void what_is_no_closed_surface_is_refused(void **slot)
{
	const rb_vec3 points[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	const int counts[4] = {3, 3, 3, 3};
	const int good[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
	const int open[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 1, 2, 3};
	const int beyond[12] = {0, 2, 1, 0, 1, 4, 1, 2, 3, 2, 0, 3};
	const int flat[12] = {0, 2, 2, 0, 1, 3, 1, 2, 3, 2, 0, 3};
	struct rb_polytope *p;
	struct rb_error err = {0};

	(void)slot;
	const struct rb_memory_counts before = rb_memory_counts();
	assert_ok(rb_polytope_create(&p, &(rb_polytope_def){4, 4, points, counts, good}, &err));
	assert_int_equal(p->edge_count, 6);
	rb_polytope_destroy(p);
	const int *const wrong[3] = {open, beyond, flat};
	for (int i = 0; i < 3; i++) {
		const rb_polytope_def def = {4, 4, points, counts, wrong[i]};
		assert_int_equal(rb_polytope_create(&p, &def, &err), RB_ERR_SCENE);
		assert_null(p);
		assert_true(err.text[0] != 0);
	}
	for (uint64_t k = 1; k <= 7; k++) {
		rb_memory_fail_at(k);
		assert_int_equal(rb_polytope_create(
					 &p, &(rb_polytope_def){4, 4, points, counts, good}, &err),
		                 RB_ERR_MEMORY);
		assert_null(p);
	}
	rb_memory_fail_at(0);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_true(after.taken - after.freed == before.taken - before.freed);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_gap_is_proved_by_its_normal_and_had_by_its_points),
		cmocka_unit_test(what_is_moved_to_a_touch_has_that_gap),
		cmocka_unit_test(polytopes_have_the_gap_that_every_direction_tried_gives),
		cmocka_unit_test(the_gap_does_not_depend_on_the_order_nor_on_the_frame),
		cmocka_unit_test(boxes_along_the_axes_have_their_closed_form),
		cmocka_unit_test(crossed_edges_have_the_gap_of_their_lines_at_any_angle),
		cmocka_unit_test(spheres_and_cylinders_have_their_closed_forms),
		cmocka_unit_test(a_rod_that_is_stuck_in_a_drum_comes_out_the_shortest_way),
		cmocka_unit_test(no_direction_proves_more_than_the_gap_of_cylinders),
		cmocka_unit_test(the_gap_is_continuous_through_zero_and_the_normal_is_its_gradient),
		cmocka_unit_test(needles_foils_and_discs_have_their_gaps),
		cmocka_unit_test(places_far_away_and_sizes_do_not_matter),
		cmocka_unit_test(bodies_in_one_another_part_along_the_shortest_way),
		cmocka_unit_test(nothing_touches_before_the_safe_time),
		cmocka_unit_test(boxes_hold_the_body_on_its_whole_way_and_fit),
		cmocka_unit_test(what_is_no_closed_surface_is_refused),
	};
	return cmocka_run_group_tests(tests, make_kinds, release_kinds);
}
