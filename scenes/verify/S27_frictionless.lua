-- SPDX-License-Identifier: MIT
-- S27: a sphere slides and spins on a floor without friction for 1e4 s, a box slides, and turns on its face. Answer: all
-- keep what they have.
local verify = require "rbsim.verify"
local what = param("what", "sphere", "what slides", {choices = {"sphere", "box", "turning box"}})
local v, radius, duration = vec3(1, 0.5, 0), 0.1, 1e4
local spin = what == "sphere" and vec3(3, -2, 5) or vec3(0, 0, what == "box" and 0 or 0.25)

verify.case { title = "Nothing rubs", duration = duration, gravity = {0, 0, -9.81}, time_step = {0.1, 0.01, 1},
	frame_rate = {0.1, 1, 0.07}, quick = "base" }
local ice = material { name = "ice", friction = 0, restitution = 0 }
verify.plane { material = ice }
local keys = {name = "body", position = {0, 0, radius}, velocity = v, angular_velocity = spin, material = ice}
if what == "sphere" then keys.radius = radius else keys.size = {0.4, 0.3, 2 * radius} end
local body = verify[what == "sphere" and "sphere" or "box"](keys)

-- Turned obliquely, gravity and the floor's normal are rounded apart by an ulp or two, and gravity then pulls along the floor.
local slant = verify.turn == 2 and 2 * verify.u * 9.81 / v:length() or 0
expect_always("velocity, relative", function() return (verify.velocity(body) - v):length() / v:length(), 1e-12 + slant * time() end)
expect_always("spin, relative if there is one", function()
	return (verify.spin(body) - spin):length() / (spin:length() > 0 and spin:length() or 1), 1e-12 + slant * time()
end)
expect_always("place, relative to the way", function()
	local wanted = vec3(v.x * time(), v.y * time(), radius)
	return (verify.position(body) - wanted):length() / (v:length() * duration), 1e-12 + verify.rounding / duration + slant * time()
end)
