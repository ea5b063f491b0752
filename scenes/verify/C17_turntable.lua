-- SPDX-License-Identifier: MIT
-- C17: a ball that rolls on a tilted turntable, for a hundred of its turns and more.
-- Answer: with k = I/(m r^2), n upright, W the table's angular velocity and p the pull along it, a = (k W n x v + p)/(1 + k), which is
-- a circle about what drifts across the pull; the spin is n x (v - W n x x)/r, and that about n stays.
local verify = require "rbsim.verify"
local W = param("W", 6.0, "angular velocity of the table, rad/s", {choices = {6.0, -1.0, 25.0}})
local g, r, k, tilt, duration = 9.81, 0.05, 0.4, 0.05, 10
local pull, x0, v0 = g * math.sin(tilt), vec3(0.3, -0.1, r), vec3(0.2, 0.1, 0)

verify.case { title = "A tilted turntable", duration = duration, gravity = {pull, 0, -g * math.cos(tilt)},
	time_step = {0.01, 1e-3, 0.1}, frame_rate = {10, 1, 7}, quick = "base" }
local stuff = material { name = "stuff", friction = 5, restitution = 0 }
verify.plane { material = stuff, motion = function(t)
	return {0, 0, 0}, {math.cos(W * t / 2), 0, 0, math.sin(W * t / 2)}, vec3(0, 0, 0), vec3(0, 0, W)
end }
local up = vec3(0, 0, 1)
local function rolling(x, v) return up:cross(v - W * up:cross(x)) / r end
local ball = verify.sphere { name = "ball", radius = r, mass = 1, material = stuff, position = x0, velocity = v0,
	angular_velocity = rolling(x0, v0) }

-- v' = s n x v + q: a turn with s about the drift n x q/s.
local s, q = k / (1 + k) * W, vec3(pull / (1 + k), 0, 0)
local drift = up:cross(q) / s
local function at(t)
	local c, z, u = math.cos(s * t), math.sin(s * t), v0 - drift
	return x0 + drift * t + (u * z + up:cross(u) * (1 - c)) / s, drift + u * c + up:cross(u) * z
end
local far, fast = 0, 0
for t = 0, duration, 0.1 do
	local x, v = at(t)
	far, fast = math.max(far, x:length()), math.max(fast, rolling(x, v):length())
end
expect_always("place, of the way", function()
	return (verify.position(ball) - at(time())):length() / far, 1e-11 + 16 * verify.rounding / r
end)
expect_always("spin, relative", function()
	return (verify.spin(ball) - rolling(at(time()))):length() / fast, 1e-11 + 16 * verify.rounding / r
end)
