/* SPDX-License-Identifier: MIT */
/*
 * Volume and inertia of polyhedra and particles, and what makes an inertia tensor possible. Pure
 * functions.
 *
 * A body whose centre of mass is given off the centroid keeps its shape where it is. Without an
 * inertia of its own it takes the tensor of the uniform shape (2/5 m r^2 for a sphere) as the one
 * about that given centre of mass: only the author knows how the mass is spread, and says so with
 * `inertia` where it matters.
 */
#ifndef RB_GEOM_MASS_H
#define RB_GEOM_MASS_H

#include "math/mat3.h"

#include <rbsim/scene.h>

/*
 * Fills in what follows from corners and faces: volume, weight, centroid, inertia, reach, half
 * width. Right to rounding, whatever the aspect ratio and the place: sums of tetrahedra without a
 * negative one.
 */
void rb_solid_measure(struct rb_solid *solid);

struct rb_particle {
	double mass;      /* kg */
	rb_vec3 position; /* m, object coordinates */
};

struct rb_particles {
	double mass;         /* kg */
	rb_vec3 center;      /* m */
	rb_mat3 inertia;     /* kg m^2 about the centre */
	double center_error; /* m: what sums of so many leave open in a coordinate of the centre */
};

/* What `count` > 0 rigidly joined points weigh together. */
struct rb_particles rb_particles_measure(const struct rb_particle *particles, size_t count);

/*
 * Whether the tensor of `count` particles says, to rounding, that they lie on one line or at one
 * point.
 */
bool rb_particles_in_line(const rb_mat3 *inertia, size_t count);

/* Ascending eigenvalues of a symmetric tensor (its lower half is not read). */
void rb_inertia_principal(const rb_mat3 *inertia, double moments[3]);

/* A multiple of 1 up to rounding. */
bool rb_inertia_is_scalar(const rb_mat3 *inertia);

/*
 * NULL where a rigid body of positive mass can have this tensor, else what is wrong with it: it
 * must be symmetric and positive, and no principal moment may exceed the sum of the other two,
 * each up to rounding.
 */
const char *rb_inertia_fault(const rb_mat3 *inertia);

#endif
