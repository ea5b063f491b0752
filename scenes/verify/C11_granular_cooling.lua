-- SPDX-License-Identifier: MIT
-- C11: a dilute gas of smooth spheres that lose energy in their impacts cools as T = T0/(1 + t/tau)^2 (Haff, J. Fluid Mech.
-- 134 (1983) 401). With Maxwell's distribution an impact takes (1 - e^2) T on average, and each sphere has
-- 4 n s^2 g sqrt(pi T/m) of them a second, s the diameter and g = (1 - eta/2)/(1 - eta)^3, so that
-- 1/tau = (1 - e^2) n s^2 g sqrt(pi T0/m) 2/3.
local verify = require "rbsim.verify"
local lattice = require "rbsim.lattice"
local e = param("e", 0.9, "restitution", {choices = {0.9, 0.95}})
local side, radius, duration = 11, 0.5, 120
local count = side ^ 3
local spacing = 2.2 -- of the lattice at the start
local half = side * spacing / 2

verify.case { title = "A gas that cools", duration = duration, time_step = {0.1, 0.01, 1}, frame_rate = {1, 10, 3},
	quick = "none", processor_seconds = 240 }
local soft = material { name = "soft", friction = 0, restitution = e }
local hard = material { name = "hard", friction = 0, restitution = 1 }
contact_pair(soft, hard, { friction = 0, restitution = 1 })
for _, n in ipairs {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}} do
	verify.plane { normal = n, point = -half * vec3(n), material = hard }
end
-- Maxwell's distribution with <v^2> = 3, so that T0 = m
local function normal() return math.sqrt(-2 * math.log(1 - math.random())) * math.cos(2 * math.pi * math.random()) end
local bodies, square = {}, 0
local velocities = {}
for i = 1, count do
	velocities[i] = vec3(normal(), normal(), normal())
	square = square + velocities[i]:dot(velocities[i])
end
local scale = math.sqrt(3 * count / square)
for i, p in ipairs(lattice.cubic { count = {side, side, side}, spacing = spacing }) do
	bodies[i] = verify.sphere { radius = radius, mass = 1, position = p, velocity = scale * velocities[i], material = soft }
end

-- Centres are in the box less a radius all round. Of the partners that a sphere a distance z < s from a wall could have, a
-- share (1 - z/s)/2 would be beyond it: a quarter on average, over six layers s thick.
local edge = 2 * (half - radius)
local volume, open = edge ^ 3, 1 - 6 / 4 * 2 * radius / edge
local n = count / volume
local eta = n * 4 / 3 * math.pi * radius ^ 3
local g = (1 - eta / 2) / (1 - eta) ^ 3
local rate = open * (1 - e ^ 2) * n * (2 * radius) ^ 2 * g * math.sqrt(math.pi) * 2 / 3

state.times, state.temperatures = {}, {}
on_frame(function(t)
	local energy = 0
	for _, body in ipairs(bodies) do energy = energy + body.kinetic_energy end
	state.times[#state.times + 1] = t
	state.temperatures[#state.temperatures + 1] = 2 / 3 * energy / count
end)

-- slope and value at zero of the straight line through points
local function line(x, y)
	local mx, my, xx, xy = 0, 0, 0, 0
	for i = 1, #x do mx, my = mx + x[i] / #x, my + y[i] / #x end
	for i = 1, #x do xx, xy = xx + (x[i] - mx) ^ 2, xy + (x[i] - mx) * (y[i] - my) end
	return xy / xx, my - xy / xx * mx
end

-- Bars are of the statistics of 1331 spheres, and of what the walls and the first impacts do.
expect("1/tau, relative", function()
	local y = {}
	for i, T in ipairs(state.temperatures) do y[i] = 1 / math.sqrt(T) end
	return math.abs(line(state.times, y) / rate - 1), 0.05
end)
expect("exponent", function()
	local x, y = {}, {}
	for i, T in ipairs(state.temperatures) do
		x[i], y[i] = math.log(1 + rate * state.times[i]), math.log(T)
	end
	return math.abs(line(x, y) + 2), 0.06
end)
