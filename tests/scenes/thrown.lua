-- SPDX-License-Identifier: MIT
-- One body, thrown with a random spin onto a floor, located: whatever its friction, it comes to an end, and the ledger explains
-- where its energy went. `turn` and `handed` turn and mirror all.
local shape = param("shape", "box", "what is thrown", {choices = {"box", "capsule", "cylinder", "hull", "cone", "union", "sphere"}})
local floor = param("floor", "plane", "onto what", {choices = {"plane", "box", "terrain"}})
local friction = param("mu", 0.5, "coefficient", {min = 0})
local restitution = param("e", 0.0, "coefficient", {min = 0, max = 1})
local turn = param("turn", 0.0, "rad: of all, about an oblique axis")
local handed = param("handed", 1, "-1: all mirrored")
local size = param("size", 1.0, "m: all lengths are multiples of it")
local k = param("k", 1, "draws how it is thrown", {min = 0})
local second = math.sqrt(size)
math.randomseed(k)
local function drawn(most) return most * (2 * math.random() - 1) end

local axis = vec3(1, 2, -2) / 3
local function turned(p)
	return p * math.cos(turn) + axis:cross(p) * math.sin(turn) + axis * (axis:dot(p) * (1 - math.cos(turn)))
end
local function product(p, q)
	return {p[1] * q[1] - p[2] * q[2] - p[3] * q[3] - p[4] * q[4], p[1] * q[2] + p[2] * q[1] + p[3] * q[4] - p[4] * q[3],
		p[1] * q[3] - p[2] * q[4] + p[3] * q[1] + p[4] * q[2], p[1] * q[4] + p[2] * q[3] - p[3] * q[2] + p[4] * q[1]}
end
local function about(angle, x, y, z)
	local s = math.sin(angle / 2)
	return {math.cos(angle / 2), s * x, s * y, s * z}
end
local frame = about(turn, axis.x, axis.y, axis.z)

world { title = "Thrown", duration = second, frame_rate = 20 / second, method = "located", gravity = turned(vec3(0, 0, -9.81)) }
local stuff = material { name = "stuff", friction = friction, restitution = restitution, density = 1000 }
if floor == "plane" then
	plane { normal = turned(vec3(0, 0, 1)), material = stuff }
elseif floor == "box" then
	box { size = {8 * size, 8 * size, size}, position = turned(vec3(0, 0, -0.5)) * size, orientation = frame, static = true, material = stuff }
else
	local function height(x, y) return 0.15 * size * math.sin(1.9 * x / size) * math.cos(1.6 * handed * y / size) end
	terrain { height = height, size = {8 * size, 8 * size}, cells = {12, 12}, orientation = frame, material = stuff }
end

local a, b, c = math.pi * (1 + drawn(1)), drawn(1), math.pi * (1 + drawn(1))
local q = product(product(about(a, 1, 0, 0), about(math.acos(b), 0, 1, 0)), about(c, 0, 0, 1))
if handed < 0 then q = {q[1], -q[2], q[3], -q[4]} end
local u, v, w = drawn(2), drawn(2), -math.random()
local p, r, s = drawn(8), drawn(8), drawn(8)
local keys = {position = turned(vec3(0, 0, 0.8)) * size, velocity = turned(vec3(u, handed * v, w)) * (size / second),
	orientation = product(frame, q), angular_velocity = turned(vec3(handed * p, r, handed * s)) / second, material = stuff}
local function point(x, y, z) return {size * x, handed * size * y, size * z} end
local made = {}
if shape == "box" then
	keys.size, made = {0.5 * size, 0.3 * size, 0.2 * size}, box
elseif shape == "sphere" then
	keys.radius, made = 0.2 * size, sphere
elseif shape == "capsule" or shape == "cylinder" then
	keys.radius, keys.length, made = (shape == "capsule" and 0.15 or 0.2) * size, 0.4 * size, shape == "capsule" and capsule or cylinder
elseif shape == "union" then
	keys.shapes = {{shape = "box", size = {0.5 * size, 0.2 * size, 0.2 * size}},
		{shape = "box", size = {0.2 * size, 0.2 * size, 0.4 * size}, position = {0.25 * size, 0, 0.2 * size}}}
	made = body
else
	keys.points, made = {}, hull
	for i = 1, shape == "cone" and 16 or 10 do
		local angle = math.pi * i / 8
		keys.points[i] = shape == "cone" and point(0.25 * math.cos(angle), 0.25 * math.sin(angle), -0.1) or point(drawn(0.3), drawn(0.3), drawn(0.3))
	end
	if shape == "cone" then keys.points[17] = point(0, 0, 0.4) end
end
local thrown = made(keys)
expect("it stays", function() return thrown.position:length() < 10 * size end)
