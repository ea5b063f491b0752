-- SPDX-License-Identifier: MIT
-- rbsim.lattice: regular and random arrangements of points, and of spheres on them.
--
--   local lattice = require "rbsim.lattice"
--   lattice.spheres(lattice.cubic { count = {4, 4, 4}, spacing = 0.3 }, { radius = 0.1, material = steel })
--
--   cubic { count = {nx, ny, nz}, spacing =, center =, jitter = }     simple cubic
--   fcc   { count = {nx, ny, nz}, spacing =, center =, jitter = }     face-centred cubic: 4 points per cell,
--                                                                     nearest neighbours `spacing` apart
--   gas   { count =, radius =, size = {x, y, z}, center =, tries = }  at random in a box, no two spheres overlapping,
--                                                                     none through the walls
--   spheres(points, keys [, name])                                    one sphere at each; `keys` are those of sphere { },
--                                                                     or function(i, point) return keys end
--
-- Each of the first three returns a list of vectors, the same for the same seed. `center` is the middle of the whole
-- (default the origin). `jitter` moves each coordinate by at most so much, at random.

local check = require "rbsim.check"
local lattice = {}

local function jittered(p, jitter)
	if jitter == 0 then return p end
	local function move() return jitter * (2 * math.random() - 1) end
	local dx, dy, dz = move(), move(), move()
	return p + vec3(dx, dy, dz)
end

local shape = {count = "counts", spacing = "positive"}
local place = {center = "vector", jitter = "not negative"}

function lattice.cubic(o)
	check.options("lattice.cubic", o, shape, place)
	local center, n, points = vec3(o.center or {0, 0, 0}), o.count, {}
	for k = 1, n[3] do
		for j = 1, n[2] do
			for i = 1, n[1] do
				local p = vec3(i - (n[1] + 1) / 2, j - (n[2] + 1) / 2, k - (n[3] + 1) / 2)
				points[#points + 1] = jittered(center + o.spacing * p, o.jitter or 0)
			end
		end
	end
	return points
end

function lattice.fcc(o)
	check.options("lattice.fcc", o, shape, place)
	local center, n, points = vec3(o.center or {0, 0, 0}), o.count, {}
	local edge = o.spacing * math.sqrt(2)
	local basis = {vec3(0, 0, 0), vec3(0.5, 0.5, 0), vec3(0.5, 0, 0.5), vec3(0, 0.5, 0.5)}
	-- the last layer of points stands half a cell before the end of the last cell
	local middle = vec3(n[1] - 0.5, n[2] - 0.5, n[3] - 0.5) / 2
	for k = 0, n[3] - 1 do
		for j = 0, n[2] - 1 do
			for i = 0, n[1] - 1 do
				for _, b in ipairs(basis) do
					points[#points + 1] = jittered(center + edge * (vec3(i, j, k) + b - middle), o.jitter or 0)
				end
			end
		end
	end
	return points
end

-- Points fall one by one; one that would overlap is thrown again. Neighbours are looked for in cells of one diameter.
function lattice.gas(o)
	check.options("lattice.gas", o, {count = "count", radius = "positive", size = "size"},
		{center = "vector", tries = "count"})
	local r, size, center = o.radius, o.size, o.center or {0, 0, 0}
	for axis = 1, 3 do
		if size[axis] <= 2 * r then error("lattice.gas: the box is no larger than a sphere", 2) end
	end
	-- a hair more than touching, so that rounding makes no overlap
	local apart2 = (2 * r * (1 + 1e-9)) ^ 2
	local cells, points, span = {}, {}, {}
	for axis = 1, 3 do span[axis] = math.floor(size[axis] / (2 * r)) + 1 end

	local function cell_of(p, axis)
		return math.floor((p[axis] - center[axis] + size[axis] / 2) / (2 * r))
	end
	local function key(i, j, k) return (i * span[2] + j) * span[3] + k end
	local function free(p)
		local ci, cj, ck = cell_of(p, 1), cell_of(p, 2), cell_of(p, 3)
		for i = math.max(ci - 1, 0), math.min(ci + 1, span[1] - 1) do
			for j = math.max(cj - 1, 0), math.min(cj + 1, span[2] - 1) do
				for k = math.max(ck - 1, 0), math.min(ck + 1, span[3] - 1) do
					for _, q in ipairs(cells[key(i, j, k)] or {}) do
						local x, y, z = p[1] - q[1], p[2] - q[2], p[3] - q[3]
						if x * x + y * y + z * z < apart2 then return false end
					end
				end
			end
		end
		return true
	end

	for i = 1, o.count do
		local p
		for try = 1, (o.tries or 1000) + 1 do
			if try > (o.tries or 1000) then
				error(("lattice.gas: no room for sphere %d of %d: take a larger box or fewer spheres"):format(i, o.count), 2)
			end
			p = {}
			for axis = 1, 3 do p[axis] = center[axis] + (math.random() - 0.5) * (size[axis] - 2 * r) end
			if free(p) then break end
		end
		local at = key(cell_of(p, 1), cell_of(p, 2), cell_of(p, 3))
		cells[at] = cells[at] or {}
		table.insert(cells[at], p)
		points[i] = vec3(p)
	end
	return points
end

function lattice.spheres(points, keys, name)
	check.value("lattice.spheres", "points", points, "table")
	if type(keys) ~= "function" then check.value("lattice.spheres", "keys", keys, "table") end
	if name ~= nil then check.value("lattice.spheres", "name", name, "text") end
	local bodies = {}
	for i, p in ipairs(points) do
		local own = type(keys) == "function" and keys(i, p) or keys
		local more = {position = p}
		if name then more.name = name .. "_" .. i end
		bodies[i] = sphere(check.with(own, more))
	end
	return bodies
end

return lattice
