#!/bin/sh
# SPDX-License-Identifier: MIT
# The cameras of every shipped scene see something: a picture of its first frame is not of one colour.
. tests/cli/functions

for scene in "$TOP"/scenes/*.lua; do
	name=$(basename "$scene" .lua)
	# expectations are of the whole run
	"$RBSIM" "$scene" -q --no-render --duration 0.05 -o "$name.h5" >out 2>err </dev/null
	[ -s "$name.h5" ] || fail "$name: no recording"
	exits 0 render "$name.h5" --frame 0 -o "$name.png" --size 192x108
	[ "$(wc -c <"$name.png")" -gt 1500 ] || fail "$name: a picture of $(wc -c <"$name.png") bytes"
done
