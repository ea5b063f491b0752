-- Unit cubes above each other, each let fall by a millimetre more than the one below: when does the stack stand?
local count = param("count", 20, "boxes", {min = 1, max = 1000})
local rate = param("rate", 240, "steps per second", {min = 1})

world { title = "A stack is let fall", duration = 20, frame_rate = 4, gravity = {0, 0, -9.81}, time_step = 1 / rate, seed = 5 }
local stuff = material { name = "stuff", density = 1000, friction = 0.5, restitution = 0 }
plane { material = stuff }
local boxes = {}
for i = 1, count do
	boxes[i] = box { size = {1, 1, 1}, material = stuff,
		position = {0.002 * math.random(), 0.002 * math.random(), i - 0.5 + 0.001 * i} }
end
local fastest = 0
on_frame(function()
	if time() < 2 then return end
	for _, body in ipairs(boxes) do fastest = math.max(fastest, body.velocity:length()) end
end)
expect("fastest after 2 s", function() return fastest, 0 end)
expect("top below its place", function() return math.max(0, count - 0.5 - boxes[count].position.z), 0.1 end)
