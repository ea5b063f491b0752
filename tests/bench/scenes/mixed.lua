-- A gas of spheres of two sizes, radii 1e-3 and 1, in a box; one in `each` is large.
-- Watch: the small ones come as clusters that burst, and the large ones run into what flies about.
-- What it is for: a grid with cells of one size has most of the small ones in one cell; pair tests per body show it.
local count = param("balls", 1000, "spheres", {min = 125, max = 1000000})
local each = param("each", 8, "spheres to one large one", {min = 2, max = 125})
local small, large, spacing, speed = 1e-3, 1, 2.04, 0.1

world { title = "A gas of two sizes, " .. count, duration = 1, frame_rate = 60, seed = 4 }
local hard = material { name = "hard", friction = 0, restitution = 1 }

-- a box of cells as near to a cube as their number allows
local cells = count // each
local nx = math.floor(cells ^ (1 / 3) + 0.5)
local ny = math.floor((cells / nx) ^ (1 / 2) + 0.5)
local nz = math.ceil(cells / (nx * ny))

local function anywhere()
	local z, phi = 2 * math.random() - 1, 2 * math.pi * math.random()
	local s = math.sqrt(1 - z * z)
	return speed * vec3(s * math.cos(phi), s * math.sin(phi), z)
end
local corner = 1.04 * large / math.sqrt(3)
for cell = 0, cells - 1 do
	local middle = spacing * vec3(cell % nx + 0.5, cell // nx % ny + 0.5, cell // (nx * ny) + 0.5)
	sphere { radius = large, material = hard, position = middle, velocity = anywhere() }
	-- near the large one's skin, on the diagonal of its cell
	for k = 0, each - 2 do
		local place = vec3(k % 5 - 2, k // 5 % 5 - 2, k // 25 - 2)
		sphere { radius = small, material = hard, velocity = anywhere(),
			position = middle + vec3(corner, corner, corner) + 5 * small * place }
	end
end
local far = spacing * vec3(nx, ny, nz)
for axis = 1, 3 do
	local low, high = {0, 0, 0}, {0, 0, 0}
	low[axis], high[axis] = 1, -1
	plane { normal = low, material = hard }
	plane { point = far, normal = high, material = hard }
end

local start
expect_always("energy is kept", function()
	start = start or energy()
	return math.abs(energy() / start - 1), 1e-9
end)
