#!/bin/sh
# SPDX-License-Identifier: MIT
# Problems with known answers, located, in frames turned at random: rounding then is in every coordinate.
. tests/cli/functions

# frame.lua: directions and orientations of a turned frame
cat >frame.lua <<'LUA'
local frame = {}
local turn = param("turn", 0.0, "rad: of all, about an oblique axis")
local axis = vec3(1, 2, -2) / 3
function frame.at(x, y, z)
	local p = vec3(x, y, z)
	return p * math.cos(turn) + axis:cross(p) * math.sin(turn) + axis * (axis:dot(p) * (1 - math.cos(turn)))
end
local c, s = math.cos(turn / 2), math.sin(turn / 2)
frame.orientation = {c, s * axis.x, s * axis.y, s * axis.z}
frame.x, frame.y, frame.z = frame.at(1, 0, 0), frame.at(0, 1, 0), frame.at(0, 0, 1)
return frame
LUA

answers()
{
	exits 0 run "$@" --method located --no-record --quiet
}

# the same, and nothing that costs so much that auto gives up locating: what had no end has one now
located()
{
	exits 0 run "$@" --method auto --no-record
	says err 'method +auto: located, '
}

# on a spring and no friction: where it turns back nothing happens, whatever way rounding makes its corners go
cat >spring.lua <<'LUA'
local frame = require "frame"
local shape = param("shape", "box", "what is on the spring", {choices = {"box", "cylinder"}})
world { duration = 2, gravity = frame.at(0, 0, -9.81) }
local m = material { name = "m", friction = 0, restitution = 0 }
plane { normal = frame.z, material = m }
local keys = { mass = 2, position = frame.at(1.3, 0, 0.15), orientation = frame.orientation, material = m }
keys.size, keys.radius, keys.length = {0.4, 0.5, 0.3}, 0.2, 0.3
keys[shape == "box" and "radius" or "size"] = nil
if shape == "box" then keys.length = nil end
local b = (shape == "box" and box or cylinder)(keys)
local post = sphere { radius = 0.01, static = true, position = frame.at(-2, 0, 0.15), collides_with = "nothing" }
spring { a = post, b = b, stiffness = 40, rest_length = 2 }
expect("it swings", function() return (b.position - frame.at(1.3 * math.cos(2 * math.sqrt(20)), 0, 0.15)):length(), 1e-11 end)
LUA
for turn in 0 0.7 1.9 2.6; do
	answers spring.lua -p turn=$turn
done
answers spring.lua -p turn=0.7 -p shape=cylinder

# a cylinder on its end on a slope: it stands as long as its weight points into its end, whichever way that leans; beyond, it
# falls over the point of the rim that is lowest
cat >stands.lua <<'LUA'
local frame = require "frame"
local share = param("share", 0.9, "of the slope at which it falls")
local way = param("way", 0.0, "rad: downhill, in the frame")
local R, h = 0.2, 0.8
local slope = math.atan(share * 2 * R / h)
local down = frame.x * math.cos(way) + frame.y * math.sin(way)
world { duration = 0.8, gravity = (down * math.sin(slope) - frame.z * math.cos(slope)) * 9.81 }
local m = material { name = "m", friction = 2, restitution = 0 }
plane { normal = frame.z, material = m }
local b = cylinder { radius = R, length = h, mass = 1, position = frame.at(0, 0, h / 2),
	orientation = frame.orientation, material = m }
-- about the lowest point: I phi'' = g d sin(phi + slope - atan(2 R / h)), d its distance from the middle
local d, inertia = math.sqrt(R * R + h * h / 4), R * R / 4 + h * h / 12 + R * R + h * h / 4
local phi, w, n = 0, 0, 4000
for _ = 1, n do
	local function f(x) return 9.81 * d / inertia * math.sin(x + slope - math.atan(2 * R / h)) end
	local k = 0.8 / n
	local a1, a2 = f(phi), f(phi + k / 2 * w)
	local a3, a4 = f(phi + k / 2 * (w + k / 2 * a1)), f(phi + k * (w + k / 2 * a2))
	phi, w = phi + k * w + k * k / 6 * (a1 + a2 + a3), w + k / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
end
local wanted = share < 1 and vec3(0, 0, 0) or frame.z:cross(down) * w
expect("it stands or falls", function() return (b.angular_velocity - wanted):length(), share < 1 and 1e-15 or 1e-10 end)
expect("nowhere else", function() return math.abs(b.position:dot(frame.z:cross(down))), 1e-11 end)
LUA
for turn in 0 0.7 1.9; do
	answers stands.lua -p turn=$turn -p way=0.4
	answers stands.lua -p turn=$turn -p share=0.999999 -p way=2
	answers stands.lua -p turn=$turn -p share=1.01 -p way=-0.3
	answers stands.lua -p turn=$turn -p share=1.1 -p way=1
done
# prisms that meet end to end, corners exactly opposite: what drifts past the other's border by rounding alone still meets it,
# level or tilted by rounding; level they rebound by the restitution
cat >ends.lua <<'LUA'
local frame = require "frame"
local tilt = param("tilt", 0.0, "rad: half of that of one of them")
local drift = param("drift", 0.0, "1/s, of the other's turning")
world { duration = 0.2 }
local m = material { name = "m", friction = 0, restitution = 0.7 }
local r = 0.1
local function prism(x, speed, tilt, turning)
	local points = {}
	for i = -1, 1, 2 do
		for _, p in ipairs { {0.1, 0.1}, {-0.1, 0.1}, {0, -0.2} } do points[#points + 1] = {i * r, p[1], p[2]} end
	end
	local q, y = frame.orientation, frame.y * tilt
	return hull { points = points, center_of_mass = {0, 0, 0}, mass = 1, material = m, position = frame.at(x, 0, 0),
		velocity = frame.x * speed, angular_velocity = frame.y * turning,
		orientation = {q[1], q[2] + y.x, q[3] + y.y, q[4] + y.z} }
end
local a = prism(0.555, 0.3, 0, drift / 30)
local b = prism(0.77464518819444417, -0.7, tilt, -drift)
expect("they part", function()
	local speed = frame.x:dot(b.velocity - a.velocity)
	if tilt == 0 then return math.abs(speed - 0.7), 1e-13 end
	return math.max(0, 0.1 - speed), 1e-13
end)
LUA
for turn in 0 0.7; do
	answers ends.lua -p turn=$turn
	answers ends.lua -p turn=$turn -p drift=7.5e-14
	answers ends.lua -p turn=$turn -p tilt=-1e-14 -p drift=7.5e-14
	answers ends.lua -p turn=$turn -p tilt=-1e-9 -p drift=1e-9
done
# boxes that meet face to face, tilted by a little, without restitution: corner after corner hits;
# one that parts within rounding does not hide the next
cat >faces.lua <<'LUA'
local frame = require "frame"
local tilt = param("tilt", 1e-9, "rad, twice")
world { duration = 0.1 }
local m = material { name = "m", friction = 0.5, restitution = 0 }
local keys = { size = {0.2, 0.25, 0.3}, mass = 1, material = m, orientation = frame.orientation }
keys.position, keys.velocity = frame.at(0.455, 0, 0), frame.x * 0.3
local a = box(keys)
local q, y = frame.orientation, (frame.y * 0.825 + frame.z * 0.565) * tilt
keys.position, keys.velocity = frame.at(0.6746, 0, 0), frame.x * -0.7
keys.orientation = {q[1] - (q[2] * y.x + q[3] * y.y + q[4] * y.z), q[2] + q[1] * y.x + q[4] * y.y - q[3] * y.z,
	q[3] + q[1] * y.y + q[2] * y.z - q[4] * y.x, q[4] + q[1] * y.z + q[3] * y.x - q[2] * y.y}
local b = box(keys)
expect("they go on almost together, alike however tilted and in all frames", function()
	local apart = (b.velocity - a.velocity):length() + (a.velocity + frame.x * 0.2):length() + b.angular_velocity:length()
	return math.abs(apart - 0.0174113), 1e-6
end)
LUA
for tilt in 1e-10 3e-9 1e-8; do
	for turn in 0 0.7 2.3; do
		located faces.lua -p turn=$turn -p tilt=$tilt
	done
done
# wedges that meet flank to flank, tilted by a little, without friction or restitution: the far side of a flank comes down just
# after the near one, and slides past the other's border as it goes on; it hits all the same
cat >wedges.lua <<'LUA'
local frame = require "frame"
local tilt = param("tilt", 1e-12, "rad")
world { duration = 0.3 }
local m = material { name = "m", friction = 0, restitution = 0 }
local function wedge(x, y, way, speed, turned)
	local points = {}
	for i = -1, 1, 2 do
		for _, p in ipairs { {0.2, 0}, {-0.1, 0.1}, {-0.1, -0.1} } do points[#points + 1] = {way * p[1], p[2], i * 0.1} end
	end
	local q, h = frame.orientation, frame.y * (turned / 2)
	return hull { points = points, center_of_mass = {0, 0, 0}, mass = 1, material = m, position = frame.at(x, y, 0),
		velocity = frame.x * speed, orientation = {q[1] - (q[2] * h.x + q[3] * h.y + q[4] * h.z),
			q[2] + q[1] * h.x + q[4] * h.y - q[3] * h.z, q[3] + q[1] * h.y + q[2] * h.z - q[4] * h.x,
			q[4] + q[1] * h.z + q[3] * h.x - q[2] * h.y} }
end
local a, b = wedge(0.355, 0, 1, 0.3, 0), wedge(0.7746, 0.05, -1, -0.7, tilt)
expect("they glance off alike, however tilted and in all frames", function()
	local apart, spin = (b.velocity - a.velocity):length(), b.angular_velocity:length()
	return math.max(math.abs(apart - 0.92548), math.abs(spin - 2.01231), math.abs(a.angular_velocity:length() - spin)), 3e-5
end)
LUA
for tilt in 1e-12 1e-10; do
	for turn in 0 2.3; do
		answers wedges.lua -p turn=$turn -p tilt=$tilt
	done
done
# two of their edges cross so nearly parallel that they have no normal but the flank's
answers wedges.lua -p turn=0.7 -p tilt=1e-10

# a ladder slides off a wall, all smooth: it leaves the wall at two thirds of its height; its speed along the floor is largest there
cat >ladder.lua <<'LUA'
local l, r, g, t0 = 2, 0.02, 9.81, 1.2
world { duration = 0.75, gravity = {0, 0, -g} }
local m = material { friction = 0, restitution = 0 }
plane { material = m }
local wall = plane { normal = {1, 0, 0}, material = m }
local ladder = capsule { radius = r, length = l, material = m, orientation = {axis = {0, 1, 0}, angle = t0 - math.pi / 2},
	position = {r + l / 2 * math.cos(t0), 0, r + l / 2 * math.sin(t0)} }
on_transition(function(c)
	if c.kind == "lift" and (c.a == wall or c.b == wall) then state.height = state.height or ladder.position.z - r end
end)
local s = math.sin(t0)
local k = ladder.mass * g * (l / 2) / (ladder.mass * l * l / 4 + ladder.inertia[1][1])
expect("it leaves the wall", function() return math.abs(state.height / (l / 2 * s) - 2 / 3), 1e-11 end)
expect("it goes on", function() return math.abs(ladder.velocity.x / (l / 3 * s * math.sqrt(2 * k * s / 3)) - 1), 1e-13 end)
LUA
located ladder.lua

# beads in a row, on slack ropes, of which the first is pulled with F: a rope that comes taut takes half of what the pull gives
# beyond the momentum, P^2 = F d m n (n - 1) when the last of n is on its way, d the slack
cat >row.lua <<'LUA'
local n, d, F, m, g = 8, 0.2, 12, 0.5, 0.1
world { duration = 1 }
local beads, taut = {}, 0
for k = 1, n do
	beads[k] = sphere { radius = 0.02, mass = m, position = {-(k - 1) * g, 0, 0}, forces = k == 1 and {{vector = {F, 0, 0}}} or nil }
	if k > 1 then joint { kind = "rope", a = beads[k - 1], b = beads[k], length = g + d } end
end
on_collision(function(c) taut = taut + 1; state.t = c.time end)
expect("each rope once", function() return taut == n - 1 end)
expect("the last", function() return math.abs((F * state.t)^2 / (F * d * m * n * (n - 1)) - 1), 1e-13 end)
expect("all go on as one", function() return math.abs(beads[n].velocity.x / (F / (n * m)) - 1), 1e-14 end)
LUA
located row.lua

# a cut shot: of equal smooth balls the cue ball keeps its spin, and when it rolls again it has 5/7 of what the impact has left
# of its velocity and 2/7 of what it had before
cat >cut.lua <<'LUA'
local R, v, e, phi = 0.03, 2, 0.95, 0.6
world { duration = 2.5, gravity = {0, 0, -9.81} }
local ball, cloth = material { friction = 0, restitution = e }, material { friction = 0.2, restitution = 0 }
contact_pair(ball, cloth, { friction = 0.2, restitution = 0 })
plane { material = cloth }
local n = vec3(math.cos(phi), math.sin(phi), 0)
local cue = sphere { radius = R, material = ball, position = {0, 0, R}, velocity = {v, 0, 0}, angular_velocity = {0, v / R, 0} }
local other = sphere { radius = R, material = ball, position = vec3(0.3, 0, R) + n * (2 * R) }
local given = n * (v * math.cos(phi) * (1 + e) / 2)
expect("the cue ball", function() return (cue.velocity - vec3(v, 0, 0) + given * (5 / 7)):length(), 1e-14 end)
expect("the other ball", function() return (other.velocity - given * (5 / 7)):length(), 1e-14 end)
LUA
located cut.lua
