-- SPDX-License-Identifier: MIT
-- J15: a stiff flyball governor (IFToMM's A05): a shaft that turns freely at 2 pi rad/s, two rods of 1 m with 5 kg at their
-- ends that hang on it by hinges, and a slider on the shaft that springs and dampers (8e5 N/m, 4e4 N s/m, which decay by
-- 3e4/s) join to the rods' middles. All bars have 3000 kg/m^3. Answer: the rods' angle, the slider's height and the spin after
-- 0.5 s, by tests/reference/governor.c with 64 binary digits.
local verify = require "rbsim.verify"

verify.case { title = "A stiff flyball governor", duration = 0.5, time_step = {0.05, 0.01, 0.5}, frame_rate = {10, 2, 100},
	gravity = {0, 0, -9.81}, method = "located", quick = "base" }
local up, across, spin = vec3(0, 0, 1), vec3(0, 1, 0), 2 * math.pi
local function part(mass, inertia, position, angle)
	return verify.sphere { radius = 0.01, mass = mass, inertia = inertia, position = position, orientation = {axis = across, angle = deg(angle)},
		velocity = vec3(0, 0, spin):cross(position), angular_velocity = {0, 0, spin}, collides_with = {} }
end
-- About a bar's own axis and across it; `both` of a rod with its 5 kg, about the centre of both.
local thin, thick = 0.3 * 2e-4 / 12, 0.3 * 1.0001 / 12
local middle = (0.3 * 0.5 + 5) / 5.3
local both = thick + 0.3 * (middle - 0.5) ^ 2 + 5 * (1 - middle) ^ 2
local shaft = part(0.3, {thick, thick, thin}, vec3(0, 0, 0.5), 0)
local slider = part(3, {0.005, 0.005, 0.005}, vec3(0, 0, 0.5), 0)
verify.joint { kind = "hinge", a = shaft, at = {0, 0, 0}, axis = up }
verify.joint { kind = "slider", a = shaft, b = slider, axis = up }
local rods = {}
for side = -1, 1, 2 do
	local top, along = vec3(side * 0.05, 0, 1), vec3(side * math.sqrt(0.75), 0, -0.5)
	rods[side] = part(5.3, {thin, both, both}, top + along * middle, side * 30)
	verify.joint { kind = "hinge", a = shaft, b = rods[side], at = top, axis = across }
	spring { a = slider, b = rods[side], at_a = {side * 0.05, 0, 0}, at_b = {side * (0.5 - middle), 0, 0}, stiffness = 8e5, damping = 4e4,
		rest_length = 0.5 }
end
local bound = 1e-13 + 64 * verify.rounding
for side = -1, 1, 2 do
	expect("angle of rod " .. side .. ", rad", function()
		local x = verify.axes(rods[side])
		return math.abs(math.asin(-side * x.z) - 0.259491381543413116), bound
	end)
end
expect("height of the slider, m", function() return math.abs(verify.position(slider).z - 0.743249424786325728), bound end)
expect("spin, of itself", function() return math.abs(verify.spin(slider).z / 5.10341542197153528 - 1), bound end)
