-- SPDX-License-Identifier: MIT
-- C09: one solid said in several ways: as a box, as the hull of its corners (and of more points), as the union of two
-- halves. Answer: they fall, hit and come to rest alike.
local verify = require "rbsim.verify"
local part = param("part", "corner", "how it lands", {choices = {"corner", "edge", "flat"}})
local g, half = 9.81, vec3(0.2, 0.15, 0.1)

verify.case { title = "The same solid", duration = part == "flat" and 5 or 0.6, gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {60, 10, 100}, quick = "base" }
local stuff = material { name = "stuff", density = 1000, friction = 0.4, restitution = part == "flat" and 0 or 0.5 }
local corners, more = {}, {}
for k = 0, 7 do
	corners[k + 1] = vec3(k % 2 == 0 and -half.x or half.x, k // 2 % 2 == 0 and -half.y or half.y, k // 4 == 0 and -half.z or half.z)
	more[k + 1], more[k + 9] = corners[k + 1], corners[k + 1] / 2
end
more[17] = vec3(half.x, 0, half.z) -- on an edge
local left = {shape = "box", size = {half.x, 2 * half.y, 2 * half.z}, position = {-half.x / 2, 0, 0}}
local right = {shape = "box", size = left.size, position = {half.x / 2, 0, 0}}

local lands = {corner = {axis = {1, 2, 3}, angle = 0.7}, edge = {axis = {0, 1, 0}, angle = 0.5}}
local names, bodies = {"box", "hull", "more points", "halves"}, {}
for k, name in ipairs(names) do
	local place = vec3(0, 2 * (k - 1), 0)
	verify.plane { point = place, group = "floor " .. name, collides_with = name, material = stuff }
	local keys = {name = name, group = name, collides_with = "floor " .. name, material = stuff, position = place + vec3(0, 0, 0.6),
		orientation = lands[part], velocity = {0.3, 0, 0}, angular_velocity = part == "corner" and {0.5, -1, 0.25} or nil}
	if k == 1 then keys.size = 2 * half else keys.points = k == 2 and corners or k == 3 and more or nil end
	if k == 4 then keys.shapes = {left, right} end
	bodies[k] = (k == 1 and verify.box or k < 4 and verify.hull or verify.body)(keys)
end

expect("they have the same mass and inertia", function()
	local worst, box = 0, bodies[1]
	for k = 2, #bodies do
		worst = verify.larger(worst, math.abs(bodies[k].mass / box.mass - 1))
		for i = 1, 3 do worst = verify.larger(worst, math.abs(bodies[k].inertia[i][i] / box.inertia[i][i] - 1)) end
	end
	return worst, 1e-13
end)
-- A tumbling box magnifies what rounding makes, some hundred times with each impact.
local function apart(k)
	local between = verify.position(bodies[k]) - verify.position(bodies[1]) - vec3(0, 2 * (k - 1), 0)
	local x1, y1 = verify.axes(bodies[1])
	local x, y = verify.axes(bodies[k])
	return verify.larger(between:length(), half.x * verify.larger((x - x1):length(), (y - y1):length()))
end
local bar = part == "flat" and 1e-10 or 1e-7
expect_always("the hull is where the box is, m", function() return apart(2), bar + 1e5 * verify.rounding end)
expect_always("inner points change nothing, m", function() return apart(3), bar + 1e5 * verify.rounding end)
expect_always("the halves are where the box is, m", function() return apart(4), bar + 1e5 * verify.rounding end)
expect("they do hit", function() return collisions() >= 4 end)
