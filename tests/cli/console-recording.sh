#!/bin/sh
# SPDX-License-Identifier: MIT
# rbsim console over a recording: keys and commands in a real terminal.
. tests/cli/functions
. "$TOP/tests/cli/terminal"

cat >s.lua <<'END'
world { title = "Drop", duration = 4, frame_rate = 50, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = 0.5 }
plane { normal = {0, 0, 1}, material = m }
sphere { name = "ball", radius = 0.5, position = {0, 0, 4}, material = m }
sphere { name = "green ball", radius = 0.25, position = {2, 0, 1}, material = m, velocity = {0, 0.1, 0} }
camera { name = "main", position = {6, -8, 3}, look_at = {0, 0, 1} }
camera { name = "moving", position = function(t) return {6 - t, -8, 3} end, look_at = {0, 0, 1} }
END
exits 0 s.lua
impacts=$(sed -n 's/^ *impacts *\([0-9][0-9]*\).*/\1/p' err)
terminal 110 34
enters "$RBSIM console s.h5"
# on a busy machine all four seconds may have gone by
sees '(playing|at the end).*speed 1 '
sees 't (0\.[2-9]|[1-4]\.).* of 4 s'
# on a busy machine it may be at its end by now, from where the space key would play again
types : && enters pause
sees '^ (paused|at the end)'
sees "collisions $impacts\$"
types Home
sees 't 0.0000 of 4 s.* frame 0 of 200'
types . .
sees 'frame 2 of 200'
types ,
sees 'frame 1 of 200'
types : && enters 'seek 50%'
sees 't 2.0000 .*frame 100 of 200'
types : && enters 'seek 1'
sees 't 1.0000 .*frame 50 of 200'
types Right
sees 't 1.0400 .*frame 52 of 200'
types Left Left
sees 't 0.9600 .*frame 48 of 200'

# collisions: the first is that of the lower ball, after sqrt(2 * 0.75 / 9.81) = 0.391 s
types Home n
sees 'frame 20 of 200'
sees '1 collision before frame 20'
types n
sees_not 'frame 20 of'
types p
sees 'frame 20 of 200'
types p
sees 'there is no collision before this frame'
types End
sees 'frame 200 of 200'

# speed: four seconds a hundred times faster are over at once
types : && enters 'speed 100'
sees 'speed 100'
types Home
sees 'frame 0 of 200'
types Space
sees 'at the end .*frame 200 of 200'
types '[' '['
sees 'speed 25 '
# what is at its end plays from the beginning; slowly, so that this can be seen
types : && enters 'speed 0.5'
sees 'speed 1/2 '
types Space
sees_not 'frame 200 of 200'
types : && enters 'speed 100'
sees 'at the end .*frame 200 of 200'
types 1
sees 'speed 1 '

# bodies, by name, number, part of a name; those that are not there
types Home : && enters 'body "green ball"'
sees 'green ball  sphere, moving'
sees 'position +2 +0 +1 m'
types / && enters 'BAL'
sees 'ball  sphere, moving'
sees 'position +0 +0 +4 m'
types : && enters 'body bal'
sees "there is no body 'bal'.*did you mean 'ball'"
types f
types : && enters 'camera moving'
types : && enters 'camera orbit 20 10'
types : && enters 'camera no'
sees "there is no camera 'no'"

# the line: completion, history, editing
types : b o Tab '"' g r Tab
sees '^:body "green ball"'
types Enter : Up
sees '^:body "green ball"'
types C-u
sees_not '^:body'
types Escape : f o o Enter
sees "unknown command 'foo'"
types : s e Tab Enter
sees "unknown command 'se'"
types : && enters 'help seek'
sees 'seek TIME.PERCENT%: show the frame'
types '?'
sees 'Keys .up, down: more; .: back'
sees '^  space +play or pause'
types PageDown PageDown PageDown
sees '^  quit +leave the console'
types Escape
sees_not '^  quit +leave'
# a key that has nothing to do with the help is not lost on it
types '?'
sees 'Keys .up, down'
types :
sees '^:'
sees_not 'Keys .up, down'
enters 'seek 0'
types : && enters 'restart'
sees 'needs a run'
types : && enters 'set e 1'
sees 'needs a run'
types : && enters 'snapshot picture.png'
sees 'picture.png: 1280 x 720 pixels|pictures are sketches'
types : && enters 'stop at collision on'
types Home Space
sees 'stopped at the collision of frame 20'
sees 'frame 20 of 200'
types : && enters 'status'
sees 'frames shown.*drift'
types q
sees '^ready> *$'
given_back
exits 64 console s.h5
says err 'needs a terminal'
