-- Sixty dominoes stand in two bends; the first one is pushed over.
-- Watch: the wave finds its own speed within the first few tiles, and keeps it round the bends.
-- Expected end: every tile has fallen, one after the other, none twice; impacts and friction have only taken energy.
-- A tile leans on the next, slides down along it, and both lean on the one after: lasting contacts, not only impacts.
-- Try: --param spacing=0.035 (a slower wave), --param count=200, --param push=0.02 (too weak: the first one rocks back)
-- Takes: 35 s of processor time, 5 s without its film.
local count = param("count", 60, "tiles", {min = 2, max = 2000})
local spacing = param("spacing", 0.018, "from face to face, m", {min = 0.005, max = 0.045})
local push = param("push", 0.1, "on the upper edge of the first tile, for a twentieth of a second, N", {min = 0, max = 10})
local palette, stack = require "rbsim.palette", require "rbsim.stack"
local size, g = {0.008, 0.024, 0.048}, 9.81

world { title = "Dominoes", duration = 0.6 + 0.025 * count, frame_rate = 120, gravity = {0, 0, -g} }
local ivory = material { name = "ivory", density = 1800, friction = 0.3, restitution = 0.2, shininess = 40 }
plane { name = "floor", material = material { name = "table", friction = 0.5, color = {0.35, 0.42, 0.38} }, texture = "none" }

-- Half of the row turns left, the other half right.
local tiles = stack.bodies(stack.dominoes { count = count, size = size, spacing = spacing, at = {-0.4, -0.25, 0},
	turn = function(i) return i < count / 2 and 0.06 or -0.06 end },
	function(i)
		local keys = { material = ivory, color = palette.hsv(0.8 * (i - 1) / count, 0.55, 0.9), texture = "none" }
		if i == 1 then keys.forces = {{ vector = {push, 0, 0}, point = {-size[1] / 2, 0, size[3] / 2}, duration = 0.05 }} end
		return keys
	end, "tile")
camera { name = "main", position = {0.0, -0.95, 0.6}, look_at = {-0.03, -0.02, 0}, fov = deg(34), size = {1280, 720},
	overlay = {"title", "time"}, video = "dominoes.mp4" }
camera { name = "close", position = {-0.28, -0.42, 0.12}, look_at = {-0.2, -0.2, 0.02}, size = {640, 360}, speed = 0.25, to = 0.8,
	video = "dominoes-close.mp4" }

-- How far a tile has fallen: the height of its upper edge over that of its lower one, from 1 to about 0.
local function upright(tile) return (tile.point({0, 0, size[3] / 2}) - tile.position).z / (size[3] / 2) end
local start
state.fell = {}
on_frame(function(t)
	start = start or energy()
	for i, tile in ipairs(tiles) do
		if not state.fell[i] and upright(tile) < 0.9 then state.fell[i] = t end
	end
end)
expect("all have fallen", function()
	local most = 0
	for _, tile in ipairs(tiles) do most = math.max(most, upright(tile)) end
	return most, 0.9
end)
expect("one after the other", function()
	for i = 2, count do
		if (state.fell[i] or math.huge) < (state.fell[i - 1] or math.huge) then return false end
	end
	return true
end)
-- The push does less than force times the way of the edge while it lasts.
expect("no energy from nowhere", function() return energy() - start, push * size[3] end)
expect("overlap stays within the tolerance", function() return max_penetration(), penetration_tolerance() end)
