/* SPDX-License-Identifier: MIT */
/*
 * Entries of the ledger (<rbsim/ledger.h>) as methods make them: sums by cause since the start of
 * the run.
 *
 * Owned by the world. While groups run, each worker enters into entries of its own (struct
 * rb_entries), which the commit adds in the order of groups. Nothing that decides the future reads
 * it.
 */
#ifndef RB_WORLD_LEDGER_H
#define RB_WORLD_LEDGER_H

#include <rbsim/frame.h>
#include <rbsim/ledger.h>

#include "base/field_list.h"
#include "math/vec3.h"

/* Energies by cause, then the linear and the angular momentum of each cause: one flat row. */
enum {
	RB_ENTRY_LINEAR = RB_ENERGY_CAUSES,
	RB_ENTRY_ANGULAR = RB_ENTRY_LINEAR + 3 * RB_MOMENTUM_CAUSES,
	RB_ENTRIES = RB_ENTRY_ANGULAR + 3 * RB_MOMENTUM_CAUSES
};

#define RB_ENTRIES_FIELDS(X)                                                                    \
	X(double, row, [RB_ENTRIES], "J, N s, N m s", "energies, momenta by cause", RB_NUMBER)  \
	X(unsigned, causes, , "", "not zero: bit k an energy, RB_ENERGY_CAUSES + k a momentum", \
	  RB_ANY_BITS)
struct rb_entries {
	RB_ENTRIES_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_entries_fields);

static inline void rb_entries_energy(struct rb_entries *e, enum rb_ledger_energy cause,
                                     double joules)
{
	e->row[cause] += joules;
	e->causes |= 1u << cause;
}

static inline void rb_entries_vector(double *row, rb_vec3 v)
{
	row[0] += v.x;
	row[1] += v.y;
	row[2] += v.z;
}

/*
 * A linear impulse, N s, and an angular one about the origin, N m s. Of rates, N and N m, they come
 * out as rates.
 */
static inline void rb_entries_momentum(struct rb_entries *e, enum rb_ledger_momentum cause,
                                       rb_vec3 linear, rb_vec3 angular)
{
	rb_entries_vector(e->row + RB_ENTRY_LINEAR + 3 * cause, linear);
	rb_entries_vector(e->row + RB_ENTRY_ANGULAR + 3 * cause, angular);
	e->causes |= 1u << (RB_ENERGY_CAUSES + cause);
}

/* An impulse, N s, that acts at a point, m, on what moves. */
static inline void rb_entries_impulse(struct rb_entries *e, enum rb_ledger_momentum cause,
                                      rb_vec3 impulse, rb_vec3 point)
{
	rb_entries_momentum(e, cause, impulse, rb_vec3_cross(point, impulse));
}

/* An angular impulse alone, N m s. */
static inline void rb_entries_twist(struct rb_entries *e, enum rb_ledger_momentum cause,
                                    rb_vec3 twist)
{
	rb_entries_momentum(e, cause, (rb_vec3){0, 0, 0}, twist);
}

/* Adds `share` times the other's entries. */
void rb_entries_add(struct rb_entries *to, double share, const struct rb_entries *from);

#define RB_LEDGER_FIELDS(X)                                                                     \
	X(double, sum, [RB_ENTRIES], "J, N s, N m s", "as struct rb_entries", RB_NUMBER)        \
	X(double, rest, [RB_ENTRIES], "J, N s, N m s", "what rounding has left out", RB_NUMBER) \
	X(double, start_kinetic, , "J", "all is counted from there", RB_NUMBER)                 \
	X(double, start_potential, , "J", "the same", RB_NUMBER)                                \
	X(rb_vec3, start_linear, , "kg m/s", "the same", RB_NUMBER)                             \
	X(rb_vec3, start_angular, , "kg m^2/s", "the same", RB_NUMBER)                          \
	X(bool, kept, , "", "false: nobody enters anything", RB_FLAG)
struct rb_ledger {
	RB_LEDGER_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_ledger_fields);

/* Sums are compensated (Neumaier, ZAMM 54 (1974) 39): millions of impacts add up to rounding. */
void rb_ledger_enter(struct rb_ledger *ledger, const struct rb_entries *entries);

/* The moment that all is counted from. */
void rb_ledger_start(struct rb_ledger *ledger, const struct rb_frame_numbers *numbers);

/*
 * What is entered, and what that leaves unexplained of these numbers. Scales are without what
 * moves.
 */
struct rb_ledger_values rb_ledger_values(const struct rb_ledger *ledger,
                                         const struct rb_frame_numbers *numbers);

#endif
