#!/bin/sh
# SPDX-License-Identifier: MIT
# A scene's own results and probes: summary, JSON, recording, info, replay, diff, resume, the table of a sweep, mistakes.
. tests/cli/functions

cat >own.lua <<'END'
local e = param("e", 0.5, "restitution", {min = 0, max = 1})
world { duration = 1, frame_rate = 30, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = e, density = 1000 }
plane { normal = {0, 0, 1}, material = m }
local ball = sphere { name = "ball", radius = 0.1, position = {0, 0, 1}, material = m }
local calls = 0
probe("height", function() calls = calls + 1 return ball.position.z end, {unit = "m", description = "of the centre"})
probe("energy/weight", function() return ball.velocity.z < 0 and 0/0 or energy() / (9.81 * ball.mass) end, {unit = "m"})
result("probe calls", function() return calls end)
result("time", function() return time() end, {unit = "s"})
result("no value", function() return 0/0 end)
result("endless", function() return math.huge end)
END
exits 0 own.lua
says err '^  results       4$'
says err '^    probe calls: 31$'
says err '^    time: 1 s$'
says err '^    no value: no value$'
says err '^  probes        2, at the last frame'
says err '^    height: 0\.[0-9]* m \(0\.1[0-9]* to 1\)$'
exits 0 own.lua --json --force
says out '"results":\{"probe calls":\{"value":31,"unit":""\},"time":\{"value":1,"unit":"s"\},"no value":\{"value":null,"unit":""\}'
says out '"probes":\{"height":\{"last":0\.[0-9]*,"smallest":0\.1[0-9]*,"largest":1,"unit":"m"\}'
exits 0 info own.h5
says out '^  results     probe calls: 31$'
says out '^  probes      height \[m\]$'
exits 0 replay own.h5
exits 0 own.lua --no-record --json
says out '"probe calls":\{"value":31'

# frames that are left out are measured all the same, and another number in a recording is found
sed 's/1, frame_rate = 30/1, frame_rate = 30/; $a record { every = 7 }' own.lua >seldom.lua
exits 0 seldom.lua -q
exits 0 seldom.lua --json --force
says out '"probe calls":\{"value":31'
exits 0 replay seldom.h5
sed 's/return calls end/return calls + 1 end/' own.lua >other.lua
exits 0 other.lua -q
exits 1 diff own.h5 other.h5
says out "result 'probe calls' is 31 in 'own.h5' and 32 in 'other.h5'"
sed 's/return ball.position.z end/return ball.position.z + 1 end/' own.lua >other.lua
exits 0 other.lua -q --force
exits 1 diff own.h5 other.h5
says out "frame 0 \(0 s\): probe 'height' is 1 in 'own.h5' and 2 in 'other.h5'"

# a random number that a function of time did not have: replay says which probe
cat >>other.lua <<'END'
probe("late", function() return 1 end)
END
exits 0 other.lua -q --force
exits 0 replay other.h5

# sweeps: columns of the table, units, a result that has the name of a number of every run
exits 0 sweep own.lua -p e=0.2,0.4,0.9 -o d -q
exits 0 collect d -q
exits 0 collect d --csv
head -n 1 out >names
says names ',probe calls,time: result,no value,endless,height: last,height: smallest,height: largest,energy/weight: last,'
sed -n 2p out | says /dev/stdin ',31,1,,,'

# mistakes of the scene, all told at once
cat >wrong.lua <<'END'
world { duration = 1 }
sphere { radius = 0.1, mass = 1 }
probe("a", 1)
result("", function() end)
result("b", function() return 1 end, {units = "m"})
result("b", function() return 1 end)
result("b", function() return 1 end)
probe("c", function() return 1 end, {unit = 1})
probe("line\nbreak", function() return 1 end)
END
exits 65 wrong.lua
says err "wrong.lua:3: probe 'a': wants a name and a function, .*got 1 for the function"
says err "wrong.lua:4: result '': the name must have 1 to 63 bytes"
says err "wrong.lua:5: result 'b': unknown key 'units' .did you mean 'unit'"
says err "wrong.lua:6: result 'b': there is one of that name already, in line 5"
says err "wrong.lua:8: probe 'c': 'unit' must be"
says err "wrong.lua:9: .*the name must have"
echo 'result = 1' >>wrong.lua
exits 65 wrong.lua
says err "'result' is a call of the scene language: write result\(name, function"
printf 'world { duration = 1 }\nfor i = 1, 257 do probe("p" .. i, function() return i end) end\nsphere { radius = 1 }\n' >many.lua
exits 65 many.lua
says err 'more than 256 of them'
sed -i 's/257/256/' many.lua
exits 0 many.lua -q
exits 0 info many.h5 --json
says out '"p256":'
exits 0 replay many.h5

# errors in the functions: of a probe the run has failed, of a result it is whole
cat >broken.lua <<'END'
world { duration = 1, frame_rate = 10 }
local b = sphere { name = "b", radius = 0.1, mass = 1, velocity = {1, 0, 0} }
probe("p", function()
	if b.position.x > 0.45 then return nil end
	return 1
end)
END
exits 65 broken.lua
says err "broken.lua:3: probe 'p': the function must return a number .got nothing"
exits 0 info broken.h5
says out 'status      failed'
says out 'broken.h5: 5 frames'
exits 65 broken.lua --force --debug
says err "broken.lua:3: probe 'p': the function must return a number .got nothing"
cat >late.lua <<'END'
world { duration = 1, frame_rate = 10 }
local b = sphere { name = "b", radius = 0.1, mass = 1, velocity = {1, 0, 0} }
result("first", function() return 1 end)
result("second", function() b:set_velocity({0, 0, 0}) end)
result("third", function() return 3 end)
END
exits 65 late.lua
says err 'late.lua:4: '
exits 0 info late.h5
says out 'status      complete'
says out '^  results     first: 1$'
says out 'third: no value'

# what goes on from a checkpoint ends with the same bits, probes' smallest and largest included
cat >long.lua <<'END'
world { duration = 2000, frame_rate = 60, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = 1, density = 1000, friction = 0 }
plane { normal = {0, 0, 1}, material = m }
local ball = sphere { name = "ball", radius = 0.1, position = {0, 0, 1}, velocity = {0, 0, 5}, material = m }
probe("height", function() return time() < 1 and ball.position.z or 0/0 end, {unit = "m"})
result("final height", function() return ball.position.z end, {unit = "m"})
END
exits 0 long.lua --json --no-record
sed 's/.*"probes"/"probes"/; s/,"films".*//' out >whole
"$RBSIM" long.lua -q -o long.h5 &
run=$!
until_true test -f long.h5
sleep 0.5
kill -USR1 $run
wait $run
status=$?
if [ $status = 75 ]; then
	exits 0 long.lua -o long.h5 --resume --json
	sed 's/.*"probes"/"probes"/; s/,"films".*//' out >gone_on
	cmp whole gone_on || fail "another result after --resume"
elif [ $status != 0 ]; then
	fail "status $status"
fi
exits 0 replay long.h5
