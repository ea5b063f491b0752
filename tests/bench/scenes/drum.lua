-- A drum of infinite planes that turn about y, with spheres in it: what does it cost that a plane without end is near all?
local n = param("n", 500, "spheres", {min = 1, max = 2000})
local sides = param("sides", 24, "planes of the drum", {min = 3, max = 100})
local rate = param("rate", 1.5, "rad/s")

world { title = "A drum", duration = 1, gravity = {0, 0, -9.81}, method = "stepped", seed = 3 }
local stone = material { name = "stone", friction = 0.5, restitution = 0, density = 2000 }
local radius, r = 2, 0.08
for k = 0, sides - 1 do
	plane { material = stone, motion = function(t)
		local a = 2 * math.pi * k / sides + rate * t
		local half = math.atan(-math.cos(a), -math.sin(a)) / 2
		return {radius * math.cos(a), 0, radius * math.sin(a)}, {math.cos(half), 0, math.sin(half), 0}
	end }
end
for side = -1, 1, 2 do
	plane { normal = {0, -side, 0}, point = {0, side, 0}, material = stone }
end
local count = 0
for z = -8, 8 do
	for x = -8, 8 do
		for y = -5, 5 do
			if count < n and math.sqrt(x * x + z * z) * 0.18 < 1.7 then
				count = count + 1
				sphere { radius = r, material = stone, position = {0.18 * x + 0.01 * math.random(), 0.18 * y, 0.18 * z} }
			end
		end
	end
end
