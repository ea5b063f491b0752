#!/bin/sh
# SPDX-License-Identifier: MIT
# Heaps, piles and stacks by steps: do they stand, and what does the way there cost?
. "$(dirname "$0")/functions"

for e in 0 0.5; do
	# a run that gives up is a result too, and says so as its status
	run "$SCENES/heap.lua" --param e=$e --no-record --threads 1 || [ -s out ] || continue
	result "heap of 100, e = $e" "status" "$(value status)" ""
	result "heap of 100, e = $e" "fastest ball at the end" "$(calc "$(measured "the heap is at rest")")" m/s \
		"$(calc 9.81/240)"
	result "heap of 100, e = $e" "largest overlap over tolerance" \
		"$(calc "$(value max_penetration) / $(value tolerance)")" "" 1
	result "heap of 100, e = $e" "rollbacks" "$(value rollbacks)" ""
	result "heap of 100, e = $e" "discarded of all body-steps" "$(calc "100 * $(value discarded_body_steps) / \
		($(value body_steps) + $(value discarded_body_steps))")" "%"
	result "heap of 100, e = $e" "body-steps over those asked for" "$(calc "$(value body_steps) / ($(value bodies) * \
		$(value duration) / $(value time_step))")" ""
	result "heap of 100, e = $e" "clusters ended without restitution" "$(value plastic_ends)" ""
	result "heap of 100, e = $e" "smallest step" "$(calc "$(value smallest_step)")" s
	result "heap of 100, e = $e" "time" "$(calc "$(value wall_time)")" s
done

# pile SHAPE SIDE LAYERS THREADS TOLERANCE: the stepped method on a falling lattice; nanoseconds for each body and step,
# over the tolerance in radii
pile()
{
	run "$BENCH_SCENES/pile.lua" --method stepped --param shape="$1" --param side="$2" --param layers="$3" \
		--tolerance "$(calc "0.5 * $5")" --no-record --threads "$4" || [ -s out ] || return 0
	name="pile of $(value bodies), $1, $4 thread(s), tolerance $5 r"
	result "$name" "status" "$(value status)" ""
	result "$name" "time per body-step" "$(calc "1e9 * $(value wall_time) / $(value body_steps)")" ns
	result "$name" "largest overlap over r" "$(calc "$(value max_penetration) / 0.5")" "" "$5"
	result "$name" "sweeps of each contact" "$(calc "$(value row_sweeps) / $(value contact_rows)")" ""
	result "$name" "factorizations" "$(value factorizations)" ""
	result "$name" "residual over the tolerance" "$(calc "$(value residual) / $(value tolerance)")" "" 1
}

for tolerance in 1e-2 1e-3 1e-4 1e-5 1e-6; do
	pile sphere 10 10 1 $tolerance
	pile box 5 8 1 $tolerance
done
pile sphere 10 10 2 1e-2
pile sphere 32 10 1 1e-2
pile sphere 32 10 2 1e-2
# the same height on a floor that grows: how the time grows with the number of bodies
for side in 8 16 32; do
	pile sphere $side 4 1 1e-2
	echo "$(value bodies) $(value wall_time)" >>growth
done
result "piles of 4 layers" "exponent of growth" "$(fit growth)" "" 1.1

for count in 2 5 10; do
	for ratio in 1e3 1e4 1e6; do
		for rate in 60 240; do
			run "$BENCH_SCENES/stack.lua" --method stepped --param count=$count --param ratio=$ratio \
				--param rate=$rate --no-record --threads 1 || continue
			result "stack of $count, top $ratio, 1/$rate s" "compression after 100 s" \
				"$(calc "$(measured compression)")" m 1e-6
			result "stack of $count, top $ratio, 1/$rate s" "drift after 100 s" "$(calc "$(measured drift)")" m 1e-6
			result "stack of $count, top $ratio, 1/$rate s" "time" "$(calc "$(value wall_time)")" s
		done
	done
done

run "$BENCH_SCENES/666.lua" --method stepped --no-record --threads 1 || exit 0
result "666, dt 1e-3" "sum of overlap squared" "$(calc "$(measured "sum of overlap squared, m^2")")" m^2
result "666, dt 1e-3" "RMS overlap per contact over R" "$(calc "$(measured "RMS overlap per contact over R")")" "" 1e-6
