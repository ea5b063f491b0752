#!/bin/sh
# SPDX-License-Identifier: MIT
# Selective against global rollback, where one fast pair among a thousand slow bodies is all that ever collides.
. "$(dirname "$0")/functions"

for _ in 1 2 3 4 5; do
	for kind in selective global; do
		run "$BENCH_SCENES/fast_pair.lua" --no-record --threads 1 --rollback $kind
		echo "$(value body_steps) $(value discarded_body_steps) $(value wall_time) $(value rollbacks) $(value collisions)" \
			>>$kind
	done
done
for kind in selective global; do
	result $kind "body-steps" "$(median $kind 1)" ""
	result $kind "discarded body-steps" "$(median $kind 2)" ""
	result $kind "rollbacks" "$(median $kind 4)" ""
	result $kind "collisions" "$(median $kind 5)" ""
	result $kind "time" "$(median $kind 3)" s
done

# over COLUMN: global over selective
over()
{
	calc "$(median global "$1") / $(median selective "$1")"
}
result "global over selective" "body-steps" "$(over 1)" "" 1 more
result "global over selective" "discarded body-steps" "$(over 2)" "" 1 more
result "global over selective" "body-steps, kept and discarded" "$(calc "($(median global 1) + $(median global 2)) / \
	($(median selective 1) + $(median selective 2))")" "" 1 more
result "global over selective" "time" "$(over 3)" "" 1 more
