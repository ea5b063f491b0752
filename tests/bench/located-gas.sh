#!/bin/sh
# SPDX-License-Identifier: MIT
# Collisions per second of the located method in gases of frictionless elastic spheres in a box of six planes, one core,
# recording off: n = 1,000, 4,000 and 100,000 at packing fractions 0.01, 0.1 and 0.25. Where most of the time is spent
# otherwise (bodies that change cells, futures that are looked for anew), the share of it says so. With valgrind also
# instructions per collision, which no other program on the machine disturbs; with perf the share of each part.
# RUNS=9 asks for more repetitions (3): of times the least is taken.
. "$(dirname "$0")/functions"
RUNS=${RUNS:-3}
SCENE=$BENCH_SCENES/gas.lua

# gas N PHI T: the result of one run; frames only at the start and the end
gas()
{
	run "$SCENE" --param n="$1" --param phi="$2" --param T="$3" --method located --no-record --threads 1 --trust
}

# instructions N PHI T: of one run
instructions()
{
	valgrind --tool=none --log-file=/dev/null true >/dev/null 2>&1 || return 1
	valgrind --tool=callgrind --callgrind-out-file=counted "$RBSIM" run "$SCENE" --param n="$1" --param phi="$2" \
		--param T="$3" --method located --no-record --threads 1 --trust --json >out 2>err </dev/null || return 1
	sed -n 's/^\(summary\|totals\): //p' counted | head -n 1
}

# parts CASE N PHI T: which share of the time goes where, by samples of the processor's clock
parts()
{
	command -v perf >/dev/null 2>&1 || return 0
	perf record -q -F 2000 -e cpu-clock -o samples "$RBSIM" run "$SCENE" --param n="$2" --param phi="$3" --param T="$4" \
		--method located --no-record --threads 1 --trust --json >out 2>err </dev/null || return 0
	perf report -i samples --stdio -q -F overhead,sym 2>/dev/null >symbols || return 0
	awk '
		$1 ~ /%$/ {
			share = $1 + 0; name = $NF
			if (name ~ /^(rb_cells_near|copy_|walk_around|rb_cells_prefetch)/) part = "finding who is near"
			else if (name ~ /^(sift|see_|rb_meet_|open$|rb_foresee$|rb_set_held)/) part = "foreseeing"
			else if (name ~ /^(rb_cells_|remove_member|add_member|next_wall|rb_foresee_wall|leaves_along)/) part = "cells and their walls"
			else if (name ~ /^(rb_queue_|heap_|lay_out|list_|ask_for|look_ahead)/) part = "the queue"
			else if (name ~ /^(rb_strike_|flies|fly_on|touch|rb_arc_|remember|meet_|kick)/) part = "impacts"
			else if (name ~ /^(rb_engine_|one_event|body_event|gives_way|rb_arena_)/) part = "going from event to event"
			else part = "start, end and the rest"
			sum[part] += share
		}
		END { for (p in sum) printf "%.1f %s\n", sum[p], p }' symbols | sort -rn >shares
	while read -r share part; do
		result "$1" "time for $part" "$share" "%"
	done <shares
}

# seconds N PHI T: least processor time of some runs, which waiting for a processor does not lengthen
seconds()
{
	measure "$RUNS" "$RBSIM" run "$SCENE" --param n="$1" --param phi="$2" --param T="$3" --method located --no-record \
		--threads 1 --trust --quiet >rows
	cut -d ' ' -f 2 rows | sort -g | head -n 1
}

# measure_gas N PHI T BAR ["counted"]
measure_gas()
{
	n=$1 phi=$2 duration=$3 bar=$4 case="n = $1, packing $2"
	gas "$n" "$phi" "$duration"
	collisions=$(value collisions)
	# relative to the energy; a random walk grows with the root of the number of collisions only
	drift=$(awk -v d="$(value energy_drift)" -v e="$(value kinetic_energy_max)" 'BEGIN { printf "%.3g", d / e }')
	result "$case" collisions "$collisions" ""
	result "$case" "wall time, start excluded" "$(calc "$(value wall_time)")" s
	whole=$(seconds "$n" "$phi" "$duration")
	start=$(seconds "$n" "$phi" "$(calc "$duration / 1e6")")
	result "$case" "collisions per processor second, start excluded" "$(calc "$collisions / ($whole - $start)")" 1/s "$bar" more
	result "$case" "collisions per processor second, start included" "$(calc "$collisions / $whole")" 1/s
	result "$case" "energy drift" "$drift" ""
	result "$case" "energy drift, carried on to 1e8 collisions as if it were all one way" \
		"$(calc "$drift * 1e8 / $collisions")" "" 1e-10
	[ "${5-}" = counted ] || return 0
	few=$(calc "$duration / 20")
	if first=$(instructions "$n" "$phi" "$few"); then
		first_collisions=$(value collisions)
		if second=$(instructions "$n" "$phi" "$(calc "3 * $few")"); then
			result "$case" "instructions per collision" \
				"$(calc "($second - $first) / ($(value collisions) - $first_collisions)")" ""
		fi
	fi
	parts "$case" "$n" "$phi" "$duration"
}

result "this machine" "load when begun" "$(cut -d ' ' -f 1 /proc/loadavg 2>/dev/null || uptime | sed 's/.*: *\([0-9.]*\).*/\1/')" ""
measure_gas 1000 0.01 800 "" counted
measure_gas 1000 0.1 200 ""
measure_gas 1000 0.25 60 ""
measure_gas 4000 0.01 300 "" counted
measure_gas 4000 0.1 100 1e6 counted
measure_gas 4000 0.25 40 1e6 counted
measure_gas 100000 0.01 10 ""
measure_gas 100000 0.1 4 5e5
measure_gas 100000 0.25 2 5e5
