#!/bin/sh
# SPDX-License-Identifier: MIT
# tests/scenes/stress.lua with a few draws and the default method: runs end, stay finite and within the tolerance. Where
# all of it is located, either rollback gives the same bits.
. tests/cli/functions

run()
{
	timeout 100 "$RBSIM" "$TOP/tests/scenes/stress.lua" --no-record --json --quiet "$@" >out 2>err </dev/null
	got=$?
	[ $got -ne 124 ] || fail "rbsim stress.lua $*: no end within 100 s"
	[ $got -eq 0 ] || fail "rbsim stress.lua $*: exit status $got"
}

# DRAW COUNT
for draw in "1 1" "2 2" "4 1" "1 5" "2 5" "6 5"; do
	# shellcheck disable=SC2086
	set -- $draw
	run --method located --rollback selective --param k="$1" --param count="$2"
	hash=$(value state_hash)
	[ ${#hash} -eq 16 ] || fail "no state hash"
	run --method located --rollback global --param k="$1" --param count="$2"
	[ "$(value state_hash)" = "$hash" ] || fail "k = $1: rollback global ends in another state than selective"
done
for k in 1 2 3 5 9; do
	run --param k=$k
done

# a pile that is located to its end: no contact is left to drift into another, however many things happen at one moment
cat >pile.lua <<'LUA'
world { duration = 0.6, gravity = {0, 0, -9.81}, frame_rate = 60, method = "located" }
local m = material { name = "m", density = 1000, friction = 0.5, restitution = 0.1 }
plane { normal = {0, 0, 1}, material = m }
for i = 0, 39 do
	sphere { radius = 0.05, material = m,
		position = {0.102 * (i % 3) + 0.0001 * i, 0.102 * (i // 3 % 3), 0.06 + 0.11 * (i // 9)} }
end
LUA
exits 0 pile.lua --no-record --json --quiet
deepest=$(value max_penetration)
awk -v d="$deepest" 'BEGIN { exit !(d < 1e-14) }' || fail "bodies of a pile overlap by $deepest m"
