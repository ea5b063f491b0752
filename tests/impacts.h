/* SPDX-License-Identifier: MIT */
/* Random eccentric impacts of boxes, cylinders, capsules and hulls: by the program, and by tests/keller.h. */
#ifndef RB_TESTS_IMPACTS_H
#define RB_TESTS_IMPACTS_H

#include <stdlib.h>

#include "constraint/simultaneous.h"
#include "geom/hull.h"
#include "geom/mass.h"
#include "model/shape.h"
#include "keller.h"
#include "math/random.h"

static const enum rb_shape_kind impacts_shapes[] = {RB_SHAPE_BOX, RB_SHAPE_CYLINDER,
                                                    RB_SHAPE_CAPSULE, RB_SHAPE_HULL};
static const char *const impacts_names[] = {"boxes", "cylinders", "capsules", "hulls"};
enum { IMPACTS_SHAPES = 4, IMPACTS_POINTS = 12 };

/* A series of numbers in [0, 1). */
struct impacts_series {
	uint64_t stream, next;
};

static inline double impacts_in(struct impacts_series *r, double low, double high)
{
	return low + (high - low) * rb_random_unit(20261122, r->stream, r->next++);
}

static inline double impacts_decades(struct impacts_series *r, double low, double high)
{
	return pow(10, impacts_in(r, low, high));
}

static inline rb_vec3 impacts_vector(struct impacts_series *r)
{
	const double x = impacts_in(r, -1, 1), y = impacts_in(r, -1, 1), z = impacts_in(r, -1, 1);

	return (rb_vec3){x, y, z};
}

static inline double impacts_sign(struct impacts_series *r)
{
	return impacts_in(r, -1, 1) < 0 ? -1 : 1;
}

/* Moments and principal axes of a symmetric tensor, by Jacobi's rotations. */
static inline rb_quat impacts_principal(rb_mat3 a, double moment[3])
{
	rb_mat3 axes = rb_mat3_diagonal(1, 1, 1);

	for (int round = 0; round < 60; round++) {
		const int p = round % 3 == 2 ? 1 : 0, q = round % 3 == 0 ? 1 : 2;

		if (a.m[p][q] == 0)
			continue;
		const double angle = 0.5 * atan2(2 * a.m[p][q], a.m[q][q] - a.m[p][p]);
		rb_mat3 turn = rb_mat3_diagonal(1, 1, 1);
		turn.m[p][p] = turn.m[q][q] = cos(angle);
		turn.m[p][q] = sin(angle);
		turn.m[q][p] = -sin(angle);
		const rb_mat3 back = rb_mat3_transposed(&turn);
		const rb_mat3 half = rb_mat3_multiply(&a, &turn);
		a = rb_mat3_multiply(&back, &half);
		axes = rb_mat3_multiply(&axes, &turn);
	}
	for (int k = 0; k < 3; k++)
		moment[k] = a.m[k][k];
	return rb_quat_unit(rb_quat_from_mat3(&axes));
}

/* A body of this shape, turned somehow; `out`: the direction (world) in which the contact lies. */
static inline struct keller_body impacts_body(struct impacts_series *r, enum rb_shape_kind kind,
                                              rb_vec3 out)
{
	struct keller_body body = {
		.orientation = rb_quat_unit((rb_quat){impacts_in(r, -1, 1), impacts_in(r, -1, 1),
	                                              impacts_in(r, -1, 1), impacts_in(r, -1, 1)})};
	const double mass = impacts_decades(r, -3, 3), size = impacts_decades(r, -2, 1);
	const rb_vec3 own = rb_quat_rotate_back(body.orientation, out);
	struct rb_shape shape = {.kind = kind};
	rb_mat3 inertia;
	rb_vec3 arm;

	for (int k = 0; k < 3; k++)
		shape.size[k] = size * impacts_decades(r, -1, 0.3);
	shape.radius = size * impacts_decades(r, -1.3, 0.3);
	if (kind == RB_SHAPE_BOX) {
		/* a corner; of every fourth a point within an edge or a face */
		const double part[2] = {impacts_in(r, -1, 1), impacts_in(r, -1, 1)};
		const bool corner = impacts_in(r, 0, 1) < 0.75;
		arm = (rb_vec3){copysign(0.5 * shape.size[0], own.x),
		                copysign(0.5 * shape.size[1], own.y),
		                copysign(0.5 * shape.size[2], own.z)};
		arm.x *= corner ? 1 : part[0];
		arm.y *= corner ? 1 : part[1];
	} else if (kind == RB_SHAPE_CYLINDER) {
		const double off = hypot(own.x, own.y);
		const double up = impacts_in(r, 0, 1) < 0.75 ? 1 : impacts_in(r, 0, 1);
		arm = (rb_vec3){shape.radius * own.x / off, shape.radius * own.y / off,
		                copysign(0.5 * up * shape.size[2], own.z)};
	} else if (kind == RB_SHAPE_CAPSULE) {
		arm = rb_vec3_add(rb_vec3_scale(shape.radius, own),
		                  (rb_vec3){0, 0, copysign(0.5 * shape.size[2], own.z)});
	}
	if (kind == RB_SHAPE_HULL) {
		rb_vec3 points[IMPACTS_POINTS];
		struct rb_hull hull;
		struct rb_error err;
		rb_quat axes;

		for (int k = 0; k < IMPACTS_POINTS; k++) {
			const rb_vec3 p = impacts_vector(r);
			points[k] = (rb_vec3){shape.size[0] * p.x, shape.size[1] * p.y,
			                      shape.size[2] * p.z};
		}
		if (rb_hull_make(&hull, points, IMPACTS_POINTS, &err) != RB_OK)
			abort();
		struct rb_solid solid = {.vertices = hull.vertices,
		                         .loops = hull.loops,
		                         .face_first = hull.face_first,
		                         .edges = (const int(*)[2])hull.edges,
		                         .vertex_count = hull.vertex_count,
		                         .face_count = hull.face_count,
		                         .edge_count = hull.edge_count};
		rb_solid_measure(&solid);
		inertia = rb_shape_inertia(&solid, &shape, mass);
		arm = hull.vertices[0];
		for (int k = 1; k < hull.vertex_count; k++)
			if (rb_vec3_dot(hull.vertices[k], own) > rb_vec3_dot(arm, own))
				arm = hull.vertices[k];
		arm = rb_quat_rotate(body.orientation, rb_vec3_sub(arm, solid.centroid));
		axes = impacts_principal(inertia, body.moment);
		body.orientation = rb_quat_unit(rb_quat_multiply(body.orientation, axes));
		rb_hull_release(&hull);
	} else {
		inertia = rb_shape_inertia(NULL, &shape, mass);
		for (int k = 0; k < 3; k++)
			body.moment[k] = inertia.m[k][k];
		arm = rb_quat_rotate(body.orientation, arm);
	}
	body.inverse_mass = 1 / mass;
	body.arm = arm;
	body.linear = impacts_vector(r);
	body.angular = rb_vec3_scale(impacts_in(r, 0, 2) / rb_vec3_length(arm), impacts_vector(r));
	return body;
}

static inline rb_vec3 impacts_velocity(const struct keller_impact *impact)
{
	const struct keller_body *a = &impact->body[0], *b = &impact->body[1];

	return rb_vec3_sub(rb_vec3_add(b->linear, rb_vec3_cross(b->angular, b->arm)),
	                   rb_vec3_add(a->linear, rb_vec3_cross(a->angular, a->arm)));
}

/* Gives b the linear velocity with which the points have this relative one. */
static inline void impacts_set(struct keller_impact *impact, rb_vec3 wanted)
{
	impact->body[1].linear = rb_vec3_add(impact->body[1].linear,
	                                     rb_vec3_sub(wanted, impacts_velocity(impact)));
}

/*
 * The k-th impact of bodies of this kind with a fixed one or with each other: friction 0 to 5 (every sixth in small
 * decades), restitution 0 to 1 with both ends, slip at random, none, hardly any, or against what friction would have it be:
 * there it comes to nothing or nearly so.
 */
static inline struct keller_impact impacts_pick(int shape, uint64_t k)
{
	struct impacts_series r = {.stream = 1000003u * (unsigned)shape + k};
	struct keller_impact impact = {.body[0].orientation = {1, 0, 0, 0},
	                               .body[0].moment = {1, 1, 1}};
	const int kind = (int)(k % 8);

	impact.normal = rb_vec3_unit(impacts_vector(&r), (rb_vec3){0, 0, 1});
	impact.body[1] = impacts_body(&r, impacts_shapes[shape], rb_vec3_neg(impact.normal));
	if (impacts_in(&r, 0, 1) < 0.5)
		impact.body[0] = impacts_body(&r, impacts_shapes[shape], impact.normal);
	impact.friction = impacts_in(&r, 0, 1) < 1.0 / 6
	                          ? impacts_decades(&r, -3, 0)
	                          : impacts_in(&r, 0, 1) * impacts_decades(&r, -1, 0.7);
	const double e = impacts_in(&r, -0.2, 1.2);
	impact.restitution = e < 0 ? 0 : e > 1 ? 1 : e;
	rb_vec3 u = impacts_velocity(&impact);
	if (rb_vec3_dot(u, impact.normal) > 0)
		u = rb_vec3_add_scaled(u, -2 * rb_vec3_dot(u, impact.normal), impact.normal);
	const rb_vec3 slip = rb_vec3_reject(u, impact.normal);
	u = rb_vec3_scale(rb_vec3_dot(u, impact.normal), impact.normal);
	if (kind == 5 || kind == 6) {
		/* friction that presses harder together than the contact yields, from the start or as slip turns */
		struct keller p;
		keller_begin(&p, &impact);
		const double cross = (double)hypotl(p.k[0][1], p.k[0][2]);
		const double least = fmin((double)p.k[0][0] / cross, 1e3);
		const double above = impacts_decades(&r, 0, 0.7);
		const double aside = kind == 5 ? impacts_in(&r, 0, 1.5)
		                               : acos((1 - impacts_decades(&r, -3, 0)) / above);
		const double angle = atan2((double)p.k[0][2], (double)p.k[0][1]) +
		                     impacts_sign(&r) * aside;
		const double c = cos(angle), s = sin(angle);
		const real *const first = p.axis[1], *const second = p.axis[2];
		rb_vec3 way = {(double)(first[0] * (real)c + second[0] * (real)s),
		               (double)(first[1] * (real)c + second[1] * (real)s),
		               (double)(first[2] * (real)c + second[2] * (real)s)};
		impact.friction = least * above;
		u = rb_vec3_add_scaled(rb_vec3_scale(impacts_decades(&r, -3, 0), u),
		                       rb_vec3_length(slip), way);
	} else if (kind == 1) {
		/* none */
	} else if (kind == 2) {
		u = rb_vec3_add_scaled(u, impacts_decades(&r, -14, 0), slip);
	} else if (kind == 3) {
		/* along a direction that repels, but for a little */
		struct keller p;
		keller_begin(&p, &impact);
		const double angle = atan2((double)-p.k[2][0], (double)-p.k[1][0]) +
		                     impacts_sign(&r) * impacts_decades(&r, -14, -1);
		const double c = cos(angle), s = sin(angle);
		const real *const first = p.axis[1], *const second = p.axis[2];
		rb_vec3 way = {(double)(first[0] * (real)c + second[0] * (real)s),
		               (double)(first[1] * (real)c + second[1] * (real)s),
		               (double)(first[2] * (real)c + second[2] * (real)s)};
		u = rb_vec3_add_scaled(u, rb_vec3_length(slip), way);
	} else {
		u = rb_vec3_add_scaled(u, kind == 4 ? impacts_decades(&r, 0, 3) : 1, slip);
	}
	impacts_set(&impact, u);
	return impact;
}

static inline double impacts_off(struct impacts_series *r, double x, double share)
{
	return x * (1 + share * impacts_in(r, -1, 1));
}

static inline rb_vec3 impacts_off3(struct impacts_series *r, rb_vec3 v, double share)
{
	return rb_vec3_add_scaled(v, share * rb_vec3_length(v), impacts_vector(r));
}

/* All that goes in, off by this share of its size. */
static inline struct keller_impact impacts_perturbed(const struct keller_impact *impact,
                                                     struct impacts_series *r, double share)
{
	struct keller_impact p = *impact;

	for (int side = 0; side < 2; side++) {
		struct keller_body *const b = &p.body[side];
		const rb_quat q = b->orientation;

		b->inverse_mass = impacts_off(r, b->inverse_mass, share);
		for (int k = 0; k < 3; k++)
			b->moment[k] = impacts_off(r, b->moment[k], share);
		b->orientation = rb_quat_unit((rb_quat){
			q.w + share * impacts_in(r, -1, 1), q.x + share * impacts_in(r, -1, 1),
			q.y + share * impacts_in(r, -1, 1), q.z + share * impacts_in(r, -1, 1)});
		b->arm = impacts_off3(r, b->arm, share);
		b->linear = impacts_off3(r, b->linear, share);
		b->angular = impacts_off3(r, b->angular, share);
	}
	p.normal = rb_vec3_unit(impacts_off3(r, p.normal, share), p.normal);
	p.friction = impacts_off(r, p.friction, share);
	p.restitution = fmin(1, impacts_off(r, p.restitution, share));
	return p;
}

static inline struct rb_solver_body impacts_joint_body(const struct keller_body *body,
                                                       rb_mat3 *root)
{
	struct rb_solver_body out = {.inverse_mass = body->inverse_mass,
	                             .linear = body->linear,
	                             .angular = body->angular};

	if (!(body->inverse_mass > 0))
		return out;
	const rb_mat3 axes = rb_quat_to_mat3(body->orientation);
	out.inverse_inertia = (double)NAN;
	for (int k = 0; k < 3; k++)
		for (int x = 0; x < 3; x++)
			root->m[k][x] = axes.m[x][k] / sqrt(body->moment[k]);
	return out;
}

/* The same by the program; `after`: bodies, or NULL. */
static inline rb_vec3 impacts_program(const struct keller_impact *impact,
                                      struct rb_solver_body *after)
{
	struct rb_arena arena = {0};
	rb_mat3 root[2];
	struct rb_solver_body body[2] = {impacts_joint_body(&impact->body[0], &root[0]),
	                                 impacts_joint_body(&impact->body[1], &root[1])};
	struct rb_solver_contact contact = {.a = 0,
	                                    .b = 1,
	                                    .normal = impact->normal,
	                                    .arm_a = impact->body[0].arm,
	                                    .arm_b = impact->body[1].arm,
	                                    .friction = impact->friction,
	                                    .restitution = impact->restitution};
	struct rb_simultaneous joint = {.body = body,
	                                .root = root,
	                                .body_count = 2,
	                                .contact = &contact,
	                                .contact_count = 1,
	                                .arena = &arena};

	rb_simultaneous_impact(&joint, NULL);
	rb_arena_release(&arena);
	if (after)
		memcpy(after, body, sizeof body);
	return contact.impulse;
}

struct impacts_check {
	double error;     /* of the impulse, of its size */
	double condition; /* change of the impulse per change of what goes in, at least 1 */
	double gain;      /* of kinetic energy, of the impulse times velocities */
	struct keller reference;
};

static inline real impacts_distance(const real *a, const real *b)
{
	const real d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};

	return sqrtl(keller_dot(d, d));
}

/* False: no reference. */
static inline bool impacts_check(int shape, uint64_t k, int perturbed, struct impacts_check *out)
{
	const double share = 1e-8;
	const struct keller_impact impact = impacts_pick(shape, k);
	struct impacts_series r = {.stream = ~k};
	real wanted[3], other[3], found[3], change[3], u[3];
	struct keller p;

	if (!keller_solve(&out->reference, &impact, wanted))
		return false;
	keller_vector(impacts_program(&impact, NULL), found);
	const real size = sqrtl(keller_dot(wanted, wanted));
	out->error = (double)(impacts_distance(wanted, found) / size);
	out->condition = 1;
	for (int n = 0; n < perturbed; n++) {
		const struct keller_impact off = impacts_perturbed(&impact, &r, share);

		if (!keller_solve(&p, &off, other))
			return false;
		out->condition = fmax(out->condition,
		                      (double)(impacts_distance(wanted, other) / size) / share);
	}
	/* J.(u + K J / 2) */
	for (int i = 0; i < 3; i++) {
		u[i] = keller_dot(out->reference.axis[i], found);
		change[i] = 0;
	}
	real work = 0, parts = 0;
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++)
			change[i] += out->reference.k[i][j] * u[j];
		work += u[i] * (out->reference.u[i] + change[i] / 2);
		parts += fabsl(u[i] * out->reference.u[i]) + fabsl(u[i] * change[i] / 2);
	}
	out->gain = (double)(work / parts);
	return true;
}

#endif
