#!/bin/sh
# SPDX-License-Identifier: MIT
# /joints in recordings: what does not change, what does; in info, plot, and after a render.
. tests/cli/functions
command -v h5dump >/dev/null || { echo "no h5dump"; exit 77; }

cat >swing.lua <<'END'
world { duration = 0.5, frame_rate = 20, gravity = {0, 0, -10} }
local m = material { name = "none", friction = 0 }
local a = sphere { name = "a", radius = 0.1, mass = 2, position = {0, 0, -1}, material = m }
local b = box { name = "b", size = {1, 0.2, 0.2}, mass = 3, position = {0.5, 3, 0}, material = m }
joint { name = "string", kind = "rod", a = a, at_b = {0, 0, 0} }
joint { kind = "hinge", a = b, at = {0, 3, 0}, axis = {0, 1, 0} }
record { fields = {"+", "joints", "events"} }
camera { name = "side", position = {0, -6, 0}, look_at = {0, 0, 0}, size = {64, 48} }
expect("the end is that of a frame", function() return true end)
END
exits 0 swing.lua --quiet --no-render

# dump PATH: the numbers of a dataset, one a line
dump()
{
	h5dump -y -w 0 -m %.17g -d "$1" swing.h5 | sed -n '/DATA {/,/}/p' | tr ',' '\n' | sed -n 's/^ *\(-\{0,1\}[0-9a-z.+-]*\) *$/\1/p' |
		grep -v '^$'
}
[ "$(dump /joints/kind | tr '\n' ' ')" = '6 2 ' ] || fail "kind: $(dump /joints/kind)"
[ "$(dump /joints/a | tr '\n' ' ')" = '0 1 ' ] || fail "a: $(dump /joints/a)"
[ "$(dump /joints/b | tr '\n' ' ')" = '-1 -1 ' ] || fail "b: $(dump /joints/b)"
[ "$(dump /joints/length | tr '\n' ' ')" = '1 0 ' ] || fail "length: $(dump /joints/length)"
h5dump -d /joints/name swing.h5 | grep -q '"string' || fail "no name"
h5dump -a /joints/kind/kinds swing.h5 | grep -q '2 hinge, 3 slider' || fail "no kinds"
[ "$(dump /joints/angle/value | wc -l)" -eq 22 ] || fail "angle: $(dump /joints/angle/value | wc -l) numbers"
[ "$(dump /joints/force/value | wc -l)" -eq 66 ] || fail "force: $(dump /joints/force/value | wc -l) numbers"
[ "$(dump /joints/angle/step | tail -n 1)" = 10 ] || fail "step: $(dump /joints/angle/step)"
h5dump -a /joints/torque/value/units swing.h5 | grep -q 'N m' || fail "no units"
# the string hangs still: its length, no speed
[ "$(dump /joints/angle/value | sed -n 21p)" = 1 ] || fail "length at the end: $(dump /joints/angle/value)"
[ "$(dump /joints/speed/value | sed -n 21p)" = 0 ] || fail "speed at the end: $(dump /joints/speed/value)"
# the bar has turned down, about -y as seen from the world: its angle is that of b, the world, against it
dump /joints/angle/value | sed -n 22p | grep -q '^-\{0,1\}[01]\.' || fail "angle at the end: $(dump /joints/angle/value)"

exits 0 info swing.h5
says out '^  joints +1 hinge, 1 rod$'
says out '^  columns .* joints$'
exits 0 info swing.h5 --json
[ "$(value joint_count)" = 2 ] || fail "info --json: $(cat out)"
exits 0 replay swing.h5
if command -v gnuplot >/dev/null; then
	exits 0 plot swing.h5 string.force joint#1.angle joint#1.speed
	exits 64 plot swing.h5 string.agnle
	says err 'JOINT.angle'
fi
exits 0 render swing.h5 --camera side --frame 5 -o side.png

# joints that are not recorded are drawn all the same; a plot of them says why not
sed 's/^record.*//' swing.lua >plain.lua
exits 0 plain.lua --quiet --no-render
exits 0 render plain.h5 --camera side --frame 5 -o plain.png
cmp -s side.png plain.png || fail "pictures differ by what is recorded"
if command -v gnuplot >/dev/null; then
	exits 66 plot plain.h5 string.force
	says err 'does not record joints'
fi
h5dump -n plain.h5 | grep -q '/joints/kind' || fail "no joints in plain.h5"
exits 1 diff swing.h5 plain.h5
says out 'contacts, events or joints'
