-- SPDX-License-Identifier: MIT
-- J08: a door, or a drawer, that a constant torque (a force) shuts against its stop. Answer: with acceleration a it is met
-- at t0 = sqrt(2 q/a), again after 2 t0 e^k each time, and rests from t0 + 2 t0 e/(1 - e) on, at the stop.
--
-- A gap is known to the rounding of a place of some metres, which is passed with a t0 e^k: so far off is a rebound, and so
-- are those before it, half as much each.
local verify = require "rbsim.verify"
local kind = param("kind", "door", "hinge or slider, and which limit it meets",
	{choices = {"door", "door low", "drawer", "drawer low"}})
local hinge, side = kind:find("door") ~= nil, kind:find("low") and -1 or 1
local e, q, most, mass, radius = 0.5, 0.5, 2, 3, 0.5
local inertia = hinge and 0.4 * mass * radius ^ 2 or mass
local a = most / inertia
local t0 = math.sqrt(2 * q / a)
local rest = t0 + 2 * t0 * e / (1 - e)

verify.case { title = "A door", duration = 1.25, time_unit = rest, time_step = {0.01, 1e-3, 0.1}, frame_rate = {20, 1, 7},
	method = "located", quick = "base" }
local body = verify.sphere { mass = mass, radius = radius, position = {0.3, -2, 1} }
local stop = verify.joint { kind = hinge and "hinge" or "slider", a = body, at = hinge and {0.3, -2, 1} or nil,
	axis = {0.6, 0, 0.8},
	limits = side > 0 and {-1, q} or {-q, 1}, restitution = e,
	motor = hinge and {speed = side * 100, torque = most} or {speed = side * 100, force = most} }
local met, late, slow, last = 0, 0, 0, 0
local place = 16 * (2 ^ -51 + verify.rounding + (hinge and 0 or verify.shift * 2 ^ -45))
on_collision(function(c)
	local speed = a * t0 * e ^ met
	local time = t0 + 2 * t0 * e * (1 - e ^ met) / (1 - e)
	local off = place / speed + 1e-14 * rest
	late = verify.larger(late, math.abs(c.time - time) / off)
	slow = verify.larger(slow, math.abs(c.approach_speed - speed) / (a * off + 1e-13 * a * t0))
	met, last = met + 1, c.time
end)
expect("moments of rebounds, of their rounding", function() return late, 1 end)
expect("speeds of rebounds, of their rounding", function() return slow, 1 end)
expect("rebounds below rounding are none", function() return met, 60 end)
expect("the last one is where the series ends, s", function() return math.abs(last - rest), 1e-6 end)
expect("it rests at the stop", function() return math.abs((hinge and stop.angle or stop.way) - side * q), place end)
expect("and does not move", function() return math.abs(stop.speed), 1e-15 end)
