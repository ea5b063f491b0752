#!/bin/sh
# SPDX-License-Identifier: MIT
# The console at all sizes, with many colours and none, without a renderer, suspended and resumed.
. tests/cli/functions
. "$TOP/tests/cli/terminal"

small_scene >s.lua
exits 0 s.lua
terminal 100 30
enters "$RBSIM console s.h5"
sees '^ at the end'
sees 'energy .J., overlap'
sees 'position|/ looks for a body'
resize()
{
	tmux -L "$TERMINAL" resize-window -x "$1" -y "$2"
}
resize 40 12
sees_not 'energy'
sees '^ at the end +t 0.5000 of 0.5 s'
sees '^ frame 30 of 30'
sees '^━+'
sees 'space play  q quit  . help  : command'
types Home
sees 't 0.0000'
types : && enters 'body left'
sees 'mass +4.189 kg'
types : && enters 'seek 0.25 and this line is much longer than the screen is wide and goes on and on'
sees "'much longer than the screen"
resize 39 11
sees '^needs 40x12'
resize 20 5
sees '^needs 40x12'
resize 70 20
sees 'frame 0 of 30'
resize 250 70
sees 'energy .J., overlap'
types End
sees 'frame 30 of 30'

# stopped, and back again
types C-z
sees '[Ss]topped'
given_back
enters 'fg'
sees 'frame 30 of 30'
types Home
sees 'frame 0 of 30'
types q
sees '^ready> *$'
given_back

# no UTF-8, no colours, no cursor: characters alone, and an error that says it
terminal_ends
TERMINAL=rbsim-$$-plain
terminal 100 30 LC_ALL=C TERM=vt100
enters "$RBSIM console s.h5"
sees '^ at the end'
sees '[@%#*+=:.]{20}'
types q
sees '^ready>'
enters "TERM=dumb $RBSIM console s.h5; echo status \$?"
sees 'status 69'
enters "clear; TERM=nonsense $RBSIM console s.h5; echo status \$?"
sees "the terminal 'nonsense' is not known"
sees 'status 69'

# without a renderer there is a sketch
mkdir only
cp "$(dirname "$RBSIM")"/rbsim-hdf5.so "$(dirname "$RBSIM")"/rbsim-console.so only
tmux -L "$TERMINAL" resize-window -x 160
enters "clear; RBSIM_MODULE_DIR=only $RBSIM console s.h5"
sees 'pictures are sketches: cannot load .*rbsim-film.so'
sees '[.:-]{8}'
types q
sees '^ready>'
exit 0
