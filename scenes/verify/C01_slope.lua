-- SPDX-License-Identifier: MIT
-- C01: a solid sphere is let go on a slope. Answer: it rolls, with a = 5/7 g sin, if mu >= 2/7 tan; else it slides with
-- a = g (sin - mu cos) and turns with 5/2 mu g cos/R.
local verify = require "rbsim.verify"
local slope = param("slope", 30, "degrees", {choices = {30, 10, 60}})
local mu = param("mu", 0.1, "friction", {choices = {0.1, 0.04, 0.9}})
local g, radius, duration = 9.81, 0.1, 2
local sin, cos = math.sin(deg(slope)), math.cos(deg(slope))

verify.case { title = "A sphere on a slope", duration = duration, gravity = {g * sin, 0, -g * cos},
	time_step = {0.01, 1e-4, 0.1}, frame_rate = {10, 1, 7}, quick = "more" }
local stuff = material { name = "stuff", friction = mu, restitution = 0 }
verify.plane { material = stuff }
local ball = verify.sphere { name = "ball", radius = radius, position = {0, 0, radius}, material = stuff }

local rolls = mu >= 2 / 7 * sin / cos
local a = rolls and 5 / 7 * g * sin or g * (sin - mu * cos)
local alpha = rolls and a / radius or 2.5 * mu * g * cos / radius
expect("velocity, relative", function()
	return (verify.velocity(ball) - vec3(a * duration, 0, 0)):length() / (a * duration), 1e-10
end)
expect("spin, relative", function()
	return (verify.spin(ball) - vec3(0, alpha * duration, 0)):length() / (alpha * duration), 1e-10
end)
expect_always("place, relative", function()
	local wanted = vec3(a * time() ^ 2 / 2, 0, radius)
	return (verify.position(ball) - wanted):length() / (a * duration ^ 2 / 2), 1e-10 + verify.rounding / (a * duration ^ 2 / 2)
end)
