#!/bin/sh
# SPDX-License-Identifier: MIT
# Error against time step, against closed forms: the classic method is of first order, each halving halves the error.
. "$(dirname "$0")/functions"

# order NAME EXPECTATION SCENE [ARGUMENT...]
order()
{
	name=$1 text=$2
	shift 2
	: >errors
	for n in 240 480 960 1920 3840; do
		run "$@" --no-record --threads 1 --time-step "$(awk "BEGIN { printf \"%.17g\", 1 / $n }")"
		echo "$(awk "BEGIN { print 1 / $n }") $(measured "$text")" >>errors
		result "$name, 1/$n s" "error" "$(calc "$(tail -n 1 errors | cut -d ' ' -f 2)")" m
	done
	result "$name" "order (slope of log error against log step)" "$(fit errors)" "" 0.9 more
}

order "bounce" "height after the first bounce" "$BENCH_SCENES/drop.lua"
order "slide to roll" "it is where it should be" "$SCENES/slide_to_roll.lua"
order "slide to roll with backspin" "it is where it should be" "$SCENES/slide_to_roll.lua" --param spin=-100
