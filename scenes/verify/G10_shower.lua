-- SPDX-License-Identifier: MIT
-- G10: fifty small bodies fall to a heavy one and bounce without loss, for a thousand impacts and more; they attract each
-- other, too, and meet. Answer: energy and momenta stay.
local verify = require "rbsim.verify"
verify.case { title = "Elastic shower", duration = 60, time_step = {0.1, 1, 0.01}, frame_rate = {2, 0.5, 3},
	gravitation = {G = 1}, quick = "none", processor_seconds = 120,
	leave_out = {shift = "chaotic: only what is conserved is known, and that is measured about the origin"} }
local hard = material { name = "hard", friction = 0, restitution = 1 }
verify.sphere { radius = 1, mass = 1, material = hard }
for k = 1, 50 do
	-- evenly over a sphere by the golden angle; heights that differ
	local z, angle = (2 * k - 1) / 50 - 1, 2.399963229728653 * k
	local r = math.sqrt(1 - z * z)
	local height = 1.3 + 0.4 * ((k * 0.6180339887498949) % 1)
	verify.sphere { radius = 0.02, mass = 1e-4, position = height * vec3(r * math.cos(angle), r * math.sin(angle), z),
		material = hard }
end
local first, spun, moved, energies, angulars, linears = nil, nil, nil, 0, 0, 0
on_frame(function()
	first, spun, moved = first or energy(), spun or angular_momentum(), moved or momentum()
	energies = verify.larger(energies, math.abs(energy() / first - 1))
	angulars = verify.larger(angulars, (angular_momentum() - spun):length())
	linears = verify.larger(linears, (momentum() - moved):length())
end)
expect("energy, share", function() return energies, 1e-12 end)
-- of 50 bodies of 1e-4 kg with speeds and distances of 1
expect("angular momentum, of that of all", function() return angulars / (50 * 1e-4), 1e-12 end)
expect("momentum, of that of all", function() return linears / (50 * 1e-4), 1e-12 end)
expect("there were impacts", function() return 500 - collisions(), 0 end)
