#!/bin/sh
# SPDX-License-Identifier: MIT
# By steps, what lands on flush tiles moves as on one slab (tests/scenes/tiles.lua). The nearest point of a tile for itself was on its
# border where a body came down beside it, with a normal that the floor has nowhere.
# Not so yet: where a face lands nearly flat, in steps in which it turns by 0.05 rad and more, points at borders take part in impacts.
. tests/cli/functions

land()
{
	exits 0 "$TOP/tests/scenes/tiles.lua" --no-record --quiet "$@"
}

land -p shape=sphere -p step=1e-2
land -p shape=sphere -p step=1e-2 -p e=0
land -p shape=sphere -p step=5e-3 -p size=1e-3 -p floor=rectangles
land -p shape=box
land -p shape=box -p floor=union
land -p shape=hull -p floor=rectangles
land -p shape=capsule
land -p shape=capsule -p floor=union
