-- A heavy ball runs into a light one, and the light one into a wall, again and again.
-- Watch: the light ball rattles between heavy ball and wall and turns it round.
-- Expected end: as many impacts as pi has digits to show: floor(pi/atan(sqrt(m/M))), 31 for a ratio of 100.
-- Head-on impacts depend on velocities alone: classic steps count them right, too; located, their times are right.
-- Try: --param ratio=10000 (314)
-- Takes: less than a second.
local ratio = param("ratio", 100.0, "mass of the heavy ball over the light one's", {min = 1, max = 1e6})
local radius, v0 = 0.1, 1

world { title = "Counting pi", duration = 30, frame_rate = 60, time_step = 1 / 240, tolerance = 1e-9 }
local hard = material { name = "hard", friction = 0, restitution = 1 }
plane { normal = {1, 0, 0}, material = hard }
local light = sphere { name = "light", radius = radius, mass = 1, position = {2, 0, 0}, material = hard }
local heavy = sphere { name = "heavy", radius = radius, mass = ratio, position = {4, 0, 0}, velocity = {-v0, 0, 0},
	material = hard }
camera { name = "side", position = {3, -6, 1}, look_at = {3, 0, 0}, size = {1280, 720} }

local angle = math.atan(math.sqrt(1 / ratio))
expect("the count of impacts", function()
	return math.abs(collisions() - math.floor(math.pi / angle)), 0
end)
-- Head-on impacts depend on velocities alone, not on where they are found: rotation by 2 angle each, to rounding.
expect("energy is kept", function() return math.abs(energy() / (ratio * v0 ^ 2 / 2) - 1), 1e-12 end)
expect("the heavy ball is on its way out", function()
	return heavy.velocity.x > 0 and light.velocity.x <= heavy.velocity.x
end)
