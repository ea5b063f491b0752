-- A car with springs and dampers at its four wheels drives over bumps that lie across the road.
-- Watch: wheels jump over every bump while the body hardly nods; without dampers (--param damping=0) it bounces on for long.
-- Expected end: the car has come over all bumps, on its wheels, and its body has stayed nearly level.
-- A bump is short and the body heavy: what a spring passes on in that time is little, and that is what springs are for.
-- Try: --param damping=0, --param stiffness=200000 (a cart), --param speed=4
-- Takes: some seconds.
local wheel = require "rbsim.wheel"
local stiffness = param("stiffness", 2.0e4, "N/m of each spring", {min = 1000, max = 1e6})
local damping = param("damping", 1500.0, "N s/m of each damper", {min = 0, max = 1e5})
local speed = param("speed", 5.0, "m/s", {min = 0.5, max = 15})
local g, r, mass = 9.81, 0.3, 700

world { method = "stepped", time_step = 1 / 480, title = "Springs on a bumpy road", duration = 4, frame_rate = 60, gravity = {0, 0, -g} }
material { name = "rubber", friction = 1, restitution = 0 }
plane { name = "road", material = "rubber", color = {0.42, 0.43, 0.45}, texture = "checker" }
for k = 0, 4 do
	capsule { name = "bump " .. k, radius = 0.12, length = 2.4, static = true, material = "rubber", position = {4 + 2.3 * k, 0, -0.05},
		orientation = {axis = {1, 0, 0}, angle = deg(90)}, color = {0.85, 0.7, 0.2} }
end
local sag = (mass + 100) * g / 4 / stiffness
local body = box { name = "body", size = {2.6, 1.3, 0.45}, mass = mass, position = {0, 0, r + 0.45}, velocity = {speed, 0, 0}, color = {0.75, 0.15, 0.12},
	texture = "none" }
box { name = "roof", size = {1.3, 1.1, 0.4}, mass = 100, position = {-0.15, 0, r + 0.45 + 0.43}, velocity = {speed, 0, 0}, color = {0.7, 0.78, 0.85},
	texture = "none" }
joint { name = "bolts", kind = "fixed", a = body, b = "roof" }
local wheels = {}
for x = -1, 1, 2 do
	for y = -1, 1, 2 do
		wheels[#wheels + 1] = wheel.sprung { body = body, at = {0.85 * x, 0.8 * y, r}, axis = {0, 1, 0}, radius = r, width = 0.2,
			stiffness = stiffness, damping = damping, rest = -sag, travel = {-0.25, 0.2}, speed = speed,
			motor = {speed = speed / r, torque = 150}, material = "rubber", name = ("wheel %d %d"):format(x, y) }
	end
end
camera { name = "side", position = function(t) return {speed * t + 0.6, -6.5, 1.6} end, look_at = body, overlay = {"title", "time"} }

local tilt, high = 0, -math.huge
on_frame(function()
	tilt = math.max(tilt, math.deg(math.acos(math.min(1, body.point({0, 0, 1}).z - body.position.z))))
	high = math.max(high, wheels[1].wheel.position.z)
end)
expect("the car is past the bumps", function() return body.position.x > 13.5 or speed < 4 end)
expect("wheels have been over the bumps", function() return high > r + 0.05 end)
if stiffness <= 3e4 and damping >= 1000 and speed <= 6 then
	expect("the body has stayed nearly level, degrees", function() return tilt, 6 end)
end
expect("it stands on its wheels", function() return body.position.z > r + 0.2 and tilt < 45 end)
