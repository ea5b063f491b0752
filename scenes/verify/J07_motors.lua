-- SPDX-License-Identifier: MIT
-- J07: a flywheel of I = 0.4 kg m^2 and its motor. Answer, in closed forms: it has its speed of 10 rad/s after I w/tau, with
-- the torque until then and none after; it stalls at a limit, which carries the torque; friction stops it after I w/tau_f; a
-- motor that is to follow an angle a sin(W t) needs -I a W^2 sin(W t), and lets go where that is more than it has.
local verify = require "rbsim.verify"
local way = param("way", "starts", "what it does", {choices = {"starts", "stalls", "stops", "follows", "lags"}})
local I, speed, torque = 0.4, 10, 2
local a, W = 0.8, 3

verify.case { title = "A flywheel and its motor", duration = way == "lags" and 0.6 or 3, time_step = {0.05, 0.01, 0.2}, frame_rate = {16, 1, 7},
	method = "located", quick = "base" }
local start = way == "stops" and speed or (way == "follows" or way == "lags") and a * W or 0
local base = verify.sphere { radius = 0.1, static = true, collides_with = {} }
local wheel = verify.sphere { radius = 0.5, mass = 4, inertia = {I, I, I}, angular_velocity = {0, 0, start}, collides_with = {} }
-- of I a W^2 = 2.88 N m
local max = way == "lags" and 2.5 or torque
local follow = {angle = function(t) return a * math.sin(W * t), a * W * math.cos(W * t) end, torque = way == "lags" and max or 1e3}
local pin = verify.joint { kind = "hinge", a = base, b = wheel, at = {0, 0, 0}, axis = {0, 0, 1},
	motor = (way == "follows" or way == "lags") and follow or way ~= "stops" and {speed = speed, torque = torque} or nil,
	friction = way == "stops" and torque or nil, limits = way == "stalls" and {-1, 1} or nil, restitution = 0 }
local first = {}
on_transition(function(c) first[c.kind] = first[c.kind] or c.time end)
local ramp = I * speed / torque
local function given() return verify.back_vector(pin.torque).z end
if way == "starts" then
	expect_always("speed, rad/s", function()
		return math.abs(pin.speed - math.min(time() * torque / I, speed)), 1e-13 + 64 * verify.rounding
	end)
	expect_always("torque, N m", function()
		return math.abs(time() - ramp) < 1e-9 and 0 or math.abs(given() - (time() < ramp and torque or 0)), 1e-12
	end)
	expect("holds its speed, s late", function() return math.abs(first.drives - ramp), 1e-14 end)
elseif way == "stalls" then
	-- it has 1 rad after sqrt(2 I/torque)
	expect("stands at its limit, rad", function() return math.abs(pin.angle - 1) + math.abs(pin.speed), 1e-14 end)
	expect("the motor pushes on", function() return math.abs(given()), 1e-13 end)
elseif way == "stops" then
	expect_always("speed, rad/s", function()
		return math.abs(pin.speed - math.max(speed - time() * torque / I, 0)), 1e-13 + 64 * verify.rounding
	end)
	expect("holds, s late", function() return math.abs(first.drives - ramp), 1e-14 end)
	expect("angle, rad", function() return math.abs(pin.angle - speed * ramp / 2), 1e-13 end)
elseif way == "follows" then
	expect_always("angle, rad", function() return math.abs(pin.angle - a * math.sin(W * time())), 1e-14 + 16 * verify.rounding end)
	expect_always("torque, N m", function() return math.abs(given() + I * a * W * W * math.sin(W * time())), 1e-11 end)
else
	local slips = math.asin(max / (I * a * W * W)) / W
	expect("lets go, s late", function() return math.abs(first.slips - slips), 1e-10 end)
	expect_always("angle, rad", function()
		local s = time() - slips
		local wanted = s < 0 and a * math.sin(W * time()) or
			a * math.sin(W * slips) + a * W * math.cos(W * slips) * s - max / I * s * s / 2
		return math.abs(pin.angle - wanted), 1e-13 + 16 * verify.rounding
	end)
end
