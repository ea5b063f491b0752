-- SPDX-License-Identifier: MIT
-- C15: what rolls slowly over the edge of a table turns about it, then slips, then leaves it: sphere, cylinder, capsule.
-- Answer: with k = I/(m r^2) and the angle t from upright, w^2 r^2 = v^2 + 2 g r (1 - cos t)/(1 + k) until the friction that
-- it takes, k/(1 + k) m g sin t, is more than mu times the pressure m (g cos t - w^2 r); from there d(w^2)/dt = 2 (g sin t -
-- mu N/m)/r, solved here in closed form, and the spin grows by mu N/(k m r), until the pressure is gone.
local verify = require "rbsim.verify"
local shape = param("shape", "sphere", "what rolls", {choices = {"sphere", "cylinder", "capsule"}})
local mu = param("mu", 1.0, "friction", {choices = {1.0, 0.3}})
local g, r, v = 9.81, 0.1, 0.1

verify.case { title = "Over an edge", duration = 0.8, length = r, gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {20, 1, 7}, quick = "base" }
local stuff = material { name = "stuff", friction = mu, restitution = 0 }
verify.box { name = "table", size = {1, 1, 1}, position = {-0.5, 0, -0.5}, material = stuff, static = true }
local keys = {name = "body", radius = r, position = {-0.01, 0, r}, velocity = {v, 0, 0}, angular_velocity = {0, v / r, 0},
	mass = 1, material = stuff}
if shape ~= "sphere" then keys.length, keys.orientation = 1.5 * r, {axis = {1, 0, 0}, angle = deg(90)} end
local body = verify[shape](keys)
local k = shape == "sphere" and 0.4 or body.inertia[3][3] / (body.mass * r * r)

local function root(f, low, high)
	for _ = 1, 200 do
		local middle = (low + high) / 2
		if f(middle) > 0 then high = middle else low = middle end
	end
	return (low + high) / 2
end

-- With q = w^2 r/g: until it slips; from there dq/dt = 2 (sin t - mu (cos t - q)).
local function turning(t) return v * v / (g * r) + 2 * (1 - math.cos(t)) / (1 + k) end
local slips = root(function(t) return k / (1 + k) * math.sin(t) - mu * (math.cos(t) - turning(t)) end, 0, 1.2)
local function particular(t) return ((4 * mu * mu - 2) * math.cos(t) - 6 * mu * math.sin(t)) / (1 + 4 * mu * mu) end
local function slipping(t) return particular(t) + (turning(slips) - particular(slips)) * math.exp(2 * mu * (t - slips)) end
local leaves = root(function(t) return slipping(t) - math.cos(t) end, slips, 1.5)
-- the spin grows by mu g (cos t - q)/(k r w): Simpson's rule
local function grows(t) return mu * g * (math.cos(t) - slipping(t)) / (k * r * math.sqrt(slipping(t) * g / r)) end
local spin, n = math.sqrt(turning(slips) * g / r), 2000
for i = 0, n do
	local weight = (i == 0 or i == n) and 1 or i % 2 == 1 and 4 or 2
	spin = spin + weight * grows(slips + (leaves - slips) * i / n) * (leaves - slips) / (3 * n)
end
local ahead = math.sqrt(slipping(leaves) * g * r) * math.cos(leaves)

local impacts, begins = 0, nil
on_collision(function() impacts = impacts + 1 end)
on_transition(function(c)
	if c.kind == "slide" and not begins then begins = verify.position(body).z / r end
end)
expect("nothing is hit", function() return impacts, 0 end)
expect("where it begins to slip, of the radius", function()
	return math.abs((begins or 0) - math.cos(slips)), 1e-9 + 64 * verify.rounding / r
end)
expect("speed ahead, relative", function()
	return math.abs(verify.velocity(body).x / ahead - 1), 1e-9 + 64 * verify.rounding / r
end)
expect("spin, relative", function()
	return (verify.spin(body) - vec3(0, spin, 0)):length() / spin, 1e-9 + 64 * verify.rounding / r
end)
expect("nothing aside, relative", function()
	return math.abs(verify.velocity(body).y) / ahead, 1e-9 + 64 * verify.rounding / r
end)
