/* SPDX-License-Identifier: MIT */
/*
 * Checks after a frame rather than assertions in the passes, because they walk all rows and name
 * the body and the number that is wrong.
 */
#include "world/invariants.h"

#include "base/error.h"
#include "base/field_list.h"
#include "world/limits.h"

/*
 * Largest deviation of unit vectors and quaternions from length 1. A step normalizes what it makes
 * and leaves some roundings; the located method's dense output is off by the tolerance of a piece.
 */
static const double unit_error = 1e-9;

static bool is_finite_row(const double *row, int count)
{
	for (int k = 0; k < count; k++)
		if (!isfinite(row[k]))
			return false;
	return true;
}

static bool is_unit(rb_vec3 v)
{
	return fabs(rb_vec3_length(v) - 1) <= unit_error;
}

enum rb_status rb_validate_state(const struct rb_world *world, struct rb_error *err)
{
	const struct rb_state *const state = &world->state;

	if (!(state->time_s >= 0 && isfinite(state->time_s)))
		return RB_FAIL(err, RB_ERR_BUG, "the state's time is %g s", state->time_s);
	if (state->body_count != world->model->body_count)
		return RB_FAIL(err, RB_ERR_BUG, "a state of %d bodies of %d", state->body_count,
		               world->model->body_count);
	for (int i = 0; i < state->body_count; i++) {
		const size_t at = (size_t)i;

		if (!is_finite_row(state->position + 3 * at, 3) ||
		    !is_finite_row(state->velocity + 3 * at, 3))
			return RB_FAIL(err, RB_ERR_BUG,
			               "position or velocity of body %d is not finite", i);
		if (state->spin && !is_finite_row(state->spin + 3 * at, 3))
			return RB_FAIL(err, RB_ERR_BUG, "the spin of body %d is not finite", i);
		if (!state->orientation)
			continue;
		const double length = rb_quat_length(rb_quat_from(state->orientation + 4 * at));
		if (!(fabs(length - 1) <= unit_error))
			return RB_FAIL(err, RB_ERR_BUG,
			               "the orientation of body %d has the length %.17g", i,
			               length);
	}
	return RB_OK;
}

/* RB_ERR_BUG, with the field, unless all fields of all objects are in the ranges of their list. */
static enum rb_status validate_fields(const struct rb_world *world, const char *what,
                                      const struct rb_fields *fields, const void *objects,
                                      size_t count, struct rb_error *err)
{
	const struct rb_limits limits = rb_limits_of(world->model);
	size_t which = 0;
	const struct rb_field *const bad = rb_fields_bad(fields, objects, count, limits.high,
	                                                 &which);

	return bad ? RB_FAIL(err, RB_ERR_BUG, "%s %zu of %zu: '%s' is out of its range", what,
	                     which, count, bad->name)
	           : RB_OK;
}

/*
 * One contact: bodies, place, and a force within the friction cone's geometry (pushing,
 * tangential).
 */
static enum rb_status validate_contact(const struct rb_world *world, const struct rb_contact *c,
                                       struct rb_error *err)
{
	if (c->b <= c->a)
		return RB_FAIL(err, RB_ERR_BUG, "a contact of bodies %d and %d, of %d", c->a, c->b,
		               world->model->body_count);
	if (!is_unit(c->normal))
		return RB_FAIL(err, RB_ERR_BUG,
		               "the normal of bodies %d and %d has the length %.17g", c->a, c->b,
		               rb_vec3_length(c->normal));
	if (!(c->normal_force >= 0))
		return RB_FAIL(err, RB_ERR_BUG, "bodies %d and %d pull at each other, with %g N",
		               c->a, c->b, c->normal_force);
	const double across = fabs(rb_vec3_dot(c->tangent_force, c->normal));
	if (!(across <= unit_error * (c->normal_force + rb_vec3_length(c->tangent_force))))
		return RB_FAIL(err, RB_ERR_BUG,
		               "friction of bodies %d and %d has %g N along the normal", c->a, c->b,
		               across);
	return RB_OK;
}

enum rb_status rb_validate_contacts(const struct rb_world *world,
                                    const struct rb_contacts *contacts, struct rb_error *err)
{
	enum rb_status status = RB_OK;

	if (contacts->count > contacts->capacity)
		return RB_FAIL(err, RB_ERR_BUG, "%zu contacts in room for %zu", contacts->count,
		               contacts->capacity);
	status = validate_fields(world, "contact", rb_contact_fields(), contacts->row,
	                         contacts->count, err);
	for (size_t k = 0; k < contacts->count && status == RB_OK; k++) {
		const struct rb_contact *const c = &contacts->row[k];

		status = validate_contact(world, c, err);
		if (status == RB_OK && k > 0 &&
		    (c[-1].a > c->a || (c[-1].a == c->a && c[-1].b > c->b)))
			status = RB_FAIL(err, RB_ERR_BUG,
			                 "contacts are not sorted: %d and %d after %d and %d", c->a,
			                 c->b, c[-1].a, c[-1].b);
	}
	return status;
}

/* False if energies and momenta may overflow, of which a run is told, but does not end. */
static bool has_energies(const struct rb_world *world)
{
	const struct rb_state *const state = &world->state;
	static const double max = 1e100;

	for (int k = 0; k < 3 * world->model->body_count; k++) {
		const double mass = world->model->mass[k / 3]; /* infinite: driven */

		if (!(fabs(state->velocity[k]) < max && fabs(state->position[k]) < max) ||
		    (state->spin && !(fabs(state->spin[k]) < max)) ||
		    (isfinite(mass) && mass >= max))
			return false;
	}
	return true;
}

enum rb_status rb_validate_records(const struct rb_world *world, struct rb_error *err)
{
	const struct rb_ledger *const ledger = &world->ledger;
	enum rb_status status = validate_fields(world, "event", rb_event_fields(),
	                                        world->events.row, world->events.count, err);

	if (status == RB_OK)
		status = validate_fields(world, "world", rb_world_fields(), world, 1, err);
	if (status != RB_OK)
		return status;
	for (size_t k = 1; k < world->events.count; k++) {
		const struct rb_event *const e = &world->events.row[k];

		if (e->time_s < e[-1].time_s)
			return RB_FAIL(err, RB_ERR_BUG, "event %zu is at %.17g s, out of order", k,
			               e->time_s);
	}
	if (ledger->kept && has_energies(world) &&
	    (!is_finite_row(ledger->sum, RB_ENTRIES) || !is_finite_row(ledger->rest, RB_ENTRIES)))
		return RB_FAIL(err, RB_ERR_BUG, "a sum of the ledger is not finite");
	return RB_OK;
}
