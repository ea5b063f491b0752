-- SPDX-License-Identifier: MIT
-- S11: one ball hits a row of four. Answer: with gaps of a micrometre the last one leaves alone; touching, the impact is
-- passed on all the same (a rule that this program has chosen, after Smith and others, 2012), and momentum and energy
-- stay. The order in which the balls are declared does not matter.
local verify = require "rbsim.verify"
local gap = param("gap", 1e-6, "between neighbours, m", {choices = {1e-6, 0.0}})
local order = param("order", 1, "of declaration", {choices = {1, 2, 3}})
local radius, v = 0.5, 1
local orders = {{1, 2, 3, 4, 5}, {5, 4, 3, 2, 1}, {3, 1, 5, 2, 4}}

verify.case { title = "Newton's cradle", duration = 1, time_step = {0.01, 1e-4, 1}, frame_rate = {1, 10, 7},
	quick = "more" }
local steel = material { name = "steel", friction = 0, restitution = 1 }
local ball = {}
for _, i in ipairs(orders[order]) do
	ball[i] = verify.sphere { name = "ball" .. i, radius = radius, mass = 1, material = steel,
		position = {i == 1 and -0.5 or (i - 1) * (2 * radius + gap), 0, 0}, velocity = {i == 1 and v or 0, 0, 0} }
end

-- Coordinates that are rounded by d tilt a normal by d/(2 radius), with small gaps in between that is all.
local tilt = 4 * verify.rounding / radius
expect("the last ball leaves with it all", function()
	return (verify.velocity(ball[5]) - vec3(v, 0, 0)):length(), 1e-12 + tilt
end)
expect("the others stand", function()
	local most = 0
	for i = 1, 4 do most = verify.larger(most, ball[i].velocity:length()) end
	return most, 1e-12 + tilt
end)
expect("momentum stays", function()
	local sum = vec3(0, 0, 0)
	for i = 1, 5 do sum = sum + verify.velocity(ball[i]) end
	return (sum - vec3(v, 0, 0)):length(), 1e-14
end)
expect("energy stays", function()
	local sum = 0
	for i = 1, 5 do sum = sum + ball[i].velocity:dot(ball[i].velocity) end
	return math.abs(sum - v * v), 1e-14
end)
