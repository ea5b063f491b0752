-- SPDX-License-Identifier: MIT
-- J13: a car whose four wheels motors turn with all that they can, up an incline, without slip. Answer: it goes by
-- (T/r - M g sin q)/(M + 4 I/r^2), T being the torque of all wheels and M the mass with them, its weight is on four wheels,
-- and no wheel slips.
local verify = require "rbsim.verify"
local g, q, r, torque, body_mass, wheel_mass = 9.81, 0.1, 0.3, 60, 400, 20
local I = 0.4 * wheel_mass * r ^ 2
local M = body_mass + 4 * wheel_mass
local a = (4 * torque / r - M * g * math.sin(q)) / (M + 4 * I / r ^ 2)

verify.case { title = "A car", duration = 4, time_step = {0.05, 0.01, 0.2}, frame_rate = {10, 1, 7},
	gravity = {-g * math.sin(q), 0, -g * math.cos(q)}, method = "located", quick = "base" }
local rubber = material { name = "rubber", friction = 0.9, restitution = 0 }
verify.plane { material = rubber }
local car = verify.box { size = {2.4, 1.2, 0.4}, mass = body_mass, material = rubber, position = {0, 0, r + 0.3} }
local wheels = {}
for k = 0, 3 do
	local at = vec3(k % 2 == 0 and -0.9 or 0.9, k < 2 and -0.8 or 0.8, r)
	local wheel = verify.sphere { mass = wheel_mass, radius = r, material = rubber, position = at }
	verify.joint { kind = "hinge", a = car, b = wheel, at = at, axis = {0, 1, 0}, motor = {speed = 1e3, torque = torque} }
	wheels[#wheels + 1] = wheel
end
local slipped = 0
on_frame(function()
	for _, wheel in ipairs(wheels) do
		local slip = verify.velocity(wheel) - vec3(verify.spin(wheel).y * r, 0, 0)
		slipped = verify.larger(slipped, slip:length())
	end
end)
expect_always("how far it has come, m", function()
	return math.abs(verify.position(car).x - 0.5 * a * time() ^ 2), 1e-12 * (1 + time() ^ 2) + 64 * verify.rounding
end)
expect("no wheel slips, m/s", function() return slipped, 1e-12 + 64 * verify.rounding end)
expect("they stay on the road, m", function()
	return math.abs(verify.position(car).z - r - 0.3), 1e-12 + 16 * verify.rounding
end)
