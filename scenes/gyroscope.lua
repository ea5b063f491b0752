-- A spinning wheel in two gimbal rings: its axis keeps its direction while the frame would have it fall.
-- Watch: a weight on the inner ring does not pull it down; the outer ring turns instead, slowly and evenly.
-- Expected end: the energy is that of the start.
-- The faster the wheel spins, the slower it precesses: torque over angular momentum.
-- Try: --param spin=50, --param weight=0
-- Takes: some seconds.
local spin = param("spin", 200.0, "rad/s of the wheel", {min = 0, max = 1000})
local weight = param("weight", 0.05, "kg, on the inner ring", {min = 0, max = 1})
local g = 9.81

world { title = "A gyroscope in gimbals", duration = 2, frame_rate = 60, gravity = {0, 0, -g} }
material { name = "brass", density = 8500, friction = 0, texture = "none", color = {0.85, 0.65, 0.25}, shininess = 80 }
local none = {collides_with = {}}
-- Rings are bars across: what they weigh counts, what they look like does not.
local outer = box { name = "outer ring", size = {0.03, 0.5, 0.03}, material = "brass", position = {0, 0, 0}, collides_with = {} }
local inner = box { name = "inner ring", size = {0.4, 0.03, 0.03}, material = "brass", position = {0, 0, 0}, collides_with = {} }
local wheel = cylinder { name = "wheel", radius = 0.12, length = 0.03, material = "brass", orientation = {axis = {0, 1, 0}, angle = deg(90)},
	angular_velocity = {spin, 0, 0}, texture = "checker", collides_with = {} }
joint { name = "vertical", kind = "hinge", a = outer, at = {0, 0, 0}, axis = {0, 0, 1} }
joint { name = "level", kind = "hinge", a = outer, b = inner, at = {0, 0, 0}, axis = {0, 1, 0} }
joint { name = "axle", kind = "hinge", a = inner, b = wheel, at = {0, 0, 0}, axis = {1, 0, 0} }
if weight > 0 then
	local bob = sphere { name = "weight", radius = 0.03, mass = weight, position = {0.2, 0, 0}, collides_with = {} }
	joint { name = "nail", kind = "fixed", a = inner, b = bob, at = {0.2, 0, 0} }
end
camera { name = "main", position = {0.9, -1.1, 0.6}, look_at = {0, 0, 0}, overlay = {"title", "time"} }

local first = nil
on_frame(function() first = first or energy() end)
expect("the energy is that of the start, of itself", function() return math.abs(energy() - first) / math.max(first, 1e-3), 1e-9 end)
if spin >= 100 then
	expect("the weight has not fallen, m", function() return inner.point({0.2, 0, 0}).z > -0.05 end)
end
