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

# mouse BUTTON COLUMN ROW: pressed and let go at a cell, counted from 1; buttons 64 and 65 are the wheel
mouse()
{
	if [ "$encoding" = digits ]; then
		types -l "$(printf '\033[<%d;%d;%dM' "$1" "$2" "$3")"
		[ "$1" -ge 64 ] || types -l "$(printf '\033[<%d;%d;%dm' "$1" "$2" "$3")"
	else
		# shellcheck disable=SC2046 # words
		types -H $(printf '1b 5b 4d %x %x %x' $(($1 + 32)) $(($2 + 32)) $(($3 + 32)))
		# shellcheck disable=SC2046
		[ "$1" -ge 64 ] || types -H $(printf '1b 5b 4d 23 %x %x' $(($2 + 32)) $(($3 + 32)))
	fi
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
	mouse 65 10 5
	sees 'frame 2 of 200'
	mouse 65 10 5
	mouse 65 10 5
	sees 'frame 6 of 200'
	mouse 64 10 5
	sees 'frame 4 of 200'
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
