#!/bin/sh
# SPDX-License-Identifier: MIT
# Instructions of a body-step of spheres four layers high that come to lie, as their number grows: those of ten steps, of which
# loading is no part, and memory and threads have none. SIDES="16 50 158" are 1,024, 10,000 and 99,856 spheres (316: 399,424).
. "$(dirname "$0")/functions"
valgrind --tool=none --log-file=/dev/null true >/dev/null 2>&1 || { echo "$BENCH: needs valgrind" >&2; exit 0; }

# counted SIDE STEPS: instructions of all of it
counted()
{
	valgrind --tool=callgrind --callgrind-out-file=counted "$RBSIM" run "$BENCH_SCENES/pile.lua" --method stepped \
		--param side="$1" --param layers=4 --param steps="$2" --tolerance 5e-3 --no-record --threads 1 --quiet >/dev/null 2>&1 </dev/null
	sed -n 's/^\(summary\|totals\): //p' counted | head -n 1
}

first=
for side in ${SIDES-16 50 158}; do
	bodies=$((4 * side * side))
	cost=$(calc "($(counted "$side" 36) - $(counted "$side" 26)) / (10 * $bodies)")
	: "${first:=$cost}"
	result "$bodies spheres" "instructions of a body-step" "$cost" ""
	result "$bodies spheres" "of those of the fewest" "$(calc "$cost / $first")" "" 1.1
done
