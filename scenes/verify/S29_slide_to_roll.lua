-- SPDX-License-Identifier: MIT
-- S29: a solid sphere slides, with spin or backspin, on a floor or down a slope, until it rolls. Answer: with u = v - R w,
-- u' = g sin - 3.5 mu g cos sgn(u) while it slides, a = 5/7 g sin when it rolls.
local verify = require "rbsim.verify"
local slope = param("slope", 0, "degrees", {choices = {0, 20}})
local spin = param("spin", 0.0, "at the start, rad/s; positive rolls on", {choices = {0.0, -60.0, 60.0}})
local g, mu, radius, v0, duration = 9.81, 0.3, 0.1, 2, 4
local sin, cos = math.sin(deg(slope)), math.cos(deg(slope))

verify.case { title = "From sliding to rolling", duration = duration, gravity = {g * sin, 0, -g * cos},
	time_step = {0.01, 1e-4, 0.1}, frame_rate = {10, 1, 7}, quick = "more" }
local rubber = material { name = "rubber", friction = mu, restitution = 0 }
verify.plane { material = rubber }
local ball = verify.sphere { name = "ball", radius = radius, position = {0, 0, radius}, velocity = {v0, 0, 0},
	angular_velocity = {0, spin, 0}, material = rubber }

local slip = v0 - radius * spin
local rub = mu * g * cos * (slip > 0 and 1 or -1)
local rolls = slip / (3.5 * rub - g * sin)
local a = g * sin - rub
local x_rolls, v_rolls = v0 * rolls + a * rolls ^ 2 / 2, v0 + a * rolls
local function exact(t)
	if t <= rolls then return v0 * t + a * t * t / 2, v0 + a * t, spin + 2.5 * rub / radius * t end
	local s, down = t - rolls, 5 / 7 * g * sin
	return x_rolls + v_rolls * s + down * s * s / 2, v_rolls + down * s, (v_rolls + down * s) / radius
end

on_transition(function(c)
	if c.kind == "roll" then state.rolls = state.rolls or c.time end
end)
expect("it rolls in time, relative", function() return math.abs((state.rolls or 0) / rolls - 1), 1e-10 end)
local x_end, v_end = exact(duration)
local far, fast = math.abs(x_end) + v0 * rolls, math.abs(v_end) + v0
expect_always("place, relative", function()
	local x = exact(time())
	return (verify.position(ball) - vec3(x, 0, radius)):length() / far, 1e-10 + verify.rounding / far
end)
expect_always("velocity, relative", function()
	local _, v = exact(time())
	return (verify.velocity(ball) - vec3(v, 0, 0)):length() / fast, 1e-10
end)
expect_always("spin, relative", function()
	local _, _, w = exact(time())
	return radius * (verify.spin(ball) - vec3(0, w, 0)):length() / fast, 1e-10
end)
