-- SPDX-License-Identifier: MIT
-- rbsim.wheel: wheels of vehicles.
--
--   local wheel = require "rbsim.wheel"
--   local left = wheel.sprung { body = car, at = {1, 0.8, 0.3}, axis = {0, 1, 0}, radius = 0.3, width = 0.2,
--       stiffness = 2e4, damping = 1500, rest = -0.1, motor = {speed = 10, torque = 100} }
--
-- wheel.fixed   a cylinder on a hinge of the body; returns {wheel, axle}
-- wheel.sprung  the same on a hub that slides up and down in the body on a spring and a damper; returns
--               {wheel, axle, hub, strut}
--
-- body       the body that it carries
-- at         centre of the wheel at the start
-- axis       of turning; default {0, 1, 0}
-- radius, width
-- material, color, mass   of the wheel; mass: default 15 kg
-- motor      of the axle, as of joint { }; its angle is that of the wheel against the body or the hub
-- speed      m/s, of the body at the start along x; the wheel begins to roll with it
-- name       of the wheel; parts are name.hub, name.axle, name.strut
-- stiffness, damping, rest, travel   of wheel.sprung: of the strut (limits: travel); its way is positive where the wheel is
--            nearer to the body than at the start
-- hub_mass   of wheel.sprung: default a third of the wheel's

local check = require "rbsim.check"
local wheel = {}

local needed = {body = "any", at = "vector", radius = "positive", width = "positive"}
local optional = {axis = "vector", material = "any", color = "any", mass = "positive", motor = "table", speed = "number", name = "text"}
local sprung = {stiffness = "not negative", damping = "not negative", rest = "number", travel = "table", hub_mass = "positive"}

-- The turn that takes the z axis of a cylinder to the axle.
local function lying(axis)
	local w, x, y = 1 + axis.z, -axis.y, axis.x
	if w < 1e-12 then return {0, 1, 0, 0} end
	local length = math.sqrt(w * w + x * x + y * y)
	return {w / length, x / length, y / length, 0}
end

local function make(o, on)
	local axis, speed = vec3(o.axis or {0, 1, 0}):unit(), o.speed or 0
	-- rolling along x on ground below: the point at the bottom stands still
	local spin = speed / o.radius * axis
	local made = {}
	made.wheel = cylinder { name = o.name, radius = o.radius, length = o.width, mass = o.mass or 15, material = o.material,
		color = o.color or {0.12, 0.12, 0.13}, position = o.at, orientation = lying(axis), velocity = {speed, 0, 0},
		angular_velocity = spin }
	made.axle = joint { name = o.name and o.name .. ".axle", kind = "hinge", a = on, b = made.wheel, at = o.at, axis = axis,
		motor = o.motor }
	return made
end

function wheel.fixed(o)
	check.options("wheel.fixed", o, needed, optional)
	return make(o, o.body)
end

function wheel.sprung(o)
	check.options("wheel.sprung", o, needed, check.with(optional, sprung))
	local speed, mass = o.speed or 0, o.hub_mass or (o.mass or 15) / 3
	local hub = sphere { name = o.name and o.name .. ".hub", radius = 0.3 * o.radius, mass = mass, position = o.at, velocity = {speed, 0, 0},
		collides_with = {}, color = {0.6, 0.62, 0.65}, texture = "none" }
	local strut = joint { name = o.name and o.name .. ".strut", kind = "slider", a = o.body, b = hub, at = o.at, axis = {0, 0, 1},
		stiffness = o.stiffness, damping = o.damping, rest = o.rest, limits = o.travel }
	local made = make(o, hub)
	made.hub, made.strut = hub, strut
	return made
end

return wheel
