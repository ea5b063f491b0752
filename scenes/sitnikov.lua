-- A light body falls up and down through the middle of two stars that circle each other, along the axis of their circle.
-- Watch: it comes to rest at a height of 1 each 6.0008 s; the stars do not feel it: its gravitational mass is 0.
-- Expected end: after five periods it is back at the top, to 1e-12.
-- With stars on ellipses the same becomes chaotic (Sitnikov 1960): any sequence of whole numbers of turns between two passages occurs.
-- Try: --param e=0.1 (ellipses: periods are no longer the same)
-- Takes: less than a second.
local e = param("e", 0.0, "eccentricity of the stars' orbits", {min = 0, max = 0.9})
local period = 6.00081898038198801
world { title = "Sitnikov's problem", duration = 5 * period, frame_rate = 60, gravitation = {G = 1} }
local light = material { name = "light", friction = 0 }
-- at the largest distance, 1 + e
local function star(name, side)
	return sphere { name = name, radius = 0.04, mass = 0.5, position = {side * (1 + e) / 2, 0, 0},
		velocity = {0, side / 2 * math.sqrt((1 - e) / (1 + e)), 0}, material = light }
end
local left, right = star("left", -1), star("right", 1)
local test = sphere { name = "test", radius = 0.02, mass = 1e-3, gravitational_mass = 0, position = {0, 0, 1}, material = light }
camera { name = "side", position = {2, -3, 0.8}, look_at = {0, 0, 0}, trails = {left, right, test}, overlay = {"title", "time"} }

local aside = 0
on_frame(function() aside = math.max(aside, math.abs(test.position.x), math.abs(test.position.y)) end)
expect("on the axis, m", function() return aside, 1e-12 end)
if e == 0 then
	expect("back at the top after five periods, m", function() return (test.position - vec3(0, 0, 1)):length(), 1e-12 end)
end
expect("the stars turn about the middle, m", function() return (left.position + right.position):length(), 1e-13 end)
