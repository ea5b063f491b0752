-- SPDX-License-Identifier: MIT
-- rbsim.chain: spheres in a row, each touching the next; links that joints hold together.
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
--
--   local links, joints = chain.links { count = 20, from = {0, 0, 2}, to = {2, 0, 2}, world = true, keys = { mass = 0.1 } }
--
-- Capsules in a straight line, each joined to the next where their ends meet.
--
-- count      how many
-- from, to   the two ends of the whole chain
-- keys       of capsule { }; radius: default a tenth of a link's length; ends are round, so a link is longer than it is wide
-- kind       of the joints: "ball" or "hinge"; default "ball"
-- axis       of hinges; default {0, 1, 0}
-- joint      more keys of joint { }, such as friction
-- world      true: the first link hangs on the world at `from`
-- last       a body on which the last link ends at `to`; also "world"
-- name       name_1, name_2, ...
--
-- Returns the list of bodies and the list of joints, from the first on.

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

-- The turn that takes the z axis to a unit vector.
local function turn_to(d)
	if d.z <= -1 + 1e-12 then return {0, 1, 0, 0} end
	local w, x, y = 1 + d.z, -d.y, d.x
	local length = math.sqrt(w * w + x * x + y * y)
	return {w / length, x / length, y / length, 0}
end

function chain.links(o)
	check.options("chain.links", o, {count = "count", from = "vector", to = "vector"},
		{keys = "table", kind = "text", axis = "vector", joint = "table", world = "boolean", last = "any", name = "text"})
	local from, to = vec3(o.from), vec3(o.to)
	local each = (to - from):length() / o.count
	if each == 0 then error("chain.links: 'from' and 'to' must be apart", 2) end
	local along = (to - from):unit()
	local keys = check.with({radius = each / 10}, o.keys or {})
	check.value("chain.links", "keys.radius", keys.radius, "positive")
	if 2 * keys.radius >= each then error("chain.links: links are wider than long (keys.radius)", 2) end
	local kind = o.kind or "ball"
	if kind ~= "ball" and kind ~= "hinge" then error("chain.links: 'kind' must be \"ball\" or \"hinge\"", 2) end
	local bodies, joints = {}, {}
	local function join(a, b, at)
		local more = {kind = kind, a = a, b = b, at = at}
		if kind == "hinge" then more.axis = o.axis or {0, 1, 0} end
		joints[#joints + 1] = joint(check.with(o.joint, more))
	end
	for i = 1, o.count do
		local more = {length = each - 2 * keys.radius, position = from + (i - 0.5) * each * along, orientation = turn_to(along)}
		if o.name then more.name = o.name .. "_" .. i end
		bodies[i] = capsule(check.with(keys, more))
		if i > 1 then join(bodies[i - 1], bodies[i], from + (i - 1) * each * along)
		elseif o.world then join(bodies[1], nil, from) end
	end
	if o.last == "world" then join(bodies[o.count], nil, to)
	elseif o.last then join(bodies[o.count], o.last, to) end
	return bodies, joints
end

return chain
