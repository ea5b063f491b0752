-- SPDX-License-Identifier: MIT
-- B02: "elastic 666" of SimBenchmark: a cube of 216 balls falls and bounces apart without loss. Answer: energy stays. The
-- best published relative error at a step of 1e-3 s is 8.4e-5 (root of the mean square).
local verify = require "rbsim.verify"
local g, radius, m, duration = 9.81, 0.1, 10, 10

verify.case { title = "SimBenchmark: elastic 666", duration = duration, gravity = {0, 0, -g}, seed = 42,
	time_step = {1e-3, 1e-4, 1e-2, 0.1}, frame_rate = {10, 1, 7}, quick = "base", length = 4 }
local hard = material { name = "hard", friction = 0, restitution = 1 }
verify.plane { material = hard }
local balls = {}
for i = 0, 5 do
	for j = 0, 5 do
		for k = 0, 5 do
			local p = vec3(0.21 * i, 0.21 * j, 1.101 + 0.21 * k)
			p = p + 1e-3 * vec3(math.random(), math.random(), math.random())
			balls[#balls + 1] = verify.sphere { radius = radius, mass = m, position = p, material = hard }
		end
	end
end

local function energy_now()
	local sum = 0
	for _, ball in ipairs(balls) do
		sum = sum + ball.kinetic_energy + m * g * verify.position(ball).z
	end
	return sum
end
local before = energy_now()
-- An impact at a place that is rounded by d changes an energy by m g d, some thousand of them with either sign.
expect_always("energy is kept, relative", function()
	return math.abs(energy_now() / before - 1), 1e-12 + 64 * verify.rounding / 3
end)
expect("they do hit each other", function() return collisions() > 1000 end)
