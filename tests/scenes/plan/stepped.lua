-- Steps with a spring and a driven floor: drag, fields and callbacks are left out.
world { duration = 0.5, frame_rate = 10, time_step = 0.01, gravity = {0, 0, -9.81}, method = "stepped" }
plane { motion = function(t) return vec3(0, 0, 0.1 * t) end }
local hook = sphere { radius = 0.1, position = {0, 0, 4}, static = true }
local load = box { size = {1, 1, 1}, position = {0, 0, 1.5} }
spring { a = hook, b = load, stiffness = 100 }
