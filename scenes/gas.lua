-- A gas of hard spheres in a box, without gravity and friction, nothing lost at impacts.
-- Watch: the speeds, all alike at the start, spread to Maxwell's distribution within a few collisions each.
-- Expected end: the same energy; <v^4>/<v^2>^2 near 5/3; a third of the energy along each axis.
-- An impact concerns two balls: each flies on its own clock, and nobody else is looked at (compare --rollback global).
-- Try: --param balls=1000
-- Takes: less than a second.
local count = param("balls", 343, "spheres", {min = 8, max = 100000})
local radius, spacing, speed = 0.05, 0.3, 1

local side = math.ceil(count ^ (1 / 3))
local edge = side * spacing
world { title = "A gas of " .. count, duration = 10, frame_rate = 60, seed = 3 }
local hard = material { name = "hard", friction = 0, restitution = 1 }
local balls = {}
for k = 0, count - 1 do
	local z, phi = 2 * math.random() - 1, 2 * math.pi * math.random()
	local s = math.sqrt(1 - z * z)
	balls[#balls + 1] = sphere { radius = radius, material = hard,
		position = {(k % side + 0.5) * spacing, (k // side % side + 0.5) * spacing, (k // (side * side) + 0.5) * spacing},
		velocity = {speed * s * math.cos(phi), speed * s * math.sin(phi), speed * z} }
end
for axis = 1, 3 do
	local low, high = {0, 0, 0}, {0, 0, 0}
	low[axis], high[axis] = 1, -1
	plane { point = {0, 0, 0}, normal = low, material = hard, visible = false }
	plane { point = {edge, edge, edge}, normal = high, material = hard, visible = false }
end
camera { name = "main", position = {2 * edge, -1.5 * edge, 1.5 * edge}, look_at = {edge / 2, edge / 2, edge / 2},
	size = {1280, 720} }

expect("energy is kept", function()
	return math.abs(energy() / (count * balls[1].mass * speed ^ 2 / 2) - 1), 1e-12
end)
-- The kurtosis of a sample of n from Maxwell's distribution scatters by about 3/sqrt(n); it starts at 1.
expect("speeds are Maxwell's", function()
	local two, four = 0, 0
	for _, ball in ipairs(balls) do
		local v2 = ball.velocity:dot(ball.velocity)
		two, four = two + v2 / count, four + v2 * v2 / count
	end
	return math.abs(four / two ^ 2 - 5 / 3), 4 * 3 / math.sqrt(count)
end)
expect("every axis has its share", function()
	local x, all = 0, 0
	for _, ball in ipairs(balls) do
		x, all = x + ball.velocity.x ^ 2, all + ball.velocity:dot(ball.velocity)
	end
	return math.abs(3 * x / all - 1), 4 * math.sqrt(2 / count) * 1.5
end)
expect("no overlap beyond the tolerance", function() return max_penetration(), penetration_tolerance() end)
