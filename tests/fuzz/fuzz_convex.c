/* SPDX-License-Identifier: MIT */
/*
 * Fuzz target: two convex bodies of any kinds, sizes and places. What must hold: an answer, of numbers; a unit normal; the
 * same gap whichever comes first, up to rounding, where the bodies are apart; at least one point of touch, no key twice.
 */
#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "geom/manifold.h"
#include "math/quat.h"

int LLVMFuzzerTestOneInput(const unsigned char *bytes, size_t size);

/* A size from 2^-10 to 2^10, a byte for the power and one for what is between: aspects to 10^6, as promised. */
static double size_from(const unsigned char *two)
{
	return ldexp(1 + two[1] / 256.0, two[0] % 21 - 10);
}

static double coordinate_from(const unsigned char *two)
{
	return (two[0] & 128 ? -1 : 1) * (two[0] % 128 == 0 ? two[1] / 64.0 : size_from(two));
}

/* Mostly turns by eighths about the axes, where everything is parallel to something. */
static rb_mat3 turn_from(const unsigned char *four)
{
	const double eighth = 0.78539816339744828;
	rb_quat q = {1, 0, 0, 0};

	if (four[0] & 1)
		return rb_quat_to_mat3(rb_quat_unit((rb_quat){1.0 + four[0], four[1] - 127.5,
		                                              four[2] - 127.5, four[3] - 127.5}));
	q = rb_quat_multiply(q, rb_quat_from_turn((rb_vec3){eighth * (four[1] % 8), 0, 0}));
	q = rb_quat_multiply(q, rb_quat_from_turn((rb_vec3){0, eighth * (four[2] % 8), 0}));
	q = rb_quat_multiply(q, rb_quat_from_turn((rb_vec3){0, 0, eighth * (four[3] % 8)}));
	return rb_quat_to_mat3(rb_quat_unit(q));
}

static struct rb_polytope *make(const unsigned char *b, rb_core *core)
{
	const double x = size_from(b + 1), y = size_from(b + 3), z = size_from(b + 5);
	const rb_vec3 corners[4] = {{x, 0, 0}, {-x, y, 0}, {0, -y, -z}, {0, 0, z}};
	const int counts[4] = {3, 3, 3, 3}, loop[12] = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2};
	const int back[12] = {2, 1, 0, 3, 2, 0, 1, 3, 0, 2, 3, 1};
	struct rb_polytope *p = NULL;
	enum rb_status status = RB_OK;

	switch (b[0] % 7) {
	case 0:
		status = rb_polytope_create_segment(&p, 0, NULL);
		break;
	case 1:
		status = rb_polytope_create_segment(&p, x, NULL);
		break;
	case 2:
		status = rb_polytope_create_rectangle(&p, x, y, NULL);
		break;
	case 3:
		*core = rb_core_of_cylinder(x, y);
		return NULL;
	case 4: {
		const rb_vec3 n = rb_vec3_cross(rb_vec3_sub(corners[1], corners[0]),
		                                rb_vec3_sub(corners[2], corners[0]));
		const bool out = rb_vec3_dot(n, rb_vec3_sub(corners[3], corners[0])) < 0;
		status = rb_polytope_create(
			&p, &(rb_polytope_def){4, 4, corners, counts, out ? loop : back}, NULL);
		break;
	}
	default:
		status = rb_polytope_create_box(&p, (rb_vec3){x, y, z}, NULL);
	}
	if (status != RB_OK)
		return NULL;
	*core = rb_core_of_polytope(p, b[0] % 7 < 2 ? y : 0);
	return p;
}

static void judge(const rb_placed *a, const rb_placed *b)
{
	const rb_convex_touch t = rb_convex_gap(a, b), back = rb_convex_gap(b, a);
	const double scale = rb_vec3_length(rb_vec3_sub(b->at, a->at)) + rb_convex_reach(a->core) +
	                     rb_convex_reach(b->core);
	rb_manifold m;

	if (!isfinite(t.gap) || !rb_vec3_finite(t.on_a) || !rb_vec3_finite(t.on_b))
		abort();
	if (!(fabs(rb_vec3_length(t.normal) - 1) <= 1e-14))
		abort();
	if (t.gap > 0 && !(fabs(t.gap - back.gap) <= 256 * DBL_EPSILON * scale))
		abort();
	rb_manifold_of(&m, a, b, 1e-9 * scale);
	if (m.count < 1 || m.count > RB_MANIFOLD_MAX || m.gap != t.gap)
		abort();
	for (int i = 0; i < m.count; i++) {
		if (!isfinite(m.point[i].gap) || !rb_vec3_finite(m.point[i].on_a))
			abort();
		for (int j = 0; j < i; j++)
			if (m.point[i].key == m.point[j].key)
				abort();
	}
}

int LLVMFuzzerTestOneInput(const unsigned char *bytes, size_t size)
{
	unsigned char b[32] = {0};
	rb_core core[2] = {{0}, {0}};

	memcpy(b, bytes, size < sizeof b ? size : sizeof b);
	struct rb_polytope *const p = make(b, &core[0]), *const q = make(b + 7, &core[1]);
	const rb_placed first = {&core[0], {0, 0, 0}, turn_from(b + 14)};
	rb_placed second = {
		&core[1],
		{coordinate_from(b + 18), coordinate_from(b + 20), coordinate_from(b + 22)},
		turn_from(b + 24)};
	if (core[0].reach + core[0].radius > 0 && core[1].reach + core[1].radius > 0) {
		judge(&first, &second);
		/* and just touching */
		const rb_convex_touch t = rb_convex_gap(&first, &second);
		second.at = rb_vec3_add_scaled(second.at, -t.gap, t.normal);
		judge(&first, &second);
	}
	rb_polytope_destroy(p);
	rb_polytope_destroy(q);
	return 0;
}
