-- SPDX-License-Identifier: MIT
-- S28: a flat box on a slope of 89 degrees with a friction coefficient of a million. Answer: it holds; it is a hundred times
-- wider than high, so that it does not tip either.
local verify = require "rbsim.verify"
local g, slope, size = 9.81, deg(89), {1, 1, 0.01}

verify.case { title = "A box on a wall", duration = 100, gravity = {g * math.sin(slope), 0, -g * math.cos(slope)},
	time_step = {0.1, 0.01, 1}, frame_rate = {1, 10, 0.3}, quick = "more" }
local rough = material { name = "rough", friction = 1e6, restitution = 0 }
verify.plane { material = rough }
local box = verify.box { name = "box", size = size, position = {0, 0, size[3] / 2}, material = rough }

expect_always("it stays, m", function()
	return (verify.position(box) - vec3(0, 0, size[3] / 2)):length(), 1e-12 + verify.rounding
end)
expect_always("it does not turn, rad", function() return verify.tilt(box), 1e-12 end)
