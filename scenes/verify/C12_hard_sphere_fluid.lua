-- SPDX-License-Identifier: MIT
-- C12: the pressure of elastic hard spheres. Answer: p = n k T Z with Z = (1 + x + x^2 - x^3)/(1 - x)^3 at the packing fraction
-- x (Carnahan, Starling, J. Chem. Phys. 51 (1969) 635; within 0.3 % of the true one). There are walls here and no periodic
-- box, so p is taken where a wall is flat, more than three diameters from its edges, and n as far from all walls.
local verify = require "rbsim.verify"
local lattice = require "rbsim.lattice"
local packing = param("packing", 0.1, "of the box", {choices = {0.1, 0.2}})
local side, radius, duration = 12, 0.5, 80
local count, sigma = side ^ 3, 1
local spacing = (math.pi / 6 / packing) ^ (1 / 3)
local edge = side * spacing
local flat = edge / 2 - 3 * sigma

verify.case { title = "A fluid of hard spheres", duration = duration, time_step = {0.1, 0.01, 1}, frame_rate = {2, 1, 3},
	quick = "none", processor_seconds = 2400, -- under a field all pairs are looked at
	turns = {0, 1}, leave_out = {turn = "another order of the last digits is another sample"} }
local hard = material { name = "hard", friction = 0, restitution = 1 }
local walls = {}
for k, n in ipairs {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}} do
	verify.plane { name = "wall " .. k, normal = n, point = -edge / 2 * vec3(n), material = hard }
	walls["wall " .. k] = vec3(n)
end
local function normal() return math.sqrt(-2 * math.log(1 - math.random())) * math.cos(2 * math.pi * math.random()) end
local bodies, square = {}, 0
for i, p in ipairs(lattice.cubic { count = {side, side, side}, spacing = spacing }) do
	local v = vec3(normal(), normal(), normal())
	square = square + v:dot(v)
	bodies[i] = verify.sphere { radius = radius, mass = 1, position = p, velocity = v, material = hard }
end
local T = square / (3 * count)

-- The lattice melts in the first tenth.
state.push, state.inside, state.samples = 0, 0, 0
on_collision(function(c)
	local n = walls[c.b.name] or walls[c.a.name]
	if not n or time() < duration / 10 then return end
	local p = verify.back(c.point)
	p = p - p:dot(n) * n
	if math.abs(p.x) < flat and math.abs(p.y) < flat and math.abs(p.z) < flat then
		state.push = state.push + c.impulse:length()
	end
end)
on_frame(function(t)
	if t < duration / 10 then return end
	state.samples = state.samples + 1
	for _, body in ipairs(bodies) do
		local p = verify.position(body)
		if math.abs(p.x) < flat and math.abs(p.y) < flat and math.abs(p.z) < flat then state.inside = state.inside + 1 end
	end
end)

expect("Z, relative", function()
	local n = state.inside / state.samples / (2 * flat) ^ 3
	local x = n * math.pi / 6 * sigma ^ 3
	local p = state.push / (6 * (2 * flat) ^ 2 * 0.9 * duration)
	local wanted = (1 + x + x ^ 2 - x ^ 3) / (1 - x) ^ 3
	return math.abs(p / (n * T) / wanted - 1), 0.015
end)
expect("energy is kept, relative", function()
	local energy = 0
	for _, body in ipairs(bodies) do energy = energy + body.kinetic_energy end
	return math.abs(energy / (square / 2) - 1), 1e-12
end)
