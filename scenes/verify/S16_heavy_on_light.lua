-- SPDX-License-Identifier: MIT
-- S16: a heavy cube on a cube of 1 kg, also a heavy ball on a ball, up to a thousand million times heavier. Answer: they
-- stand.
local verify = require "rbsim.verify"
local shape = param("shape", "box", "what stands there", {choices = {"box", "sphere"}})
local ratio = param("ratio", 1.0, "mass of the upper over that of the lower", {choices = {1.0, 1e2, 1e4, 1e6, 1e9}})

verify.case { title = "Heavy on light", duration = 100, gravity = {0, 0, -9.81}, time_step = {1 / 60, 1 / 240, 1},
	frame_rate = {1, 10, 0.3}, quick = "base" }
local stuff = material { name = "stuff", friction = 0.5, restitution = 0 }
verify.plane { material = stuff }
local bodies, start, turned = {}, {}, {}
for k, mass in ipairs {1, ratio} do
	local keys = {name = k == 1 and "light" or "heavy", mass = mass, position = {0, 0, k - 0.5}, material = stuff}
	if shape == "box" then keys.size = {1, 1, 1} else keys.radius = 0.5 end
	bodies[k] = verify[shape](keys)
	start[k], turned[k] = vec3(keys.position), verify.axes(bodies[k])
end

local bar = ratio <= 1e4 and 1e-9 or 1e-6
expect_always("nothing sinks or drifts, m", function()
	local far = 0
	for k, body in ipairs(bodies) do far = verify.larger(far, (verify.position(body) - start[k]):length()) end
	return far, bar + verify.rounding
end)
expect_always("nothing turns, rad", function()
	local most = 0
	for k, body in ipairs(bodies) do most = verify.larger(most, (verify.axes(body) - turned[k]):length()) end
	return most, bar
end)
expect("overlap, m", function() return max_penetration(), bar end)
