-- SPDX-License-Identifier: MIT
-- C14: what rolls along the ground meets a step of a quarter of its radius and gets up, without hopping or slipping: sphere,
-- cylinder, capsule; the step is fixed, or heavy and free. Answer: with k = I/(m r^2) the impact leaves it turning about the
-- edge with v' = v (1 - h/(r (1 + k))); on top v''^2 = v'^2 - 2 g h/(1 + k), and it rolls on as if nothing had been.
local verify = require "rbsim.verify"
local shape = param("shape", "sphere", "what rolls", {choices = {"sphere", "cylinder", "capsule"}})
local step = param("step", "fixed", "the step", {choices = {"fixed", "heavy"}})
local r = param("radius", 1.0, "m", {choices = {1.0, 1e-3}})
local g, h, mu = 9.81, r / 4, 1
local unit = math.sqrt(r)
local v = 2.5 * unit

verify.case { title = "Up a step", duration = 2, time_unit = unit, length = r, gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {20, 1, 7}, quick = "base" }
local stuff = material { name = "stuff", friction = mu, restitution = 0 }
verify.plane { material = stuff }
verify.box { name = "step", size = {8 * r, 10 * r, h}, position = {4 * r, 0, h / 2}, material = stuff,
	static = step == "fixed" or nil, mass = step == "heavy" and 200 or nil }
local keys = {name = "body", radius = r, position = {-2 * r, 0, r}, velocity = {v, 0, 0}, angular_velocity = {0, v / r, 0},
	mass = 1, material = stuff}
if shape ~= "sphere" then keys.length, keys.orientation = 1.5 * r, {axis = {1, 0, 0}, angle = deg(90)} end
local body = verify[shape](keys)

local k = shape == "sphere" and 0.4 or body.inertia[3][3] / (body.mass * r * r)
local turns = v * (1 - h / (r * (1 + k)))
local top = math.sqrt(turns ^ 2 - 2 * g * h / (1 + k))
local impacts = 0
on_collision(function() impacts = impacts + 1 end)

expect("it meets the edge once", function() return math.abs(impacts - 1), 0 end)
-- from when it is on top, energy is that of rolling there: the height may be off by rounding only
expect_always("it loses nothing on its way, of what it had", function()
	local z, s, w = verify.position(body).z - r, verify.velocity(body), verify.spin(body) * r
	local energy = s:dot(s) / 2 + k * w:dot(w) / 2 + g * z
	local wanted = (1 + k) / 2 * (impacts > 0 and turns or v) ^ 2
	return math.abs(energy / wanted - 1), 1e-11 + 64 * verify.rounding / r
end)
expect("speed on top, relative", function()
	return (verify.velocity(body) - vec3(top, 0, 0)):length() / top, 1e-9 + 64 * verify.rounding / r
end)
expect("spin on top, relative", function()
	return (verify.spin(body) - vec3(0, top / r, 0)):length() * r / top, 1e-9 + 64 * verify.rounding / r
end)
expect("it is on top, of the radius", function()
	return math.abs(verify.position(body).z - r - h) / r, 1e-11 + 4 * verify.rounding / r
end)
