-- A lattice with a jitter falls into an open box and piles up: spheres of r = 0.5 m or boxes of 1 m, spacing 1.1 m.
local side = param("side", 10, "bodies along x and y", {min = 1, max = 200})
local layers = param("layers", 10, "bodies along z", {min = 1, max = 200})
local shape = param("shape", "sphere", "of the bodies", {choices = {"sphere", "box"}})
local mu = param("mu", 0.5, "friction", {min = 0, max = 2})
local steps = param("steps", 600, "of 1/240 s", {min = 1})

world { title = "A pile", duration = steps / 240, frame_rate = 4, time_step = 1 / 240, gravity = {0, 0, -9.81}, seed = 3 }
record { fields = {"contacts"} } -- of which the mean overlap
local stone = material { name = "stone", friction = mu, restitution = 0 }
local wall = 0.55 * side + 0.1
plane { normal = {0, 0, 1}, material = stone }
for _, way in ipairs { {1, 0}, {-1, 0}, {0, 1}, {0, -1} } do
	plane { normal = {way[1], way[2], 0}, point = {-wall * way[1], -wall * way[2], 0}, material = stone }
end
local function jitter() return 0.09 * (math.random() - 0.5) end
for z = 0, layers - 1 do
	for y = 0, side - 1 do
		for x = 0, side - 1 do
			local at = { 1.1 * x - 0.55 * (side - 1) + jitter(), 1.1 * y - 0.55 * (side - 1) + jitter(),
				0.55 + 1.1 * z + jitter() }
			if shape == "sphere" then
				sphere { radius = 0.5, material = stone, position = at }
			else
				box { size = {1, 1, 1}, material = stone, position = at }
			end
		end
	end
end
