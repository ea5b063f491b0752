#!/bin/sh
# SPDX-License-Identifier: MIT
# SIGINT, SIGTERM, SIGUSR1 and SIGHUP close everything properly; another SIGINT stops at once.
. tests/cli/functions

long_scene >s.lua
has_frames() # has_frames RECORDING: more than the first
{
	"$RBSIM" info "$1" --json >info 2>/dev/null && [ "$(value frames info)" -gt 1 ]
}
ticks() # of processor time that $pid has had
{
	sed 's/.*) //' "/proc/$pid/stat" | awk '{ print $12 + $13 }'
}
works_on() # for a fifth of a second and more since it had $before
{
	now=$(ticks 2>/dev/null)
	[ -n "$now" ] || fail "the run has ended after a signal that it goes on after"
	[ "$now" -ge $((before + 20)) ]
}
begun() # a scene has said so
{
	grep -qs begun out err
}
pid=
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
for case in "INT 75" "TERM 75" "USR1 75" "HUP 75"; do
	signal=${case% *} wanted=${case#* }
	# whoever runs this may have SIGHUP ignored
	env --default-signal=HUP "$RBSIM" s.lua --force -o $signal.h5 >out 2>err &
	pid=$!
	until_true has_frames $signal.h5
	kill -"$signal" $pid
	ended "$wanted" "SIG$signal"
	says err "SIG$signal at [0-9.]+ s: --resume goes on from frame [0-9]+"
	[ -s $signal.h5.checkpoint ] || fail "SIG$signal: there is no checkpoint"
	says err 'frames +[0-9]+ of 6000001'
	frames=$(sed -n 's/.*frames *\([0-9]*\) of.*/\1/p' err)
	exits 0 info $signal.h5 --json
	[ "$(value status)" = interrupted ] || fail "SIG$signal: the recording is '$(value status)'"
	[ "$(value frames)" = "$frames" ] || fail "SIG$signal: $(value frames) frames recorded, $frames made"
	[ "$frames" -gt 1 ] || fail "SIG$signal: stopped before it began"
done

# without a recording too
{ cat s.lua && echo 'on_frame(function(_, k) if k == 1 then print("begun") end end)'; } >tells.lua
rm -f out err # the last one's would be taken for it
"$RBSIM" tells.lua --no-record >out 2>err &
pid=$!
until_true begun
kill -TERM $pid
ended 143 "--no-record"

# while the scene is loaded
cat >loads.lua <<'END'
print("begun")
for i = 1, math.huge do end
END
for case in "TERM 143" "USR1 143" "HUP 143"; do
	rm -f out err
	env --default-signal=HUP "$RBSIM" loads.lua --no-record >out 2>err &
	pid=$!
	until_true begun
	kill -"${case% *}" $pid
	ended "${case#* }" "SIG${case% *} while the scene is loaded"
done

# one that is ignored, as nohup(1) does, stays ignored
env --ignore-signal=HUP "$RBSIM" s.lua --force -q -o ignored.h5 >out 2>err &
pid=$!
until_true has_frames ignored.h5
before=$(ticks)
kill -HUP $pid
until_true works_on
kill -TERM $pid
ended 75 "after SIGHUP"
exits 0 info ignored.h5
says out 'status +interrupted: interrupted by SIGTERM'

# a body whose turn until the next frame takes ages to follow
cat >fast.lua <<'END'
world { gravity = { 0, 0, 0 }, duration = 1, frame_rate = 1, time_step = 1, method = "located" }
local ball = sphere { radius = 1, density = 1, angular_velocity = { 1e13, 0, 0 } }
on_step(function()
	print("begun")
	ball:apply_force({ 0, 1, 0 }, { 1, 0, 0 })
end)
END
rm -f out err
"$RBSIM" fast.lua --no-record >out 2>err &
pid=$!
until_true begun
before=$(ticks)
until_true works_on
kill -TERM $pid
ended 143 "fast turning"

# One that can't come to a whole step soon: a callback that works for a while.
busy_scene | sed 's/^\tlocal x = 0/\tprint("begun")\n&/' >busy.lua
rm -f out err
"$RBSIM" busy.lua --trust --no-record >out 2>err &
pid=$!
until_true begun
before=$(ticks)
kill -INT $pid
until_true works_on
kill -INT $pid
ended 130 "second SIGINT"
