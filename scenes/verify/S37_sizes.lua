-- SPDX-License-Identifier: MIT
-- S37: a thrown sphere bounces with friction and spin, of a radius from a nanometre to a million kilometres, times scaled by
-- the root. Answer: in units of the radius always the same, from the impact's closed form.
local verify = require "rbsim.verify"
local impact = require "impact"
local size = param("size", 1e-9, "radius, m", {choices = {1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9}})
local g, e, mu, unit, duration = 9.81, 0.8, 0.1, math.sqrt(size), 5

verify.case { title = "All sizes", duration = duration, time_unit = unit, gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 1},
	frame_rate = {10, 1, 7}, quick = "more", length = size }
local stuff = material { name = "stuff", friction = mu, restitution = e }
verify.plane { material = stuff }
local thrown = {g = g, height = 4, vz = 1, vx = 2, wr = -1, e = e, mu = mu}
local ball = verify.sphere { name = "ball", radius = size, position = {0, 0, 5 * size}, material = stuff,
	velocity = size / unit * vec3(thrown.vx, 0, thrown.vz), angular_velocity = {0, thrown.wr / unit, 0} }

local flights = impact.flights(thrown, duration)
-- Rounding d of coordinates, in radii, is that of heights of the order of 1.
local bar = 1e-11 + 16 * verify.rounding / size
expect_always("place, radii", function()
	local at = impact.at(flights, g, time() / unit)
	return (verify.position(ball) / size - vec3(at.x, 0, at.height + 1)):length(), bar
end)
expect("velocity, radii per unit of time", function()
	local at = impact.at(flights, g, duration)
	return (verify.velocity(ball) * unit / size - vec3(at.vx, 0, at.vz)):length(), bar
end)
expect("spin, radians per unit of time", function()
	local at = impact.at(flights, g, duration)
	return (verify.spin(ball) * unit - vec3(0, at.wr, 0)):length(), bar
end)
expect("the impacts are as many", function() return math.abs(collisions() - (#flights - 1)), 0 end)
