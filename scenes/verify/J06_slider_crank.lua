-- SPDX-License-Identifier: MIT
-- J06: a slider-crank that a motor turns at W, far below what it can do. Answer: the piston is at
-- r cos Wt + sqrt(l^2 - r^2 sin^2 Wt). Let go, without a motor, its energy stays; with friction of the piston's rail it
-- stops and stays, and the ledger explains where the energy went.
local verify = require "rbsim.verify"
local way = param("way", "driven", "how it moves", {choices = {"driven", "free", "rubs"}})
local r, l, W = 0.25, 0.6, 8

verify.case { title = "A slider-crank", duration = 5, time_step = {0.05, 0.01, 0.2}, frame_rate = {10, 1, 7},
	method = "located", quick = "base" }
local plain = material { name = "plain", friction = 0 }
local function rod(length, mass, keys)
	keys.mass, keys.material, keys.collides_with, keys.radius = mass, plain, {}, 0.05
	keys.inertia = {1e-3, mass * length ^ 2 / 12, mass * length ^ 2 / 12}
	return verify.sphere(keys)
end
local crank = rod(r, 2, {position = {r / 2, 0, 0}, velocity = {0, W * r / 2, 0}, angular_velocity = {0, 0, W}})
-- at the start its far end stands still
local coupler = rod(l, 1, {position = {r + l / 2, 0, 0}, velocity = {0, W * r / 2, 0}, angular_velocity = {0, 0, -W * r / l}})
local piston = rod(0.1, 3, {position = {r + l, 0, 0}})
local frame = verify.sphere { radius = 0.05, static = true, material = plain, collides_with = {} }
verify.joint { kind = "hinge", a = frame, b = crank, at = {0, 0, 0}, axis = {0, 0, 1},
	motor = way == "driven" and {speed = W, torque = 1e4} or nil }
verify.joint { kind = "hinge", a = crank, b = coupler, at = {r, 0, 0}, axis = {0, 0, 1} }
verify.joint { kind = "hinge", a = coupler, b = piston, at = {r + l, 0, 0}, axis = {0, 0, 1} }
local rail = verify.joint { kind = "slider", a = piston, axis = {1, 0, 0}, friction = way == "rubs" and 5 or nil }
if way == "driven" then
	expect_always("the piston, m", function()
		local x = r * math.cos(W * time()) + math.sqrt(l * l - (r * math.sin(W * time())) ^ 2)
		return (verify.position(piston) - vec3(x, 0, 0)):length(), 1e-12 + 256 * verify.rounding
	end)
elseif way == "free" then
	local first
	local lost = 0
	on_frame(function()
		first = first or energy()
		lost = verify.larger(lost, math.abs(energy() / first - 1))
	end)
	expect("energy, of itself", function() return lost, 1e-12 + 1e3 * verify.rounding end)
	expect_always("piston and crank agree, m", function()
		local pin = verify.position(crank) * 2
		return math.abs(verify.position(piston).x - pin.x - math.sqrt(l * l - pin.y ^ 2)), 1e-12 + 256 * verify.rounding
	end)
else
	local holds
	on_transition(function(c) holds = c.kind == "drives" end)
	expect("it has stopped", function() return energy(), 1e-25 end)
	expect("and the rail holds it", function() return holds end)
end
