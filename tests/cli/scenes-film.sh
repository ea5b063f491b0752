#!/bin/sh
# SPDX-License-Identifier: MIT
# The cameras of every shipped scene see something: a picture of its first frame is not of one colour. What is wrong with memory or
# threads is not so with one scene alone: builds that are slow try some.
. tests/cli/functions

every=1 count=0
[ "${RBSIM_MODE:-release}" = release ] || every=6
for scene in "$TOP"/scenes/*.lua "$TOP"/scenes/examples/*.lua; do
	count=$((count + 1))
	[ $((count % every)) -eq 0 ] || continue
	name=$(basename "$scene" .lua)
	# expectations are of the whole run
	"$RBSIM" "$scene" -q --no-render --duration 0.05 -o "$name.h5" >out 2>err </dev/null
	[ -s "$name.h5" ] || fail "$name: no recording"
	cameras=$(sed -n 's/^camera *{ name = "\([a-z]*\)".*/\1/p' "$scene")
	[ -n "$cameras" ] || fail "$name: no camera"
	for camera in $cameras; do
		exits 0 render "$name.h5" --camera "$camera" --frame 0 -o "$name-$camera.png" --size 192x108
		size=$(wc -c <"$name-$camera.png")
		[ "$size" -gt 1000 ] || fail "$name: camera '$camera': a picture of $size bytes"
	done
done
