-- Touching bodies are hit: rows of spheres and boxes, racks, a pyramid, a bat; the velocities when all is over are printed.
-- What located and stepped make of it is compared by tests/cli/physics-one-law.sh.
local kind = param("kind", "row", "what is hit", {choices = {"row", "rack", "boxes", "pyramid", "bat"}})
local count = param("count", 5, "balls of the row, rows of the rack", {min = 1, max = 12})
local e = param("e", 1.0, "restitution", {min = 0, max = 1})
local mu = param("mu", 0.0, "friction", {min = 0, max = 2})
local off = param("off", 0.0, "how far the cue ball comes from the middle, over its radius", {min = -1.9, max = 1.9})
local grow = param("grow", 1.0, "mass of each ball of the row over the one before", {min = 0.1, max = 10})
local gap = param("gap", 0.0, "between neighbours in the row, m", {min = 0, max = 1e-3})
local wall = param("wall", false, "behind the row", {choices = {false, true}})
local joined = param("joined", false, "balls of the row slide on rods", {choices = {false, true}})
local g = param("g", 0.0, "gravity, on a smooth table", {min = 0, max = 20})
local speed = param("speed", 4.0, "of what hits, m/s", {min = 1e-3, max = 1e3})
local r = 0.03

world { duration = 0.16, frame_rate = 6.25, gravity = {0, 0, -g} }
local ivory = material { name = "ivory", density = 1700, friction = mu, restitution = e }
local smooth = material { name = "smooth", density = 1700, friction = 0, restitution = e }
local bodies = {}
local function ball(x, y, z, mass, velocity)
	bodies[#bodies + 1] = sphere { radius = r, position = {x, y, z}, mass = mass, material = ivory, velocity = velocity }
end

if kind == "row" then
	ball(-0.3, off * r, r, 0.1, {speed, 0, 0})
	for k = 0, count - 1 do
		ball(k * (2 * r + gap), 0, r, 0.1 * grow ^ (k + 1))
		if joined then joint { kind = "slider", a = bodies[#bodies], axis = {1, 0, 0} } end
	end
	if wall then
		plane { point = {(count - 1) * (2 * r + gap) + r, 0, 0}, normal = {-1, 0, 0}, material = ivory }
	end
elseif kind == "rack" then
	ball(-0.3, off * r, r, 0.1, {speed, 0, 0})
	for row = 0, count - 1 do
		for k = 0, row do ball(row * r * math.sqrt(3), (2 * k - row) * r, r, 0.1) end
	end
elseif kind == "bat" then -- a ball hits another one, which touches a bat on a hinge
	ball(-0.3, off * r, r, 0.1, {speed, 0, 0})
	ball(0, 0, r, 0.1)
	local bat = box { size = {2 * r, 8 * r, 2 * r}, position = {2 * r, 0, r}, mass = 0.2, material = ivory }
	joint { kind = "hinge", a = bat, at = {2 * r, 5 * r, r}, axis = {0, 0, 1} }
	bodies[3] = bat
elseif kind == "boxes" then
	for k = 1, count do
		bodies[k] = box { size = {2 * r, 2 * r, 2 * r}, position = {(k - 1) * 2 * r - (k == 1 and 0.3 or 0), 0, r},
			velocity = {k == 1 and speed or 0, 0, 0}, material = ivory }
	end
else -- nine, four and one, on a floor; one falls on the top
	for layer = 0, 2 do
		for i = 0, 2 - layer do
			for j = 0, 2 - layer do
				ball((2 * i + layer) * r, (2 * j + layer) * r, r + layer * r * math.sqrt(2), 0.1)
			end
		end
	end
	ball(2 * r, 2 * r, r + 2 * r * math.sqrt(2) + 2 * r + 0.3, 0.1, {0, 0, -speed})
end
if g > 0 or kind == "pyramid" then plane { normal = {0, 0, 1}, material = smooth } end

expect("all velocities are finite", function()
	for _, body in ipairs(bodies) do
		local v = body == bodies[3] and kind == "bat" and body.angular_velocity or body.velocity
		print(("velocity %.17g %.17g %.17g"):format(v.x, v.y, v.z))
	end
	return true
end)
