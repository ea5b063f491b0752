-- SPDX-License-Identifier: MIT
-- S03: a ball loses part of its speed at each of infinitely many bounces. Answer: it rests from
-- sqrt(2h/g) (1 + e)/(1 - e) on.
local verify = require "rbsim.verify"
local e = param("e", 0.8, "restitution", {choices = {0.8, 0.5, 0.9, 0.99}})
local g, radius, h = 9.81, 0.1, 1
local rest = math.sqrt(2 * h / g) * (1 + e) / (1 - e)

verify.case { title = "Bounces that end", duration = rest + 1, gravity = {0, 0, -g}, time_step = {0.01, 1e-4, 0.1},
	frame_rate = {10, 1, 7}, quick = "more" }
local rubber = material { name = "rubber", friction = 0.5, restitution = e }
verify.plane { material = rubber }
local ball = verify.sphere { name = "ball", radius = radius, position = {0, 0, radius + h}, material = rubber }

-- Turned obliquely, gravity and the floor's normal are rounded apart by an ulp or two: the floor is a slope of that, on
-- which the ball rolls.
local slant = verify.turn == 2 and 2 * verify.u * g or 0
on_transition(function(c)
	if c.kind == "rest" or (slant > 0 and c.kind == "roll") then state.rest = state.rest or c.time end
end)
-- A drop height that is rounded by d moves the end by rest d/(2h).
expect("it rests in time, relative", function()
	return math.abs((state.rest or 0) / rest - 1), 1e-12 + verify.rounding / (2 * h)
end)
expect("then it has no speed", function() return ball.velocity:length(), slant * time() end)
expect("it lies on the floor, m", function()
	return math.abs(verify.position(ball).z - radius), 1e-12 + verify.rounding
end)
expect("it took a bounded number of impacts", function() return collisions(), 1e5 end)
