#!/bin/sh
# SPDX-License-Identifier: MIT
# Nets of ropes that are exactly taut between fixed bodies lock: they had no end when located, and `auto` stood at 0 s.
. tests/cli/functions

scene="$TOP/tests/scenes/taut_net.lua"

for n in 3 5; do
	for corners in 2 4; do
		exits 76 "$scene" --no-record --quiet --method located -p n=$n -p corners=$corners
		says err "lock and let go in turn"
	done
done
exits 76 "$scene" --no-record --quiet --method located -p n=3 -p corners=4 -p diagonal=1
says err "lock and let go in turn"
for n in 3 5; do
	exits 0 "$scene" --no-record --quiet --time-step 0.002 -p n=$n
done
# by one corner it does not lock
exits 0 "$scene" --no-record --quiet --method located -p n=4 -p corners=1
