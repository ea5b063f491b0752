-- SPDX-License-Identifier: MIT
-- G11: a star cluster of Plummer's density in equilibrium, for two crossing times. Answer: the energy stays, as does the ratio
-- of the kinetic energy to half of the potential one (virial theorem), but for what the chance of so many stars does.
--
-- Places and speeds are drawn as in Aarseth, Henon, Wielen, Astron. Astrophys. 37 (1974) 183, in units with G = M = 1 and the
-- energy -1/4: then a crossing takes 2 sqrt(2). The speeds are scaled so that 2 K/|W| is 1 at the start.
local verify = require "rbsim.verify"
local count = param("stars", 32, "how many", {choices = {32, 1000}})
local crossing = 2 * math.sqrt(2)

local long = "a thousand stars take long: cases G01 to G10 vary it"
verify.case { title = "A cluster of stars", duration = 2 * crossing, time_step = {0.25}, frame_rate = {8},
	gravitation = {G = 1, softening = 0.01}, quick = "base", processor_seconds = 7200, turns = {0},
	leave_out = {shift = long, turn = long, time_step = long, frame_rate = long, harmless = long, zero_field = long} }
local plain = material { name = "plain", friction = 0 }

local function direction()
	local z, angle = 2 * math.random() - 1, 2 * math.pi * math.random()
	local r = math.sqrt(1 - z * z)
	return vec3(r * math.cos(angle), r * math.sin(angle), z)
end
local places, velocities = {}, {}
local place, velocity = vec3(0, 0, 0), vec3(0, 0, 0)
for i = 1, count do
	-- the radius within which a share of the mass lies, but for the outermost thousandth
	local r = 1 / math.sqrt((0.999 * (math.random() * 0.999 + 0.001)) ^ (-2 / 3) - 1)
	local q, y
	repeat q, y = math.random(), 0.1 * math.random() until y < q * q * (1 - q * q) ^ 3.5
	places[i] = 3 * math.pi / 16 * r * direction()
	velocities[i] = math.sqrt(2) * q * (1 + r * r) ^ -0.25 * math.sqrt(16 / (3 * math.pi)) * direction()
	place, velocity = place + places[i] / count, velocity + velocities[i] / count
end
local kinetic, potential = 0, 0
for i = 1, count do
	places[i], velocities[i] = places[i] - place, velocities[i] - velocity
	kinetic = kinetic + velocities[i]:dot(velocities[i]) / (2 * count)
	for k = 1, i - 1 do
		local d = places[i] - places[k]
		potential = potential - 1 / (count ^ 2 * math.sqrt(d:dot(d) + 1e-4))
	end
end
local scale, stars = math.sqrt(-potential / (2 * kinetic)), {}
for i = 1, count do
	stars[i] = verify.sphere { radius = 1e-4, mass = 1 / count, position = places[i], velocity = scale * velocities[i],
		material = plain, collides_with = {} }
end

local first, spun, drift, ratio, linear, angular = nil, nil, 0, 0, 0, 0
on_frame(function()
	local moving = 0
	for _, star in ipairs(stars) do moving = moving + star.kinetic_energy end
	first, spun = first or energy(), spun or angular_momentum()
	drift = verify.larger(drift, math.abs(energy() / first - 1))
	ratio = verify.larger(ratio, math.abs(2 * moving / (moving - energy()) - 1))
	linear = verify.larger(linear, momentum():length())
	angular = verify.larger(angular, (angular_momentum() - spun):length())
end)
expect("energy, share", function() return drift, 1e-10 end)
-- of a thousand the fluctuation is 1/sqrt(1000); softening takes up to a hundredth
expect("2 K/|W| - 1", function() return ratio, 0.05 * math.max(1, math.sqrt(1000 / count)) end)
-- of masses, speeds and distances of 1
expect("momentum, kg m/s", function() return linear, 1e-13 end)
expect("angular momentum, kg m^2/s", function() return angular, 1e-12 end)
