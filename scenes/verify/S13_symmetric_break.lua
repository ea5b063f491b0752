-- SPDX-License-Identifier: MIT
-- S13: a ball hits two touching ones at the same moment. Answer: it goes on at v (1 - 0.6 (1 + e)), they leave at
-- 0.6 (1 + e)/sqrt(3) v to 30 degrees on both sides, mirror images to the bit, in any order of declaration.
local verify = require "rbsim.verify"
local e = param("e", 1.0, "restitution", {choices = {1.0, 0.5}})
local order = param("order", 1, "of declaration", {choices = {1, 2, 3, 4, 5, 6}})
local orders = {{1, 2, 3}, {1, 3, 2}, {2, 1, 3}, {2, 3, 1}, {3, 1, 2}, {3, 2, 1}}
local radius, v = 0.5, 1

verify.case { title = "A symmetric break", duration = 1, time_step = {0.01, 1e-4, 1}, frame_rate = {1, 10, 7},
	quick = "more" }
local ivory = material { name = "ivory", friction = 0, restitution = e }
local places = {{-0.5 - math.sqrt(3) * radius, 0, 0}, {0, radius, 0}, {0, -radius, 0}}
local ball = {}
for _, i in ipairs(orders[order]) do
	ball[i] = verify.sphere { name = ({"cue", "left", "right"})[i], radius = radius, mass = 1, material = ivory,
		position = places[i], velocity = {i == 1 and v or 0, 0, 0} }
end

-- Coordinates that are rounded by d tilt the normals by d/(2 radius), and part the two impacts by d/v.
local bar = 1e-13 + 4 * verify.rounding / radius
local out = 0.6 * (1 + e) / math.sqrt(3) * v
expect("the cue ball", function()
	return (verify.velocity(ball[1]) - vec3(v * (1 - 0.6 * (1 + e)), 0, 0)):length(), bar
end)
expect("the others leave at 30 degrees", function()
	local left = (verify.velocity(ball[2]) - out * vec3(math.sqrt(3) / 2, 0.5, 0)):length()
	local right = (verify.velocity(ball[3]) - out * vec3(math.sqrt(3) / 2, -0.5, 0)):length()
	return verify.larger(left, right), bar
end)
-- To the bit where the mirror plane is a plane of coordinates.
expect("mirror images", function()
	local p, q, c = verify.velocity(ball[2]), verify.velocity(ball[3]), verify.velocity(ball[1])
	local skew = verify.larger(math.abs(p.x - q.x), verify.larger(math.abs(p.y + q.y), math.abs(c.y)))
	return skew, verify.exact and 0 or bar
end)
