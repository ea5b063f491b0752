-- A stack, a tower or a pyramid, the topmost box heavier: how far does it sink or lean, against what it is built as?
local stack = require "rbsim.stack"
local kind = param("kind", "tower", "what stands there", {choices = {"tower", "pyramid", "kapla"}})
local count = param("count", 10, "boxes, rows or floors", {min = 1, max = 1000})
local ratio = param("ratio", 1.0, "mass of the topmost box over that of the others", {min = 1, max = 1e12})
local seconds = param("seconds", 100.0, "simulated", {min = 0.1, max = 1e6})

world { duration = seconds, frame_rate = 1, gravity = {0, 0, -9.81}, time_step = 1 / 60 }
local stuff = material { name = "stuff", density = 1000, friction = 0.5, restitution = 0 }
plane { material = stuff }
local size = kind == "tower" and {1, 1, 1} or {1, 1, 0.5}
local blocks = kind == "kapla" and stack.kapla { floors = count } or kind == "pyramid" and stack.pyramid { rows = count, size = size }
	or stack.tower { count = count, size = size }
local bodies = stack.bodies(blocks, function(i, block)
	local s = block.size
	return { material = stuff, mass = 1000 * s[1] * s[2] * s[3] * (i == #blocks and ratio or 1) }
end)
local start, height = {}, 0
for i, body in ipairs(bodies) do start[i], height = vec3(body.position), math.max(height, body.position.z) end
local sunk, far = 0, 0
on_frame(function()
	sunk = math.max(sunk, start[#start].z - bodies[#bodies].position.z)
	for i, body in ipairs(bodies) do far = math.max(far, (body.position - start[i]):length()) end
end)
expect("compression", function() return sunk, 1e-6 end)
expect("displacement over height", function() return far / height, 1e-6 end)
