-- SPDX-License-Identifier: MIT
-- S31, gear: two equal spheres meet head-on with opposite spins, like gear wheels (Chung and Ooi 2011, test 7). Answer:
-- their surfaces move alike, so nothing happens along them, exactly.
local verify = require "rbsim.verify"
local spin = param("spin", 21.0, "rad/s", {choices = {21.0, 0.175}})
local e, v, radius = 0.5, 0.2, 0.1

verify.case { title = "Gear wheels", duration = 1, time_step = {1e-2, 1e-4, 1}, frame_rate = {10, 60, 1}, quick = "more" }
local nylon = material { name = "nylon", friction = 0.4, restitution = e }
local a = verify.sphere { name = "a", radius = radius, position = {-0.15, 0, 0}, velocity = {v, 0, 0},
	angular_velocity = {0, 0, spin}, material = nylon }
local b = verify.sphere { name = "b", radius = radius, position = {0.15, 0, 0}, velocity = {-v, 0, 0},
	angular_velocity = {0, 0, -spin}, material = nylon }

-- A normal that is tilted by rounding turns part of the approach and of the surfaces' speed along it.
local bar = verify.exact and 0 or (v + spin * radius) * (4 * verify.u + 2 * verify.rounding / radius)
expect("the normal part, relative", function()
	return math.abs(verify.velocity(a).x / (-e * v) - 1) + math.abs(verify.velocity(b).x / (e * v) - 1), 1e-12
end)
expect("nothing along the surfaces, m/s", function()
	local p, q = verify.velocity(a), verify.velocity(b)
	return math.abs(p.y) + math.abs(p.z) + math.abs(q.y) + math.abs(q.z), 2 * bar
end)
expect("the spins stay, m/s at the surface", function()
	local p, q = verify.spin(a) - vec3(0, 0, spin), verify.spin(b) + vec3(0, 0, spin)
	return radius * (p:length() + q:length()), 5 * bar
end)
