-- SPDX-License-Identifier: MIT
-- S24: solids lie on a face, an edge of a round one, two ends. Answer: they lie there, and their contacts never change.
local verify = require "rbsim.verify"
local shape = param("shape", "box", "what lies there", {choices = {"box", "cylinder", "lying cylinder", "coin", "lying capsule",
	"tetrahedron", "dumb-bell"}})

verify.case { title = "At rest on a face", duration = 100, gravity = {0, 0, -9.81}, time_step = {0.1, 0.01, 1},
	frame_rate = {1, 10, 0.3}, quick = "more" }
local stuff = material { name = "stuff", friction = 0.5, restitution = 0 }
verify.plane { material = stuff }
local lying = {axis = {1, 0, 0}, angle = deg(90)}
local body
if shape == "box" then
	body = verify.box { size = {0.3, 0.2, 0.1}, position = {0, 0, 0.05}, material = stuff }
elseif shape == "cylinder" then
	body = verify.cylinder { radius = 0.1, length = 0.3, position = {0, 0, 0.15}, material = stuff }
elseif shape == "lying cylinder" then
	body = verify.cylinder { radius = 0.1, length = 0.3, position = {0, 0, 0.1}, orientation = lying, material = stuff }
elseif shape == "coin" then
	body = verify.cylinder { radius = 0.1, length = 1e-3, position = {0, 0, 0.5e-3}, material = stuff }
elseif shape == "lying capsule" then
	body = verify.capsule { radius = 0.1, length = 0.3, position = {0, 0, 0.1}, orientation = lying, material = stuff }
elseif shape == "tetrahedron" then
	body = verify.hull { points = {{0, 0, 0}, {0.3, 0, 0}, {0, 0.2, 0}, {0, 0, 0.25}}, material = stuff }
else
	body = verify.body { position = {0, 0, 0.1}, material = stuff, shapes = {
		{ shape = "sphere", radius = 0.1, position = {-0.2, 0, 0} },
		{ shape = "sphere", radius = 0.1, position = {0.2, 0, 0} },
		{ shape = "capsule", radius = 0.04, length = 0.4, orientation = {axis = {0, 1, 0}, angle = deg(90)} } } }
end

local start, x, y, z = verify.position(body), verify.axes(body)
on_transition(function() state.told = (state.told or 0) + 1 end)
-- Turned obliquely, gravity and the floor's normal are rounded apart by an ulp or two, and what is round rolls on that.
local slant = verify.turn == 2 and verify.u * 9.81 or 0
expect_always("it lies still, m", function()
	return (verify.position(body) - start):length(), 1e-12 + verify.rounding + slant * time() ^ 2
end)
expect_always("it does not turn, rad", function()
	local ax, ay, az = verify.axes(body)
	return verify.larger((ax - x):length(), verify.larger((ay - y):length(), (az - z):length())), 1e-12 + 10 * slant * time() ^ 2
end)
expect("its contacts stay as they are", function() return state.told or 0, 0 end)
expect("nothing hits", function() return collisions(), 0 end)
