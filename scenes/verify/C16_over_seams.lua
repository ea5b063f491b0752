-- SPDX-License-Identifier: MIT
-- C16: what rolls over a floor of several bodies, or of one body of several parts, all flush: sphere, cylinder, capsule.
-- Answer: it rolls on; seams are nothing, whichever way they run.
local verify = require "rbsim.verify"
local shape = param("shape", "sphere", "what rolls", {choices = {"sphere", "cylinder", "capsule"}})
local floor = param("floor", "boxes", "what it rolls on", {choices = {"boxes", "union", "plane"}})
local way = param("way", 0.0, "rad: of its path, from across the seams", {choices = {0.0, 0.3}})
local g, r, v, duration = 9.81, 1, 2, 2

verify.case { title = "Over seams", duration = duration, length = r, gravity = {0, 0, -g}, time_step = {0.01, 0.1},
	frame_rate = {20, 7}, quick = "base", processor_seconds = 120 }
local stuff = material { name = "stuff", friction = 0.5, restitution = 0 }
local parts = {}
for i = -3, 3 do
	local at, size = {i * r, 0, -r / 2}, {r, 6 * r, r}
	-- a plane that boxes lie in, with gaps between them
	if floor == "plane" then at[1] = 1.5 * i * r end
	parts[#parts + 1] = {shape = "box", size = size, position = at}
	if floor ~= "union" then
		verify.box { name = "part" .. i, size = size, position = at, material = stuff, static = true }
	end
end
if floor == "union" then verify.body { name = "floor", shapes = parts, material = stuff, static = true } end
if floor == "plane" then verify.plane { material = stuff } end

local ahead = vec3(math.cos(way), math.sin(way), 0)
local start = ahead * (-v * duration / 2) + vec3(0, 0, r)
local turns = vec3(-ahead.y, ahead.x, 0) * (v / r)
local keys = {name = "body", radius = r, position = start, velocity = ahead * v, angular_velocity = turns, mass = 1, material = stuff}
if shape ~= "sphere" then
	-- along y, then turned about z
	local c, s, h = math.cos(way / 2), math.sin(way / 2), math.sqrt(0.5)
	keys.length, keys.orientation = 1.5 * r, {c * h, c * h, s * h, s * h}
end
local body = verify[shape](keys)

expect_always("place, of the radius", function()
	return (verify.position(body) - start - ahead * (v * time())):length() / r, 1e-12 + 64 * verify.rounding / r
end)
expect("velocity, relative", function()
	return (verify.velocity(body) - ahead * v):length() / v, 1e-12 + 64 * verify.rounding / r
end)
expect("spin, relative", function()
	return (verify.spin(body) - turns):length() * r / v, 1e-12 + 64 * verify.rounding / r
end)
