-- SPDX-License-Identifier: MIT
-- G15: two balls lie on each other, held by nothing but their own gravitation, at rest or as they drift. Answer: for 1e3 s
-- they stay as they are, and neither sinks into the other.
local verify = require "rbsim.verify"
local method = param("method", "located", "how", {choices = {"located", "auto", "stepped"}})
local friction = param("friction", "none", "of the balls", {choices = {"none", "rough"}})
local drifts = param("drifts", 0.0, "speed of both, m/s", {choices = {0.0, 0.125}})
verify.case { title = "At rest on each other", duration = 1000, time_step = {0.05, 0.01, 0.25}, frame_rate = {0.5, 0.1, 2},
	gravitation = {G = 1}, method = method, quick = "base" }
local rubber = material { name = "rubber", friction = friction == "rough" and 0.5 or 0, restitution = 0.5 }
local function ball(keys)
	keys.velocity, keys.material = {0, drifts, drifts / 2}, rubber
	return verify.sphere(keys)
end
local left = ball { name = "left", radius = 2, mass = 1, position = {-2, 0, 0} }
local right = ball { name = "right", radius = 1, mass = 3, position = {1, 0, 0} }
local least, most, moved, speed, first = math.huge, -math.huge, 0, 0, nil
on_frame(function(t)
	local apart = verify.position(right) - verify.position(left)
	first = first or apart
	least, most = math.min(least, apart:length() - 3), math.max(most, apart:length() - 3)
	moved = verify.larger(moved, (apart - first):length())
	speed = verify.larger(speed, (right.velocity - left.velocity):length())
end)
-- Located: two coordinates, below 128 m where they drift. By steps each of the up to 1e5 rounds positions and velocities; the
-- tolerance is 1e-6 m.
local steps = method == "stepped" and drifts > 0 and 1e5 or 0
local x = (drifts > 0 and 2 ^ -44 or 2 ^ -50) + 4 * verify.rounding + steps * 2 ^ -46
expect("they sink, m", function() return -least, x end)
expect("they part, m", function() return most, x end)
expect("they turn about each other, m", function() return moved, x end)
expect("relative speed, m/s", function() return speed, 1e-14 + steps * 2 ^ -55 end)
