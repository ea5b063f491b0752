#!/bin/sh
# SPDX-License-Identifier: MIT
# Three tiles are located to their end. At 0.219 s friction may hold a foot at every moment but over no while, so that it has
# to slip; at 0.229 s no direction of a slow slip is balanced, so that it has to turn. Pieces that ended at once had no end.
. tests/cli/functions

exits 0 "$TOP/scenes/dominoes.lua" --param count=3 --method located --no-record --no-render --json --quiet
[ "$(value stepped)" = 0 ] || fail "three tiles, located: stepped $(value stepped) s"
