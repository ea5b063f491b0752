-- SPDX-License-Identifier: MIT
-- S27: a sphere slides and spins on a floor without friction for 1e4 s. Answer: it keeps both.
local verify = require "rbsim.verify"
local v, spin, radius, duration = vec3(1, 0.5, 0), vec3(3, -2, 5), 0.1, 1e4

verify.case { title = "Nothing rubs", duration = duration, gravity = {0, 0, -9.81}, time_step = {0.1, 0.01, 1},
	frame_rate = {0.1, 1, 0.07}, quick = "base" }
local ice = material { name = "ice", friction = 0, restitution = 0 }
verify.plane { material = ice }
local ball = verify.sphere { name = "ball", radius = radius, position = {0, 0, radius}, velocity = v, angular_velocity = spin,
	material = ice }

-- Turned obliquely, gravity and the floor's normal are rounded apart by an ulp or two, and gravity then pulls along the floor.
local slant = verify.turn == 2 and 2 * verify.u * 9.81 / v:length() or 0
expect_always("velocity, relative", function() return (verify.velocity(ball) - v):length() / v:length(), 1e-12 + slant * time() end)
expect_always("spin, relative", function() return (verify.spin(ball) - spin):length() / spin:length(), 1e-12 + slant * time() end)
expect_always("place, relative to the way", function()
	local wanted = vec3(v.x * time(), v.y * time(), radius)
	return (verify.position(ball) - wanted):length() / (v:length() * duration), 1e-12 + verify.rounding / duration + slant * time()
end)
