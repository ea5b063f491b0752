-- A bar thrown at the floor, corner first, and the same bar of many pieces in a row, each fixed to the next: the impact is the
-- same. So many joints are eliminated, not iterated on.
local e, mu = param("e", 0.5, ""), param("mu", 0.3, "")
local pieces = param("pieces", 40, "", {min = 2})
local bound = param("bound", 1e-7, "m/s and rad/s, of about ten")
world { duration = 0.003, frame_rate = 1000, gravity = {0, 0, 0} }
local m = material { name = "m", density = 1000, restitution = e, friction = mu }
plane { material = m }
local size = {2, 0.1, 0.2}
local axis, angle = vec3(0.3, 1, 0.2):unit(), 0.6
local function turned(v)
	return math.cos(angle) * v + math.sin(angle) * axis:cross(v) + (1 - math.cos(angle)) * axis:dot(v) * axis
end
local low = 0
for k = 0, 7 do
	low = math.min(low, turned(vec3((k % 2 - 0.5) * size[1], (k // 2 % 2 - 0.5) * size[2], (k // 4 - 0.5) * size[3])).z)
end
local v, w = vec3(1, -0.5, -3), vec3(0.5, -2, 1)
local function part(length, off, y)
	return box { size = {length, size[2], size[3]}, material = m, position = vec3(0, y, 0.001 - low) + off,
		orientation = {axis = axis, angle = angle}, velocity = v + w:cross(off), angular_velocity = w }
end
local alone, held = part(size[1], vec3(0, 0, 0), 0), {}
local length = size[1] / pieces
for k = 1, pieces do
	held[k] = part(length, turned(vec3((k - 0.5) * length - size[1] / 2, 0, 0)), 3)
	if k > 1 then
		joint { kind = "fixed", a = held[k - 1], b = held[k],
			at = vec3(0, 3, 0.001 - low) + turned(vec3((k - 1) * length - size[1] / 2, 0, 0)) }
	end
end
expect("each has hit the floor", function() return collisions() == 2 end)
expect("the row moves on as the bar alone", function()
	local mean, worst = vec3(0, 0, 0), 0
	for _, body in ipairs(held) do
		mean = mean + body.velocity / pieces
		worst = math.max(worst, (body.angular_velocity - alone.angular_velocity):length())
	end
	return math.max(worst, (mean - alone.velocity):length()), bound
end)
