-- SPDX-License-Identifier: MIT
-- What slides or rolls without loss over flush boxes goes on as on one: boxes of several widths, whichever way they run.
-- `step`: every second box stands higher by that much, and stops what slides.
local turn = param("turn", 0.0, "rad: of all, about an oblique axis")
local way = param("way", 0.3, "rad: of the paths, from across the seams")
local size = param("size", 1.0, "m: all lengths are multiples of it")
local step = param("step", 0.0, "of the size, by which every second box stands higher")
local gap = param("gap", 0.0, "of the size, between boxes")
local floor = param("floor", "boxes", "what they go on", {choices = {"boxes", "union", "rectangles", "driven"}})
local bound = param("bound", 1e-3, "of the size: how far off they may be")
local handed = param("handed", 1, "-1: all mirrored")
local second = math.sqrt(size)
local g, v = 9.81, 3

local axis = vec3(1, 2, -2) / 3
local function turned(p)
	return p * math.cos(turn) + axis:cross(p) * math.sin(turn) + axis * (axis:dot(p) * (1 - math.cos(turn)))
end
local function at(x, y, z) return turned(vec3(x, handed * y, z)) * size end
local function product(p, q)
	return {p[1] * q[1] - p[2] * q[2] - p[3] * q[3] - p[4] * q[4], p[1] * q[2] + p[2] * q[1] + p[3] * q[4] - p[4] * q[3],
		p[1] * q[3] - p[2] * q[4] + p[3] * q[1] + p[4] * q[2], p[1] * q[4] + p[2] * q[3] - p[3] * q[2] + p[4] * q[1]}
end
local c, s = math.cos(turn / 2), math.sin(turn / 2)
local frame = {c, s * axis.x, s * axis.y, s * axis.z}
-- about the vertical by `angle`, after `first`
local function upright(angle, first)
	return product(frame, product({math.cos(angle / 2), 0, 0, handed * math.sin(angle / 2)}, first or {1, 0, 0, 0}))
end

world { title = "Seams", duration = second, frame_rate = 20 / second, time_step = second / 60, method = "stepped",
	gravity = turned(vec3(0, 0, -g)) }
local smooth = material { name = "smooth", friction = 0, restitution = 0, density = 1000 }
local rough = material { name = "rough", friction = 0.5, restitution = 0, density = 1000 }

local widths, x, parts = {0.31, 1.7, 0.05, 0.9, 1, 0.11}, -1.5, {}
for i = 1, 12 do
	local w = widths[i % 6 + 1]
	local length, middle = w - gap, x + w / 2
	local keys = {size = {length * size, 16 * size, size}, position = at(middle, 0, (1 - i % 2) * step - 0.5), orientation = frame, material = rough}
	if floor == "union" then
		parts[i] = {shape = "box", size = keys.size, position = vec3(middle, 0, -0.5) * size}
	elseif floor == "rectangles" then
		plane { size = {16 * size, 16 * size}, position = at(16 * i - 23.5, 0, 0), normal = turned(vec3(0, 0, 1)), material = rough }
	else
		local start = keys.position
		keys.static = floor == "boxes"
		keys.motion = floor == "driven" and function() return start, frame, vec3(0, 0, 0), vec3(0, 0, 0) end or nil
		box(keys)
	end
	x = x + w
end
if floor == "union" then body { shapes = parts, static = true, orientation = frame, material = rough } end

local ahead = at(math.cos(way), math.sin(way), 0) / size
local speed = v * size / second
local up = turned(vec3(0, 0, 1))
local across = {math.sqrt(0.5), -handed * math.sqrt(0.5), 0, 0}
local points = {}
for i = 0, 6 do
	for side = -1, 1, 2 do
		points[#points + 1] = {0.3 * size * math.cos(2 * math.pi * i / 7), 0.3 * size * math.sin(2 * math.pi * i / 7), 0.1 * side * size}
	end
end
local bodies = {}
local function go(make, y, height, keys)
	keys.name = "body " .. #bodies
	keys.position = at(-0.7, y, height)
	keys.velocity = ahead * speed
	keys.material = keys.material or smooth
	bodies[#bodies + 1] = {make(keys), keys.position}
end
go(box, -5, 0.1, {size = {0.5 * size, 0.4 * size, 0.2 * size}, orientation = upright(0)})
go(box, -4, 0.1, {size = {0.5 * size, 0.4 * size, 0.2 * size}, orientation = upright(way)})
go(box, -3, 0.01, {size = {0.7 * size, 0.6 * size, 0.02 * size}, orientation = upright(0.4)})
go(cylinder, -2, 0.1, {radius = 0.3 * size, length = 0.2 * size, orientation = upright(0)})
go(hull, -1, 0.1, {points = points, orientation = upright(0.2)})
local flush = step < 1e-6 -- within the tolerance
if flush then
	local roll = up:cross(ahead) * (speed / (0.1 * size))
	go(sphere, 0, 0.1, {radius = 0.1 * size, angular_velocity = roll, material = rough})
	go(cylinder, 1, 0.1, {radius = 0.1 * size, length = 0.3 * size, angular_velocity = roll, material = rough, orientation = upright(way, across)})
	go(capsule, 2, 0.1, {radius = 0.1 * size, length = 0.3 * size, angular_velocity = roll, material = rough, orientation = upright(way, across)})
end

local function off(of)
	return (of[1].position - of[2] - ahead * (speed * time())):length() / size
end
if flush then
	expect_always("place, of the size", function()
		local worst = 0
		for _, of in ipairs(bodies) do worst = math.max(worst, off(of)) end
		return worst, bound
	end)
else
	-- the first that is higher is less than a third of the way ahead
	expect("all are stopped", function()
		local least = math.huge
		for _, of in ipairs(bodies) do least = math.min(least, off(of)) end
		return -least, -0.9
	end)
end
