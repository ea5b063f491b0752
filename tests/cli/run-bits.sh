#!/bin/sh
# SPDX-License-Identifier: MIT
# The same bits with 1, 2 and 3 threads, with and without a recording, twice in a row.
. tests/cli/functions

cat >s.lua <<'END'
world { duration = 1, gravity = {0, 0, -9.81}, seed = 5 }
local m = material { name = "m", restitution = 0.6, density = 1000, friction = 0.3 }
plane { normal = {0, 0, 1}, material = m }
for i = 0, 39 do
	sphere {
		radius = 0.1, material = m, position = {0.25 * (i % 8), 0.25 * (i // 8), 0.5 + 0.3 * math.random()},
		velocity = {math.random() - 0.5, math.random() - 0.5, 0},
	}
end
END
first=
for args in "--threads 1" "--threads 1" "--threads 2" "--threads 3" "--threads 1 --no-record" "--threads 3 --no-record"; do
	# shellcheck disable=SC2086
	exits 0 s.lua --json --force $args
	hash=$(value state_hash)
	[ ${#hash} -eq 16 ] || fail "no state hash"
	[ "${first:=$hash}" = "$hash" ] || fail "$args: $hash, but $first before"
done
exits 0 s.lua --json --no-record --seed 6
[ "$(value state_hash)" != "$first" ] || fail "the seed changes nothing"
