-- A ball slides over a smooth floor from (-5, 2.5, 0) m at (3, 0, -1) m/s; here y is up.
-- Watch: without friction nothing turns it and nothing slows it down.
-- Expected end: (1, 2.5, -2) m after 2 s.
-- Its weight is borne by the floor: what acts on it sums up to nothing, so it keeps its velocity.
-- Try: --param mu=0.3 (it then begins to roll, and gets less far)
-- Takes: less than a second.
local mu = param("mu", 0.0, "friction", {min = 0, max = 1})
world { title = "Straight on", duration = 2, frame_rate = 60, gravity = {0, -9.81, 0} }
local ice = material { name = "ice", friction = mu, restitution = 0 }
plane { normal = {0, 1, 0}, material = ice, texture = "checker" }
local ball = sphere { name = "ball", radius = 2.5, mass = 19, position = {-5, 2.5, 0}, velocity = {3, 0, -1}, material = ice }
camera { name = "side", position = {-2, 9, 22}, look_at = {-2, 2.5, -1}, up = {0, 1, 0}, size = {1280, 720}, overlay = {"title", "time"} }

if mu == 0 then
	expect("it has come to (1, 2.5, -2), m", function() return (ball.position - vec3(1, 2.5, -2)):length(), 1e-9 end)
	expect("at (3, 0, -1), m/s", function() return (ball.velocity - vec3(3, 0, -1)):length(), 1e-12 end)
	expect("nothing is left that acts, N", function() return ball.force:length(), 1e-9 * 19 * 9.81 end)
	expect("it does not turn", function() return ball.angular_velocity:length(), 0 end)
else
	expect("it has not come as far", function() return ball.position.x < 1 end)
end
