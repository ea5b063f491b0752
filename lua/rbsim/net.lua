-- SPDX-License-Identifier: MIT
-- rbsim.net: knots in rows and columns, each tied to its neighbours.
--
--   local net = require "rbsim.net"
--   local knots, cords = net.sheet { count = {9, 7}, from = {-1, -1, 2}, along = {2, 0, 0}, across = {0, 2, 0}, keys = { mass = 0.02, radius = 0.02 } }
--
-- count          {columns, rows}, each 2 or more
-- from           of the first knot; default the origin
-- along, across  from there to the last knot of the first row, and of the first column
-- keys           of sphere { }; mass: default 0.01 kg, radius: default a twentieth of the smaller spacing
-- kind           of the ties: "rope" or "rod"; default "rope"
-- joint          more keys of joint { }
-- hung           function(column, row): whether that knot is tied to the world where it is; default: none
-- name           name_1_1, name_2_1, ... by column and row
--
-- Returns the knots, knots[column][row], and the list of ties.

local check = require "rbsim.check"
local net = {}

function net.sheet(o)
	check.options("net.sheet", o, {count = "table", along = "vector", across = "vector"},
		{from = "vector", keys = "table", kind = "text", joint = "table", hung = "function", name = "text"})
	local columns, rows = o.count[1], o.count[2]
	for _, n in ipairs {columns or 0, rows or 0} do
		check.value("net.sheet", "count", n, "count")
		if n < 2 then error("net.sheet: 'count' must be {columns, rows}, each 2 or more", 2) end
	end
	local kind = o.kind or "rope"
	if kind ~= "rope" and kind ~= "rod" then error("net.sheet: 'kind' must be \"rope\" or \"rod\"", 2) end
	local from, along, across = vec3(o.from or {0, 0, 0}), vec3(o.along) / (columns - 1), vec3(o.across) / (rows - 1)
	local least = math.min(along:length(), across:length())
	if least == 0 then error("net.sheet: 'along' and 'across' must have a length", 2) end
	local keys = check.with({mass = 0.01, radius = least / 20, texture = "none"}, o.keys or {})
	local knots, ties = {}, {}
	local function tie(a, b) ties[#ties + 1] = joint(check.with(o.joint, {kind = kind, a = a, b = b})) end
	for i = 1, columns do
		knots[i] = {}
		for k = 1, rows do
			local at = from + (i - 1) * along + (k - 1) * across
			local more = {position = at}
			if o.name then more.name = ("%s_%d_%d"):format(o.name, i, k) end
			knots[i][k] = sphere(check.with(keys, more))
			if o.hung and o.hung(i, k) then ties[#ties + 1] = joint { kind = "ball", a = knots[i][k], at = at, visible = false } end
			if i > 1 then tie(knots[i - 1][k], knots[i][k]) end
			if k > 1 then tie(knots[i][k - 1], knots[i][k]) end
		end
	end
	return knots, ties
end

return net
