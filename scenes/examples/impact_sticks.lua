-- A ball of 19 kg and 2.5 cm flies onto a floor at (-1, -2) m/s and bounces without loss, with friction 0.25.
-- Watch: it comes in without spin and leaves with it; the point that touches stands still for a moment.
-- Expected end: it leaves at (-5/7, 2) m/s and turns at 28.571 rad/s.
-- To stop the point below takes 2/7 m v = 5.43 N s along the floor; friction gives up to mu * 2 m v = 19 N s: enough.
-- Try: --param mu=0.05 (too little to stop it: it leaves sliding)
-- Takes: less than a second.
local mu = param("mu", 0.25, "friction", {min = 0, max = 1})
local mass, r, vx, vz = 19, 0.025, -1, -2
world { title = "An impact that sticks", duration = 0.2, frame_rate = 60, time_step = 1 / 1920 }
local floor = material { name = "floor", friction = mu, restitution = 1 }
plane { normal = {0, 0, 1}, material = floor, texture = "checker" }
local ball = sphere { name = "ball", radius = r, mass = mass, position = {0.1, 0, r + 0.2}, velocity = {vx, 0, vz}, material = floor }
camera { name = "side", position = {0, -0.8, 0.15}, look_at = {0, 0, 0.1}, size = {1280, 720}, speed = 0.1, overlay = {"title", "time"} }

local limit, needed = mu * 2 * mass * -vz, 2 / 7 * mass * math.abs(vx)
local along = math.min(limit, needed)
local speed, spin = vx + along / mass, -along * r / (0.4 * mass * r * r)
state.count, state.along, state.up = 0, 0, 0
on_collision(function(c)
	state.count = state.count + 1
	state.up, state.along = math.abs(c.impulse.z), math.abs(c.impulse.x)
end)
expect("it has bounced once", function() return state.count == 1 end)
expect("by 2 m v, N s", function() return math.abs(state.up - 2 * mass * -vz), 1e-9 * limit end)
expect("friction has given what it takes, N s", function() return math.abs(state.along - along), 1e-9 * limit end)
expect("it leaves at (-5/7, 2), m/s", function() return (ball.velocity - vec3(speed, 0, -vz)):length(), 1e-9 end)
expect("it turns at 28.571, rad/s", function() return (ball.angular_velocity - vec3(0, spin, 0)):length(), 1e-9 * 28.571 end)
