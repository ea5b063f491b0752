-- Two heaps of rubble, 240 m across and held together by nothing but their own gravitation, meet off their middles.
-- Watch: they turn round each other as they sink into one another, and grains of both colours mix only where they touch.
-- Expected end: one heap, which turns with the angular momentum of the beginning; no grain overlaps another one.
-- Small asteroids are such heaps: at 0.11 m/s these would part for ever, and a collision slower than walking takes hours.
-- Try: --param speed=3 (they fly apart in pieces and single grains), --param grains=150 --param aside=0
-- Takes: a second of processor time.
local speed = param("speed", 0.9, "as they meet, in mutual escape speeds", {min = 0})
local aside = param("aside", 0.8, "of their middles, in radii", {min = 0, max = 1.5})
local count = param("grains", 40, "of each heap", {min = 2, max = 5000})
local lattice = require "rbsim.lattice"
local G, hour, radius, density = 6.67430e-11, 3600, 30, 2500
world { title = "Rubble piles", duration = 4 * hour, frame_rate = 48 / hour, gravitation = {G = G}, method = "stepped", seed = 3 }
local rock = material { name = "rock", density = density, friction = 0.6, restitution = 0.4 }

-- The sites of a close packing nearest to the middle; those that fit ill move as the heap settles under its weight.
local function heap(name, color, centre, velocity)
	local n = math.ceil((count / 4) ^ (1 / 3) * 1.3) + 1
	local sites = lattice.fcc { count = {n, n, n}, spacing = 2.04 * radius, jitter = 0.015 * radius }
	local off = vec3(0.3, 0.2, 0.1) * radius
	table.sort(sites, function(p, q) return (p - off):length() < (q - off):length() end)
	local grains = {}
	for i = 1, count do
		local shade = 0.8 + 0.2 * math.random()
		grains[i] = sphere { name = name .. " " .. i, radius = radius, material = rock, position = centre + sites[i] - off,
			velocity = velocity, texture = "none", color = {shade * color[1], shade * color[2], shade * color[3]} }
	end
	return grains
end
local mass = count * density * 4 / 3 * math.pi * radius ^ 3
local size = radius * (count / 0.65) ^ (1 / 3)
local apart = 3 * size
-- faster by what they gain until balls of their size touch
local escape = math.sqrt(4 * G * mass / (2 * size))
local slow = math.sqrt(math.max(0, speed ^ 2 - 1 + 2 * size / apart)) * escape
local left = heap("left", {0.85, 0.55, 0.3}, vec3(-apart / 2, -aside * size / 2, 0), vec3(slow / 2, 0, 0))
local right = heap("right", {0.45, 0.6, 0.85}, vec3(apart / 2, aside * size / 2, 0), vec3(-slow / 2, 0, 0))
camera { name = "above", position = {0, -1.3 * apart, 2.2 * apart}, look_at = {0, 0, 0}, fov = deg(30), speed = 0.5 * hour,
	overlay = {"title", "time"}, background = {0.02, 0.02, 0.04},
	lights = {{kind = "sun", direction = {-0.6, -0.7, 0.6}}, {kind = "ambient", intensity = 0.08}} }

local all = {}
for _, heap in ipairs {left, right} do
	for _, grain in ipairs(heap) do all[#all + 1] = grain end
end
local function centre()
	local sum = vec3(0, 0, 0)
	for _, grain in ipairs(all) do sum = sum + grain.position / #all end
	return sum
end
local start, turning, moved = nil, nil, 0
on_frame(function()
	start, turning = start or centre(), turning or angular_momentum().z
	moved = math.max(moved, (centre() - start):length())
end)
-- tolerance: 1e-4 of a radius
expect("no grain overlaps another one, m", function() return max_penetration(), 1e-4 * radius end)
expect("the middle of all stays, m", function() return moved, 1e-9 * size end)
-- forces of contact act within a step of 19 s, a hundredth of the time in which a heap falls in
if aside > 0 then
	expect("angular momentum stays, share", function() return math.abs(angular_momentum().z / turning - 1), 0.02 end)
end
local function outside()
	local middle, far = centre(), 0
	for _, grain in ipairs(all) do
		if (grain.position - middle):length() > 3 * size then far = far + 1 end
	end
	return far
end
if speed < 1 then expect("in the heap at the end, but for", function() return outside(), 0.05 * #all end) end
result("grains that are gone", outside)
