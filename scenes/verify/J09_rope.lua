-- SPDX-License-Identifier: MIT
-- J09: a ball on a rope of 1 m. It falls, 0.6 m beside the point that holds it, until the rope is taut 0.8 m below: with
-- e = 0 it goes on on a circle with 0.6 v, with e = 1 the part along the rope comes back. Or it is thrown from below with
-- v^2 = 3.5 g: the rope goes slack where v^2 = g z, at half its length above the point, and is taut again after
-- 4 v cos/g, where parabola and circle meet.
local verify = require "rbsim.verify"
local way = param("way", "caught", "what it does", {choices = {"caught", "rebounds", "thrown"}})
local g, e = 9.81, way == "rebounds" and 1 or 0
local thrown = way == "thrown"

verify.case { title = "A rope", duration = 1.5, time_step = {0.01, 1e-3, 0.1}, frame_rate = {20, 1, 7}, gravity = {0, 0, -g},
	method = "located", quick = "base" }
local ball = verify.sphere { mass = 2, radius = 0.1, position = thrown and {0, 0, -1} or {0.6, 0, 0},
	velocity = thrown and {0, math.sqrt(3.5 * g), 0} or {0, 0, 0} }
local rope = verify.joint { kind = "rope", a = ball, at_b = {0, 0, 0}, length = 1, restitution = e }
local taut, slack, where, fast, impulse
on_collision(function(c)
	if taut then return end
	taut, fast, impulse = c.time, c.approach_speed, c.impulse:length()
end)
on_transition(function(c)
	if c.kind == "slack" and not slack then slack, where = c.time, verify.position(ball).z end
end)
local v = math.sqrt(1.6 * g)
if thrown then
	expect("height at which it goes slack, m", function() return math.abs(where - 0.5), 1e-11 + 64 * verify.rounding end)
	expect("flight, s", function() return math.abs(taut - slack - 4 * math.sqrt(0.5 * 0.75 / g)), 1e-11 + 64 * verify.rounding end)
else
	expect("moment, s", function() return math.abs(taut - v / g), 4e-16 + 4 * verify.rounding / v end)
	expect("approach, m/s", function() return math.abs(fast - 0.8 * v), 1e-14 + 64 * verify.rounding end)
	expect("impulse, N s", function() return math.abs(impulse - 2 * (1 + e) * 0.8 * v), 1e-13 + 256 * verify.rounding end)
end
if way == "caught" then
	local start = 0.5 * 0.36 * v * v - 0.8 * g
	expect_always("on the circle, m", function() return time() > v / g and math.abs(verify.position(ball):length() - 1) or 0,
		1e-15 + 4 * verify.rounding end)
	expect_always("with its energy, J/kg", function()
		local u = verify.velocity(ball)
		return time() > v / g and math.abs(0.5 * u:dot(u) + g * verify.position(ball).z - start) or 0, 1e-13 + 256 * verify.rounding
	end)
end
