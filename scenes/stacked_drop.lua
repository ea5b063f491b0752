-- A ball is dropped on one that rests on the floor, nothing is lost at impacts.
-- Watch: the lower ball hardly moves: it passes the blow to the floor and gets it back within the same moment.
-- Expected end: the upper ball rises to where it was dropped, the lower one rests.
-- Floor, lower and upper ball are one impact: what touches at one moment is solved together.
-- Try: --param mass=3 (a heavy ball dropped on a light one)
-- Takes: less than a second.
local mass = param("mass", 1.0, "of the dropped ball over the other's", {min = 0.1, max = 10})
local g, radius, h = 9.81, 0.1, 1

world { title = "Dropped on a resting ball", duration = 2 * math.sqrt(2 * h / g), frame_rate = 60,
	gravity = {0, 0, -g} }
local hard = material { name = "hard", friction = 0, restitution = 1 }
plane { normal = {0, 0, 1}, material = hard, texture = "checker" }
local low = sphere { name = "low", radius = radius, mass = 1, position = {0, 0, radius}, material = hard }
local high = sphere { name = "high", radius = radius, mass = mass, position = {0, 0, 3 * radius + h}, material = hard }
camera { name = "side", position = {0, -4, 1}, look_at = {0, 0, 0.7}, size = {1280, 720} }

local total = g * (1 * radius + mass * (3 * radius + h))
expect("energy is kept, relative", function() return math.abs(energy() / total - 1), 1e-12 end)
if mass == 1 then
	expect("the upper ball is back", function() return math.abs(high.position.z - 3 * radius - h), 1e-9 end)
	expect("the lower one rests", function() return math.abs(low.position.z - radius), 1e-9 end)
end
