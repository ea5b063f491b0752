-- SPDX-License-Identifier: MIT
-- S06: two thousand spheres of 1 mm at 10 km/s, five hundred a run, each on a static box 1 mm thick, in random directions; a
-- step of 1/60 s is 167 m. Answer: every one is reflected, at its time.
local verify = require "rbsim.verify"
local shots = require "shots"
local batch = param("batch", 1, "which quarter of them", {choices = {1, 2, 3, 4}})
math.randomseed(batch)

verify.case { title = "Ten kilometres per second at a thin box", duration = 1 / 60, time_step = {1 / 60, 1e-3, 1e-5},
	frame_rate = {60, 1, 200}, quick = "base", length = 256 }
local steel = material { name = "steel", density = 7800, friction = 0, restitution = 0.5 }

-- The turn that takes z to n or to -n, the box being the same: about z x n.
local function orientation(n)
	if n.z < 0 then n = -n end
	local half = math.sqrt((1 + n.z) / 2)
	return {half, -n.y / (2 * half), n.x / (2 * half), 0}
end
shots.fire { count = 500, thick = 1e-3, speed = 1e4, restitution = 0.5, material = steel, target = function(centre, normal)
	verify.box { size = {0.5, 0.5, 1e-3}, position = centre, orientation = orientation(normal), static = true, material = steel }
end }
