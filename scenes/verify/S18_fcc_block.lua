-- SPDX-License-Identifier: MIT
-- S18: touching spheres in a face-centred cubic block (74 % of the space) fill a box, with gravity. Answer: nothing moves.
local verify = require "rbsim.verify"
local lattice = require "rbsim.lattice"
local radius, cells = 0.05, 3

verify.case { title = "A block of touching spheres", duration = 100, gravity = {0, 0, -9.81}, time_step = {0.1, 0.01, 1},
	frame_rate = {1, 0.1, 0.3}, quick = "none", processor_seconds = 120 }
local steel = material { name = "steel", friction = 0.5, restitution = 0 }
-- Centres go from 0 to (cells - 1/2) edges; the walls touch the outermost.
local edge = 2 * radius * math.sqrt(2)
local half = (cells - 0.5) * edge / 2
for _, n in ipairs {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}} do
	verify.plane { normal = n, point = -(half + radius) * vec3(n), material = steel }
end
local bodies, start = {}, {}
for i, p in ipairs(lattice.fcc { count = {cells, cells, cells}, spacing = 2 * radius }) do
	bodies[i] = verify.sphere { radius = radius, mass = 1, position = p, material = steel }
	start[i] = vec3(bodies[i].position)
end

expect_always("nothing moves, J/kg", function()
	local energy = 0
	for _, body in ipairs(bodies) do energy = energy + body.kinetic_energy end
	return energy / #bodies, 1e-16
end)
expect("nothing creeps, m", function()
	local far = 0
	for i, body in ipairs(bodies) do far = verify.larger(far, (body.position - start[i]):length()) end
	return far, 1e-12 + verify.rounding
end)
