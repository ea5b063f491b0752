#!/bin/sh
# SPDX-License-Identifier: MIT
# rbsim plot draws quantities of a recording and results of a sweep, and says what it cannot draw.
. tests/cli/functions

small_scene 'local e = param("e", 0.5, "x")' >s.lua
exits 0 s.lua -q -o run.h5
exits 0 sweep s.lua -p e=0.1,0.5,0.9 -o d -q
exits 0 collect d -q
cat >two.lua <<'END'
world { duration = 0.1 }
for name, z in pairs {a1 = 1, a2 = 5, a21 = 9, a22 = 13} do
	sphere { name = name, radius = 0.1, mass = 1, position = {z, 0, z} }
end
END
exits 0 two.lua -q -o two.h5
# with --json the same as numbers, for which nothing need be installed
exits 0 plot run.h5 left.z kinetic_energy --json
says out '^\{"file":"run.h5","against":\{"name":"time","unit":"s","values":\[0,0.0166'
says out '"quantities":\[\{"name":"left.z","unit":"m","values":\[0.2999.*\{"name":"kinetic_energy","unit":"J".*"picture":null,"exit_status":0\}$'
exits 0 plot d/sweep.h5 e --against index --json
says out '"against":\{"name":"index","unit":"","values":\[0,1,2\]\},"quantities":\[\{"name":"e","unit":"","values":\[0.1.*,0.5,0.9'
exits 64 plot run.h5 lfet.z --json
says err "no quantity 'lfet.z' \(did you mean 'left.z'\?\)"
exits 64 plot run.h5 kinetic_enrgy --json
says err "no quantity 'kinetic_enrgy' \(did you mean 'kinetic_energy'\?\)"
if ! command -v gnuplot >/dev/null; then
	exits 69 plot run.h5 energy
	says err "no 'gnuplot' in PATH .install the package gnuplot-nox)"
	echo "no gnuplot"
	exit 77
fi

exits 0 plot run.h5 energy kinetic_energy left.z
says out 'time \[s\]'
says out 'left.z'
# units in a text, too: of one quantity, of several that share it, and at the names where they differ
exits 0 plot run.h5 left.z
says out '^left.z \[m\]'
exits 0 plot run.h5 energy kinetic_energy
says out '^\[J\]'
exits 0 plot run.h5 left.z left.vz
says out 'left.vz \[m/s\]'
# of two bodies whose names are alike the one that was named, and no other
exits 0 plot two.h5 a2.z
says out ' 5 [+|]\*\*'
exits 0 plot two.h5 a21.z
says out ' 9 [+|]\*\*'
# what is constant but for rounding is a level line
cat >still.lua <<'END'
world { duration = 2, frame_rate = 16, gravity = {0, 0, -9.81} }
joint { kind = "rod", a = sphere { radius = 0.1, mass = 1, position = {1, 0, 1} }, at_b = {0, 0, 1} }
END
exits 0 still.lua -q
exits 0 plot still.h5 energy
[ "$(grep -c '[*][*][*]' out)" -le 3 ] || fail "the energy of a pendulum is no level line"
exits 0 plot d/sweep.h5 e --against e
[ "$(grep -o X out | wc -l)" -ge 4 ] || fail "not a cross for each run and one in the key"

# the points of a picture are those of the recording: the height falls from 0.3 m and never below the radius
mkdir bin
cat >bin/gnuplot <<'END'
#!/bin/sh
tee "$SCRIPT_OF_TEST" >/dev/null
echo picture
END
chmod +x bin/gnuplot
SCRIPT_OF_TEST=$PWD/script
export SCRIPT_OF_TEST
plain=$PATH
PATH=$PWD/bin:$PATH
exits 0 plot run.h5 left.z right.vx momentum -o z.svg
[ "$(cat z.svg)" = picture ] || fail "no picture"
awk '/^\$data0/ { inside = 1; next } /^END/ { if (inside) exit } inside { print }' script >points
awk 'NR == 1 && ($1 != 0 || $2 != 0.3) || $2 < 0.0999 || $2 > 0.3 { exit 1 } END { exit NR != 31 }' points ||
	fail "other heights: $(head -n 3 points)"
awk '/^\$data1/ { inside = 1; next } /^END/ { if (inside) exit } inside { print }' script | head -n 1 | grep -qx '0 -1' ||
	fail "another velocity of the right ball"
exits 0 plot d/sweep.h5 frames --against e -o s.png
awk '/^\$data0/ { inside = 1; next } /^END/ { if (inside) exit } inside { print }' script | cut -d ' ' -f 2 | sort -u >frames
[ "$(cat frames)" = 31 ] || fail "frames: $(cat frames)"
points()
{
	awk '/^\$data0/ { inside = 1; next } /^END/ { if (inside) exit } inside { print }' script
}
# a phase plot, with units at both axes
exits 0 plot run.h5 left.vz --against left.z -o phase.svg
says script 'set xlabel .left.z \[m\]'
says script 'set ylabel .left.vz \[m/s\]'
points | awk 'NR == 1 && ($1 != 0.3 || $2 != 0) { exit 1 } END { exit NR != 31 }' ||
	fail "another first point: $(sed -n 1,40p script)"
# units that differ stand at the names, shared ones at the axis
exits 0 plot run.h5 left.z left.vz -o z.svg --force
says script 'left.vz \[m/s\]'
exits 0 plot run.h5 left.z right.z -o z.svg --force
says script "set ylabel .\[m\]"

# a wheel that spins five radians a second about a fixed axis: its angle grows beyond half a turn and is exact
cat >spin.lua <<'END'
world { duration = 4, frame_rate = 10 }
local w = cylinder { name = "wheel", radius = 0.2, length = 0.1, mass = 1, angular_velocity = {0, 0, -5} }
sphere { radius = 0.1, mass = 1, position = {0, 3, 0}, velocity = {1, 0, 0} }
probe("phase", function() return math.sin(5 * time()) end, {unit = "1"})
probe("none", function() return 0/0 end)
END
exits 0 spin.lua -q
exits 0 plot spin.h5 wheel.rz -o a.svg
says script 'wheel.rz \[rad\]'
points | awk '{ d = $2 + 5 * $1; if (d * d > 1e-20) exit 1 } END { exit NR != 41 }' || fail "other angles: $(points | tail -n 2)"
exits 0 plot spin.h5 wheel.angle -o a.svg --force
points | awk '{ d = $2 - 5 * $1; if (d * d > 1e-20) exit 1 } END { exit NR != 41 }' || fail "other angles: $(points | tail -n 2)"
exits 0 plot spin.h5 wheel.yaw -o a.svg --force
points | awk 'NR == 6 { d = $2 + 2.5; if (d * d > 1e-20) exit 1 } NR == 11 { d = $2 + 5 - 6.283185307179586; if (d * d > 1e-20) exit 1 }' ||
	fail "other angles: $(points | sed -n 11p)"
exits 0 plot spin.h5 wheel.wz '#1.x' -o a.svg --force
exits 0 plot spin.h5 phase -o a.svg --force
points | awk '{ d = $2 - sin(5 * $1); if (d * d > 1e-20) exit 1 } END { exit NR != 41 }' || fail "another probe"
says script 'phase \[1\]'
exits 66 plot spin.h5 none -o b.svg
says err "has no values of 'none'"
PATH=$plain

sed 's/name = name, //' two.lua >unnamed.lua
exits 0 unnamed.lua -q -o unnamed.h5
exits 0 plot unnamed.h5 '#3.z'
says out '#3.z'
exits 64 plot unnamed.h5 '#4.z'
says err "no quantity '#4.z' .*JOINT.angle"

exits 64 plot run.h5
exits 64 plot run.h5 height
says err "no quantity 'height' \(wanted: energy, momentum, penetration, a probe"
exits 0 plot run.h5 penetration
exits 64 plot run.h5 penetratoin
says err "did you mean 'penetration'"
exits 64 plot run.h5 nobody.z
exits 64 plot run.h5 energy --against e
says err "no quantity 'e'"
exits 66 plot d/sweep.h5 nothing
says err "no numbers 'nothing' \(wanted: e, "
exits 66 plot nothing.h5 energy
exits 73 plot run.h5 energy -o z.svg
exits 0 plot run.h5 energy -o z.svg --force
exits 64 plot run.h5 energy -o z.pdf
