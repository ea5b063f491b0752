-- Thirty balls of three materials rain on a checkered floor, filmed by three cameras at once.
-- Watch: a camera that circles, one that rides on a ball, and slow motion with the arrows of velocities.
-- Expected end: every ball lies or rolls on the floor; impacts have only taken energy.
-- Cameras are functions of time, bodies or vectors; each has its own size, speed and output, and none slows the steps.
-- Try: rbsim scenes/film.lua, then rbsim render film.h5 --camera slow -o slow.gif --size 320x180 --to 1
-- Takes: 40 s of processor time, less than a second without its film.
local palette, path = require "rbsim.palette", require "rbsim.path"

world { title = "Rain of balls", duration = 8, frame_rate = 60, gravity = {0, 0, -9.81}, seed = 3 }
local kinds = {}
for k, e in ipairs {0.85, 0.6, 0.3} do
	kinds[k] = material { name = ("e = %.2f"):format(e), density = 900, friction = 0.4, restitution = e,
		color = palette.at(k) }
end
local floor = material { name = "floor", friction = 0.4, restitution = 0 }
plane { name = "floor", material = floor, texture = "checker" }

local textures = {"beachball", "stripes", "checker"}
local balls = {}
for k = 0, 29 do
	local kind = k % 3 + 1
	balls[k + 1] = sphere { name = "ball " .. k + 1, radius = 0.12 + 0.1 * math.random(), material = kinds[kind],
		texture = textures[math.random(3)],
		position = {0.7 * (k % 6 - 2.5), 0.7 * (k // 6 - 2), 1.2 + 2.5 * math.random()},
		velocity = {math.random() - 0.5, math.random() - 0.5, 0},
		angular_velocity = {4 * math.random() - 2, 4 * math.random() - 2, 4 * math.random() - 2} }
end

camera { name = "circle", position = path.orbit { center = {0, 0, 2.4}, radius = 5.5, period = 24, start = deg(-100) },
	look_at = {0, 0, 0.6}, size = {1280, 720}, overlay = {"title", "time", "energy"}, video = "film.mp4" }
camera { name = "ride", mount = balls[16], level = true, offset = {-0.9, -0.9, 0.5}, look_at = balls[16],
	size = {640, 360}, fps = 30, video = "ride.mp4" }
camera { name = "slow", position = {0, -4.5, 1.2}, look_at = {0, 0, 0.8}, size = {640, 360}, fps = 30, speed = 0.25,
	to = 2, vectors = "velocity", trails = {balls[15], balls[16]}, overlay = "time", video = "slow.mp4" }

local first
on_frame(function() first = first or energy() end)
expect("energy has only gone down", function() return energy() - first, 1e-9 * first end)
expect("all balls are on the floor", function()
	local highest = 0
	for _, ball in ipairs(balls) do
		highest = math.max(highest, ball.position.z)
	end
	return highest, 0.5
end)
