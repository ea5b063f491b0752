-- SPDX-License-Identifier: MIT
-- J01: a mass of 1 kg on a rod of 1 m, from the horizontal (IFToMM's A01). Answer: it is back after 2.36784194757623745 s,
-- 4 K(sin 45 deg)/sqrt(g), for 1000 s; its energy and its distance stay.
local verify = require "rbsim.verify"
local g, period, turns = 9.81, 2.36784194757623745, 422

verify.case { title = "A pendulum for 1000 s", duration = turns * period, time_step = {0.05, 0.01, 0.2}, frame_rate = {1 / period, 1, 7},
	gravity = {0, 0, -g}, method = "located", quick = "base" }
local plain = material { name = "plain", friction = 0 }
local ball = verify.sphere { radius = 0.01, mass = 1, position = {1, 0, 0}, material = plain }
verify.joint { kind = "rod", a = ball, at_b = {0, 0, 0} }
local lost, off = 0, 0
on_frame(function()
	-- potential energy from the pivot, and m g L is what it may be
	local p, v = verify.position(ball), verify.velocity(ball)
	lost = verify.larger(lost, math.abs(v:dot(v) / 2 + g * p.z) / g)
	off = verify.larger(off, math.abs(p:length() - 1))
end)
expect("energy, of m g L", function() return lost, 1e-13 + 4 * verify.rounding end)
expect("distance, m", function() return off, 1e-15 + 4 * verify.rounding end)
-- at rest: from there on it falls with g
expect("period, s late after 1000 s", function() return math.abs(verify.velocity(ball).z) / g, 1e-11 + 1e4 * verify.rounding end)
expect("place, m", function() return (verify.position(ball) - vec3(1, 0, 0)):length(), 1e-11 + 1e4 * verify.rounding end)
