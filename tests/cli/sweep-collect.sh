#!/bin/sh
# SPDX-License-Identifier: MIT
# rbsim collect: one file of virtual datasets over all runs, with tables, that opens from another folder; and a table.
. tests/cli/functions

cat >s.lua <<'END'
local e = param("e", 0.5, "restitution")
local n = param("n", 2, "balls")
local name = param("name", "a", "any")
world { duration = 0.1 * n, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = e, density = 1000 }
plane { normal = {0, 0, 1}, material = m }
for i = 1, n do sphere { radius = 0.1, position = {i, 0, 0.2}, velocity = {e, 0, 0}, material = m } end
expect("e/2 is small", function() return e, 0.6 end)
END
mkdir deep deep/er
exits 1 sweep s.lua -p e=0.5,0.7 -p n=1,2 -p name=x,'y "z"' -o deep/d
rm deep/d/point-00001.json deep/d/point-00001.h5 # missing

exits 0 collect deep/d --csv
[ "$(wc -l <out)" -eq 9 ] || fail "$(wc -l <out) lines, wanted 9"
says out '^index,seed,state,exit_status,state_hash,e,n,name,frames,.*e/2 is small: ok'
says out '^0,[0-9]+,done,0,[0-9a-f]{16},0.5,1,x,7,'
says out '^1,[0-9]+,unfinished,,,0.5,1,"y ""z""",,,,'
says out '^4,[0-9]+,failed,1,[0-9a-f]{16},0.7,1,x,7,.*,0,0.7,0.6$'
cp out table
exits 0 collect deep/d --csv -o -
cmp -s table out || fail "'-o -' prints another table"
exits 64 collect deep/d -o -
says err "wants '--csv'"
exits 64 collect deep/d --csv --json -o -
exits 0 collect deep/d -o table.csv
cmp -s table table.csv || fail "the table is another one in a file"
exits 0 collect deep/d -o deep/er/all.h5
says out 'all.h5: 8 points, 3 done, 7 recordings'
exits 73 collect deep/d -o deep/er/all.h5
says err "it exists"
exits 0 collect deep/d --json
[ "$(value recordings)" = 7 ] || fail "JSON: $(cat out)"
[ -f deep/d/sweep.h5 ] || fail "no deep/d/sweep.h5"
exits 66 collect deep/er
exits 73 collect deep/d -o nowhere/x.h5

# recordings of positions alone are as good as others
sed '/^world/i record { fields = {"position"} }' s.lua >bare.lua
exits 0 sweep bare.lua -p n=1,2 -o bare
exits 0 collect bare
says out 'sweep.h5: 2 points, 2 done, 2 recordings'

# the table is no recording, and says what it is to who takes it for one
exits 66 info bare/sweep.h5
says err "'bare/sweep.h5' is the table of a sweep, not a recording: .*rbsim plot"

/usr/bin/python3 -c 'import h5py' 2>/dev/null || { echo "no h5py"; exit 77; }
mv deep moved
cat >look.py <<'END'
import sys
import h5py
import numpy
top = sys.argv[1]
for name in ("/er/all.h5", "/d/sweep.h5"):
    f = h5py.File(top + name, "r")
    assert list(f["/parameters/e"]) == [0.5] * 4 + [0.7] * 4
    assert f["/parameters/name"].asstr()[1] == 'y "z"', f["/parameters/name"][1]
    assert f["/points/state"].asstr()[1] == "unfinished" and f["/points/state"].asstr()[7] == "failed"
    assert numpy.isnan(f["/points/exit_status"][1]) and f["/points/exit_status"][4] == 1
    assert list(f["/expectations/e%2F2 is small: ok"][4:]) == [0] * 4
    assert f["/particles/bodies/position"].shape == (8, 13, 2, 3)
    for k in range(8):
        if k == 1:
            assert numpy.isnan(f["/particles/bodies/position"][k]).all() and numpy.isnan(f["/end/position"][k]).all()
            continue
        run = h5py.File(top + "/d/point-%05d.h5" % k, "r")
        frames, bodies, _ = run["/particles/bodies/position/value"].shape
        assert frames == f["/results/frames"][k]
        for what in ("position", "velocity"):
            value = run["/particles/bodies/" + what + "/value"][:]
            assert (f["/particles/bodies/" + what][k, :frames, :bodies] == value).all(), (k, what)
            assert (f["/end/" + what][k, :bodies] == value[-1]).all(), (k, what)
            assert numpy.isnan(f["/particles/bodies/" + what][k, frames:]).all()
            assert numpy.isnan(f["/end/" + what][k, bodies:]).all()
        assert (f["/time"][k, :frames] == run["/observables/kinetic_energy/time"][:]).all()
        assert (f["/observables/momentum"][k, :frames] == run["/observables/momentum/value"][:]).all()
    f.close()
END
top=$PWD/moved
cd / && /usr/bin/python3 "$TMPDIR/look.py" "$top" >"$TMPDIR/err" 2>&1 || { cd "$TMPDIR" || exit 1; fail "h5py reads something else"; }
