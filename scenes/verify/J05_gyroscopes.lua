-- SPDX-License-Identifier: MIT
-- J05: a heavy top, held at a point of its axis, in steady precession, slow or fast; a gyroscope in gimbals; a Furuta pendulum.
-- Answer: the top's axis keeps its tilt q and goes round at W, where I W^2 cos q - C w W + m g l = 0, with C about its axis,
-- I across it at the point and w the spin along it. Of all of them energy and angular momentum about the vertical stay.
--
-- The slow precession is stable: its place is off by roundings of the spin, w, that add up over the time as an angle does.
local verify = require "rbsim.verify"
local what = param("what", "top slow", "which", {choices = {"top slow", "top fast", "gimbals", "furuta"}})
local top = what:find("top") ~= nil
local g, m, l, C, A, q, w = 9.81, 2, 0.3, 0.02, 0.015, 1.1, 100
verify.case { title = "Gyroscopes", duration = 10, time_step = {0.05, 0.01, 0.2}, frame_rate = {10, 1, 7},
	gravity = {0, 0, -g}, method = "located", quick = "base" }
local plain = material { name = "plain", friction = 0 }
local bodies = {}
local function body(keys)
	keys.material, keys.collides_with, keys.radius = plain, {}, 0.05
	bodies[#bodies + 1] = verify.sphere(keys)
	return bodies[#bodies]
end
if top then
	local s, c, I = math.sin(q), math.cos(q), A + m * l * l
	local root = math.sqrt((C * w) ^ 2 - 4 * I * c * m * g * l)
	local W = what == "top slow" and 2 * m * g * l / (C * w + root) or (C * w + root) / (2 * I * c)
	local axis = vec3(s, 0, c)
	local spin = vec3(0, 0, W) + axis * (w - W * c)
	local gyroscope = body { mass = m, inertia = {A, A, C}, position = axis * l, velocity = spin:cross(axis * l),
		angular_velocity = spin, orientation = {axis = vec3(0, 1, 0), angle = q} }
	verify.joint { kind = "ball", a = gyroscope, at = {0, 0, 0} }
	local off = 1e-13 * w * 10
	expect_always("the tilt, of the length", function()
		return math.abs(verify.position(gyroscope).z / l - c), off + 1e3 * verify.rounding
	end)
	expect_always("the place, of the length", function()
		local t = time()
		local there = vec3(s * math.cos(W * t), s * math.sin(W * t), c) * l
		return (verify.position(gyroscope) - there):length() / l, off + 1e3 * w * verify.rounding
	end)
elseif what == "gimbals" then
	local outer = body { mass = 1, inertia = {0.02, 0.02, 0.03}, angular_velocity = {0, 0, 1} }
	local inner = body { mass = 1, inertia = {0.01, 0.012, 0.012}, angular_velocity = {0.5, 0, 1} }
	local rotor = body { mass = 2, inertia = {0.003, 0.005, 0.003}, position = {0, 0.1, 0}, velocity = {-0.1, 0, 0.05},
		angular_velocity = {0.5, 40, 1} }
	verify.joint { kind = "hinge", a = outer, at = {0, 0, 0}, axis = {0, 0, 1} }
	verify.joint { kind = "hinge", a = outer, b = inner, at = {0, 0, 0}, axis = {1, 0, 0} }
	verify.joint { kind = "hinge", a = inner, b = rotor, at = {0, 0, 0}, axis = {0, 1, 0} }
else
	local arm = body { mass = 1, inertia = {0.01, 0.02, 0.02}, position = {0.25, 0, 0}, velocity = {0, 0.5, 0},
		angular_velocity = {0, 0, 2} }
	local rod = body { mass = 0.5, inertia = {0.01, 0.001, 0.01}, position = {0.5, 0.3, 0}, velocity = {-0.6, 1, -0.9},
		angular_velocity = {-3, 0, 2} }
	verify.joint { kind = "hinge", a = arm, at = {0, 0, 0}, axis = {0, 0, 1} }
	verify.joint { kind = "hinge", a = arm, b = rod, at = {0.5, 0, 0}, axis = {1, 0, 0} }
end
local function moving()
	local sum = 0
	for _, b in ipairs(bodies) do sum = sum + b.kinetic_energy end
	return sum
end
local up, origin = verify.vector {0, 0, 1}, verify.point {0, 0, 0}
local energy0, turning0, scale
local lost, turned = 0, 0
on_frame(function()
	-- about the point that is held
	local turning = (angular_momentum() - origin:cross(momentum())):dot(up)
	energy0, turning0, scale = energy0 or energy(), turning0 or turning, scale or moving()
	lost = verify.larger(lost, math.abs(energy() - energy0) / scale)
	turned = verify.larger(turned, math.abs(turning - turning0) / math.abs(turning0))
end)
expect("energy, of the kinetic energy", function() return lost, 1e-12 + 1e3 * verify.rounding end)
expect("angular momentum about the vertical, of itself", function() return turned, 1e-12 + 1e3 * verify.rounding end)
