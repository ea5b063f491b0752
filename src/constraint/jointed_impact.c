/* SPDX-License-Identifier: MIT */
#include "constraint/jointed_impact.h"

#include <string.h>

#include "constraint/coulomb.h"
#include "constraint/eccentric.h"

/* Largest residual of the joints, relative to the speeds: K is not accurate beyond it. */
static const double failed_share = 1e-11;
/* Relative error of K, and the least share of the free bodies' K along the normal. */
static const double effective_mass_error = 1e-10;
/* Approach afterwards, as a share of that before, that rounding may leave. */
static const double stopped_share = 1e-9;
enum { STOP_PASSES = 3 };

bool rb_jointed_impact_is_bilateral(const struct rb_cone_row *row)
{
	const struct rb_constraint *const base = &row->base;

	if (base->set == RB_CONSTRAINT_FREE)
		return true;
	return base->set == RB_CONSTRAINT_INTERVAL && base->softness == 0 && !row->given &&
	       base->low == -(double)INFINITY && base->high == (double)INFINITY;
}

static rb_vec3 velocity_of(const struct rb_cone *cone, const struct rb_link *link)
{
	return rb_vec3_sub(rb_solver_point_velocity(&cone->bodies.body[link->b], link->arm_b),
	                   rb_solver_point_velocity(&cone->bodies.body[link->a], link->arm_a));
}

/* Largest speed that an end of a joint or of the contact has by its bodies' velocities, m/s. */
static double largest_speed(const struct rb_cone *cone, const struct rb_link *link)
{
	const struct rb_solver_body *const body = cone->bodies.body;
	const struct rb_solver_body *const a = &body[link->a], *const b = &body[link->b];
	double largest = fmax(rb_vec3_length(a->linear) +
	                              rb_vec3_length(a->angular) * rb_vec3_length(link->arm_a),
	                      rb_vec3_length(b->linear) +
	                              rb_vec3_length(b->angular) * rb_vec3_length(link->arm_b));

	for (int k = 0; k < cone->row_count; k++) {
		const struct rb_constraint *const row = &cone->row[k].base;
		const int at[2] = {row->a, row->b};
		const double arm[2] = {rb_vec3_length(row->arm_a),
		                       rb_vec3_length(row->couple ? row->arm_a : row->arm_b)};

		for (int side = 0; side < 2; side++)
			largest = fmax(largest,
			               (row->couple ? 0 : rb_vec3_length(body[at[side]].linear)) +
			                       arm[side] * rb_vec3_length(body[at[side]].angular));
	}
	return largest;
}

static void apply(const struct rb_cone *cone, const struct rb_link *link, rb_vec3 impulse)
{
	rb_solver_apply(&cone->bodies, link->a, link->arm_a, rb_vec3_neg(impulse));
	rb_solver_apply(&cone->bodies, link->b, link->arm_b, impulse);
}

/* Joints keep their velocities; false: not within `failed_share`. */
static bool keep_joints(struct rb_cone *cone, const struct rb_link *link)
{
	const double scale = largest_speed(cone, link);

	return rb_cone_resolve(cone, scale) <= failed_share * scale;
}

static void clear_impulses(struct rb_cone *cone)
{
	for (int k = 0; k < cone->row_count; k++)
		rb_constraint_clear(&cone->row[k].base);
}

/*
 * Fills K with the responses to unit impulses from rest; changes velocities and impulses of rows.
 * False: the joints cannot be satisfied, or hold the contact along its normal.
 */
static bool fill_inverse_mass(struct rb_cone *cone, const struct rb_link *link, rb_mat3 *k)
{
	double along = 0;

	for (int e = 0; e < 3; e++) {
		const rb_vec3 unit = {e == 0, e == 1, e == 2};

		for (int i = 0; i < cone->body_count; i++)
			cone->bodies.body[i].linear = cone->bodies.body[i].angular = (rb_vec3){0, 0,
			                                                                       0};
		clear_impulses(cone);
		apply(cone, link, unit);
		along += rb_vec3_dot(unit, link->normal) *
		         rb_vec3_dot(velocity_of(cone, link), link->normal);
		if (!keep_joints(cone, link))
			return false;
		const rb_vec3 column = velocity_of(cone, link);
		k->m[0][e] = column.x;
		k->m[1][e] = column.y;
		k->m[2][e] = column.z;
	}
	return rb_vec3_dot(link->normal, rb_mat3_apply(k, link->normal)) >
	       effective_mass_error * along;
}

/* Targets and biases of the rows. */
struct kept {
	rb_along_across target;
	rb_vec3 bias;
};

static bool find_inverse_mass(struct rb_cone *cone, const struct rb_link *link, rb_mat3 *k)
{
	/* stays in the arena, as what eliminates the joints does, which is taken after it */
	struct kept *const kept = rb_arena_take(cone->arena, (size_t)cone->row_count, sizeof *kept);

	if (!kept)
		return false;
	for (int r = 0; r < cone->row_count; r++) {
		struct rb_cone_row *const row = &cone->row[r];

		kept[r] = (struct kept){row->base.target, row->bias};
		row->base.target = (rb_along_across){0, {0, 0, 0}};
		row->bias = (rb_vec3){0, 0, 0};
	}
	const bool found = fill_inverse_mass(cone, link, k);
	for (int r = 0; r < cone->row_count; r++) {
		cone->row[r].base.target = kept[r].target;
		cone->row[r].bias = kept[r].bias;
	}
	clear_impulses(cone);
	return found;
}

/*
 * Applies the impulse. Where it stops the contact, rounding may leave an approach; it is turned
 * into as slow a separation: bodies that stand still otherwise would hit each other again.
 */
static bool apply_and_stop(struct rb_cone *cone, const struct rb_link *link, double approach,
                           rb_vec3 *impulse)
{
	rb_vec3 more = *impulse;

	for (int pass = 0; pass < STOP_PASSES; pass++) {
		apply(cone, link, more);
		if (!keep_joints(cone, link))
			return false;
		const double left = rb_vec3_dot(velocity_of(cone, link), link->normal);

		if (!(left < 0 && left >= -stopped_share * approach))
			break;
		more = rb_vec3_scale(-2 * left / link->normal_inverse_mass, link->normal);
		*impulse = rb_vec3_add(*impulse, more);
	}
	return true;
}

bool rb_jointed_impact(struct rb_cone *cone, const struct rb_link *link, rb_vec3 velocity,
                       double noise, rb_vec3 *impulse)
{
	const size_t size = (size_t)cone->body_count * sizeof *cone->bodies.body;
	struct rb_solver_body *const before = rb_arena_take(cone->arena, (size_t)cone->body_count,
	                                                    sizeof *before);
	struct rb_link own = *link;
	bool solved = false;

	if (!before)
		return false;
	memcpy(before, cone->bodies.body, size);
	const bool found = find_inverse_mass(cone, link, &own.inverse_effective_mass);
	memcpy(cone->bodies.body, before, size);
	if (found) {
		own.central = false;
		own.inverse_effective_mass_error = effective_mass_error;
		own.normal_inverse_mass = rb_vec3_dot(
			own.normal, rb_mat3_apply(&own.inverse_effective_mass, own.normal));
		const double approach = -rb_vec3_dot(velocity, own.normal);

		*impulse = rb_link_impact(&own, velocity, own.restitution * approach);
		solved = apply_and_stop(cone, &own, approach, impulse) &&
		         rb_vec3_dot(velocity_of(cone, link), link->normal) >= -noise;
	}
	if (!solved) {
		memcpy(cone->bodies.body, before, size);
		clear_impulses(cone);
	}
	return solved;
}
