-- A force of 27.6 N pulls for a tenth of a second along the rim of a ball of 19 kg and 2.5 cm that floats freely.
-- Watch: the ball moves off and turns; the force acts where the rim is highest, whatever has turned there.
-- Expected end: the torque is 27.6 N * 0.025 m = 0.69 N m, while it acts.
-- The force moves the middle as if it acted there, whichever point it pulls at: 27.6 / 19 m/s^2.
-- Try: --param force=1
-- Takes: less than a second.
local force = param("force", 27.6, "N", {min = 0, max = 1000})
local mass, r, seconds = 19, 0.025, 0.1
world { title = "A pull at the rim", duration = seconds, frame_rate = 120, time_step = 1 / 960 }
local ball = sphere { name = "ball", radius = r, mass = mass }
camera { name = "side", position = {0.02, -0.2, 0.05}, look_at = {0.01, 0, 0}, size = {1280, 720}, speed = 0.1, overlay = {"title", "time"} }

-- At a point of the world: always the highest one.
on_step(function() ball:apply_force({force, 0, 0}, ball.position + vec3(0, 0, r)) end)
state.off = 0
on_frame(function(t)
	if t > 0 then state.off = math.max(state.off, (ball.torque - vec3(0, force * r, 0)):length()) end
end)
expect("its torque, N m", function() return state.off, 1e-12 * (0.69 + force * r) end)
expect("the force on it, N", function() return (ball.force - vec3(force, 0, 0)):length(), 1e-12 * (1 + force) end)
local inertia = 0.4 * mass * r * r
expect("it turns, rad/s", function()
	return math.abs(ball.angular_velocity.y - force * r / inertia * seconds), 1e-9 * (1 + force)
end)
expect("it moves, m/s", function() return math.abs(ball.velocity.x - force / mass * seconds), 1e-9 * (1 + force) end)
