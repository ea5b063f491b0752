#!/bin/sh
# SPDX-License-Identifier: MIT
# Instructions per body-step (valgrind's callgrind) beside those before methods, shapes, forces and constraints became rows:
# what that order costs. BASE names the version before it; both run the scenes of this one.
. "$(dirname "$0")/functions"
BASE=${BASE:-2467f71}
# shellcheck disable=SC2034 # read by counting
MOST=1.03
. "$TOP/tests/bench/counting"

for tolerance in 5e-3 5e-5; do
	for shape in sphere box; do
		compare "$BASE" "heap of 400, $shape, tolerance $tolerance" "$BENCH_SCENES/pile.lua" -p shape=$shape -p side=10 -p layers=4 \
			--method stepped --duration 1 --tolerance $tolerance
	done
done
compare "$BASE" "gas of 1,000, located" "$BENCH_SCENES/gas.lua" -p n=1000 -p phi=0.1 -p T=0.2 --method located
compare "$BASE" "gas of 1,000, classic" "$BENCH_SCENES/gas.lua" -p n=1000 -p phi=0.1 -p T=0.05 --method classic
compare "$BASE" "tower of 20, located" "$BENCH_SCENES/stand.lua" -p count=20 -p seconds=1 --method located
compare "$BASE" "tower of 20, by steps" "$BENCH_SCENES/stand.lua" -p count=20 -p seconds=1 --method stepped
compare "$BASE" "wrecking ball, on springs" "$SCENES/wrecking_ball.lua" --method located --duration 0.3
# 24 infinite planes that turn: each is a pair only with what it reaches, which it was not in BASE
compare "$BASE" "drum of 24 planes, 500 spheres" "$BENCH_SCENES/drum.lua" --method stepped --duration 0.5
