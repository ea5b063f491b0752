-- SPDX-License-Identifier: MIT
-- J02: two masses of 1 kg on rods of 1 m, from the horizontal. Answer: where they are after 5 and 10 s, by two programs of 30
-- digits. The motion is chaotic: what rounds coordinates by 1e-15 moves places after 10 s by some 1e-12 m. For 1000 s its
-- energy stays, and rods do not drift.
local verify = require "rbsim.verify"
local g = 9.81
local way = param("way", "places", "what is looked at", {choices = {"places", "long"}})

verify.case { title = "A double pendulum", duration = way == "long" and 1000 or 10, time_step = {0.05, 0.01, 0.2},
	frame_rate = {1, 10, 7}, gravity = {0, 0, -g}, method = "located", quick = "none", processor_seconds = 300,
	leave_out = {frame_rate = "answers are at whole seconds"} }
local plain = material { name = "plain", friction = 0 }
local function ball(x) return verify.sphere { radius = 0.01, mass = 1, position = {x, 0, 0}, material = plain, collides_with = {} } end
local one, two = ball(1), ball(2)
verify.joint { kind = "rod", a = one, at_b = {0, 0, 0} }
verify.joint { kind = "rod", a = one, b = two }
local lost, off, miss = 0, 0, {}
local known = {
	[5] = {vec3(-0.58686920981627, 0, -0.80968174647180), vec3(-1.55077846947044, 0, -1.07591273481265)},
	[10] = {vec3(-0.538347239612, 0, -0.842723115621), vec3(-1.040765783246, 0, -1.707347662469)}}
on_frame(function(t, k)
	local p, q, v, w = verify.position(one), verify.position(two), verify.velocity(one), verify.velocity(two)
	lost = verify.larger(lost, math.abs(v:dot(v) / 2 + w:dot(w) / 2 + g * (p.z + q.z)) / (3 * g))
	off = verify.larger(off, verify.larger(math.abs(p:length() - 1), math.abs((q - p):length() - 1)))
	if known[k] then miss[k] = verify.larger((p - known[k][1]):length(), (q - known[k][2]):length()) end
end)
if way == "places" then
	expect("places at 5 s, m", function() return miss[5], 1e-11 + 1e4 * verify.rounding end)
	expect("places at 10 s, m", function() return miss[10], 1e-9 + 1e6 * verify.rounding end)
else
	expect("energy, of what moves", function() return lost, 1e-12 + 4 * verify.rounding end)
end
expect("drift of rods, m", function() return off, 1e-14 + 4 * verify.rounding end)
