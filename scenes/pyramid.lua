-- A pyramid of ten rows of boxes stands; then a ball takes the top off.
-- Watch: for a second nothing moves that one could see; the ball then moves what it hits, and the rows below stay.
-- Expected end: the top box is off, the lowest rows are where they were built.
-- All 55 boxes rest on each other in one problem of some 200 contacts, solved once; standing costs nothing after that.
-- Try: --param rows=20, --param ball=false --duration 60, --param heavy=1000
-- Takes: 15 s of processor time, 2 s without its film.
local rows = param("rows", 10, "boxes in the lowest row", {min = 1, max = 100})
local ball = param("ball", true, "a ball is thrown at the top")
local heavy = param("heavy", 1.0, "mass of the top box over that of the others", {min = 1, max = 1e6})
local stack, palette = require "rbsim.stack", require "rbsim.palette"
local g, size, radius, hit = 9.81, {0.25, 0.25, 0.125}, 0.0625, 1

world { title = "A pyramid of " .. rows .. " rows", duration = 2, frame_rate = 60, gravity = {0, 0, -g} }
local wood = material { name = "wood", density = 700, friction = 0.5, restitution = 0 }
plane { name = "floor", material = wood, color = {0.62, 0.60, 0.55}, texture = "checker" }
local boxes = stack.bodies(stack.pyramid { rows = rows, size = size }, function(i, block)
	local mass = 700 * size[1] * size[2] * size[3]
	return { material = wood, color = palette.at(block.row), texture = "none", mass = block.row == rows and heavy * mass or mass }
end, "box")
local top, high = boxes[#boxes], rows * size[3]
if ball then
	-- aimed to be at the top box's middle height after `hit` seconds
	local far, v = 6, 6 / hit
	sphere { name = "ball", radius = radius, mass = 5, material = material { name = "rubber", friction = 0.4, restitution = 0.3, color = palette.red },
		position = {-far - radius - size[1] / 2, 0, high - size[3] / 2}, velocity = {v, 0, g * hit / 2} }
end
camera { name = "main", position = {0.25 * high, -1.0 - 2.6 * high, 0.3 + 0.75 * high}, look_at = {0, 0, 0.48 * high}, fov = deg(40),
	size = {1280, 720}, overlay = {"title", "time"}, video = "pyramid.mp4" }

local start, early = {}, 0
for i, one in ipairs(boxes) do start[i] = vec3(one.position) end
local function moved(first, last)
	local far = 0
	for i = first, last do far = math.max(far, (boxes[i].position - start[i]):length()) end
	return far
end
on_frame(function(t)
	if not ball or t < 0.95 * hit then early = math.max(early, moved(1, #boxes)) end
end)
expect("it stands until it is hit, over its height", function() return early / high, 1e-6 end)
if ball then
	expect("the top is off", function() return (top.position - start[#boxes]):length() > size[1] end)
	expect("the lowest row stays, m", function() return moved(1, rows), 1e-3 end)
end
expect("overlap stays within the tolerance", function() return max_penetration(), penetration_tolerance() end)
