-- SPDX-License-Identifier: MIT
-- S08: a sphere passes another with an impact parameter of 2 (1 -+ 1e-12) radii. Answer: it hits with the normal at
-- asin(b/2R) to its velocity, or misses.
local verify = require "rbsim.verify"
local hits = param("hits", true, "near enough", {choices = {true, false}})
local b = hits and 2 * (1 - 1e-12) or 2 * (1 + 1e-12)

verify.case { title = "Grazing", duration = 6, time_step = {0.01, 1e-3, 1}, frame_rate = {1, 10, 7}, quick = "more" }
local hard = material { name = "hard", friction = 0, restitution = 1 }
local still = verify.sphere { name = "still", radius = 1, mass = 1, material = hard }
local moving = verify.sphere { name = "moving", radius = 1, mass = 1, position = {-3, b, 0}, velocity = {1, 0, 0},
	material = hard }

on_collision(function(c)
	state.normal = verify.back_vector(c.normal)
	state.time = c.time
end)
expect("the right branch", function() return math.abs(collisions() - (hits and 1 or 0)), 0 end)
expect("energy is kept", function() return math.abs(2 * (still.kinetic_energy + moving.kinetic_energy) - 1), 1e-14 end)
if hits then
	-- The cosine is sqrt(2e-12) = 1.4e-6: an ulp of b, or a rounding of coordinates, weighs 1/1.4e-6.
	local cosine = math.sqrt((2 - b) * (2 + b)) / 2
	local bar = (4 * verify.u + verify.rounding) / cosine
	expect("the normal has the angle asin(b/2R), rad", function()
		local n = state.normal or vec3(0 / 0, 0, 0)
		return math.abs(math.abs(n.x) - cosine), bar
	end)
	expect("the one at rest takes the normal part", function()
		local wanted = cosine * vec3(cosine, -b / 2, 0)
		return (verify.velocity(still) - wanted):length(), 2 * bar
	end)
else
	expect("nothing changes", function()
		return still.velocity:length() + (verify.velocity(moving) - vec3(1, 0, 0)):length(), 4 * verify.u
	end)
end
