-- SPDX-License-Identifier: MIT
-- S09: a head-on impact of spheres of very different mass. Answer: the one at rest leaves at (1 + e) v m/(m + M), and
-- momentum stays.
local verify = require "rbsim.verify"
local ratio = param("ratio", 1e9, "mass of the moving one over that of the other", {choices = {1e9, 1e-9, 1e6, 1.0}})
local e = param("e", 1.0, "restitution", {choices = {1.0, 0.5}})
local radius, v = 0.1, 1

verify.case { title = "A mass ratio of a billion", duration = 1, time_step = {0.01, 1e-4, 1}, frame_rate = {1, 10, 7},
	quick = "more" }
local hard = material { name = "hard", friction = 0, restitution = e }
local a = verify.sphere { name = "a", radius = radius, mass = ratio, position = {-0.7, 0, 0}, velocity = {v, 0, 0},
	material = hard }
local b = verify.sphere { name = "b", radius = radius, mass = 1, material = hard }

-- Coordinates that are rounded by d tilt the normal by d/(2 radius).
local bar = 1e-14 + 2 * verify.rounding / radius
expect("one impact", function() return math.abs(collisions() - 1), 0 end)
expect("the one at rest leaves at its speed, relative", function()
	local wanted = (1 + e) * v * ratio / (1 + ratio)
	return (verify.velocity(b) - vec3(wanted, 0, 0)):length() / wanted, bar
end)
expect("the other one's speed, relative to v", function()
	local wanted = v * (ratio - e) / (1 + ratio)
	return (verify.velocity(a) - vec3(wanted, 0, 0)):length() / v, bar
end)
expect("momentum changes by 4 ulp at most, relative", function()
	local p, q = ratio * verify.velocity(a), verify.velocity(b)
	local largest = math.max(ratio * v, p:length(), q:length())
	return (p + q - vec3(ratio * v, 0, 0)):length() / largest, 4 * verify.u
end)
