#!/bin/sh
# SPDX-License-Identifier: MIT
# Auto comes to an end where one method does not: a frame that cannot be located is done again by steps, and says so.
. tests/cli/functions

cat >tilted.lua <<'LUA'
world { duration = 0.4, gravity = {0, 0, -9.8} }
plane {}
cylinder { radius = 0.021, length = 0.01, position = {0, 0, 0.5}, orientation = {angle = 3, axis = {1, 0, 0}} }
LUA
timeout "$PATIENCE" "$RBSIM" tilted.lua --no-record --json --quiet >out 2>err </dev/null || fail "auto: exit status $?"
# with other threads to the same bits
hash=$(value state_hash)
exits 0 tilted.lua --no-record --json --quiet --threads 3
[ "$(value state_hash)" = "$hash" ] || fail "other threads, another end"

# how much may be located is a matter of simulated time, not of the time step that a frame is divided by
cat >rattle.lua <<'LUA'
world { duration = 1, frame_rate = 1, gravity = {0, 0, 0}, time_step = param("step", 1.0) }
local m = material { friction = 0, restitution = 1, density = 1000 }
plane { material = m, point = {0, 0, 0}, normal = {0, 0, 1} }
plane { material = m, point = {0, 0, 1}, normal = {0, 0, -1} }
for k = 1, 20 do
	box { material = m, size = {0.05, 0.05, 0.02}, position = {0.3 * k, 0, 0.5}, velocity = {0, 0, 40 + k},
		angular_velocity = {3, 2, 1 + k / 10} }
end
LUA
hash=
for step in 1 0.1 0.004; do
	exits 0 rattle.lua -p step=$step --no-record --json --quiet
	[ "$(value stepped)" = 0 ] || fail "time step $step: stepped $(value stepped) s"
	[ "${hash:-$(value state_hash)}" = "$(value state_hash)" ] || fail "time step $step: another end"
	hash=$(value state_hash)
done

# nor of seconds: scenes whose lengths and times are scaled by powers of two change the method at the same event, to the same bits
cat >scaled.lua <<'LUA'
local L, T = 2.0 ^ param("length", 0), 2.0 ^ param("time", 0)
world { duration = 0.5 * T, frame_rate = 64 / T, time_step = T / 256, gravity = {0, 0, -10 * L / T ^ 2}, tolerance = L * 2.0 ^ -20 }
local m = material { friction = 0.5, restitution = 0.25, density = 1024 / L ^ 3 }
plane { material = m }
local list = {}
for k = 0, 26 do
	list[k + 1] = box { material = m, size = {0.25 * L, 0.25 * L, 0.25 * L}, velocity = {0.5 * (k % 2) * L / T, 0, -L / T},
		position = {0.3 * (k % 3) * L, 0.3 * (k // 3 % 3) * L, (0.25 + 0.3 * (k // 9)) * L}, angular_velocity = {1 / T, k / T / 8, 0} }
end
expect("where they are", function()
	local sum = 0
	for k, b in ipairs(list) do sum = sum + k * b.position.x / L + b.position.z / L end
	return sum, 1e9
end)
LUA
first=
for scales in "0 0" "-6 0" "2 4"; do
	# shellcheck disable=SC2086 # two numbers
	set -- $scales
	exits 0 scaled.lua -p length="$1" -p time="$2" --no-record --json --quiet --threads 1
	part=$(awk -v s="$(value stepped)" -v t="$2" 'BEGIN { printf "%.15g", s / 2 ^ t }')
	place=$(sed -n 's/.*"measured":\([^,]*\).*/\1/p' out)
	awk -v s="$part" 'BEGIN { exit !(s > 0.1 && s < 0.45) }' || fail "scaled by $scales: stepped $part of 0.5"
	[ "${first:-$part $place}" = "$part $place" ] || fail "scaled by $scales: stepped $part, at $place; as it was: $first"
	first="$part $place"
done

# by steps alone too: where overlaps are closed no velocity is taken for a way
first=
for time in 0 4; do
	exits 0 scaled.lua --method stepped -p time="$time" --no-record --json --quiet --threads 1
	place=$(sed -n 's/.*"measured":\([^,]*\).*/\1/p' out)
	[ "${first:-$place}" = "$place" ] || fail "steps scaled by 2^$time: at $place; as it was: $first"
	first=$place
done

# what stands again after steps is not tried again before they have cost much more than that
exits 0 "$TOP/scenes/arch.lua" --method auto --no-record --no-render --json --quiet --threads 1
[ "$(value rollbacks)" -le 1 ] || fail "the arch: $(value rollbacks) frames were done again"

# what stands at rest is located where that takes less than steps: a tower, and no pyramid
cat >rest.lua <<'LUA'
local stack = require "rbsim.stack"
world { duration = 1, frame_rate = 10, gravity = {0, 0, -9.81} }
local m = material { density = 1000, friction = 0.5, restitution = 0 }
plane { material = m }
local tower = param("kind", "tower") == "tower"
local blocks = tower and stack.tower { count = 20, size = {1, 1, 1} } or stack.pyramid { rows = 12, size = {1, 1, 0.5} }
stack.bodies(blocks, function() return { material = m } end)
LUA
for kind in tower:0 pyramid:1; do
	exits 0 rest.lua -p kind=${kind%:*} --no-record --json --quiet --threads 1
	[ "$(value stepped)" = "${kind#*:}" ] || fail "a ${kind%:*} at rest: stepped $(value stepped) s of 1"
done

# boxes that are let fall on each other and stand by steps: these cost next to nothing, so locating is not tried again
cat >fall.lua <<'LUA'
world { duration = 10, frame_rate = 10, gravity = {0, 0, -9.81}, time_step = 1 / 240 }
local m = material { density = 1000, friction = 0.5, restitution = 0 }
plane { material = m }
for i = 1, 20 do box { size = {1, 1, 1}, material = m, position = {0, 0, i - 0.5 + 0.001 * i} } end
LUA
exits 0 fall.lua --no-record --json --quiet --threads 1
[ "$(value rollbacks)" = 0 ] || fail "a stack that was let fall: $(value rollbacks) attempts to locate it"

# what is integrated a million times a second, in flight, is left to steps as well
cat >stiff.lua <<'LUA'
world { duration = 0.2, frame_rate = 20, gravity = {0, 0, -9.81} }
plane {}
local a = sphere { radius = 0.01, mass = 1e-3, position = {0, 0, 1} }
local b = sphere { radius = 0.01, mass = 1e-3, position = {0.2, 0, 1} }
spring { a = a, b = b, rest_length = 0.1, stiffness = 1e9 }
LUA
exits 0 stiff.lua --no-record --json --quiet
stepped=$(value stepped)
awk -v s="$stepped" 'BEGIN { exit !(s > 0.1) }' || fail "a spring of 1e9 N/m: stepped $stepped s of 0.2"

# spheres that fly count what it takes to find their touches, where these have no closed form: over a floor that moves
cat >moving.lua <<'LUA'
world { duration = 0.5, frame_rate = 10, gravity = {0, 0, -10}, time_step = 1 / 200 }
local m = material { friction = 0, restitution = 0.5, density = 1000 }
plane { material = m, motion = function(t) return {math.sin(t), 0, 0}, nil, {math.cos(t), 0, 0} end }
for k = 0, 99 do
	sphere { radius = 0.1, material = m, position = {k % 10 * 0.25, k // 10 * 0.25, 0.15 + k % 7 * 0.02} }
end
LUA
# so do solids, by what their shapes take: in a box without gravity
cat >gas.lua <<'LUA'
world { duration = 1, frame_rate = 10, gravity = {0, 0, 0}, time_step = 1 / 100 }
local m = material { friction = 0.3, restitution = 1, density = 1000 }
for _, n in ipairs { {1, 0, 0}, {0, 1, 0}, {0, 0, 1} } do
	plane { material = m, normal = n, point = -0.2 * vec3(n) }
	plane { material = m, normal = -1 * vec3(n), point = 1.1 * vec3(n) }
end
for k = 0, 63 do
	cylinder { radius = 0.09, length = 0.18, material = m, position = {k % 4 * 0.3, k // 4 % 4 * 0.3, k // 16 * 0.3},
		velocity = {3 * math.sin(k), 3 * math.cos(3 * k), 3 * math.sin(5 * k)} }
end
LUA
# and mechanisms that touch nothing, of many joints: two legs of a walking machine, and no chain of ten links
for scene in moving.lua gas.lua "$TOP/scenes/jansen.lua"; do
	exits 0 "$scene" --duration 0.5 --method auto --no-render --no-record --json --quiet --threads 1
	awk -v s="$(value stepped)" -v all="$(value duration)" 'BEGIN { exit !(s > 0.5 * all) }' ||
		fail "$scene: stepped $(value stepped) s of $(value duration)"
done
exits 0 "$TOP/scenes/hanging_chain.lua" --duration 0.5 --no-render --no-record --json --quiet --threads 1
[ "$(value stepped)" = 0 ] || fail "a hanging chain: stepped $(value stepped) s"

# a frame with callbacks cannot be done again, a step within it can, with what on_step has given it: what a flat end on a turntable
# comes to is seen at the step's end
cat >turntable.lua <<'LUA'
world { duration = 0.05, frame_rate = 20, gravity = {0, 0, -55.83}, time_step = 2.5e-4 }
local m = material { density = 1.3e4, friction = 4, restitution = 0 }
plane { material = m, motion = function(t)
	return {0, 0, 0}, {axis = {0, 0, 1}, angle = 5 * t}, {0, 0, 0}, {0, 0, 5}
end }
cylinder { length = 0.402, radius = 0.2, position = {0, 0, 0.201}, velocity = {0.6, 0.5, 0.5}, material = m }
local calls = 0
on_step(function() calls = calls + 1 end)
expect("each step is asked for once", function() return calls == 200 end)
LUA
exits 0 turntable.lua --no-record --json --quiet

# so is what asks a field too often, which no driven body is asked for: its mass is math.huge
cat >field.lua <<'LUA'
world { duration = 0.4, frame_rate = 20, gravity = {0, 0, -9.81} }
plane {}
for i = 1, 10 do sphere { radius = 0.01, mass = 1e-3, position = {0.1 * i, 0, 2} } end
sphere { radius = 0.01, position = {0, 1, 2}, motion = function() return {0, 1, 2} end }
field(function(t, x, v, body) return {1e-3 * math.sin(1e4 * t), 0, 1e-9 * body.mass} end)
LUA
exits 0 field.lua --no-record --json --quiet
stepped=$(value stepped)
awk -v s="$stepped" 'BEGIN { exit !(s > 0.2) }' || fail "a field asked 4 million times a second: stepped $stepped s of 0.4"

# what is squeezed within the tolerance cannot be pushed apart, however short the step: it stays where it is
cat >squeezed.lua <<'LUA'
world { duration = 0.2, time_step = 0.01, gravity = {0, 0, -9.81}, tolerance = 1e-6, method = "stepped" }
local m = material { density = 1000, friction = 0.5 }
plane { material = m }
plane { material = m, normal = {0, 0, -1}, point = {0, 0, 0.2 - 1.2e-6} }
sphere { material = m, radius = 0.1, position = {0, 0, 0.1 - 6e-7}, velocity = {0.5, 0, 0} }
capsule { material = m, radius = 0.1, length = 0.3, position = {0, 1, 0.1 - 6e-7}, velocity = {0.5, 0, 0},
          orientation = {axis = {0, 1, 0}, angle = math.pi / 2} }
box { material = m, size = {0.3, 0.2, 0.2}, position = {0, 2, 0.1 - 6e-7}, velocity = {0.5, 0, 0} }
LUA
for method in stepped auto; do
	exits 0 squeezed.lua --no-record --json --quiet --method $method
	short=$(value smallest_step) # 0: located to the end
	awk -v s="$short" -v all="$(value stepped)" 'BEGIN { exit !(s > 1e-3 || all == 0) }' ||
		fail "$method: what is squeezed takes steps of $short s"
done

# attempts that follow steps get a part of what these took: what auto moves of a heap is a small multiple of its steps (5; 12 without)
# (it need not be at rest by then)
"$RBSIM" "$TOP/scenes/heap.lua" --param balls=60 --duration 3 --no-record --no-render --quiet --json --threads 1 >out 2>err </dev/null ||
	[ $? -eq 1 ] || fail "a heap: $(tail -n 1 err)"
awk -v moved="$(value body_steps)" 'BEGIN { exit !(moved < 8 * 60 * 3 * 240) }' || fail "a heap: $(value body_steps) body steps"

# a chain of rods, taut between two points, that is pushed across: no motion keeps the rods, steps hold them within the tolerance
cat >taut.lua <<'LUA'
world { duration = 1, frame_rate = 10 }
local balls = {}
for k = 0, 3 do
	balls[k] = sphere { radius = 0.05, mass = 1, position = {k, 0, 0}, collides_with = {}, velocity = {0, k == 1 and 1e-3 or 0, 0} }
	joint { kind = "rod", a = balls[k], b = balls[k - 1], at_b = k == 0 and {-1, 0, 0} or nil }
end
joint { kind = "rod", a = balls[3], at_b = {4, 0, 0} }
LUA
exits 76 taut.lua --no-record --quiet --method located
says err "^rbsim: taut.lua:7: rod #4 cannot be kept together"
exits 0 taut.lua --no-record --quiet --method auto

# what acts is so strong that the steps of a frame are without number: that ends the run, and is said
cat >strong.lua <<'LUA'
world { duration = 0.3, frame_rate = 1, gravity = {0, param("g", 1e155), -7.5} }
plane {}
cylinder { radius = 0.09, length = 0.2, position = {0, 0, 0.6}, velocity = {1, 0, -1}, angular_velocity = {1, 3, 0} }
on_step(function() end)
LUA
for g in 1e20 1e60 1e155; do
	exits 76 strong.lua -p g=$g --no-record --quiet
	says err '^rbsim: steps after t = [0-9.e-]+ s are too short to reach'
done

# a step in which what turns very fast leaves all numbers is taken again, shorter; that is no bug, in checked builds either
cat >whirl.lua <<'LUA'
world { duration = 1e-4, frame_rate = 16, gravity = {0, 0, -13}, time_step = 0.007 }
plane {}
local a = sphere { radius = 0.1, position = {0, 0.088, 0.754}, velocity = {1.2, 0, -1.2}, angular_velocity = {1.2, 2, 3.4} }
local b = cylinder { radius = 0.055, length = 0.243, position = {1.5, 0.137, 1}, mass = 1.43, angular_velocity = {1.2, 1.2, 1e8} }
joint { kind = "hinge", a = a, b = b, at = {0.6, 0.14, 0.4}, axis = {0, 1, 0} }
LUA
exits 0 whirl.lua --no-record --quiet --method stepped
