-- SPDX-License-Identifier: MIT
-- S35: a needle of 1 by 1e-6 by 1e-6 m, a foil of 1 by 1 by 1e-6 m, a disc as thin, turning freely. Answer: energy
-- and angular momentum stay.
local verify = require "rbsim.verify"
local shape = param("shape", "needle", "what turns", {choices = {"needle", "foil", "disc"}})
local about = param("about", "x", "which axis", {choices = {"x", "y", "z", "all"}})
local thin, speed = 1e-6, 10
local axis = ({x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1}, all = {1, 1, 1}})[about]

verify.case { title = "Needle and foil", duration = 10, time_step = {0.01, 1e-3, 1}, frame_rate = {10, 1, 60}, quick = "more" }
local keys = {name = "body", mass = 1, angular_velocity = speed * vec3(axis)}
local body
if shape == "disc" then
	keys.radius, keys.length = 0.5, thin
	body = verify.cylinder(keys)
else
	keys.size = {1, shape == "foil" and 1 or thin, thin}
	body = verify.box(keys)
end

local rows, w = body.inertia, keys.angular_velocity
local momentum = vec3(rows[1][1] * w.x, rows[2][2] * w.y, rows[3][3] * w.z)
local energy = momentum:dot(w) / 2
expect("it has the inertia of its shape", function()
	local flat = (1 + thin * thin) / 12
	local wanted = shape == "needle" and {thin * thin / 6, flat, flat} or shape == "foil" and {flat, flat, 1 / 6}
		or {0.25 / 4 + thin * thin / 12, 0.25 / 4 + thin * thin / 12, 0.25 / 2}
	local worst = 0
	for k = 1, 3 do worst = verify.larger(worst, math.abs(rows[k][k] / wanted[k] - 1)) end
	return worst, 1e-12
end)
expect_always("energy, relative", function() return math.abs(body.kinetic_energy / energy - 1), 1e-9 end)
-- Against the start. A spin about a needle's axis that is rounded across it, in an oblique turn, is another momentum by 1e-4:
-- the inertia there is 1e12 times larger.
local largest = math.max(rows[1][1], rows[2][2], rows[3][3])
local rounded = verify.turn == 2 and 16 * verify.u * largest * w:length() / momentum:length() or 0
local first
expect_always("angular momentum, relative", function()
	first = first or vec3(body.angular_momentum)
	return (body.angular_momentum - first):length() / first:length(), 1e-9 + rounded
end)
