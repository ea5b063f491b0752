#!/bin/sh
# SPDX-License-Identifier: MIT
# How far it is to a first result: from a clone to a film, to a plot in Python; which examples run; who opens a recording.
# RBSIM is the program; CLONE=0 leaves out the build of a clone, which takes some minutes.
set -eu
cd "$(dirname "$0")/../.."
top=$PWD
rbsim=$(realpath "${RBSIM:-build/release/rbsim}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

now() { date +%s.%N; }
# since START WHAT: prints seconds
since() { awk "BEGIN { printf \"%8.1f s  %s\\n\", $(now) - $1, \"$2\" }"; }

python=${RBSIM_PYTHON:-python3}
cat >"$work/plot.py" <<'END'
import sys, rbsim
with rbsim.run("scenes/bounce.lua") as run:
    t, z = run.time[:], run.position[:, 0, 2]
try:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    pyplot.plot(t, z)
    pyplot.savefig(sys.argv[1])
except ImportError:
    print("           (no matplotlib: arrays, not a picture)")
END

if [ "${CLONE:-1}" != 0 ]; then
	start=$(now)
	git clone --quiet "$top" "$work/clone"
	make -C "$work/clone" -j"$(nproc)" >"$work/log" 2>&1 || { tail "$work/log"; exit 1; }
	since "$start" "clone and build, $(nproc) processors"
	(cd "$work/clone" && build/release/rbsim scenes/bounce.lua --quiet >"$work/log" 2>&1) || tail -n 2 "$work/log"
	since "$start" "clone to the first film"
	rbsim=$work/clone/build/release/rbsim
else
	start=$(now)
fi
# a notebook with the same cell, run as Jupyter runs it; the time counts from the clone where there is one
if "$python" -c 'import nbconvert, ipykernel' 2>/dev/null; then
	sed 's/^import sys, rbsim$/import sys, rbsim; sys.argv = ["", "notebook.png"]/' "$work/plot.py" | "$python" -c '
import json, sys
json.dump({"nbformat": 4, "nbformat_minor": 5, "metadata": {}, "cells": [{"cell_type": "code", "id": "first", "metadata": {},
    "execution_count": None, "outputs": [], "source": sys.stdin.read().replace("scenes/", sys.argv[1] + "/scenes/")}]},
    open(sys.argv[2], "w"))' "$top" "$work/first.ipynb"
	PYTHONPATH=$top/tools/python RBSIM=$rbsim "$python" -m nbconvert --to notebook --execute --output ran.ipynb "$work/first.ipynb" \
		>"$work/log" 2>&1 || { tail -n 3 "$work/log"; exit 1; }
	since "$start" "to the first plot in a notebook (nbconvert --execute)"
else
	echo "           no nbconvert and ipykernel: no notebook"
fi
start=$(now)
PYTHONPATH=$top/tools/python RBSIM=$rbsim "$python" "$work/plot.py" "$work/plot.png" || echo "           no plot: numpy and h5py are needed"
since "$start" "from the program to the first plot in Python"

guide='README.md docs/README.md docs/analysis.md docs/tutorial.md'
# shellcheck disable=SC2086 # a list
blocks=$(cat $guide tools/python/README.md | grep -c '^```[a-z]')
blocks=$((blocks + $(find tools/python/examples -name '*.py' | wc -l)))
pages=$(cat man/*.[0-9] | awk '/^\.Sh (EXAMPLES|FIRST STEPS)/ { on = 1; next } /^\.Sh / { on = 0 } on && /^\.(Dl|Bd)/' | wc -l)
echo "$blocks examples in guide and Python package, all run: docs.sh, tutorial.sh, python.sh, manual-examples.sh"
echo "$pages examples in manuals, all run: options-manual.sh, embed.sh, manual-examples.sh"

"$rbsim" scenes/bounce.lua --no-render --quiet -o "$work/run.h5"
echo "readers of a recording here:"
"$python" tests/readers/check.py "$work/run.h5" | sed 's/^/  /' || true
