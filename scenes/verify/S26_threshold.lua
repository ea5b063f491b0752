-- SPDX-License-Identifier: MIT
-- S26: a flat box on a slope, mu a millionth above or below tan(slope). Answer: it stays, or slides with a millionth of
-- g sin(slope).
local verify = require "rbsim.verify"
local slope = param("slope", 30, "degrees", {choices = {30, 10, 60}})
local sticks = param("sticks", true, "mu above tan(slope)", {choices = {true, false}})
local g, size, duration = 9.81, {0.4, 0.3, 0.1}, 10
local sin, cos = math.sin(deg(slope)), math.cos(deg(slope))
local mu = sin / cos * (sticks and 1 + 1e-6 or 1 - 1e-6)

verify.case { title = "To stick or to slip", duration = duration, gravity = {g * sin, 0, -g * cos},
	time_step = {0.01, 1e-3, 0.1}, frame_rate = {10, 1, 60}, quick = "more" }
local stuff = material { name = "stuff", friction = mu, restitution = 0 }
verify.plane { material = stuff }
local box = verify.box { name = "box", size = size, position = {0, 0, size[3] / 2}, material = stuff }

if sticks then
	expect_always("it stays, m", function() return (verify.position(box) - vec3(0, 0, size[3] / 2)):length(), 1e-10 end)
else
	local a = g * sin - mu * g * cos
	expect("distance, relative", function() return math.abs(verify.position(box).x / (a * duration ^ 2 / 2) - 1), 1e-6 end)
	expect("speed, relative", function() return math.abs(verify.velocity(box).x / (a * duration) - 1), 1e-6 end)
	expect_always("aside, m", function() return math.abs(verify.position(box).y), 1e-10 + verify.rounding end)
end
expect_always("turned, rad", function() return verify.tilt(box), 1e-10 end)
