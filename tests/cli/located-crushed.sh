#!/bin/sh
# SPDX-License-Identifier: MIT
# What is driven against bodies that cannot give way ends the run, with status 76 and both names; it had no end, as rounds of impacts
# that cannot succeed were tried again and again. What finds a way out is pushed out.
. tests/cli/functions

press='plane { name = "press", normal = {0, 0, -1}, motion = function(t) return {0, 0, 3 - 2 * t}, nil, {0, 0, -2} end }'
lid='local lid = box { name = "lid", size = {2, 1, 0.1}, position = {0, 0, 1.05}, motion = function(t) return {0, 0, 1.05 - t / 2} end }'
ram='local ram = sphere { name = "ram", radius = 0.1, collides_with = {}, motion = function(t) return {0, 0, 4 - 2 * t} end }'

# scene DRIVER FRICTION GRAVITY BODIES
scene()
{
	echo "world { duration = 1.4, gravity = {0, 0, $3} }
local m = material { friction = $2, restitution = 0.3, density = 1000 }
plane { name = 'floor', normal = {0, 0, 1}, material = m }
$1
$4" >crush.lua
}

# crushed NAME NAME: the run ends with status 76, which names both; by auto too, which steps there
crushed()
{
	exits 76 crush.lua --method located --no-record --quiet
	says err "no impulses end the approach of '($1)' and '($2)' at t = 0[.][0-9]* s, at [0-9.]* m/s"
	exits 76 crush.lua --no-record --quiet
}

scene "$press" 0.5 0 'sphere { name = "ball", radius = 1, position = {0, 0, 1}, material = m }'
crushed press ball
scene "$press" 0 -9.81 'box { name = "box", size = {1, 1, 2}, position = {0, 0, 1.2}, material = m }'
crushed 'press|floor|box' 'floor|box'
scene "$press" 0.4 0 'for i = 0, 1 do sphere { name = "ball " .. i, radius = 0.5, position = {0, 0, 0.5 + i}, material = m } end'
crushed '.*' '.*'
scene "$press" 0.3 0 'cylinder { name = "can", radius = 0.5, length = 2, position = {0, 0, 1}, material = m }'
crushed 'press|floor|can' 'floor|can'
scene "$lid" 0.3 0 'sphere { name = "large", radius = 0.3, position = {0, 0, 0.3}, material = m }
sphere { name = "small", radius = 0.2, position = {0.7, 0, 0.2}, material = m }'
crushed 'lid|floor|large' 'floor|large'
scene "$ram" 0.3 0 'local ball = sphere { name = "ball", radius = 0.5, position = {0, 0, 1.5}, velocity = {0, 0, -2}, material = m }
joint { kind = "rod", a = ram, b = ball }'
crushed 'floor|ball' 'floor|ball'
scene "$press" 0.3 0 'local box = box { name = "box", size = {1, 1, 1}, position = {0, 0, 0.7}, material = m }
joint { kind = "slider", a = box, axis = {0, 0, 1}, limits = {-0.1, 0.1}, restitution = 0.3 }'
crushed 'press|box' 'press|box'
scene "$press
for s = -1, 1, 2 do
	plane { name = 'wall' .. s, normal = {s * math.cos(math.pi / 6), 0, 0.5}, material = m }
end" 0.9 0 'sphere { name = "ball", radius = 0.5, position = {0, 0, 1}, material = m }'
crushed 'press|wall.*|ball' 'press|wall.*|ball'

# ropes to bodies that part
echo 'world { duration = 1, gravity = {0, 0, 0} }
local up = sphere { name = "up", radius = 0.1, position = {0, 0, 1}, motion = function(t) return {0, 0, 1 + t} end }
local down = sphere { name = "down", radius = 0.1, motion = function(t) return {0, 0, -t * t} end }
local ball = sphere { name = "ball", radius = 0.1, mass = 1, position = {0, 0, 0.5}, velocity = {0, 0, 0.5} }
joint { name = "upper", kind = "rope", a = up, b = ball, length = 0.7 }
joint { name = "lower", kind = "rope", a = down, b = ball, length = 0.7 }' >crush.lua
exits 76 crush.lua --method located --no-record --quiet
says err "no impulses end the approach of rope '(upper|lower)' and what is joined to it at t = 0[.][0-9]* s"

# beside the lowest point of a ram without friction
scene 'sphere { name = "ram", radius = 0.5, material = m, motion = function(t) return {0.2, 0, 3 - 2 * t} end }' 0 0 \
	'sphere { name = "ball", radius = 0.5, position = {0, 0, 0.5}, material = m }'
exits 0 crush.lua --method located --no-record --quiet
