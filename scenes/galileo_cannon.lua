-- Galileo's cannon: balls threaded on an upright cord fall together, the small one on top, and it shoots up.
-- Watch: all hit the ground at one speed; the top ball leaves with several times that and rises far above its start.
-- Expected end: the top ball rises to the height of the closed form for impacts that come one after the other.
-- Each ball meets the next one still coming down: for masses far apart speeds go 1, 3, 7 ..., heights as their squares.
-- Try: --param ratio=2, --param e=0.9
-- Takes: less than a second.
local ratio = param("ratio", 3.0, "of the masses of neighbours", {min = 1.1, max = 100})
local e = param("e", 1.0, "restitution", {min = 0.5, max = 1})
local g, drop, count = 9.81, 0.3, 3
local radius = {0.16, 0.11, 0.075}

world { title = "Galileo's cannon", duration = 3, frame_rate = 60, gravity = {0, 0, -g} }
local rubber = material { name = "rubber", friction = 0, restitution = e, texture = "none" }
plane { name = "ground", material = rubber, color = {0.72, 0.74, 0.76}, texture = "none" }
local gap, z, balls = 0.004, drop, {}
for k = 1, count do
	z = z + radius[k]
	balls[k] = sphere { name = "ball " .. k, radius = radius[k], mass = 3 / ratio ^ (k - 1), material = rubber, position = {0, 0, z},
		color = ({{0.8, 0.25, 0.2}, {0.9, 0.65, 0.2}, {0.25, 0.5, 0.8}})[k] }
	-- The cord through all of them: each slides along it, and may turn about it.
	joint { name = "cord " .. k, kind = "cylindrical", a = balls[k], at = {0, 0, z}, axis = {0, 0, 1}, visible = false }
	z = z + radius[k] + gap
end
capsule { name = "cord", radius = 0.008, length = 5.6, static = true, position = {0, 0, 2.8}, color = {0.55, 0.4, 0.25}, collides_with = {} }
camera { name = "side", position = {0, -6, 2.2}, look_at = {0, 0, 1.95}, trails = {balls[count]}, overlay = {"title", "time"} }

-- Impacts one after the other: ball k goes up with v_k when k + 1 still comes down; gaps make it so, and cost a little height.
local v = math.sqrt(2 * g * drop)
local up = e * v
for k = 1, count - 1 do
	local m, n = balls[k].mass, balls[k + 1].mass
	up = (m * up - n * v + e * m * (up + v)) / (m + n)
end
local top, highest = radius[1] * 2 + radius[2] * 2 + radius[3] + 2 * gap, 0
on_frame(function() highest = math.max(highest, balls[count].position.z) end)
-- A gap is flown through in gap / (2 v), in which heights change by some gaps: a hundredth of the rise, and what frames miss.
expect("the top ball rises as impacts in turn have it, m", function() return math.abs(highest - top - up * up / (2 * g)), 0.01 * up * up / (2 * g) end)
