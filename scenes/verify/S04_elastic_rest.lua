-- SPDX-License-Identifier: MIT
-- S04: bodies that would give back every impact lie still: a sphere on a floor, a thousand in a cubic lattice that fills
-- a box, whose coordinates 0.1 k leave gaps of an ulp, a block on a slope of 30 degrees. Answer: nothing moves.
local verify = require "rbsim.verify"
local part = param("part", "sphere", "what lies there", {choices = {"sphere", "lattice", "block"}})
local sin, cos = part == "block" and 0.5 or 0, part == "block" and math.sqrt(0.75) or 1

verify.case { title = "Elastic and at rest", duration = 100, gravity = {9.81 * sin, 0, -9.81 * cos}, time_step = {0.1, 0.01, 1},
	frame_rate = {1, 0.1, 0.3}, quick = "base", processor_seconds = 120 }
local hard = material { name = "hard", friction = part == "block" and 1 or 0.5, restitution = 1 }
local bodies, radius = {}, 0.05
verify.plane { material = hard }
if part == "sphere" then
	bodies[1] = verify.sphere { name = "ball", radius = radius, position = {0, 0, radius}, material = hard }
elseif part == "block" then
	bodies[1] = verify.box { name = "block", size = {0.2, 0.2, 0.1}, position = {0, 0, 0.05}, material = hard }
else
	for _, wall in ipairs {{{1, 0, 0}, {0, 0, 0}}, {{-1, 0, 0}, {1, 0, 0}}, {{0, 1, 0}, {0, 0, 0}}, {{0, -1, 0}, {0, 1, 0}}} do
		verify.plane { normal = wall[1], point = wall[2], material = hard }
	end
	for i = 0, 9 do
		for j = 0, 9 do
			for k = 0, 9 do
				bodies[#bodies + 1] = verify.sphere { radius = radius, mass = 1, material = hard,
					position = {0.1 * i + radius, 0.1 * j + radius, 0.1 * k + radius} }
			end
		end
	end
end

expect_always("nothing moves, J/kg", function()
	local energy, mass = 0, 0
	for _, body in ipairs(bodies) do energy, mass = energy + body.kinetic_energy, mass + body.mass end
	return energy / mass, 1e-20
end)
local start = {}
for i, body in ipairs(bodies) do start[i] = vec3(body.position) end
expect("nothing has moved, m", function()
	local far = 0
	for i, body in ipairs(bodies) do far = verify.larger(far, (body.position - start[i]):length()) end
	return far, 1e-12 + verify.rounding
end)
