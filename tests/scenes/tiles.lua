-- SPDX-License-Identifier: MIT
-- What lands on flush tiles goes on as on one slab, wherever the borders are: pairs of equal bodies, thrown at random, each over a
-- floor of its own.
local shape = param("shape", "box", "what is thrown", {choices = {"sphere", "box", "hull", "capsule"}})
local floor = param("floor", "boxes", "what tiles are", {choices = {"boxes", "union", "rectangles", "driven"}})
local friction = param("mu", 0.5, "coefficient", {min = 0})
local restitution = param("e", 0.5, "coefficient", {min = 0, max = 1})
local step = param("step", 1e-3, "s")
local size = param("size", 1.0, "m: all lengths are multiples of it")
local bound = param("bound", 1e-6, "m/s, of bodies of 1 m: how far off velocities may be")
local tile, half, pairs = 0.09, 9, 24
local second = math.sqrt(size)
world { title = "Tiles", duration = 0.12 * second, frame_rate = 1 / (0.12 * second), time_step = step * second, method = "stepped",
	gravity = vec3(0, 0, -9.81) }
local stuff = material { name = "stuff", friction = friction, restitution = restitution, density = 1000 }
local function drawn(most) return most * (2 * math.random() - 1) end
local function at(x, y, z) return vec3(x, y, z) * size end
local wide = 2 * half * tile

local function lay(x, y)
	local parts = {}
	for i = -half, half - 1 do
		for j = -half, half - 1 do
			local p = at(x + (i + 0.5) * tile, y + (j + 0.5) * tile, -0.5)
			local keys = {size = at(tile, tile, 1), position = p, material = stuff}
			if floor == "union" then
				parts[#parts + 1] = {shape = "box", size = keys.size, position = p}
			elseif floor == "rectangles" then
				plane { size = {tile * size, tile * size}, point = p + at(0, 0, 0.5), material = stuff }
			elseif floor == "driven" then
				keys.motion = function() return p, {1, 0, 0, 0}, vec3(0, 0, 0), vec3(0, 0, 0) end
				box(keys)
			else
				keys.static = true
				box(keys)
			end
		end
	end
	if floor == "union" then body { shapes = parts, static = true, material = stuff } end
end

local function throw(x, y, q)
	local keys = {position = at(x, y, 0) + q.position * size, velocity = q.velocity * (size / second),
		angular_velocity = q.spin / second, material = stuff}
	if shape ~= "sphere" then keys.orientation = {axis = q.axis, angle = q.angle} end
	if shape == "sphere" then
		keys.radius = 0.1 * size
		return sphere(keys)
	elseif shape == "box" then
		keys.size = at(0.3, 0.2, 0.1)
		return box(keys)
	elseif shape == "capsule" then
		keys.radius, keys.length = 0.1 * size, 0.3 * size
		return capsule(keys)
	end
	keys.points = {at(0.2, 0, 0), at(-0.2, 0, 0), at(0, 0.15, 0), at(0, -0.15, 0), at(0, 0, 0.1), at(0, 0, -0.1)}
	return hull(keys)
end

local made = {}
for k = 1, pairs do
	math.randomseed(k)
	local q = {velocity = vec3(drawn(3), drawn(3), -2 - math.random()), spin = vec3(drawn(5), drawn(5), drawn(5)),
		axis = vec3(drawn(1), drawn(1), drawn(1)), angle = drawn(3), position = vec3(drawn(0.2), drawn(0.2), 0.25)}
	for side = 0, 1 do
		local x, y = 4 * side, 4 * k
		if side == 0 then
			box { size = at(wide, wide, 1), position = at(x, y, -0.5), static = true, material = stuff }
		else
			lay(x, y)
		end
		made[2 * k + side] = throw(x, y, q)
	end
end

expect("velocities, of those on one slab", function()
	local worst = 0
	for k = 1, pairs do
		local a, b = made[2 * k], made[2 * k + 1]
		worst = math.max(worst, (a.velocity - b.velocity):length() * second / size,
			(a.angular_velocity - b.angular_velocity):length() * 0.1 * second)
	end
	return worst, bound
end)
expect("most have landed", function()
	local landed = 0
	for k = 1, pairs do
		if made[2 * k].velocity.z > -2 * size / second then landed = landed + 1 end
	end
	return -landed, -pairs / 2
end)
