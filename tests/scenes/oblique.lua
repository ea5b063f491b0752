-- SPDX-License-Identifier: MIT
-- One body falls on a plane, obliquely and with spin; tells where it is soon after its first impact.
local kind = param("kind", "box", "what falls", {choices = {"box", "cylinder", "capsule", "sphere"}})
local e = param("e", 0.0, "restitution")
local mu = param("mu", 0.3, "friction")

world { title = "Oblique", duration = 0.35, frame_rate = 10, time_step = 1 / 60, gravity = {0, 0, -9.81} }
local stuff = material { name = "stuff", friction = mu, restitution = e, density = 1000 }
plane { material = stuff }
local unit = math.sqrt(0.95)
local keys = {name = "body", material = stuff, position = {0, 0, 0.63}, velocity = {1.5, 0.4, -0.2}, angular_velocity = {2.1, 3, -1.5},
	orientation = {0.9 / unit, 0.2 / unit, 0.3 / unit, 0.1 / unit}}
local body
if kind == "box" then
	keys.size = {0.3, 0.2, 0.25}
	body = box(keys)
elseif kind == "sphere" then
	keys.radius = 0.1
	body = sphere(keys)
else
	keys.radius, keys.length = 0.1, 0.2
	body = (kind == "capsule" and capsule or cylinder)(keys)
end
expect("its place is told", function()
	local at = body.position
	print(("place %.12g %.12g %.12g"):format(at.x, at.y, at.z))
	return true
end)
