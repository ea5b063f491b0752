#!/bin/sh
# SPDX-License-Identifier: MIT
# By steps, units cancel: a scene in other units of time, length or mass, by powers of two, moves to the same bits. A hull
# falls onto a capsule and overlaps it in a step: the ways on which overlaps close, m, are kept where velocities are.
. tests/cli/functions

cat >units.lua <<'EOF'
local T, L, M = 2 ^ param("t", 0), 2 ^ param("l", 0), 2 ^ param("m", 0)
world { duration = 0.55 * T, frame_rate = 20 / T, time_step = T / 80, gravity = {0, 0, -9.81 * L / T ^ 2} }
local m = material { name = "m", friction = 0.1, restitution = 0, density = 1000 * M / L ^ 3 }
plane { material = m, normal = {0, 0, 1} }
local function scaled(points)
	for _, p in ipairs(points) do
		for k = 1, 3 do p[k] = p[k] * L end
	end
	return points
end
local bodies = {
	capsule { material = m, radius = 0.13 * L, length = 0.23 * L, position = {0, 0, 0.5 * L},
		orientation = {0.8652541178331944, 0.04972724815133302, -0.19890899260533207, 0.4574906829922637},
		velocity = {0.06 * L / T, 0, 0.24 * L / T} },
	hull { material = m, points = scaled {{-0.1, 0.14, 0.17}, {-0.19, -0.07, -0.05}, {-0.05, 0.02, -0.1},
		{0.06, 0.15, 0.17}, {0.14, -0.11, 0.1}, {0.11, 0.04, 0.07}}, position = {0, 0, 1.35 * L},
		orientation = {0.8691746759008043, 0, 0.34966797306354197, 0.34966797306354197},
		velocity = {0, 0, -0.48 * L / T} },
}
expect_always("motion", function()
	for _, b in ipairs(bodies) do
		local p, v, w = b.position, b.velocity, b.angular_velocity
		print(string.format("at %a %a %a  %a %a %a  %a %a %a", p.x / L, p.y / L, p.z / L, v.x * T / L, v.y * T / L,
			v.z * T / L, w.x * T, w.y * T, w.z * T))
	end
	return true
end)
EOF

# motion T L M, the exponents: prints what the bodies did
motion()
{
	timeout "$PATIENCE" "$RBSIM" units.lua --no-record --method stepped --param t="$1" --param l="$2" --param m="$3" >out 2>&1 </dev/null ||
		fail "units of 2^$1 s, 2^$2 m, 2^$3 kg: exit status $?"
	sed -n 's/^at //p' out
}

motion 0 0 0 >wanted
[ "$(wc -l <wanted)" -ge 20 ] || fail "the scene told no motion"
while read -r t l m; do
	motion "$t" "$l" "$m" >found
	cmp -s wanted found || fail "units of 2^$t s, 2^$l m, 2^$m kg: $(diff wanted found | sed -n 2p)"
done <<'EOF'
8 0 0
-20 0 0
0 7 0
0 -12 0
0 0 1
0 0 -31
5 3 4
EOF

# Located, a ball meets another at any size and speed whose squares a double holds, squared twice or not.
cat >far.lua <<'EOF'
local size, speed = param("size", 1.0, ""), param("speed", 1.0, "")
local m = material { restitution = 1 }
world { duration = 10 * size / speed, frame_rate = speed / size }
sphere { name = "a", radius = size, mass = 1, velocity = {speed, 0, 0}, material = m }
sphere { name = "b", radius = size, mass = 1, position = {3 * size, 0, 0}, material = m }
expect("all of the speed is handed on, in time", function()
	return math.abs(body("b").position.x / size - 12) + math.abs(body("b").velocity.x / speed - 1), 1e-13
end)
EOF
while read -r size speed; do
	exits 0 run far.lua --no-record --method located --param size="$size" --param speed="$speed"
done <<'EOF'
1 1e153
1e60 1e100
1e9 1e150
1e-3 1e-160
1 1e-300
EOF
exits 65 run far.lua --no-record --param speed=1e154
says err "sphere 'a': 'velocity' 1e\+154 m/s .*too fast"

# what is so light and slow that impulses are no normal doubles is refused, where it was wrong or had no end; just above it is right
cat >slow.lua <<'EOF'
local light, speed = param("light", 1e-30, ""), param("speed", 1.0, "")
local m = material { restitution = 1, friction = 0 }
world { duration = 4 / speed, frame_rate = 4 * speed, time_step = 0.25 / speed }
box { name = "a", size = {1, 1, 1}, mass = 4000, velocity = {speed, 0, 0}, material = m }
box { name = "b", size = {1, 1, 1}, mass = light, position = {2, 0, 0}, material = m }
expect("the light one leaves twice as fast", function() return math.abs(body("b").velocity.x / speed - 2), 1e-8 end)
EOF
for method in located auto stepped; do
	exits 65 run slow.lua --no-record --method $method -p speed=1e-300
	says err "slow.lua:5: box 'b': its mass 1e-30 kg times the largest speed of the scene, 1e-300 m/s, is too small for impulses"
	exits 65 run slow.lua --no-record --method $method -p speed=1e-280
	exits 0 run slow.lua --no-record --quiet --method $method -p speed=1e-277
	exits 0 run slow.lua --no-record --quiet --method $method -p speed=1e-140 -p light=1e-160
done

# nor may a callback set one
for call in set_velocity set_angular_velocity; do
	cat >fast.lua <<EOF
world { duration = 1 }
local a = sphere { radius = 1 }
on_step(function() a:$call({0, 1e200, 0}) end)
EOF
	exits 65 run fast.lua --no-record
	says err "fast.lua:3: $call: too fast"
done
