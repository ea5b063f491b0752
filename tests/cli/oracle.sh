#!/bin/sh
# SPDX-License-Identifier: MIT
# Recordings say what is so: tests/oracle computes gaps, contacts, impacts, energy and momentum anew, without the program.
# That it would notice if they did not is tested with recordings that have one thing spoiled.
. tests/cli/functions
case ${RBSIM_MODE:-release} in
release | debug) ;;
*) echo "numbers are the same under sanitizers"; exit 77 ;;
esac

oracle=$TOP/tests/oracle
python=
find_python || { echo "no Python with h5py and numpy (RBSIM_PYTHON can name one)"; exit 77; }
# compiled files would land in the tree, and more threads than one for small matrices only wait
export PYTHONDONTWRITEBYTECODE=1 OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

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
"$python" "$oracle/scenes.py" --program "$RBSIM" --frames 2 --share steps arch dominoes heap marble_run >out ||
	fail "forces and impulses of steps are not what changes momentum"
# bodies that turning raises, spheres that pass impacts on, steps that were halved, a body wedged between floor and wall;
# what stands in halves of a step on fewer points of a face than in a whole one, bodies of which one takes parts of it,
# motion that pays for lifting, what scripts change
for first in 205 212 229 271 252,1.15 389 269 232; do
	"$python" "$oracle/scenes.py" --program "$RBSIM" --frames 2 --share random --first ${first%,*} --count 1 --one-step \
		--given "--method stepped --duration $(case $first in *,*) echo ${first#*,} ;; *) echo 1 ;; esac)" >>out ||
		fail "forces and impulses of random scene $first do not add up"
done
# steps that are halved for all: forces are means over the whole step
"$python" "$oracle/scenes.py" --program "$RBSIM" --frames 2 --share random --first 229 --count 1 --one-step \
	--given "--method stepped --rollback global --duration 1" >global
says global random-229
if grep -q 'FAIL.*steps, momentum' global; then fail "forces of steps that are halved for all do not add up"; fi
