#!/bin/sh
# SPDX-License-Identifier: MIT
# The oracle over all scenes and cases of verify, as far as a run comes in a minute, and over scenes in steps of a
# frame, and over random scenes.
. tests/cli/functions

python=
find_python || { echo "no Python with h5py and numpy (RBSIM_PYTHON can name one)"; exit 77; }
export PYTHONDONTWRITEBYTECODE=1 OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

failed=0
look()
{
	echo "== $*"
	"$python" "$TOP/tests/oracle/scenes.py" --program "$RBSIM" --frames 100 --share "$@" || failed=1
}
look scenes
look verify
look steps
look random --count 200
look random --count 100 --given "--method stepped"
[ $failed -eq 0 ] || fail "recordings and oracle disagree"
