/* SPDX-License-Identifier: MIT */
/*
 * The ledger over a whole run: where the energy went, and the most that was unexplained at any
 * frame.
 */
#ifndef RB_APP_BALANCE_H
#define RB_APP_BALANCE_H

#include <stdio.h>

#include <rbsim/frame.h>

#include "app/json.h"
#include "base/field_list.h"

/* Largest values of all frames so far; zeros: no frame yet. */
#define RB_BALANCE_FIELDS(X)                                                                  \
	X(bool, kept, , "", "some frame had a ledger", RB_FLAG)                               \
	X(double, energy_scale, , "J", "as of struct rb_ledger_values", RB_NUMBER)            \
	X(double, unexplained, , "J", "either sign", RB_NUMBER)                               \
	X(double, gained, , "J", "unexplained above zero", RB_NUMBER)                         \
	X(double, momentum_scale, [2], "kg m/s, kg m^2/s", "linear, then angular", RB_NUMBER) \
	X(double, momentum_unexplained, [2], "kg m/s, kg m^2/s", "of the same", RB_NUMBER)
struct rb_balance {
	RB_BALANCE_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_balance_fields);

/* The list of struct rb_frame_numbers (<rbsim/frame.h>): the first and last ones of a run. */
#define RB_FRAME_NUMBERS_FIELDS(X)                                                     \
	X(double, kinetic_energy, , "J", "at the frame", RB_NUMBER)                    \
	X(double, potential_energy, , "J", "zero at the origin", RB_NUMBER)            \
	X(rb_vec3, momentum, , "kg m/s", "of all bodies", RB_NUMBER)                   \
	X(rb_vec3, angular_momentum, , "kg m^2/s", "about the origin", RB_NUMBER)      \
	X(double, mass, , "kg", "of what attracts by its mass; 0: not all", RB_NUMBER) \
	X(rb_vec3, center_of_mass, , "m", "of these", RB_NUMBER)                       \
	X(double, max_penetration, , "m", "since the frame before", RB_NUMBER)         \
	X(uint64_t, contacts, , "", "lasting ones", RB_ANY_BITS)                       \
	X(uint64_t, collisions, , "", "since the frame before", RB_ANY_BITS)           \
	X(uint64_t, rollbacks, , "", "since the frame before", RB_ANY_BITS)            \
	X(uint64_t, substeps, , "", "accepted since the frame before", RB_ANY_BITS)    \
	X(double, smallest_step, , "s", "of those tried", RB_NUMBER)                   \
	X(double, stepped, , "s", "simulated by steps", RB_NUMBER)                     \
	X(double, gravitation_error, , "", "share of an acceleration", RB_NUMBER)      \
	X(double, gravitation_energy_error, , "", "share of an energy", RB_NUMBER)     \
	X(bool, has_ledger, , "", "`ledger` is kept", RB_FLAG)                         \
	X(struct rb_ledger_values, ledger, , "J, kg m/s, kg m^2/s", "zeros without one", RB_NUMBER)
RB_FIELDS_DECLARE(rb_frame_numbers_fields);

void rb_balance_take(struct rb_balance *balance, const struct rb_frame_numbers *numbers);

/* The largest shares of the scales that were unexplained. */
double rb_balance_energy_share(const struct rb_balance *balance);
double rb_balance_momentum_share(const struct rb_balance *balance);

/* Two lines of the summary; nothing where the ledger was not kept. `last`: of the last frame. */
void rb_balance_print(FILE *file, const struct rb_balance *balance,
                      const struct rb_ledger_values *last);
/* "ledger": an object, or null. */
void rb_balance_print_json(struct rb_json *json, const struct rb_balance *balance,
                           const struct rb_ledger_values *last);

void rb_balance_pack(struct rb_balance *balance, struct rb_pack *pack);

#endif
