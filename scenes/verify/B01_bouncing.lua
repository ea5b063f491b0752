-- SPDX-License-Identifier: MIT
-- B01: "bouncing" of SimBenchmark (J. Hwangbo and others, RaiSim's authors): 49 balls fall and bounce without loss. Answer:
-- energy stays. The best published relative error at a step of 1e-3 s is 5.7e-6 (root of the mean square).
local verify = require "rbsim.verify"
local g, radius, m, height, duration = 9.81, 0.1, 10, 5, 20

verify.case { title = "SimBenchmark: bouncing", duration = duration, gravity = {0, 0, -g}, time_step = {1e-3, 1e-4, 1e-2, 0.1},
	frame_rate = {10, 1, 7}, quick = "more", length = 8 }
local hard = material { name = "hard", friction = 0, restitution = 1 }
verify.plane { material = hard }
local balls = {}
for i = 0, 6 do
	for j = 0, 6 do
		balls[#balls + 1] = verify.sphere { radius = radius, mass = m, position = {2 * i - 6, 2 * j - 6, height}, material = hard }
	end
end

-- A contact that is rounded by d changes an energy by m g d.
expect_always("energy is kept, relative", function()
	local energy = 0
	for _, ball in ipairs(balls) do
		energy = energy + ball.kinetic_energy + m * g * verify.position(ball).z
	end
	return math.abs(energy / (#balls * m * g * height) - 1), 1e-12 + 4 * verify.rounding / height
end)
local fall = math.sqrt(2 * (height - radius) / g)
expect("every ball bounces as often", function()
	return math.abs(collisions() - #balls * math.floor((duration / fall + 1) / 2)), 0
end)
