#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs that are killed at random moments, KILLS in all (500), over scenes of four kinds. After each kill: every frame that
# stands in the recording is that of a run that was left alone, and none is lost that stood there before. Each is gone on
# with until it is whole: recording and films are the same to the bit.
. tests/cli/functions

kills=${KILLS:-500}
# numbers that follow from one seed, so that a failure can be had again: SEED=
seed=${SEED:-$$}
number=$seed
random() # random N: in 0 .. N-1, in $picked
{
	number=$(((number * 1103515245 + 12345) % 2147483648))
	picked=$((number / 65536 % $1))
}

cat >located.lua <<'END'
world { duration = 60, frame_rate = 60 }
local m = material { name = "m", density = 1000, friction = 0, restitution = 1 }
for i = -1, 1, 2 do
	plane { normal = {-i, 0, 0}, point = {i, 0, 0}, material = m }
	plane { normal = {0, -i, 0}, point = {0, i, 0}, material = m }
	plane { normal = {0, 0, -i}, point = {0, 0, i}, material = m }
end
for i = 0, 215 do
	sphere { radius = i % 7 == 0 and 0.1 or 0.04, material = m,
		position = {-0.75 + 0.3 * (i % 6), -0.75 + 0.3 * (i // 6 % 6), -0.75 + 0.3 * (i // 36)},
		velocity = {math.random() - 0.5, math.random() - 0.5, math.random() - 0.5} }
end
record { fields = {"position", "velocity", "events"} }
END
cat >dense.lua <<'END'
world { duration = 0.5, gravity = {0, 0, -9.81}, frame_rate = 120, time_step = 0.01 }
local m = material { name = "m", density = 1000, friction = 0.5, restitution = 0.1 }
plane { normal = {0, 0, 1}, material = m }
for i = 0, 39 do
	sphere { radius = 0.05, material = m,
		position = {0.102 * (i % 3) + 0.0001 * i, 0.102 * (i // 3 % 3), 0.06 + 0.11 * (i // 9)} }
end
END
cat >callbacks.lua <<'END'
world { duration = 30, gravity = {0, 0, -9.81}, frame_rate = 100 }
local m = material { name = "m", density = 1000, friction = 0.3, restitution = 0.8 }
plane { normal = {0, 0, 1}, material = m }
for i = 0, 9 do sphere { name = "b" .. i, radius = 0.1, position = {0.3 * i, 0, 0.5 + 0.1 * i}, material = m } end
state.hits, state.log = 0, {}
on_step(function(t) body("b3"):apply_force({math.random() - 0.5, 0, 0}) end)
on_frame(function(t, k)
	state.log[#state.log % 50 + 1] = {k = k, p = body("b3").position}
	if k % 25 == 0 then for i = 0, 9 do body("b" .. i):apply_impulse({0, 0.1 * math.random(), 5 + math.random()}) end end
end)
on_collision(function(c) state.hits = state.hits + 1 end)
record { every = 2, compression = 1, fields = {"position", "orientation", "velocity", "angular_velocity", "events"} }
END
cat >film.lua <<'END'
world { duration = 4, gravity = {0, 0, -9.81}, frame_rate = 50 }
local m = material { name = "m", density = 1000, friction = 0.3, restitution = 0.8 }
plane { normal = {0, 0, 1}, size = {3, 3}, material = m }
for i = 0, 5 do sphere { name = "b" .. i, radius = 0.1, position = {0.3 * i, 0, 0.5 + 0.1 * i}, material = m } end
camera { name = "a", position = {2, -4, 2}, look_at = body "b2", size = {96, 64}, samples = 1, png = "a/%04d.png",
	trails = {body "b1"}, overlay = {"time", "energy"} }
END

pid=''
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
for scene in located dense callbacks film; do
	mkdir $scene.whole
	(cd $scene.whole && "$RBSIM" ../$scene.lua -o r.h5 -q >../out 2>../err) || fail "$scene: the whole run failed"
done

frames_of() # in $frames
{
	frames=0
	[ -e "$1" ] || return
	"$RBSIM" info "$1" --json >info.out 2>info.err || { cat info.err >&2; fail "seed $seed: '$1' can't be read after a kill"; }
	frames=$(value frames info.out)
}

done_kills=0 runs=0
while [ $done_kills -lt $kills ]; do
	for scene in located dense callbacks film; do
		[ $done_kills -lt $kills ] || break
		rm -rf broken
		mkdir broken
		more='' before=0 ended=''
		random 12
		most=$((picked + 1))
		for _ in $(seq $most); do
			random 3
			threads=$((picked + 1))
			(cd broken && exec "$RBSIM" ../$scene.lua -o r.h5 -q --threads $threads --checkpoint-every 0.05 $more) >out 2>err &
			pid=$!
			random 700
			sleep "0.$(printf %03d "$picked")"
			if kill -9 $pid 2>/dev/null; then
				wait $pid 2>/dev/null
				got=$?
			else
				wait $pid
				got=$?
			fi
			pid=
			if [ $got -eq 0 ]; then ended=1; break; fi
			[ $got -eq 137 ] || fail "seed $seed, $scene: exit status $got after kill $done_kills"
			done_kills=$((done_kills + 1))
			more=--resume
			frames_of broken/r.h5
			[ "$frames" -ge "$before" ] || fail "seed $seed, $scene: $before frames stood there, now $frames"
			before=$frames
			if [ "$frames" -gt 0 ]; then
				"$RBSIM" diff $scene.whole/r.h5 broken/r.h5 >diff.out 2>&1
				grep -Eq '^the same (to the bit|as far as both go)' diff.out ||
					{ cat diff.out >&2; fail "seed $seed, $scene: frames differ after kill $done_kills"; }
			fi
			[ $done_kills -lt $kills ] || break
		done
		if [ -z "$ended" ]; then
			(cd broken && "$RBSIM" ../$scene.lua -o r.h5 -q --resume) >out 2>err || fail "seed $seed, $scene: the last part failed"
		fi
		exits 0 diff $scene.whole/r.h5 broken/r.h5
		mv broken/r.h5 broken.h5
		(cd $scene.whole && find . -type f ! -name r.h5 -exec cmp {} ../broken/{} \;) >differs 2>&1
		[ ! -s differs ] || { cat differs >&2; fail "seed $seed, $scene: films differ"; }
		[ -z "$(find broken -name '*.checkpoint*')" ] || fail "seed $seed, $scene: a complete run leaves checkpoints"
		runs=$((runs + 1))
	done
done
echo "$done_kills kills, $runs runs the same to the bit"
