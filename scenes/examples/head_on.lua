-- Ball B of 18 kg at 2 m/s runs into ball A of 2 kg that comes towards it at 1 m/s; nothing is lost.
-- Watch: the heavy one hardly slows down, the light one is thrown back faster than either came.
-- Expected end: v_B = 1.4 m/s, v_A = 4.4 m/s.
-- Seen from the common centre of mass, which moves at 1.7 m/s, both just turn round.
-- Try: --param e=0 (both go on at 1.7 m/s)
-- Takes: less than a second.
local e = param("e", 1.0, "restitution", {min = 0, max = 1})
local mass_b, mass_a, vb, va = 18, 2, 2, -1
world { title = "Head on", duration = 2, frame_rate = 60 }
local steel = material { name = "steel", friction = 0, restitution = e }
local b = sphere { name = "B", radius = 0.5, mass = mass_b, position = {-2, 0, 0}, velocity = {vb, 0, 0}, material = steel }
local a = sphere { name = "A", radius = 0.25, mass = mass_a, position = {1, 0, 0}, velocity = {va, 0, 0}, material = steel }
camera { name = "side", position = {1, -8, 1}, look_at = {1, 0, 0}, size = {1280, 720}, overlay = {"title", "time", "energy"} }

local common = (mass_b * vb + mass_a * va) / (mass_b + mass_a)
expect("v_B, m/s", function() return math.abs(b.velocity.x - (common - e * (vb - common))), 1e-12 end)
expect("v_A, m/s", function() return math.abs(a.velocity.x - (common - e * (va - common))), 1e-12 end)
expect("momentum is kept", function() return math.abs(momentum().x / (mass_b * vb + mass_a * va) - 1), 1e-14 end)
if e == 1 then
	expect("energy is kept", function() return math.abs(energy() / (mass_b * vb ^ 2 / 2 + mass_a * va ^ 2 / 2) - 1), 1e-13 end)
end
