-- A chain hangs between two hooks, and is cut in the middle: two halves fall, swing and whip.
-- Watch: before the cut nothing moves at all; after it the loose ends fall faster than a stone would.
-- Expected end: until the cut every link stands still, and the cut itself costs no energy.
-- Of equal rods in a row the slopes go up evenly, link by link: the catenary of rods, which a chain's is for many.
-- Try: --param links=8, --param sag=1.5
-- Takes: some seconds.
local count = param("links", 12, "links, an even number", {min = 4, max = 60})
local steep = param("sag", 1.2, "slope of the outermost links", {min = 0.2, max = 5})
local cut = param("cut", 0.5, "s, when it is cut", {min = 0, max = 2})
local g, each = 9.81, 0.25
assert(count % 2 == 0, "links must be an even number")

world { title = "A chain that is cut", duration = 2, frame_rate = 60, gravity = {0, 0, -g} }
material { name = "iron", density = 7800, friction = 0, color = {0.45, 0.46, 0.5}, shininess = 60 }
-- Forces of a hanging chain: level everywhere the same, upright less by a link's weight from joint to joint.
local joints_at = {vec3(0, 0, 0)}
for k = 1, count do
	local slope = steep * (2 * k - count - 1) / (count - 1)
	joints_at[k + 1] = joints_at[k] + each * vec3(1, 0, slope):unit()
end
local shift = vec3(-joints_at[count + 1].x / 2, 0, 2)
local links, pins = {}, {}
for k = 1, count do
	local p, q = joints_at[k] + shift, joints_at[k + 1] + shift
	local d = q - p
	links[k] = capsule { name = "link " .. k, radius = 0.03, length = each - 0.06, material = "iron", position = (p + q) / 2,
		orientation = {axis = {0, 1, 0}, angle = math.atan(d.x, d.z)}, collides_with = {} }
	pins[k] = joint { name = "pin " .. k, kind = "hinge", a = links[k], b = links[k - 1], at = p, axis = {0, 1, 0}, radius = 0.012 }
end
joint { name = "hook", kind = "hinge", a = links[count], at = joints_at[count + 1] + shift, axis = {0, 1, 0}, radius = 0.012 }
local middle = pins[count // 2 + 1]
camera { name = "front", position = {0, -4.6, 1.2}, look_at = {0, 0, 1.15}, overlay = {"title", "time"},
	trails = {links[count // 2], links[count // 2 + 1]} }

local start, first, moved, mass = {}, nil, 0, 0
for k = 1, count do
	start[k] = vec3(links[k].position)
	mass = mass + links[k].mass
end
state.cut = false
on_step(function(t)
	if not state.cut and t >= cut then
		middle:release()
		state.cut = true
	end
end)
on_frame(function(t)
	first = first or energy()
	if state.cut or t > cut then return end
	for k = 1, count do moved = math.max(moved, (links[k].position - start[k]):length()) end
end)
expect("until the cut nothing moves, m", function() return moved, 1e-9 end)
expect("the energy is that of the start, J", function() return math.abs(energy() - first), 1e-8 * mass * g end)
expect("it has been cut, and has fallen", function() return middle.released and links[count // 2].position.z < start[count // 2].z end)
