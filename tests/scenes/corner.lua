-- SPDX-License-Identifier: MIT
-- A box that lies nearly flat comes to the edge of another one, slowly and without restitution: a corner hits its face, then
-- others. What located and stepped make of it is compared by tests/cli/physics-one-law.sh.
local tilt = param("tilt", 1e-3, "angle between the faces, rad")

world { title = "Corner", duration = 0.02, frame_rate = 100, gravity = {0, 0, 0} }
local wood = material { name = "wood", friction = 0.5, restitution = 0 }
box { size = {1, 1, 0.2}, static = true, material = wood }
local lid = box { size = {0.3, 0.2, 0.1}, mass = 1, position = {0.63, 0, 0.1505}, velocity = {0, 0, -0.05},
	orientation = {axis = {1, -1.5, 0}, angle = tilt}, material = wood }
expect("its motion is told", function()
	local v, w = lid.velocity, lid.angular_velocity
	print(("motion %d %.12g %.12g %.12g"):format(collisions(), v.z, 0.1 * w.x, 0.1 * w.y))
	return true
end)
