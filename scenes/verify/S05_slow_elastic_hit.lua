-- SPDX-License-Identifier: MIT
-- S05: a sphere hits an equal one at rest, however slowly. Answer: they exchange their velocities.
local verify = require "rbsim.verify"
local v = param("v", 1e-3, "speed, m/s", {choices = {1.0, 1e-3, 1e-6}})
local radius = 0.1

verify.case { title = "A slow elastic hit", duration = 1, time_step = {0.01, 1e-4, 1}, frame_rate = {1, 10, 60},
	quick = "more" }
local hard = material { name = "hard", friction = 0, restitution = 1 }
local a = verify.sphere { name = "a", radius = radius, position = {-2 * radius - v / 2, 0, 0}, velocity = {v, 0, 0},
	material = hard }
local b = verify.sphere { name = "b", radius = radius, material = hard }

-- Coordinates that are rounded by d tilt the normal by d/(2 radius).
local bar = 1e-14 + 2 * verify.rounding / radius
expect("one impact", function() return math.abs(collisions() - 1), 0 end)
expect("the first one stands, relative", function() return verify.velocity(a):length() / v, bar end)
expect("the second one has its velocity, relative", function()
	return (verify.velocity(b) - vec3(v, 0, 0)):length() / v, bar
end)
