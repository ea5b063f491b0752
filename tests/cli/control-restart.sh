#!/bin/sh
# SPDX-License-Identifier: MIT
# restart: the same scene gives the same bits, a parameter that was set takes effect, outputs are replaced, who watches stays.
. tests/cli/functions

scene()
{
	cat <<END
local e = param("e", 0.75, "restitution", {min = 0, max = 1})
local z = param("z", 2.0, "height")
world { title = "$1", duration = 2, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = e, density = 1000 }
plane { normal = {0, 0, 1}, material = m }
sphere { name = "ball", radius = 0.1, position = {0, 0, z}, material = m }
expect("it comes down", function() return body("ball").position.z < 1 end)
END
}
scene one >s.lua
exits 0 s.lua -o plain.h5 --json
hash=$(value state_hash)
exits 0 s.lua -o other.h5 --param e=0.25 --json
other=$(value state_hash)
[ "$hash" != "$other" ] || fail "the parameter does not matter"

# in the middle, from a file
printf 'at 0.2 set e 0.5\nat 0.4 restart\nat 0.6 set e 0.25\nat 0.8 restart\nat 1 set e 0.75\nat 1 restart\n' >commands
exits 0 s.lua -o again.h5 --commands commands -q
exits 0 diff plain.h5 again.h5
printf 'at 1 set e 0.25\nat 1 restart\n' >commands
exits 0 s.lua -o again.h5 --commands commands --force -q
exits 0 diff other.h5 again.h5
exits 0 info again.h5 --json
[ "$(value status)" = complete ] || fail "the recording is '$(value status)'"

# the result is that of the last run, and its expectations are looked at once
printf 'at 1.9 restart\n' >commands
exits 0 s.lua --no-record --commands commands --json
[ "$(value state_hash)" = "$hash" ] || fail "without a recording: another state hash"
[ "$(value frames)" = 121 ] || fail "$(value frames) frames"

# who watches stays connected; the first recording of the run is replaced without --force, but not that of another run
pid=
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
echo pause >commands
exits 73 s.lua -o plain.h5 --listen s --commands commands
[ ! -e s ] || fail "a run that is refused has made a socket"
"$RBSIM" s.lua -o live.h5 --listen s --commands commands --json >out 2>err &
pid=$!
state()
{
	"$RBSIM" ctl s status | sed -n "s/^$1 //p"
}
is()
{
	[ "$(state "$1")" = "$2" ]
}
until_true [ -S s ]
until_true is state paused
"$RBSIM" ctl s step 100 >/dev/null
until_true is frame 100
scene two >s.lua # what is restarted is the scene as it was read
"$RBSIM" ctl s set e 0.25 >/dev/null || fail "set was refused"
"$RBSIM" ctl s restart >/dev/null || fail "restart was refused"
until_true is restarts 1
until_true is state paused
[ "$(state frame)" = 0 ] || fail "a paused run stands at frame $(state frame) after its restart"
[ "$("$RBSIM" ctl s hello | sed -n 's/^title //p')" = one ] || fail "the scene on disk was taken"
"$RBSIM" ctl s step 50 >/dev/null
until_true is frame 50

# a value that the scene itself refuses: the run stays as it is
"$RBSIM" ctl s set z -1 >/dev/null || fail "a number was refused"
"$RBSIM" ctl s restart >/dev/null
told()
{
	"$RBSIM" ctl s events | grep -q 'cannot restart, the run is paused'
}
until_true told
until_true is state paused
[ "$(state frame)" = 50 ] || fail "the run went on to frame $(state frame)"
says err 'warning: cannot restart: .*overlap|warning: cannot restart: .*ball'
"$RBSIM" ctl s set z 2 >/dev/null
"$RBSIM" ctl s play >/dev/null
ended 0 "the run"
[ "$(value state_hash)" = "$other" ] || fail "after it was set and restarted: another state hash"
exits 0 diff other.h5 live.h5

# signals end whichever run it is
for n in 1 2 3; do
	echo 'at 0.5 restart' >commands
	long_scene >l.lua
	"$RBSIM" l.lua -o l.h5 --force --listen s --commands commands -q >out 2>err &
	pid=$!
	until_true [ -S s ]
	for _ in 1 2 3 4 5 6; do
		"$RBSIM" ctl s restart >/dev/null 2>&1
	done
	kill -TERM $pid
	wait $pid
	got=$?
	pid=
	[ $got -eq 75 ] || [ $got -eq 143 ] || fail "SIGTERM among restarts ($n): exit status $got"
	[ ! -e s ] || fail "SIGTERM among restarts: the socket is still there"
	exits 0 info l.h5
done

# a signal is heard while the scene is loaded anew: the run that goes on until then ends with its checkpoint
cat >slow.lua <<'END'
local n = param("n", 1)
print("loads")
for i = 1, n do end
world { duration = 2 }
sphere { radius = 0.1 }
END
printf 'at 0.2 set n 40000000000\nat 0.2 restart\n' >commands
"$RBSIM" slow.lua --commands commands >out 2>err &
pid=$!
until_true sh -c '[ "$(grep -c loads err)" -eq 2 ]'
kill -TERM $pid
ended 75 "SIGTERM while it restarts"
grep -q 'ran longer than' err && fail "the signal waited for the scene: $(cat err)"
exits 0 slow.lua --resume -q
exits 0 info slow.h5 --json
[ "$(value frames)" = 121 ] || fail "$(value frames) frames after a signal while it restarted"

# films are made anew as well, by the cameras of the scene as it was read
[ -f "$(dirname "$RBSIM")/rbsim-film.so" ] || exit 0
cat >film.lua <<'END'
local e = param("e", 0.75)
world { duration = 0.5, frame_rate = 20, gravity = {0, 0, -9.81} }
plane { texture = "checker" }
sphere { radius = 0.5, position = {0, 0, 1}, material = material { restitution = e } }
camera { name = "side", position = {0, -6, 1}, look_at = {0, 0, 1}, size = {64, 48}, samples = 1, png = "side/%03d.png" }
END
exits 0 film.lua -o f.h5 -q
[ "$(find side -name '*.png' | wc -l)" -eq 11 ] || exit 0 # no pictures can be made here
mv side plain
printf 'at 0.2 restart\nat 0.4 restart\n' >commands
exits 0 film.lua -o g.h5 -q --commands commands
exits 0 diff f.h5 g.h5
[ "$(find side -name '*.png' | wc -l)" -eq 11 ] || fail "$(find side -name '*.png' | wc -l) pictures after restarts"
[ -z "$(find . -name '*partial*')" ] || fail "left behind: $(find . -name '*partial*')"
