-- SPDX-License-Identifier: MIT
-- G03: masses 3, 4 and 5 at rest at the corners of a triangle with sides of these lengths, G = 1: close encounters, then one
-- is thrown out. Answer: Burrau 1913; Szebehely and Peters, AJ 72 (1967) 876; numbers of an integration with 30 digits.
--
-- Bounds are rounding times what encounters make of it: an error grows by 1e4 until t = 30, by 1e9 to 1e11 later.
local verify = require "rbsim.verify"
verify.case { title = "Pythagorean three bodies", duration = 70, time_step = {0.1, 0.02, 1}, frame_rate = {1, 0.1, 2},
	gravitation = {G = 1}, quick = "more" }
local plain = material { name = "plain", friction = 0 }
local function point(mass, x, y)
	return verify.sphere { radius = 1e-6, mass = mass, position = vec3(x, y, 0), material = plain }
end
local first = point(3, 1, 3)
point(4, -2, -1)
point(5, 1, -1)
local wanted = {
	{10, vec3(0.77848041013809, 0.14139230029009, 0), 1e-12, 1e2},
	{30, vec3(0.856340498897316, 2.28709366369625, 0), 1e-10, 1e4},
	{60, vec3(0.743807500118, 1.939947951095, 0), 1e-5, 1e11},
	{70, vec3(6.93346359901, 20.26180430595, 0), 1e-4, 1e12}}
local off = {}
on_frame(function(t)
	for k, w in ipairs(wanted) do
		if t == w[1] then off[k] = (verify.position(first) - w[2]):length() end
	end
end)
for k, w in ipairs(wanted) do
	expect("place at " .. w[1] .. " s, m", function() return off[k], w[3] + w[4] * verify.rounding end)
end
