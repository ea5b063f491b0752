-- SPDX-License-Identifier: MIT
-- S38: S03 and S16 where bodies weigh a hundred thousand times more, or ten million times less. Answer: the same in units of
-- sqrt(m/g).
local verify = require "rbsim.verify"
local part = param("part", "zeno", "S03, or S16 of spheres or boxes", {choices = {"zeno", "stack", "boxes"}})
local g = param("g", 1e6, "m/s^2", {choices = {1e6, 1e-6}})
local e, h, radius, unit = part == "zeno" and 0.8 or 0, 1, 0.1, 1 / math.sqrt(g)
local rest = math.sqrt(2 * h) * (1 + e) / (1 - e)

verify.case { title = "Gravity of 1e6 and 1e-6 m/s^2", duration = part == "zeno" and rest + 1 or 100, time_unit = unit,
	gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 1}, frame_rate = {1, 10, 0.7}, quick = "more" }
local stuff = material { name = "stuff", friction = 0.5, restitution = e }
verify.plane { material = stuff }
if part == "zeno" then
	local ball = verify.sphere { name = "ball", radius = radius, position = {0, 0, radius + h}, material = stuff }
	-- Turned obliquely, gravity and the floor's normal are rounded apart: the floor is a slope of that, on which it rolls.
	local slant = verify.turn == 2 and 2 * verify.u * g or 0
	on_transition(function(c)
		if c.kind == "rest" or (slant > 0 and c.kind == "roll") then state.rest = state.rest or c.time end
	end)
	expect("it rests in time, relative", function()
		return math.abs((state.rest or 0) / unit / rest - 1), 1e-9 + verify.rounding / (2 * h)
	end)
	expect("then it has no speed", function() return ball.velocity:length(), slant * time() end)
	expect("it lies on the floor, m", function()
		return math.abs(verify.position(ball).z - radius), 1e-12 + verify.rounding
	end)
else
	local function one(name, mass, z)
		local keys = {name = name, mass = mass, position = {0, 0, z}, material = stuff}
		if part == "stack" then keys.radius = radius else keys.size = {2 * radius, 2 * radius, 2 * radius} end
		return verify[part == "stack" and "sphere" or "box"](keys)
	end
	local light, heavy = one("light", 1, radius), one("heavy", 1e4, 3 * radius)
	expect_always("overlap, radii", function()
		local a, b = verify.position(light), verify.position(heavy)
		return verify.larger(radius - a.z, 2 * radius - (b - a):length()) / radius, 1e-9
	end)
	expect("nothing drifts, radii", function()
		local a, b = verify.position(light) - vec3(0, 0, radius), verify.position(heavy) - vec3(0, 0, 3 * radius)
		return verify.larger(a:length(), b:length()) / radius, 1e-9
	end)
end
