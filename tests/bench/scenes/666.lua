-- SimBenchmark's "666", inelastic: 6 x 6 x 6 balls without friction fall on a plane (R 0.1 m, 10 kg, spacing 0.21 m).
-- Its error is the sum over all pairs of overlap squared, averaged over the steps; a square root of that, over the
-- number of contacts, is the overlap of one.
local rate = param("rate", 1000, "steps per second", {min = 10})
local radius = 0.1

world { title = "666", duration = 10, frame_rate = rate, time_step = 1 / rate, gravity = {0, 0, -9.81}, seed = 42 }
local smooth = material { name = "smooth", friction = 0, restitution = 0 }
plane { normal = {0, 0, 1}, material = smooth }
local balls = {}
for z = 0, 5 do
	for y = 0, 5 do
		for x = 0, 5 do
			balls[#balls + 1] = sphere { radius = radius, mass = 10, material = smooth, position = {
				0.21 * x + 1e-3 * math.random(), 0.21 * y + 1e-3 * math.random(),
				0.101 + 0.21 * z + 1e-3 * math.random() } }
		end
	end
end

local frames, sum, contacts = 0, 0, 0
on_frame(function()
	local at, cell = {}, {}
	local function key(x, y, z) return x .. "," .. y .. "," .. z end
	for i, ball in ipairs(balls) do
		local p = ball.position
		local x, y, z = p.x // 0.2001, p.y // 0.2001, p.z // 0.2001
		at[i] = {p.x, p.y, p.z, x, y, z}
		local k = key(x, y, z)
		cell[k] = cell[k] or {}
		table.insert(cell[k], i)
		local depth = radius - p.z
		if depth > -1e-7 then
			contacts = contacts + 1
			if depth > 0 then sum = sum + depth * depth end
		end
	end
	for i, a in ipairs(at) do
		for x = a[4] - 1, a[4] + 1 do
			for y = a[5] - 1, a[5] + 1 do
				for z = a[6] - 1, a[6] + 1 do
					for _, j in ipairs(cell[key(x, y, z)] or {}) do
						if j > i then
							local b = at[j]
							local dx, dy, dz = b[1] - a[1], b[2] - a[2], b[3] - a[3]
							local depth = 2 * radius - math.sqrt(dx * dx + dy * dy + dz * dz)
							if depth > -1e-7 then
								contacts = contacts + 1
								if depth > 0 then sum = sum + depth * depth end
							end
						end
					end
				end
			end
		end
	end
	frames = frames + 1
end)
expect("sum of overlap squared, m^2", function() return sum / frames, 1e-10 end)
expect("RMS overlap per contact over R", function() return math.sqrt(sum / math.max(contacts, 1)) / radius, 1e-6 end)
