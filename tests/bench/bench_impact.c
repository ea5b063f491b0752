/* SPDX-License-Identifier: MIT */
/* bench_impact COUNT SHAPE: a row for each random impact: error, condition, gain, and what happened within it. */
#include <stdio.h>

#include "impacts.h"

int main(int argc, char **argv)
{
	const long count = argc > 1 ? strtol(argv[1], NULL, 10) : 100;
	const int shape = argc > 2 ? (int)strtol(argv[2], NULL, 10) : 0;

	if (count < 1 || shape < 0 || shape >= IMPACTS_SHAPES)
		return 64;
	for (long k = 0; k < count; k++) {
		struct impacts_check check = {0};

		if (!impacts_check(shape, (uint64_t)k, 4, &check))
			return 70;
		printf("%.17g %.17g %.17g %.17g %d %d %d %s\n", check.error, check.condition,
		       check.error / check.condition, check.gain, check.reference.slips_ended,
		       check.reference.stuck, check.reference.jammed, impacts_names[shape]);
	}
	return 0;
}
