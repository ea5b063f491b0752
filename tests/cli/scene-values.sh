#!/bin/sh
# SPDX-License-Identifier: MIT
# Every key of the scene language takes what is no sensible value, or refuses it with the scene's line: status 0 or 65, nothing else.
. tests/cli/functions

# how a table of keys stands in a scene; @ is the key with its value
cat >words <<'END'
world|world { duration = 0.05, @ }
gravitation|world { duration = 0.05, gravitation = { @ } }
material|material { name = "x", @ }
contact_pair|contact_pair(m, m, { @ })
sphere|sphere { static = true, radius = 0.1, @ }
plane|plane { normal = {0, 0, 1}, point = {0, 0, -2}, @ }
box|box { static = true, size = {1, 1, 1}, @ }
capsule|capsule { static = true, radius = 1, length = 1, @ }
cylinder|cylinder { static = true, radius = 1, length = 1, @ }
terrain|terrain { height = function() return 0 end, size = {1, 1}, cells = {2, 2}, @ }
hull|hull { static = true, points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, @ }
union|body { material = m, shapes = {{ shape = "sphere", radius = 0.1 }}, @ }
shapes|body { material = m, shapes = {{ shape = "sphere", radius = 0.1, @ }} }
body|sphere { radius = 0.1, material = m, @ }
forces|sphere { radius = 0.1, material = m, forces = {{ vector = {1, 0, 0}, @ }} }
particles|sphere { radius = 0.1, particles = {{ mass = 1, position = {1, 0, 0} }, { mass = 1, position = {0, 1, 0} }, { mass = 1, position = {0, 0, 1}, @ }} }
spring|spring { a = ball, b = other, stiffness = 1, @ }
drag|drag { linear = 1, @ }
camera|camera { @ }
film|camera { name = "front" } film { rows = {{"front"}}, video = "a.mp4", @ }
units|camera { units = { @ } }
lights|camera { lights = {{ direction = {0, 0, -1}, @ }} }
record|record { @ }
field|field(function() return {0, 0, 0} end, { @ })
result|result("q", function() return 1 end, { @ })
joint|joint { kind = "hinge", a = ball, at = {0, 0, 5}, axis = {0, 1, 0}, @ }
motor|joint { kind = "hinge", a = ball, at = {0, 0, 5}, axis = {0, 1, 0}, motor = { @ } }
param|param("q", 1, "help", { @ })
END
cat >values <<'END'
0 / 0
-1 / 0
1e308
1e-320
-1
math.mininteger
("x"):rep(100000)
{1e308, 1e308, 1e308}
{0 / 0, 0, 0}
{{}}
{[1] = 1, [1e15] = 2}
function() return 1 / 0 end
setmetatable({}, { __index = function() error("inherited") end })
END
# a program with a sanitizer is slow to start: there each key has one of four, and the keys of a kind have all of them
every=1
[ "${RBSIM_MODE:-release}" = release ] || { sed -n '1p;5p;8p;13p' values >few && mv few values && every=4; }

"$RBSIM" --print-tables scene | sed -n 's/^\.\\" table /table /p; s/^\.It Ic \([a-zA-Z_0-9]*\).*/\1/p' >rows
[ "$(grep -vc '^table' rows)" -gt 100 ] || fail "the tables of keys are not to be seen"
# how they stand without is right
while IFS='|' read -r table scene; do
	[ "$table" = world ] || [ "$table" = gravitation ] || echo 'world { duration = 0.05 }' >plain.lua
	[ "$table" != world ] && [ "$table" != gravitation ] || : >plain.lua
	cat >>plain.lua <<'END'
local m = material { name = "m", density = 1000 }
local ball = sphere { name = "ball", radius = 0.1, position = {0, 0, 5}, material = m }
local other = sphere { radius = 0.1, position = {0, 5, 5}, material = m }
END
	echo "$scene" | sed 's/, motor = { @ }//; s/, @//; s/@//' >>plain.lua
	exits 0 check plain.lua
done <words

awk -F '|' -v every=$every '
FILENAME == "words" { word[$1] = $2; next }
FILENAME == "values" { value[++values] = $0; next }
/^table / { table = substr($0, 7); if (!(table in word)) { print "no word for table " table >"missing" } next }
{
	for (v = 1 + keys++ % every; v <= values; v += every) {
		scene = word[table]
		given = $0 " = " value[v]
		while ((at = index(scene, "@"))) scene = substr(scene, 1, at - 1) given substr(scene, at + 1)
		file = table "-" $0 "-" v ".lua"
		if (table != "world") print "world { duration = 0.05 }" >file
		print "local m = material { name = \"m\", density = 1000 }" >file
		print "local ball = sphere { radius = 0.1, position = {0, 0, 5}, material = m }" >file
		print "local other = sphere { radius = 0.1, position = {0, 5, 5}, material = m }" >file
		print scene >file
		close(file)
		print file
	}
}' words values rows >files
[ ! -e missing ] || fail "$(cat missing)"
tried=0
while read -r file; do
	tried=$((tried + 1))
	timeout "$PATIENCE" "$RBSIM" check "$file" >out 2>err </dev/null
	case $? in
	0) ;;
	65) grep -q "^$file:" err || fail "$file is refused without its name: $(tail -n 1 "$file")" ;;
	*) fail "$file: exit status $?: $(tail -n 1 "$file")" ;;
	esac
done <files
echo "$tried values tried"
exit 0
