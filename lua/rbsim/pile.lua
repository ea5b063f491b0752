-- SPDX-License-Identifier: MIT
-- rbsim.pile: spheres in the air above a floor, ready to fall into a heap.
--
--   local pile = require "rbsim.pile"
--   pile.spheres { count = 100, keys = { radius = 0.1, material = stone }, above = 0.5 }
--
-- count   how many
-- keys    of sphere { }; its radius decides the distances
-- above   m, from the floor (z = 0 at `center`) to the lowest sphere; default one radius
-- wide    spheres along one side of a layer; default as high as wide
-- gap     free room between two spheres as a part of the radius; default 0.1
-- jitter  each is moved aside at random by at most so much of the radius; default 0.04; with the gap of 0.1 none can overlap
-- center  of the floor; default the origin
-- name    name_1, name_2, ...
--
-- Returns the list of bodies, from the lowest layer up.

local check = require "rbsim.check"
local pile = {}

function pile.spheres(o)
	check.options("pile.spheres", o, {count = "count", keys = "table"}, {above = "not negative", wide = "count",
		gap = "not negative", jitter = "not negative", center = "vector", name = "text"})
	local r = check.value("pile.spheres", "keys.radius", o.keys.radius, "positive")
	local wide = o.wide or math.ceil(o.count ^ (1 / 3) - 1e-9)
	local gap, jitter = o.gap or 0.1, o.jitter or 0.04
	if 2 * jitter > gap then error("pile.spheres: 'jitter' must be at most half of 'gap', or spheres overlap", 2) end
	local step, center = r * (2 + gap), vec3(o.center or {0, 0, 0})
	local low = r + (o.above or r)
	local bodies = {}
	for n = 0, o.count - 1 do
		local i, j, k = n % wide, n // wide % wide, n // (wide * wide)
		local function aside() return r * jitter * (2 * math.random() - 1) end
		local dx, dy = aside(), aside()
		local p = center + vec3((i - (wide - 1) / 2) * step + dx, (j - (wide - 1) / 2) * step + dy, low + k * step)
		local more = {position = p}
		if o.name then more.name = o.name .. "_" .. n + 1 end
		bodies[n + 1] = sphere(check.with(o.keys, more))
	end
	return bodies
end

return pile
