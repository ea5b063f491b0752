#!/bin/sh
# SPDX-License-Identifier: MIT
# Springs, drag, fields and driven bodies: what check and info say of them, and who refuses them.
. tests/cli/functions

cat >forces.lua <<'END'
world { duration = 0.1 }
local a = sphere { name = "a", radius = 0.1 }
local b = sphere { name = "b", radius = 0.1, position = {1, 0, 0} }
spring { a = a, b = b, stiffness = 10 }
spring { a = "b", b = "a", stiffness = 1, damping = 0.1 }
drag { linear = 0.1 }
field(function(t, x, v) return {0, 0, -1} end)
END
cat >driven.lua <<'END'
world { duration = 0.1 }
sphere { radius = 0.1 }
sphere { name = "fan", radius = 0.1, position = {0, 5, 0}, motion = function(t)
	return {0, 5, t}, {axis = {0, 0, 1}, angle = t}, {0, 0, 1}
end }
plane { name = "lift", motion = function(t) return {0, 0, -1} end }
END

exits 0 check forces.lua
says out '^  forces +2 springs, 1 drag, 1 field$'
says out '^  \+ springs '
says out '^  \+ field '
exits 0 check forces.lua --json
for count in spring:2 drag:1 field:1; do
	[ "$(value "${count%:*}_count")" = "${count#*:}" ] || fail "check --json: $(cat out)"
done

exits 0 check driven.lua --no-record
says out '^  bodies +3 moving \(2 of them driven\), 0 static$'
says out '^  driven +fan: angular velocity differenced$'
says out '^ +lift: velocity differenced$'
exits 0 check driven.lua --json
[ "$(value driven_count)" = 2 ] || fail "check --json: $(cat out)"

for scene in forces driven; do
	exits 65 $scene.lua --no-record --method classic
	says err "method 'classic' has no"
	[ ! -e $scene.h5 ] || fail "$scene.h5 was made"
done
exits 65 check forces.lua --method classic
for what in springs drag fields; do
	says err "method 'classic' has no $what: use 'located' or 'auto'"
done
sed 's/^field.*/field(function(t, x, v)\n\treturn t\nend)/' forces.lua >wrong.lua
exits 65 wrong.lua --no-record
says err "wrong.lua:7: 'field' must return a finite force"

exits 0 forces.lua --quiet
exits 0 info forces.h5
says out '^  forces +2 springs, 1 drag, 1 field$'
exits 0 driven.lua --quiet
exits 0 info driven.h5 --json
[ "$(value driven_count)" = 2 ] || fail "info --json: $(cat out)"

# torques: for a time, one that turns with its body beside a force, one of a callback; by every method that has boxes
cat >torque.lua <<'LUA'
world { duration = 1, frame_rate = 20, time_step = param("dt", 0.01) }
local bound = param("bound", 1e-12)
local ball = sphere { name = "ball", radius = 0.5, mass = 2, forces = { { torque = {0, 0, 0.3}, start = 0.25, duration = 0.5 } } }
local bar = box { name = "bar", size = {1, 0.2, 0.3}, mass = 3, position = {0, 5, 0}, angular_velocity = {0, 0, 1},
	forces = { { torque = {0, 0, 0.2}, vector = {3, 0, 0}, frame = "body" } } }
local top = sphere { name = "top", radius = 0.5, mass = 2, position = {0, 10, 0} }
on_step(function() top:apply_torque {0.1, 0, 0} end)
local I = 0.4 * 2 * 0.25
local J = 3 * (1 + 0.04) / 12
expect("a torque for a time", function() return math.abs(ball.angular_velocity.z - 0.3 * 0.5 / I), bound end)
expect("a torque that turns with its body", function() return math.abs(bar.angular_velocity.z - 1 - 0.2 / J), bound end)
expect("a torque of a callback", function() return math.abs(top.angular_velocity.x - 0.1 / I), bound end)
expect("speed of a point", function()
	local v = ball:point_velocity {0.5, 0, 0}
	return math.abs(math.sqrt(v.x * v.x + v.y * v.y) - 0.5 * ball.angular_velocity.z), 1e-12
end)
expect("centre", function() return bar.center_of_mass.x == 0 end)
LUA
for method in located stepped auto; do
	exits 0 torque.lua --method $method --no-record --json
	awk -v s="$(value angular_momentum_share)" 'BEGIN { exit !(s < 1e-14) }' || fail "$method: a torque is in no account"
done
cat >nothing.lua <<'LUA'
world { duration = 1 }
sphere { radius = 1, forces = { { start = 1 } } }
LUA
exits 65 check nothing.lua
says err "needs 'vector', or 'direction' and 'magnitude', or 'torque'"

# a spring that pulls so hard that squares overflow says so; it had no end
cat >hard.lua <<'LUA'
world { duration = 1 }
local a = sphere { name = "a", radius = 0.1, mass = 1 }
local b = sphere { name = "b", radius = 0.1, mass = 1, position = {1, 0, 0} }
spring { a = a, b = b, stiffness = 1, rest_length = param("rest", 1e160) }
LUA
for rest in 1e151 1e160 1e300; do
	exits 76 hard.lua --method located --no-record -p rest=$rest
	says err "hard.lua:2: 'a' moves at 0 m/s and gets 1e.${rest#1e} m/s.2 at t = 0 s"
done
exits 0 hard.lua --method located --no-record -p rest=1e140

echo 'world { duration = 1 } sphere { radius = 1, forces = {{vector = {1, 0, 0}, direction = {1, 0, 0}}} }' >both.lua
exits 65 both.lua
says err "forces\[1\]: 'vector' excludes 'direction' and 'magnitude'"
