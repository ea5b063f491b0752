-- SPDX-License-Identifier: MIT
-- S25: a cube slides over a floor in a direction of its own. Answer: v^2/(2 mu g), straight, without turning, in all.
local verify = require "rbsim.verify"
local angle = param("angle", 0.0, "of the velocity to an edge, degrees", {choices = {0.0, 7.5, 15.0, 22.5, 30.0, 37.5, 45.0, 52.5,
	60.0, 67.5, 75.0, 82.5, 90.0}})
local g, mu, v, side = 9.81, 0.4, 2, 0.2
local along, across = vec3(math.cos(deg(angle)), math.sin(deg(angle)), 0), vec3(-math.sin(deg(angle)), math.cos(deg(angle)), 0)
local way, stops = v * v / (2 * mu * g), v / (mu * g)

verify.case { title = "The same friction in all directions", duration = 1, gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {10, 1, 60}, quick = "more" }
local stuff = material { name = "stuff", friction = mu, restitution = 0 }
verify.plane { material = stuff }
local box = verify.box { name = "box", size = {side, side, side}, position = {0, 0, side / 2}, velocity = v * along,
	material = stuff }

on_transition(function(c)
	if c.kind == "rest" then state.rest = state.rest or c.time end
end)
expect("distance, relative", function()
	return math.abs(verify.position(box):dot(along) / way - 1), 1e-10 + verify.rounding / way
end)
expect_always("aside, relative", function() return math.abs(verify.position(box):dot(across)) / way, 1e-10 + verify.rounding / way end)
expect_always("turned, rad", function() return verify.tilt(box), 1e-10 end)
expect("it rests in time, relative", function() return math.abs((state.rest or 0) / stops - 1), 1e-10 end)
expect("then it has no speed", function() return verify.velocity(box):length(), 1e-12 end)
