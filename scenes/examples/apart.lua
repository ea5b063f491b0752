-- Two balls touch while they move apart; here y is up, and nothing else acts.
-- Watch: nothing happens between them, although friction is 0.3 and their skins slide past each other.
-- Expected end: both go on as they were, 60 J before and after.
-- An impact needs an approach: whether a touching pair pushes is told by the sign of the velocity along the normal.
-- Try: --param towards=true (A comes back at B: they collide at once)
-- Takes: less than a second.
local towards = param("towards", false, "A moves towards B instead")
local mu = 0.3
world { title = "Touching and moving apart", duration = 1, frame_rate = 60 }
local skin = material { name = "skin", friction = mu, restitution = 1 }
local va = towards and vec3(2, 0, 1) or vec3(-2, 0, -1)
local vb = vec3(1, 0, 3)
local a = sphere { name = "A", radius = 5, mass = 18, position = {0, 5, 0}, velocity = va, material = skin }
local b = sphere { name = "B", radius = 2.5, mass = 3, position = {5 * math.sqrt(2), 2.5, 0}, velocity = vb, material = skin }
camera { name = "side", position = {3, 10, 32}, look_at = {3, 4, 0}, up = {0, 1, 0}, size = {1280, 720}, overlay = {"title", "time", "energy"} }

expect("60 J", function() return math.abs(18 / 2 * va:dot(va) + 3 / 2 * vb:dot(vb) - 60), 1e-13 end)
if towards then
	expect("they have collided", function() return collisions() >= 1 end)
else
	expect("nothing has happened between them", function() return collisions(), 0 end)
	expect("60 J are left", function() return math.abs(energy() - 60), 1e-12 end)
	expect("A goes on as it was, m/s", function() return (a.velocity - va):length() + a.angular_velocity:length(), 1e-14 end)
	expect("B goes on as it was, m/s", function() return (b.velocity - vb):length() + b.angular_velocity:length(), 1e-14 end)
end
