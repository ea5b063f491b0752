-- SPDX-License-Identifier: MIT
-- S12: a ball hits another, that one a wall and then the first one again. Answer: impacts at 5, 10 and 15 ms, and the
-- first ball goes back as fast as it came.
local verify = require "rbsim.verify"
local radius = 0.1

verify.case { title = "Ball, ball and wall", duration = 0.1, time_step = {0.01, 1e-4, 0.1}, frame_rate = {10, 60, 100},
	quick = "more" }
local hard = material { name = "hard", friction = 0, restitution = 1 }
verify.plane { normal = {-1, 0, 0}, point = {1.1, 0, 0}, material = hard }
local a = verify.sphere { name = "a", radius = radius, position = {0.78, 0, 0}, velocity = {2, 0, 0}, material = hard }
local b = verify.sphere { name = "b", radius = radius, position = {0.99, 0, 0}, material = hard }

state.times = {}
on_collision(function(c) state.times[#state.times + 1] = c.time end)
-- A gap that is rounded by d moves an impact by d/2; a tilt of the normals by d/(2 radius) grows threefold at each of three.
local bar = 1e-12 + 10 * verify.rounding
expect("three impacts", function() return math.abs(#state.times - 3), 0 end)
expect("in time, s", function()
	local late = 0
	for i = 1, 3 do late = verify.larger(late, math.abs((state.times[i] or 0 / 0) - 0.005 * i)) end
	return late, bar
end)
expect("the first ball goes back", function()
	return (verify.velocity(a) - vec3(-2, 0, 0)):length(), 1e-12 + 30 * verify.rounding / radius
end)
expect("the second one stands", function() return verify.velocity(b):length(), 1e-12 + 30 * verify.rounding / radius end)
