-- SPDX-License-Identifier: MIT
-- rbsim.stack: things that are built of blocks and stand, or fall when pushed.
--
--   local stack = require "rbsim.stack"
--   stack.bodies(stack.tower { count = 10, size = {0.2, 0.2, 0.1} }, { material = wood }, "brick")
--
--   tower    { count =, size = }                    one box on the other
--   pyramid  { rows =, size =, gap = }              a wall of rows, each one box shorter than the one below; `gap` m
--                                                   between neighbours, default an eighth of size.x
--   arch     { stones =, radius =, thickness =, width = }  half a circle of wedges about the y axis, inner radius `radius`
--   cards    { levels =, length =, width =, thickness =, lean =, space = }  pairs of cards that lean on each other,
--                                                   `lean` rad from upright (default 30 degrees), a long card over each
--                                                   level but the last; pairs stand `space` apart (default 0.15 length).
--                                                   The left card of a pair is shorter by four thicknesses: its edge
--                                                   then leans on the other's face, which carries what is above
--   dominoes { count =, size =, spacing =, turn = } upright tiles of size {thin, wide, high}, `spacing` from face to
--                                                   face, in a row whose direction turns by `turn` rad from each to
--                                                   the next: a number or function(i), default 0
--   kapla    { floors =, block =, gap = }           floors of nine upright blocks, six lying on them and two across;
--                                                   `block` {thin, middle, long}, default {0.05, 0.1, 0.2}
--   bodies(blocks, keys [, name [, make]])          a body for each block; `keys` are those of box { }, or
--                                                   function(i, block) return keys end; `make` the calls to take,
--                                                   default {box = box, hull = hull}
--
-- The first six return a list of blocks, from the lowest up where there are levels: tables with `position`, `orientation`
-- if it is turned, and `size` of a box or `points` of a hull. They stand on z = 0 about `at` (default the origin), rows
-- along x.

local check = require "rbsim.check"
local stack = {}

local place = {at = "vector"}
local function more(keys)
	for key, kind in pairs(place) do keys[key] = kind end
	return keys
end

local function about(y, angle)
	return {math.cos(angle / 2), 0, y * math.sin(angle / 2), 0}
end

function stack.tower(o)
	check.options("stack.tower", o, {count = "count", size = "size"}, place)
	local at, blocks = vec3(o.at or {0, 0, 0}), {}
	for k = 1, o.count do
		blocks[k] = {size = o.size, position = at + vec3(0, 0, (k - 0.5) * o.size[3])}
	end
	return blocks
end

function stack.pyramid(o)
	check.options("stack.pyramid", o, {rows = "count", size = "size"}, more {gap = "not negative"})
	local at, size, blocks = vec3(o.at or {0, 0, 0}), o.size, {}
	local pitch = size[1] + (o.gap or size[1] / 8)
	for row = 1, o.rows do
		local last = o.rows - row
		for i = 0, last do
			blocks[#blocks + 1] = {size = size, row = row,
				position = at + vec3((i - last / 2) * pitch, 0, (row - 0.5) * size[3])}
		end
	end
	return blocks
end

-- Corners that two stones share are the same numbers, and the left half is the mirror image of the right one.
function stack.arch(o)
	check.options("stack.arch", o, {stones = "count", radius = "positive", thickness = "positive", width = "positive"}, place)
	local n, blocks = o.stones, {}
	local function corner(k, r)
		local mirrored = 2 * k > n
		local angle = math.pi * (mirrored and n - k or k) / n
		local x = 2 * k == n and 0 or r * math.cos(angle)
		return mirrored and -x or x, r * math.sin(angle)
	end
	for k = 0, n - 1 do
		local points = {}
		for _, edge in ipairs {k, k + 1} do
			for _, r in ipairs {o.radius, o.radius + o.thickness} do
				local x, z = corner(edge, r)
				points[#points + 1], points[#points + 2] = {x, -o.width / 2, z}, {x, o.width / 2, z}
			end
		end
		blocks[#blocks + 1] = {points = points, position = vec3(o.at or {0, 0, 0})}
	end
	return blocks
end

-- A pair whose contact is above x, y on the level z.
local function pair(blocks, o, at, lean)
	local t, long, short = o.thickness, o.length, o.length - 4 * o.thickness
	local sin, cos = math.sin(lean), math.cos(lean)
	-- up along the card and out of its lower face, for the one that leans to the right
	local function card(length, side, below)
		local up, face = vec3(side * sin, 0, cos), vec3(side * cos, 0, -sin)
		local touch = at + vec3(0, 0, short * cos)
		blocks[#blocks + 1] = {size = {t, o.width, length}, orientation = about(side, lean),
			position = touch - (length / 2 - below) * up - t / 2 * face}
	end
	card(short, 1, 0)
	card(long, -1, long - short)
end

function stack.cards(o)
	check.options("stack.cards", o, {levels = "count", length = "positive", width = "positive", thickness = "positive"},
		more {lean = "positive", space = "not negative"})
	local at, lean, blocks, z = vec3(o.at or {0, 0, 0}), o.lean or deg(30), {}, 0
	local apart = 2 * o.length * math.sin(lean) + (o.space or 0.15 * o.length)
	for level = 1, o.levels do
		local last = o.levels - level
		for i = 0, last do pair(blocks, o, at + vec3((i - last / 2) * apart, 0, z), lean) end
		z = z + o.length * math.cos(lean) + o.thickness * math.sin(lean)
		if last > 0 then
			blocks[#blocks + 1] = {size = {last * apart + o.length / 2, o.width, o.thickness},
				position = at + vec3(0, 0, z + o.thickness / 2)}
			z = z + o.thickness
		end
	end
	return blocks
end

function stack.dominoes(o)
	check.options("stack.dominoes", o, {count = "count", size = "size", spacing = "positive"}, more {turn = "any"})
	local p, heading, step, blocks = vec3(o.at or {0, 0, 0}), 0, o.size[1] + o.spacing, {}
	for i = 1, o.count do
		blocks[i] = {size = o.size, position = p + vec3(0, 0, o.size[3] / 2), heading = heading,
			orientation = heading ~= 0 and {math.cos(heading / 2), 0, 0, math.sin(heading / 2)} or nil}
		local turn = type(o.turn) == "function" and o.turn(i) or o.turn or 0
		-- half of the turn before the way to the next, half after it: on an arc each stands across its own tangent
		local way = heading + turn / 2
		p, heading = p + step * vec3(math.cos(way), math.sin(way), 0), heading + turn
	end
	return blocks
end

function stack.kapla(o)
	check.options("stack.kapla", o, {floors = "count"}, more {block = "size", gap = "not negative"})
	local at, b, blocks = vec3(o.at or {0, 0, 0}), o.block or {0.05, 0.1, 0.2}, {}
	local thin, middle, long = b[1], b[2], b[3]
	local gap = o.gap or thin / 25
	local rows = long - middle / 2 -- apart, so that one across rests on two rows
	local function add(x, y, z, size) blocks[#blocks + 1] = {size = size, position = at + vec3(x, y, z)} end
	for floor = 0, o.floors - 1 do
		local z = floor * (long + thin)
		for row = -1, 1 do
			for _, x in ipairs {-long - gap / 2 + thin / 2, 0, long + gap / 2 - thin / 2} do
				add(x, row * rows, z + long / 2, {thin, middle, long})
			end
		end
		for row = -1, 1 do
			for side = -1, 1, 2 do
				add(side * (long + gap) / 2, row * rows, z + long + thin / 2, {long, middle, thin})
			end
		end
		for side = -1, 1, 2 do
			add(side * (long + gap) / 2, side * rows / 2, z + long + 1.5 * thin, {middle, long, thin})
		end
	end
	return blocks
end

function stack.bodies(blocks, keys, name, make)
	check.value("stack.bodies", "blocks", blocks, "table")
	if type(keys) ~= "function" then check.value("stack.bodies", "keys", keys, "table") end
	if name ~= nil then check.value("stack.bodies", "name", name, "text") end
	make = make or {box = box, hull = hull}
	local bodies = {}
	for i, block in ipairs(blocks) do
		local own = check.with(type(keys) == "function" and keys(i, block) or keys,
			{position = block.position, orientation = block.orientation, size = block.size, points = block.points})
		if name then own.name = name .. "_" .. i end
		bodies[i] = (block.points and make.hull or make.box)(own)
	end
	return bodies
end

return stack
