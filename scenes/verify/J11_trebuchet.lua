-- SPDX-License-Identifier: MIT
-- J11: a trebuchet: a beam on a hinge, its counterweight fixed to the short arm, a ball in a sling, which is a rope that is
-- let go of after 0.625 s. Answer: where the ball is then, how fast, when and how far away it lands: Lagrange's equations
-- of the two angles by Taylor series of 30 digits, then a parabola (tests/reference/trebuchet.py).
local verify = require "rbsim.verify"
local g, height, long, short, sling, radius = 9.81, 4, 4, 1, 3, 0.125

verify.case { title = "A trebuchet", duration = 5, time_step = {0.05, 0.01, 0.2}, frame_rate = {16, 48, 80}, gravity = {0, 0, -g},
	method = "located", quick = "base", length = 16 }
local bare = material { name = "bare", friction = 0, restitution = 0 }
local pivot, angle = vec3(0, 0, height), -math.pi / 4
local arm = vec3(math.cos(angle), 0, math.sin(angle))
local function body(mass, inertia, position, r)
	return verify.sphere { radius = r, mass = mass, inertia = {inertia, inertia, inertia}, position = position, material = bare, collides_with = {} }
end
local beam = body(20, 60, pivot + arm, 0.2)
local weight = body(900, 40, pivot - short * arm, 0.5)
local tip = pivot + long * arm
local ball = verify.sphere { radius = radius, mass = 10, position = tip - vec3(sling, 0, 0), material = bare }
verify.plane { point = {0, 0, -radius}, normal = {0, 0, 1}, material = bare }
verify.joint { kind = "hinge", a = beam, at = pivot, axis = {0, 1, 0} }
verify.joint { kind = "fixed", a = beam, b = weight, at = pivot - short * arm }
local rope = verify.joint { kind = "rope", a = beam, b = ball, at_a = (long - 1) * arm, at_b = {0, 0, 0}, length = sling }
local p, v, lands, range, first, lost
on_frame(function(t)
	first = first or energy()
	if p or t < 0.625 then return end
	p, v, lost = verify.position(ball), verify.velocity(ball), math.abs(energy() - first) / (900 * g)
	rope:release()
end)
on_collision(function(c)
	if not lands and c.kind == "collision" then lands, range = c.time, verify.position(ball).x end
end)
local known = {place = vec3(4.9647774132184600344, 0, 2.497177317037351477), velocity = vec3(15.09682673850270846, 0, 20.532336744314204889), lands = 4.9292809508795656309, range = 69.945761162484949517}
expect("place at the release, m", function() return (p - known.place):length(), 1e-12 + 256 * verify.rounding end)
expect("velocity then, m/s", function() return (v - known.velocity):length(), 1e-11 + 1e3 * verify.rounding end)
expect("energy until then, of what fell", function() return lost, 1e-11 end)
expect("when it lands, s", function() return math.abs(lands - known.lands), 1e-12 + 256 * verify.rounding end)
expect("how far, m", function() return math.abs(range - known.range), 1e-10 + 1e4 * verify.rounding end)
