#!/bin/sh
# SPDX-License-Identifier: MIT
# What a collision costs of spheres under forces that vary: a gas with `drag`, in closed form, and with a `field`, on pieces,
# beside the same without, located, one core, recording off. The time in the field's function is what a second one adds.
# Processor times, start excluded; of RUNS (3) the least. With valgrind also instructions per collision, which no other program
# on the machine disturbs.
. "$(dirname "$0")/functions"
RUNS=${RUNS:-3}
SCENE=$BENCH_SCENES/gas.lua

# gas N T KEY=VALUE: arguments of a run
gas()
{
	echo "run $SCENE --param n=$1 --param phi=0.1 --param T=$2 --param $3 --method located --no-record --threads 1 --trust"
}

# seconds N T KEY=VALUE: least processor time of some runs
seconds()
{
	# shellcheck disable=SC2046 # words
	measure "$RUNS" "$RBSIM" $(gas "$@") --quiet >rows
	cut -d ' ' -f 2 rows | sort -g | head -n 1
}

# instructions N T KEY=VALUE: of one run
instructions()
{
	valgrind --tool=none --log-file=/dev/null true >/dev/null 2>&1 || return 1
	# shellcheck disable=SC2046 # words
	valgrind --tool=callgrind --callgrind-out-file=counted "$RBSIM" $(gas "$@") --json >out 2>err </dev/null || return 1
	sed -n 's/^\(summary\|totals\): //p' counted | head -n 1
}

# cost N T KEY=VALUE: microseconds of a collision
cost()
{
	# shellcheck disable=SC2046 # words
	run $(gas "$@" | cut -d ' ' -f 2-)
	collisions=$(value collisions)
	calc "1e6 * ($(seconds "$@") - $(seconds "$1" 1e-9 "$3")) / $collisions"
}

# counted CASE N T KEY=VALUE: instructions of a collision, start excluded
counted()
{
	case=$1
	shift
	if first=$(instructions "$1" 1e-9 "$3") && all=$(instructions "$@"); then
		result "$case" "instructions per collision" "$(calc "($all - $first) / $(value collisions)")" ""
	fi
}

# compare N T: T s, and without forces ten times as long
compare()
{
	case="n = $1"
	plain=$(cost "$1" "$(calc "10 * $2")" drag=0)
	drag=$(cost "$1" "$2" drag=1e-9)
	field=$(cost "$1" "$2" fields=1)
	both=$(cost "$1" "$2" fields=2)
	result "$case" "collision" "$plain" us
	result "$case" "collision with drag" "$drag" us
	result "$case" "with drag over without" "$(calc "$drag / $plain")" "" 4
	result "$case" "collision with a field" "$field" us
	result "$case" "time of it in the field's function" "$(calc "$both - $field")" us
	result "$case" "with a field over without, the function taken off" \
		"$(calc "(2 * $field - $both) / $plain")" "" 4
}

compare 1000 8
compare 10000 0.8
counted "n = 1000" 1000 1 drag=0
counted "n = 1000, drag" 1000 1 drag=1e-9
