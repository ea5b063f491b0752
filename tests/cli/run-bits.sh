#!/bin/sh
# SPDX-License-Identifier: MIT
# The same bits with 1, 2 and 3 threads, with and without a recording, twice in a row, with each method; of located runs
# also with either rollback and with any time step.
. tests/cli/functions

cat >s.lua <<'END'
local loose = param("loose", false, "too few to be a heap")
world { duration = 1, gravity = {0, 0, -9.81}, seed = 5 }
local m = material { name = "m", restitution = 0.6, density = 1000, friction = 0.3 }
plane { normal = {0, 0, 1}, material = m }
for i = 0, loose and 5 or 39 do
	sphere {
		radius = 0.1, material = m, position = {0.25 * (i % 8), 0.25 * (i // 8), 0.5 + 0.3 * math.random()},
		velocity = {math.random() - 0.5, math.random() - 0.5, 0},
	}
end
END

# same ARGUMENTS VARIATION...: all variations of a run end in the same state
same()
{
	base=$1
	shift
	first=
	for args in "$@"; do
		# shellcheck disable=SC2086
		exits 0 s.lua --json --force $base $args
		hash=$(value state_hash)
		[ ${#hash} -eq 16 ] || fail "no state hash"
		[ "${first:=$hash}" = "$hash" ] || fail "$base $args: $hash, but $first before"
	done
}

for method in classic auto; do
	same "--method $method" "--threads 1" "--threads 1" "--threads 2" "--threads 3" "--threads 1 --no-record" \
		"--threads 3 --no-record"
	exits 0 s.lua --json --no-record --method $method --seed 6
	[ "$(value state_hash)" != "$first" ] || fail "$method: the seed changes nothing"
done
same "--method located --param loose=true --no-record" "--threads 1" "--threads 3" "--rollback global" \
	"--time-step 0.001" "--time-step 0.01"
# callbacks that do nothing
small_scene >plain.lua
for method in auto located stepped classic; do
	exits 0 plain.lua --json --no-record --method $method
	plain=$(value state_hash)
	for hook in on_frame on_step; do
		small_scene "$hook(function() end)" >hook.lua
		exits 0 hook.lua --json --no-record --method $method
		[ "$(value state_hash)" = "$plain" ] || fail "$method: an empty $hook changes the state's hash"
	done
done
