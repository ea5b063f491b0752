-- SPDX-License-Identifier: MIT
-- C02: a sphere rolls over the rim of a plate, too fast to stay on it (v^2 > g R). Answer: from the moment when its centre is
-- above the rim it flies a parabola, spinning on.
local verify = require "rbsim.verify"
local g, radius, v, duration = 9.81, 0.1, 2, 1
local leaves = 0.5

verify.case { title = "Over the edge", duration = duration, gravity = {0, 0, -g}, time_step = {0.01, 1e-4, 0.1},
	frame_rate = {10, 1, 7}, quick = "more" }
local stuff = material { name = "stuff", friction = 0.5, restitution = 0 }
verify.plane { size = {4, 2}, point = {-2, 0, 0}, material = stuff }
local ball = verify.sphere { name = "ball", radius = radius, position = {-v * leaves, 0, radius}, velocity = {v, 0, 0},
	angular_velocity = {0, v / radius, 0}, material = stuff }

on_transition(function(c)
	if c.kind == "lift" then state.lift = state.lift or c.time end
end)
expect("it lifts off in time, relative", function() return math.abs((state.lift or 0) / leaves - 1), 1e-10 + verify.rounding end)
expect_always("place, m", function()
	local s = math.max(0, time() - leaves)
	return (verify.position(ball) - vec3(v * (time() - leaves), 0, radius - g * s * s / 2)):length(), 1e-10 + 8 * verify.rounding
end)
expect("spin, relative", function()
	return (verify.spin(ball) - vec3(0, v / radius, 0)):length() / (v / radius), 1e-10
end)
