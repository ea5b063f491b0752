#!/bin/sh
# SPDX-License-Identifier: MIT
# Recorded contact forces of located frames are those of that very moment: of a ball that rolls down a ball, by its closed
# form, and on a body that turns, by the motion; asking for them changes no bit.
. tests/cli/functions
python3 -c 'import h5py, numpy' 2>/dev/null && python=python3 || python=/usr/bin/python3
"$python" -c 'import h5py, numpy' 2>/dev/null || { echo 'h5py and numpy are needed'; exit 77; }

cat >roll.lua <<'END'
world { duration = 2, frame_rate = 60, gravity = {0, 0, -9.81} }
local m = material { friction = 0.9 }
sphere { radius = 5, static = true, material = m }
sphere { radius = 1, mass = 3, position = {0.6, 0.3, math.sqrt(36 - 0.45)}, material = m }
record { fields = {"position", "velocity", param("what", "contacts", "a column more")} }
END
exits 0 roll.lua --method located --json -o roll.h5
hash=$(value state_hash)
exits 0 roll.lua --method located --json -o other.h5 --param what=events
[ "$(value state_hash)" = "$hash" ] || fail 'contacts that are recorded change the motion'
"$python" - <<'END' || fail 'forces are not those of their frame'
import h5py, numpy as np
with h5py.File('roll.h5') as f:
    end = f['/rbsim/frames/contact_end'][:]
    x, v = (f[f'/particles/bodies/{name}/value'][:, 0] for name in ('position', 'velocity'))
    force = f['/rbsim/contacts/force'][:]
    first = f['/rbsim/contacts/a'][:]
    ball = f['/particles/bodies/id'][0]
m, g, seen = 3, 9.81, 0
for k in range(1, len(end)):
    if end[k] - end[k - 1] != 1:
        continue
    up = x[k] / np.linalg.norm(x[k])
    if up[2] < 0.7: # before it leaves, cos = 10/17, and before it slips
        continue
    seen += 1
    found = force[end[k - 1]] * (-1 if first[end[k - 1]] == ball else 1)
    normal = m * (g * up[2] - v[k] @ v[k] / 6)
    down = np.array([0, 0, -g]) + g * up[2] * up
    wanted = normal * up - m * down * 2 / 7
    assert np.abs(found - wanted).max() < 1e-9 * m * g, (k, found, wanted)
assert seen > 40, seen
END
