#!/bin/sh
# SPDX-License-Identifier: MIT
# The console over runs: of its own, attached, beginning anew, slower than wished; and over a recording that grows.
. tests/cli/functions
. "$TOP/tests/cli/terminal"

# $1 of work in each frame: how fast it goes can be chosen
cat >s.lua <<'END'
local work = param("work", 0, "turns in each frame")
local height = param("height", 3, "m")
world { title = "Work", duration = 60, frame_rate = 50, gravity = {0, 0, -9.81} }
plane { normal = {0, 0, 1} }
sphere { name = "ball", radius = 0.5, position = {0, 0, height} }
on_frame(function() local s = 0 for i = 1, work do s = s + i end end)
END
terminal 110 34

# one that is over before it can be watched, and one that has ended is started again
# an older recording stands under its name until it has a frame of its own, and is not shown as its own
exits 0 s.lua --duration 0.2 --param height=9
enters "$RBSIM console --duration 0.2 --force -- s.lua"
sees 'at the end .*frame 10 of 10'
types Home : && enters 'body ball'
sees 'position +0 +0 +3 m'
# with another value, which holds for every run from then on
types : && enters 'set hight 7'
sees "has no parameter 'hight'"
types : && enters 'set height 7'
sees 'height=7 from the next restart on'
for said in height=7 position; do
	types R
	# the screen is another one then: what was said is gone
	sees_not "$said"
	sees 'frame 10 of 10'
	types Home : && enters 'body ball'
	sees 'position +0 +0 +7 m'
done
types q
sees '^ready>'
# one that is killed says so
enters "clear; $RBSIM console s.lua --force --duration 1e6 -p work=100000"
sees 'frame [0-9]+ of 50000000'
is_recorded()
{
	"$RBSIM" info s.h5 2>/dev/null | grep -Eq '^  status +running'
}
until_true is_recorded # before that the older one has the name
kill -s KILL "$(pgrep -f "run --listen .* s.lua --force --duration 1e6")"
sees 'it was killed: by somebody, or for lack of memory'
sees ': unfinished'
types : && enters 'status'
sees '^unfinished, '
types q
sees '^ready>'
enters "clear; $RBSIM console s.h5"
sees 's.h5: unfinished'
types q
sees '^ready>'
# one that replaces it shows its own frames, though the old one says that it is being written
enters "clear; $RBSIM console s.lua --force --duration 0.2 --param height=5"
sees 'at the end .*frame 10 of 10'
types Home : && enters 'body ball'
sees 'position +0 +0 +5 m'
types q
sees '^ready>'
enters "clear; $RBSIM console s.lua"
sees "s.h5.*exists"
enters "clear; $RBSIM console none.lua; echo status \$?"
sees 'status 66'
enters "clear; $RBSIM console s.h5 --param work=1; echo status \$?"
sees 'is for a run'
sees 'status 64'

# work that takes this machine ten times as long as the 20 ms that a frame has: it may be busy now, and idle later
begun=$(date +%s%N)
exits 0 s.lua --duration 0.4 --no-record --param work=1000000
work=$(awk "BEGIN { printf \"%d\", 1e6 * 0.2 / (($(date +%s%N) - $begun) * 1e-9 / 20) }")
# slower than true time: it is told, and pause, step and back mean the run
enters "clear; $RBSIM console s.lua --force --param work=$work"
sees 'the simulation cannot keep up'
frame()
{
	screen | sed -n 's/.* frame \([0-9]*\) of .*/\1/p' | head -n 1
}
# so far that there is something to go back to
has_begun()
{
	now=$(frame)
	[ "${now:-0}" -ge 2 ]
}
until_true has_begun
types Space
sees '^ paused .*: paus'
before=
# a frame may be under way yet
stands_still()
{
	last=$before
	sleep 2
	before=$(frame)
	[ -n "$last" ] && [ "$last" = "$before" ]
}
until_true stands_still
types .
sees "frame $((before + 1)) of"
types , ,
sees "frame $((before - 1)) of"
types Space
goes_on()
{
	now=$(frame)
	[ "${now:-0}" -gt $((before + 3)) ]
}
until_true goes_on
# other values, from the restart on
types Space
types : && enters 'set work 0'
types : && enters 'set height 7'
# the run is still to hear of it, and what is typed until then is for the screen that goes
types : && enters 'body ball'
sees 'position +0 +0 '
types R
sees_not 'position'
sees 'frame [0-9]+ of 3000'
types Home : && enters 'body ball'
sees 'position +0 +0 +7 m'
types q
sees '^ready>'
given_back

# attached: two consoles, one player; one's own view
"$RBSIM" s.lua --listen run.sock --force --param work=300000 --duration 1200 -q >/dev/null 2>&1 &
run=$!
until_true test -S run.sock
enters "clear; $RBSIM attach run.sock"
sees '^ live .*newest frames'
exits 0 ctl run.sock pause
sees '^ paused .*: paused'
here=$(frame)
exits 0 ctl run.sock step 2
sees "frame $((here + 2)) of"
types Space
sees '^ live'
types V
sees '^ view paused'
exits 0 ctl run.sock status
says out 'state playing'
types : && enters 'view play'
sees '^ live'
types Home
sees '^ playing .*t 0\.'
types End
sees '^ live'
types q
sees '^ready>'
given_back
kill -0 $run || fail "leaving has ended the run"

# the recording that grows meanwhile, without the socket
enters "clear; $RBSIM console s.h5"
sees 'growing'
types End
sees '^ live'
here=$(frame)
more()
{
	now=$(frame)
	[ "${now:-0}" -gt "$here" ]
}
until_true more
types Home
sees '^ playing .*t 0\.'
types q
sees '^ready>'

# a run that ends while it is watched leaves its recording
enters "clear; $RBSIM attach run.sock"
sees '^ live'
exits 0 ctl run.sock quit
sees 'the run has ended'
sees '^ at the end '
types Home
sees 't 0\.'
types q
sees '^ready>'
given_back
wait $run
enters "clear; $RBSIM attach run.sock; echo status \$?"
sees 'status 66'
