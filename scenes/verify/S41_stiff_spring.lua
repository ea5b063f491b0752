-- SPDX-License-Identifier: MIT
-- S41: a spring of 1e9 N/m, on 1 kg (31622.7766 rad/s) and between 1 g and 1 t (1e6 rad/s). Answer: a harmonic oscillation
-- with the reduced mass.
local verify = require "rbsim.verify"
local pair = param("pair", "wall", "what it is fixed to", {choices = {"wall", "masses"}})
local stiffness, stretch = 1e9, 1e-3
local light, heavy = pair == "wall" and 1 or 1e-3, 1e3
local reduced = pair == "wall" and light or light * heavy / (light + heavy)
local omega = math.sqrt(stiffness / reduced)

verify.case { title = "A stiff spring", duration = 1, time_step = {1e-3, 1e-5, 0.1}, frame_rate = {1, 10, 7}, quick = "none",
	processor_seconds = 400 }
local a = pair == "wall" and verify.sphere { name = "anchor", radius = 0.1, static = true }
	or verify.sphere { name = "heavy", radius = 0.1, mass = heavy }
local b = verify.sphere { name = "light", radius = 0.1, mass = light, position = {1 + stretch, 0, 0} }
spring { a = a, b = b, stiffness = stiffness, rest_length = 1 }

-- The length beyond that at rest, and its rate over omega, are cos and -sin of the phase.
local function now()
	local length = (verify.position(b) - verify.position(a)).x - 1
	local rate = verify.velocity(b).x - (pair == "wall" and 0 or verify.velocity(a).x)
	return length / stretch, -rate / omega / stretch
end
expect_always("the phase, rad", function()
	local c, s = now()
	local off = math.atan(s, c) - omega * time()
	return math.abs(off - 2 * math.pi * math.floor(off / (2 * math.pi) + 0.5)), 1e-3 + 2 * verify.rounding / stretch
end)
expect_always("the amplitude, relative", function()
	local c, s = now()
	return math.abs(math.sqrt(c * c + s * s) - 1), 1e-3 + 2 * verify.rounding / stretch
end)
