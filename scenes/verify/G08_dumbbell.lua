-- SPDX-License-Identifier: MIT
-- G08: two spheres in contact turn about each other as one. Answer: they press with G m1 m2/s^2 - m s omega^2, m the reduced
-- mass; from omega^2 = G M/s^3 on they fly apart at once, on the Kepler orbit of which s is the smallest distance.
local verify = require "rbsim.verify"
local share = param("share", "half", "of omega^2 = G M/s^3", {choices = {"half", "most", "above"}})
local omega2 = ({half = 0.5, most = 0.99, above = 1.21})[share]
local omega = math.sqrt(omega2)
local a = 1 / (2 - omega2) -- of the orbit
local unit = share == "above" and 2 * math.pi * a ^ 1.5 or 2 * math.pi / omega

verify.case { title = "Dumbbell", duration = share == "above" and 1 or 3, time_unit = unit, time_step = {0.05, 0.01, 1},
	frame_rate = {8, 1, 3}, gravitation = {G = 1}, quick = "more" }
local stone = material { name = "stone", friction = 0.5 }
local function ball(x)
	return verify.sphere { radius = 0.5, mass = 0.5, position = vec3(x, 0, 0), velocity = vec3(0, x * omega, 0),
		angular_velocity = vec3(0, 0, omega), material = stone }
end
local left, right = ball(-0.5), ball(0.5)
local function between() return verify.position(right) - verify.position(left) end
if share == "above" then
	expect("after a turn, the smallest distance, m", function() return math.abs(between():length() - 1), 1e-11 + 1e2 * verify.rounding end)
	local most -- where a frame is half way
	on_frame(function(t)
		if math.abs(t / unit - 0.5) < 1e-9 then most = between():length() end
	end)
	expect("apart as on the orbit, m", function()
		return most and math.abs(most - (2 * a - 1)) or 0, 1e-11 + 1e2 * verify.rounding
	end)
	expect("spin as it was, rad/s", function() return math.abs(verify.spin(left).z - omega), 1e-11 + 10 * verify.rounding end)
else
	local gap, off, press = 0, 0, 0
	on_frame(function(t)
		local d = between()
		gap = verify.larger(gap, math.abs(d:length() - 1))
		off = verify.larger(off, (d - vec3(math.cos(omega * t), math.sin(omega * t), 0)):length())
		-- the sum of what acts turns it; what gravitation does, less that, is the contact's
		local inward = -verify.back_vector(right.force):dot(d)
		press = verify.larger(press, math.abs((0.25 - inward) - (0.25 - 0.25 * omega2)))
	end)
	expect("gap, m", function() return gap, 2 ^ -50 + 4 * verify.rounding end)
	expect("it turns as one, m", function() return off, 1e-12 + 1e2 * verify.rounding end)
	expect("force of the contact, N", function() return press, 1e-12 + 10 * verify.rounding end)
end
