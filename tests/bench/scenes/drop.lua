-- scenes/bounce.lua up to the second fall: one moment of a bouncing ball against its closed form.
-- The error is of first order in the time step: the fall is g dt/2 too fast, and so is what comes of it.
local e, g, h, radius, at = 0.8, 9.81, 1.9, 0.1, 1

world { title = "One bounce", duration = at, frame_rate = 60, gravity = {0, 0, -g} }
local rubber = material { name = "rubber", density = 1100, friction = 0.6, restitution = e }
plane { normal = {0, 0, 1}, material = rubber }
local ball = sphere { name = "ball", radius = radius, position = {0, 0, radius + h}, material = rubber }

expect("height after the first bounce", function()
	local t = at - math.sqrt(2 * h / g)
	return math.abs(ball.position.z - radius - e * math.sqrt(2 * g * h) * t + g * t * t / 2),
		2 * math.sqrt(2 * g * h) / 240
end)
