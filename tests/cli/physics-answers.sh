#!/bin/sh
# SPDX-License-Identifier: MIT
# Problems with known answers, located, in frames turned at random: rounding then is in every coordinate.
. tests/cli/functions

# frame.lua: directions and orientations of a turned frame
cat >frame.lua <<'LUA'
local frame = {}
local turn = param("turn", 0.0, "rad: of all, about an oblique axis")
local axis = vec3(1, 2, -2) / 3
function frame.at(x, y, z)
	local p = vec3(x, y, z)
	return p * math.cos(turn) + axis:cross(p) * math.sin(turn) + axis * (axis:dot(p) * (1 - math.cos(turn)))
end
local c, s = math.cos(turn / 2), math.sin(turn / 2)
frame.orientation = {c, s * axis.x, s * axis.y, s * axis.z}
frame.x, frame.y, frame.z = frame.at(1, 0, 0), frame.at(0, 1, 0), frame.at(0, 0, 1)
return frame
LUA

answers()
{
	timeout 60 "$RBSIM" "$@" --method located --no-record --quiet >out 2>err </dev/null || fail "rbsim $*: exit status $?"
}

# on a spring and no friction: where it turns back nothing happens, whatever way rounding makes its corners go
cat >spring.lua <<'LUA'
local frame = require "frame"
local shape = param("shape", "box", "what is on the spring", {choices = {"box", "cylinder"}})
world { duration = 2, gravity = frame.at(0, 0, -9.81) }
local m = material { name = "m", friction = 0, restitution = 0 }
plane { normal = frame.z, material = m }
local keys = { mass = 2, position = frame.at(1.3, 0, 0.15), orientation = frame.orientation, material = m }
keys.size, keys.radius, keys.length = {0.4, 0.5, 0.3}, 0.2, 0.3
keys[shape == "box" and "radius" or "size"] = nil
if shape == "box" then keys.length = nil end
local b = (shape == "box" and box or cylinder)(keys)
local post = sphere { radius = 0.01, static = true, position = frame.at(-2, 0, 0.15), collides_with = "nothing" }
spring { a = post, b = b, stiffness = 40, rest_length = 2 }
expect("it swings", function() return (b.position - frame.at(1.3 * math.cos(2 * math.sqrt(20)), 0, 0.15)):length(), 1e-11 end)
LUA
for turn in 0 0.7 1.9 2.6; do
	answers spring.lua -p turn=$turn
done
answers spring.lua -p turn=0.7 -p shape=cylinder
exit 0
