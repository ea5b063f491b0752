/* SPDX-License-Identifier: MIT */
/*
 * Each cause has a running sum and the rounding lost by it (Neumaier's variant of Kahan summation),
 * so that millions of impacts add up to an ulp of the sum. What the initial values plus all entries
 * do not explain of the present values is the residual, reported as cause "unexplained".
 */
#include "world/ledger.h"

#include <math.h>

#include "base/error.h"

RB_FIELDS_DEFINE(rb_entries_fields, struct rb_entries, RB_ENTRIES_FIELDS);
RB_FIELDS_DEFINE(rb_ledger_fields, struct rb_ledger, RB_LEDGER_FIELDS);

const char *rb_ledger_energy_name(int cause)
{
	RB_ASSERT(cause >= 0 && cause <= RB_ENERGY_CAUSES);

	static const char *const name[RB_ENERGY_CAUSES + 1] = {
		[RB_ENERGY_APPLIED] = "applied",
		[RB_ENERGY_DRIVEN] = "driven",
		[RB_ENERGY_CALLBACKS] = "callbacks",
		[RB_ENERGY_IMPACTS] = "impacts",
		[RB_ENERGY_IMPACT_FRICTION] = "impact_friction",
		[RB_ENERGY_SLIDING] = "sliding",
		[RB_ENERGY_ROLLING] = "rolling",
		[RB_ENERGY_JOINT_FRICTION] = "joint_friction",
		[RB_ENERGY_DRAG] = "drag",
		[RB_ENERGY_DAMPING] = "damping",
		[RB_ENERGY_CAUSES] = "unexplained",
	};

	return name[cause];
}

const char *rb_ledger_momentum_name(int cause)
{
	RB_ASSERT(cause >= 0 && cause <= RB_MOMENTUM_CAUSES);

	static const char *const name[RB_MOMENTUM_CAUSES + 1] = {
		[RB_MOMENTUM_APPLIED] = "applied",     [RB_MOMENTUM_DRAG] = "drag",
		[RB_MOMENTUM_CALLBACKS] = "callbacks", [RB_MOMENTUM_DRIVEN] = "driven",
		[RB_MOMENTUM_STATIC] = "static",       [RB_MOMENTUM_CAUSES] = "unexplained",
	};

	return name[cause];
}

void rb_entries_add(struct rb_entries *to, double share, const struct rb_entries *from)
{
	for (int k = 0; k < RB_ENTRIES; k++)
		to->row[k] += share * from->row[k];
	to->causes |= from->causes;
}

/*
 * Neumaier's step on entries [first, first + count): the smaller of old sum and entry loses digits.
 */
static void add(struct rb_ledger *ledger, int first, int count, const double *row)
{
	RB_ASSERT_COSTLY(first >= 0 && first + count <= RB_ENTRIES);
	for (int k = first; k < first + count; k++) {
		const double x = row[k], old = ledger->sum[k], sum = old + x;

		ledger->rest[k] += fabs(old) >= fabs(x) ? (old - sum) + x : (x - sum) + old;
		ledger->sum[k] = sum;
	}
}

void rb_ledger_enter(struct rb_ledger *ledger, const struct rb_entries *entries)
{
	RB_ASSERT(ledger->kept || entries->causes == 0);

	for (int k = 0; k < RB_ENERGY_CAUSES; k++)
		if (entries->causes & 1u << k)
			add(ledger, k, 1, entries->row);
	for (int k = 0; k < RB_MOMENTUM_CAUSES; k++)
		if (entries->causes & 1u << (RB_ENERGY_CAUSES + k)) {
			add(ledger, RB_ENTRY_LINEAR + 3 * k, 3, entries->row);
			add(ledger, RB_ENTRY_ANGULAR + 3 * k, 3, entries->row);
		}
}

void rb_ledger_start(struct rb_ledger *ledger, const struct rb_frame_numbers *numbers)
{
	ledger->start_kinetic = numbers->kinetic_energy;
	ledger->start_potential = numbers->potential_energy;
	ledger->start_linear = numbers->momentum;
	ledger->start_angular = numbers->angular_momentum;
}

/* Compensated sum of three entries from `first` on. */
static rb_vec3 vector_of(const struct rb_ledger *ledger, int first)
{
	return rb_vec3_add(rb_vec3_from(ledger->sum + first), rb_vec3_from(ledger->rest + first));
}

struct rb_ledger_values rb_ledger_values(const struct rb_ledger *ledger,
                                         const struct rb_frame_numbers *numbers)
{
	const double kinetic = numbers->kinetic_energy - ledger->start_kinetic;
	const double potential = numbers->potential_energy - ledger->start_potential;
	rb_vec3 linear = rb_vec3_sub(numbers->momentum, ledger->start_linear);
	rb_vec3 angular = rb_vec3_sub(numbers->angular_momentum, ledger->start_angular);
	double left = kinetic + potential;
	struct rb_ledger_values v = {.energy_scale = numbers->kinetic_energy + fabs(potential)};

	for (int k = 0; k < RB_ENERGY_CAUSES; k++) {
		v.energy[k] = ledger->sum[k] + ledger->rest[k];
		left += rb_ledger_takes(k) ? v.energy[k] : -v.energy[k];
		v.energy_scale += fabs(v.energy[k]);
	}
	for (int k = 0; k < RB_MOMENTUM_CAUSES; k++) {
		v.momentum[k][0] = vector_of(ledger, RB_ENTRY_LINEAR + 3 * k);
		v.momentum[k][1] = vector_of(ledger, RB_ENTRY_ANGULAR + 3 * k);
		linear = rb_vec3_sub(linear, v.momentum[k][0]);
		angular = rb_vec3_sub(angular, v.momentum[k][1]);
		v.momentum_scale[0] += rb_vec3_length(v.momentum[k][0]);
		v.momentum_scale[1] += rb_vec3_length(v.momentum[k][1]);
	}
	v.energy[RB_ENERGY_CAUSES] = left;
	v.momentum[RB_MOMENTUM_CAUSES][0] = linear;
	v.momentum[RB_MOMENTUM_CAUSES][1] = angular;
	return v;
}
