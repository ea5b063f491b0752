-- SPDX-License-Identifier: MIT
-- C03: a floor that moves: up at a constant speed under a bouncing ball, or along under a ball that begins to roll. Answer:
-- that of a floor at rest, seen from the floor.
local verify = require "rbsim.verify"
local impact = require "impact"
local part = param("part", "lift", "which way it moves", {choices = {"lift", "belt"}})
local g, radius, e, mu, u, duration = 9.81, 0.1, 0.8, 0.3, 0.5, 3
local up = part == "lift" and vec3(0, 0, u) or vec3(u, 0, 0)

verify.case { title = "A driven floor", duration = duration, gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {10, 1, 7}, quick = "more" }
local stuff = material { name = "stuff", friction = mu, restitution = part == "lift" and e or 0 }
verify.plane { material = stuff, motion = function(t) return t * up, nil, up, vec3(0, 0, 0) end }
local height = part == "lift" and 1 or 0
local ball = verify.sphere { name = "ball", radius = radius, position = {0, 0, radius + height}, material = stuff }

if part == "lift" then
	local thrown = {g = g, height = height, vz = -u, vx = 0, wr = 0, e = e, mu = mu}
	local flights = impact.flights(thrown, duration)
	expect_always("place, m", function()
		local at = impact.at(flights, g, time())
		return (verify.position(ball) - vec3(0, 0, at.height + radius + u * time())):length(), 1e-10 + 8 * verify.rounding
	end)
	expect("the impacts are as many", function() return math.abs(collisions() - (#flights - 1)), 0 end)
else
	local rolls = 2 * u / (7 * mu * g)
	on_transition(function(c)
		if c.kind == "roll" then state.rolls = state.rolls or c.time end
	end)
	expect("it rolls in time, relative", function() return math.abs((state.rolls or 0) / rolls - 1), 1e-10 end)
	expect_always("place, m", function()
		local s, t = math.min(time(), rolls), time()
		local x = mu * g * s * s / 2 + mu * g * s * (t - s)
		return (verify.position(ball) - vec3(x, 0, radius)):length(), 1e-10 + verify.rounding
	end)
	expect("velocity, relative", function() return (verify.velocity(ball) - vec3(2 / 7 * u, 0, 0)):length() / u, 1e-10 end)
	expect("spin, relative", function()
		return (radius * verify.spin(ball) - vec3(0, -5 / 7 * u, 0)):length() / u, 1e-10
	end)
end
