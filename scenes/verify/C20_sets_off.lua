-- SPDX-License-Identifier: MIT
-- C20: a box on a floor that speeds up and turns faster than friction can follow: from no slip at all, four corners slip in
-- four directions that turn. Answer: corners' equations (loads of the least squares) by an 8th order method at 3e-14.
local verify = require "rbsim.verify"
local case = param("case", 1, "floor and box", {choices = {1, 2, 3}})
local mirror = param("mirror", 1, "of y", {choices = {1, -1}})
-- size, friction, place; acceleration of the floor along x and y, about z; then, after 0.3 s, x, y, angle and their rates
local cases = {
	{{0.3, 0.2, 0.1}, 0.2, {0.5, 0.1}, {0, 0, 8}, {0.48021458230571, 0.183917758804117, 0.175525924380624, -0.154536501938698, 0.552822770779092, 1.16781010573071}},
	{{0.3, 0.2, 0.02}, 0.2, {0.4, -0.2}, {1, 2, 10}, {0.439941981129819, -0.122634088608246, 0.147883765267036, 0.268533068603671, 0.514495637027933, 1.00243807868518}},
	{{0.1, 0.2, 0.05}, 0.35, {-0.6, 0.3}, {0, 1, -9}, {-0.535755778872152, 0.439657890477481, -0.273564168880005, 0.461900079252876, 0.913385628648208, -1.83423154574938}},
}
local size, mu, place, speeds_up, answer = table.unpack(cases[case])
local ax, ay, turn = speeds_up[1], mirror * speeds_up[2], mirror * speeds_up[3]

verify.case { title = "A box sets off on a floor", duration = 0.3, gravity = {0, 0, -9.8}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {10, 100, 70}, quick = "base" }
local stuff = material { name = "stuff", friction = mu, restitution = 0 }
verify.plane { material = stuff, motion = function(t)
	local half = turn * t * t / 4
	return {ax * t * t / 2, ay * t * t / 2, 0}, {math.cos(half), 0, 0, math.sin(half)}, vec3(ax * t, ay * t, 0), vec3(0, 0, turn * t)
end }
local block = verify.box { mass = 1, size = size, material = stuff, position = {place[1], mirror * place[2], size[3] / 2} }

expect("place, m", function()
	return (verify.position(block) - vec3(answer[1], mirror * answer[2], size[3] / 2)):length(), 1e-9 + 64 * verify.rounding
end)
expect("velocity, m/s", function()
	return (verify.velocity(block) - vec3(answer[4], mirror * answer[5], 0)):length(), 1e-9 + 64 * verify.rounding
end)
expect("spin, rad/s", function()
	return (verify.spin(block) - vec3(0, 0, mirror * answer[6])):length(), 1e-9 + 64 * verify.rounding
end)
