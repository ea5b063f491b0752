/* SPDX-License-Identifier: MIT */
/*
 * The ledger: where energy and momentum went since the start of a run, by cause.
 *
 *   total(t) - total(0) = applied + driven + callbacks
 *                         - (impacts + impact_friction + sliding + rolling + joint_friction + drag
 *                         + damping) + unexplained
 *
 * where total is kinetic plus potential energy. The causes of the second line are energies taken,
 * so positive when they dissipate. `unexplained` is measured, not entered: what the method itself
 * made or lost. Linear and angular momentum (about the origin) have causes of their own.
 */
#ifndef RBSIM_LEDGER_H
#define RBSIM_LEDGER_H

#include <stdbool.h>

#include <rbsim/math.h>

#ifdef __cplusplus
extern "C" {
#endif

enum rb_ledger_energy {
	RB_ENERGY_APPLIED,   /* work of stated forces, and of fields without a potential */
	RB_ENERGY_DRIVEN,    /* work of driven bodies */
	RB_ENERGY_CALLBACKS, /* by impulses, forces, velocities and positions set in callbacks */
	RB_ENERGY_IMPACTS,   /* from here on taken: by restitution below 1 */
	RB_ENERGY_IMPACT_FRICTION,
	RB_ENERGY_SLIDING,
	RB_ENERGY_ROLLING,
	RB_ENERGY_JOINT_FRICTION,
	RB_ENERGY_DRAG,
	RB_ENERGY_DAMPING, /* of springs */
	RB_ENERGY_CAUSES
};

enum rb_ledger_momentum {
	RB_MOMENTUM_APPLIED, /* gravity, gravity_force, stated forces, fields */
	RB_MOMENTUM_DRAG,
	RB_MOMENTUM_CALLBACKS,
	RB_MOMENTUM_DRIVEN, /* by contact and springs with driven bodies */
	RB_MOMENTUM_STATIC, /* ... with static ones */
	RB_MOMENTUM_CAUSES
};

/*
 * "applied", "driven", ... as in recordings; for RB_ENERGY_CAUSES and RB_MOMENTUM_CAUSES:
 * "unexplained".
 */
const char *rb_ledger_energy_name(int cause);
const char *rb_ledger_momentum_name(int cause);

/* Whether the cause takes energy from the bodies where its value is positive. */
static inline bool rb_ledger_takes(int cause)
{
	return cause >= RB_ENERGY_IMPACTS && cause < RB_ENERGY_CAUSES;
}

/* The ledger at one moment; the last of each list is what is unexplained. */
struct rb_ledger_values {
	double energy[RB_ENERGY_CAUSES + 1]; /* J */
	/* linear, kg m/s, and angular about the origin, kg m^2/s */
	rb_vec3 momentum[RB_MOMENTUM_CAUSES + 1][2];
	double energy_scale;      /* J: kinetic + |change of potential| + sum of |causes| */
	double momentum_scale[2]; /* sums of the bodies' own |momenta| and of the |causes| */
};

#ifdef __cplusplus
}
#endif
#endif
