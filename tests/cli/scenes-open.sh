#!/bin/sh
# SPDX-License-Identifier: MIT
# Each shipped scene opens with six lines: what happens, what to watch, how it should end, a fact, what to try, how long it takes.
. tests/cli/functions

count=0
for scene in "$TOP"/scenes/*.lua "$TOP"/scenes/examples/*.lua; do
	awk '
	NR == 1 { ok = /^-- [A-Z0-9].*\.$/ }
	NR == 2 { ok = ok && /^-- Watch: ./ }
	NR == 3 { ok = ok && /^-- Expected end: ./ }
	NR == 4 { ok = ok && /^-- ./ && !/^-- (Watch|Expected end|Try):/ }
	NR == 5 { ok = ok && /^-- Try: ./ }
	NR == 6 { ok = ok && /^-- Takes: ./ }
	NR == 7 { ok = ok && !/^--/ }
	length > 140 && NR <= 6 { ok = 0 }
	END { exit !(ok && NR >= 7) }' "$scene" || fail "$(basename "$scene"): does not open with the six lines"
	count=$((count + 1))
done
[ "$count" -ge 12 ] || fail "only $count scenes"
