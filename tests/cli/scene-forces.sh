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
