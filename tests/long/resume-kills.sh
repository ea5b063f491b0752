#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs that are killed at random moments, KILLS in all (500), over scenes of seven kinds, and sweeps, whose runs or which
# themselves are. After each kill: every frame that stands in the recording is that of a run that was left alone, and none
# is lost that stood there before. Each is gone on with until it is whole: recording and films are the same to the bit.
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
world { duration = 180, frame_rate = 60 }
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
world { duration = 0.4, gravity = {0, 0, -9.81}, frame_rate = 240, time_step = 0.01 }
local m = material { name = "m", density = 1000, friction = 0.5, restitution = 0.1 }
plane { normal = {0, 0, 1}, material = m }
for k = 0, 239 do
	local i = k % 40
	sphere { radius = 0.05, material = m,
		position = {k // 40 + 0.102 * (i % 3) + 0.0001 * i, 0.102 * (i // 3 % 3), 0.06 + 0.11 * (i // 9)} }
end
END
cat >callbacks.lua <<'END'
world { duration = 240, gravity = {0, 0, -9.81}, frame_rate = 100 }
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
world { duration = 20, gravity = {0, 0, -9.81}, frame_rate = 50 }
local m = material { name = "m", density = 1000, friction = 0.3, restitution = 0.8 }
plane { normal = {0, 0, 1}, size = {3, 3}, material = m }
for i = 0, 5 do sphere { name = "b" .. i, radius = 0.1, position = {0.3 * i, 0, 0.5 + 0.1 * i}, material = m } end
camera { name = "a", position = {2, -4, 2}, look_at = body "b2", size = {96, 64}, samples = 1, png = "a/%04d.png",
	trails = {body "b1"}, overlay = {"time", "energy"} }
END
# clusters that are integrated, a driven floor and a driven ball, a force that begins and ends, a field of force
cat >forces.lua <<'END'
world { duration = 200, gravity = {0, 0, -9.81}, frame_rate = 40 }
local m = material { name = "m", density = 1000, friction = 0.3, restitution = 0.5 }
plane { normal = {0, 0, 1}, material = m, motion = function(t) return {0, 0, 0.02 * (1 - math.cos(12 * t))} end }
local a = sphere { name = "a", radius = 0.1, position = {0, 0, 0.3}, material = m }
local b = sphere { name = "b", radius = 0.1, position = {0.5, 0, 0.6}, material = m,
	forces = {{vector = {3, 0, 0}, start = 0.4, duration = 0.7}} }
sphere { radius = 0.1, position = {1.5, 0, 0.1}, material = m }
sphere { radius = 0.15, position = {-1, 0, 0.5}, material = m, motion = function(t) return {-1 + 0.3 * math.sin(3 * t), 0, 0.5} end }
spring { a = a, b = b, stiffness = 200, rest_length = 0.5 }
drag { linear = 0.2 }
END
# nothing but springs and a field, that push bodies into each other
cat >springs.lua <<'END'
world { duration = 60, frame_rate = 50 }
local m = material { name = "m", density = 1000, friction = 0, restitution = 1 }
local last
for i = 0, 5 do
	local one = sphere { radius = 0.05, position = {0.2 * i, 0.01 * i * i, 0}, velocity = {0, math.random() - 0.5, 0}, material = m }
	if last then spring { a = last, b = one, stiffness = 60, rest_length = 0.15 } end
	last = one
end
field(function(t, x, v) return {-2 * x.x, -2 * x.y, -2 * x.z} end)
END
# boxes, a capsule and a cylinder that fall on a floor and each other
cat >convex.lua <<'END'
world { duration = 1.2, gravity = {0, 0, -9.81}, frame_rate = 100 }
local m = material { name = "m", density = 1000, friction = 0.5, restitution = 0.2 }
plane { normal = {0, 0, 1}, material = m }
for k = 0, 1 do
	for i = 0, 2 do box { size = {0.2, 0.2, 0.2}, position = {0.01 * i, k, 0.1 + 0.201 * i}, material = m } end
	capsule { radius = 0.08, length = 0.3, position = {0.8, k, 0.4}, velocity = {-0.5, 0, 0}, angular_velocity = {1, 2, 3}, material = m }
	cylinder { radius = 0.1, length = 0.2, position = {-0.8, k + 0.1, 0.5}, angular_velocity = {3, 0.2, 1}, material = m }
end
END

pid=''
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
scenes='located dense callbacks film forces springs convex'
for scene in $scenes; do
	mkdir $scene.whole
	(cd $scene.whole && "$RBSIM" ../$scene.lua -o r.h5 -q >../out 2>../err) || fail "$scene: the whole run failed"
done
sed 's/^world { duration = [0-9]*/local k = param("k", 1.0, "which")\nworld { duration = 40 * k/' callbacks.lua >points.lua
exits 0 sweep points.lua -p k=0.25:1.5:0.25 -o sweep.whole -q

frames_of() # in $frames
{
	frames=0
	[ -e "$1" ] || return
	"$RBSIM" info "$1" --json >info.out 2>info.err || { cat info.err >&2; fail "seed $seed: '$1' can't be read after a kill"; }
	frames=$(value frames info.out)
}

done_kills=0 runs=0

# in $got; counts the kill where there was one
kill_after() # kill_after MILLISECONDS
{
	sleep "0.$(printf %03d "$1")"
	kill -9 $pid 2>/dev/null
	wait $pid 2>/dev/null
	got=$?
	pid=
	[ $got -ne 137 ] || done_kills=$((done_kills + 1))
}

# what stands in the recording after a kill is right, and no less than before
judge()
{
	frames_of broken/r.h5
	[ "$frames" -ge "$before" ] || fail "seed $seed, $scene: $before frames stood there, now $frames"
	before=$frames
	[ "$frames" -gt 0 ] || return
	"$RBSIM" diff $scene.whole/r.h5 broken/r.h5 >diff.out 2>&1
	grep -Eq '^the same (to the bit|as far as both go)' diff.out ||
		{ cat diff.out >&2; fail "seed $seed, $scene: frames differ after kill $done_kills"; }
}

break_run()
{
	rm -rf broken
	mkdir broken
	more='' before=0 got=1
	random 12
	for _ in $(seq $((picked + 1))); do
		random 3
		threads=$((picked + 1))
		(cd broken && exec "$RBSIM" ../$scene.lua -o r.h5 -q --threads $threads --checkpoint-every 0.05 $more) >out 2>err &
		pid=$!
		random 700
		kill_after "$picked"
		[ $got -ne 0 ] || break
		[ $got -eq 137 ] || fail "seed $seed, $scene: exit status $got after kill $done_kills"
		more=--resume
		judge
		[ $done_kills -lt "$kills" ] || break
	done
	if [ $got -ne 0 ]; then
		(cd broken && "$RBSIM" ../$scene.lua -o r.h5 -q --resume) >out 2>err || fail "seed $seed, $scene: the last part failed"
	fi
	exits 0 diff $scene.whole/r.h5 broken/r.h5
	mv broken/r.h5 broken.h5
	(cd $scene.whole && find . -type f ! -name r.h5 -exec cmp {} ../broken/{} \;) >differs 2>&1
	[ ! -s differs ] || { cat differs >&2; fail "seed $seed, $scene: films differ"; }
	[ -z "$(find broken -name '*.checkpoint*')" ] || fail "seed $seed, $scene: a complete run leaves checkpoints"
	runs=$((runs + 1))
}

# A sweep, or one of its runs, which the sweep then tells as failed, and runs again when it goes on.
break_sweep()
{
	rm -rf broken
	exits 0 sweep points.lua -p k=0.25:1.5:0.25 -o broken --plan
	random 12
	for _ in $(seq $((picked + 1))); do
		"$RBSIM" sweep broken --jobs 2 --checkpoint-every 0.05 --quiet >out 2>err &
		pid=$!
		random 700
		if [ $((picked % 2)) -eq 0 ]; then
			sleep "0.$(printf %03d "$picked")"
			child=$(cut -d ' ' -f 1 /proc/$pid/task/$pid/children 2>/dev/null)
			[ -z "$child" ] || ! kill -9 "$child" 2>/dev/null || done_kills=$((done_kills + 1))
			wait $pid
			got=$?
			pid=
			# 75: a run of the sweep before has not ended yet
			[ $got -le 1 ] || [ $got -eq 75 ] || fail "seed $seed: a sweep whose run was killed ends with $got"
		else
			kill_after "$picked"
		fi
		[ $got -ne 0 ] || break
		[ $done_kills -lt "$kills" ] || break
	done
	# runs of a sweep that was killed end by themselves, at a checkpoint
	for _ in $(seq 100); do
		exits 0 sweep broken --status --json
		[ "$(value running)" != 0 ] || break
		sleep 0.1
	done
	exits 0 sweep broken -q
	for json in sweep.whole/point-*.json; do
		point=${json#*/}
		[ "$(value state_hash "$json")" = "$(value state_hash "broken/$point")" ] || fail "seed $seed: $point: another state"
		exits 0 diff "sweep.whole/${point%.json}.h5" "broken/${point%.json}.h5"
	done
	[ -z "$(find broken -name '*.checkpoint*')" ] || fail "seed $seed: a complete sweep leaves checkpoints"
	runs=$((runs + 1))
}

while [ $done_kills -lt "$kills" ]; do
	for scene in $scenes sweep; do
		[ $done_kills -lt "$kills" ] || break
		if [ $scene = sweep ]; then break_sweep; else break_run; fi
	done
done
echo "$done_kills kills, $runs runs and sweeps the same to the bit"
