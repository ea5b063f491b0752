-- A ball with its centre of mass off the middle is pushed at its middle for a tenth of a second.
-- Watch: the push has an arm, so the ball turns, and its middle circles round the centre of mass as it flies.
-- Expected end: the centre of mass at F t/m, the angular velocity that the turning arm has left, both kept for ever.
-- The force is given in object coordinates: the point turns with the body, the direction does not.
-- Try: --param offset=0
-- Takes: less than a second.
local offset = param("offset", 0.05, "of the centre of mass along y, m", {min = -0.09, max = 0.09})
local radius, mass, newton, push, duration = 0.1, 2, 10, 0.1, 3

world { title = "Off its centre of mass", duration = duration, frame_rate = 60 }
local ball = sphere { name = "ball", radius = radius, mass = mass, center_of_mass = {0, offset, 0},
	forces = { { vector = {newton, 0, 0}, point = {0, 0, 0}, duration = push } } }
camera { name = "main", position = {1, -3, 1}, look_at = ball, size = {1280, 720} }

local v = newton * push / mass
expect("momentum is the impulse", function() return math.abs(ball.velocity.x - v) / v, 1e-12 end)
-- The arm turns with the body: a'' = (offset F/I) cos a, here by Runge and Kutta's fourth order in steps of 0.1 ms.
expect("it turns as its arm lets it, rad/s", function()
	local k, steps = offset * newton / (0.4 * mass * radius ^ 2), 1000
	local h, a, w = push / steps, 0, 0
	for _ = 1, steps do
		local w1, k1 = w, k * math.cos(a)
		local w2, k2 = w + h / 2 * k1, k * math.cos(a + h / 2 * w1)
		local w3, k3 = w + h / 2 * k2, k * math.cos(a + h / 2 * w2)
		local w4, k4 = w + h * k3, k * math.cos(a + h * w3)
		a, w = a + h / 6 * (w1 + 2 * w2 + 2 * w3 + w4), w + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
	end
	return math.abs(ball.angular_velocity.z - w), 1e-9
end)
expect("nothing else turns", function()
	return math.abs(ball.angular_velocity.x) + math.abs(ball.angular_velocity.y), 1e-12
end)
