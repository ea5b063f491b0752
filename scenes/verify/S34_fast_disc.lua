-- SPDX-License-Identifier: MIT
-- S34: the inertia of a disc (radius 0.5 m, height 0.01 m) at 1e4 rad/s with a wobble of 1 rad/s. Answer: it turns about its
-- angular momentum at |L|/I1 = 19997.3337138 rad/s and about its own axis at -9997.33368884 rad/s; the axis stays
-- 5.000666662e-5 rad from the angular momentum.
local verify = require "rbsim.verify"
local r, h, m = 0.5, 0.01, 1
local i1, i3 = m * (3 * r * r + h * h) / 12, m * r * r / 2
local spin = vec3(1, 0, 1e4)

verify.case { title = "A disc at 1600 turns a second", duration = 1, time_step = {1e-3, 1e-5, 0.1}, frame_rate = {10, 100, 60},
	quick = "more" }
local disc = verify.sphere { name = "disc", radius = r, mass = m, inertia = {i1, i1, i3}, angular_velocity = spin }

local momentum = vec3(i1 * spin.x, 0, i3 * spin.z)
local space, own = momentum:length() / i1, (i1 - i3) / i1 * spin.z
local axis = momentum:unit()
expect("the rates are those of the table", function()
	return math.abs(space / 19997.3337138 - 1) + math.abs(-own / 9997.33368884 - 1), 1e-11
end)

-- v turned about the axis by an angle.
local function turned(v, angle)
	local along = axis:dot(v) * axis
	return along + math.cos(angle) * (v - along) + math.sin(angle) * axis:cross(v)
end
-- Where the disc's axes are: turned about its own axis z first, then about the angular momentum.
local function exact(t)
	local c, s = math.cos(own * t), math.sin(own * t)
	return turned(vec3(c, s, 0), space * t), turned(vec3(-s, c, 0), space * t), turned(vec3(0, 0, 1), space * t)
end
expect_always("the angle that it has turned, rad", function()
	local x, y, z = verify.axes(disc)
	local ex, ey, ez = exact(time())
	return verify.larger((x - ex):length(), verify.larger((y - ey):length(), (z - ez):length())), 1e-6
end)
expect_always("the axis, rad", function()
	local _, _, z = verify.axes(disc)
	local _, _, ez = exact(time())
	return (z - ez):length(), 1e-9
end)
expect_always("the wobble, rad", function()
	local _, _, z = verify.axes(disc)
	return math.abs(z:cross(axis):length() - 5.000666662e-5), 1e-9
end)
expect_always("energy, relative", function()
	return math.abs(2 * disc.kinetic_energy / (i1 * spin.x ^ 2 + i3 * spin.z ^ 2) - 1), 1e-12
end)
