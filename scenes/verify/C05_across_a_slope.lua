-- SPDX-License-Identifier: MIT
-- C05: a flat box on a slope starts straight across it. Answer: with phi its heading from downhill, u = tan(phi/2) and
-- k = mu/tan(slope), v = v0 u^(k - 1) (1 + u^2)/2, and all that follows by integrals of powers of u; it stops if k > 1.
local verify = require "rbsim.verify"
local slope = param("slope", 20, "degrees", {choices = {20, 35}})
local g, v0, k, size = 9.81, 2, 1.375, {0.2, 0.2, 0.05}
local sin, cos = math.sin(deg(slope)), math.cos(deg(slope))

-- Time and place since u was 1, from dt = -v dphi/(g sin(slope) sin(phi)).
local function from_start(u)
	local scale = v0 / (2 * g * sin)
	local function power(n) return (1 - u ^ n) / n end
	return scale * (power(k - 1) + power(k + 1)),
		v0 * scale / 2 * (power(2 * k - 2) - power(2 * k + 2)), v0 * scale * (power(2 * k - 1) + power(2 * k + 1))
end
local stops, far, aside = from_start(0)

verify.case { title = "Across a slope", duration = stops + 0.25, gravity = {g * sin, 0, -g * cos}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {10, 1, 60}, quick = "more" }
local stuff = material { name = "stuff", friction = k * sin / cos, restitution = 0 }
verify.plane { material = stuff }
local box = verify.box { name = "box", size = size, position = {0, 0, size[3] / 2}, velocity = {0, v0, 0}, material = stuff }

local function exact(t)
	if t >= stops then return vec3(far, aside, 0) end
	local low, high = 0, 1 -- u falls from 1 to 0
	for _ = 1, 200 do
		local u = (low + high) / 2
		if from_start(u) < t then high = u else low = u end
	end
	local _, x, y = from_start((low + high) / 2)
	return vec3(x, y, 0)
end
local way = vec3(far, aside, 0):length()
expect_always("place, relative", function()
	return (verify.position(box) - vec3(0, 0, size[3] / 2) - exact(time())):length() / way, 1e-9 + verify.rounding / way
end)
-- The last of the way goes as u^(2k - 2): a stop that is found where the speed is lost in rounding is short by little.
on_transition(function(c)
	if c.kind == "rest" then state.rest = state.rest or c.time end
end)
expect("it stops in time, relative", function() return math.abs((state.rest or 0) / stops - 1), 1e-6 end)
expect("it does not turn, rad", function() return verify.tilt(box), 1e-9 end)
