-- SPDX-License-Identifier: MIT
-- G04: three bodies at the corners of an equilateral triangle turn about their centre of mass as one. Answer: omega^2 = G
-- (m1 + m2 + m3)/s^3, whatever the masses (Lagrange 1772). Equal masses are unstable: an error grows by exp(2.22 omega t / pi)
-- and more, 7e3 in two turns; with 1, 1e-3 and a test body (Routh: less than 0.0385) it stays.
local verify = require "rbsim.verify"
local kind = param("kind", "equal", "masses", {choices = {"equal", "trojan"}})
local mass = kind == "equal" and {1, 1, 1} or {1, 1e-3, 1e-6}
local active = kind == "equal" and mass or {1, 1e-3, 0}
local sum = active[1] + active[2] + active[3]
local omega = math.sqrt(sum)
local turns = kind == "equal" and 2 or 10

verify.case { title = "Lagrange's triangle", duration = turns, time_unit = 2 * math.pi / omega, time_step = {0.05, 0.01, 1},
	frame_rate = {8, 1, 3}, gravitation = {G = 1}, quick = "more" }
local plain = material { name = "plain", friction = 0 }
local corner = {vec3(0, 0, 0), vec3(1, 0, 0), vec3(0.5, math.sqrt(0.75), 0)}
local centre = vec3(0, 0, 0)
for k = 1, 3 do centre = centre + active[k] / sum * corner[k] end
local body = {}
for k = 1, 3 do
	local x = corner[k] - centre
	body[k] = verify.sphere { radius = 1e-3, mass = mass[k], gravitational_mass = active[k], position = x, material = plain,
		velocity = omega * vec3(-x.y, x.x, 0) }
end
local grows = kind == "equal" and 7e3 or 1e3
expect_always("in its corner, m", function()
	local c, s = math.cos(omega * time()), math.sin(omega * time())
	local off = 0
	for k = 1, 3 do
		local x = corner[k] - centre
		off = verify.larger(off, (verify.position(body[k]) - vec3(c * x.x - s * x.y, s * x.x + c * x.y, 0)):length())
	end
	-- places and speeds are rounded at the start
	return off, grows * (2 ^ -52 * (1 + omega) + 2 * verify.rounding)
end)
