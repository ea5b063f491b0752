#!/bin/sh
# SPDX-License-Identifier: MIT
# tests/scenes/stress.lua with a few draws and the default method: runs end, stay finite and within the tolerance. Where
# all of it is located, either rollback gives the same bits.
. tests/cli/functions

run()
{
	timeout 20 "$RBSIM" "$TOP/tests/scenes/stress.lua" --no-record --json --quiet "$@" >out 2>err </dev/null
	got=$?
	[ $got -ne 124 ] || fail "rbsim stress.lua $*: no end within 20 s"
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
