/* SPDX-License-Identifier: MIT */
/*
 * The ledger itself is kept by the methods; here its worst moments over a run are collected. Shares
 * are relative to what moved over the run, not to the energy at hand, which may be zero.
 */
#include "app/balance.h"

#include <float.h>
#include <math.h>

#include "app/common.h"
#include "base/error.h"
#include "base/visible.h"
#include "math/vec3.h"

RB_FIELDS_DEFINE(rb_balance_fields, struct rb_balance, RB_BALANCE_FIELDS);
RB_FIELDS_DEFINE(rb_frame_numbers_fields, struct rb_frame_numbers, RB_FRAME_NUMBERS_FIELDS);
_Static_assert(sizeof(struct rb_ledger_values) % sizeof(double) == 0, "it consists of doubles");

void rb_balance_take(struct rb_balance *balance, const struct rb_frame_numbers *numbers)
{
	const struct rb_ledger_values *const ledger = &numbers->ledger;
	const double off = ledger->energy[RB_ENERGY_CAUSES];

	RB_ASSERT(numbers != NULL);
	if (!numbers->has_ledger)
		return;
	balance->kept = true;
	balance->energy_scale = rb_larger(balance->energy_scale, ledger->energy_scale);
	balance->unexplained = rb_larger(balance->unexplained, fabs(off));
	balance->gained = rb_larger(balance->gained, off);
	for (int k = 0; k < 2; k++) {
		balance->momentum_scale[k] = rb_larger(balance->momentum_scale[k],
		                                       ledger->momentum_scale[k]);
		balance->momentum_unexplained[k] = rb_larger(
			balance->momentum_unexplained[k],
			rb_vec3_length(ledger->momentum[RB_MOMENTUM_CAUSES][k]));
	}
}

/* A part of a whole; 0 where nothing moved, NAN of a whole that is not finite. */
static double share(double part, double whole)
{
	if (whole == 0)
		return 0;
	return isfinite(whole) ? part / whole : (double)NAN;
}

double rb_balance_energy_share(const struct rb_balance *balance)
{
	return share(balance->unexplained, balance->energy_scale);
}

/* The share of linear (0) or angular (1) momentum. */
static double momentum_share(const struct rb_balance *balance, int k)
{
	return share(balance->momentum_unexplained[k], balance->momentum_scale[k]);
}

double rb_balance_momentum_share(const struct rb_balance *balance)
{
	return rb_larger(momentum_share(balance, 0), momentum_share(balance, 1));
}

/*
 * The causes that gave or took energy, with what takes it shown as positive. What is rounding of
 * all that moved is not worth a word: joints alone have impacts of 1e-29 J when they are assembled.
 */
static void print_causes(FILE *file, const struct rb_balance *balance,
                         const struct rb_ledger_values *last)
{
	const double rounding = DBL_EPSILON * balance->energy_scale;
	char text[64];
	int count = 0;

	fputs("  ledger        ", file);
	for (int k = 0; k < RB_ENERGY_CAUSES; k++) {
		if (last->energy[k] == 0 || fabs(last->energy[k]) <= rounding)
			continue;
		fputs(count++ > 0 ? ", " : "", file);
		for (const char *c = rb_ledger_energy_name(k); *c; c++)
			putc(*c == '_' ? ' ' : *c, file);
		putc(' ', file);
		fputs(rb_text_measure("", rb_ledger_takes(k) ? -last->energy[k] : last->energy[k],
		                      3, "J", text),
		      file);
	}
	fputs(count > 0 ? "\n" : "nothing gave or took energy\n", file);
}

void rb_balance_print(FILE *file, const struct rb_balance *balance,
                      const struct rb_ledger_values *last)
{
	char text[4][64];

	if (!balance->kept)
		return;
	print_causes(file, balance, last);
	rb_print(file,
	         "  unexplained   %s, %s of what moved; of momentum %s, of angular momentum %s\n",
	         rb_text_measure("", balance->unexplained, 3, "J at most", text[0]),
	         rb_text_measure("", share(balance->unexplained, balance->energy_scale), 2, "",
	                         text[1]),
	         rb_text_measure("", momentum_share(balance, 0), 2, "", text[2]),
	         rb_text_measure("", momentum_share(balance, 1), 2, "", text[3]));
}

void rb_balance_print_json(struct rb_json *json, const struct rb_balance *balance,
                           const struct rb_ledger_values *last)
{
	if (!balance->kept) {
		rb_json_text(json, "ledger", NULL);
		return;
	}
	rb_json_open(json, "ledger", '{');
	for (int k = 0; k <= RB_ENERGY_CAUSES; k++)
		rb_json_number(json, rb_ledger_energy_name(k), last->energy[k]);
	rb_json_number(json, "energy_scale", balance->energy_scale);
	rb_json_number(json, "unexplained_max", balance->unexplained);
	rb_json_number(json, "unexplained_share",
	               share(balance->unexplained, balance->energy_scale));
	rb_json_number(json, "gained_share", share(balance->gained, balance->energy_scale));
	rb_json_number(json, "momentum_share", momentum_share(balance, 0));
	rb_json_number(json, "angular_momentum_share", momentum_share(balance, 1));
	rb_json_close(json, '}');
}

void rb_balance_pack(struct rb_balance *balance, struct rb_pack *pack)
{
	rb_fields_pack(rb_balance_fields(), balance, 1, NULL, pack);
}
