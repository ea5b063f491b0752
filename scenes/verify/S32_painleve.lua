-- SPDX-License-Identifier: MIT
-- S32: the lower end of a slender rod slides and digs in, where friction would need a force that it cannot have
-- (Painleve: mu > 4/3 at 63 degrees). Answer: an impulse ends the slip at once, and the end stands (in numbers:
-- tests/test_located_jam.c); asked here is that energy never rises, that numbers stay finite, and that the run ends.
local verify = require "rbsim.verify"
local shape = param("shape", "capsule", "of the rod", {choices = {"capsule", "box"}})
local mu = param("mu", 1.5, "friction", {choices = {1.5, 3.0, 1.2}})
local g, length, thick, angle, v = 9.81, 1, 0.01, deg(63), 1

verify.case { title = "Painleve's rod", duration = 2, gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {100, 10, 60}, quick = "more" }
local stuff = material { name = "stuff", friction = mu, restitution = 0 }
verify.plane { material = stuff }
-- The rod's axis, its own z, leans to +x; it slides towards -x.
local keys = {name = "rod", mass = 1, material = stuff, velocity = {-v, 0, 0}, orientation = {axis = {0, 1, 0}, angle = deg(90) - angle}}
local rod
if shape == "capsule" then
	keys.radius, keys.length = thick / 2, length
	keys.position = {0, 0, length / 2 * math.sin(angle) + thick / 2}
	rod = verify.capsule(keys)
else
	keys.size = {thick, thick, length}
	keys.position = {0, 0, length / 2 * math.sin(angle) + thick / 2 * math.cos(angle)}
	rod = verify.box(keys)
end

local function energy_now() return rod.kinetic_energy + g * verify.position(rod).z end
local least = energy_now()
expect_always("energy never rises, relative", function()
	local now = energy_now()
	local more = now / least - 1
	least = math.min(least, now)
	return more, 1e-12 + 8 * verify.rounding
end)
expect("it lies on the floor, m", function()
	return verify.position(rod).z, thick / 2 + 1e-6 * length
end)
expect("overlap, m", function() return max_penetration(), 1e-6 * thick end)
