-- A cone of beads on a rough round table is too steep to stand.
-- Watch: its side runs down, in avalanches that end one after the other, and over the edge of the table.
-- Expected end: a heap at rest, whose side stands at the angle of repose.
-- Beads that are fixed make the table as rough as the heap; on a smooth one spheres roll away and no heap stands.
-- Try: --param mu=0.1 (flatter), --param mu=1, --param R=0.2
-- Takes: 15 s of processor time.
local R = param("R", 0.13, "radius of the table, m; a bead's is 0.01 m", {min = 0.03, max = 2})
local mu = param("mu", 0.5, "friction", {min = 0, max = 2})
local steep = param("steep", 55, "slope of the cone at the start, degrees", {min = 1, max = 75})
local seconds = param("seconds", 3.0, "simulated", {min = 0.1, max = 1000})
local g, r = 9.81, 0.01

world { title = "The angle of repose", duration = seconds, frame_rate = 60, gravity = {0, 0, -g}, method = "stepped", seed = 6 }
local glass = material { name = "glass", density = 2500, friction = mu, restitution = 0.1, color = {0.85, 0.62, 0.30} }
local most = math.ceil(R / r)
for x = -most, most do
	for y = -most, most do
		local at = vec3((x + y % 2 / 2) * 2 * r, y * math.sqrt(3) * r, -r)
		if math.sqrt(at.x ^ 2 + at.y ^ 2) <= R then
			sphere { name = ("table %d %d"):format(x, y), radius = r, static = true, material = glass, position = at, color = {0.35, 0.37, 0.40},
				texture = "none" }
		end
	end
end
local beads = {}
local layers = math.floor(R * math.tan(deg(steep)) / (2.05 * r))
for layer = 0, layers - 1 do
	local z = (1.05 + 2.05 * layer) * r
	local wide = R - z / math.tan(deg(steep))
	for x = -most, most do
		for y = -most, most do
			local at = vec3((x + layer % 2 / 2) * 2.1 * r, (y + layer % 2 / 2) * 2.1 * r, z)
			if math.sqrt(at.x ^ 2 + at.y ^ 2) <= wide then
				beads[#beads + 1] = sphere { radius = r, material = glass, texture = "none",
					position = at + 0.06 * r * vec3(math.random() - 0.5, math.random() - 0.5, 0) }
			end
		end
	end
end
camera { name = "main", position = {0.1, -0.68, 0.2}, look_at = {0, 0, 0.03}, fov = deg(28), size = {1280, 720}, overlay = {"title", "time"},
	video = "angle_of_repose.mp4" }

-- Slope of the least squares through the highest beads of rings around the axis, outside of the tip.
local function angle()
	local top, count, sx, sy, sxx, sxy = {}, 0, 0, 0, 0, 0
	for _, bead in ipairs(beads) do
		local p = bead.position
		local ring = math.floor(math.sqrt(p.x ^ 2 + p.y ^ 2) / (2 * r))
		if p.z > -r then top[ring] = math.max(top[ring] or -r, p.z) end
	end
	for ring = 0, math.floor(R / (2 * r)) do
		local x, y = (ring + 0.5) * 2 * r, top[ring] or -r
		count, sx, sy, sxx, sxy = count + 1, sx + x, sy + y, sxx + x * x, sxy + x * y
	end
	return math.deg(math.atan(-(count * sxy - sx * sy) / (count * sxx - sx * sx)))
end
local function on_table()
	local on = 0
	for _, bead in ipairs(beads) do
		if bead.position.z > -r then on = on + 1 end
	end
	return on
end
local function fastest()
	local most = 0
	for _, bead in ipairs(beads) do
		if bead.position.z > -r then most = math.max(most, bead.velocity:length()) end
	end
	return most
end
probe("beads on the table", on_table)
result("angle of repose", angle, {unit = "deg"})
result("beads on the table", on_table)
result("fastest of these", fastest, {unit = "m/s"})
if mu >= 0.3 and R >= 0.1 and steep >= 45 and seconds >= 3 then
	expect("the side is not flatter than 12 degrees", function() return 12, angle() end)
	expect("nor steeper than 40 degrees", function() return angle(), 40 end)
	expect("the heap has come to rest, m/s", function() return fastest(), 0.02 end)
end
expect("overlap stays within the tolerance", function() return max_penetration(), penetration_tolerance() end)
