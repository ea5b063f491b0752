-- SPDX-License-Identifier: MIT
-- rbsim.path: functions of time for cameras.
--
--   local path = require "rbsim.path"
--   camera { position = path.orbit { center = {0, 0, 1}, radius = 5, period = 20 }, look_at = {0, 0, 1} }
--
--   orbit { center =, radius =, height =, period =, start = }   round a centre in a level circle; `height` above it
--                                                               (default 0), `start` in radians (default 0)
--   line { from =, to =, start =, duration = }                  straight, softly from rest to rest
--   through { {t, {x, y, z}}, {t, {x, y, z}}, ... }             smoothly through points at their times (Catmull-Rom)
--   shake { at =, size =, frequency = }                         a hand that is not quite still
--
-- Each returns a function(t) that depends on nothing but t.

local check = require "rbsim.check"
local path = {}

function path.orbit(o)
	check.options("path.orbit", o, {radius = "positive", period = "positive"},
		{center = "vector", height = "number", start = "number"})
	local center, radius, period = vec3(o.center or {0, 0, 0}), o.radius, o.period
	local height, start = o.height or 0, o.start or 0
	return function(t)
		local a = start + 2 * math.pi * t / period
		return center + vec3(radius * math.cos(a), radius * math.sin(a), height)
	end
end

function path.line(o)
	check.options("path.line", o, {from = "vector", to = "vector", duration = "positive"}, {start = "number"})
	local from, to, start, duration = vec3(o.from), vec3(o.to), o.start or 0, o.duration
	return function(t)
		local s = math.max(0, math.min(1, (t - start) / duration))
		s = s * s * (3 - 2 * s)
		return from + s * (to - from)
	end
end

function path.through(stops)
	check.value("path.through", "stops", stops, "table")
	if #stops < 2 then error("path.through: needs two stops {t, {x, y, z}} or more", 2) end
	local times, points = {}, {}
	for i, stop in ipairs(stops) do
		if type(stop) ~= "table" then error(("path.through: stop %d is no {t, {x, y, z}}"):format(i), 2) end
		times[i] = check.value("path.through", "t of stop " .. i, stop[1], "number")
		points[i] = vec3(check.value("path.through", "point of stop " .. i, stop[2], "vector"))
		if i > 1 and times[i] <= times[i - 1] then error("path.through: times must grow", 2) end
	end
	local n = #points
	local function slope(i)
		local a, b = math.max(i - 1, 1), math.min(i + 1, n)
		return (points[b] - points[a]) / (times[b] - times[a])
	end
	return function(t)
		if t <= times[1] then return points[1] end
		if t >= times[n] then return points[n] end
		local i = 1
		while times[i + 1] < t do i = i + 1 end
		-- cubic Hermite between stops i and i + 1
		local h = times[i + 1] - times[i]
		local s = (t - times[i]) / h
		local s2, s3 = s * s, s * s * s
		return (2 * s3 - 3 * s2 + 1) * points[i] + (s3 - 2 * s2 + s) * h * slope(i)
			+ (3 * s2 - 2 * s3) * points[i + 1] + (s3 - s2) * h * slope(i + 1)
	end
end

function path.shake(o)
	check.options("path.shake", o, {at = "vector", size = "not negative"}, {frequency = "positive"})
	local at, size, w = vec3(o.at), o.size, 2 * math.pi * (o.frequency or 1)
	return function(t)
		-- three sines whose periods have no common multiple
		return at + size * vec3(math.sin(w * t), math.sin(1.3247 * w * t + 1), math.sin(1.7549 * w * t + 2)) / math.sqrt(3)
	end
end

return path
