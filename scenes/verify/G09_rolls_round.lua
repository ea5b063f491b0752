-- SPDX-License-Identifier: MIT
-- G09: a ball rolls without slip round a fixed one, which attracts it. Answer: its speed v and its spin v/r stay; it is pressed
-- with m (G M/s^2 - v^2/s), s the sum of radii; with v^2 >= G M/s it leaves at once, on the orbit of which s is the smallest
-- distance.
local verify = require "rbsim.verify"
local share = param("share", "slow", "of the speed at which it leaves", {choices = {"slow", "fast", "beyond"}})
local big, small, M, m = 2, 0.5, 7, 1
local s = big + small
local v = ({slow = 0.3, fast = 0.95, beyond = 1.1})[share] * math.sqrt(M / s)
local a = 1 / (2 / s - v * v / M)
local unit = share == "beyond" and 2 * math.pi * math.sqrt(a ^ 3 / M) or 2 * math.pi * s / v

verify.case { title = "Rolls round", duration = share == "beyond" and 1 or 10, time_unit = unit, time_step = {0.05, 0.01, 1},
	frame_rate = {8, 1, 3}, gravitation = {G = 1}, quick = "more", length = s }
local rough = material { name = "rough", friction = 1 }
verify.sphere { radius = big, static = true, gravitational_mass = M, material = rough }
local ball = verify.sphere { radius = small, mass = m, position = vec3(s, 0, 0), velocity = vec3(0, v, 0),
	angular_velocity = vec3(0, 0, v / small), material = rough }
if share == "beyond" then
	expect("back where it left, m", function()
		return (verify.position(ball) - vec3(s, 0, 0)):length(), 1e-10 + 1e3 * verify.rounding
	end)
else
	local speed, spin, press, gap = 0, 0, 0, 0
	on_frame(function(t)
		local x = verify.position(ball)
		speed = verify.larger(speed, math.abs(verify.velocity(ball):length() - v))
		spin = verify.larger(spin, math.abs(verify.spin(ball).z - v / small))
		gap = verify.larger(gap, math.abs(x:length() - s))
		local inward = -verify.back_vector(ball.force):dot(x) / s
		press = verify.larger(press, math.abs(inward - m * v * v / s))
	end)
	expect("speed, m/s", function() return speed, 1e-11 + 10 * verify.rounding end)
	expect("spin, rad/s", function() return spin, 1e-11 + 20 * verify.rounding end)
	expect("force of the contact, N", function() return press, 1e-11 + 10 * verify.rounding end)
	expect("gap, m", function() return gap, 2 ^ -48 + 4 * verify.rounding end)
end
