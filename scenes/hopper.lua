-- Three hundred bodies of all shapes run through a hopper into a box below.
-- Watch: they arch over the opening and break through again; round ones are ahead, flat ones lie across.
-- Expected end: none has got lost through a wall, none overlaps another; what is below the hopper lies in the box.
-- Boxes, capsules, cylinders, hulls, spheres and unions in one heap: stepped, as their contacts are too dense to locate.
-- Try: --param opening=0.5 (it jams), --param mu=0.1, --param n=5000 --param seconds=10 (half an hour)
-- Takes: 50 s of processor time, 15 s without its film.
local n = param("n", 300, "bodies", {min = 1, max = 200000})
local opening = param("opening", 1.0, "side of the hole, m", {min = 0.2, max = 3})
local mu = param("mu", 0.4, "friction", {min = 0, max = 2})
local seconds = param("seconds", 6.0, "simulated", {min = 0.05, max = 1000})
local palette = require "rbsim.palette"
local g, r, wide, steep = 9.81, 0.1, 5, deg(50)

world { title = "A hopper with " .. n .. " bodies", duration = seconds, frame_rate = 60, gravity = {0, 0, -g}, method = "stepped", seed = 11 }
local stone = material { name = "stone", density = 2000, friction = mu, restitution = 0 }
local steel = material { name = "steel", friction = mu, restitution = 0, color = {0.60, 0.64, 0.68} }

-- Four plates of the funnel, from the rim of the hole outwards and upwards; their sides reach into each other. Four more
-- stand on their upper edges. The box below is a floor with four plates.
local hole, long = 4, (wide - opening) / 2 / math.cos(steep)
local rim = hole + long * math.sin(steep)
for k = 0, 3 do
	local a = k * math.pi / 2
	local out, aside = vec3(math.cos(a), math.sin(a), 0), vec3(-math.sin(a), math.cos(a), 0)
	local middle = opening / 2 + long / 2 * math.cos(steep)
	plane { name = "slope " .. k, material = steel, size = {wide, long}, axis = aside, visible = k ~= 3,
		normal = math.cos(steep) * vec3(0, 0, 1) - math.sin(steep) * out,
		point = middle * out + vec3(0, 0, hole + long / 2 * math.sin(steep)) }
	plane { name = "wall " .. k, material = steel, size = {wide, 40}, axis = aside, visible = false,
		normal = -1 * out, point = wide / 2 * out + vec3(0, 0, rim + 20) }
	plane { name = "side " .. k, material = steel, size = {6, 3}, axis = aside, visible = k ~= 3,
		normal = -1 * out, point = 3 * out + vec3(0, 0, 1.5) }
end
plane { name = "floor", material = steel, color = {0.70, 0.69, 0.66}, texture = "none" }

-- Shapes of about the size r, in turn.
local function solid(kind, keys)
	if kind == 0 then
		keys.size = {1.6 * r, 1.3 * r, 1.0 * r}
		return box(keys)
	elseif kind == 1 then
		keys.radius = 0.8 * r
		return sphere(keys)
	elseif kind == 2 then
		keys.radius, keys.length = 0.5 * r, 1.0 * r
		return capsule(keys)
	elseif kind == 3 then
		keys.radius, keys.length = 0.8 * r, 0.8 * r
		return cylinder(keys)
	elseif kind == 4 then
		local s = 0.7 * r
		keys.points = {{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}, {-s, -s, -s}}
		return hull(keys)
	end
	keys.shapes = {{ shape = "sphere", radius = 0.5 * r, position = {-0.5 * r, 0, 0} }, { shape = "sphere", radius = 0.5 * r, position = {0.5 * r, 0, 0} }}
	return body(keys)
end
local bodies = {}
local across = math.floor((wide - 0.4) / (2.6 * r))
for k = 0, n - 1 do
	local x, y, z = k % across, k // across % across, k // (across * across)
	local function between(a, b) return a + (b - a) * math.random() end
	local ax, ay, az = between(-1, 1), between(-1, 1), between(0.1, 1)
	bodies[k + 1] = solid(k % 6, { name = "b" .. k + 1, material = stone, color = palette.at(k % 6 + 1), texture = "none",
		orientation = {axis = {ax, ay, az}, angle = between(0, 3)},
		position = {(x - (across - 1) / 2) * 2.6 * r, (y - (across - 1) / 2) * 2.6 * r, rim + 2 * r + 2.6 * r * z} })
end
camera { name = "main", position = {6.5, -15, 9}, look_at = {0, 0, 5.2}, fov = deg(48), size = {960, 960}, overlay = {"title", "time"},
	video = "hopper.mp4" }

expect("none is lost through a wall", function()
	local out = 0
	for _, one in ipairs(bodies) do
		local p = one.position
		local room = p.z > rim and wide / 2 or 3
		if math.abs(p.x) > room or math.abs(p.y) > room or p.z < 0 then out = out + 1 end
	end
	return out, 0
end)
expect("overlap stays within the tolerance", function() return max_penetration(), penetration_tolerance() end)
