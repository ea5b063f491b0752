-- SPDX-License-Identifier: MIT
-- J03: Bricard's mechanism (IFToMM's A04): five bars of 1 m and 1 kg and the ground, joined to a ring by six hinges at right
-- angles, falls. By count it has no freedom, but it has one: a row of its joints is redundant. Answer: its energy stays, and
-- so do its lengths and right angles, for 10 s.
local verify = require "rbsim.verify"
local g = 9.81

verify.case { title = "Bricard's mechanism", duration = 10, time_step = {0.05, 0.01, 0.2}, frame_rate = {10, 1, 7},
	gravity = {0, -g, 0}, method = "located", quick = "base" }
local point = {[0] = vec3(0, 0, 0), vec3(1, 0, 0), vec3(1, -1, 0), vec3(1, -1, 1), vec3(0, -1, 1), vec3(0, 0, 1)}
local axis = {[0] = vec3(0, 1, 0), vec3(0, 0, 1), vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), vec3(1, 0, 0)}
local bar = {}
for k = 1, 5 do
	local d = point[k] - point[k - 1]
	local function across(x) return x ~= 0 and 1e-5 or 1 / 12 end
	bar[k] = verify.sphere { radius = 0.05, mass = 1, inertia = {across(d.x), across(d.y), across(d.z)},
		position = (point[k] + point[k - 1]) / 2, collides_with = {} }
	verify.joint { kind = "hinge", a = bar[k], b = bar[k - 1], at = point[k - 1], axis = axis[k - 1] }
end
verify.joint { kind = "hinge", a = bar[5], at = point[5], axis = axis[5] }
-- An end of a bar, by its body's axes, and the directions of hinges.
local function turned(k, v)
	local x, y, z = verify.axes(bar[k])
	return x * v.x + y * v.y + z * v.z
end
local function tip(k, which) return verify.position(bar[k]) + turned(k, point[k - 1 + which] - (point[k] + point[k - 1]) / 2) end
local lost, off, first = 0, 0, nil
on_frame(function()
	first = first or energy()
	lost = verify.larger(lost, math.abs(energy() - first) / (5 * g))
	for k = 2, 5 do
		off = verify.larger(off, (tip(k, 0) - tip(k - 1, 1)):length())
		off = verify.larger(off, (turned(k, axis[k - 1]) - turned(k - 1, axis[k - 1])):length())
	end
	off = verify.larger(off, (tip(5, 1) - point[5]):length())
end)
expect("energy, of what falls", function() return lost, 1e-10 end)
expect("ends and directions of hinges, m", function() return off, 1e-13 + 64 * verify.rounding end)
