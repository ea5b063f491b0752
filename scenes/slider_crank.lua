-- A crank turns evenly and drives a piston: rotation becomes to and fro, as in every engine.
-- Watch: the piston lingers at its outer end and hurries through the inner one.
-- Expected end: after a whole turn the piston is where the closed form has it.
-- The piston's place is r cos(a) + sqrt(L^2 - r^2 sin(a)^2); a long connecting rod makes it nearly a cosine.
-- Try: --param rod=0.35, --param turns=3
-- Takes: less than a second.
local L = param("rod", 0.6, "length of the connecting rod, m", {min = 0.32, max = 5})
local turns = param("turns", 1.25, "turns of the crank", {min = 0.1, max = 5})
local r, omega = 0.25, 2 * math.pi
local g = 9.81

world { method = "stepped", time_step = 5e-4, title = "A crank and a piston", duration = turns, frame_rate = 60, gravity = {0, 0, -g} }
material { name = "steel", density = 7800, friction = 0, texture = "none" }
local wheel = cylinder { name = "crank", radius = 1.2 * r, length = 0.05, material = "steel", orientation = {axis = {1, 0, 0}, angle = deg(90)},
	angular_velocity = {0, -omega, 0}, collides_with = {}, color = {0.5, 0.52, 0.56} }
local rod = box { name = "rod", size = {L, 0.04, 0.06}, material = "steel", position = {r + L / 2, -0.08, 0}, collides_with = {},
	velocity = {0, 0, omega * r / 2}, angular_velocity = {0, omega * r / L, 0}, color = {0.8, 0.5, 0.2} }
local piston = box { name = "piston", size = {0.15, 0.15, 0.15}, material = "steel", position = {r + L, -0.08, 0}, collides_with = {} }
joint { name = "axle", kind = "hinge", a = wheel, at = {0, 0, 0}, axis = {0, 1, 0}, motor = {angle = function(t) return omega * t end, torque = 1e4} }
joint { name = "crank pin", kind = "hinge", a = wheel, b = rod, at = {r, -0.08, 0}, axis = {0, 1, 0} }
joint { name = "piston pin", kind = "hinge", a = rod, b = piston, at = {r + L, -0.08, 0}, axis = {0, 1, 0} }
joint { name = "cylinder", kind = "slider", a = piston, at = {r + L, -0.08, 0}, axis = {1, 0, 0} }
record { fields = {"+", "joints"} }
camera { name = "side", position = {0.4, -2.4, 0.4}, look_at = {0.35, 0, 0}, overlay = {"title", "time"} }

local function place(t)
	return r * math.cos(omega * t) + math.sqrt(L * L - (r * math.sin(omega * t)) ^ 2)
end
-- What joints may be open by in steps is the tolerance, 1e-6 of half of the rod's width.
expect_always("the piston is where the closed form has it, m", function()
	return math.abs(piston.position.x - place(time())), 2e-8
end)
