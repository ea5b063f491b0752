#!/bin/sh
# SPDX-License-Identifier: MIT
# Whatever ends a console, the terminal is as it was; and so ends a run of its own, but for one that was told to stay.
. tests/cli/functions
. "$TOP/tests/cli/terminal"

small_scene >s.lua
exits 0 s.lua
long_scene >long.lua
terminal 100 30
# Its own name: other consoles may be there, and other runs of this test.
own=./rbsim-$$
cp "$RBSIM" $own
cp "$(dirname "$RBSIM")"/*.so .
number()
{
	pgrep -o -f "^\.${own#.} $1"
}
nobody_left()
{
	[ -z "$(number console)" ]
}
# killed SIGNAL: the console with it. After SIGKILL the shell may have said so on the screen that is then taken away.
killed()
{
	kill -s "$1" "$(number console)"
	[ "$1" = KILL ] || sees 'ended with [1-9]'
	until_true nobody_left
	given_back
}
for signal in TERM HUP INT SEGV ABRT BUS QUIT; do
	enters 'clear'
	enters "$own console s.h5; echo ended with \$?"
	sees 'frame [0-9]+ of 30'
	kill -s $signal "$(number console)"
	# a shell drops the rest of a line that SIGINT has ended
	case $signal in
	INT) sees '^ready> *$' ;;
	*) sees 'ended with [1-9]' ;;
	esac
	# its guard ends a moment later, and would be taken for the next one
	until_true nobody_left
	given_back
done

# in the middle of playing, typed; and while a line is being typed
enters 'clear'
enters "$own console s.h5 --speed 0.01; echo ended with \$?"
sees 'playing'
types C-c
sees '^ready> *$'
given_back

# a run of its own ends with it, whatever ends that
for signal in TERM SEGV KILL; do
	enters 'clear'
	enters "$own console long.lua --no-record; echo ended with \$?"
	sees 'playing.*playing$'
	run=$(number run)
	[ -n "$run" ] || fail "there is no run"
	killed $signal
	gone()
	{
		! kill -0 "$run" 2>/dev/null
	}
	until_true gone
done

# in mid-frame: all of a large screen changes with each picture
cat >turn.lua <<'END'
world { duration = 100, frame_rate = 30 }
plane { normal = {0, 0, 1}, texture = "checker" }
sphere { radius = 1, position = {0, 0, 1} }
camera { position = function(t) return {8 * math.cos(3 * t), 8 * math.sin(3 * t), 4} end, look_at = {0, 0, 1} }
END
exits 0 turn.lua --no-render
tmux -L "$TERMINAL" resize-window -x 200 -y 60
for end in KILL:0.02 TERM:0.05 SEGV:0.01 KILL:0.03 TERM:0.04 SEGV:0.07; do
	enters 'clear'
	enters "$own console turn.h5; echo ended with \$?"
	sees 'playing.*frame [1-9][0-9]* of'
	sleep "${end#*:}"
	killed "${end%:*}"
done
# killed while it is stopped: the terminal is the shell's
enters 'clear'
enters "$own console turn.h5"
sees 'playing.*frame [1-9][0-9]* of'
types C-z
sees '[Ss]topped'
kill -s KILL "$(number console)"
until_true nobody_left
given_back
tmux -L "$TERMINAL" resize-window -x 100 -y 30

# quit ends it too, and the recording is whole
enters 'clear'
enters "$own console long.lua -o q.h5; echo ended with \$?"
sees 'playing.*playing$'
types q
sees "'q.h5' holds it up to there"
sees 'ended with 0'
exits 0 info q.h5
says out 'interrupted'

# one that is to stay stays, and can be attached to; nobody slows it down any more
enters 'clear'
enters "$own console long.lua --no-record --detach; echo ended with \$?"
sees 'playing.*playing$'
types q
sees 'the run goes on: rbsim attach /'
address=$(tmux -L "$TERMINAL" capture-pane -p -J | sed -n 's/.*rbsim attach //p' | tr -d ' ')
run=$(number run)
[ -n "$run" ] || fail "the run has ended"
enters 'clear'
enters "$own attach $address"
sees 'newest frames'
types q
sees '^ready> *$'
kill -0 "$run" || fail "leaving an attached run has ended it"
exits 0 ctl "$address" quit
until_true gone
given_back

# a recording that is not of the run, as an older one under its name, is not taken for what a killed run has left
exits 0 s.lua -o older.h5
"$RBSIM" long.lua -o a.h5 --listen sock -q &
run=$!
until_true test -f a.h5
mv older.h5 a.h5
enters 'clear'
enters "$own attach sock"
sees 'newest frames'
kill -s KILL "$run"
sees 'the run has ended'
sees 'sock: ended'
sees 'frame [0-9]+ of 6000000'
shows 'sock: complete' && fail "an older recording is shown"
types q
sees '^ready> *$'
given_back
