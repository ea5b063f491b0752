-- SPDX-License-Identifier: MIT
-- S35: a needle, a foil, a rod, a disc or a dumb-bell falls aslant on a floor without friction; one corner or end
-- hits first. Answer: J = (1 + e) v/(1/m + (r x n) I^-1 (r x n)), r from the centre of mass to the contact. (With e = 0
-- the corner stays, and the rod and the needle turn about it on to the next one, 0.012 s and 3.6e-7 s later.)
local verify = require "rbsim.verify"
local shape = param("shape", "needle", "what falls", {choices = {"needle", "foil", "rod", "capsule", "disc", "dumb-bell"}})
local e = param("e", 0.5, "restitution", {choices = {0.5, 0.0, 1.0}})
local v, gap, m = 1, 0.1, 2

verify.case { title = "Impact at a tip", duration = 0.105, time_step = {0.01, 1e-3, 0.1}, frame_rate = {100, 10, 60}, quick = "base" }
local stuff = material { name = "stuff", friction = 0, restitution = e }
verify.plane { material = stuff }

-- Turned about the axis (1, 2, 2)/3, so that no edge lies level; rows of the matrix.
local angle, axis = 0.4, vec3(1, 2, 2) / 3
local function turned(p)
	local along = axis:dot(p) * axis
	return along + math.cos(angle) * (p - along) + math.sin(angle) * axis:cross(p)
end
local x, y, z = turned(vec3(1, 0, 0)), turned(vec3(0, 1, 0)), turned(vec3(0, 0, 1))
local function sign(a) return a > 0 and 1 or -1 end

-- `low` is the lowest point of the solid, from its centre.
local keys = {name = "body", mass = m, velocity = {0, 0, -v}, material = stuff, orientation = {axis = axis, angle = angle}}
local sizes = {needle = {1, 1e-6, 1e-6}, foil = {1, 1, 1e-6}, rod = {1, 0.02, 0.03}}
local make, low
if sizes[shape] then
	local s = sizes[shape]
	make, keys.size = verify.box, s
	low = -(s[1] / 2 * sign(x.z) * x + s[2] / 2 * sign(y.z) * y + s[3] / 2 * sign(z.z) * z)
elseif shape == "capsule" then
	make, keys.radius, keys.length = verify.capsule, 0.02, 1
	low = -0.5 * sign(z.z) * z - vec3(0, 0, 0.02)
elseif shape == "disc" then
	make, keys.radius, keys.length = verify.cylinder, 0.5, 1e-3
	local rim = vec3(0, 0, 1) - z.z * z
	low = -0.5 * rim:unit() - 0.5e-3 * sign(z.z) * z
else
	make = verify.body
	keys.shapes = {
		{ shape = "sphere", radius = 0.1, position = {-0.4, 0, 0} }, { shape = "sphere", radius = 0.1, position = {0.4, 0, 0} },
		{ shape = "capsule", radius = 0.03, length = 0.8, orientation = {axis = {0, 1, 0}, angle = deg(90)} } }
	low = -0.4 * sign(x.z) * x - vec3(0, 0, 0.1)
end
keys.position = vec3(0, 0, gap - low.z)
local body = make(keys)

-- In the body's axes, whose inertia is diagonal for all of these.
local rows, arm = body.inertia, low:cross(vec3(0, 0, 1))
local inside = vec3(arm:dot(x) / rows[1][1], arm:dot(y) / rows[2][2], arm:dot(z) / rows[3][3])
local turn = inside.x * x + inside.y * y + inside.z * z
local impulse = (1 + e) * v / (1 / m + turn:dot(arm))

on_collision(function(c)
	if state.time then return end
	state.time, state.impulse = c.time, vec3(c.impulse):length()
	state.velocity, state.spin = verify.velocity(body), verify.spin(body)
	state.tip = verify.back(c.point)
end)
local none = vec3(0 / 0, 0 / 0, 0 / 0)
local fastest = impulse * turn:length()
expect("in time, relative", function() return math.abs((state.time or 0) / (gap / v) - 1), 1e-12 + 4 * verify.rounding / gap end)
expect("where the tip is, m", function()
	return ((state.tip or none) - vec3(low.x, low.y, 0)):length(), 1e-9 + 4 * verify.rounding
end)
expect("impulse, relative", function() return math.abs((state.impulse or 0) / impulse - 1), 1e-9 end)
expect("velocity, relative", function()
	return ((state.velocity or none) - vec3(0, 0, impulse / m - v)):length() / v, 1e-9
end)
expect("spin, relative", function() return ((state.spin or none) - impulse * turn):length() / fastest, 1e-9 end)
