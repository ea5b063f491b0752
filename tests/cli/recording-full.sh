#!/bin/sh
# SPDX-License-Identifier: MIT
# A file size limit in mid-run: exit 74, a text that names file and cause, and all before it readable.
set -eu
cd "$TMPDIR"
cat >long.lua <<'END'
world { duration = 40, frame_rate = 1000, time_step = 1e-3 }
for i = 0, 49 do
	sphere { radius = 0.1, position = {0, 0, i}, velocity = {0, i, 0} }
end
END
status=0
(ulimit -f 40000; exec "$RBSIM" long.lua -o run.h5 --quiet) 2>err || status=$?
cat err
[ $status -eq 74 ]
grep -q "cannot write 'run.h5': File too large" err
"$RBSIM" info run.h5 >info
cat info
grep -q 'status *failed' info
[ "$("$RBSIM" info --json run.h5 | sed -n 's/.*"frames": *\([0-9]*\).*/\1/p' | head -n 1)" -gt 1000 ]
[ -z "$(find . -name "*partial*")" ]

# what exists stays as it is without --force, and with it until there is something in its place
echo old >there.h5
status=0
"$RBSIM" long.lua --duration 0.1 -o there.h5 2>err || status=$?
[ $status -eq 73 ]
grep -q "cannot create 'there.h5': it exists (--force replaces it" err
[ "$(cat there.h5)" = old ]
"$RBSIM" long.lua --duration 0.1 -o there.h5 --force --quiet
"$RBSIM" info there.h5 | grep -q complete
status=0
"$RBSIM" long.lua --duration 0.1 -o no/such/folder.h5 2>err || status=$?
[ $status -eq 73 ]
grep -q "cannot create 'no/such/folder.h5': No such file or directory" err
