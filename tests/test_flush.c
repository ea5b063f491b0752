/* SPDX-License-Identifier: MIT */
/* src/geom/manifold.h: boxes face to face that are nearly flush and nearly parallel, at every size of nearly. */
#include "shapes.h"

#include "geom/manifold.h"
#include "math/random.h"

enum { SAMPLES = 60000 };

static double unit_at(int sample, int stream)
{
	return rb_random_unit(7, (uint64_t)stream, (uint64_t)sample);
}

/* Of either sign and any size from 1e-16 to 1e-2; in one of eight cases zero. */
static double small(int sample, int stream)
{
	const double u = unit_at(sample, stream),
		     size = pow(10, -16 + 14 * unit_at(sample, stream + 50));

	return u < 0.125 ? 0 : u < 0.5625 ? size : -size;
}

/* m: how far a point is outside a box, negative: within. */
static double outside(const shape *box, const rb_placed *placed, rb_vec3 p)
{
	const rb_vec3 x = rb_mat3_apply_transposed(&placed->turn, rb_vec3_sub(p, placed->at));
	const rb_vec3 h = box->polytope->half;

	return fmax(fmax(fabs(x.x) - h.x, fabs(x.y) - h.y), fabs(x.z) - h.z);
}

typedef struct {
	shape a, b;
	rb_placed at_a, at_b;
	double band;
} couple;

/* Two boxes of equal width, b at the side of a, off by what is nearly nothing in every way. */
static void couple_up(couple *c, int sample)
{
	const double gap = 0.1 * small(sample, 0), band = pow(10, -12 + 8 * unit_at(sample, 1));
	const double deep = 0.05 + unit_at(sample, 2);
	const bool all_ways = unit_at(sample, 3) < 0.5;
	const rb_vec3 turn = {all_ways ? small(sample, 4) : 0, all_ways ? small(sample, 5) : 0,
	                      small(sample, 6)};

	c->a = shapes_box(0.1, 0.4, 0.8);
	c->b = shapes_box(deep, unit_at(sample, 7) < 0.5 ? 0.4 : 0.2,
	                  unit_at(sample, 8) < 0.5 ? 0.8 : 0.3);
	c->band = band;
	const rb_vec3 at = {0.1 + deep + gap, small(sample, 9), small(sample, 10)};
	c->at_a = (rb_placed){&c->a.core, {0, 0, 0}, shapes_upright};
	c->at_b = (rb_placed){&c->b.core, at, shapes_turned(turn)};
	if (unit_at(sample, 11) < 0.5)
		return;
	/* both anywhere, turned together */
	const rb_mat3 whole = shapes_turned(
		(rb_vec3){3 * unit_at(sample, 12), 3 * unit_at(sample, 13), 1});
	c->at_a.turn = whole;
	c->at_b.turn = rb_mat3_multiply(&whole, &c->at_b.turn);
	c->at_b.at = rb_mat3_apply(&whole, at);
}

static void part(couple *c)
{
	shapes_release(&c->a);
	shapes_release(&c->b);
}

static const double noise = 1e-13;
/* m: what the nearest points may stand too high where only grown patches share any. */
static const double fine = 1e-11;

static double least_gap(const rb_manifold *m)
{
	double least = HUGE_VAL;

	for (int i = 0; i < m->count; i++)
		least = fmin(least, m->point[i].gap);
	return least;
}

static void there_is_a_point_and_all_lie_on_both_boxes(void **slot)
{
	(void)slot;
	for (int k = 0; k < 2 * SAMPLES; k++) {
		rb_manifold m;
		couple c;

		couple_up(&c, k / 2);
		if (k % 2 == 0)
			rb_manifold_of(&m, &c.at_a, &c.at_b, c.band);
		else
			rb_manifold_with_nearest(&m, &c.at_a, &c.at_b, c.band, fine,
			                         (double)INFINITY);
		if (m.count < 1)
			fail_msg("sample %d: no point", k / 2);
		for (int i = 0; i < m.count; i++) {
			const double a = outside(&c.a, &c.at_a, m.point[i].on_a);
			const double b = outside(&c.b, &c.at_b, m.point[i].on_b);
			const double most = 2 * c.band + noise;
			if (fabs(a) > most || fabs(b) > most)
				fail_msg("sample %d, point %d of %d: %.3g and %.3g off the boxes, "
				         "band %.3g, gap %.3g",
				         k, i, m.count, a, b, c.band, m.gap);
		}
		part(&c);
	}
}

static void the_lowest_point_has_the_gap(void **slot)
{
	(void)slot;
	for (int k = 0; k < SAMPLES; k++) {
		rb_manifold m;
		couple c;

		couple_up(&c, k);
		rb_manifold_with_nearest(&m, &c.at_a, &c.at_b, c.band, 0, (double)INFINITY);
		if (least_gap(&m) > m.gap + fine || least_gap(&m) < m.gap - c.band)
			fail_msg("sample %d: gap %.17g, lowest of %d points %.3g above, band %.3g",
			         k, m.gap, m.count, least_gap(&m) - m.gap, c.band);
		part(&c);
	}
}

static bool has_mirrored(const rb_manifold *m, const rb_manifold_point *p, double near)
{
	for (int i = 0; i < m->count; i++)
		if (rb_vec3_length(rb_vec3_sub(m->point[i].on_b, p->on_a)) <= near &&
		    rb_vec3_length(rb_vec3_sub(m->point[i].on_a, p->on_b)) <= near &&
		    fabs(m->point[i].gap - p->gap) <= near)
			return true;
	return false;
}

static void the_order_of_the_boxes_does_not_matter(void **slot)
{
	(void)slot;
	for (int k = 0; k < SAMPLES; k++) {
		rb_manifold m, n;
		couple c;

		couple_up(&c, k);
		rb_manifold_with_nearest(&m, &c.at_a, &c.at_b, c.band, 0, (double)INFINITY);
		rb_manifold_with_nearest(&n, &c.at_b, &c.at_a, c.band, 0, (double)INFINITY);
		if (fabs(m.gap - n.gap) > 2 * noise)
			fail_msg("sample %d: gaps %.17g and %.17g", k, m.gap, n.gap);
		/* sides that cross do so at an angle above the band, and move by what the view along n shifts over it */
		const double angle = rb_vec3_length(rb_vec3_add(m.normal, n.normal));
		const double near = 3 * c.band + (4e-16 + fabs(m.gap) * angle) / c.band;
		for (int i = 0; i < m.count; i++)
			if (!has_mirrored(&n, &m.point[i], near))
				fail_msg("sample %d: point %d of %d is not among %d, band %.3g gap "
				         "%.3g normals %.3g",
				         k, i, m.count, n.count, c.band, m.gap,
				         rb_vec3_length(rb_vec3_add(m.normal, n.normal)));
		part(&c);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(there_is_a_point_and_all_lie_on_both_boxes),
		cmocka_unit_test(the_lowest_point_has_the_gap),
		cmocka_unit_test(the_order_of_the_boxes_does_not_matter),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
