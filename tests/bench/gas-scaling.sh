#!/bin/sh
# SPDX-License-Identifier: MIT
# How the cost of a dilute gas grows with its number of spheres at the same density, with selective rollback: one size
# of spheres, and two of radii 1e-3 and 1. Every run simulates the same time, so that all see the same phase of the gas.
. "$(dirname "$0")/functions"

# gas N REPEATS NAME SCENE DURATION [ARGUMENT...]: appends to NAME.cost "n seconds", to NAME.tests "n tests"
gas()
{
	n=$1 repeats=$2 name=$3 scene=$4 duration=$5
	shift 5
	: >rows
	for _ in $(seq "$repeats"); do
		run "$scene" --param balls="$n" "$@" --duration "$duration" --no-record --threads 1 --rollback selective --trust
		echo "$(value wall_time) $(value pair_tests) $(value bodies) $(value body_steps)" >>rows
	done
	cost=$(calc "$(median rows 1) / $duration")
	# the broadphase's tests over all bodies and the steps that the scene asks for
	tests=$(awk -v s="$duration" -v dt="$(value time_step)" 'NR == 1 { printf "%.4g", $2 / ($3 * s / dt) }' rows)
	echo "$n $cost" >>"$name.cost"
	echo "$n $tests" >>"$name.tests"
	result "$name, n = $n" "cost per simulated second" "$cost" s
	result "$name, n = $n" "cost per body and step" "$(awk -v c="$(median rows 1)" \
		'NR == 1 { printf "%.4g", 1e9 * c / $4 }' rows)" ns
	result "$name, n = $n" "discarded body-steps" "$(calc "100 * $(value discarded_body_steps) / $(value body_steps)")" "%"
	result "$name, n = $n" "pair tests per body and step" "$tests" ""
}

# grows NAME
grows()
{
	result "$1" "exponent of cost against n" "$(fit "$1.cost")" "" 1.1
	result "$1" "pair tests per body, most over least" "$(awk 'NR == 1 { a = b = $2 }
		{ if ($2 < a) a = $2; if ($2 > b) b = $2 }
		END { printf "%.3f", b / a }' "$1.tests")" "" 2
}

# sizes NAME SCENE DURATION [ARGUMENT...]
sizes()
{
	gas 1000 15 "$@"
	gas 10000 5 "$@"
	gas 100000 3 "$@"
	grows "$1"
}

sizes "one size" "$SCENES/gas.lua" 1
# A small one is tested against the large ones in the cells around it, and these are missing beyond a wall: a small box
# has fewer tests per body for that reason alone, the more so the fewer large ones it holds (8 of 1,000 in the last row).
sizes "radii 1e-3 and 1, half of each" "$BENCH_SCENES/mixed.lua" 0.2 --param each=2
sizes "radii 1e-3 and 1, one in 125 large" "$BENCH_SCENES/mixed.lua" 0.2 --param each=125
