#!/bin/sh
# SPDX-License-Identifier: MIT
# diff finds the first frame and body at which two recordings differ, and by how much.
. tests/cli/functions

cat >s.lua <<'END'
local kick = param("kick", 0.0, "m/s that one ball gets at 0.25 s")
local extra = param("extra", false, "a third ball")
local bare = param("bare", false, "without velocities")
world { duration = param("duration", 0.5, "s"), frame_rate = param("rate", 60, "Hz"), gravity = {0, 0, -9.81} }
sphere { name = "left", radius = 0.1, position = {-0.5, 0, 2}, angular_velocity = {0, 0, param("spin", 0.5, "rad/s")} }
local right = sphere { name = "right", radius = 0.1, position = {0.5, 0, 2} }
record { fields = bare and {"position", "orientation"} or {"position", "orientation", "velocity", "angular_velocity"},
	every = param("every", 1, "frames") }
if extra then sphere { radius = 0.1, position = {0, 5, 2} } end
if kick ~= 0 then
	on_step(function(t) if t == 0.25 then right:set_velocity({kick, 0, right.velocity.z}) end end)
end
END
exits 0 s.lua -q -o a.h5
exits 0 s.lua -q -o same.h5
exits 0 diff a.h5 same.h5
says out 'the same to the bit: 31 frames of 2 bodies'
exits 0 diff a.h5 same.h5 --json
says out '"same":true'
printf 'world { duration = 1e-9, frame_rate = 1 }\nsphere { radius = 1 }\n' >one.lua
exits 0 one.lua -q
exits 0 diff one.h5 one.h5
says out 'the same to the bit: 2 frames of 1 body$'

exits 0 s.lua -q -o kicked.h5 --param kick=1e-9
exits 1 diff a.h5 kicked.h5
says out "frame 16 .*body 'right': position differs by [0-9.e-]* m "
exits 1 diff a.h5 kicked.h5 --json
[ "$(value frame)" = 16 ] || fail "frame $(value frame)"
[ "$(value name)" = right ] || fail "name $(value name)"
says out '"column":"position"'
exits 1 diff a.h5 kicked.h5 -q
says_nothing out
# frames are told by their numbers also where only every fourth is recorded
exits 0 s.lua -q -o a4.h5 --param every=4
exits 0 s.lua -q -o kicked4.h5 --param every=4 --param kick=1e-9
exits 1 diff a4.h5 kicked4.h5
says out "^frame 16 \(0.26666"
exits 1 diff a4.h5 kicked4.h5 --json
[ "$(value frame)" = 16 ] || fail "frame $(value frame)"
exits 1 diff a.h5 a4.h5
says out "'a.h5' has frame 1 at 0.016.* s where 'a4.h5' has frame 4 at 0.06"

exits 0 s.lua -q -o more.h5 --param extra=true
exits 1 diff a.h5 more.h5
says out "bodies differ: 'a.h5' has 2 moving .* 'more.h5' has 3"
exits 0 s.lua -q -o short.h5 --param duration=0.25
exits 1 diff a.h5 short.h5
says out "'a.h5' has 31 frames and 'short.h5' has 16"
exits 0 s.lua -q -o rate.h5 --param rate=50
exits 1 diff a.h5 rate.h5
says out "'a.h5' has frame 1 at 0.01666666666666666[0-9]* s where 'rate.h5' has frame 1 at 0.02[0-9]* s$"
exits 1 diff rate.h5 a.h5 --json
says out '"difference":"times".*"frame":1,"time":\[0.02[0-9]*,0.0166[0-9]*\]'
exits 0 s.lua -q -o bare.h5 --param bare=true
for order in "a.h5 bare.h5" "bare.h5 a.h5"; do
	# shellcheck disable=SC2086 # two names
	exits 1 diff $order
	says out "^only 'a.h5' has the column 'velocity'; what both have is the same$"
	says out "^only 'a.h5' has the column 'angular_velocity'; "
	[ "$(wc -l <out)" -eq 2 ] || fail "more than the two columns are told"
done
exits 66 diff a.h5 missing.h5
says err 'missing.h5'

if [ -e /dev/full ]; then
	for other in same kicked; do
		"$RBSIM" diff a.h5 $other.h5 >/dev/full 2>err
		got=$?
		[ $got -eq 74 ] || fail "diff >/dev/full of a $other recording: $got, not 74"
		says err 'cannot write standard output'
	done
fi
