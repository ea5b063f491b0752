#!/bin/sh
# SPDX-License-Identifier: MIT
# What slides or rolls over flush bodies goes on as over one, located to rounding; a step up by a thousandth of the size stops what
# slides.
. tests/cli/functions

over()
{
	exits 0 "$TOP/tests/scenes/seams.lua" --no-record --quiet "$@"
}

over
over -p turn=0.7 -p handed=-1 -p way=-0.5
over -p size=1e-3 -p way=0
over -p size=1e3 -p turn=1.3
over -p floor=union -p way=0
over -p floor=rectangles -p way=0.2
over -p floor=driven
over -p gap=1e-9 -p way=0
over -p gap=1e-3
over -p step=1e-9
over -p step=1e-3
over -p step=1e-3 -p turn=0.7 -p way=0

for floor in boxes union rectangles driven; do
	over -p floor=$floor --method located -p bound=1e-12
done
over --method located -p bound=1e-12 -p turn=0.7 -p handed=-1 -p way=-0.5
over --method located -p bound=1e-12 -p size=1e-3 -p way=0
over --method located -p bound=1e-12 -p turn=1.0 -p handed=-1
over --method located -p bound=1e-12 -p turn=1.4
over --method located -p step=1e-3
over --method auto -p bound=1e-6
