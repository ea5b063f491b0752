-- SPDX-License-Identifier: MIT
-- C06: a cylinder, a capsule, a dumb-bell lie across a slope and are let go. Answer: with c = I/(m r^2) they roll with
-- a = g sin/(1 + c) if mu >= tan c/(1 + c), else slide with a = g (sin - mu cos) and turn with mu g cos/(c r).
local verify = require "rbsim.verify"
local shape = param("shape", "cylinder", "what rolls", {choices = {"cylinder", "capsule", "dumb-bell", "coin"}})
local slope = param("slope", 20, "degrees", {choices = {20, 60}})
local g, r, mu, duration = 9.81, 0.1, 0.4, 2
local sin, cos = math.sin(deg(slope)), math.cos(deg(slope))

verify.case { title = "Solids that roll", duration = duration, gravity = {g * sin, 0, -g * cos}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {10, 1, 60}, quick = "more" }
local stuff = material { name = "stuff", friction = mu, restitution = 0 }
verify.plane { material = stuff }
local across = {axis = {1, 0, 0}, angle = deg(90)}
local keys, body = {name = "body", position = {0, 0, r}, orientation = across, material = stuff}, nil
if shape == "dumb-bell" then
	keys.shapes = {{ shape = "sphere", radius = r, position = {0, 0, -0.2} }, { shape = "sphere", radius = r, position = {0, 0, 0.2} },
		{ shape = "cylinder", radius = r / 3, length = 0.4 }}
	body = verify.body(keys)
else
	keys.radius, keys.length = r, shape == "coin" and 0.05 or 0.3
	body = verify[shape == "capsule" and "capsule" or "cylinder"](keys)
end

local c = body.inertia[3][3] / (body.mass * r * r)
expect("it has the inertia of its shape", function()
	local l = 0.3 -- a capsule: cylinder and two halves of a sphere, by volumes
	local wanted = shape == "capsule" and (0.5 * l + 0.4 * 4 / 3 * r) / (l + 4 / 3 * r) or shape == "dumb-bell" and c or 0.5
	return math.abs(c / wanted - 1), 1e-12
end)
local rolls = mu >= sin / cos * c / (1 + c)
local a = rolls and g * sin / (1 + c) or g * (sin - mu * cos)
local alpha = rolls and a / r or mu * g * cos / (c * r)
expect_always("place, relative", function()
	local wanted = vec3(a * time() ^ 2 / 2, 0, r)
	return (verify.position(body) - wanted):length() / (a * duration ^ 2 / 2), 1e-10 + verify.rounding
end)
expect("velocity, relative", function()
	return (verify.velocity(body) - vec3(a * duration, 0, 0)):length() / (a * duration), 1e-10
end)
expect("spin, relative", function()
	return (verify.spin(body) - vec3(0, alpha * duration, 0)):length() / (alpha * duration), 1e-10
end)
expect_always("it stays across, rad", function()
	local _, _, z = verify.axes(body)
	return z:cross(vec3(0, 1, 0)):length(), 1e-9
end)
