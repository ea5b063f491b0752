#!/bin/sh
# SPDX-License-Identifier: MIT
# A small run makes a small file: what only growing needs is gone from a recording that is complete, and nothing else is.
. tests/cli/functions

cat >one.lua <<'END'
world { duration = 1/6, gravity = {0, 0, -9.81} }
plane { material = material { restitution = 0.5 } }
sphere { radius = 0.1, position = {0, 0, 0.15} }
END
exits 0 one.lua --quiet
size=$(stat -c %s one.h5)
[ "$size" -le 40000 ] || fail "11 frames of one sphere take $size bytes, wanted 40000 at most"
exits 0 info one.h5
says out '11 frames of 1 moving body'
h5ls -r one.h5 >list
for same in '/observables/momentum/step +Dataset, same as' '/particles/bodies/velocity/time +Dataset, same as' \
	'/VTKHDF/Points +Dataset \{11, 3\}'; do
	says list "$same"
done
h5dump -a /particles/bodies/position/value/units one.h5 | grep -q '"m"' || fail "a column has lost its unit"
h5dump -d /VTKHDF/Points one.h5 | grep -q '(10,0)' || fail "the positions that VTK reads are not there"
for left in *partial*; do
	[ ! -e "$left" ] || fail "$left is left over"
done

# tables without rows
sed 's/0.15}/9}/' one.lua >high.lua
echo 'record { fields = {"+", "events", "contacts"} }' >>high.lua
exits 0 high.lua --quiet
[ "$(stat -c %s high.h5)" -le 44000 ] || fail "empty tables take $(($(stat -c %s high.h5) - size)) bytes"
h5ls high.h5/rbsim/events >list
says list 'time +Dataset \{0\}'

# one that was stopped stays as it is, to go on; what it is in the end is the same
sed 's/1\/6/4/' one.lua >long.lua
exits 0 long.lua -o whole.h5 --quiet
printf 'at 2 checkpoint\nat 2 quit\n' >commands
"$RBSIM" long.lua -o half.h5 --commands commands --quiet >out 2>err
"$RBSIM" long.lua -o half.h5 --resume --quiet >out 2>err || fail "the run does not go on: $(cat err)"
exits 0 diff whole.h5 half.h5
