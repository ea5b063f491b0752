-- A ball that loses nothing bounces from 5 m (S1 of the comparisons with other engines).
local g, radius = 9.81, 0.5

world { title = "Elastic bounces", duration = 10, frame_rate = 100, time_step = 0.01, gravity = {0, 0, -g} }
local hard = material { name = "hard", friction = 0, restitution = 1 }
plane { normal = {0, 0, 1}, material = hard }
local ball = sphere { radius = radius, material = hard, position = {0, 0, 5 + radius} }
local worst, last = 0, 0
on_frame(function()
	last = math.abs((ball.velocity.z ^ 2 / 2 + g * (ball.position.z - radius)) / (5 * g) - 1)
	worst = math.max(worst, last)
end)
result("largest relative energy error", function() return worst end)
result("relative energy error at the end", function() return last end)
