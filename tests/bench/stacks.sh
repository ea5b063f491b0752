#!/bin/sh
# SPDX-License-Identifier: MIT
# Stacks of 20 and 50 boxes that are let fall, by steps: at rest after 2 s, no lower than their contacts' tolerances, and then
# nothing shifts. SEEDS="1 2 3" lays them in so many ways.
. "$(dirname "$0")/functions"

for count in 20 50; do
	for rate in 60 240; do
		for tolerance in 1e-6 1e-4 1e-2; do
			for seed in ${SEEDS-1 2 3}; do
				run "$BENCH_SCENES/dropped.lua" --method stepped --param count=$count --param rate=$rate --seed "$seed" \
					--tolerance "$(calc "0.5 * $tolerance")" --no-record --threads 1 || [ -s out ] || continue
				name="$count boxes, 1/$rate s, tolerance $tolerance r, seed $seed"
				result "$name" "fastest after 2 s" "$(calc "$(found "fastest after 2 s")")" m/s 0
				result "$name" "shift after 2 s" "$(calc "$(found "shift after 2 s")")" m 0
				result "$name" "how low the top is" "$(calc "$(found "how low the top is")")" m \
					"$(calc "$count * 0.5 * $tolerance")"
			done
		done
	done
done
