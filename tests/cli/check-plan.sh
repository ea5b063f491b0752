#!/bin/sh
# SPDX-License-Identifier: MIT
# check prints what runs, what is left out and why, and touches nothing.
. tests/cli/functions

small_scene >s.lua
exits 0 check s.lua
says out 'bodies +2 moving, 1 static'
says out '0.5 s in 31 frames at 60 per second, 120 steps'
says out 'touching +gaps within 8 ulp'
says out 'rubber on rubber: friction 0.4, restitution 0.5'
says out '^ *\+ gravity'
says out '^ *- gravity_force '
says out '^ *\+ contact'
says out 'memory +[0-9.]+ MB .tried as far as frame 31 of 31'
says out 'disk +s.h5: '
says_nothing err
[ ! -e s.h5 ] || fail "check has made a recording"
exits 0 check s.lua --json
[ "$(value bodies)" = 2 ] || fail "bodies: $(value bodies)"
says out '"gravity":true'
says out '"gyroscopic":false'
exits 0 check s.lua --no-record
says out 'nothing is recorded'
exits 0 check s.lua -q
says_nothing out

cat >drift.lua <<'END'
world { duration = 0.51 }
sphere { radius = 1, position = {0, 0, 0}, velocity = {1, 0, 0} }
END
exits 0 check drift.lua
says out '32 frames'
says out '^ *- contact'
says out '^ *- gravity '

# a recording that stands in the way is told, and left alone
echo precious >drift.h5
exits 0 check drift.lua
says out "but +cannot create 'drift.h5'"
[ "$(cat drift.h5)" = precious ] || fail "check has touched a file"
