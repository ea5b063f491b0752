-- SPDX-License-Identifier: MIT
-- J12: a chain of a hundred hinged links that carries a ball of a million times a link's mass. Answer: it stands, and joints
-- carry the weights of what is below them. Not turned obliquely: what rounds a coordinate lets it swing by as much, and each
-- of its links then vibrates with up to 5 kHz.
local verify = require "rbsim.verify"
local g, n = 9.81, 100
local length, mass, heavy = 1 / n, 1, 1e6

verify.case { title = "A heavy ball on a chain", duration = 100, time_step = {0.05, 0.01, 0.2}, frame_rate = {10, 1, 7},
	gravity = {0, 0, -g}, method = "located", quick = "base", turns = {0, 1} }
local plain = material { name = "plain", friction = 0 }
local down = vec3(0, 0, -1)
local joints, before = {}, nil
for k = 1, n do
	local link = verify.sphere { mass = mass, radius = 0.2 * length, material = plain, collides_with = {},
		position = down * ((k - 0.5) * length) }
	joints[k] = verify.joint { kind = "hinge", a = link, b = before, at = down * ((k - 1) * length), axis = {0, 1, 0} }
	before = link
end
local ball = verify.sphere { mass = heavy, radius = 0.2, material = plain, collides_with = {}, position = down * 1.2 }
verify.joint { kind = "hinge", a = ball, b = before, at = down, axis = {0, 1, 0} }
expect_always("it stands, m", function() return (verify.position(ball) - down * 1.2):length(), 1e-15 + verify.rounding end)
for _, k in ipairs {1, 50, 100} do
	expect("what joint " .. k .. " carries, of the weight", function()
		return math.abs(joints[k].force:length() / ((heavy + (n + 1 - k) * mass) * g) - 1), 1e-13
	end)
end
