/* SPDX-License-Identifier: MIT */
#include "constraint/impulse.h"

#include <float.h>

#include "constraint/contact_row.h"
#include "constraint/eccentric.h"
#include "constraint/effective_mass.h"

static bool is_moving(const struct rb_world *world, int index)
{
	return index < world->model->body_count;
}

/* Adds the part of a body at that arm to K: 1/m - [r] I^-1 [r]. */
static void add_inverse_mass(const struct rb_world *world, const struct rb_state *state, int i,
                             rb_vec3 arm, rb_mat3 *k)
{
	const rb_vec3 *const axis = rb_effective_mass_world;
	rb_vec3 spin[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};

	for (int c = 0; c < 3 && state->spin; c++)
		spin[c] = rb_world_turn(world, state, i, rb_vec3_cross(arm, axis[c]));
	rb_effective_mass_add_spins(world->model->inverse_mass[i], arm, axis, spin, k);
}

/*
 * Adds the body's normal and tangential inverse effective masses; false unless its contact is
 * central and its inertia isotropic.
 */
static bool central_inverse_mass(const struct rb_world *world, const struct rb_state *state, int i,
                                 double *along, double *across)
{
	const struct rb_model *model = world->model;

	if (!is_moving(world, i))
		return true;
	*along += model->inverse_mass[i];
	*across += model->inverse_mass[i];
	if (!state->spin)
		return true;
	if (isnan(model->inverse_inertia_scalar[i]))
		return false;
	if (model->center_of_mass) {
		const rb_vec3 c = model->center_of_mass[i];

		if (c.x != 0 || c.y != 0 || c.z != 0)
			return false;
	}
	*across += model->shape[i].radius * model->shape[i].radius *
	           model->inverse_inertia_scalar[i];
	return true;
}

struct rb_link rb_link_of(const struct rb_world *world, const struct rb_state *state,
                          const struct rb_touch *touch, const struct rb_gap *gap)
{
	const struct rb_model *model = world->model;
	const struct rb_pair_material *pair = rb_contact_material(model, touch->a, touch->b);
	struct rb_link link = {.a = touch->a,
	                       .b = touch->b,
	                       .normal = gap->normal,
	                       .friction = pair->friction,
	                       .restitution = pair->restitution};

	link.arm_a = rb_vec3_sub(gap->point, rb_world_row3(state->position, touch->a));
	if (is_moving(world, touch->b))
		link.arm_b = rb_vec3_sub(gap->point, rb_world_row3(state->position, touch->b));

	link.inverse_mass_a = model->inverse_mass[link.a];
	link.inverse_mass_b = is_moving(world, link.b) ? model->inverse_mass[link.b] : 0;
	if (state->spin) {
		link.inverse_inertia_a = model->inverse_inertia_scalar[link.a];
		link.inverse_inertia_b = is_moving(world, link.b)
		                                 ? model->inverse_inertia_scalar[link.b]
		                                 : 0;
	}
	link.central = central_inverse_mass(world, state, link.a, &link.normal_inverse_mass,
	                                    &link.tangent_inverse_mass) &&
	               central_inverse_mass(world, state, link.b, &link.normal_inverse_mass,
	                                    &link.tangent_inverse_mass);
	if (link.central) {
		/*
		 * a sphere's arm is its radius along the normal, independent of the gap (within the
		 * tolerance)
		 */
		link.arm_a = rb_vec3_scale(model->shape[link.a].radius, link.normal);
		if (is_moving(world, link.b))
			link.arm_b = rb_vec3_scale(-model->shape[link.b].radius, link.normal);
		return link;
	}
	add_inverse_mass(world, state, link.a, link.arm_a, &link.inverse_effective_mass);
	if (is_moving(world, link.b))
		add_inverse_mass(world, state, link.b, link.arm_b, &link.inverse_effective_mass);
	link.normal_inverse_mass = rb_vec3_dot(
		link.normal, rb_mat3_apply(&link.inverse_effective_mass, link.normal));
	link.tangent_inverse_mass = rb_effective_mass_tangent(&link.inverse_effective_mass,
	                                                      link.normal);
	return link;
}

static inline rb_vec3 velocity_at(const struct rb_state *state, int i, rb_vec3 arm)
{
	const rb_vec3 v = rb_world_row3(state->velocity, i);

	return state->spin ? rb_vec3_add(v, rb_vec3_cross(rb_world_row3(state->spin, i), arm)) : v;
}

rb_vec3 rb_link_velocity(const struct rb_world *world, const struct rb_state *state,
                         const struct rb_link *link)
{
	const rb_vec3 of_a = velocity_at(state, link->a, link->arm_a);

	return is_moving(world, link->b)
	               ? rb_vec3_sub(velocity_at(state, link->b, link->arm_b), of_a)
	               : rb_vec3_neg(of_a);
}

static double speed_bound(const struct rb_world *world, int i, rb_vec3 arm)
{
	const struct rb_state *state = &world->state;

	if (!is_moving(world, i))
		return 0;
	double speed = rb_vec3_max_abs(rb_world_row3(state->velocity, i));
	if (state->spin)
		speed += rb_vec3_max_abs(rb_world_row3(state->spin, i)) * rb_vec3_max_abs(arm);
	return speed;
}

double rb_link_noise(const struct rb_world *world, const struct rb_link *link)
{
	return 8 * DBL_EPSILON *
	       (speed_bound(world, link->a, link->arm_a) +
	        speed_bound(world, link->b, link->arm_b));
}

/* The hot path of every iteration; inverse mass and inertia come with the link. */
static inline void apply_to_body(struct rb_world *world, int i, double inverse_mass,
                                 double inverse_inertia, rb_vec3 arm, rb_vec3 impulse)
{
	double *const v = world->state.velocity + 3 * (size_t)i;

	v[0] += inverse_mass * impulse.x;
	v[1] += inverse_mass * impulse.y;
	v[2] += inverse_mass * impulse.z;
	if (inverse_inertia == 0)
		return;
	const rb_vec3 torque = rb_vec3_cross(arm, impulse);
	const rb_vec3 turn = isnan(inverse_inertia) ? rb_world_turn(world, &world->state, i, torque)
	                                            : rb_vec3_scale(inverse_inertia, torque);
	double *const w = world->state.spin + 3 * (size_t)i;

	w[0] += turn.x;
	w[1] += turn.y;
	w[2] += turn.z;
}

void rb_link_apply(struct rb_world *world, const struct rb_link *link, rb_vec3 impulse)
{
	apply_to_body(world, link->a, link->inverse_mass_a, link->inverse_inertia_a, link->arm_a,
	              rb_vec3_neg(impulse));
	if (link->inverse_mass_b > 0)
		apply_to_body(world, link->b, link->inverse_mass_b, link->inverse_inertia_b,
		              link->arm_b, impulse);
}

/* The part of u across the normal. */
static rb_vec3 across(const struct rb_link *link, rb_vec3 u)
{
	return rb_vec3_add_scaled(u, -rb_vec3_dot(u, link->normal), link->normal);
}

/* Shortens the vector to the length `max` if it is longer: the circular friction cone. */
static rb_vec3 within(rb_vec3 tangent, double max)
{
	const double length = rb_vec3_length(tangent);

	return length > max ? rb_vec3_scale(max / length, tangent) : tangent;
}

rb_vec3 rb_link_impact(const struct rb_link *link, rb_vec3 velocity, double target_velocity)
{
	const double approach = -rb_vec3_dot(velocity, link->normal);

	if (!link->central && link->friction > 0) {
		const struct rb_eccentric contact = {link->inverse_effective_mass, link->normal,
		                                     link->friction, target_velocity / approach,
		                                     link->inverse_effective_mass_error};

		return rb_eccentric_impulse(&contact, velocity);
	}
	const double normal = (target_velocity + approach) / link->normal_inverse_mass;
	if (!(link->friction > 0))
		return rb_vec3_scale(normal, link->normal);
	const rb_vec3 stick = rb_vec3_scale(-1 / link->tangent_inverse_mass,
	                                    across(link, velocity));
	return rb_vec3_add_scaled(within(stick, link->friction * normal), normal, link->normal);
}

/* For a central contact, normal and friction impulses are independent: one after the other. */
static rb_vec3 central_impulse(const struct rb_impulse_row *row, rb_vec3 u)
{
	const struct rb_link *link = &row->link;
	/*
	 * the sum is clamped, not the increment: a later sweep may reduce an impulse that is too
	 * large
	 */
	const double normal = fmax(
		0, row->normal + (row->target_velocity - rb_vec3_dot(u, link->normal)) /
					 link->normal_inverse_mass);
	rb_vec3 tangent = {0, 0, 0};

	if (link->friction > 0)
		tangent = within(rb_vec3_add_scaled(row->tangent, -1 / link->tangent_inverse_mass,
		                                    across(link, u)),
		                 link->friction * normal);
	return rb_vec3_add_scaled(tangent, normal, link->normal);
}

/*
 * For an eccentric contact, the impulse that by itself brings the relative velocity `free` to the
 * target: sticking if the cone allows that, otherwise sliding, with friction opposite to the
 * remaining slip (damped fixed point of its direction). Where friction would make the bodies
 * approach faster than the impulse separates them (Painleve): the sticking impulse, limited to the
 * cone.
 */
static rb_vec3 eccentric_impulse(const struct rb_link *link, rb_vec3 free, double target_velocity)
{
	const double missing = target_velocity - rb_vec3_dot(free, link->normal);
	rb_mat3 inverse;

	if (missing <= 0)
		return (rb_vec3){0, 0, 0};
	if (!(link->friction > 0) || !rb_mat3_inverse(&link->inverse_effective_mass, &inverse))
		return rb_vec3_scale(missing / link->normal_inverse_mass, link->normal);
	const rb_vec3 stick = rb_mat3_apply(
		&inverse, rb_vec3_sub(rb_vec3_scale(target_velocity, link->normal), free));
	const double stick_normal = rb_vec3_dot(stick, link->normal);
	const rb_vec3 stick_tangent = across(link, stick);
	if (stick_normal >= 0 && rb_vec3_length(stick_tangent) <= link->friction * stick_normal)
		return stick;

	rb_vec3 along = rb_vec3_unit(
		across(link, free),
		rb_vec3_unit(rb_vec3_neg(stick_tangent), rb_vec3_across(link->normal)));
	for (int round = 0; round < 64; round++) {
		const rb_vec3 d = rb_vec3_add_scaled(link->normal, -link->friction, along);
		const rb_vec3 kd = rb_mat3_apply(&link->inverse_effective_mass, d);
		const double inverse_effective_mass = rb_vec3_dot(kd, link->normal);

		if (!(inverse_effective_mass > 1e-3 * link->normal_inverse_mass))
			break;
		const rb_vec3 slip = across(
			link, rb_vec3_add_scaled(free, missing / inverse_effective_mass, kd));
		const rb_vec3 next = rb_vec3_unit(rb_vec3_add(along, rb_vec3_unit(slip, along)),
		                                  along);
		const bool converged = rb_vec3_length(rb_vec3_sub(next, along)) <= 1e-13;

		along = next;
		if (converged || round == 63)
			return rb_vec3_scale(missing / inverse_effective_mass, d);
	}
	const double normal = fmax(stick_normal, missing / link->normal_inverse_mass);
	return rb_vec3_add_scaled(within(stick_tangent, link->friction * normal), normal,
	                          link->normal);
}

/* Solves a single row; returns the change of its velocity. */
static double solve_row(struct rb_world *world, struct rb_impulse_row *row)
{
	const struct rb_link *link = &row->link;
	const rb_vec3 u = rb_link_velocity(world, &world->state, link);
	const rb_vec3 before = rb_vec3_add_scaled(row->tangent, row->normal, link->normal);
	const rb_vec3 after =
		link->central ? central_impulse(row, u)
			      : eccentric_impulse(
					link,
					rb_vec3_sub(u, rb_mat3_apply(&link->inverse_effective_mass,
	                                                             before)),
					row->target_velocity);

	row->normal = rb_vec3_dot(after, link->normal);
	row->tangent = rb_vec3_add_scaled(after, -row->normal, link->normal);
	row->change = rb_vec3_sub(after, before);
	rb_link_apply(world, link, row->change);
	return rb_vec3_length(row->change) *
	       fmax(link->normal_inverse_mass, link->tangent_inverse_mass);
}

/*
 * Adds `share` of each row's direction to its impulse; the sweep that follows projects it back to
 * the cone.
 */
static void extrapolate(struct rb_world *world, struct rb_impulse_row *row, int count, double share)
{
	for (int k = 0; k < count; k++) {
		const rb_vec3 extra = rb_vec3_scale(share, row[k].direction);
		const double normal = rb_vec3_dot(extra, row[k].link.normal);

		row[k].normal += normal;
		row[k].tangent = rb_vec3_add(
			row[k].tangent, rb_vec3_add_scaled(extra, -normal, row[k].link.normal));
		rb_link_apply(world, &row[k].link, extra);
	}
}

/* Work of a row per sweep, in multiplications, about. */
enum { SWEEP_WORK = 256 };

/* Iterates on the rows; `*diverged`: the impulses grow without bound. */
static double iterate(struct rb_world *world, struct rb_impulse_row *row, int count, int sweeps,
                      double tolerance, bool *diverged)
{
	enum { FIRST = 8 };
	double change = 0, size = 0, size_before = 0, largest = 0;

	for (int sweep = 0; sweep < sweeps; sweep++) {
		change = size = 0;
		for (int k = 0; k < count; k++) {
			change = fmax(change, solve_row(world, &row[k]));
			size += row[k].link.normal_inverse_mass *
			        rb_vec3_dot(row[k].change, row[k].change);
		}
		if (change <= tolerance ||
		    rb_interrupt_after(&world->interrupt, SWEEP_WORK * (uint64_t)count))
			break;
		if (sweep < FIRST)
			largest = fmax(largest, change);
		*diverged = !(size < HUGE_VAL) || (sweep >= FIRST && change > 100 * largest) ||
		            (sweep + 1 == sweeps && change > 0.5 * largest);
		if (*diverged)
			break;
		/*
		 * a single row is exact after a sweep, and the last sweep must not be followed by
		 * an extrapolation; restarts where the change grew
		 */
		const double share = sweep > 0 && size <= size_before ? size / size_before : 0;
		if (count > 1 && share > 0 && sweep + 1 < sweeps)
			extrapolate(world, row, count, share);
		for (int k = 0; k < count; k++)
			row[k].direction = rb_vec3_add_scaled(row[k].change, share,
			                                      row[k].direction);
		size_before = size;
	}
	return change;
}

double rb_impulse_rows_solve(struct rb_world *world, struct rb_impulse_row *row, int count,
                             int sweeps, double tolerance)
{
	double change = 0;

	for (int round = 0; round < 4; round++) {
		bool diverged = false;

		change = iterate(world, row, count, sweeps, tolerance, &diverged);
		if (!diverged)
			break;
		/*
		 * a body jammed between others by friction (Painleve): retry with half the
		 * friction, at last without
		 */
		for (int k = 0; k < count; k++) {
			rb_link_apply(world, &row[k].link,
			              rb_vec3_neg(rb_vec3_add_scaled(row[k].tangent, row[k].normal,
			                                             row[k].link.normal)));
			row[k].normal = 0;
			row[k].tangent = row[k].direction = (rb_vec3){0, 0, 0};
			row[k].link.friction = round < 2 ? 0.5 * row[k].link.friction : 0;
		}
	}
	return change;
}
