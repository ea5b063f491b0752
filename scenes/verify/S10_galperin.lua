-- SPDX-License-Identifier: MIT
-- S10: a heavy ball drives a light one against a wall (G. Galperin, Playing pool with pi, Regul. Chaotic Dyn. 8, 2003).
-- Answer: the impacts are as many as pi has digits to show, floor(pi/atan(sqrt(m/M))). In the plane of the velocities times
-- the roots of the masses each impact is a reflection, two are a rotation by 2 atan(sqrt(m/M)).
-- The spheres are large against the gaps: balls on a line are unstable across it, by a factor of 1 + sqrt(2 gap/radius) at
-- each impact, which would make another problem of the rotated one. The gap is angle/sin(n angle) m at impact n, so in all
-- a deviation grows by exp(5.25 sqrt(2/(radius angle))).
local verify = require "rbsim.verify"
local k = param("k", 2, "the mass ratio is 100^k", {choices = {2, 1, 3, 4, 5}})
local ratio, radius = 100 ^ k, 64 * 8 ^ math.max(0, k - 2)
local angle = math.atan(1 / math.sqrt(ratio))
local count = math.floor(math.pi / angle)

verify.case { title = "Counting pi", duration = 40, time_step = {0.1, 1e-3, 1}, frame_rate = {1, 10, 7},
	tolerance = 1e-6, quick = "more", length = radius / 16, processor_seconds = 120 }
local hard = material { name = "hard", friction = 0, restitution = 1 }
verify.plane { normal = {1, 0, 0}, material = hard }
local light = verify.sphere { name = "light", radius = radius, mass = 1, position = {radius + 1, 0, 0}, material = hard }
local heavy = verify.sphere { name = "heavy", radius = radius, mass = ratio, position = {3 * radius + 2, 0, 0},
	velocity = {-1, 0, 0}, material = hard }

-- Direction in that plane at the end; an odd count ends with the two balls' impact.
local last = count % 2 == 0 and math.pi - count * angle or (count + 1) * angle - math.pi
local peak = math.sqrt(ratio)
expect("the count of impacts", function() return math.abs(collisions() - count), 0 end)
expect("the heavy ball's velocity", function() return math.abs(verify.velocity(heavy).x - math.cos(last)), 1e-9 end)
-- Up to k = 4 relative to its own value; the light ball has been up to 1e5 times as fast at k = 5, and each of 314159
-- reflections rounds the angle: there relative to the largest speed. Turned or shifted, every impact rounds three components
-- at up to the largest speed, and the last speed may be 1e-5 of that.
expect("the light ball's velocity, relative", function()
	local wanted = math.sin(last) * peak
	local scale = k < 5 and math.abs(wanted) or peak
	return math.abs(verify.velocity(light).x - wanted) / scale, 1e-9 + (verify.exact and 0 or count * verify.u * peak / scale)
end)
-- Each impact tilts by the rounding of the coordinates over the radius, which then grows as said above. On an axis there is
-- nothing across.
expect("nothing across the line, relative to the largest speed", function()
	local v, w = verify.velocity(light), verify.velocity(heavy)
	local across = math.abs(v.y) + math.abs(v.z) + math.abs(w.y) + math.abs(w.z)
	local tilt = (verify.turn == 2 and verify.u or 0) + 3 * verify.rounding / radius
	return across / peak, verify.exact and 0 or count * tilt * math.exp(5.25 * math.sqrt(2 / (radius * angle)))
end)
