#!/bin/sh
# SPDX-License-Identifier: MIT
# The helpers that are shipped: each in a scene that runs, and what they say when they are misused.
. tests/cli/functions

cat >helpers.lua <<'END'
world { duration = 0.05, frame_rate = 20, gravity = {0, 0, -9.81}, seed = 4 }
local lattice, pile, wall = require "rbsim.lattice", require "rbsim.pile", require "rbsim.wall"
local chain, path, palette, u = require "rbsim.chain", require "rbsim.path", require "rbsim.palette", require "rbsim.units"
local function distance(points)
	local least = math.huge
	for i = 1, #points do
		for j = 1, i - 1 do least = math.min(least, (points[i] - points[j]):length()) end
	end
	return least
end
local function middle(points)
	local sum = vec3(0, 0, 0)
	for _, p in ipairs(points) do sum = sum + p end
	return sum / #points
end

local cubic = lattice.cubic { count = {2, 3, 4}, spacing = 0.5, center = {10, 0, 9} }
assert(#cubic == 24 and math.abs(distance(cubic) - 0.5) < 1e-12 and (middle(cubic) - {10, 0, 9}):length() < 1e-12)
local fcc = lattice.fcc { count = {2, 2, 2}, spacing = 0.5, center = {20, 0, 9} }
assert(#fcc == 32 and math.abs(distance(fcc) - 0.5) < 1e-12 and (middle(fcc) - {20, 0, 9}):length() < 1e-12)
local near = 0
for i = 2, #fcc do if (fcc[i] - fcc[1]):length() < 0.51 then near = near + 1 end end
assert(near >= 3)
local gas = lattice.gas { count = 200, radius = 0.1, size = {2, 2, 2}, center = {30, 0, 9} }
assert(#gas == 200 and distance(gas) >= 0.2)
for _, p in ipairs(gas) do assert(math.abs(p.x - 30) <= 0.9 and math.abs(p.y) <= 0.9 and math.abs(p.z - 9) <= 0.9) end
local balls = lattice.spheres(cubic, { radius = 0.1, color = palette.at(3) }, "c")
assert(balls[24].name == "c_24" and balls[2].position == cubic[2])
lattice.spheres(fcc, function(i) return { radius = i == 1 and 0.2 or 0.1 } end)
lattice.spheres(gas, { radius = 0.1 })

local heap = pile.spheres { count = 30, keys = { radius = 0.1 }, name = "h" }
assert(#heap == 30 and heap[1].position.z == 0.2)
wall.floor()
wall.tray { size = {2, 2}, center = {-10, 0, 1} }
local box = wall.box { size = {100, 100, 100}, center = {0, 0, 50}, open = "-z +z", keys = { texture = "checker" } }
assert(box["-x"].point {0, 0, 0} == vec3(-50, 0, 50) and not box["+z"])
local row = chain.row { count = 5, from = {-20, 0, 5}, direction = {0, 2, 0}, keys = { radius = 5 * u.cm } }
assert((row[5].position - {-20, 0.4, 5}):length() < 1e-12)
local links, joints = chain.links { count = 4, from = {-30, 0, 5}, to = {-30, 3, 1}, world = true, last = row[1] and "world", name = "link",
	kind = "hinge", axis = {1, 0, 0}, keys = { radius = 0.1 } }
assert(#links == 4 and #joints == 5 and links[4].name == "link_4" and joints[1].kind == "hinge" and joints[5].b == nil)
assert((links[1].point {0, 0, -0.625} - {-30, 0, 5}):length() < 1e-12 and (links[4].point {0, 0, 0.625} - {-30, 3, 1}):length() < 1e-12)

local wheel, net = require "rbsim.wheel", require "rbsim.net"
local cart = cylinder { radius = 0.2, length = 0.2, position = {-40, 0, 9}, velocity = {2, 0, 0} }
local fixed = wheel.fixed { body = cart, at = {-40.4, 0.5, 9}, radius = 0.2, width = 0.1, speed = 2, mass = 2 }
local sprung = wheel.sprung { body = cart, at = {-39.6, 0.5, 9}, radius = 0.2, width = 0.1, speed = 2, stiffness = 100, rest = -0.01,
	travel = {-0.1, 0.1}, motor = {speed = 10, torque = 1}, name = "left" }
assert(fixed.wheel.mass == 2 and fixed.axle.kind == "hinge" and fixed.axle.a == cart and not fixed.hub)
assert(sprung.strut.kind == "slider" and sprung.axle.a == sprung.hub and sprung.axle.b == sprung.wheel and sprung.hub.mass == 5)
-- on ground below it would roll: its lowest point stands still
assert((fixed.wheel.angular_velocity - {0, 10, 0}):length() < 1e-12)
local knots, ties = net.sheet { count = {3, 4}, from = {-46, 0, 9}, along = {2, 0, 0}, across = {0, 3, 0}, name = "knot",
	hung = function(i, k) return k == 1 end, keys = { mass = 0.02 } }
assert(#knots == 3 and #knots[1] == 4 and #ties == 2 * 4 + 3 * 3 + 3 and knots[3][4].name == "knot_3_4")
assert(knots[3][4].position == vec3(-44, 3, 9) and ties[1].kind == "ball" and ties[2].kind == "rope" and knots[2][2].mass == 0.02)

local stack = require "rbsim.stack"
local tower = stack.tower { count = 3, size = {1, 1, 0.5}, at = {0, 0, 2} }
assert(#tower == 3 and tower[3].position == vec3(0, 0, 3.25))
local pyramid = stack.pyramid { rows = 3, size = {1, 1, 1}, gap = 0.25 }
assert(#pyramid == 6 and pyramid[4].position == vec3(-0.625, 0, 1.5) and pyramid[4].row == 2)
local arch = stack.arch { stones = 5, radius = 1, thickness = 0.3, width = 0.5 }
assert(#arch == 5 and #arch[1].points == 8)
for i = 1, 4 do assert(arch[1].points[i][3] == 0 and arch[5].points[4 + i][3] == 0) end
local cards = stack.cards { levels = 2, length = 0.4, width = 0.25, thickness = 0.004 }
assert(#cards == 7)
local row_of_tiles = stack.dominoes { count = 4, size = {0.01, 0.02, 0.05}, spacing = 0.01, turn = deg(30) }
assert(#row_of_tiles == 4 and math.abs(row_of_tiles[4].heading - deg(90)) < 1e-12)
assert(math.abs((row_of_tiles[2].position - row_of_tiles[1].position):length() - 0.02) < 1e-12)
local kapla = stack.kapla { floors = 2 }
assert(#kapla == 34 and math.abs(kapla[34].position.z - 0.525) < 1e-12)
local built = stack.bodies(tower, function(i) return { mass = i, collides_with = {} } end, "tower")
assert(built[2].name == "tower_2" and built[2].mass == 2)
stack.bodies(arch, { collides_with = {}, position = {0, 0, 0} }, "wedge")

camera { position = path.orbit { center = {0, 0, 1}, radius = 5, period = 20 }, look_at = heap[1] }
assert((path.orbit { radius = 1, period = 4 }(1) - {0, 1, 0}):length() < 1e-12)
assert(path.line { from = {0, 0, 0}, to = {1, 0, 0}, duration = 2 }(1) == vec3(0.5, 0, 0))
local through = path.through { {0, {0, 0, 0}}, {1, {1, 0, 0}}, {3, {2, 1, 0}} }
assert(through(-1) == vec3(0, 0, 0) and through(1) == vec3(1, 0, 0) and through(9) == vec3(2, 1, 0))
assert((path.shake { at = {1, 1, 1}, size = 0.1 }(3.7) - {1, 1, 1}):length() <= 0.1)
assert(palette.hsv(1 / 3, 1, 1)[2] == 1 and palette.scale(0.5)[1] == 1 and math.abs(u.degree - deg(1)) < 1e-18)
expect("nothing got lost", function() return #heap == 30 end)
END
exits 0 helpers.lua --no-record --quiet

bad()
{
	printf '%s\n' "world { duration = 1 }" "$1" >bad.lua
	exits 65 check bad.lua
	grep -Fq -- "bad.lua:2: $2" err || fail "'$1' does not get '$2'"
}
bad 'require "rbsim.lattice".cubic { count = {2, 2, 0}, spacing = 1 }' "lattice.cubic: 'count' must be three whole numbers"
bad 'require "rbsim.lattice".cubic { spacing = 1 }' "lattice.cubic: option 'count' is missing"
bad 'require "rbsim.lattice".gas { count = 500, radius = 0.4, size = {2, 2, 2} }' 'lattice.gas: no room for sphere'
bad 'require "rbsim.pile".spheres { count = 3, keys = {}, hight = 3 }' "pile.spheres: unknown option 'hight' (there are above"
bad 'require "rbsim.pile".spheres { count = 3, keys = { radius = -1 } }' "pile.spheres: 'keys.radius' must be a positive number (got -1)"
bad 'require "rbsim.wall".box { size = {1, 1, 1}, open = "+w" }' "wall.box: '+w' is no side of a box"
bad 'require "rbsim.stack".tower { count = 2 }' "stack.tower: option 'size' is missing"
bad 'require "rbsim.chain".row { count = 2.5, keys = { radius = 1 } }' "chain.row: 'count' must be a whole number"
bad 'require "rbsim.chain".links { count = 2, from = {0, 0, 0}, to = {0, 0, 0} }' "chain.links: 'from' and 'to' must be apart"
bad 'require "rbsim.chain".links { count = 2, from = {0, 0, 0}, to = {1, 0, 0}, keys = { radius = 0.3 } }' 'chain.links: links are wider than long'
bad 'require "rbsim.chain".links { count = 2, from = {0, 0, 0}, to = {1, 0, 0}, kind = "rod" }' "chain.links: 'kind' must be"
bad 'require "rbsim.net".sheet { count = {1, 2}, along = {1, 0, 0}, across = {0, 1, 0} }' "net.sheet: 'count' must be {columns, rows}"
bad 'require "rbsim.net".sheet { count = {2, 2}, along = {0, 0, 0}, across = {0, 1, 0} }' "net.sheet: 'along' and 'across' must have"
bad 'require "rbsim.wheel".fixed { body = "x", at = {0, 0, 0}, radius = 1, width = 1, rest = 1 }' "wheel.fixed: unknown option 'rest'"
bad 'require "rbsim.path".through { {0, {0, 0, 0}}, {0, {1, 0, 0}} }' 'path.through: times must grow'
bad 'return require "rbsim.units".furlong' "units: no unit 'furlong'"
bad 'require "rbsim.chain".row { count = 2, keys = { radius = 1, raduis = 3 } }' 'sphere (in rbsim.chain:'
bad 'require "rbsim.nothing"' "require 'rbsim.nothing': no such helper is shipped with rbsim"

# A folder of one's own.
mkdir -p own/rbsim
echo 'return { radius = 3 }' >own/rbsim/mine.lua
echo 'world { duration = 1 } sphere { radius = require "rbsim.mine".radius }' >mine.lua
RBSIM_LUA_PATH=$PWD/own
export RBSIM_LUA_PATH
exits 0 check mine.lua
