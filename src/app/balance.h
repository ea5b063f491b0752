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
#include "base/pack.h"

/* Zeros: no frame yet. Scales and what is unexplained are the largest of all frames, each. */
struct rb_balance {
	bool kept;
	double energy_scale, unexplained, gained; /* J; gained: unexplained above zero */
	double momentum_scale[2], momentum_unexplained[2];
};

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
/* The values of a frame, which a resumed run starts from. */
void rb_ledger_values_pack(struct rb_ledger_values *values, struct rb_pack *pack);

#endif
