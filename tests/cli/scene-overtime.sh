#!/bin/sh
# SPDX-License-Identifier: MIT
# A script that keeps Lua busy where no hook runs is ended by time, in every way into a scene, with a status; a recording holds
# what was recorded until then.
. tests/cli/functions

case ${RBSIM_MODE:-release} in
tsan) echo "tsan holds signals back where nothing of the system's library is called"; exit 77 ;;
esac
export RBSIM_SCRIPT_SECONDS=0.2
LATE='the script ran longer than [0-9.]+ seconds( within one operation)? \(--trust lifts this\)'

# late STATUS ARGUMENT...
late()
{
	status=$1
	shift
	timeout "$PATIENCE" "$RBSIM" "$@" >out 2>err </dev/null
	got=$?
	[ $got -eq "$status" ] || fail "rbsim $*: exit status $got, wanted $status"
	says err "$LATE"
}

# scene NAME, with more lines on standard input: `busy` ends in no time that one would wait for
scene()
{
	{
		cat <<'END'
world { duration = 0.5, frame_rate = 20, gravity = {0, 0, -9.81} }
local m = material { restitution = 0.5, density = 1000 }
plane { material = m }
local ball = sphere { name = "ball", radius = 0.1, position = {0, 0, 0.3}, material = m }
local function busy()
	local t = {}
	setmetatable(t, t)
	t.__call = t
	t()
end
END
		cat
	} >"$1.lua"
}

# while it is loaded
echo 'busy()' | scene load
late 65 check load.lua
late 65 load.lua --no-record
late 65 load.lua --help
echo 'table.sort({1, 2, 3, 4}, function(a, b) pcall(busy) return a < b end)' | scene sort
late 65 check sort.lua
echo 'local t = function() end for i = 1, 190000 do t = setmetatable({}, { __call = t }) end t()' | scene chain
late 65 check chain.lua
echo 'local function f() return xpcall(f, f) end f()' | scene handlers
late 65 check handlers.lua
echo 'do local x <close> = setmetatable({}, { __close = busy }) end' | scene close
late 65 check close.lua
mkdir lib
echo 'local t = {} setmetatable(t, t) t.__call = t t()' >lib/busy.lua
echo 'require "lib.busy"' | scene require
late 65 check require.lua
echo 'param("n", 1, "a number") busy()' | scene swept
late 65 sweep swept.lua -p n=1,2 -o swept --plan

# while it runs: what was recorded before is there, and told
recorded()
{
	late 65 "$1.lua" -o "$1.h5"
	exits 0 info "$1.h5"
	says out "status +failed: the script ran longer"
	says out "$2 frames of [12] moving bod"
	[ ! -e "$1.h5.partial" ] || fail "$1: the recording was left open"
}
echo 'on_frame(function(t, frame) if frame == 5 then busy() end end)' | scene frame
recorded frame '[56]'
echo 'on_step(function(t) if t > 0.2 then busy() end end)' | scene step
recorded step '[456]'
echo 'on_collision(function() busy() end)' | scene collision
recorded collision '[456]'
echo 'field(function(t) if t > 0.2 then busy() end return {0, 0, 0} end)' | scene field
recorded field '[3456]'
cat <<'END' | scene motion
box { size = {1, 1, 0.1}, position = {5, 0, 0}, material = m, motion = function(t) if t > 0.2 then busy() end return {5, 0, 0} end }
END
recorded motion '[3456]'
echo 'expect("it ends", function() busy() end)' | scene expect
late 65 expect.lua -o expect.h5
exits 0 info expect.h5

# a film that is made from the recording
echo 'camera { position = function(t) if t > 0.2 then busy() end return {0, -3, 1} end, look_at = {0, 0, 0} }' | scene film
exits 0 film.lua -o film.h5 --no-render
late 65 render film.h5 -o film%d.png

# with a checkpoint the run is gone on from, and time has changed nothing of it: what is too long here is not where there is more
cat <<'END' | scene long
local t = function() end
for i = 1, 60000 do t = setmetatable({}, { __call = t }) end
on_frame(function(_, frame)
	if frame == 6 then t() end
end)
END
export RBSIM_SCRIPT_SECONDS=60
exits 0 long.lua -o whole.h5
printf 'at 0.15 checkpoint\n' >commands
export RBSIM_SCRIPT_SECONDS=0.1
late 65 long.lua -o long.h5 --commands commands
[ -s long.h5.checkpoint ] || fail "no checkpoint is left of a run that time ended"
export RBSIM_SCRIPT_SECONDS=60
exits 0 long.lua -o long.h5 --resume
exits 0 diff whole.h5 long.h5

# the time of one call is not that of another: many short ones are no long one
export RBSIM_SCRIPT_SECONDS=0.2
scene many <<'END'
on_step(function() for i = 1, 300000 do end end)
END
exits 0 many.lua --no-record --method classic --time-step 0.001
exit 0
