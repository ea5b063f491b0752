-- SPDX-License-Identifier: MIT
-- C07: a disc rolls round on its rim, its centre at rest (Euler's disc). Answer: with the tilt alpha, the radius a, half
-- the thickness c and inertias A across and C along the axis, the contact goes round at Omega, Omega^2 sin(alpha)/a
-- (A a cos(alpha) - C c sin(alpha)) = m g (a cos(alpha) - c sin(alpha)), and this goes on.
local verify = require "rbsim.verify"
local tilt = param("tilt", 0.5, "rad", {choices = {0.5, 0.1, 1.0}})
local g, a, c, m = 9.81, 0.0381, 0.001, 0.4
local across, along = m * (3 * a * a + 4 * c * c) / 12, m * a * a / 2
local sin, cos = math.sin(tilt), math.cos(tilt)
local around = math.sqrt(m * g * (a * cos - c * sin) * a / (sin * (across * a * cos - along * c * sin)))

verify.case { title = "Euler's disc", duration = 10 * 2 * math.pi / around, gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {100, 10, 60}, quick = "base", length = 1 / 16 }
local steel = material { name = "steel", friction = 0.5, restitution = 0 }
verify.plane { material = steel }
-- The axis leans to x; the contact is at a (cos, 0, -sin) - c (sin, 0, cos) from the centre, and the spin along that line.
local contact = vec3(a * cos - c * sin, 0, -a * sin - c * cos)
local disc = verify.cylinder { name = "disc", radius = a, length = 2 * c, mass = m, material = steel,
	position = {0, 0, -contact.z}, orientation = {axis = {0, 1, 0}, angle = tilt}, angular_velocity = -around * sin / a * contact }

expect("for a thin one it is the known formula", function()
	return math.abs(around ^ 2 * sin / (4 * g / a) - 1), 4 * c / a
end)
expect_always("the centre is at rest, over the radius", function()
	return (verify.position(disc) - vec3(0, 0, -contact.z)):length() / a, 1e-8 + 8 * verify.rounding / a
end)
-- The axis goes round z at that rate.
expect_always("the axis, rad", function()
	local _, _, z = verify.axes(disc)
	local angle = around * time()
	return (z - vec3(sin * math.cos(angle), sin * math.sin(angle), cos)):length(), 1e-7 + 64 * verify.rounding / a
end)
expect_always("energy, relative", function()
	return math.abs(disc.kinetic_energy / (m / 2 * (around * sin / a) ^ 2 *
		(across / m * a * a + along / m * c * c)) - 1), 1e-9 + 64 * verify.rounding / a
end)
