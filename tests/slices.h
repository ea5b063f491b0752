/* SPDX-License-Identifier: MIT */
/* Mass properties of bodies of revolution about z by adding up slices, for tests of shapes. Header only. */
#ifndef RB_TESTS_SLICES_H
#define RB_TESTS_SLICES_H

#include "support.h"

#include "math/mat3.h"
#include "shape/shape_types.h"

/*
 * Volume and moments against slices of radius(z) from -half to half. Where the radius squared is a polynomial the
 * midpoint rule is off by about 1 / SLICES^2 of the whole, whatever jumps stand at ends of slices.
 */
static inline void slices_assert(const struct rb_shape_type *row, const struct rb_shape *shape,
                                 double (*radius)(const struct rb_shape *shape, double z),
                                 double half)
{
	enum { SLICES = 20000 };
	const double pi = 3.14159265358979323846, h = 2 * half / SLICES, mass = 3;
	double volume = 0, along = 0, across = 0;

	for (int k = 0; k < SLICES; k++) {
		const double z = -half + (k + 0.5) * h, r = radius(shape, z);
		const double slice = pi * r * r * h;

		volume += slice;
		along += slice * r * r / 2;
		across += slice * (r * r / 4 + z * z);
	}
	const rb_mat3 inertia = row->inertia(shape, mass);
	const double bound = 1e-7;
	assert_near(row->volume(shape) / volume, 1, bound);
	assert_near(inertia.m[2][2] / (mass * along / volume), 1, bound);
	assert_near(inertia.m[0][0] / (mass * across / volume), 1, bound);
	assert_near(inertia.m[1][1] / (mass * across / volume), 1, bound);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			assert_true(i == j || inertia.m[i][j] == 0);
}

/* `point` is on the surface, and `out` the unit normal there: so far away is what lies on it, also a little inside. */
static inline void slices_assert_surface(const struct rb_shape_type *row,
                                         const struct rb_shape *shape, rb_vec3 point, rb_vec3 out)
{
	static const double way[] = {-0.01, -1e-6, 0, 1e-6, 0.3, 100};

	for (size_t k = 0; k < sizeof way / sizeof *way; k++)
		assert_near(row->distance(shape, rb_vec3_add_scaled(point, way[k], out)), way[k],
		            1e-13);
	assert_true(rb_vec3_length(point) <= row->reach(shape) * (1 + 1e-15));
	const rb_vec3 half = row->half(shape);
	assert_true(fabs(point.x) <= half.x * (1 + 1e-15) &&
	            fabs(point.y) <= half.y * (1 + 1e-15) && fabs(point.z) <= half.z * (1 + 1e-15));
}

/* How far its core with its radius reaches along `direction`, unit. */
static inline double slices_support(const struct rb_shape_type *row, const struct rb_shape *shape,
                                    rb_vec3 direction)
{
	const rb_mat3 upright = rb_mat3_diagonal(1, 1, 1);
	struct rb_error err;
	rb_core core;

	assert_ok(row->core(shape, &core, &err));
	const rb_placed placed = {&core, {0, 0, 0}, upright};
	const double height = rb_placed_height(&placed, direction) + core.radius;
	rb_polytope_destroy((struct rb_polytope *)(uintptr_t)core.polytope);
	return height;
}

/* Each of these numbers, and no other, has to be positive and finite. */
static inline void slices_assert_faults(const struct rb_shape_type *row,
                                        const struct rb_shape *good, double *const *number,
                                        int count, struct rb_shape *shape)
{
	static const double wrong[] = {0, -1, (double)NAN, (double)INFINITY};
	char text[RB_SHAPE_FAULT_SIZE];

	*shape = *good;
	assert_false(row->fault(shape, text));
	for (int k = 0; k < count; k++)
		for (int w = 0; w < 4; w++) {
			*shape = *good;
			*number[k] = wrong[w];
			assert_true(row->fault(shape, text));
			assert_non_null(strstr(text, "must be"));
		}
	*shape = *good;
}

#endif
