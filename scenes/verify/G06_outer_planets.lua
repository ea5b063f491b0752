-- SPDX-License-Identifier: MIT
-- G06: Sun, Jupiter, Saturn, Uranus, Neptune and Pluto for 200,000 days. Answer: from the data of 5 September 1994 in Hairer,
-- Lubich, Wanner, Geometric Numerical Integration, I.2.4 (the Sun with the inner planets at rest at the origin), where two
-- programs of order 15 and 16 end within 4e-12 AU of each other. In SI units it is the same: sizes do not matter.
local verify = require "rbsim.verify"
local units = param("units", "AU", "of length: AU, kg of the Sun, days; or SI", {choices = {"AU", "SI"}})
local au, day, sun = 1, 1, 1
if units == "SI" then au, day, sun = 1.495978707e11, 86400, 1.98847e30 end
-- with the Gaussian constant in any units
local G = 2.95912208286e-4 * au ^ 3 / day ^ 2 / sun

verify.case { title = "Outer planets", duration = 200, time_unit = 1000 * day, time_step = {0.1, 1, 0.02},
	frame_rate = {0.1, 0.01, 0.7}, length = au, gravitation = {G = G}, quick = "base", processor_seconds = 120,
	leave_out = {shift = "the answer is known to 4e-12 AU of 40: 64 AU aside take away more"} }
local plain = material { name = "plain", friction = 0 }
local data = {
	{"Sun", 1.00000597682, {0, 0, 0}, {0, 0, 0}},
	{"Jupiter", 9.54786104043e-4, {-3.5023653, -3.8169847, -1.5507963}, {0.00565429, -0.00412490, -0.00190589}},
	{"Saturn", 2.85583733151e-4, {9.0755314, -3.0458353, -1.6483708}, {0.00168318, 0.00483525, 0.00192462}},
	{"Uranus", 4.37273164546e-5, {8.3101420, -16.2901086, -7.2521278}, {0.00354178, 0.00137102, 0.00055029}},
	{"Neptune", 5.17759138449e-5, {11.4707666, -25.7294829, -10.8169456}, {0.00288930, 0.00114527, 0.00039677}},
	{"Pluto", 1 / 1.3e8, {-15.5387357, -25.2225594, -3.1902382}, {0.00276725, -0.00170702, -0.00136504}}}
local body = {}
for _, d in ipairs(data) do
	body[d[1]] = verify.sphere { name = d[1], radius = 4.7e-4 * au, mass = d[2] * sun, position = au * vec3(d[3]),
		velocity = au / day * vec3(d[4]), material = plain }
end
local function off(name, place) return (verify.position(body[name]) / au - vec3(place)):length() end
-- 46 turns of Jupiter: places and speeds rounded at the start grow in proportion to time
local bound = 1e-10 + 1e4 * verify.rounding / au + (units == "SI" and 1e4 * 2 ^ -53 or 0)
expect("Jupiter, AU", function() return off("Jupiter", {2.61107957011, -5.07952549679, -2.24472067785}), bound end)
expect("Pluto, AU", function() return off("Pluto", {36.5669506988, -13.7676844013, -15.0434692218}), bound end)
