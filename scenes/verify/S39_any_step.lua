-- SPDX-License-Identifier: MIT
-- S39: a thrown sphere bounces with friction and spin, at steps from 1e-9 s (a million of them) to 1 s. Answer: the same
-- events and states, from the impact's closed form; so four steps of dt/4 are one of dt.
local verify = require "rbsim.verify"
local impact = require "impact"
local dt = param("dt", 1.0, "longest step, s", {choices = {1.0, 0.25, 1e-3, 2.5e-4, 1e-9}})
local g, e, mu, radius = 9.81, 0.8, 0.1, 0.1
local short = dt == 1e-9
local duration = short and 1e-3 or 4

verify.case { title = "Steps from a nanosecond to a second", duration = duration, gravity = {0, 0, -g}, time_step = {dt},
	frame_rate = {1, 10, 7}, quick = "more",
	leave_out = {time_step = "it is this case's own parameter, from 1e-9 s to 1 s"} }
local stuff = material { name = "stuff", friction = mu, restitution = e }
verify.plane { material = stuff }
local thrown = {g = g, height = short and 2e-4 or 1, vz = short and -1 or 4, vx = 2, wr = -1, e = e, mu = mu}
local ball = verify.sphere { name = "ball", radius = radius, position = {0, 0, radius + thrown.height}, material = stuff,
	velocity = {thrown.vx, 0, thrown.vz}, angular_velocity = {0, thrown.wr / radius, 0} }

local flights = impact.flights(thrown, duration)
state.count, state.late = 0, 0
on_collision(function(c)
	state.count = state.count + 1
	local flight = flights[state.count + 1]
	state.late = verify.larger(state.late, math.abs(c.time - (flight and flight.time or 0 / 0)))
end)
expect("the same impacts", function() return math.abs(state.count - (#flights - 1)), 0 end)
expect("in time, s", function() return state.late, 1e-9 end)
expect_always("place, m", function()
	local at = impact.at(flights, g, time())
	return (verify.position(ball) - vec3(at.x, 0, at.height + radius)):length(), 1e-9
end)
expect("velocity, m/s", function()
	local at = impact.at(flights, g, duration)
	return (verify.velocity(ball) - vec3(at.vx, 0, at.vz)):length(), 1e-9
end)
expect("spin at the surface, m/s", function()
	local at = impact.at(flights, g, duration)
	return (radius * verify.spin(ball) - vec3(0, at.wr, 0)):length(), 1e-9
end)
