-- Seventeen wedges stand as an arch without mortar, and carry a stone that is dropped on their crown.
-- Watch: the blow runs through the wedges and is gone; the thinner the arch, the nearer it comes to opening like a hinge.
-- Expected end: the arch stands as it was built, the stone lies on it.
-- Half a circle of stones stands while thickness is more than about 0.107 of the mean radius (Heyman): 0.114 m here.
-- Try: --param thickness=0.09 (it falls by itself), --param drop=2
-- Takes: 20 s of processor time, less than a second without its film.
local thickness = param("thickness", 0.3, "of the arch, m", {min = 0.02, max = 1})
local drop = param("drop", 0.2, "how far the stone falls, m; 0: it lies there", {min = 0, max = 5})
local stones = param("stones", 17, "in the arch, an odd number", {min = 3, max = 101})
local stack = require "rbsim.stack"
local g, radius, width, s = 9.81, 1, 0.5, 0.12

world { title = "An arch", duration = 3, frame_rate = 60, gravity = {0, 0, -g} }
local sandstone = material { name = "sandstone", density = 2300, friction = 0.7, restitution = 0, color = {0.78, 0.68, 0.50} }
plane { name = "ground", material = sandstone, color = {0.45, 0.50, 0.36}, texture = "none" }
local blocks = stack.arch { stones = stones, radius = radius, thickness = thickness, width = width }
local arch = stack.bodies(blocks, function(i)
	local shade = 0.92 + 0.16 * (i % 2)
	return { material = sandstone, color = {0.78 * shade, 0.68 * shade, 0.50 * shade}, texture = "none" }
end, "wedge")
-- The keystone's upper side is a chord: level, below the outer circle.
local top = (radius + thickness) * math.cos(math.pi / 2 / stones)
local stone = box { name = "stone", size = {s, s, s}, position = {0, 0, top + s / 2 + drop}, material = sandstone, color = {0.55, 0.30, 0.24},
	texture = "none" }
camera { name = "main", position = {1.6, -4.2, 1.3}, look_at = {0, 0, 0.75}, fov = deg(36), size = {1280, 720}, overlay = {"title", "time"},
	video = "arch.mp4" }

local start = {}
for i, wedge in ipairs(arch) do start[i] = vec3(wedge.position) end
-- Every joint may close by the tolerance, 6e-6 m by steps (1e-4 of the least half width), eighteen of them in a row.
if thickness >= 0.2 then
	expect("the arch stands, m", function()
		local far = 0
		for i, wedge in ipairs(arch) do far = math.max(far, (wedge.position - start[i]):length()) end
		return far, 18 * penetration_tolerance()
	end)
	expect("the stone lies on it, m", function() return math.abs(stone.position.z - top - s / 2), 18 * penetration_tolerance() end)
end
expect("at rest", function()
	local most = stone.velocity:length()
	for _, wedge in ipairs(arch) do most = math.max(most, wedge.velocity:length()) end
	return most, thickness >= 0.2 and 1e-6 or math.huge
end)
expect("overlap stays within the tolerance", function() return max_penetration(), penetration_tolerance() end)
