-- SPDX-License-Identifier: MIT
-- S31: a sphere hits a wall at an angle (Chung and Ooi, Granul. Matter 13, 2011, test 4). Answer: that of rigid bodies; the
-- contact sticks up to 32.52 degrees and slips beyond.
local verify = require "rbsim.verify"
local impact = require "impact"
local angle = param("angle", 45, "from the normal, degrees", {choices = {45, 10, 30, 35, 60, 80, 85}})
local e, mu, speed, radius = 0.98, 0.092, 3.9, 0.0025
local vn, vt = speed * math.cos(deg(angle)), speed * math.sin(deg(angle))

-- Ratio of the speeds along the wall and spin in rad/s, as tabulated.
local tabulated = {[10] = {0.71428571, 193.49368}, [30] = {0.71428571, 557.14286}, [35] = {0.73984856, 581.94527},
	[45] = {0.81784, 502.34563}, [60] = {0.89482987, 355.212}, [80] = {0.96788028, 123.36383}, [85] = {0.98406307, 61.917531}}

verify.case { title = "Oblique impact", duration = 0.1, time_step = {1e-3, 1e-4, 0.1}, frame_rate = {10, 60, 100},
	quick = "more", length = 1 / 64 }
local oxide = material { name = "oxide", density = 4000, friction = mu, restitution = e }
verify.plane { material = oxide }
local ball = verify.sphere { name = "ball", radius = radius, position = {0, 0, 2 * radius}, velocity = {vt, 0, -vn},
	material = oxide }

local n, t, wr = impact.sphere(vn, vt, 0, e, mu)
expect("velocity, relative", function()
	return (verify.velocity(ball) - vec3(t, 0, n)):length() / speed, 1e-12
end)
expect("spin, relative", function() return (radius * verify.spin(ball) - vec3(0, wr, 0)):length() / speed, 1e-12 end)
expect("the tabulated ratio along the wall", function()
	return math.abs(verify.velocity(ball).x / vt - tabulated[angle][1]), 5e-9
end)
expect("the tabulated spin, rad/s", function() return math.abs(verify.spin(ball).y - tabulated[angle][2]), 5.1e-6 end)
