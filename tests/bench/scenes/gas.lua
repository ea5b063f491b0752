-- Spheres in a box at a share `phi` of its volume, with speeds as Maxwell's from the start, so that collisions come at
-- one rate from beginning to end; frames at the start and the end only. The rest makes the method take its other ways.
local n = param("n", 4000, "spheres", {min = 2, max = 1000000})
local phi = param("phi", 0.25, "share of the volume", {min = 1e-6, max = 0.5})
local duration = param("T", 1.0, "s")
local g = param("g", 0.0, "m/s^2")
local mu = param("mu", 0.0, "friction")
local e = param("e", 1.0, "restitution")
local k = param("drag", 0.0, "N s/m")
local fields = param("fields", 0, "of a constant force that a function gives, 1e-9 N", {min = 0})
local octaves = param("octaves", 0, "between the radii of the largest and the smallest")

local radius, side = 0.5, math.ceil(n ^ (1 / 3))
local edge = (n * 4 / 3 * math.pi * radius ^ 3 / phi) ^ (1 / 3)
world { title = "Gas", duration = duration, frame_rate = 1 / duration, gravity = {0, 0, -g}, seed = 1 }
local hard = material { name = "hard", density = 1, friction = mu, restitution = e }
for axis = 1, 3 do
	local low, high, far = {0, 0, 0}, {0, 0, 0}, {0, 0, 0}
	low[axis], high[axis], far[axis] = 1, -1, edge
	plane { point = {0, 0, 0}, normal = low, material = hard }
	plane { point = far, normal = high, material = hard }
end
if k > 0 then drag { linear = k } end
local force = vec3(1e-9, 0, 0)
for _ = 1, fields do
	field(function() return force end)
end
local function normal()
	return math.sqrt(-2 * math.log(1 - math.random())) * math.cos(2 * math.pi * math.random())
end
for k = 0, n - 1 do
	sphere { radius = radius * 2 ^ -math.random(0, octaves), mass = 1, material = hard,
		position = {(k % side + 0.5) * edge / side, (k // side % side + 0.5) * edge / side,
			(k // (side * side) + 0.5) * edge / side},
		velocity = {normal(), normal(), normal()} }
end
