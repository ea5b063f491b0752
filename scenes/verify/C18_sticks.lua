-- SPDX-License-Identifier: MIT
-- C18: what stands on a turntable, nine tenths of the way to where friction no longer holds it. Answer: it stays where it is on the
-- table, by either method and any step.
local verify = require "rbsim.verify"
local way = param("way", "located", "method", {choices = {"located", "stepped"}})
local shape = param("shape", "box", "what stands on it", {choices = {"box", "cylinder"}})
local g, mu, W, size = 9.81, 0.5, 2, 0.1
local far = 0.9 * mu * g / (W * W)

verify.case { title = "What sticks", duration = 10, gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 0.02}, method = way,
	frame_rate = {10, 1, 7}, quick = "base" }
local stuff = material { name = "stuff", friction = mu, restitution = 0 }
verify.box { size = {4, 4, size}, material = stuff, motion = function(t)
	return {0, 0, -size / 2}, {math.cos(W * t / 2), 0, 0, math.sin(W * t / 2)}, vec3(0, 0, 0), vec3(0, 0, W)
end }
local keys = {mass = 1, material = stuff, position = {far, 0, size / 2}, velocity = {0, W * far, 0}, angular_velocity = {0, 0, W}}
if shape == "box" then keys.size = {2 * size, 1.5 * size, size} else keys.radius, keys.length = size, size end
local body = verify[shape](keys)

expect_always("place, of the radius", function()
	local there = vec3(far * math.cos(W * time()), far * math.sin(W * time()), size / 2)
	return (verify.position(body) - there):length() / far, 1e-9 + 64 * verify.rounding
end)
expect_always("how it is turned, rad", function()
	local c, s = math.cos(W * time()), math.sin(W * time())
	return (verify.axes(body) - vec3(c, s, 0)):length(), 1e-9 + 64 * verify.rounding
end)
