-- SPDX-License-Identifier: MIT
-- J04: Andrews' squeezing mechanism: seven bodies in a plane, ten hinges, a spring, a torque (Hairer and Wanner, Solving
-- Ordinary Differential Equations II, VII.7). Answer: their angles after 0.03 s, by tests/reference/squeezer.c with 64
-- binary digits. Those that are published, with 14 digits (beta 15.81077119629904), are 1.15e-9 off in beta and up to 2e-11
-- in the others. In space 3 of the 7 closures of each loop are redundant.
local verify = require "rbsim.verify"

verify.case { title = "Andrews' squeezing mechanism", duration = 0.03, time_step = {1e-3, 1e-4, 0.03}, frame_rate = {1 / 0.03, 100, 1000},
	length = 0.0625, method = "located", quick = "base" }
local xa, ya, xb, yb, xc, yc = -0.06934, -0.00227, -0.03635, 0.03273, 0.014, 0.072
local d, da, e, ea, rr, ra, sa, sb, sc, sd = 0.028, 0.0115, 0.02, 0.01421, 0.007, 0.00092, 0.01874, 0.01043, 0.018, 0.02
local ta, tb, u, ua, ub, zf, zt, fa = 0.02308, 0.00916, 0.04, 0.01228, 0.00449, 0.02, 0.04, 0.01421
local beta, theta, gamma, phi, delta, omega, epsilon = -0.0617138900142764496, 0, 0.455279819163070380, 0.222668390165885885,
	0.487364979543842550, -0.222668390165885885, 1.23054744454982119
local cos, sin = math.cos, math.sin
local function body(mass, inertia, x, y, forces)
	return verify.sphere { radius = 1e-3, mass = mass, inertia = {inertia, inertia, inertia}, position = {x, y, 0}, collides_with = {}, forces = forces }
end
local b, p, f = beta + theta, phi + delta, omega + epsilon
local one = body(0.04325, 2.194e-6, ra * cos(beta), ra * sin(beta), {{torque = verify.vector {0, 0, 0.033}}})
local two = body(0.00365, 4.410e-7, rr * cos(beta) - da * cos(b), rr * sin(beta) - da * sin(b))
local three_at = vec3(xb + sa * sin(gamma) + sb * cos(gamma), yb - sa * cos(gamma) + sb * sin(gamma), 0)
local three = body(0.02373, 5.255e-6, three_at.x, three_at.y)
local four = body(0.00706, 5.667e-7, xa + zt * cos(delta) + (e - ea) * sin(p), ya + zt * sin(delta) - (e - ea) * cos(p))
local five = body(0.07050, 1.169e-5, xa + ta * cos(delta) - tb * sin(delta), ya + ta * sin(delta) + tb * cos(delta))
local six = body(0.00706, 5.667e-7, xa + u * sin(epsilon) + (zf - fa) * cos(f), ya - u * cos(epsilon) + (zf - fa) * sin(f))
local seven = body(0.05498, 1.912e-5, xa + ua * sin(epsilon) - ub * cos(epsilon), ya - ua * cos(epsilon) - ub * sin(epsilon))
local wall = verify.sphere { radius = 1e-3, static = true, position = {xc, yc, 0}, collides_with = {} }
local E = vec3(rr * cos(beta) - d * cos(b), rr * sin(beta) - d * sin(b), 0)
local function pin(x, y, at) verify.joint { kind = "hinge", a = x, b = y, at = at, axis = {0, 0, 1} } end
pin(one, nil, {0, 0, 0})
pin(one, two, {rr * cos(beta), rr * sin(beta), 0})
pin(three, nil, {xb, yb, 0})
pin(five, nil, {xa, ya, 0})
pin(seven, nil, {xa, ya, 0})
pin(five, four, {xa + zt * cos(delta), ya + zt * sin(delta), 0})
pin(seven, six, {xa + u * sin(epsilon), ya - u * cos(epsilon), 0})
pin(two, three, E)
pin(two, four, E)
pin(two, six, E)
local spot = vec3(xb + sd * cos(gamma) + sc * sin(gamma), yb + sd * sin(gamma) - sc * cos(gamma), 0)
spring { a = three, b = wall, at_a = spot - three_at, stiffness = 4530, rest_length = 0.07785 }
-- What a body has turned by since the start, to whole turns, against what it should have.
local function off(one, start, wanted)
	local x = verify.axes(one)
	local angle = math.atan(x.y, x.x) - (wanted - start)
	return math.abs(angle - 2 * math.pi * math.floor(angle / (2 * math.pi) + 0.5))
end
local bound = 1e-12 + 1e6 * verify.rounding
-- These two turn with some 800 rad/s then: of what they have turned by.
expect("beta, of itself", function() return off(one, beta, 15.81077119515371) / 15.8, bound end)
expect("beta + Theta, of beta", function() return off(two, b, 0.05440013674186777) / 15.8, bound end)
expect("gamma, rad", function() return off(three, gamma, 0.04082224011964579), bound end)
expect("Phi + delta, rad", function() return off(four, p, -0.01032015046212555), bound end)
expect("delta, rad", function() return off(five, delta, 0.52440996587995405), bound end)
expect("Omega + epsilon, rad", function() return off(six, f, 1.582810857384017), bound end)
expect("epsilon, rad", function() return off(seven, epsilon, 1.048080741041938), bound end)
