-- SPDX-License-Identifier: MIT
-- S14: a box falls flat on a floor or, as steep as it, on a slope: four corners touch at one moment. Answer: it does not
-- begin to turn, and its speed across the floor becomes e times what it was. It is followed until it would land again: what
-- rounding then has turned it, 1e-15 rad, makes a rigid body land corner by corner.
local verify = require "rbsim.verify"
local e = param("e", 0.5, "restitution", {choices = {0.5, 0.0, 1.0}})
local slope = param("slope", 0, "degrees", {choices = {0, 20}})
local g, h, size, duration = 9.81, 1, {0.4, 0.2, 0.1}, 0.85
local sin, cos = math.sin(deg(slope)), math.cos(deg(slope))
local normal, down = vec3(sin, 0, cos), vec3(cos, 0, -sin)

verify.case { title = "A box dropped flat", duration = duration, gravity = {0, 0, -g}, time_step = {0.01, 1e-4, 0.1},
	frame_rate = {10, 1, 60}, quick = "more" }
local stuff = material { name = "stuff", friction = 0, restitution = e }
verify.plane { normal = normal, material = stuff }
local start = (size[3] / 2 + h) * normal
local box = verify.box { name = "box", size = size, position = start, material = stuff,
	orientation = slope ~= 0 and {axis = {0, 1, 0}, angle = deg(slope)} or nil }

-- Height over the floor and its rate: falls, and bounces at e.
local function exact(t)
	local fall, at, up = math.sqrt(2 * h / (g * cos)), 0, 0
	if t < fall then return h - g * cos * t * t / 2, -g * cos * t end
	at, up = fall, e * g * cos * fall
	while up > 0 and t > at + 2 * up / (g * cos) do at, up = at + 2 * up / (g * cos), e * up end
	local s = t - at
	return up > 0 and up * s - g * cos * s * s / 2 or 0, up > 0 and up - g * cos * s or 0
end
-- A slope, and an oblique rotation, are rounded: the face is then not quite parallel to the floor.
local bar = slope == 0 and verify.exact and 1e-13 or 1e-9
expect_always("it does not turn, rad/s", function() return verify.spin(box):length(), bar end)
expect_always("place, m", function()
	local t = time()
	local height = exact(t)
	local wanted = start + (height - h) * normal + g * sin * t * t / 2 * down
	return (verify.position(box) - wanted):length(), 1e-11 + 8 * verify.rounding
end)
expect("velocity, relative", function()
	local _, rate = exact(duration)
	return (verify.velocity(box) - rate * normal - g * sin * duration * down):length() / (g * duration), 1e-11 + 8 * verify.rounding
end)
