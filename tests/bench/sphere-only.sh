#!/bin/sh
# SPDX-License-Identifier: MIT
# Instructions per body-step (valgrind's callgrind) of scenes of spheres alone, beside those of an earlier version: what
# other shapes have made spheres pay. Both versions run the scenes of this one.
# BASE names the earlier version (the last one without convex bodies); PILE_BASE the one for piles, which are stepped: the
# method came with convex bodies. Both are built from git; a version of which git knows nothing is left out.
. "$(dirname "$0")/functions"
BASE=${BASE:-b668c1c}
PILE_BASE=${PILE_BASE:-06a89e0}
# shellcheck disable=SC2034 # read by counting
MOST=1.02
. "$TOP/tests/bench/counting"

compare "$BASE" "gas, located" "$BENCH_SCENES/gas.lua" -p n=1000 -p phi=0.1 -p T=0.2 --method located
compare "$BASE" "gas, classic" "$BENCH_SCENES/gas.lua" -p n=1000 -p phi=0.1 -p T=0.05 --method classic
compare "$BASE" "heap, classic" "$SCENES/heap.lua" --method classic --duration 0.3
compare "$BASE" billiard "$SCENES/billiard.lua"
compare "$BASE" cradle "$SCENES/cradle.lua"
for tolerance in 5e-3 5e-4 5e-6; do
	compare "$PILE_BASE" "pile of 64, tolerance $tolerance" "$BENCH_SCENES/pile.lua" -p side=4 -p layers=4 --method stepped \
		--duration 1 --tolerance $tolerance
done
compare "$PILE_BASE" "pile of 400, tolerance 5e-3" "$BENCH_SCENES/pile.lua" -p side=10 -p layers=4 --method stepped \
	--duration 1 --tolerance 5e-3
