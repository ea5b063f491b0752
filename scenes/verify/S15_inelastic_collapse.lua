-- SPDX-License-Identifier: MIT
-- S15: three spheres on a line, restitution below 7 - 4 sqrt(3): infinitely many impacts in a finite time (S. McNamara
-- and W. R. Young, Phys. Fluids A 4, 1992). Answer: it ends, the three go on together with a third of the velocity.
-- Spheres are large against gaps, so that rounding across the line does not grow.
local verify = require "rbsim.verify"
local radius, gap = 1, 1 / 64

verify.case { title = "Inelastic collapse", duration = 1, time_step = {0.01, 1e-4, 1}, frame_rate = {1, 10, 7},
	quick = "more" }
local clay = material { name = "clay", friction = 0, restitution = 0.05 }
local ball = {}
for i = 1, 3 do
	ball[i] = verify.sphere { name = "ball" .. i, radius = radius, mass = 1, material = clay,
		position = {(i - 1) * (2 * radius + gap), 0, 0}, velocity = {i == 1 and 1 or 0, 0, 0} }
end

on_transition(function(c)
	if c.kind == "merge" then state.merged = true end
end)
expect("it is told as a merge", function() return state.merged == true end)
expect("momentum stays", function()
	local sum = vec3(0, 0, 0)
	for i = 1, 3 do sum = sum + verify.velocity(ball[i]) end
	return (sum - vec3(1, 0, 0)):length(), 1e-14
end)
expect("they go on together", function()
	local worst = 0
	for i = 1, 3 do worst = verify.larger(worst, (verify.velocity(ball[i]) - vec3(1 / 3, 0, 0)):length()) end
	return worst, 1e-12 + 8 * verify.rounding / radius
end)
-- Touching is a band of 8 ulp of the larger of coordinate and size.
expect_always("no gap is below 0 beyond the touching band, m", function()
	local far, deep = 0, 0
	for i = 1, 3 do
		for _, axis in ipairs {"x", "y", "z"} do far = verify.larger(far, math.abs(ball[i].position[axis])) end
	end
	for i = 1, 2 do
		deep = verify.larger(deep, 2 * radius - (ball[i + 1].position - ball[i].position):length())
	end
	return deep, 8 * verify.ulp(far)
end)
expect("impacts are bounded", function() return collisions(), 1e5 end)
