-- SPDX-License-Identifier: MIT
-- S23: a slender block is tilted and let go; it rocks from one edge to the other. Answer (Housner 1963): each impact
-- leaves 1 - 3/2 sin^2(alpha) of the spin, tan(alpha) = width over height.
local verify = require "rbsim.verify"
local slender = param("slender", 2, "height over width", {choices = {2, 4}})
local g, width, depth = 9.81, 0.25, 0.5
local height = slender * width
local half, alpha = math.sqrt(width ^ 2 + height ^ 2) / 2, math.atan(1 / slender)
local tilt = 0.75 * alpha
local left = 1 - 1.5 * math.sin(alpha) ^ 2
-- Energy about the edge, with the inertia 4/3 m R^2.
local rate = 3 * g / (4 * half)
local first = math.sqrt(2 * rate * (math.cos(alpha - tilt) - math.cos(alpha)))

verify.case { title = "A rocking block", duration = slender, gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {10, 1, 60}, quick = "more" }
local stuff = material { name = "stuff", friction = 1, restitution = 0 }
verify.plane { material = stuff }
-- It stands on its edge at x = width/2.
local box = verify.box { name = "box", size = {width, depth, height}, material = stuff,
	orientation = {axis = {0, 1, 0}, angle = tilt},
	position = {width / 2 - half * math.sin(alpha - tilt), 0, half * math.cos(alpha - tilt)} }

-- Spins after each moment of impact; corners of one edge may be told one by one.
on_collision(function(c)
	local spins = state.spins or {}
	state.spins = spins
	if #spins == 0 or c.time > state.at + 1e-9 then spins[#spins + 1] = 0 end
	spins[#spins], state.at = verify.spin(box):length(), c.time
end)
local wanted = slender == 2 and 4 or 8
expect("it rocks", function() return wanted - #(state.spins or {}), 0 end)
expect("the first spin, relative", function()
	return math.abs(((state.spins or {})[1] or 0) / (first * left) - 1), 1e-9 + 8 * verify.rounding / width
end)
expect("what each impact leaves", function()
	local worst, before = 0, first
	for k = 1, wanted do
		local spin = (state.spins or {})[k] or 0 / 0
		worst, before = verify.larger(worst, math.abs(spin / before - left)), spin
	end
	return worst, 1e-9 + 64 * verify.rounding / width
end)
expect_always("it rocks in its plane", function()
	local _, y = verify.axes(box)
	return (y - vec3(0, 1, 0)):length(), 1e-9
end)
