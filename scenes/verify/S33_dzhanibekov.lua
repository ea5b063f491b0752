-- SPDX-License-Identifier: MIT
-- S33: a box of 3 by 2 by 1 m, spinning about its middle axis and a little beside. Answer: it tumbles with a
-- period (Jacobi's elliptic functions) of 12.9012460037936 s; energy and angular momentum stay.
local verify = require "rbsim.verify"
local inertia, spin = {2.5, 5, 6.5}, vec3(0.01, 5, 0.01)
local period, count = 12.9012460037936, 100

verify.case { title = "A tumbling racket", duration = count * period, time_step = {0.1, 1e-3, 1}, frame_rate = {0.1, 1, 0.3},
	quick = "more" }
local body = verify.box { name = "body", size = {3, 2, 1}, mass = 6, angular_velocity = spin }

local momentum = vec3(inertia[1] * spin.x, inertia[2] * spin.y, inertia[3] * spin.z)
local energy = momentum:dot(spin) / 2
expect_always("energy, relative", function() return math.abs(body.kinetic_energy / energy - 1), 1e-12 end)
-- Shifted, the momentum about the world's origin has nothing more: the body does not travel.
expect_always("angular momentum, relative", function()
	return (verify.back_vector(body.angular_momentum) - momentum):length() / momentum:length(), 1e-12
end)
-- After whole periods the spin in the body's axes is what it was; by how much it differs, over how fast it changes there, is
-- how late it is.
expect("phase after 100 periods, in periods", function()
	local x, y, z = verify.axes(body)
	local w = verify.spin(body)
	local off = vec3(w:dot(x), w:dot(y), w:dot(z)) - spin
	local rate = vec3((inertia[2] - inertia[3]) / inertia[1] * spin.y * spin.z,
		(inertia[3] - inertia[1]) / inertia[2] * spin.z * spin.x,
		(inertia[1] - inertia[2]) / inertia[3] * spin.x * spin.y)
	return off:length() / rate:length() / period, 1e-6
end)
