-- A lattice with a jitter falls into an open box and piles up: spheres of r = 0.5 m or boxes of 1 m, spacing 1.1 m;
-- or boxes turned at random, spacing 1.85 m, which keeps their corners apart.
local side = param("side", 10, "bodies along x and y", {min = 1, max = 1000})
local layers = param("layers", 10, "bodies along z", {min = 1, max = 200})
local shape = param("shape", "sphere", "of the bodies", {choices = {"sphere", "box", "turned"}})
local mu = param("mu", 0.5, "friction", {min = 0, max = 2})
local steps = param("steps", 600, "of 1/240 s", {min = 1})

world { title = "A pile", duration = steps / 240, frame_rate = 4, time_step = 1 / 240, gravity = {0, 0, -9.81}, seed = 3 }
record { fields = {"contacts"} } -- of which the mean overlap
local stone = material { name = "stone", friction = mu, restitution = 0 }
local spacing = shape == "turned" and 1.85 or 1.1
local wall = 0.5 * spacing * side + 0.1
plane { normal = {0, 0, 1}, material = stone }
for _, way in ipairs { {1, 0}, {-1, 0}, {0, 1}, {0, -1} } do
	plane { normal = {way[1], way[2], 0}, point = {-wall * way[1], -wall * way[2], 0}, material = stone }
end
-- uniform over all turns: Shoemake, Graphics Gems III (1992) 124
local function turn()
	local u, v, w = math.random(), 2 * math.pi * math.random(), 2 * math.pi * math.random()
	local p, q = math.sqrt(1 - u), math.sqrt(u)
	return {p * math.sin(v), p * math.cos(v), q * math.sin(w), q * math.cos(w)}
end
local function jitter() return 0.09 * (math.random() - 0.5) end
for z = 0, layers - 1 do
	for y = 0, side - 1 do
		for x = 0, side - 1 do
			local at = { spacing * x - 0.5 * spacing * (side - 1) + jitter(), spacing * y - 0.5 * spacing * (side - 1) + jitter(),
				0.5 * spacing + spacing * z + jitter() }
			if shape == "sphere" then
				sphere { radius = 0.5, material = stone, position = at }
			else
				box { size = {1, 1, 1}, material = stone, position = at, orientation = shape == "turned" and turn() or nil }
			end
		end
	end
end
