-- A torque spins a ball of 19 kg and 2.5 cm up from rest, at 3 rad/s^2 for 2 s.
-- Watch: the point above the middle goes round; its acceleration points ever more to the middle.
-- Expected end: turned by 6 rad, at 6 rad/s; the point at (0, 0.025, 0) m has v = (-0.15, 0, 0), a = (-0.075, -0.9, 0).
-- a = alpha x r + omega x (omega x r): 0.075 along the way, and 0.9 = 36 * 0.025 to the middle.
-- Try: --param alpha=30
-- Takes: less than a second.
local alpha = param("alpha", 3.0, "rad/s^2", {min = 0, max = 100})
local r, mass, seconds = 0.025, 19, 2
world { title = "Spun up", duration = seconds, frame_rate = 60 }
local ball = sphere { name = "ball", radius = r, mass = mass, forces = {{torque = {0, 0, alpha * 0.4 * mass * r * r}}} }
camera { name = "above", position = {0, -0.06, 0.12}, look_at = ball, size = {1280, 720}, overlay = {"title", "time"} }

-- The point of the ball that is there now: turned back into its own coordinates.
local turned, w = alpha * seconds ^ 2 / 2, alpha * seconds
local above = {r * math.sin(turned), r * math.cos(turned), 0}
expect("it has turned by alpha t^2 / 2", function()
	local q = ball.orientation
	return math.min(math.abs(q[1] - math.cos(turned / 2)), math.abs(q[1] + math.cos(turned / 2))) +
		math.min(math.abs(q[4] - math.sin(turned / 2)), math.abs(q[4] + math.sin(turned / 2))), 1e-9
end)
expect("it turns at alpha t, rad/s", function() return (ball.angular_velocity - vec3(0, 0, w)):length(), 1e-9 end)
expect("it still speeds up, rad/s^2", function() return (ball.angular_acceleration - vec3(0, 0, alpha)):length(), 1e-12 * (1 + alpha) end)
expect("the point is there, m", function() return (ball.point(above) - vec3(0, r, 0)):length(), 1e-9 end)
expect("its velocity, m/s", function() return (ball:point_velocity(above) - vec3(-r * w, 0, 0)):length(), 1e-9 end)
expect("its acceleration, m/s^2", function() return (ball:point_acceleration(above) - vec3(-r * alpha, -r * w * w, 0)):length(), 1e-9 * (1 + w * w) end)
