#!/bin/sh
# SPDX-License-Identifier: MIT
# A sweep that is interrupted, or killed, stops its runs, goes on, and has the bits of one that was left alone.
. tests/cli/functions

cat >s.lua <<'END'
local e = param("e", 0.5, "restitution")
world { duration = 4, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = e, density = 1000, friction = 0.3 }
plane { normal = {0, 0, 1}, material = m }
for i = 1, 60 do
	sphere { radius = 0.1, position = {0.5 * i, 0, 0.5 + 0.01 * i}, material = m,
		velocity = {math.random(), math.random(), 0} }
end
END
pid=
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
begun=$(date +%s%N)
exits 0 sweep s.lua -p e=0.5:0.9:0.05 -o whole
# a part of what it takes here and now, so that each round finds runs to stop
part=$(awk "BEGIN { print ($(date +%s%N) - $begun) * 0.13e-9 }")

# our runs, and nobody else's: processes whose command line has this folder's point
runs_left()
{
	for stat in /proc/[0-9]*/cwd; do
		[ "$(readlink "$stat" 2>/dev/null)" = "$PWD/cut" ] && return 0
	done
	return 1
}
none_left()
{
	! runs_left
}

# as soon as there is a folder, its sweep can be gone on with
for round in 1 2 3 4 5 6; do
	"$RBSIM" sweep s.lua -p e=0.5:0.9:0.05 -o "early$round" >out 2>err &
	pid=$!
	while [ ! -f "early$round/plan.csv" ] && kill -0 $pid 2>/dev/null; do :; done
	kill -USR1 $pid 2>/dev/null
	ended 75 "SIGUSR1 as soon as there is a plan"
	says err "'rbsim sweep early$round' goes on"
done

stopped=0
for signal in INT TERM USR1 KILL INT TERM KILL; do
	"$RBSIM" sweep s.lua -p e=0.5:0.9:0.05 -o cut >out 2>err &
	pid=$!
	until_true [ -f cut/plan.csv ]
	sleep "$part"
	kill -"$signal" $pid 2>/dev/null
	wait $pid
	got=$?
	pid=
	[ "$signal" = KILL ] || [ $got -eq 75 ] || [ $got -eq 0 ] || fail "SIG$signal: exit status $got"
	[ $got -eq 0 ] || stopped=$((stopped + 1))
	[ $got -ne 75 ] || says err "'rbsim sweep cut' goes on"
	until_true none_left
	exits 0 sweep cut --status --json
	[ "$(value failed)" = 0 ] || fail "SIG$signal: points have failed: $(cat out)"
	[ "$(value running)" = 0 ] || fail "SIG$signal: points still run: $(cat out)"
done
[ $stopped -ge 2 ] || fail "only $stopped sweeps were stopped before their end"
exits 0 sweep cut
says err '9 of 9 points done'
for json in whole/*.json; do
	[ "$(value state_hash "$json")" = "$(value state_hash "cut/${json#whole/}")" ] || fail "$json: other bits"
done

# a run that is killed has failed, is told, and is run again, since that may mend
cat >long.lua <<'END'
local k = param("k", 1, "which")
world { duration = k == 1 and 1000 or 0.01, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = 1, density = 1000 }
plane { normal = {0, 0, 1}, material = m }
for i = 1, 100 do sphere { radius = 0.1, position = {0.5 * i, 0, 0.5 + 0.01 * i}, material = m } end
END
"$RBSIM" sweep long.lua -p k=0,1,2 -o killed --jobs 1 >out 2>err &
pid=$!
until_true [ -f killed/point-00001.h5 ]
child=$(cat /proc/$pid/task/$pid/children)
kill -9 $child
ended 1 "a run was killed"
says err 'point 1 \(k=1\) failed, exit status 137: ended by signal 9'
says err '2 of 3 points done, 1 failed'
exits 0 sweep killed --status
says out "to be run +1:.* of 3 tasks --array=1"

# the second SIGINT ends runs at once, also busy ones
busy_scene >busy.lua
"$RBSIM" sweep busy.lua --trust --no-record -o busy --jobs 1 >out 2>err &
pid=$!
until_true [ -f busy/point-00000.log ]
sleep 0.5
kill -INT $pid
sleep 0.3
kill -0 $pid 2>/dev/null || fail "the first SIGINT has not waited"
kill -INT $pid
ended 75 "second SIGINT"

# two sweeps over one folder at the same time: each point once
exits 0 sweep s.lua -p e=0.5:0.9:0.05 -o both --plan
"$RBSIM" sweep both --jobs 1 --json >one 2>err &
pid=$!
"$RBSIM" sweep both --jobs 1 --json >two 2>err2
wait $pid
pid=
ran=$(($(value runs one) + $(value runs two)))
[ $ran -eq 9 ] || fail "two sweeps: $ran runs of 9 points"
exits 0 sweep both
