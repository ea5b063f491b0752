-- SPDX-License-Identifier: MIT
-- C20: a box on a floor that speeds up and turns faster than friction can follow: from no slip at all, four corners slip in
-- four directions that turn. Answer: corners' equations (loads of the least squares) by an 8th order method at 3e-14.
-- Or on one whose acceleration (a t, b t^2) grows past friction: slip, and what speeds it up, begin at nothing, in a direction that
-- turns. Answer: x'' = -mu g (x - X)'/|(x - X)'|, by its power series at the onset and then to 30 digits.
local verify = require "rbsim.verify"
local case = param("case", 1, "floor and box", {choices = {1, 2, 3, 4, 5, 6}})
local mirror = param("mirror", 1, "of y", {choices = {1, -1}})
-- size, friction, place; acceleration of the floor along x and y, about z; then, after 0.3 s, x, y, angle and their rates
local cases = {
	{{0.3, 0.2, 0.1}, 0.2, {0.5, 0.1}, {0, 0, 8}, {0.48021458230571, 0.183917758804117, 0.175525924380624, -0.154536501938698, 0.552822770779092, 1.16781010573071}},
	{{0.3, 0.2, 0.02}, 0.2, {0.4, -0.2}, {1, 2, 10}, {0.439941981129819, -0.122634088608246, 0.147883765267036, 0.268533068603671, 0.514495637027933, 1.00243807868518}},
	{{0.1, 0.2, 0.05}, 0.35, {-0.6, 0.3}, {0, 1, -9}, {-0.535755778872152, 0.439657890477481, -0.273564168880005, 0.461900079252876, 0.913385628648208, -1.83423154574938}},
	{{0.3, 0.2, 0.1}, 0.1, {0, 0}, {0, 0, 0}, {0.1121494487899258, 0.02149921382013679, 0, 0.4535512956193053, 0.1118221133583609, 0}, grows = {4, 3}, about = 0, ends = 0.6},
	{{0.3, 0.2, 0.03}, 0.1, {0, 0}, {0, 0, 0}, {0.0123489467447084, -0.02191630494005555, 0, 0.08937259239204381, -0.1998104155889057, 0}, grows = {4, -60}, about = 1, ends = 0.3},
	{{0.1, 0.2, 0.3}, 0.05, {0, 0}, {0, 0, 0}, {0.01545215996690339, 0.02859619446584384, 0, 0.06925366249653527, 0.1612908313758816, 0}, grows = {1, 9}, about = -2.2, ends = 0.5},
}
local own = cases[case]
local size, mu, place, speeds_up, answer = table.unpack(own)
local ax, ay, turn = speeds_up[1], mirror * speeds_up[2], mirror * speeds_up[3]
local gx, gy = table.unpack(own.grows or {0, 0})
-- all of it is turned about z
local c, s = math.cos(own.about or 0), math.sin(own.about or 0)
local function about(x, y, z) return vec3(c * x - s * y, s * x + c * y, z) end

verify.case { title = "A box sets off on a floor", duration = own.ends or 0.3, gravity = {0, 0, -9.8}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {10, 100, 70}, quick = "base" }
local stuff = material { name = "stuff", friction = mu, restitution = 0 }
verify.plane { material = stuff, motion = function(t)
	local half = turn * t * t / 4
	return about(ax * t ^ 2 / 2 + gx * t ^ 3 / 6, ay * t ^ 2 / 2 + mirror * gy * t ^ 4 / 12, 0), {math.cos(half), 0, 0, math.sin(half)},
		about(ax * t + gx * t ^ 2 / 2, ay * t + mirror * gy * t ^ 3 / 3, 0), vec3(0, 0, turn * t)
end }
local block = verify.box { mass = 1, size = size, material = stuff, position = {place[1], mirror * place[2], size[3] / 2} }

expect("place, m", function()
	return (verify.position(block) - about(answer[1], mirror * answer[2], size[3] / 2)):length(), 1e-9 + 64 * verify.rounding
end)
expect("velocity, m/s", function()
	return (verify.velocity(block) - about(answer[4], mirror * answer[5], 0)):length(), 1e-9 + 64 * verify.rounding
end)
expect("spin, rad/s", function()
	return (verify.spin(block) - vec3(0, 0, mirror * answer[6])):length(), 1e-9 + 64 * verify.rounding
end)
