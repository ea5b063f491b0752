#!/bin/sh
# SPDX-License-Identifier: MIT
# Eccentric impacts with friction against an integration of Keller's equations in long double (tests/keller.h): error of
# the impulse over the condition that the integration finds by changing all that goes in. COUNT=2000 of each shape.
. "$(dirname "$0")/functions"
COUNT=${COUNT:-2000}

# shellcheck disable=SC2046 # flags are several words
${CC:-cc} -std=c17 -O2 -D_GNU_SOURCE -I"$TOP/include" -I"$TOP/src" -I"$TOP/tests" -o bench \
	"$TOP/tests/bench/bench_impact.c" "$(dirname "$RBSIM")/librbsim-internal.a" \
	-lm $(pkg-config --libs qhull_r 2>/dev/null || echo -lqhull_r) -pthread

# part FILE COLUMN SHARE: the smallest value that is not below this share of them
part()
{
	cut -d ' ' -f "$2" "$1" | sort -g | awk -v share="$3" '{ v[NR] = $1 }
		END { n = int(share * NR + 0.999999); printf "%.3g", v[n < 1 ? 1 : n] }'
}
for shape in 0 1 2 3; do
	./bench "$COUNT" $shape >rows
	case="$COUNT $(head -n 1 rows | cut -d ' ' -f 8)"
	result "$case" "slip ends within the impact" "$(awk '$5' rows | wc -l)" ""
	result "$case" "drawn together a second time" "$(awk '$7' rows | wc -l)" ""
	result "$case" "condition, median" "$(part rows 2 0.5)" ""
	result "$case" "condition, most" "$(part rows 2 1)" ""
	result "$case" "error over condition, median" "$(part rows 3 0.5)" "" 1e-10
	result "$case" "error over condition, 99 %" "$(part rows 3 0.99)" "" 1e-10
	result "$case" "error over condition, most" "$(part rows 3 1)" "" 1e-10
	result "$case" "gain of kinetic energy, most, of the parts of the work" "$(part rows 4 1)" "" 1e-14
done
