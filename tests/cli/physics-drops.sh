#!/bin/sh
# SPDX-License-Identifier: MIT
# tests/scenes/drop.lua: single bodies of every shape on planes that are shaken or turn, by events: no touch is missed.
. tests/cli/functions

# planes that turn, and planes that are shaken beneath bodies that rock
for draw in 40 52 64 79 118 197 244; do
	timeout "$PATIENCE" "$RBSIM" "$TOP/tests/scenes/drop.lua" --param k=$draw --method located --no-record --json --quiet \
		>out 2>err </dev/null || fail "draw $draw: exit status $?"
done
