#!/bin/sh
# SPDX-License-Identifier: MIT
# tests/scenes/stress.lua with a few draws: steps end, stay finite and within the tolerance, with either rollback.
# physics-located.sh does the same with the default method.
set -eu
scene=$(dirname "$0")/../scenes/stress.lua
# other draws are other numbers for the same code
draws='1 2 3 4 5 6 7 8 9 10'
[ "${RBSIM_MODE:-release}" = release ] || draws='1 2'
for k in $draws; do
	for rollback in selective global; do
		"$RBSIM" "$scene" --method classic --param k="$k" --rollback $rollback --no-record --quiet || {
			echo "k = $k, rollback $rollback: exit $?"
			exit 1
		}
	done
done

# cubes that fall on each other, by steps: overlaps of two, wedged so that no impulses closed them, were closed by moving one of
# them by 0.7 m, through a wall
"$RBSIM" "$(dirname "$0")/../bench/scenes/pile.lua" --method stepped --param shape=turned --param steps=170 --tolerance 5e-5 \
	--no-record --quiet || {
	echo "cubes turned at random: exit $?"
	exit 1
}
