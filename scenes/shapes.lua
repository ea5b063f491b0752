-- One of each shape tumbles weightless over a floor: box, capsule, cylinder, hull, and rigid unions of them.
-- Watch: long and flat ones wobble as they turn; each keeps its own angular momentum.
-- Expected end: all are where they were, turned; momentum, energy and angular momentum are as at the start.
-- Patterns lie on the surfaces of bodies and turn with them. Here they collide with nothing.
-- Try: --param spin=6, or rbsim render shapes.h5 --frame 100 -o shapes.png --size 1920x1080
-- Takes: 55 s of processor time, less than a second without its film.
local palette = require "rbsim.palette"
local spin = param("spin", 2, "angular speed, rad/s", {min = 0, max = 20})

world { title = "Shapes", duration = 8 }
local matter = material { name = "matter", density = 1000, shininess = 60 }
local chalk = material { name = "chalk", color = {0.88, 0.86, 0.80} }
plane { name = "floor", material = chalk, texture = "checker", collides_with = {} }

local bodies = {}
-- The k-th of ten, in two rows.
local function place(k, axis, look)
	look.name = look.name or look[1]
	look[1] = nil
	look.position = {1.5 * ((k - 1) % 5 - 2), k > 5 and 1.4 or -0.4, k > 5 and 2.6 or 1.1}
	look.angular_velocity = spin * vec3(axis):unit()
	look.color, look.material, look.collides_with = look.color or palette.at(k), matter, {}
	return look
end

-- Corners of an icosahedron, and of a prism with n sides.
local function icosahedron(r)
	local points, g = {}, (1 + 5 ^ 0.5) / 2
	for s = -1, 1, 2 do
		for t = -g, g, 2 * g do
			for turn = 0, 2 do
				local p = {0, s, t}
				points[#points + 1] = vec3(p[turn % 3 + 1], p[(turn + 1) % 3 + 1], p[(turn + 2) % 3 + 1]) * (r / 2)
			end
		end
	end
	return points
end
local function prism(n, r, h)
	local points = {}
	for k = 1, n do
		local x, y = r * math.cos(2 * math.pi * k / n), r * math.sin(2 * math.pi * k / n)
		points[#points + 1], points[#points + 2] = {x, y, -h / 2}, {x, y, h / 2}
	end
	return points
end

bodies[1] = box(place(1, {1, 0.2, 0.6}, { name = "box", size = {1.0, 0.7, 0.4}, texture = "checker" }))
bodies[2] = capsule(place(2, {0.6, 1, 0.2}, { name = "capsule", radius = 0.25, length = 0.6, texture = "stripes" }))
bodies[3] = cylinder(place(3, {1, 0.5, 0.1}, { name = "cylinder", radius = 0.35, length = 0.8, texture = "checker" }))
bodies[4] = hull(place(4, {0.3, 1, 0.4}, { name = "icosahedron", points = icosahedron(0.55) }))
bodies[5] = body(place(5, {1, 0.3, 0.1}, { name = "dumb-bell", shapes = {
	{ shape = "capsule", radius = 0.09, length = 0.9 },
	{ shape = "sphere", radius = 0.28, position = {0, 0, -0.4} },
	{ shape = "sphere", radius = 0.28, position = {0, 0, 0.4} } } }))
bodies[6] = hull(place(6, {1, 0.2, 0.5}, { name = "nut", points = prism(6, 0.5, 0.35), texture = "stripes" }))
bodies[7] = cylinder(place(7, {1, 0.3, 0.3}, { name = "coin", radius = 0.5, length = 0.06, texture = "beachball" }))
bodies[8] = body(place(8, {1, 1, 0.2}, { name = "jack", shapes = {
	{ shape = "capsule", radius = 0.12, length = 0.9 },
	{ shape = "capsule", radius = 0.12, length = 0.9, orientation = {axis = {1, 0, 0}, angle = deg(90)} },
	{ shape = "capsule", radius = 0.12, length = 0.9, orientation = {axis = {0, 1, 0}, angle = deg(90)} } } }))
bodies[9] = body(place(9, {0.2, 1, 0.1}, { name = "hammer", shapes = {
	{ shape = "box", size = {0.7, 0.3, 0.3}, position = {0, 0, 0.5} },
	{ shape = "cylinder", radius = 0.07, length = 1.0 } } }))
bodies[10] = sphere(place(10, {0.5, 1, 0.5}, { name = "ball", radius = 0.42 }))

camera { name = "main", position = {1.2, -7.2, 3.6}, look_at = {0, 0.4, 1.55}, fov = deg(34), size = {1280, 720}, video = "shapes.mp4" }
camera { name = "wires", position = {1.2, -7.2, 3.6}, look_at = {0, 0.4, 1.55}, fov = deg(34), size = {640, 360},
	style = "wireframe", video = "shapes-wires.mp4" }

local start = {}
on_frame(function()
	for k, b in ipairs(bodies) do
		start[k] = start[k] or { momentum = b.angular_momentum, energy = b.kinetic_energy }
	end
end)
expect("each keeps its energy", function()
	local worst = 0
	for k, b in ipairs(bodies) do
		worst = math.max(worst, math.abs(b.kinetic_energy - start[k].energy) / math.max(start[k].energy, 1e-300))
	end
	return worst, 1e-12
end)
expect("each keeps its angular momentum", function()
	local worst = 0
	for k, b in ipairs(bodies) do
		worst = math.max(worst, (b.angular_momentum - start[k].momentum):length() / math.max(start[k].momentum:length(), 1e-300))
	end
	return worst, 1e-12
end)
