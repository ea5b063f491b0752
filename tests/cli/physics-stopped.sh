#!/bin/sh
# SPDX-License-Identifier: MIT
# Without weight, what an impact stops is not struck again by what rounding has left of its velocity.
. tests/cli/functions

for shape in box sphere cylinder hull balls; do
	for draw in $(tried 1 2 3 4 5 6); do
		for mu in 0 0.5; do
			exits 0 "$TOP/tests/scenes/stopped.lua" --method located --param shape=$shape --param draw="$draw" --param mu=$mu \
				--no-record --json --quiet
			[ "$(value collisions)" = 1 ] || fail "$shape, draw $draw, friction $mu: struck $(value collisions) times"
		done
	done
done
