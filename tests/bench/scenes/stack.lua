-- Unit boxes on each other, the top one heavier.
local count = param("count", 10, "boxes", {min = 1, max = 200})
local ratio = param("ratio", 1, "mass of the top over that of the others", {min = 1})
local rate = param("rate", 60, "steps per second", {min = 60})

world { title = "A stack", duration = 100, frame_rate = 60, time_step = 1 / rate, gravity = {0, 0, -9.81} }
local wood = material { name = "wood", friction = 0.5, restitution = 0 }
plane { normal = {0, 0, 1}, material = wood }
local top
for k = 1, count do
	top = box { size = {1, 1, 1}, material = wood, mass = k == count and ratio or 1, position = {0, 0, k - 0.5} }
end
expect("compression", function() return math.abs(top.position.z - (count - 0.5)), 1e-6 end)
expect("drift", function() return math.max(math.abs(top.position.x), math.abs(top.position.y)), 1e-6 end)
