-- SPDX-License-Identifier: MIT
-- S17: "666" of SimBenchmark: a cube of 216 balls falls, nothing bounces, nothing rubs, all run apart. Answer: no overlap.
-- The best published sum of squares at a step of 1e-3 s is 1.35e-4 m^2; ours stands beside it.
local verify = require "rbsim.verify"
local g, radius, duration = 9.81, 0.1, 10

verify.case { title = "SimBenchmark: 666, inelastic", duration = duration, gravity = {0, 0, -g}, seed = 42,
	time_step = {1e-3, 4e-3, 1e-2}, frame_rate = {10, 1, 7}, quick = "none", length = 4, processor_seconds = 600,
	tolerance = 1e-6 * radius }
local dough = material { name = "dough", friction = 0, restitution = 0 }
verify.plane { material = dough }
local balls = {}
for i = 0, 5 do
	for j = 0, 5 do
		for k = 0, 5 do
			local p = vec3(0.21 * i, 0.21 * j, 0.101 + 0.21 * k)
			p = p + 1e-3 * vec3(math.random(), math.random(), math.random())
			balls[#balls + 1] = verify.sphere { radius = radius, mass = 10, position = p, material = dough }
		end
	end
end

-- Squares of overlaps with the floor and between pairs, and how many touch: those nearer than the tolerance.
local sums, frames, contacts = 0, 0, 0
local function look(overlap)
	if overlap <= -1e-6 * radius then return end
	contacts = contacts + 1
	if overlap > 0 then sums = sums + overlap * overlap end
end
on_frame(function()
	local p = {}
	for i, ball in ipairs(balls) do
		p[i] = verify.position(ball)
		look(radius - p[i].z)
	end
	for i = 1, #p do
		local a = p[i]
		for k = i + 1, #p do
			local b = p[k]
			local x, y, z = a.x - b.x, a.y - b.y, a.z - b.z
			local square = x * x + y * y + z * z
			if square < 4.0001 * radius * radius then look(2 * radius - math.sqrt(square)) end
		end
	end
	frames = frames + 1
end)
expect("overlap of a contact, RMS, radii", function() return math.sqrt(sums / math.max(1, contacts)) / radius, 1e-6 end)
expect("overlap, mean sum of squares, m^2", function() return sums / frames, 1.35e-4 end)
expect("largest overlap, radii", function() return max_penetration() / radius, 1e-6 end)
expect("they do run apart", function()
	local high = 0
	for _, ball in ipairs(balls) do high = verify.larger(high, verify.position(ball).z) end
	return high, 0.5
end)
