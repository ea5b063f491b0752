-- SPDX-License-Identifier: MIT
-- rbsim.wall: rooms made of planes.
--
--   local wall = require "rbsim.wall"
--   wall.floor { material = felt }
--   wall.box { size = {4, 4, 3}, keys = { material = glass } }
--
--   floor(keys)                                 the plane z = 0; `keys` of plane { }
--   box { size =, center =, open =, keys = }    six infinite planes that look inwards; `open` is a text that names the
--                                               sides to leave out, some of "-x +x -y +y -z +z"; returns them by side
--   tray { size = {w, h}, center =, keys = }    one finite plane, level

local check = require "rbsim.check"
local wall = {}

local sides = {"-x", "+x", "-y", "+y", "-z", "+z"}

function wall.floor(keys)
	if keys ~= nil then check.value("wall.floor", "keys", keys, "table") end
	return plane(check.with({normal = {0, 0, 1}}, keys or {}))
end

function wall.box(o)
	check.options("wall.box", o, {size = "size"}, {center = "vector", open = "text", keys = "table"})
	local center, planes, open = vec3(o.center or {0, 0, 0}), {}, {}
	for side in (o.open or ""):gmatch("%S+") do
		if not table.concat(sides, " "):find(side, 1, true) or #side ~= 2 then
			error(("wall.box: '%s' is no side of a box (they are %s)"):format(side, table.concat(sides, " ")), 2)
		end
		open[side] = true
	end
	for n, side in ipairs(sides) do
		if not open[side] then
			local axis, outwards = (n + 1) // 2, n % 2 == 0 and 1 or -1
			local normal, point = {0, 0, 0}, vec3(center)
			normal[axis] = -outwards
			point[axis] = point[axis] + outwards * o.size[axis] / 2
			planes[side] = plane(check.with(o.keys, {normal = normal, point = point}))
		end
	end
	return planes
end

function wall.tray(o)
	check.options("wall.tray", o, {size = "table"}, {center = "vector", keys = "table"})
	return plane(check.with(o.keys, {normal = {0, 0, 1}, point = o.center or {0, 0, 0}, size = o.size}))
end

return wall
