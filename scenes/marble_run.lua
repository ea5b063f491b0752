-- Marbles, and a dumb-bell among them, run down a zigzag of troughs, each a union of four boxes behind a pane.
-- Watch: they drop from trough to trough, roll along walls, push each other; the dumb-bell turns itself across the way.
-- Expected end: all are in the tray at the bottom, none fell beside.
-- A union is one body: its boxes share a name, a material and, where it moves, one mass and inertia.
-- Try: --param marbles=12, --param slope=0.2, --param e=0.5
-- Takes: 55 s of processor time, 2 s without its film.
local count = param("marbles", 5, "how many", {min = 1, max = 40})
local slope = param("slope", 0.12, "of the troughs, rad", {min = 0.02, max = 0.4})
local e = param("e", 0.2, "restitution", {min = 0, max = 0.9})
local palette = require "rbsim.palette"
local g, r, long, wide, thick, levels = 9.81, 0.025, 1.2, 0.14, 0.01, 4

world { title = "A marble run", duration = 9, frame_rate = 60, gravity = {0, 0, -g}, seed = 5 }
local wood = material { name = "wood", density = 700, friction = 0.3, restitution = e, color = {0.80, 0.62, 0.40} }
local glass = material { name = "glass", density = 2500, friction = 0.3, restitution = e, shininess = 120 }
-- less than the tangent of the slope, so that the dumb-bell slides on where it lies lengthwise; marbles roll with 2/7 of it
contact_pair(wood, glass, { friction = 0.08, restitution = e })
plane { name = "floor", material = wood, color = {0.42, 0.44, 0.46}, texture = "none" }

-- A trough about its own origin: a bottom, two sides, and a wall at its upper end; it runs down towards +x. The side towards
-- the camera, `front` in y, is a low board and a pane above it that one does not see.
local function trough(name, front, keys)
	keys.name, keys.static, keys.material, keys.texture = name, true, wood, "none"
	local y = front * (wide / 2 - thick / 2)
	body { name = "pane of " .. name, static = true, material = wood, visible = false, position = keys.position,
		orientation = keys.orientation, shapes = {{ shape = "box", size = {long, thick, 0.07}, position = {0, y, 0.06} }} }
	keys.shapes = {
		{ shape = "box", size = {long, wide, thick} },
		{ shape = "box", size = {long, thick, 0.09}, position = {0, -y, 0.05} },
		{ shape = "box", size = {long, thick, 0.02}, position = {0, y, 0.015} },
		{ shape = "box", size = {thick, wide, 0.16}, position = {-long / 2 - thick / 2, 0, 0.075} } }
	return body(keys)
end
-- Each begins below the lower end of the one above, and runs the other way.
local fall = long * math.sin(slope) + 0.12
for level = 1, levels do
	local side, z = level % 2 == 1 and 1 or -1, (levels - level + 0.5) * fall + 0.15
	local half = slope / 2
	trough("trough " .. level, -side, { position = {-0.06 * side, 0, z},
		-- turned about y by the slope, every second one first about z by half a turn
		orientation = side == 1 and {math.cos(half), 0, math.sin(half), 0} or {0, -math.sin(half), 0, math.cos(half)} })
end
-- The tray: four low walls on the floor, under the end of the last trough.
local last = levels % 2 == 1 and 1 or -1
local tray = vec3(last * (long / 2 + 0.15), 0, 0)
body { name = "tray", static = true, material = wood, texture = "none", position = tray, shapes = {
	{ shape = "box", size = {0.5, 0.01, 0.14}, position = {0, 0.205, 0.07} }, { shape = "box", size = {0.5, 0.01, 0.14}, position = {0, -0.205, 0.07} },
	{ shape = "box", size = {0.01, 0.4, 0.14}, position = {0.245, 0, 0.07} }, { shape = "box", size = {0.01, 0.4, 0.14}, position = {-0.245, 0, 0.07} } } }

-- They wait in the uppermost trough, one behind the other, each a little to its own side.
local runners = {}
local function place(k, aside)
	local s = -long / 2 + 0.06 + 0.075 * k
	return vec3(-0.06 + s * math.cos(slope), aside or 0.02 * (k % 3 - 1), (levels - 0.5) * fall + 0.15 - s * math.sin(slope) + (thick / 2 + r + 1e-3) / math.cos(slope))
end
for k = 1, count do
	runners[k] = sphere { name = "marble " .. k, radius = r, material = glass, color = palette.at(k), position = place(k) }
end
runners[#runners + 1] = body { name = "dumb-bell", material = glass, color = palette.yellow, position = place(count + 1, 0), shapes = {
	{ shape = "sphere", radius = r, position = {0, -0.03, 0} }, { shape = "sphere", radius = r, position = {0, 0.03, 0} },
	{ shape = "capsule", radius = 0.4 * r, length = 0.06, orientation = {axis = {1, 0, 0}, angle = deg(90)} } } }
camera { name = "main", position = {0.3, -2.4, 1.75}, look_at = {0, 0, 0.52}, fov = deg(38), size = {1280, 720}, trails = {runners[1]},
	overlay = {"title", "time"}, video = "marble_run.mp4" }

expect("all are in the tray", function()
	if slope < 0.1 or slope > 0.15 or e > 0.3 or count > 8 then return true end -- some fly beside
	local out = 0
	for _, one in ipairs(runners) do
		local p = one.position - tray
		if math.abs(p.x) > 0.25 or math.abs(p.y) > 0.205 or p.z > 0.15 then out = out + 1 end
	end
	return out, 0
end)
local start
expect_always("energy is only lost", function()
	start = start or energy()
	return energy() / start - 1, 1e-9
end)
expect("overlap stays within the tolerance", function() return max_penetration(), penetration_tolerance() end)
