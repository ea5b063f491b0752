-- SPDX-License-Identifier: MIT
-- C10: forty rods, boxes, cylinders and dumb-bells hit a floor, turning, each with friction and restitution of its own at
-- random. Answer: no impact adds energy (Stronge 1990), and without friction one with e = 1 takes none.
local verify = require "rbsim.verify"
local batch = param("batch", 1, "which forty", {choices = {1, 2, 3}})
local lossless = param("lossless", false, "no friction, e = 1", {choices = {false, true}})
math.randomseed(batch)

verify.case { title = "Impacts lose energy", duration = 1, gravity = {0, 0, -9.81}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {20, 10, 60}, quick = "base", length = 4 }
local function between(a, b) return a + (b - a) * math.random() end
local function direction()
	local x, y, z = between(-1, 1), between(-1, 1), between(-1, 1)
	return vec3(x, y, z):unit()
end
local bodies, least, first = {}, {}, {}
local function energy_of(k) return bodies[k].kinetic_energy + bodies[k].mass * 9.81 * verify.position(bodies[k]).z end
local ground = material { name = "ground" }
verify.plane { group = "floor", collides_with = "bodies", material = ground }
for k = 1, 40 do
	local name, kind = "body " .. k, k % 4
	local stuff = material { name = "stuff " .. k }
	contact_pair(ground, stuff, {friction = lossless and 0 or between(0, 1.5), restitution = lossless and 1 or between(0, 1)})
	local keys = {name = name, group = "bodies", collides_with = "floor", material = stuff, mass = between(0.1, 10),
		position = {between(-2, 2), between(-2, 2), between(0.7, 1)}, orientation = {axis = direction(), angle = between(0, 3)},
		velocity = {between(-3, 3), between(-3, 3), between(-3, 0)}, angular_velocity = between(0, 10) * direction()}
	if kind == 0 then
		keys.radius, keys.length = between(0.01, 0.1), between(0.2, 0.8)
		bodies[k] = verify.capsule(keys)
	elseif kind == 1 then
		keys.size = {between(0.05, 0.6), between(0.05, 0.6), between(0.05, 0.6)}
		bodies[k] = verify.box(keys)
	elseif kind == 2 then
		keys.radius, keys.length = between(0.02, 0.3), between(0.02, 0.5)
		bodies[k] = verify.cylinder(keys)
	else
		local r = between(0.05, 0.15)
		keys.shapes = {{ shape = "sphere", radius = r, position = {-0.3, 0, 0} }, { shape = "sphere", radius = r, position = {0.3, 0, 0} }}
		bodies[k] = verify.body(keys)
	end
	first[k] = energy_of(k)
	least[k] = first[k]
end

-- Heights that are rounded by d are energies rounded by d/h.
if lossless then
	expect_always("each keeps its energy, relative", function()
		local worst = 0
		for k = 1, #bodies do worst = verify.larger(worst, math.abs(energy_of(k) / first[k] - 1)) end
		return worst, 1e-11 + 64 * verify.rounding
	end)
else
	expect_always("none gains energy, relative", function()
		local worst = -1
		for k = 1, #bodies do
			local now = energy_of(k)
			worst, least[k] = verify.larger(worst, (now - least[k]) / first[k]), math.min(now, least[k])
		end
		return worst, 1e-12 + 64 * verify.rounding
	end)
end
expect("they do hit", function() return collisions() >= 40 end)
