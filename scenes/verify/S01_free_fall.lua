-- SPDX-License-Identifier: MIT
-- S01: a sphere thrown without anything to meet. Answer: the parabola, at any time step.
local verify = require "rbsim.verify"
local g, v0 = 9.81, vec3(3, 0, 4)
local dt = param("dt", 0.1, "longest step, s", {choices = {1e-9, 1e-6, 1e-3, 1 / 60, 0.1, 1.0}})
local duration = dt == 1e-9 and 1e-4 or dt == 1e-6 and 0.1 or 10

verify.case { title = "Free fall at any step", duration = duration, gravity = {0, 0, -g}, time_step = {dt},
	frame_rate = {1, 10, 30}, quick = "more", length = 8,
	leave_out = {time_step = "it is this case's own parameter, from 1e-9 s to 1 s"} }
local ball = verify.sphere { name = "ball", radius = 0.1, velocity = v0 }

local function exact(t) return t * v0 - vec3(0, 0, g * t * t / 2) end
reference(function(t) return {ball = {position = verify.point(exact(t)), velocity = verify.vector(v0 - vec3(0, 0, g * t))}} end)

-- Relative to the length of the path; the bar has 2.2e-16 for each step that a method takes.
local length = exact(duration):length()
local bar = 1e-13 + duration / dt * verify.u
expect_always("the position is on the parabola", function()
	return (verify.position(ball) - exact(time())):length() / length, bar + verify.rounding / length
end)
expect_always("the velocity is that of the parabola", function()
	local v = v0 - vec3(0, 0, g * time())
	return (verify.velocity(ball) - v):length() / v0:length(), bar * (1 + g * duration / v0:length())
end)
