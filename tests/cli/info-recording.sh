#!/bin/sh
# SPDX-License-Identifier: MIT
# info tells what is in a recording: whole ones, one that grows, one whose run was killed.
. tests/cli/functions

small_scene 'param("e", 0.5, "unused")' >s.lua
exits 0 s.lua -q --param e=0.25
exits 0 info s.h5
says out '^s.h5: 31 frames of 2 moving bodies \(and 1 that is static\), 0 to 0.5 s of 0.5 s'
says out 'title +Two balls'
says out 'status +complete'
says out 'columns +position orientation velocity angular_velocity'
says out 'e = 0.25'
says out 'energy'
says out 'momentum'
says out 'overlap'
says out 'command +.*s.lua -q --param e=0.25'
# what it adds up is what the run has summed up
exits 0 s.lua --param e=0.25 --json -o again.h5
cp out again.json
exits 0 info s.h5 --json
python3 - <<'END' || fail "the energies of the run are others"
import json
run, told = json.load(open("again.json")), json.load(open("out"))
for end in "first", "last":
    assert run[end]["kinetic_energy"] + run[end]["potential_energy"] == told["energy_" + end], end
assert told["energy_first"] != told["energy_last"]
assert told["smallest_step"] == run["smallest_step"]
END
exits 0 info s.h5 --json
[ "$(value frames)" = 31 ] || fail "frames: $(value frames)"
[ "$(value status)" = complete ] || fail "status"
says out "\"files\":\[\"s.lua\"\],\"file_sizes\":\[$(wc -c <s.lua)\]"
exits 0 info s.h5
says out "files +s.lua, $(wc -c <s.lua) bytes \(see --scene\)"
exits 0 info s.h5 --scene
cmp -s out s.lua || fail "--scene is not the scene"
exits 0 info s.h5 --scene --json
says out '^\{"file":"s.h5","scene":"world .*\\n.*","exit_status":0\}$'
echo "not a recording" >text.h5
exits 66 info text.h5
exits 66 info .

long_scene >long.lua
"$RBSIM" long.lua -q &
pid=$!
trap 'kill -9 $pid 2>/dev/null' EXIT
growing()
{
	"$RBSIM" info long.h5 --json >out 2>err && [ "$(value frames)" -gt 1 ]
}
until_true growing
[ "$(value status)" = running ] || fail "status of a growing recording: $(value status)"
first=$(value frames)
grown()
{
	growing && [ "$(value frames)" -gt "$first" ]
}
until_true grown
kill -9 $pid
wait $pid 2>/dev/null
growing || fail "unreadable after kill -9"
frames=$(value frames)
[ "$frames" -ge "$first" ] || fail "$frames frames after kill -9, $first before"
exits 0 info long.h5
says out 'status +running'
touch -d '100 seconds ago' long.h5 # nothing in it tells that nobody writes it
exits 0 info long.h5
says out 'status +running, unless its process was killed: last written 1[0-9][0-9] s ago'
exits 0 info long.h5 --json
[ "$(value seconds_since_written)" -ge 100 ] || fail "$(cat out)"
