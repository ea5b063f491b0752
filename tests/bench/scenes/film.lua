-- N textured spheres fly over a checkered plane in the sight of a camera: what a picture costs.
-- bare = 1: nothing to see, so that a picture is a clear, a read-back and its encoding.
local n = param("n", 1000, "spheres", {min = 1})
local bare = param("bare", 0, "1: nothing is visible", {min = 0, max = 1}) == 1
local pictures = param("pictures", 120, "pictures", {min = 1})
world { duration = (pictures - 1) / 30, frame_rate = 30, gravity = {0, 0, 0}, seed = 1 }
local m = material { density = 1000, friction = 0, restitution = 1 }
local side = math.ceil(n ^ (1 / 3))
local cell = 10 / side
for i = 0, n - 1 do
	local x, y, z = i % side, i // side % side, i // (side * side)
	sphere { radius = 0.3 * cell, material = m, visible = not bare, group = "ghost", collides_with = {},
		position = {(x + 0.5) * cell - 5, (y + 0.5) * cell - 5, (z + 0.5) * cell + 0.2},
		velocity = {math.random() - 0.5, math.random() - 0.5, math.random() - 0.5},
		angular_velocity = {math.random() - 0.5, math.random() - 0.5, math.random() - 0.5} }
end
plane { material = m, texture = "checker", visible = not bare, group = "ghost", collides_with = {} }
for k = 1, 4 do
	camera { name = "camera" .. k, position = {14, -16 + 4 * k, 10}, look_at = {0, 0, 4}, size = {1280, 720}, fps = 30,
		background = bare and {0.5, 0.6, 0.7} or nil, shadows = not bare, samples = bare and 1 or nil }
end
