#!/bin/sh
# SPDX-License-Identifier: MIT
# `steps` counts time steps instead of seconds: in scenes, on the command line, wherever a duration holds.
. tests/cli/functions

cat >n.lua <<'END'
local n = param("n", 12, "steps", {min = 1})
world { steps = n, time_step = 0.0078125, frame_rate = 32 }
sphere { radius = 0.1, velocity = {1, 0, 0} }
expect("as long as the steps", function() return math.abs(time() - 0.0078125 * n), 0 end)
END
# lasts SECONDS FRAMES FILE
lasts()
{
	exits 0 info "$3" --json
	[ "$(value duration)" = "$1" ] || fail "$3 lasts $(value duration) s, wanted $1"
	[ "$(value frames)" = "$2" ] || fail "$3 has $(value frames) frames, wanted $2"
}
exits 0 n.lua
lasts 0.09375 4 n.h5
exits 0 n.lua --force -p n=13
lasts 0.1015625 5 n.h5
exits 1 n.lua --force --steps 4
lasts 0.03125 2 n.h5
exits 1 n.lua --force --steps=4 --time-step 0.015625 --method stepped
lasts 0.0625 3 n.h5
exits 0 replay n.h5
exits 1 n.lua --force --duration 0.5
lasts 0.5 17 n.h5
exits 0 check n.lua --steps 8 --json
[ "$(value duration)" = 0.0625 ] || fail "check: $(value duration) s"
exits 0 check n.lua --json --method stepped
says out '"time_step":0.0078125,"steps":12,'

# the default time step is a quarter of a frame
printf 'world { steps = 30 }\nsphere { radius = 1 }\n' >d.lua
exits 0 d.lua --steps 8
lasts 0.033333333333333333 3 d.h5
exits 0 d.lua --force
lasts 0.125 9 d.h5

# a run goes on where it was, and says when it is another one
exits 64 n.lua --resume --steps 3 -o n.h5
exits 64 d.lua --resume --steps 31
says err 'the duration was 0.125, is 0.129'

# a sweep hands it on; one over the number of steps as well
exits 1 sweep n.lua -p n=1,2 --steps 2 -o s
lasts 0.015625 2 s/point-00000.h5
lasts 0.015625 2 s/point-00001.h5
exits 0 sweep n.lua -p n=4,8 -o v
lasts 0.03125 2 v/point-00000.h5
lasts 0.0625 3 v/point-00001.h5

# every setting of converge lasts as long, whatever its time step
cat >c.lua <<'END'
world { steps = 64, time_step = 0.0078125, gravity = {0, 0, -9.81} }
sphere { name = "ball", radius = 0.1 }
reference(function(t) return { ball = { position = {0, 0, -4.905 * t * t} } } end)
END
exits 0 converge c.lua --dt 0.0078125,0.00390625 --methods classic --runs 1 --json
[ "$(value duration)" = 0.5 ] || fail "converge: $(value duration) s"
errors=$(tr '{' '\n' <out | sed -n 's/.*"position":\([^,}]*\).*/\1/p' | tr '\n' ' ')
exits 0 converge c.lua --dt 0.0078125,0.00390625 --methods classic --runs 1 --duration 0.5 --json
again=$(tr '{' '\n' <out | sed -n 's/.*"position":\([^,}]*\).*/\1/p' | tr '\n' ' ')
[ "$errors" = "$again" ] || fail "converge by steps: $errors, by the duration: $again"

# mistakes
printf 'world { title = "x",\n duration = 1, steps = 10 }\nsphere { radius = 1 }\n' >m.lua
exits 65 m.lua
says err "^m.lua:[12]: world: 'duration' and 'steps' exclude each other"
for wrong in 0 -3 2.5 '"many"'; do
	printf 'world { steps = %s }\nsphere { radius = 1 }\n' "$wrong" >m.lua
	exits 65 m.lua
	says err "^m.lua:1: world: 'steps' must be"
done
printf 'world { steps = 3, time_step = -1 }\nsphere { radius = 1 }\n' >m.lua
exits 65 m.lua
says err "'time_step' must be positive"
printf 'sphere { radius = 1 }\nworld { frame_rate = 10 }\n' >m.lua
exits 65 m.lua
says err "^m.lua:2: world: 'duration' is missing"
exits 65 m.lua --duration 1e300
says err "^m.lua: world: 'duration' 1e\+300 s times"
printf 'sphere { radius = 1 }\n' >m.lua
exits 65 m.lua
says err "^m.lua: world: 'duration' is missing .*'steps'"
exits 0 m.lua --steps 4 --no-record
exits 64 n.lua --steps 4 --duration 1
says err "'--steps' contradicts '--duration'"
exits 64 n.lua --steps 2.5
exits 64 n.lua --steps 0
