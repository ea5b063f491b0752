-- SPDX-License-Identifier: MIT
-- S02: a ball that loses nothing bounces a thousand times. Answer: energy stays, impact k is at (2k - 1) sqrt(2 h/g).
local verify = require "rbsim.verify"
local g, radius, h = 9.81, 0.1, 4.9
local fall = math.sqrt(2 * h / g)

verify.case { title = "A thousand elastic bounces", duration = 2000 * fall, gravity = {0, 0, -g},
	time_step = {0.01, 1e-4, 0.1}, frame_rate = {1, 10, 7}, quick = "more" }
local hard = material { name = "hard", friction = 0, restitution = 1 }
verify.plane { material = hard }
local ball = verify.sphere { name = "ball", radius = radius, position = {0, 0, 5}, material = hard }

state.count, state.late = 0, 0
on_collision(function(c)
	state.count = state.count + 1
	state.late = verify.larger(state.late, math.abs(c.time - (2 * state.count - 1) * fall))
end)

-- A drop height that is rounded by d moves impact k by (2k - 1) fall d/(2h).
expect("every impact is in time, s", function() return state.late, 1e-9 + 2000 * fall / (2 * h) * verify.rounding end)
expect("a thousand impacts", function() return math.abs(state.count - 1000), 0 end)
expect_always("energy is kept, relative", function()
	local e = verify.velocity(ball):dot(verify.velocity(ball)) / 2 + g * (verify.position(ball).z - radius)
	return math.abs(e / (g * h) - 1), 1e-11 + 2 * verify.rounding / h
end)
