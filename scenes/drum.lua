-- A drum turns slowly, half full of beads.
-- Watch: they are carried up, and run down over the surface as a thin layer; its slope stays.
-- Expected end: the surface stands at the dynamic angle of repose, between 15 and 40 degrees.
-- The centre of a half disc lies across its surface from the axis: the angle is that of the beads' centre of mass.
-- Try: --param mu=0.1 (flatter), --param rate=6 (the surface bends), --param rate=14 (faster than sqrt(g/R): they go round)
-- Takes: 10 s of processor time.
local n = param("n", 170, "beads, of which 170 fill half of it", {min = 10, max = 20000})
local mu = param("mu", 0.5, "friction", {min = 0, max = 2})
local rate = param("rate", 1.5, "of the drum, rad/s", {min = 0, max = 50})
local seconds = param("seconds", 2.0, "simulated", {min = 0.1, max = 1000})
local g, r, R, sides, deep = 9.81, 0.01, 0.12, 24, 0.08

world { title = "A drum turns", duration = seconds, frame_rate = 60, gravity = {0, 0, -g}, method = "stepped", seed = 3 }
local glass = material { name = "glass", density = 2500, friction = mu, restitution = 0.1 }
local steel = material { name = "steel", friction = math.max(mu, 0.6), restitution = 0, color = {0.60, 0.64, 0.68} }
contact_pair(glass, steel, {friction = math.max(mu, 0.6)})
local smooth = material { name = "smooth", friction = 0, restitution = 0 }
contact_pair(glass, smooth, {friction = 0})
for k = 0, sides - 1 do
	plane { name = "side " .. k, material = steel, visible = false, motion = function(t)
		local a = 2 * math.pi * k / sides + rate * t
		local half = math.atan(-math.cos(a), -math.sin(a)) / 2
		return {R * math.cos(a), 0, R * math.sin(a)}, {math.cos(half), 0, math.sin(half), 0}
	end }
end
-- The rim is drawn by a body of its own, which turns with the walls and touches nothing.
local rim = {}
for k = 1, sides do
	local a = 2 * math.pi * k / sides
	rim[k] = { shape = "box", size = {0.3 * r, deep, 2.02 * R * math.tan(math.pi / sides)}, position = (R + 0.15 * r) * vec3(math.cos(a), 0, math.sin(a)),
		orientation = {axis = {0, 1, 0}, angle = -a} }
end
body { name = "rim", shapes = rim, collides_with = {}, material = steel, motion = function(t)
	return {0, 0, 0}, {math.cos(rate * t / 2), 0, -math.sin(rate * t / 2), 0}, {0, 0, 0}, {0, -rate, 0}
end }
for side = -1, 1, 2 do
	plane { name = "end " .. side, material = smooth, normal = {0, -side, 0}, point = {0, side * deep / 2, 0}, visible = side > 0,
		color = {0.30, 0.32, 0.35}, texture = "none" }
end
local palette = require "rbsim.palette"
local beads, rows = {}, math.floor((deep - 0.2 * r) / (2.1 * r))
for z = -6, 6 do
	for x = -6, 6 do
		for y = 0, rows - 1 do
			local at = vec3(2.1 * r * x, (y - (rows - 1) / 2) * 2.1 * r, 2.1 * r * z + 0.2 * r)
			if #beads < n and math.sqrt(at.x ^ 2 + at.z ^ 2) < R * math.cos(math.pi / sides) - 1.2 * r then
				beads[#beads + 1] = sphere { radius = r, material = glass, texture = "none", color = palette.at(z < -3 and 1 or 5),
					position = {at.x + 0.05 * r * math.random(), at.y, at.z} }
			end
		end
	end
end
camera { name = "main", position = {0, -0.75, 0}, look_at = {0, 0, 0}, fov = deg(24), size = {960, 960}, overlay = {"title", "time"},
	video = "drum.mp4" }

local function angle()
	local x, z = 0, 0
	for _, bead in ipairs(beads) do x, z = x + bead.position.x, z + bead.position.z end
	return math.deg(math.atan(math.abs(x), -z))
end
local sum, squares, frames = 0, 0, 0
on_frame(function(t)
	if t > seconds / 3 then
		local a = angle()
		sum, squares, frames = sum + a, squares + a * a, frames + 1
	end
end)
probe("angle of the surface", angle, {unit = "deg"})
result("dynamic angle of repose", function() return sum / frames end, {unit = "deg"})
result("its fluctuation", function() return math.sqrt(math.max(0, squares / frames - (sum / frames) ^ 2)) end, {unit = "deg"})
result("Froude number", function() return rate ^ 2 * R / g end)
if mu >= 0.3 and rate >= 0.5 and rate <= 3 and seconds >= 2 then
	expect("the surface is not flatter than 15 degrees", function() return 15, sum / frames end)
	expect("nor steeper than 40 degrees", function() return sum / frames, 40 end)
end
expect("none is lost", function()
	local lost = 0
	for _, bead in ipairs(beads) do
		if math.sqrt(bead.position.x ^ 2 + bead.position.z ^ 2) > R / math.cos(math.pi / sides) then lost = lost + 1 end
	end
	return lost, 0
end)
expect("overlap stays within the tolerance", function() return max_penetration(), penetration_tolerance() end)
