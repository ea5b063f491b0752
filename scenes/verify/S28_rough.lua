-- SPDX-License-Identifier: MIT
-- S28: oblique impacts of a sphere with a friction coefficient of a million. Answer: the contact point stops, the centre
-- keeps 5/7 of its speed along the wall. (S28_steep is the box on a slope of 89 degrees.)
local verify = require "rbsim.verify"
local angle = param("angle", 60, "from the normal, degrees", {choices = {60, 10, 30, 85}})
local e, speed, radius = 0.5, 3.9, 0.0025
local vn, vt = speed * math.cos(deg(angle)), speed * math.sin(deg(angle))

verify.case { title = "As rough as can be", duration = 0.1, time_step = {1e-3, 1e-4, 0.1}, frame_rate = {10, 60, 100},
	quick = "more", length = 1 / 64 }
local rough = material { name = "rough", friction = 1e6, restitution = e }
verify.plane { material = rough }
local ball = verify.sphere { name = "ball", radius = radius, position = {0, 0, 2 * radius}, velocity = {vt, 0, -vn},
	material = rough }

expect("velocity, relative", function()
	return (verify.velocity(ball) - vec3(5 / 7 * vt, 0, e * vn)):length() / speed, 1e-12
end)
expect("spin, relative", function()
	return (radius * verify.spin(ball) - vec3(0, 5 / 7 * vt, 0)):length() / speed, 1e-12
end)
expect("energy is not gained", function()
	return ball.kinetic_energy / (0.5 * ball.mass * speed * speed), 1
end)
