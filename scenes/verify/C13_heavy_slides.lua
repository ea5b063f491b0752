-- SPDX-License-Identifier: MIT
-- C13: a heavy slab that rides on a light one, up to a thousand million times heavier. Answer: both slide with mu g and
-- stop together after v/(mu g).
local verify = require "rbsim.verify"
local ratio = param("ratio", 1e4, "mass of the upper over that of the lower", {choices = {1e4, 1.0, 1e6, 1e9}})
local g, mu, v, thick = 9.81, 0.1, 0.5, 0.1
local stop = v / (mu * g)

verify.case { title = "Heavy slides on light", duration = 1, gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {60, 10, 100}, quick = "base" }
local ice = material { name = "ice", friction = mu, restitution = 0 }
local rough = material { name = "rough", friction = 0.9, restitution = 0 }
contact_pair(ice, rough, { friction = mu, restitution = 0 })
verify.plane { material = ice }
local bodies = {}
for k, mass in ipairs {1, ratio} do
	local width = k == 1 and 1 or 0.5
	bodies[k] = verify.box { name = k == 1 and "light" or "heavy", size = {width, width, thick}, mass = mass, material = rough,
		position = {0, 0, (k - 0.5) * thick}, velocity = {v, 0, 0} }
end
expect_always("both are where they should be, m", function()
	local t, far = math.min(time(), stop), 0
	for k, body in ipairs(bodies) do
		local wanted = vec3(v * t - mu * g * t * t / 2, 0, (k - 0.5) * thick)
		far = verify.larger(far, (verify.position(body) - wanted):length())
	end
	return far, 1e-9 + 2 * verify.rounding
end)
expect("they stand, m/s", function()
	return verify.larger(verify.velocity(bodies[1]):length(), verify.velocity(bodies[2]):length()), 1e-12
end)
