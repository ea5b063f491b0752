#!/bin/sh
# SPDX-License-Identifier: MIT
# --resume: runs that were interrupted come to the same bits as one that was not; what can't be gone on with is refused.
. tests/cli/functions

# what h5dump says, without the file's name and where in it the scales of axes stand
plain()
{
	sed '/^HDF5/d; s/DATASET [0-9][0-9]* "/DATASET "/g'
}

# interrupted SCENE COUNT OPTION...: whole as whole.h5, and broken off COUNT times, with other numbers of threads, as b.h5
interrupted()
{
	scene=$1 count=$2
	shift 2
	[ "${RBSIM_MODE:-release}" = release ] || count=1
	rm -rf whole broken
	mkdir whole broken
	(cd whole && "$RBSIM" ../$scene -o r.h5 --threads 1 -q "$@" >out 2>err) || fail "$scene: the whole run failed"
	exits 0 info whole/r.h5 --json
	duration=$(value duration)
	more=
	for i in $(seq $count); do
		at=$(awk "BEGIN { print $duration * $i / ($count + 1) }")
		printf 'at %s checkpoint\nat %s quit\n' "$at" "$(awk "BEGIN { print $at + $duration / 24 }")" >commands
		(cd broken && "$RBSIM" ../$scene -o r.h5 --threads $((i % 3 + 1)) -q $more --commands ../commands "$@" >out 2>err)
		[ $? -eq 130 ] || { cat broken/err >&2; fail "$scene: part $i ended otherwise"; }
		[ -s broken/r.h5.checkpoint ] || fail "$scene: no checkpoint after part $i"
		more=--resume
	done
	(cd broken && "$RBSIM" ../$scene -o r.h5 -q --resume "$@" >out 2>err) ||
		{ cat broken/err >&2; fail "$scene: the last part failed"; }
	exits 0 diff whole/r.h5 broken/r.h5
	for file in whole/r.h5 broken/r.h5; do
		h5dump -w 0 -d /rbsim/state_hash -d /observables/collisions/value -d /observables/kinetic_energy/value \
			-d /observables/smallest_step/value -d /observables/substeps/value $file 2>/dev/null |
			plain >${file%/*}.numbers
		h5dump -w 0 -g /observables/ledger $file 2>/dev/null | plain >>${file%/*}.numbers
		h5dump -w 0 -g /rbsim/events $file 2>/dev/null | plain >${file%/*}.events
	done
	cmp whole.numbers broken.numbers || fail "$scene: observables differ"
	cmp whole.events broken.events || fail "$scene: events differ"
	rm -f whole/r.h5 broken/r.h5 whole/out whole/err broken/out broken/err
	diff -r whole broken >&2 || fail "$scene: what else is there differs"
}

# gas on its own clocks, with cells of two levels; events recorded
cat >gas.lua <<'END'
world { duration = 3, frame_rate = 30 }
local m = material { name = "m", density = 1000, friction = 0, restitution = 1 }
for i = -1, 1, 2 do
	plane { normal = {-i, 0, 0}, point = {i, 0, 0}, material = m }
	plane { normal = {0, -i, 0}, point = {0, i, 0}, material = m }
	plane { normal = {0, 0, -i}, point = {0, 0, i}, material = m }
end
for i = 0, 63 do
	sphere { radius = i % 7 == 0 and 0.1 or 0.04, material = m,
		position = {-0.7 + 0.45 * (i % 4), -0.7 + 0.45 * (i // 4 % 4), -0.7 + 0.45 * (i // 16)},
		velocity = {math.random() - 0.5, math.random() - 0.5, math.random() - 0.5} }
end
record { fields = {"position", "velocity", "events"} }
END
interrupted gas.lua 3
interrupted gas.lua 2 --rollback global

# lasting contacts: a stack and a ball that rolls up to it, over a rim
cat >stack.lua <<'END'
world { duration = 3, gravity = {0, 0, -9.81}, frame_rate = 50 }
local m = material { name = "m", density = 1000, friction = 0.4, restitution = 0.3 }
plane { normal = {0, 0, 1}, size = {6, 2}, material = m }
for i = 0, 3 do sphere { radius = 0.1, position = {0.001 * i, 0, 0.1 + 0.2 * i}, material = m } end
sphere { radius = 0.12, position = {-1, 0.01, 0.12}, velocity = {1.5, 0, 0}, material = m }
sphere { radius = 0.1, position = {2, 0, 0.5}, velocity = {1, 0, 0}, angular_velocity = {3, 40, 0}, material = m }
record { fields = {"position", "orientation", "velocity", "angular_velocity", "events", "contacts"} }
END
interrupted stack.lua 4

# forces without a closed form, a driven floor, forces that begin and end
cat >forces.lua <<'END'
world { duration = 2, gravity = {0, 0, -9.81}, frame_rate = 40 }
local m = material { name = "m", density = 1000, friction = 0.3, restitution = 0.5 }
plane { normal = {0, 0, 1}, material = m, motion = function(t) return {0, 0, 0.02 * (1 - math.cos(12 * t))} end }
local a = sphere { name = "a", radius = 0.1, position = {0, 0, 0.3}, material = m }
local b = sphere { name = "b", radius = 0.1, position = {0.5, 0, 0.6}, material = m,
	forces = {{vector = {3, 0, 0}, start = 0.4, duration = 0.7}} }
sphere { name = "c", radius = 0.1, position = {1.5, 0, 0.1}, material = m }
spring { a = a, b = b, stiffness = 200, rest_length = 0.5 }
drag { linear = 0.2 }
END
"$RBSIM" check forces.lua >out 2>err || fail "forces.lua does not load"
interrupted forces.lua 4

# the classic method, with what it leaves out of frames in between
sed 's/frame_rate = 50/frame_rate = 50, method = "classic"/; s/record {/record { every = 3,/' stack.lua >classic.lua
interrupted classic.lua 3
sed 's/frame_rate = 50/frame_rate = 50, method = "classic", rollback = "global"/; s/record {.*/record { precision = "single", compression = 3 }/' \
	stack.lua >single.lua
interrupted single.lua 2

# too dense to locate: auto steps for a while
cat >dense.lua <<'END'
world { duration = 0.6, gravity = {0, 0, -9.81}, frame_rate = 60, time_step = 0.01 }
local m = material { name = "m", density = 1000, friction = 0.5, restitution = 0.1 }
plane { normal = {0, 0, 1}, material = m }
for i = 0, 39 do
	sphere { radius = 0.05, position = {0.102 * (i % 3) + 0.0001 * i, 0.102 * (i // 3 % 3), 0.06 + 0.11 * (i // 9)}, material = m }
end
END
interrupted dense.lua 3

# a crowd that flies apart: auto steps while it is one, and then locates again
cat >quiet.lua <<'END'
world { duration = 20, frame_rate = 20, gravity = {0, 0, 0}, time_step = 1 / 240 }
local m = material { name = "m", friction = 0.5, restitution = 0.3, density = 1000 }
for k = 0, 63 do
	local x, y, z = k % 4 - 1.5, k // 4 % 4 - 1.5, k // 16 - 1.5
	box { material = m, size = {0.25, 0.25, 0.25}, position = {0.3 * x, 0.3 * y, 0.3 * z},
		velocity = {-x + 0.1 * y, -y + 0.1 * z, -z}, angular_velocity = {1, k / 8, 0} }
end
END
exits 0 quiet.lua --json --quiet --no-record
awk -v s="$(value stepped)" 'BEGIN { exit !(s > 0.5 && s < 12) }' || fail "a crowd that flies apart: stepped $(value stepped) s of 20"
interrupted quiet.lua 2

# faces and edges that touch at several points, located and stepped
cat >boxes.lua <<'END'
world { duration = 1.2, gravity = {0, 0, -9.81}, frame_rate = 40 }
local m = material { name = "m", density = 1000, friction = 0.5, restitution = 0.2 }
plane { normal = {0, 0, 1}, material = m }
for i = 0, 2 do box { size = {0.2, 0.2, 0.2}, position = {0.01 * i, 0, 0.1 + 0.201 * i}, material = m } end
capsule { radius = 0.08, length = 0.3, position = {0.8, 0, 0.4}, velocity = {-0.5, 0, 0}, angular_velocity = {1, 2, 3}, material = m }
cylinder { radius = 0.1, length = 0.2, position = {-0.8, 0.1, 0.5}, angular_velocity = {3, 0.2, 1}, material = m }
record { fields = {"position", "orientation", "velocity", "angular_velocity", "events", "contacts"} }
END
interrupted boxes.lua 4
interrupted boxes.lua 3 --method stepped
interrupted dense.lua 2 --method stepped

# callbacks that push, remember and draw numbers; what they have seen is an expectation
cat >script.lua <<'END'
world { duration = 2, gravity = {0, 0, -9.81}, frame_rate = 50, seed = 7 }
local m = material { name = "m", density = 1000, friction = 0.3, restitution = 0.8 }
plane { normal = {0, 0, 1}, material = m }
local ball = sphere { name = "ball", radius = 0.1, position = {0, 0, 1}, material = m }
sphere { name = "other", radius = 0.1, position = {1, 0, 1}, material = m }
state.list, state.count, state.max = {}, 0, -1 / 0
local list = state.list
state.same, state.ring = list, {n = 1}
state.ring.ring = state.ring
on_step(function(t, dt) if t > 0.5 then ball:apply_force({math.random() - 0.5, 0, 0}) end end)
on_frame(function(t, k)
	state.count = state.count + 1
	state.last, state.at, state.half = ball, ball.position, k / 2
	list[#list + 1] = {t = t, hit = false, k = k}
	if k % 17 == 0 then ball:apply_impulse({0, math.random(), 0}) end
end)
on_collision(function(c) if #list > 0 then list[#list].hit = c.impulse end end)
expect("every frame was seen, once", function() return state.count == 101 and #list == 101 end)
expect("what was one table is one", function() return state.same == list and state.ring.ring == state.ring end)
expect("numbers kept their kind", function()
	return math.type(list[50].k) == "integer" and math.type(state.half) == "float" and state.max == -1 / 0
end)
expect("bodies and vectors are what they were", function()
	return state.last == ball and (state.at + vec3(0, 0, 1)).z == ball.position.z + 1
end)
expect_always("it stays above", function() return ball.position.z >= 0 end)
END
interrupted script.lua 5

# The state at the end is that of the last frame, wherever within the next one the run ends: a signal that does not wait for its
# end is a matter of time, an error of a callback in its third step of four is not.
sed '/^expect/,$d' script.lua >last.lua
sed 's/^on_step(function(t, dt)/& if t > 0.75 then error("here") end/' last.lua >within.lua
printf 'at 0.74 quit\n' >commands
for method in located auto stepped classic; do
	exits 130 last.lua -q -o last.h5 --force --method $method --time-step 0.005 --commands commands
	exits 65 within.lua -q -o within.h5 --force --method $method --time-step 0.005
	for file in last within; do
		exits 0 info $file.h5 --json
		[ "$(value frames)" -eq 38 ] || fail "$method, $file: $(value frames) frames"
		value state_hash >$file.state
	done
	cmp last.state within.state || fail "$method: the state at the end is not that of the last frame"
done

# films: pictures with trails, energies and a camera that moves with random numbers of its own
small_scene 'camera { name = "a", position = function(t) return {2 + 0.01 * math.random(), -3, 1 + t} end, look_at = body "left",
	size = {64, 48}, samples = 1, fps = 25, png = "a/%03d.png", trails = {body "right"}, overlay = {"time", "energy"} }' >film.lua
interrupted film.lua 2

# nothing moves, and nothing of that is recorded
cat >still.lua <<'END'
world { duration = 0.5 }
box { size = {1, 1, 1}, static = true }
camera { position = {3, 3, 3}, look_at = {0, 0, 0}, size = {32, 32}, samples = 1, fps = 10, png = "still/%d.png" }
END
interrupted still.lua 2
says_nothing err

# energies, momenta and impulses that no double holds: the ledger has them, the motion does not need them
cat >heavy.lua <<'END'
world { duration = 1, gravity = {0, 0, -9.81} }
record { ledger = true, fields = {"+", "events"} }
plane { material = material { restitution = 0.5 } }
sphere { radius = 0.1, mass = 1e308, position = {0, 0, 10} }
sphere { radius = 0.1, mass = 1e306, position = {3, 0, 1}, velocity = {50, 0, -50} }
box { size = {0.1, 0.2, 0.3}, mass = 2, position = {6, 0, 0.3}, angular_velocity = {1, 2, 3} }
END
for method in located stepped; do
	interrupted heavy.lua 3 --method $method
done

# films that commands have switched off and on, before a checkpoint and after it, also in the moment of one
switched() # switched WHOLE FIRST SECOND: commands of a whole run, and of the two parts of another one
{
	rm -rf whole broken
	mkdir whole broken
	printf "$1" >commands.whole
	printf "$2" >commands.1
	printf "$3" >commands.2
	(cd whole && exits 0 ../film.lua -o r.h5 -q --commands ../commands.whole) || exit 1
	(cd broken && exits 130 ../film.lua -o r.h5 -q --commands ../commands.1 &&
		exits 0 ../film.lua -o r.h5 -q --resume --commands ../commands.2) || exit 1
	exits 0 diff whole/r.h5 broken/r.h5
	rm -f whole/r.h5 broken/r.h5 whole/out whole/err broken/out broken/err
	diff -r whole broken >&2 || fail "'$2', then '$3': other pictures"
}
switched 'at 0.1 film off\nat 0.4 film on\n' 'at 0.1 film off\nat 0.2 checkpoint\nat 0.3 quit\n' 'at 0.4 film on\n'
[ "$(ls broken/a | wc -l)" -lt 10 ] || fail "no pictures were left out"
switched 'at 0.1 film off\nat 0.2 film on\n' 'at 0.1 film off\nat 0.2 film on\nat 0.3 checkpoint\nat 0.4 quit\n' 'status\n'
switched 'at 0.2 film off\n' 'at 0.2 film off\nat 0.2 checkpoint\nat 0.3 quit\n' 'status\n'

# ---- what --resume says ----

for other in --force --no-record; do
	exits 64 gas.lua --resume $other
	says err "'--resume' contradicts '$other'"
done
exits 0 gas.lua -q --resume -o none.h5 # there is nothing: from the beginning
[ ! -e none.h5.checkpoint ] || fail "a complete run leaves a checkpoint"
before=$(cksum <none.h5)
exits 0 gas.lua --resume -o none.h5 # it is complete
says err 'is complete'
exits 0 gas.lua --resume -o none.h5 --json
[ "$(value status)" = complete ] || fail "status $(value status)"
[ "$(cksum <none.h5)" = "$before" ] || fail "a complete recording was touched"

# Killed before there is a checkpoint, and again sooner: what could be read is not lost, though it is made again.
sed 's/duration = 2,/duration = 15,/; $a on_frame(function() local x = 0 for i = 1, 1.5e5 do x = x + i end end)' script.lua |
	grep -v '^expect("every' >early.lua
exits 0 early.lua -q -o early.whole.h5
trap 'kill -9 $pid 2>/dev/null' EXIT
frames=0
for enough in 150 20; do
	"$RBSIM" early.lua -o early.h5 --resume --checkpoint-every 0 >out 2>err &
	pid=$!
	if [ $frames -eq 0 ]; then
		until_true sh -c '[ "$("$RBSIM" info early.h5 --json 2>/dev/null | sed "s/.*\"frames\":\([0-9]*\).*/\1/")" -gt '$enough' ] 2>/dev/null'
	else
		until_true grep -q 'has no checkpoint: from the beginning' err
		sleep 0.05
	fi
	kill -9 $pid
	wait $pid 2>/dev/null
	exits 0 info early.h5 --json
	[ "$(value frames)" -ge $frames ] || fail "$frames frames stood there, now $(value frames)"
	frames=$(value frames)
	exits 1 diff early.whole.h5 early.h5
	says out '^the same as far as both go'
done
exits 0 early.lua -q -o early.h5 --resume
exits 0 diff early.whole.h5 early.h5
for set in /observables/collisions/value /observables/kinetic_energy/value /rbsim/state_hash; do
	h5dump -w 0 -d $set early.h5 | plain >early.set
	h5dump -w 0 -d $set early.whole.h5 | plain | cmp - early.set || fail "$set differs"
done

long_scene >long.lua
"$RBSIM" long.lua -o long.h5 -q >out 2>err &
pid=$!
trap 'kill -9 $pid 2>/dev/null' EXIT
until_true [ -s long.h5 ]
sleep 0.2
exits 73 long.lua -o long.h5 --resume --duration 100000 # while it goes on; it has no checkpoint yet
kill -TERM $pid
wait $pid
[ $? -eq 75 ] || fail "SIGTERM: another exit status"
refused()
{
	pattern=$1
	shift
	exits 64 "$@"
	says err "$pattern"
}
before=$(cksum <long.h5)
refused "parameter 'n' was 50, is 49" long.lua -o long.h5 --resume -p n=49
refused 'the duration was 100000, is 999' long.lua -o long.h5 --resume --duration 999
refused 'the seed was 1, is 2' long.lua -o long.h5 --resume --seed 2
refused 'the method was auto, is classic' long.lua -o long.h5 --resume --method classic
refused 'the time step was' long.lua -o long.h5 --resume --time-step 0.001
refused 'the tolerance was' long.lua -o long.h5 --resume --tolerance 1e-6
refused 'rollback was selective, is global' long.lua -o long.h5 --resume --rollback global
for python in /usr/bin/python3 python3; do
	cp long.h5 other.h5
	$python -c 'import h5py; h5py.File("other.h5", "r+")["rbsim/version"][()] = b"0.0.1"' 2>/dev/null || continue
	refused 'rbsim was 0.0.1, is ' long.lua -o other.h5 --resume
	break
done
cp long.lua kept.lua
echo '-- changed' >>long.lua
refused "was made before 'long.lua' was changed" long.lua -o long.h5 --resume
cp kept.lua long.lua
[ "$(cksum <long.h5)" = "$before" ] || fail "what was refused was written to"

# ---- checkpoints that are not whole ----

cat >short.lua <<'END'
world { duration = 1, gravity = {0, 0, -9.81} }
local m = material { name = "m", density = 1000, restitution = 0.9 }
plane { normal = {0, 0, 1}, material = m }
sphere { radius = 0.1, position = {0, 0, 1}, material = m }
END
exits 0 short.lua -q -o whole.h5
for at in 2 5; do
	printf 'at 0.%d checkpoint\nat 0.6 quit\n' $at >commands
	exits 130 short.lua -q -o cut.h5 --resume --commands commands
done
[ -s cut.h5.checkpoint ] || fail "no checkpoint"
[ -s cut.h5.checkpoint~ ] || fail "not the one before"
mkdir kept
cp cut.h5* kept
size=$(wc -c <cut.h5.checkpoint)
places="0 9 17 25 33 60 $((size / 2)) $((size - 1))" lengths="0 5 31 40 $((size / 3)) $((size - 1))"
case ${RBSIM_MODE:-release} in tsan) places=60 lengths=40 ;; esac
for at in $places; do
	cp kept/* .
	printf '\125' | dd of=cut.h5.checkpoint bs=1 seek=$at conv=notrunc 2>/dev/null
	cmp -s cut.h5.checkpoint kept/cut.h5.checkpoint && printf '\252' | dd of=cut.h5.checkpoint bs=1 seek=$at conv=notrunc 2>/dev/null
	exits 0 short.lua -o cut.h5 --resume
	says err "going on from the one before"
	exits 0 diff whole.h5 cut.h5
done
for length in $lengths; do
	cp kept/* .
	head -c $length kept/cut.h5.checkpoint >cut.h5.checkpoint
	exits 0 short.lua -o cut.h5 --resume
	says err "going on from the one before"
	exits 0 diff whole.h5 cut.h5
done
# both
cp kept/* .
head -c 100 kept/cut.h5.checkpoint >cut.h5.checkpoint
head -c 100 kept/cut.h5.checkpoint~ >cut.h5.checkpoint~
exits 66 short.lua -o cut.h5 --resume
says err "is not a checkpoint to resume from"
# of another run of the same scene
cp kept/* .
exits 0 short.lua -q -o cut.h5 --force
exits 0 diff whole.h5 cut.h5
[ ! -e cut.h5.checkpoint ] || fail "the checkpoint of the recording that was replaced is still there"

# ---- what can't be kept ----

cat >function.lua <<'END'
world { duration = 1000 }
sphere { radius = 1 }
state.a = {b = {[3] = function() end}}
END
printf 'at 0.1 checkpoint\nat 0.2 quit\n' >commands
exits 130 function.lua -o f.h5 --commands commands
says err 'state.a.b\[3\]: a function can.t be kept'
[ ! -e f.h5.checkpoint ] || fail "a checkpoint of what can't be kept"
