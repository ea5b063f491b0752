#!/bin/sh
# SPDX-License-Identifier: MIT
# A heap of a hundred balls under the classic method: does it come to rest, and what does the way there cost?
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
