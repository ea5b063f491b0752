-- SPDX-License-Identifier: MIT
-- rbsim.units: everything in a scene is in SI units; these factors and functions get there from others.
--
--   local u = require "rbsim.units"
--   sphere { radius = 57.15 / 2 * u.mm, mass = 170 * u.g, velocity = {8 * u.km_per_h, 0, 0} }
--
-- Lengths in m, masses in kg, times in s, speeds in m/s, angles in rad, frequencies in rad/s.

local units = {
	km = 1e3, cm = 1e-2, mm = 1e-3, um = 1e-6, inch = 0.0254, foot = 0.3048, yard = 0.9144, mile = 1609.344,
	g = 1e-3, mg = 1e-6, tonne = 1e3, pound = 0.45359237, ounce = 0.028349523125,
	ms = 1e-3, us = 1e-6, minute = 60, hour = 3600, day = 86400,
	km_per_h = 1 / 3.6, mph = 0.44704, knot = 1852 / 3600,
	degree = math.pi / 180, turn = 2 * math.pi, rpm = 2 * math.pi / 60,
	gravity = 9.80665,                            -- m/s^2, the standard one
	earth = {0, 0, -9.80665}, moon = {0, 0, -1.625}, mars = {0, 0, -3.73}, -- for world { gravity = }
	G = 6.67430e-11,                              -- m^3/(kg s^2), CODATA 2018
}

return setmetatable(units, {
	__index = function(_, name) error(("units: no unit '%s'"):format(tostring(name)), 2) end,
})
