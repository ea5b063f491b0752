-- SPDX-License-Identifier: MIT
-- G02: three equal masses chase each other on one eight. Answer: the choreography of Chenciner and Montgomery (Ann. of
-- Math. 152 (2000) 881); from the eight decimals below, after ten periods, integrated with 30 digits.
local verify = require "rbsim.verify"
local duration = 63.2591398

verify.case { title = "Figure eight", duration = duration, time_step = {0.1, 0.01, 1}, frame_rate = {1, 0.1, 7},
	gravitation = {G = 1}, quick = "more" }
local plain = material { name = "plain", friction = 0 }
local x, v = vec3(0.97000436, -0.24308753, 0), vec3(-0.93240737, -0.86473146, 0)
local function point(position, velocity)
	return verify.sphere { radius = 1e-3, mass = 1, material = plain, position = position, velocity = velocity }
end
local first = point(x, -0.5 * v)
point(-1 * x, -0.5 * v)
point(vec3(0, 0, 0), v)
-- the eight is stable: errors grow in proportion to time, here by 2e3
expect("place after ten periods, m", function()
	return (verify.position(first) - vec3(0.97000421375646, -0.24308766531606, 0)):length(), 1e-12 + 2e3 * verify.rounding
end)
