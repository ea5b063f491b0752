-- A ball with its centre of mass off the middle is pushed at its middle for a tenth of a second.
-- Watch: the push has an arm, so the ball turns, and its middle circles round the centre of mass as it flies.
-- Expected end: the centre of mass at F t/m, angular velocity r x F t/I, both kept for ever.
-- The force is given in object coordinates: the point turns with the body, the direction does not.
-- Try: --param offset=0
local offset = param("offset", 0.05, "of the centre of mass along y, m", {min = -0.09, max = 0.09})
local radius, mass, newton, push, duration, dt = 0.1, 2, 10, 0.1, 3, 1 / 480

world { title = "Off its centre of mass", duration = duration, frame_rate = 60, time_step = dt }
local ball = sphere { name = "ball", radius = radius, mass = mass, center_of_mass = {0, offset, 0},
	forces = { { vector = {newton, 0, 0}, point = {0, 0, 0}, duration = push } } }
camera { name = "main", position = {1, -3, 1}, look_at = ball, size = {1280, 720} }

local v = newton * push / mass
expect("momentum is the impulse", function() return math.abs(ball.velocity.x - v) / v, 1e-12 end)
-- The arm -offset turns away by at most w push / 2 while the force acts: second order. The classic method adds first
-- order in dt; located, the torque that turns with the body is integrated to rounding.
expect("it turns at r x F t / I", function()
	local inertia = 0.4 * mass * radius ^ 2
	local w = offset * newton * push / inertia
	return math.abs(ball.angular_velocity.z - w), math.abs(w) * ((w * push) ^ 2 / 6 + math.abs(w) * dt) + 1e-12
end)
expect("nothing else turns", function()
	return math.abs(ball.angular_velocity.x) + math.abs(ball.angular_velocity.y), 1e-12
end)
