-- SPDX-License-Identifier: MIT
-- rbsim.chain: spheres in a row, each touching the next.
--
--   local chain = require "rbsim.chain"
--   local balls = chain.row { count = 5, from = {0, 0, 1}, direction = {1, 0, 0}, keys = { radius = 0.05 } }
--
-- count      how many
-- keys       of sphere { }
-- from       centre of the first; default the origin
-- direction  of the row; default {1, 0, 0}
-- gap        m, free room between two; default 0: they touch
-- name       name_1, name_2, ...
--
-- Returns the list of bodies.

local check = require "rbsim.check"
local chain = {}

function chain.row(o)
	check.options("chain.row", o, {count = "count", keys = "table"},
		{from = "vector", direction = "vector", gap = "not negative", name = "text"})
	local r = check.value("chain.row", "keys.radius", o.keys.radius, "positive")
	local direction = vec3(o.direction or {1, 0, 0})
	if direction:length() == 0 then error("chain.row: 'direction' must have a length", 2) end
	local from, step = vec3(o.from or {0, 0, 0}), direction:unit() * (2 * r + (o.gap or 0))
	local bodies = {}
	for i = 1, o.count do
		local more = {position = from + (i - 1) * step}
		if o.name then more.name = o.name .. "_" .. i end
		bodies[i] = sphere(check.with(o.keys, more))
	end
	return bodies
end

return chain
