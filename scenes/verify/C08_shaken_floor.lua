-- SPDX-License-Identifier: MIT
-- C08: a floor moves along as A sin(w t), with a box on it that it can drag with mu g. Answer: the box keeps to the floor
-- while that accelerates by no more, and slides with mu g until their speeds are equal again.
local verify = require "rbsim.verify"
local g, mu, size, amplitude = 9.81, 0.3, {0.2, 0.2, 0.1}, 0.05
local strong = param("strong", 1.5, "largest acceleration of the floor over mu g", {choices = {1.5, 0.9, 5.0}})
local w = math.sqrt(strong * mu * g / amplitude)
local duration = 4 * 2 * math.pi / w

verify.case { title = "A shaken floor", duration = duration, gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {60, 10, 100}, quick = "base" }
local stuff = material { name = "stuff", friction = mu, restitution = 0 }
local function floor_at(t) return amplitude * math.sin(w * t) end
local function floor_speed(t) return amplitude * w * math.cos(w * t) end
verify.plane { material = stuff, motion = function(t)
	return vec3(floor_at(t), 0, 0), nil, vec3(floor_speed(t), 0, 0), vec3(0, 0, 0)
end }
local box = verify.box { name = "box", size = size, position = {0, 0, size[3] / 2}, velocity = {floor_speed(0), 0, 0}, material = stuff }

local function root(f, low, high)
	local rising = f(high) > 0
	for _ = 1, 200 do
		local middle = (low + high) / 2
		if (f(middle) > 0) == rising then high = middle else low = middle end
	end
	return (low + high) / 2
end
-- Phases {time, place, speed, acceleration}; one that keeps to the floor has no acceleration.
local function phases()
	local list, most, tick = {{0, 0, floor_speed(0)}}, mu * g, 2 * math.pi / w / 4096
	while true do
		local at = list[#list]
		local t, slides = at[1], at[4]
		-- on the floor: until it accelerates by more; sliding: until the speeds are equal
		local function over(s)
			if slides then return (at[3] + slides * (s - t) - floor_speed(s)) * (slides < 0 and 1 or -1) end
			return most - math.abs(amplitude * w * w * math.sin(w * s))
		end
		local s = t + tick
		while s <= duration and over(s) > 0 do s = s + tick end
		if s > duration then return list end
		s = root(over, s - tick, s)
		local pull = -amplitude * w * w * math.sin(w * s)
		local place = slides and at[2] + at[3] * (s - t) + slides * (s - t) ^ 2 / 2 or at[2] + floor_at(s) - floor_at(t)
		-- it keeps to the floor if that asks for no more than friction can; else it is left behind
		local keeps = slides and math.abs(pull) <= most
		list[#list + 1] = {s, place, floor_speed(s), not keeps and (pull > 0 and most or -most) or nil}
	end
end
local list = phases()
expect_always("place, m", function()
	local t, k = time(), #list
	while k > 1 and list[k][1] > t do k = k - 1 end
	local at = list[k]
	local s = t - at[1]
	local x = at[4] and at[2] + at[3] * s + at[4] * s * s / 2 or at[2] + floor_at(t) - floor_at(at[1])
	return (verify.position(box) - vec3(x, 0, size[3] / 2)):length(), 1e-9 + 8 * verify.rounding
end)
-- what slides on the other way, with no rest between, goes on sliding: there is nothing to tell
local kinds = {}
for k = 2, #list do
	local kind = list[k][4] and "slide" or "rest"
	if kind ~= kinds[#kinds] then kinds[#kinds + 1] = kind end
end
on_transition(function(c) state.told = (state.told or 0) + 1 end)
expect("it begins and stops to slide as often", function() return math.abs((state.told or 0) - #kinds), 0 end)
expect("it does not turn, rad", function() return verify.tilt(box), 1e-9 end)
