-- SPDX-License-Identifier: MIT
-- G07: two spheres at rest fall to each other, bounce and come to rest. Answer, with G (m1 + m2) = 1, the sum of radii s = 1
-- and the distance D = 10: they touch after sqrt(D^3/2) (acos q + q sqrt(1 - q^2)) with q^2 = s/D, with v^2 = 2 (1/s - 1/D);
-- after a bounce 1/D' = 1/s - e^2 v^2/2. The infinite series of bounces ends at 37.930593942526 s; then they press with
-- G m1 m2/s^2.
--
-- The last bounce, of 8 ulp of the size, is known to 1e-9 s; the end of the series follows from those before.
local verify = require "rbsim.verify"
local friction = param("friction", "none", "of the spheres", {choices = {"none", "rough"}})

verify.case { title = "Infall to rest", duration = 1000, time_step = {0.25, 0.05, 10}, frame_rate = {1, 0.1, 2},
	gravitation = {G = 1}, quick = "more" }
local rubber = material { name = "rubber", friction = friction == "rough" and 0.5 or 0, restitution = 0.5 }
local function ball(x) return verify.sphere { radius = 0.5, mass = 0.5, position = vec3(x, 0, 0), material = rubber } end
local left, right = ball(-5), ball(5)
local touch, apex, rest, gap, last = {}, 0, nil, 0, 0
on_collision(function(c) touch[#touch + 1] = c.time end)
on_transition(function(c) if c.kind == "rest" then rest = c.time end end)
on_frame(function(t)
	local d = (verify.position(right) - verify.position(left)):length()
	if t > 38 then gap = verify.larger(gap, math.abs(d - 1)) end
end)
local x = 1e-10 + 1e3 * verify.rounding
expect("first touch, s", function() return math.abs(touch[1] - 34.6377164734116), x end)
expect("second touch, s", function() return math.abs(touch[2] - 36.5277140893896), x end)
expect("rest, s", function() return math.abs(rest - 37.930593942526), 1e-10 + 1e3 * verify.rounding end)
expect("gap for the rest of the time, m", function() return gap, 2 ^ -50 + 4 * verify.rounding end)
expect("they press, N", function()
	-- what gravitation does and contact takes back
	return math.abs(right.force:length()), 1e-12
end)
expect("energy that is left, J", function() return math.abs(energy() + 0.25), 1e-14 + verify.rounding end)
