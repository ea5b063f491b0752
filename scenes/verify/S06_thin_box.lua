-- SPDX-License-Identifier: MIT
-- S06: two thousand spheres of 1 mm at 10 km/s, five hundred a run, each on a static box 1 mm thick, in random directions; a
-- step of 1/60 s is 167 m. Answer: every one is reflected, at its time.
local verify = require "rbsim.verify"
local batch = param("batch", 1, "which quarter of them", {choices = {1, 2, 3, 4}})
local count = 500
math.randomseed(batch)
local e, speed, radius, thick, away, side = 0.5, 1e4, 1e-3, 1e-3, 40, 256

verify.case { title = "Ten kilometres per second at a thin box", duration = 1 / 60, time_step = {1 / 60, 1e-3, 1e-5},
	frame_rate = {60, 1, 200}, quick = "base", length = 256 }
local steel = material { name = "steel", density = 7800, friction = 0, restitution = e }

local function direction()
	while true do
		local d = vec3(2 * math.random() - 1, 2 * math.random() - 1, 2 * math.random() - 1)
		if d:length() <= 1 and d:length() > 0.1 then return d:unit() end
	end
end
-- The turn that takes z to n: about z x n.
local function orientation(n)
	local half = math.sqrt((1 + n.z) / 2)
	return n.z < -0.999 and {0, 1, 0, 0} or {half, -n.y / (2 * half), n.x / (2 * half), 0}
end

-- Each box is beyond the reach of others' spheres. Directions that graze are thrown again: hitting within the face is then
-- sure, and the time is not worse than its coordinates by more than a factor of ten.
local across, shots, place = math.ceil(math.sqrt(count)), {}, {}
for i = 1, count do
	local centre = vec3(((i - 1) % across - across / 2) * side, ((i - 1) // across - across / 2) * side, 0)
	local normal, d = direction(), direction()
	if normal.z < -0.999 then normal = vec3(0, 0, -1) end
	while math.abs(d:dot(normal)) < 0.1 do d = direction() end
	verify.box { size = {0.5, 0.5, thick}, position = centre, orientation = orientation(normal), static = true, material = steel }
	shots[i] = {d = d, normal = normal, centre = centre, time = (away - (radius + thick / 2) / math.abs(d:dot(normal))) / speed,
		body = verify.sphere { name = "s" .. i, radius = radius, position = centre - away * d, velocity = speed * d,
			material = steel } }
	place["s" .. i] = i
end

on_collision(function(c)
	local shot = shots[place[c.a.name] or place[c.b.name]]
	shot.hits = (shot.hits or 0) + 1
	shot.late = math.abs(c.time - shot.time)
end)
expect("none goes through", function()
	local through = 0
	for _, shot in ipairs(shots) do
		local before = -shot.d:dot(shot.normal)
		local after = (verify.position(shot.body) - shot.centre):dot(shot.normal)
		if before * after <= 0 or shot.hits ~= 1 then through = through + 1 end
	end
	return through, 0
end)
-- A coordinate of up to 4e3 m is rounded by 5e-13 m, ten times that along the way of the flattest.
expect("every impact is in time, s", function()
	local late = 0
	for _, shot in ipairs(shots) do late = verify.larger(late, shot.late or 0 / 0) end
	return late, 1e-13 + 10 * verify.rounding / speed
end)
expect("every one is reflected, relative", function()
	local worst = 0
	for _, shot in ipairs(shots) do
		local v = shot.d - (1 + e) * shot.d:dot(shot.normal) * shot.normal
		worst = verify.larger(worst, (verify.velocity(shot.body) / speed - v):length())
	end
	return worst, 1e-12
end)
