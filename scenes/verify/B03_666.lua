-- SPDX-License-Identifier: MIT
-- B03: "666" of SimBenchmark: a cube of 216 balls falls into a heap without restitution. Answer: no overlap.
local verify = require "rbsim.verify"
local g, radius, m, duration = 9.81, 0.1, 10, 10

verify.case { title = "SimBenchmark: 666", duration = duration, gravity = {0, 0, -g}, seed = 42,
	time_step = {1e-3, 1e-2, 0.1}, frame_rate = {10, 1, 7}, quick = "none", wall_seconds = 300, length = 4, tolerance = 1e-7 }
local soft = material { name = "soft", friction = 0, restitution = 0 }
verify.plane { material = soft }
local balls = {}
for i = 0, 5 do
	for j = 0, 5 do
		for k = 0, 5 do
			local p = vec3(0.21 * i, 0.21 * j, 0.101 + 0.21 * k)
			p = p + 1e-3 * vec3(math.random(), math.random(), math.random())
			balls[#balls + 1] = verify.sphere { radius = radius, mass = m, position = p, material = soft }
		end
	end
end
expect_always("overlap, radii", function() return max_penetration() / radius, 1e-6 end)
expect("no ball is below the floor, radii", function()
	local deep = 0
	for _, ball in ipairs(balls) do deep = verify.larger(deep, radius - verify.position(ball).z) end
	return deep / radius, 1e-6
end)
