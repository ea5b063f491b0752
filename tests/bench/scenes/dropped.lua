-- Unit cubes on each other, each let fall by a millimetre more than the one below, shifted by up to 2 mm.
local count = param("count", 20, "boxes", {min = 1, max = 200})
local rate = param("rate", 240, "steps per second", {min = 60})
local rest = 2

world { title = "A dropped stack", duration = 5, frame_rate = 60, time_step = 1 / rate, gravity = {0, 0, -9.81}, seed = 5 }
local wood = material { name = "wood", friction = 0.5, restitution = 0 }
plane { normal = {0, 0, 1}, material = wood }
local boxes, then_at = {}, {}
for k = 1, count do
	boxes[k] = box { size = {1, 1, 1}, mass = 1000, material = wood,
		position = {0.002 * math.random(), 0.002 * math.random(), k - 0.5 + 0.001 * k} }
end
local fastest, shift = 0, 0
on_frame(function(t)
	if t < rest - 1e-9 then return end
	for k, box in ipairs(boxes) do
		then_at[k] = then_at[k] or box.position
		fastest = math.max(fastest, box.velocity:length(), 0.5 * box.angular_velocity:length())
		shift = math.max(shift, (box.position - then_at[k]):length())
	end
end)
result("fastest after 2 s", function() return fastest end, {unit = "m/s"})
result("shift after 2 s", function() return shift end, {unit = "m"})
result("how low the top is", function() return count - 0.5 - boxes[count].position.z end, {unit = "m"})
