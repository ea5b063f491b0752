-- SPDX-License-Identifier: MIT
-- G01: two bodies on an ellipse, both of one mass or one of them a test body (its gravitational mass is 0), a hundred times
-- round. Answer: after each period they are back; energy and the vector to the pericentre stay.
--
-- The numbers at the pericentre are exact: distance 1, G (m1 + m2) = a v with a = 1/(1 - e) and the speed v = (1 + e) a. What
-- a relative error x of the speed there makes of the place after k periods is 6 pi k x ((1 + e)/(1 - e))^1.5 in units of a:
-- the error of the energy there is (1 + e)/(1 - e) times larger in the period. A passage of the pericentre is right to a
-- quarter of the rounding of a number, and errors of n passages add up as a random walk does, in time: sqrt(n^3/3).
local verify = require "rbsim.verify"
local orbit = param("orbit", "0.5", "eccentricity, and whether one is a test body",
	{choices = {"0.5", "0.9", "0.99", "0.5 test", "0.9 test", "0.99 test"}})
local a = ({["0.5"] = 2, ["0.9"] = 10, ["0.99"] = 100})[orbit:match("%S+")]
local test = orbit:find("test") ~= nil
local n, e = 100, 1 - 1 / a
local v = 2 * a - 1
local mu = a * v
local period = 2 * math.pi * math.sqrt(a ^ 3 / mu)

verify.case { title = "Kepler", duration = n, time_unit = period, time_step = {0.25, 0.01, 1}, frame_rate = {1, 0.5, 4},
	gravitation = {G = 1}, quick = "base" }
local plain = material { name = "plain", friction = 0 }
local function point(keys)
	keys.radius, keys.material = 1e-3, plain
	return verify.sphere(keys)
end
local first, second
if test then
	first = point { mass = mu }
	second = point { mass = mu * 1e-6, gravitational_mass = 0, position = vec3(1, 0, 0), velocity = vec3(0, v, 0) }
else
	first = point { mass = mu / 2, position = vec3(-0.5, 0, 0), velocity = vec3(0, -v / 2, 0) }
	second = point { mass = mu / 2, position = vec3(0.5, 0, 0), velocity = vec3(0, v / 2, 0) }
end
local start
local function now()
	local d = verify.position(second) - verify.position(first)
	local w = verify.velocity(second) - verify.velocity(first)
	return d, w
end
local steep = (1 + e) / (1 - e)
local back, energies, vectors = 0, 0, 0
on_frame(function(t)
	local d, w = now()
	-- energy of the relative motion, J/kg
	local h = 0.5 * w:dot(w) - mu / d:length()
	local angular = d:cross(w)
	local pericentre = w:cross(angular) * (1 / mu) - d * (1 / d:length())
	start = start or h
	energies = verify.larger(energies, math.abs(h / start - 1))
	vectors = verify.larger(vectors, (pericentre - vec3(e, 0, 0)):length())
	local k = t / period
	if math.abs(k - math.floor(k + 0.5)) < 1e-9 then
		back = verify.larger(back, (d - vec3(1, 0, 0)):length() / a)
	end
end)
local x = 2 ^ -53
expect("back after each period, share of a", function()
	return back, 6 * math.pi * steep ^ 1.5 * (math.sqrt(n ^ 3 / 3) * x / 4 + n * verify.rounding) + n * period * 2 * x * v / a
end)
-- both terms of the energy are steep times larger than it, and rounded
expect("energy, share", function() return energies, 32 * steep * (x + verify.rounding) end)
expect("vector to the pericentre", function() return vectors, 64 * x + 8 * verify.rounding end)
