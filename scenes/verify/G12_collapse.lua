-- SPDX-License-Identifier: MIT
-- G12: a cold cloud of grains, at rest, falls in on itself and becomes a ball of grains (by steps). Answer: while nothing
-- touches, each shell follows t = t_ff 2/pi (acos sqrt(x) + sqrt(x (1 - x))) with x its radius as a share of the first and
-- t_ff = sqrt(3 pi/(32 G rho)); spheres without friction end in random close packing, of a share of 0.64.
local verify = require "rbsim.verify"
local rubble = require "rubble"
local count = param("grains", 50, "how many", {choices = {50, 2000}})
local angle = param("opening_angle", 0.5, "of the tree", {choices = {0.5, 0.0}})
-- mass and radius of the cloud 1; the ball has a quarter of that, if grains fill 0.62 of it
local radius = 0.25 * (0.62 / count) ^ (1 / 3)

local why = "chaotic from the first impact on, and long"
verify.case { title = "A cold collapse", duration = count >= 1000 and 3 or 2, time_step = {2e-3}, frame_rate = {50},
	gravitation = {G = 1, opening_angle = angle}, method = "stepped", quick = "base", processor_seconds = 7200, turns = {0},
	leave_out = {shift = why, turn = why, time_step = why, frame_rate = why, harmless = why, zero_field = why} }
local smooth = material { name = "smooth", friction = 0, restitution = 0.5 }
local spacing = (math.sqrt(2) * 4 / 3 * math.pi / count) ^ (1 / 3)
local grains = rubble.cloud { count = count, radius = radius, spacing = spacing, mass = 1 / count, material = smooth,
	jitter = 0.3 }

-- by the distance from the origin: the half-mass radius and those about it, so that single grains do not matter
local function half_mass()
	local r, sum = {}, 0
	for i, g in ipairs(grains) do r[i] = verify.position(g):length() end
	table.sort(r)
	local from, to = math.floor(0.45 * count), math.ceil(0.55 * count)
	for i = from, to do sum = sum + r[i] end
	return sum / (to - from + 1)
end
local start, t_ff, wrong, halved, deepest, middle, spun, centre = nil, nil, 0, false, 0, vec3(0, 0, 0), 0, 0
on_frame(function(t)
	local total = rubble.total(grains)
	if not start then
		start, middle = half_mass(), total.centre
		t_ff = math.sqrt(3 * math.pi / 32 * (4 / 3 * math.pi * start ^ 3) / 0.5)
	end
	if not halved then
		local x = half_mass() / start
		-- from the law, the time for this radius; as a difference of radii by the speed of the fall
		local law = t_ff * 2 / math.pi * (math.acos(math.sqrt(math.min(1, x))) + math.sqrt(x * math.max(0, 1 - x)))
		local speed = math.pi / 2 / t_ff * math.sqrt(math.max(0, 1 / x - 1))
		wrong = verify.larger(wrong, math.abs(t - law) * speed / x)
		halved = x < 0.5
	end
	deepest = verify.larger(deepest, max_penetration())
	spun = verify.larger(spun, angular_momentum():length())
	centre = verify.larger(centre, (total.centre - middle):length())
end)
if count >= 1000 then -- few are no sphere
	expect("half-mass radius until it has halved, share", function() return wrong, 0.01 end)
end
expect("has halved", function() return halved end)
-- tolerance: 1e-4 of the smallest radius
expect("overlap, m", function() return deepest, 1e-4 * radius end)
local function packing()
	local total = rubble.total(grains)
	local inner = total.radius / 2
	local filled = 0
	for _, g in ipairs(grains) do
		-- the share of a grain that is inside, as if it were cut by a plane
		local out = ((verify.position(g) - total.centre):length() - inner) / radius
		if out <= -1 then
			filled = filled + 1
		elseif out < 1 then
			filled = filled + (1 - out) ^ 2 * (2 + out) / 4
		end
	end
	return filled * (radius / inner) ^ 3
end
if count >= 1000 then -- the inner half of few has order from the middle one on
	expect("packing of the inner half, at least", function() return -packing(), -0.6 end)
	expect("packing of the inner half, at most", function() return packing(), 0.66 end)
end
expect("centre of mass, m", function() return centre, 1e-12 end)
-- none to begin with, and impulses between two bodies act at one point
expect("angular momentum, kg m^2/s", function() return spun, 1e-10 end)
result("radius", function() return rubble.total(grains).radius end, {unit = "m"})
result("packing", packing)
result("speed of the fastest grain", function()
	local most = 0
	for _, g in ipairs(grains) do most = math.max(most, g.velocity:length()) end
	return most
end, {unit = "m/s"})
