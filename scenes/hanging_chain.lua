-- A chain of links, held at one end and let go from the horizontal, with nothing that rubs.
-- Watch: the far links stay level and fall nearly as if nobody held them, until the bend has come to them.
-- Expected end: every joint is closed and the energy that of the start.
-- Links near the hook swing while the last ones hardly know that they hang on something.
-- Try: --param links=20 (four times the time), --param links=4
-- Takes: some seconds.
local chain = require "rbsim.chain"
local count = param("links", 10, "links", {min = 2, max = 200})
local length, g = 2, 9.81

world { title = "A hanging chain", duration = 2, frame_rate = 60, gravity = {0, 0, -g} }
material { name = "iron", density = 7800, friction = 0, color = {0.45, 0.46, 0.5}, shininess = 60 }
local links, joints = chain.links { count = count, from = {-length / 2, 0, 2}, to = {length / 2, 0, 2}, world = true,
	kind = "hinge", name = "link", keys = {material = "iron", radius = 0.2 * length / count, collides_with = {}} }
camera { name = "side", position = {0, -5, 1.2}, look_at = {0, 0, 1.2}, overlay = {"title", "time"} }

local first = nil
local mass = 0
for _, link in ipairs(links) do mass = mass + link.mass end
on_frame(function() first = first or energy() end)
expect("the energy is that of the start, J", function() return math.abs(energy() - first), 1e-9 * mass * g * length end)
expect("every joint is closed, m", function()
	local worst, half = 0, length / count / 2
	for i = 2, count do
		local gap = links[i].point({0, 0, -half}) - links[i - 1].point({0, 0, half})
		worst = math.max(worst, gap:length())
	end
	return worst, 1e-11 * length
end)
