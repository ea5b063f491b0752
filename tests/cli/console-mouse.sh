#!/bin/sh
# SPDX-License-Identifier: MIT
# Wheel and clicks, in both ways in which terminals tell of them; sizes that change and stopping while it plays.
. tests/cli/functions
. "$TOP/tests/cli/terminal"

cat >s.lua <<'END'
world { title = "Drop", duration = 4, frame_rate = 50, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = 0.5 }
plane { normal = {0, 0, 1}, material = m }
sphere { name = "ball", radius = 0.5, position = {0, 0, 4}, material = m }
END
exits 0 s.lua
terminal 100 30

# event BUTTON COLUMN ROW [up]: one that the terminal tells of, at a cell, counted from 1; buttons 64 and 65 are the wheel, 32 is
# the left one as the pointer moves
event()
{
	if [ "$encoding" = digits ]; then
		types -l "$(printf '\033[<%d;%d;%d%s' "$1" "$2" "$3" "$([ "${4:-}" = up ] && echo m || echo M)")"
	else
		[ "${4:-}" = up ] && set -- 3 "$2" "$3"
		# shellcheck disable=SC2046 # words
		types -H $(printf '1b 5b 4d %x %x %x' $(($1 + 32)) $(($2 + 32)) $(($3 + 32)))
	fi
}
# mouse BUTTON COLUMN ROW: pressed and let go
mouse()
{
	event "$1" "$2" "$3"
	[ "$1" -ge 64 ] || event "$1" "$2" "$3" up
}
# drags COLUMN ROW COLUMN ROW: from one cell to the other with the left button held
drags()
{
	event 0 "$1" "$2"
	event 32 "$1" "$2"
	event 32 "$3" "$4"
	event 0 "$3" "$4" up
}
row_of_timeline()
{
	screen | grep -n '●' | tail -n 1 | cut -d : -f 1
}

for encoding in digits bytes; do
	# their entries in terminfo say which
	[ $encoding = digits ] && term=xterm-256color || term=tmux-256color
	enters "clear; TERM=$term $RBSIM console s.h5"
	sees 'playing'
	# on a busy machine it may be at its end by now, from where the space key would play again
	types : && enters pause
	sees '^ (paused|at the end)'
	types Home
	sees 'frame 0 of 200'
	row=$(row_of_timeline)
	[ -n "$row" ] || fail "there is no time line: $(screen)"
	mouse 65 10 "$row"
	sees 'frame 2 of 200'
	mouse 65 10 "$row"
	mouse 65 10 "$row"
	sees 'frame 6 of 200'
	mouse 64 10 "$row"
	sees 'frame 4 of 200'
	# over the picture it is the camera that goes nearer and farther away; the ball fills it in the end
	screen | sed -n 3,20p >far
	for _ in 1 2 3 4 5 6; do mouse 64 10 5; done
	nearer() { screen | sed -n 3,20p >near; ! cmp -s far near; }
	until_true nearer
	for _ in 1 2 3 4 5 6; do mouse 65 10 5; done
	as_before() { screen | sed -n 3,20p | cmp -s - far; }
	until_true as_before
	# a drag turns it, and back; with the button up nothing turns
	drags 20 6 31 10
	until_true nearer
	drags 31 10 20 6
	until_true as_before
	# from the time line it does not begin
	event 0 4 "$row"
	sees_not 'frame 4 of 200'
	event 32 20 6
	event 32 31 10
	event 0 31 10 up
	types Home . . . .
	sees 'frame 4 of 200'
	until_true as_before
	shows 'frame 4 of 200' || fail "the wheel over the picture has moved the time: $(screen)"
	mouse 0 100 "$row"
	sees 'frame 200 of 200'
	mouse 0 1 "$row"
	sees 'frame 0 of 200'
	mouse 0 51 "$row"
	sees 'frame (9[6-9]|10[0-4]) of 200'
	before=$(screen | sed -n 's/.* frame \([0-9]*\) of .*/\1/p' | head -n 1)
	# elsewhere a click is no seeking, nor is another button
	mouse 0 51 5
	mouse 2 1 "$row"
	types : && enters 'status'
	sees 'pictures drawn'
	shows "frame $before of 200" || fail "a click on the picture has moved the view: $(screen)"
	types q
	sees '^ready>'
	given_back
done

# while it plays
resize()
{
	tmux -L "$TERMINAL" resize-window -x "$1" -y "$2"
}
enters "clear; $RBSIM console s.h5 --speed 0.01"
sees '^ playing'
for size in '40 12' '39 12' '20 5' '40 11' '1 1' '120 40' '41 13' '200 60' '40 12'; do
	# shellcheck disable=SC2086 # two words
	resize $size
	sleep 0.1
done
sees '^ playing +t [0-3]\.'
sees '^ frame [0-9]+ of 200'
resize 100 30
sees '^ playing .* frame [0-9]+ of 200'
sees 'energy .J., overlap'
types C-z
sees '[Ss]topped'
given_back
enters 'clear; fg'
sees '^ playing .* frame [0-9]+ of 200'
types C-z
sees '[Ss]topped'
# stopped, and another size when it comes back
resize 60 20
enters 'clear; fg'
sees '^ playing +t [0-3]'
types q
sees '^ready>'
given_back
