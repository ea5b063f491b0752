#!/bin/sh
# SPDX-License-Identifier: MIT
# Recordings say what is so: tests/oracle computes gaps, contacts, impacts, energy and momentum anew, without the program.
# That it would notice if they did not is tested with recordings that have one thing spoiled.
. tests/cli/functions
find_oracle

"$python" "$oracle/test_gaps.py" || fail "gaps of the oracle are not those of closed forms"
exits 0 "$oracle/bodies.lua" -o bodies.h5 --quiet
"$python" "$oracle/oracle.py" --all bodies.h5 >out || fail "inertias are not those of the shapes"
for check in inertias 'centres of mass'; do
	says out "ok +$check: .* 0 of 6 beyond"
done
for column in inertia center_of_mass; do
	"$python" - $column <<'END'
import h5py, sys
column = h5py.File("bodies.h5", "a")["particles/bodies/" + sys.argv[1]]
column[5] = column[5] * (1 + 1e-6)
END
done
"$python" "$oracle/oracle.py" bodies.h5 >out && fail "the oracle misses another inertia and centre of mass"
says out 'FAILED: centres of mass, inertias'
exits 0 "$oracle/wall.lua" -o located.h5 --quiet
exits 0 "$oracle/wall.lua" --method stepped -o stepped.h5 --quiet
exits 0 "$oracle/wall.lua" --method stepped --time-step 0.016666666666666666 --duration 2 -o steps.h5 --quiet
"$python" "$oracle/spoil.py" located.h5 stepped.h5 steps.h5 >out || fail "the oracle misses what is spoiled"
"$python" "$oracle/scenes.py" --program "$RBSIM" --frames 8 >out || fail "recordings and oracle disagree"
