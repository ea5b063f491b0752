#!/bin/sh
# SPDX-License-Identifier: MIT
# Data on standard output, talk on standard error; a closed pipe or a full disk ends in an error, not in silence.
. tests/cli/functions

small_scene >s.lua
exits 0 s.lua --no-record --json
says_nothing err
[ "$(wc -l <out)" -eq 1 ] || fail "--json is not one line"
[ "$(value status)" = complete ] || fail "no status"
if command -v python3 >/dev/null; then
	for args in "s.lua --no-record --json" "check s.lua --json" "methods --json"; do
		# shellcheck disable=SC2086
		exits 0 $args
		python3 -m json.tool out >/dev/null || fail "rbsim $args: not JSON"
	done
fi

if [ -e /dev/full ]; then
	for args in "s.lua --no-record --json" "check s.lua" "methods" "--help"; do
		# shellcheck disable=SC2086
		"$RBSIM" $args >/dev/full 2>err
		[ $? -eq 74 ] || fail "rbsim $args >/dev/full: not 74"
		says err 'cannot write standard output'
	done
fi
for args in "s.lua --no-record --json" "methods"; do
	# the reader has gone when the program writes
	# shellcheck disable=SC2086
	{ sleep 0.3; "$RBSIM" $args 2>err; echo $? >status; } | true
	until_true [ -s status ]
	[ "$(cat status)" = 74 ] || fail "rbsim $args into a closed pipe: $(cat status)"
	says err 'Broken pipe'
	rm status
done
