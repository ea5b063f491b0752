-- SPDX-License-Identifier: MIT
-- S10: a heavy ball drives a light one against a wall (G. Galperin, Playing pool with pi, Regul. Chaotic Dyn. 8, 2003).
-- Answer: the impacts are as many as pi has digits to show, floor(pi/atan(sqrt(m/M))). In the plane of the velocities times
-- the roots of the masses each impact is a reflection, two are a rotation by 2 atan(sqrt(m/M)).
-- The spheres are large against the gaps: balls on a line are unstable across it, by a factor of 1 + 2 gap/radius at each
-- impact, which would make another problem of the rotated one.
local verify = require "rbsim.verify"
local k = param("k", 2, "the mass ratio is 100^k", {choices = {2, 1, 3, 4, 5}})
local ratio, radius = 100 ^ k, 64
local angle = math.atan(1 / math.sqrt(ratio))
local count = math.floor(math.pi / angle)

verify.case { title = "Counting pi", duration = 40, time_step = {0.1, 1e-3, 1}, frame_rate = {1, 10, 7},
	tolerance = 1e-6, quick = "more", length = 4, wall_seconds = 120 }
local hard = material { name = "hard", friction = 0, restitution = 1 }
verify.plane { normal = {1, 0, 0}, material = hard }
local light = verify.sphere { name = "light", radius = radius, mass = 1, position = {radius + 1, 0, 0}, material = hard }
local heavy = verify.sphere { name = "heavy", radius = radius, mass = ratio, position = {3 * radius + 2, 0, 0},
	velocity = {-1, 0, 0}, material = hard }

-- Direction in that plane at the end; an odd count ends with the two balls' impact.
local last = count % 2 == 0 and math.pi - count * angle or (count + 1) * angle - math.pi
-- A normal that is tilted by rounding/radius at each of `count` impacts takes that much.
local bar = 1e-9 + count * 4 * verify.rounding / radius
expect("the count of impacts", function() return math.abs(collisions() - count), 0 end)
expect("the heavy ball's velocity", function()
	return (verify.velocity(heavy) - vec3(math.cos(last), 0, 0)):length(), bar
end)
expect("the light ball's velocity, relative", function()
	local wanted = math.sin(last) * math.sqrt(ratio)
	return (verify.velocity(light) - vec3(wanted, 0, 0)):length() / math.abs(wanted), bar
end)
