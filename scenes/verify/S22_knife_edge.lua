-- SPDX-License-Identifier: MIT
-- S22: a cube balances on an edge, upright to rounding or 1e-9 rad beside. Answer: the former stays for 5 s; the latter
-- falls about the edge, with theta'' = 3 g sin(theta)/(4 R), R half of the diagonal, and lands flat at 45 degrees.
local verify = require "rbsim.verify"
local beside = param("beside", 1e-9, "rad", {choices = {1e-9, 0.0}})
local g, side = 9.81, 1
local half = side / math.sqrt(2)
local rate = 3 * g / (4 * half)

-- theta'^2 = 2 rate (cos(beside) - cos(theta)), by Simpson's rule over s, theta = beside cosh(s): there the integrand is
-- smooth, and the difference of the cosines, as a product of sines, has no cancellation.
local function cosh(s) return (math.exp(s) + math.exp(-s)) / 2 end
local function sinh(s) return (math.exp(s) - math.exp(-s)) / 2 end
local function time_to(theta)
	local x, n, sum = theta / beside, 20000, 0
	local h = math.log(x + math.sqrt(x * x - 1)) / n
	for k = 0, n do
		local s = k * h
		local less, more = beside * sinh(s / 2) ^ 2, beside * (cosh(s) + 1) / 2
		local dt = k == 0 and 1 / math.sqrt(rate)
			or beside * sinh(s) / math.sqrt(4 * rate * math.sin(less) * math.sin(more))
		sum = sum + ((k == 0 or k == n) and 1 or k % 2 == 1 and 4 or 2) * dt
	end
	return sum * h / 3
end
local falls = beside > 0 and time_to(deg(45))

verify.case { title = "A knife edge", duration = beside > 0 and falls + 1 or 5, gravity = {0, 0, -g}, time_step = {0.01, 1e-3, 0.1},
	frame_rate = {10, 1, 60}, quick = "more" }
local stuff = material { name = "stuff", friction = 1, restitution = 0 }
verify.plane { material = stuff }
local box = verify.box { name = "box", size = {side, side, side}, position = {0, 0, half * math.cos(beside)}, material = stuff,
	orientation = {axis = {0, 1, 0}, angle = deg(45) + beside} }

on_collision(function(c) state.hit = state.hit or c.time end)
if beside > 0 then
	-- an orientation that is rounded by 2e-16 rad moves the moment by that over `beside`, over the rate of growth
	expect("it falls in time, relative", function()
		return math.abs((state.hit or 0) / falls - 1), 1e-5
	end)
	expect("it lies on its face, m", function()
		return math.abs(verify.position(box).z - side / 2), 1e-8 * side + 8 * verify.rounding
	end)
	expect("it does not turn aside", function()
		local _, y = verify.axes(box)
		return (y - vec3(0, 1, 0)):length(), 1e-9
	end)
else
	-- 2e-16 rad grow by exp(5 sqrt(rate)), ten million times
	expect_always("it stands, rad", function()
		local x = verify.axes(box)
		return math.abs(x.x + x.z), 1e-6
	end)
	expect("nothing has hit", function() return collisions(), 0 end)
end
