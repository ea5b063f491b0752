#!/bin/sh
# SPDX-License-Identifier: MIT
# What a driven body holds by a joint or a spring follows it from the moment it starts, also what has been at rest until then.
# By steps, a body at rest on a rod or rope slept on; located, a spring pulled towards where the last piece of the function would
# have led, so that one at rest stayed there, and others were off by up to 3e-7 of their way.
. tests/cli/functions

cat >starts.lua <<'END'
local by = param("by", "rod", "what holds the box", {choices = {"rod", "rope", "ball", "slider", "spring", "free"}})
local w = param("w", 5.0, "rad/s, of the box on its spring")
local bound = param("bound", 1e-9, "m, m/s")
local start, duration = 0.7, 1.4
world { duration = duration, frame_rate = 20, time_step = 0.002, gravity = {0, 0, by == "free" and 0 or -9.81} }
local m = material { friction = by == "spring" and 0 or 0.4, restitution = 0 }
local function way(t) return 2 * math.max(0, t - start) ^ 2, 4 * math.max(0, t - start) end
plane { material = m }
local b = box { size = {0.2, 0.2, 0.2}, position = {0, 0, 0.1}, mass = 8, material = m }
local d = sphere { radius = 0.05, motion = function(t)
	local x, v = way(t)
	return {1 + x, 0, 0.1}, nil, {v, 0, 0}
end }
if by == "rod" or by == "rope" then
	joint { kind = by, a = b, b = d }
elseif by == "ball" then
	joint { kind = "ball", a = b, b = d, at = {0.1, 0, 0.1} }
elseif by == "slider" then
	joint { kind = "slider", a = d, b = b, axis = {1, 0, 0}, motor = {speed = 0, force = 1e4} }
else
	spring { a = d, b = b, stiffness = 8 * w ^ 2 }
end
expect("follows", function()
	local x, v = way(duration)
	if by == "spring" or by == "free" then
		local s = duration - start
		x, v = x - 4 / w ^ 2 * (1 - math.cos(w * s)), v - 4 / w * math.sin(w * s)
	end
	return math.max(math.abs(b.position.x - x), math.abs(b.velocity.x - v)), bound
end)
END
for by in rod rope ball slider spring free 'spring -p w=500.0'; do
	# shellcheck disable=SC2086
	for how in located auto 'stepped -p bound=0.02'; do
		exits 0 starts.lua --no-record --method $how -p by=$by
	done
done

# A body on a spring whose other end oscillates, against the closed form.
cat >shaken.lua <<'END'
local W, w, T = param("W", 40.0, "rad/s, of the driven end"), param("w", 3.5, "rad/s"), param("T", 4.0, "s")
world { duration = T, frame_rate = 20 }
local b = sphere { radius = 0.1, mass = 8 }
local d = sphere { radius = 0.05, motion = function(t)
	return {1 + 0.01 * math.sin(W * t), 0, 0}, nil, {0.01 * W * math.cos(W * t), 0, 0}
end }
spring { a = b, b = d, stiffness = 8 * w ^ 2 }
local A = 0.01 * w ^ 2 / (w ^ 2 - W ^ 2)
local B = -W * A / w
expect("exact", function()
	return math.abs(b.position.x - A * math.sin(W * T) - B * math.sin(w * T)) / (math.abs(A) + math.abs(B)), 1e-10
end)
END
for case in 'W=4.0' 'W=40.0' 'W=400.0' 'W=40.0 -p T=40.0' 'W=40.0 -p w=0.05'; do
	# shellcheck disable=SC2086
	exits 0 shaken.lua --no-record --method located -p $case
done

# A ball along the straight side of what spins about z: s'' = W^2 s, if s' < -W (half the width + radius)/2 presses it against
# that. A spinning rectangle's rim was taken to keep its direction: the ball went 4.5 mm into it. Others bounced on it without end, or
# left it.
cat >spun.lua <<'END'
local kind = param("kind", "plane", "what spins", {choices = {"plane", "box"}})
local W, T, s, u, r = 2, 0.3, 1, -3, 0.1
world { duration = T, frame_rate = 20 }
local m = material { friction = 0, restitution = 0 }
local function motion(t)
	return {0, 0, 0}, {math.cos(W * t / 2), 0, 0, math.sin(W * t / 2)}, {0, 0, 0}, {0, 0, W}
end
if kind == "plane" then
	plane { size = {1, 4}, motion = motion, material = m }
else
	box { size = {1, 4, 1}, motion = motion, material = m }
end
local b = sphere { radius = r, position = {0.5 + r, s, 0}, velocity = {-W * s, W * (0.5 + r) + u, 0}, material = m }
expect("exact", function()
	local more, less = (s + u / W) / 2 * math.exp(W * T), (s - u / W) / 2 * math.exp(-W * T)
	local x, y, c, q = 0.5 + r, more + less, math.cos(W * T), math.sin(W * T)
	return (b.position - vec3(c * x - q * y, q * x + c * y, 0)):length(), 1e-12
end)
END
for kind in plane box; do
	exits 0 spun.lua --no-record --method located -p kind=$kind
done
