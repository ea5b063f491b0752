#!/bin/sh
# SPDX-License-Identifier: MIT
# Damaged recordings, checkpoints and sweeps, given to every verb that reads or writes them: all end, with a stated status
# (tests/damage/run.py). Time is only what tells an end from none.
. tests/cli/functions
command -v python3 >/dev/null || { echo "no python3"; exit 77; }

mkdir files
cd files || exit 1
small_scene 'local q = param("q", 1, "number")
probe("height of the ball", function() return energy() end, {unit = "m"})
result("impacts", collisions)
record { fields = {"+", "events", "contacts"} }' >whole.lua
exits 0 whole.lua -q
small_scene 'on_frame(function() local x = 0 for i = 1, 3e5 do x = x + i end end)' | sed 's/duration = 0.5/duration = 2/' >cut.lua
"$RBSIM" cut.lua -q -o cut.h5 --checkpoint-every 0.01 >out 2>err &
pid=$!
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
until_true [ -s 'cut.h5.checkpoint~' ]
kill -KILL $pid
wait $pid 2>/dev/null
pid=
exits 0 sweep whole.lua -q -p q=1,2 -o sweep
rm -f out err
cd ..
# a run that was killed has its partial files, which are not what is looked for
rm -f files/*partial*
unset RBSIM_CHECK_MEMORY
# HDF5 does not give back what it has of a file whose damage it finds
export ASAN_OPTIONS="${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0"
python3 "$TOP/tests/damage/run.py" --program "$RBSIM" --folder files --count "${CHANGES:-64}" --timeout 120
