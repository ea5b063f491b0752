#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs of a sweep that were stopped or killed go on from their checkpoints, and end in the bits of runs that were left alone.
. tests/cli/functions

# Two balls, and ten seconds of work in each run while a file says so; a run that begins at its first frame tells.
cat >s.lua <<'END'
local e = param("e", 0.5, "restitution")
world { duration = 2, gravity = {0, 0, -9.81}, frame_rate = 100 }
local m = material { name = "rubber", restitution = e, density = 1000, friction = 0.3 }
plane { normal = {0, 0, 1}, material = m }
for i = 1, 2 do sphere { radius = 0.1, position = {i, 0, 1 + 0.1 * math.random()}, velocity = {1, 0, 0}, material = m } end
on_frame(function(t, k)
	if k == 0 then
		local file = io.open("begun", "a")
		file:write(e, "\n")
		file:close()
	end
	local slow = io.open("slow")
	if slow then
		slow:close()
		local x = 0
		for i = 1, 1e7 do x = x + i end
	end
end)
END
exits 0 sweep s.lua --trust -p e=0.3,0.6,0.9 -o whole
pid=
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT

# all points are done, with the right bits, and FILE tells of so many beginnings
whole()
{
	exits 0 sweep "$1" --status
	says out '3 points of s.lua: 3 done'
	for k in 0 1 2; do
		exits 0 diff "whole/point-0000$k.h5" "$1/point-0000$k.h5"
		[ "$(value state_hash whole/point-0000$k.json)" = "$(value state_hash "$1/point-0000$k.json")" ] ||
			fail "$1: point $k ends in another state"
	done
	[ "$(wc -l <"$1/begun")" -eq "$2" ] || fail "$1: $(wc -l <"$1/begun") runs began at their first frame, wanted $2"
	[ -z "$(find "$1" -name '*.checkpoint*')" ] || fail "$1: complete runs leave checkpoints"
}
nobody_runs()
{
	exits 0 sweep "$1" --status --json
	[ "$(value running)" = 0 ]
}
has_begun() # has_begun FOLDER COUNT
{
	[ -f "$1/begun" ] && [ "$(wc -l <"$1/begun")" -ge "$2" ]
}

# signals; a sweep that is killed stops its runs, too, at checkpoints
exits 0 sweep s.lua --trust -p e=0.3,0.6,0.9 -o cut --plan
touch cut/slow
for signal in TERM INT USR1 KILL; do
	"$RBSIM" sweep cut --jobs 3 >out 2>err &
	pid=$!
	until_true has_begun cut 3
	sleep 0.3
	kill -$signal $pid
	wait $pid
	got=$?
	pid=
	case $signal in KILL) wanted=137 ;; *) wanted=75 ;; esac
	[ $got -eq $wanted ] || fail "SIG$signal: exit status $got"
	until_true nobody_runs cut
	for k in 0 1 2; do [ -s cut/point-0000$k.h5.checkpoint ] || fail "SIG$signal: point $k has no checkpoint"; done
done
rm cut/slow
exits 0 sweep cut --jobs 2
whole cut 3

# Runs that are killed lose what came after the checkpoint before. How often there is one is not settled by the plan.
exits 0 sweep s.lua --trust -p e=0.3,0.6,0.9 -o killed --plan
touch killed/slow
"$RBSIM" sweep killed --jobs 3 --checkpoint-every 0.05 >out 2>err &
pid=$!
for k in 0 1 2; do until_true [ -s killed/point-0000$k.h5.checkpoint ]; done
for child in $(cat /proc/$pid/task/$pid/children); do kill -9 "$child"; done
ended 1 "runs that were killed"
exits 0 sweep killed --status
says out '3 failed'
rm killed/slow
exits 0 sweep killed --jobs 3 --checkpoint-every 1000
whole killed 3

# Checkpoints that are damaged, both: the run says so and has failed; the next time it begins anew.
exits 0 sweep s.lua --trust -p e=0.3,0.6,0.9 -o damaged --plan
touch damaged/slow
"$RBSIM" sweep damaged --jobs 3 >out 2>err &
pid=$!
until_true has_begun damaged 3
sleep 0.2
kill -TERM $pid
wait $pid
pid=
rm damaged/slow
for file in damaged/*.checkpoint*; do head -c 100 "$file" >cut.checkpoint && mv cut.checkpoint "$file"; done
exits 1 sweep damaged --jobs 3
says err 'point 0 .*exit status 66: .*is not a checkpoint to resume from'
exits 0 sweep damaged --jobs 3
whole damaged 6

# Two at once on one folder: who ends last has nothing left to do, whoever ran the points.
exits 0 sweep s.lua --trust -p e=0.2,0.4,0.6,0.8 -o shared --plan
touch shared/slow
"$RBSIM" sweep shared --jobs 2 >first 2>&1 &
pid=$!
until_true has_begun shared 2
"$RBSIM" sweep shared --jobs 2 >out 2>err &
other=$!
until_true has_begun shared 4
rm shared/slow
wait $pid
first=$?
wait $other
second=$?
pid=
[ $first -eq 0 ] || [ $second -eq 0 ] || fail "two at once, and all is done: $first and $second"
exits 0 sweep shared --status

# A point that takes too long, or makes too large a file, has failed; the others have not, and it goes on when it may.
cat >bound.lua <<'END'
local n, work = param("n", 1.0, "how long"), param("work", 3e5, "of each frame")
world { duration = n, gravity = {0, 0, -9.81} }
sphere { radius = 0.1, position = {0, 0, 1} }
on_frame(function() local x = 0 for i = 1, work do x = x + i end end)
END
begun=$(date +%s)
exits 0 sweep bound.lua -p n=0.1 -o short
bound=$((3 + 3 * ($(date +%s) - begun))) # as this machine is
"$RBSIM" sweep bound.lua -p n=0.1,1e4 -o slow --jobs 2 --point-time $bound >out 2>err
[ $? -eq 1 ] || fail "a point that takes too long: $(cat err)"
says err 'point 1 .*took longer than '$bound' s'
[ -s slow/point-00001.h5.checkpoint ] || fail "no checkpoint of a point that takes too long"
"$RBSIM" sweep bound.lua -p n=0.1,40 -p work=1 -o large --jobs 2 --point-disk 1000000 --no-render >out 2>err
[ $? -eq 74 ] || fail "a point that takes too much disk: $(cat err)"
says err 'point 1 .*File too large'
[ -z "$(find large -size +1000000c)" ] || fail "a file beyond the bound"
exits 0 sweep large --jobs 2
exits 0 sweep large --status

# Many small files count together, and what the run has recorded until then stays.
cat >pictures.lua <<'END'
local n = param("n", 0.1, "how long")
world { duration = n, frame_rate = 10 }
plane {}
sphere { radius = 0.1, velocity = {0.1, 0, 0}, position = {0, 0, 0.5} }
camera { position = {0, -4, 0.6}, look_at = {0, 0, 0.6}, size = {640, 480}, samples = 1, png = "many/%06d.png" }
END
"$RBSIM" sweep pictures.lua -p n=0.1,100 -o many --jobs 2 --point-disk 3000000 >out 2>err
[ $? -eq 1 ] || fail "a point whose pictures take too much disk: $(cat err)"
says err 'point 1 .*took more than 3000000 bytes of disk'
[ -s many/point-00001.h5.checkpoint ] || fail "no checkpoint of a point that takes too much disk"
