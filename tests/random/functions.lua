-- SPDX-License-Identifier: MIT
-- The functions that a random scene may have: motions of driven bodies, fields, callbacks. Scenes name them with numbers,
-- so that a scene stays a list of plain calls.
local functions = {}

-- Shaken along `by` from `point`, with the velocity stated or left out.
function functions.shaken(point, by, omega, stated)
	point, by = vec3(point), vec3(by)
	return function(t)
		local p = point + math.sin(omega * t) * by
		if not stated then return p end
		return p, nil, omega * math.cos(omega * t) * by
	end
end

-- Turned about `axis` through `point`.
function functions.turned(point, axis, omega)
	return function(t)
		return point, {axis = axis, angle = omega * t}, {0, 0, 0}, omega * vec3(axis)
	end
end

-- A force towards `centre` that grows with the distance.
function functions.towards(centre, stiffness)
	centre = vec3(centre)
	return function(_, x) return stiffness * (centre - vec3(x)) end
end

function functions.nothing()
	return function() end
end

-- An impulse on the body of this name at the first step from `start` on.
function functions.kick(name, start, impulse)
	local done = false
	return function(t)
		if not done and t >= start then
			done = true
			body(name):apply_impulse(impulse)
		end
	end
end

return functions
