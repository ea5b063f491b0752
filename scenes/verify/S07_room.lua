-- SPDX-License-Identifier: MIT
-- S07: a sphere at 10 km/s in a room for a second. Answer: unfolded, each coordinate is a triangle wave.
local verify = require "rbsim.verify"
local radius, inner, speed = 0.0625, 0.4375, 1e4
local v = speed / math.sqrt(83) * vec3(5, 7, 3)
local start = vec3(0.1, -0.2, 0.05)

verify.case { title = "A room at 10 km/s", duration = 1, time_step = {0.01, 1e-4, 1}, frame_rate = {10, 1, 60},
	quick = "more" }
local hard = material { name = "hard", friction = 0, restitution = 1 }
for _, n in ipairs {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}} do
	verify.plane { normal = n, point = -(inner + radius) * vec3(n), material = hard }
end
local ball = verify.sphere { name = "ball", radius = radius, position = start, velocity = v, material = hard }

-- Coordinate, sign of the velocity and number of reflections after a time.
local function unfold(x, speed_x, t)
	local way = x + inner + speed_x * t
	local k = math.floor(way / (2 * inner))
	local rest = way - 2 * inner * k
	if k % 2 == 0 then return rest - inner, 1, k end
	return inner - rest, -1, k
end
-- A wall that is rounded by d moves the way by 2d at each of 1e4 impacts, with either sign.
local bar = 1e-7 + 2e4 * verify.rounding
expect_always("it is where the unfolded way leads, m", function()
	local t = time()
	local x, y, z = unfold(start.x, v.x, t), unfold(start.y, v.y, t), unfold(start.z, v.z, t)
	return (verify.position(ball) - vec3(x, y, z)):length(), bar
end)
expect_always("its speed is kept, relative", function() return math.abs(ball.velocity:length() / speed - 1), 1e-12 end)
expect("the impacts are as many", function()
	local count = 0
	for _, axis in ipairs {"x", "y", "z"} do
		local _, _, k = unfold(start[axis], v[axis], 1)
		count = count + math.abs(k)
	end
	return math.abs(collisions() - count), 0
end)
