/* SPDX-License-Identifier: MIT */
/*
 * Sums that do not depend on the order of their terms, and that change sign with them, to the bit.
 *
 * Every term is split into two parts on fixed grids that depend only on the largest term and the
 * number of terms; on a grid, sums are exact in any order. The rest, below the second grid, is
 * dropped: less than 2^(3 log2(n) - 104) of the largest term (after Demmel and Nguyen, "Fast
 * reproducible floating-point summation", ARITH 21 (2013)).
 */
#ifndef RB_CONSTRAINT_EXACT_SUM_H
#define RB_CONSTRAINT_EXACT_SUM_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/* 1.5 times 2 to the power of biased - 1023. */
static inline double rb_exact_grid(int biased)
{
	if (biased < 1 || biased > 2046)
		return ldexp(1.5, biased - 1023);
	const uint64_t bits = (uint64_t)biased << 52 | UINT64_C(1) << 51;
	double grid;

	memcpy(&grid, &bits, sizeof grid);
	return grid;
}

static inline double rb_exact_sum(const double *term, int count)
{
	if (count <= 2)
		return count == 2 ? term[0] + term[1] : count == 1 ? term[0] : 0;
	double largest = 0;
	for (int i = 0; i < count; i++)
		largest = fabs(term[i]) > largest ? fabs(term[i]) : largest;
	if (largest == 0) { /* comparisons have passed over NaN */
		double zero = 0;

		for (int i = 0; i < count; i++)
			zero += term[i];
		return zero;
	}
	uint64_t pattern;
	int bits = 1;
	memcpy(&pattern, &largest, sizeof pattern);
	while (bits < 31 && count > 1 << bits)
		bits++;
	const int biased = (int)(pattern >> 52) + 1 + bits;
	const double grid = rb_exact_grid(biased), fine = rb_exact_grid(biased + bits - 52);
	double sum = 0, rest = 0;
	for (int i = 0; i < count; i++) {
		const double high = (grid + term[i]) - grid;

		sum += high;
		rest += (fine + (term[i] - high)) - fine;
	}
	return sum + rest;
}

#endif
