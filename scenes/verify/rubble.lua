-- SPDX-License-Identifier: MIT
-- rubble: heaps of grains that hold together by gravitation; what the verify cases of rubble piles share.
--
--   local rubble = require "rubble"
--   local grains = rubble.cloud { count = 1000, radius = 0.08, spacing = 0.2, centre = {0, 0, 0}, mass = 1e-3,
--                                 material = stone }
--   local bodies = rubble.clumps(grains, 1.2 * 0.16)
--
--   cloud { … }          grains within a ball about `centre`: the sites of a face-centred lattice nearest to it, `spacing`
--                        apart, each moved by up to `jitter` (0.1) of what is free between neighbours; `velocity` of all
--   total(grains)        {mass =, centre =, velocity =, radius =}: radius of a homogeneous ball with the same mean square
--                        distance from the centre, m
--   ellipsoid(grains, radius)  of the homogeneous ellipsoid with the same second moments, grains as balls of `radius`: {density =,
--                        axes = {a, b, c}} with c along z, and spin = angular momentum about z over the moment of inertia
--   momentum_scale(grains)  sum of |m v|
--   clumps(grains, link) groups of grains whose centres are within `link` of another's, largest first: lists of grains

local lattice = require "rbsim.lattice"
local verify = require "rbsim.verify"
local rubble = {}

function rubble.cloud(o)
	local n = math.ceil((o.count / 4) ^ (1 / 3) * 1.3) + 1
	local sites = lattice.fcc { count = {n, n, n}, spacing = o.spacing }
	-- about a point off the lattice's symmetry, so that no two are equally far
	local off = o.spacing * vec3(0.1234, 0.0567, 0.0321)
	table.sort(sites, function(a, b) return (a - off):length() < (b - off):length() end)
	local centre, middle = vec3(o.centre or {0, 0, 0}), vec3(0, 0, 0)
	for i = 1, o.count do middle = middle + sites[i] / o.count end
	-- two neighbours move towards each other by no more than what is between them
	local free = (o.jitter or 0.1) * (o.spacing - 2 * o.radius)
	local function some() return free * (2 * math.random() - 1) end
	local grains = {}
	for i = 1, o.count do
		local p = centre + sites[i] - middle
		local x, y, z = some(), some(), some()
		grains[i] = verify.sphere { name = (o.name or "grain") .. " " .. i, radius = o.radius, mass = o.mass,
			position = p + vec3(x, y, z), velocity = o.velocity, material = o.material }
	end
	return grains
end

function rubble.total(grains)
	local mass, centre, velocity, square = 0, vec3(0, 0, 0), vec3(0, 0, 0), 0
	for _, g in ipairs(grains) do
		mass, centre, velocity = mass + g.mass, centre + g.mass * verify.position(g), velocity + g.mass * verify.velocity(g)
	end
	centre, velocity = centre / mass, velocity / mass
	for _, g in ipairs(grains) do
		local d = verify.position(g) - centre
		square = square + g.mass / mass * d:dot(d)
	end
	return {mass = mass, centre = centre, velocity = velocity, radius = math.sqrt(5 / 3 * square)}
end

function rubble.momentum_scale(grains)
	local sum = 0
	for _, g in ipairs(grains) do sum = sum + g.mass * g.velocity:length() end
	return sum
end

function rubble.ellipsoid(grains, radius)
	local total = rubble.total(grains)
	local xx, xy, yy, zz, turning, inertia = 0, 0, 0, 0, 0, 0
	local own = radius ^ 2 / 5
	for _, g in ipairs(grains) do
		local d, v, share = verify.position(g) - total.centre, verify.velocity(g) - total.velocity, g.mass / total.mass
		xx, xy, yy, zz = xx + share * (d.x ^ 2 + own), xy + share * d.x * d.y, yy + share * (d.y ^ 2 + own), zz + share * (d.z ^ 2 + own)
		turning = turning + g.mass * (d.x * v.y - d.y * v.x + 2 * own * verify.spin(g).z)
		inertia = inertia + g.mass * (d.x ^ 2 + d.y ^ 2 + 2 * own)
	end
	local mean, part = (xx + yy) / 2, math.sqrt(((xx - yy) / 2) ^ 2 + xy ^ 2)
	local axes = {math.sqrt(5 * (mean + part)), math.sqrt(5 * (mean - part)), math.sqrt(5 * zz)}
	return {axes = axes, density = total.mass / (4 / 3 * math.pi * axes[1] * axes[2] * axes[3]), spin = turning / inertia}
end

function rubble.clumps(grains, link)
	local root, place, cell = {}, {}, {}
	local function find(i)
		while root[i] ~= i do
			root[i] = root[root[i]]
			i = root[i]
		end
		return i
	end
	local function key(x, y, z) return (x * 1000003 + y) * 1000003 + z end
	for i, g in ipairs(grains) do
		root[i], place[i] = i, g.position
		local p = place[i]
		local x, y, z = math.floor(p.x / link), math.floor(p.y / link), math.floor(p.z / link)
		for dx = -1, 1 do
			for dy = -1, 1 do
				for dz = -1, 1 do
					for _, k in ipairs(cell[key(x + dx, y + dy, z + dz)] or {}) do
						if (place[k] - p):length() < link then root[find(k)] = find(i) end
					end
				end
			end
		end
		local own = key(x, y, z)
		cell[own] = cell[own] or {}
		table.insert(cell[own], i)
	end
	local groups, list = {}, {}
	for i, g in ipairs(grains) do
		local r = find(i)
		if not groups[r] then
			groups[r] = {}
			list[#list + 1] = groups[r]
		end
		table.insert(groups[r], g)
	end
	table.sort(list, function(a, b) return #a > #b end)
	return list
end

return rubble
