-- SPDX-License-Identifier: MIT
-- B03: "rolling" of SimBenchmark: 25 balls of 1 kg on a plate of 20 x 20 x 1 m and 10 kg, which 150 N pull over a floor, in
-- four directions. Answer: with f1 = mu (M + n m) g from the floor, each ball takes f2 = (F - f1)/M/(3.5/m + n/M); the balls
-- have f2/m, the plate 3.5 f2/m. The published error is the mean square of velocities; its root over theirs is ours.
local verify = require "rbsim.verify"
local angle = param("angle", 60, "of the force to an edge, degrees", {choices = {60, 0, 30, 90}})
local g, radius, force, duration = 9.81, 0.5, 150, 4
local along = vec3(math.cos(deg(angle)), math.sin(deg(angle)), 0)

verify.case { title = "SimBenchmark: rolling", duration = duration, gravity = {0, 0, -g}, time_step = {1e-3, 1e-2, 1 / 60},
	frame_rate = {100, 10, 60}, quick = "base", length = 16 }
local ground, plate, rubber = material { name = "ground" }, material { name = "plate" }, material { name = "rubber" }
contact_pair(ground, plate, { friction = 0.4, restitution = 0 })
contact_pair(plate, rubber, { friction = 0.8, restitution = 0 })
contact_pair(ground, rubber, { friction = 0.8, restitution = 0 })
verify.plane { material = ground }
local box = verify.box { name = "plate", size = {20, 20, 1}, mass = 10, position = {0, 0, 0.5}, material = plate,
	forces = {{vector = force * along}} }
local balls = {}
for i = -2, 2 do
	for j = -2, 2 do
		balls[#balls + 1] = verify.sphere { radius = radius, mass = 1, position = {2 * i, 2 * j, 1 + radius}, material = rubber }
	end
end

local n, m, heavy = #balls, 1, 10
local f1 = 0.4 * (heavy + n * m) * g
local f2 = (force - f1) / heavy / (3.5 / m + n / heavy)
local a_ball, a_box = f2 / m, 3.5 * f2 / m
expect("accelerations are those of the table", function()
	return math.abs(a_ball / 0.211 - 1) + math.abs(a_box / 0.7385 - 1), 1e-2
end)
local squares, sizes = 0, 0
on_frame(function()
	local t, ball = time(), 0
	for _, one in ipairs(balls) do
		local off = verify.velocity(one) - a_ball * t * along
		ball = verify.larger(ball, off:dot(off))
	end
	local off = verify.velocity(box) - a_box * t * along
	squares = squares + ball + off:dot(off)
	sizes = sizes + (a_ball ^ 2 + a_box ^ 2) * t * t
end)
expect("RMS error of velocities over their RMS", function() return math.sqrt(squares / sizes), 1e-9 end)
expect("the plate does not turn, rad", function() return verify.tilt(box), 1e-9 end)
expect("overlap, radii", function() return max_penetration() / radius, 1e-9 end)
