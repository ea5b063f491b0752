/* SPDX-License-Identifier: MIT */
/*
 * The values that a sweep gives to one parameter, from "NAME=VALUES".
 *
 * VALUES are texts parted by commas; three numbers parted by colons, low:high:step, stand for all
 * of them from low to high. Such numbers are counted in decimals, exactly: 0:1:0.1 has eleven
 * values, the fourth is 0.3. Two numbers, low:high, are all between them, which only a sample can
 * draw from.
 *
 * An axis owns what it holds; const after rb_axis_init.
 */
#ifndef RB_SWEEP_AXIS_H
#define RB_SWEEP_AXIS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rbsim/error.h>

enum { RB_AXIS_NUMBER_SIZE = 64 };

/* One text, or an arithmetic progression of decimal numbers: (first + k * step) * 10^exponent. */
struct rb_axis_piece {
	uint64_t count;
	const char *text; /* into rb_axis.values, zero-terminated; NULL: a progression */
	int64_t first, step;
	int exponent;
};

struct rb_axis {
	char *text;                   /* owned: "NAME=VALUES" as given */
	char *name;                   /* owned */
	char *values;                 /* owned: VALUES, cut into pieces */
	struct rb_axis_piece *pieces; /* owned */
	int piece_count;
	uint64_t count; /* of all values; 0: all between low and high */
	double low, high;
	size_t room; /* for the longest value with a zero behind */
};

/* RB_ERR_USAGE says what is wrong. At most `most` values. Released in any case. */
RB_CHECKED enum rb_status rb_axis_init(struct rb_axis *axis, const char *text, uint64_t most,
                                       struct rb_error *err);
void rb_axis_release(struct rb_axis *axis); /* safe on a zeroed one */

/* The k-th value: a text of the axis, or one made in `out`. */
const char *rb_axis_value(const struct rb_axis *axis, uint64_t k, char out[RB_AXIS_NUMBER_SIZE]);
/*
 * The value at `unit` in [0, 1): the interval is cut into as many equal parts as there are values.
 */
const char *rb_axis_at(const struct rb_axis *axis, double unit, char out[RB_AXIS_NUMBER_SIZE]);

#endif
