-- SPDX-License-Identifier: MIT
-- C19: a plank on two rollers that turn inwards, at four corners of which only three are determined. Answer: x'' = -mu g
-- x/(D - mu c), c half its thickness, 2 D between the rollers; it does not turn, nor go aside.
local verify = require "rbsim.verify"
local shape = param("shape", "box", "what lies on them", {choices = {"box", "capsule"}})
local wide = param("wide", 0.2, "width of the plank, m", {choices = {0.2, 0.03}})
local way = param("way", "located", "method", {choices = {"located", "stepped"}})
local g, mu, D, R, W, c, x0 = 9.81, 0.3, 0.5, 0.1, 20, 0.025, 0.1
local w = math.sqrt(mu * g / (D - mu * c))

verify.case { title = "A plank on rollers", duration = 5, gravity = {0, 0, -g}, method = way,
	time_step = {0.01, 1e-3, 0.005}, frame_rate = {10, 1, 7}, quick = "base" }
-- Steps are off by the first order of the longest step, and turn by what their solver leaves.
local bound, turns = 1e-9, 1e-9
if way == "stepped" then bound, turns = 0.02, 1e-3 end
local stuff = material { name = "stuff", friction = mu, restitution = 0 }
for side = -1, 1, 2 do
	-- the cylinder's axis along y, then a turn about it
	local h, spin = math.sqrt(0.5), -side * W
	verify.cylinder { radius = R, length = 0.6, material = stuff, motion = function(t)
		local cos, sin = math.cos(spin * t / 2), math.sin(spin * t / 2)
		return {side * D, 0, -R}, {cos * h, cos * h, sin * h, -sin * h}, vec3(0, 0, 0), vec3(0, spin, 0)
	end }
end
local keys = {mass = 1, material = stuff, position = {x0, 0, c}}
if shape == "box" then keys.size = {2, wide, 2 * c}
else keys.radius, keys.length, keys.orientation = c, 2, {axis = {0, 1, 0}, angle = deg(90)} end
local plank = verify[shape](keys)

expect_always("place, of the swing", function()
	return (verify.position(plank) - vec3(x0 * math.cos(w * time()), 0, c)):length() / x0, bound + 64 * verify.rounding
end)
expect_always("velocity, relative", function()
	return (verify.velocity(plank) - vec3(-x0 * w * math.sin(w * time()), 0, 0)):length() / (x0 * w), bound + 64 * verify.rounding
end)
expect_always("it does not turn, rad/s", function() return verify.spin(plank):length(), turns + 64 * verify.rounding end)
