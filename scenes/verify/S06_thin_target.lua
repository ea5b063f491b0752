-- SPDX-License-Identifier: MIT
-- S06: ten thousand spheres of 1 mm at 10 km/s, five hundred a run, each on its own plate without thickness, in random
-- directions. Answer: every one is reflected, at its time.
local verify = require "rbsim.verify"
local shots = require "shots"
local batch = param("batch", 1, "which twentieth of them", {choices = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16,
	17, 18, 19, 20}})
math.randomseed(batch)

verify.case { title = "Ten kilometres per second at a thin plate", duration = 1 / 60, time_step = {1 / 60, 1e-3, 1e-5},
	frame_rate = {60, 1, 200}, quick = "more", length = 256 }
local steel = material { name = "steel", density = 7800, friction = 0, restitution = 0.5 }

shots.fire { count = 500, speed = 1e4, restitution = 0.5, material = steel, target = function(centre, normal)
	verify.plane { normal = normal, point = centre, size = {0.5, 0.5}, axis = math.abs(normal.x) < 0.9 and {1, 0, 0} or {0, 1, 0},
		material = steel }
end }
