-- SPDX-License-Identifier: MIT
-- B04: after "Kapla" of SimBenchmark: a tower of 102 wooden blocks in six floors of 17. Answer: it stands for 600 s. The
-- published ones fall after 25 to 60,000 steps of 0.01 s, by the number of iterations.
local verify = require "rbsim.verify"
local stack = require "rbsim.stack"

verify.case { title = "SimBenchmark: Kapla", duration = 600, gravity = {0, 0, -9.81}, time_step = {0.01, 1 / 240, 0.1},
	frame_rate = {0.1, 1, 0.07}, quick = "none", length = 1, processor_seconds = 300 }
local wood = material { name = "wood", density = 700, friction = 0.5, restitution = 0 }
verify.plane { material = wood }
local blocks = stack.kapla { floors = 6 }
local bodies, start, height = stack.bodies(blocks, {material = wood}, "block", verify), {}, 0
for i, body in ipairs(bodies) do
	start[i] = verify.position(body)
	height = math.max(height, start[i].z)
end

expect("there are as many as there", function() return math.abs(#bodies - 102), 0 end)
expect_always("displacement over height", function()
	local far = 0
	for i, body in ipairs(bodies) do
		far = verify.larger(far, verify.larger((verify.position(body) - start[i]):length(), height * verify.tilt(body)))
	end
	return far / height, 1e-6 + verify.rounding
end)
expect("overlap, m", function() return max_penetration(), 1e-6 * 0.05 end)
