#!/bin/sh
# SPDX-License-Identifier: MIT
# What a sweep costs beside its runs: how much longer a run takes in it than alone, and whether short runs keep all
# processors busy. On a machine that others use too, what the runs take of all the processor time of the sweep says most.
# Folders are left for the end: file systems are slow to give out what was just deleted.
. "$(dirname "$0")/functions"

cat >ball.lua <<'END'
local e = param("e", 0.5, "restitution")
world { duration = 0.5, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = e, density = 1000 }
plane { normal = {0, 0, 1}, material = m }
sphere { radius = 0.1, position = {0, 0, 1}, material = m }
END
jobs=$(nproc)

# idle and all time of the processors, in ticks
ticks()
{
	awk '/^cpu / { print $5 + $6, $2 + $3 + $4 + $5 + $6 + $7 + $8 + $9 }' /proc/stat
}

# alone, from a shell, and one after another in a sweep; processor time includes all that the sweep itself does
"$RBSIM" ball.lua -q --threads 1 --force -o warm.h5
for round in 1 2 3; do
	measure 50 "$RBSIM" run --json --force --threads=1 --seed=1 --param=e=0.5 --output=alone.h5 -- ball.lua >rows
	echo "$(median rows 1) $(median rows 2)" >>alone
	measure 1 "$RBSIM" sweep ball.lua -p e=0:0.99:0.01 -o "one$round" --jobs 1 -q >rows
	awk '{ print $1 / 100, $2 / 100 }' rows >>swept
done
for column in 1 2; do
	what=$([ $column -eq 1 ] && echo "wall time" || echo "processor time")
	result "one run" "$what, alone" "$(calc "1e3 * $(median alone $column)")" ms
	result "one run" "$what, more in a sweep" "$(calc "1e3 * ($(median swept $column) - $(median alone $column))")" ms 5
done

for case in "recorded" "without recordings"; do
	folder=$(echo "$case" | tr -d ' ')
	set --
	[ "$case" = recorded ] || set -- --no-record
	ticks >before
	measure 1 sh -c '"$0" "$@" >out' "$RBSIM" sweep ball.lua -p e=0:0.999:0.001 -o "$folder" --json "$@" >rows
	ticks >after
	result "1000 short runs, $case" "wall time" "$(value wall_time)" s
	result "1000 short runs, $case" "processors that the runs kept busy" \
		"$(calc "100 * $(value processor_time) / $(value wall_time) / $jobs")" % 95 more
	result "1000 short runs, $case" "of the processor time, that of the runs" \
		"$(calc "100 * $(value processor_time) / $(median rows 2)")" % 95 more
	result "1000 short runs, $case" "more than that, a run" \
		"$(calc "$(median rows 2) - $(value processor_time)")" ms 5
	result "1000 short runs, $case" "processors not idle" \
		"$(paste -d ' ' before after | awk '{ printf "%.4g", 100 * (1 - ($3 - $1) / ($4 - $2)) }')" % 95 more
done
result "1000 points" "going on where all is done" "$(measure 1 "$RBSIM" sweep recorded -q | awk '{ print $1 }')" s
"$RBSIM" sweep ball.lua -p e=0:1:0.000001 -o million --plan -q
result "a million points" "memory to plan, and to tell the status" "$(measure 1 "$RBSIM" sweep million --status --json | awk '{ print $3 / 1000 }')" MB
