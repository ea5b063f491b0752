/* SPDX-License-Identifier: MIT */
/* Small problems of several contacts at one moment, and what is measured on them. */
#ifndef RB_TESTS_PILES_H
#define RB_TESTS_PILES_H

#include "support.h"

#include "constraint/simultaneous_forces.h"

/* One problem: bodies with places, contacts of spheres and of spheres with planes. Body 0 is what does not yield. */
struct pile {
	struct rb_simultaneous joint;
	struct rb_arena arena;
	rb_vec3 *place;
	double *radius;
	rb_mat3 *root; /* of inverse inertias */
	int body_room, contact_room;
};

static inline void pile_open(struct pile *p, int bodies, int contacts)
{
	*p = (struct pile){.body_room = bodies + 1, .contact_room = contacts};
	p->joint.body = calloc((size_t)bodies + 1, sizeof *p->joint.body);
	p->joint.contact = calloc((size_t)contacts + 1, sizeof *p->joint.contact);
	p->place = calloc((size_t)bodies + 1, sizeof *p->place);
	p->radius = calloc((size_t)bodies + 1, sizeof *p->radius);
	p->joint.root = p->root = calloc((size_t)bodies + 1, sizeof *p->root);
	assert_true(p->joint.body && p->joint.contact && p->place && p->radius && p->root);
	p->joint.body_count = 1;
}

static inline void pile_close(struct pile *p)
{
	free(p->joint.body);
	free(p->joint.contact);
	free(p->place);
	free(p->radius);
	free(p->root);
	rb_arena_release(&p->arena);
}

static inline int ball(struct pile *p, double radius, double mass, rb_vec3 place, rb_vec3 velocity)
{
	const int i = p->joint.body_count++;

	assert_true(i < p->body_room);
	p->joint.body[i] = (struct rb_solver_body){.inverse_mass = 1 / mass,
	                                           .inverse_inertia = 2.5 /
	                                                              (mass * radius * radius),
	                                           .linear = velocity};
	p->place[i] = place;
	p->radius[i] = radius;
	return i;
}

static inline struct rb_solver_contact *add_contact(struct pile *p, struct rb_solver_contact c)
{
	assert_true(p->joint.contact_count < p->contact_room);
	p->joint.contact[p->joint.contact_count] = c;
	return &p->joint.contact[p->joint.contact_count++];
}

static inline struct rb_solver_contact *touch(struct pile *p, int a, int b, double friction,
                                              double restitution)
{
	const rb_vec3 n = rb_vec3_unit(rb_vec3_sub(p->place[b], p->place[a]), (rb_vec3){0, 0, 1});

	return add_contact(p, (struct rb_solver_contact){.a = a,
	                                                 .b = b,
	                                                 .normal = n,
	                                                 .arm_a = rb_vec3_scale(p->radius[a], n),
	                                                 .arm_b = rb_vec3_scale(-p->radius[b], n),
	                                                 .friction = friction,
	                                                 .restitution = restitution});
}

/* A plane below the ball, if `up` is up. */
static inline struct rb_solver_contact *plane(struct pile *p, int a, rb_vec3 up, double friction,
                                              double restitution)
{
	return add_contact(p, (struct rb_solver_contact){.a = a,
	                                                 .b = 0,
	                                                 .normal = rb_vec3_neg(up),
	                                                 .arm_a = rb_vec3_scale(-p->radius[a], up),
	                                                 .friction = friction,
	                                                 .restitution = restitution});
}

static inline bool hit(struct pile *p, int *rounds)
{
	p->joint.arena = &p->arena;
	const bool settled = rb_simultaneous_impact(&p->joint, rounds);
	rb_arena_reset(&p->arena);
	return settled;
}

static inline double load(struct pile *p, rb_vec3 gravity)
{
	p->joint.arena = &p->arena;
	for (int i = 1; i < p->joint.body_count; i++)
		if (p->joint.body[i].inverse_mass > 0)
			p->joint.body[i].linear = rb_vec3_add(p->joint.body[i].linear, gravity);
	const double left = rb_simultaneous_forces(&p->joint);
	rb_arena_reset(&p->arena);
	return left;
}

static inline rb_vec3 velocity(const struct pile *p, int i)
{
	return p->joint.body[i].linear;
}

static inline rb_vec3 point_velocity(const struct pile *p, int i, rb_vec3 arm)
{
	return rb_vec3_add(p->joint.body[i].linear, rb_vec3_cross(p->joint.body[i].angular, arm));
}

static inline double largest_approach(const struct pile *p)
{
	double largest = 0;

	for (int k = 0; k < p->joint.contact_count; k++) {
		const struct rb_solver_contact *c = &p->joint.contact[k];
		const rb_vec3 u = rb_vec3_sub(point_velocity(p, c->b, c->arm_b),
		                              point_velocity(p, c->a, c->arm_a));

		largest = fmax(largest, -rb_vec3_dot(u, c->normal));
	}
	return largest;
}

/* How far the worst impulse is outside its cone, as a share of the largest impulse. */
static inline double cone_excess(const struct pile *p)
{
	double largest = 0, excess = 0;

	for (int k = 0; k < p->joint.contact_count; k++) {
		const struct rb_solver_contact *c = &p->joint.contact[k];
		const double n = rb_vec3_dot(c->impulse, c->normal);
		const rb_vec3 t = rb_vec3_add_scaled(c->impulse, -n, c->normal);

		largest = fmax(largest, rb_vec3_length(c->impulse));
		excess = fmax(excess, fmax(-n, rb_vec3_length(t) - c->friction * n));
	}
	return largest > 0 ? excess / largest : 0;
}

static inline double energy(const struct pile *p)
{
	double sum = 0;

	for (int i = 1; i < p->joint.body_count; i++) {
		const struct rb_solver_body *b = &p->joint.body[i];

		sum += rb_vec3_dot(b->linear, b->linear) / b->inverse_mass +
		       rb_vec3_dot(b->angular, b->angular) / b->inverse_inertia;
	}
	return 0.5 * sum;
}

static inline rb_vec3 momentum(const struct pile *p)
{
	rb_vec3 sum = {0, 0, 0};

	for (int i = 1; i < p->joint.body_count; i++)
		sum = rb_vec3_add_scaled(sum, 1 / p->joint.body[i].inverse_mass,
		                         p->joint.body[i].linear);
	return sum;
}

/* The largest speed or acceleration of anything that yields, of its surface too. */
static inline double fastest(const struct pile *p)
{
	double largest = 0;

	for (int i = 1; i < p->joint.body_count; i++) {
		const struct rb_solver_body *b = &p->joint.body[i];

		largest = fmax(largest, rb_vec3_length(b->linear));
		largest = fmax(largest, p->radius[i] * rb_vec3_length(b->angular));
	}
	return largest;
}

#endif
