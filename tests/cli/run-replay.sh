#!/bin/sh
# SPDX-License-Identifier: MIT
# replay says whether a recording's run comes to the same bits again, and where not; repair makes what a killed run has left
# a plain file, which is gone on with all the same.
. tests/cli/functions
python=
for p in /usr/bin/python3 python3; do
	$p -c 'import h5py' 2>/dev/null && { python=$p; break; }
done

cat >s.lua <<'END'
local v = param("v", 1, "speed")
world { duration = 2, gravity = {0, 0, -9.81}, frame_rate = 50 }
local m = material { name = "m", density = 1000, friction = 0.3, restitution = 0.8 }
plane { normal = {0, 0, 1}, material = m }
for i = 0, 4 do sphere { name = "b" .. i, radius = 0.1, position = {0.3 * i, 0, 0.5}, velocity = {v * math.random(), 0, 0}, material = m } end
on_step(function() body("b3"):apply_force({math.random() - 0.5, 0, 0}) end)
on_frame(function(t, k) if k % 25 == 0 then body("b1"):apply_impulse({0, math.random(), 5}) end end)
END

# ---- replay ----

exits 0 s.lua -q -o r.h5 --threads 1 -p v=2 --seed 5 --time-step 0.004
hash=$(h5dump -d /rbsim/state_hash r.h5 2>/dev/null | sed -n 's/.*"\([0-9a-f]\{16\}\)".*/\1/p')
rm -f s.lua.kept && mv s.lua s.lua.kept # it needs nothing but the recording
for threads in 1 3; do
	exits 0 replay r.h5 --threads $threads
	says out "^the same to the bit: 101 frames, state hash $hash$"
done
exits 0 replay r.h5 --json
[ "$(value same)" = true ] && [ "$(value state_hash)" = "$hash" ] || fail "JSON: $(cat out)"
exits 0 replay r.h5 --quiet
says_nothing out
mv s.lua.kept s.lua
for record in 'every = 7' 'precision = "single", compression = 2' 'fields = {"position"}'; do
	(cat s.lua; echo "record { $record }") >other.lua
	exits 0 other.lua -q -o other.h5 --force
	exits 0 replay other.h5
	says out '^the same to the bit'
done
exits 0 s.lua -q -o classic.h5 --method classic
exits 0 replay classic.h5
printf 'at 0.5 quit\n' >commands
exits 130 s.lua -q -o quit.h5 --commands commands
exits 0 replay quit.h5
says out '^the same to the bit: 26 frames'

if [ -n "$python" ]; then
	# one bit of one number, and the hash alone
	cp r.h5 bit.h5
	$python - <<'END'
import h5py, numpy
values = h5py.File("bit.h5", "r+")["particles/bodies/position/value"]
values[40, 3, 1] = numpy.nextafter(values[40, 3, 1], 9)
END
	exits 1 replay bit.h5
	says out "differs first at frame 40: position of 'b3': "
	exits 1 replay bit.h5 --json
	[ "$(value first_difference)" = 40 ] && [ "$(value same)" = false ] || fail "JSON: $(cat out)"
	cp r.h5 hash.h5
	$python -c 'import h5py; h5py.File("hash.h5", "r+")["rbsim/state_hash"][()] = b"0123456789abcdef"'
	exits 1 replay hash.h5
	says out 'the same 101 frames, but ends in another state: 0123456789abcdef recorded'
fi
echo text >text.h5
exits 66 replay text.h5
exits 66 replay nothing.h5

# ---- repair ----

sed 's/duration = 2,/duration = 100,/; $a on_frame(function() local x = 0 for i = 1, 2e4 do x = x + i end end)' s.lua >long.lua
exits 0 long.lua -q -o whole.h5
pid=
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
"$RBSIM" long.lua -q -o k.h5 --checkpoint-every 0.1 >out 2>err &
pid=$!
until_true [ -s k.h5.checkpoint~ ]
exits 73 repair k.h5 # while it goes on
says err "the run that writes it goes on"
exits 73 s.lua -o k.h5 --force # which would lose it, after hours of work
says err "cannot write to 'k.h5': the run that writes it goes on"
kill -9 $pid || fail "the run was over before it was killed"
wait $pid
pid=
exits 0 info k.h5 --json
[ "$(value status)" = running ] || fail "a killed run is '$(value status)'"
frames=$(value frames)
exits 0 replay k.h5
cp k.h5 json.h5
exits 0 repair k.h5
says out "'k.h5' is a plain file: $frames frames, interrupted: the process was killed"
exits 0 repair json.h5 --json
[ "$(value frames)" = "$frames" ] || fail "JSON: $(cat out)"
exits 0 info k.h5 --json
[ "$(value status)" = interrupted ] && [ "$(value frames)" = "$frames" ] || fail "after repair: $(cat out)"
if [ -n "$python" ]; then
	$python -c 'import h5py, sys; sys.exit(len(h5py.File("k.h5", "r")["particles/bodies/position/value"]) != int(sys.argv[1]))' "$frames" ||
		fail "h5py does not find $frames frames in the repaired file"
fi
exits 1 diff whole.h5 k.h5
says out '^the same as far as both go'
exits 0 repair k.h5 # once more
exits 0 info k.h5 --json
[ "$(value frames)" = "$frames" ] || fail "the second repair has lost frames"
exits 0 long.lua -o k.h5 --resume
! grep -q 'from the beginning' err || fail "after repair the run began anew"
exits 0 diff whole.h5 k.h5
exits 0 replay k.h5 --quiet
exits 0 repair k.h5
says out 'complete'
exits 0 diff whole.h5 k.h5
for file in text.h5 nothing.h5 .; do exits 66 repair $file; done
: >empty.h5
exits 66 repair empty.h5

# a run that its scene has ended: what it has recorded is compared, at whatever frame that was
for last in 0 3; do
	small_scene "on_frame(function(t, k) if k == $last then error('enough') end end)" >ends.lua
	exits 65 ends.lua -o ends.h5 -q --force
	exits 0 replay ends.h5
	says out "^the same to the bit: $((last + 1)) frame"
done
