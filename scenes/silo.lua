-- A tall silo is filled with beads, and its floor is lowered slowly.
-- Watch: the beads come to lie; when the floor gives way the walls begin to carry, and the load on the floor falls off.
-- Expected end: the floor carries less than half of the beads; the walls carry the rest by friction.
-- Janssen (1895): the load saturates with the height, (D / 4 mu K) (1 - exp(-4 mu K h / D)) of rho g over the section.
-- Try: --param mu=0 (the floor carries all), --param n=200 (a low column: nearly all), --param mu=0.8
-- Takes: 15 s of processor time.
local n = param("n", 500, "beads", {min = 10, max = 20000})
local mu = param("mu", 0.5, "friction of walls and beads", {min = 0, max = 2})
local wide = param("wide", 5, "width of the square silo, diameters of a bead", {min = 3, max = 40})
local g, r, fall, begins = 9.81, 0.01, 0.002, 0.6
local D = 2 * r * wide
local across = math.floor((D - 0.2 * r) / (2.05 * r))
local high = 2.1 * r * n / across / across

world { title = "The load on the floor of a silo", duration = 1.2, frame_rate = 60, gravity = {0, 0, -g}, method = "stepped", seed = 4 }
local glass = material { name = "glass", density = 2500, friction = mu, restitution = 0, color = {0.55, 0.70, 0.80} }
local steel = material { name = "steel", friction = mu, restitution = 0, color = {0.60, 0.64, 0.68} }
for k = 0, 3 do
	local out = vec3(math.cos(k * math.pi / 2), math.sin(k * math.pi / 2), 0)
	plane { name = "wall " .. k, material = steel, normal = -1 * out, point = D / 2 * out, visible = false }
	box { name = "edge " .. k, static = true, collides_with = {}, material = steel, size = {0.4 * r, 0.4 * r, high},
		position = (D / 2 + 0.2 * r) * vec3(out.x - out.y, out.x + out.y, 0) + vec3(0, 0, high / 2) }
end
local floor = plane { name = "floor", material = steel, motion = function(t)
	local late = math.max(0, t - begins)
	return {0, 0, -fall * late}, nil, {0, 0, t > begins and -fall or 0}
end }
local beads = {}
for k = 0, n - 1 do
	local x, y, z = k % across, k // across % across, k // (across * across)
	local function off() return 0.04 * r * (math.random() - 0.5) end
	beads[k + 1] = sphere { radius = r, material = glass, texture = "none",
		position = {(x - (across - 1) / 2) * 2.05 * r + off(), (y - (across - 1) / 2) * 2.05 * r + off(), (1.1 + 2.1 * z) * r} }
end
camera { name = "main", position = {0, -1.9 * high - 4 * D, 0.7 * high}, look_at = {0, 0, 0.48 * high}, fov = deg(30), size = {480, 960},
	overlay = {"title", "time"}, video = "silo.mp4" }

-- Means of the last quarter of a second, when the walls carry as much as they can.
local load, frames, weight = 0, 0, n * 2500 * 4 / 3 * math.pi * r ^ 3 * g
on_frame(function(t)
	if t > 0.95 then
		load, frames = load - floor.force.z, frames + 1
	end
end)
local function share() return load / frames / weight end
-- Solves (1 - exp(-x)) / x = share for x = 4 mu K h / D.
local function saturation()
	local low, top = 1e-9, 1e3
	for _ = 1, 60 do
		local x = (low + top) / 2
		if (1 - math.exp(-x)) / x > share() then low = x else top = x end
	end
	return low
end
local function height()
	local sum = 0
	for _, bead in ipairs(beads) do sum = sum + bead.position.z end
	return 2 * sum / n
end
probe("load on the floor over the weight", function() return -floor.force.z / weight end)
result("load on the floor over the weight", share)
result("Janssen's K", function() return saturation() * D / (4 * math.max(mu, 1e-9) * height()) end)
result("height over width", function() return height() / D end)
-- What slides down a wall carries at most mu times its own pressure: K is between the active and the passive limit.
if mu >= 0.3 and n >= 400 and wide <= 6 then
	-- (1 - sin 40 deg) / (1 + sin 40 deg): no beads have more internal friction.
	expect("the walls carry most of it", function() return share(), 0.5 end)
	expect("Janssen's K is not below the active limit", function() return 0.217, saturation() * D / (4 * mu * height()) end)
elseif mu == 0 then
	expect("the floor carries all", function() return math.abs(share() - 1), 0.02 end)
end
expect("overlap stays within the tolerance", function() return max_penetration(), penetration_tolerance() end)
