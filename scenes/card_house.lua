-- A house of fourteen cards stands on nothing but friction; then a steel ball rolls up and one card has had enough.
-- Watch: nothing moves until the marble comes; --param marble=false leaves the house alone.
-- Expected end: the house has stood until it was hit; without the marble it stands as it was built.
-- Cards lean by 30 degrees: feet and tops need mu >= tan(30 degrees) = 0.58 in the worst place, and get 0.7.
-- Try: --param marble=false --duration 60, --param mu=0.2 (it slides apart at once), --param levels=4
-- Takes: 25 s of processor time, 3 s without its film.
local mu = param("mu", 0.7, "friction of cards", {min = 0, max = 2})
local levels = param("levels", 3, "of pairs", {min = 1, max = 8})
local marble = param("marble", true, "a marble hits the house")
local stack, palette = require "rbsim.stack", require "rbsim.palette"
local g, length, v, radius = 9.81, 0.4, 3, 0.04
local hit = 1

world { title = "A house of cards", duration = 2, frame_rate = 120, gravity = {0, 0, -g} }
local paper = material { name = "card", density = 900, friction = mu, restitution = 0 }
local glass = material { name = "marble", density = 7800, friction = 0.3, restitution = 0.3, color = palette.blue, shininess = 120 }
plane { name = "table", material = paper, color = {0.24, 0.36, 0.30}, texture = "none" }
local cards = stack.bodies(stack.cards { levels = levels, length = length, width = 0.25, thickness = 0.004 },
	function(i) return { material = paper, color = i % 2 == 0 and {0.93, 0.91, 0.86} or {0.80, 0.22, 0.20}, texture = "none" } end, "card")
if marble then
	-- it rolls, and so neither slows down nor slips, until it touches the foot of the house
	local foot = (levels - 1) / 2 * (2 * length * 0.5 + 0.15 * length) + length * 0.5 + 0.004
	sphere { name = "marble", radius = radius, material = glass, position = {foot + v * hit + radius, 0, radius}, velocity = {-v, 0, 0},
		angular_velocity = {0, -v / radius, 0} }
end
camera { name = "main", position = {0.9, -2.6, 0.95}, look_at = {0, 0, 0.5}, fov = deg(36), size = {1280, 720}, overlay = {"title", "time"},
	video = "card_house.mp4" }

local start, moved = {}, 0
for i, card in ipairs(cards) do start[i] = vec3(card.position) end
on_frame(function(t)
	if marble and t > 0.9 * hit then return end
	for i, card in ipairs(cards) do moved = math.max(moved, (card.position - start[i]):length()) end
end)
expect("it stands until it is hit, m", function() return moved, mu >= 0.58 and 1e-6 or math.huge end)
expect("overlap stays within the tolerance", function() return max_penetration(), penetration_tolerance() end)
