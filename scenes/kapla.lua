-- A tower of 102 wooden blocks, six floors of 17, stands; then a ball flies through its third floor.
-- Watch: nothing moves until the ball comes; the floors above then sink into the gap, and some of them stay up.
-- Expected end: without the ball the tower stands as it was built, for as long as one likes.
-- After SimBenchmark's Kapla, where engines lose their tower after 25 to 60,000 steps, by the number of iterations.
-- Try: --param ball=true, --param floors=20, --duration 600
-- Takes: 15 s of processor time, 2 s without its film.
local floors = param("floors", 6, "of 17 blocks", {min = 1, max = 100})
local ball = param("ball", false, "a ball is thrown at the tower")
local stack, palette = require "rbsim.stack", require "rbsim.palette"
local g, hit, radius = 9.81, 1, 0.06

world { title = "Kapla: " .. 17 * floors .. " blocks", duration = 3, frame_rate = 60, gravity = {0, 0, -g} }
local wood = material { name = "pine", density = 550, friction = 0.5, restitution = 0, color = {0.86, 0.69, 0.44} }
plane { name = "floor", material = wood, color = {0.48, 0.45, 0.42}, texture = "none" }
local blocks = stack.kapla { floors = floors }
local bodies = stack.bodies(blocks, function(i)
	local shade = 0.84 + 0.32 * (7 * i % 11) / 11
	return { material = wood, color = {0.86 * shade, 0.69 * shade, 0.44 * shade}, texture = "none" }
end, "block")
local high = 0.25 * floors
if ball then
	sphere { name = "ball", radius = radius, mass = 4, material = material { name = "lead", friction = 0.4, restitution = 0, color = palette.red },
		position = {-0.3 - 8 * hit, 0.075, 0.4 * high}, velocity = {8, 0, g * hit / 2} }
end
camera { name = "main", position = {1.2 + 0.2 * high, -1.6 - 1.2 * high, 0.4 + 0.6 * high}, look_at = {0, 0, 0.48 * high}, fov = deg(38),
	size = {720, 960}, overlay = {"title", "time"}, video = "kapla.mp4" }

local start, early = {}, 0
for i, one in ipairs(bodies) do start[i] = vec3(one.position) end
on_frame(function(t)
	if ball and t > 0.9 * hit then return end
	for i, one in ipairs(bodies) do early = math.max(early, (one.position - start[i]):length()) end
end)
expect("it stands, over its height", function() return early / high, 1e-9 end)
expect("overlap stays within the tolerance", function() return max_penetration(), penetration_tolerance() end)
