#!/bin/sh
# SPDX-License-Identifier: MIT
# Texts of scenes reach the console's terminal as letters: no window's title, no C1, no mark of direction is sent.
. tests/cli/functions
. "$TOP/tests/cli/terminal"

bad='\27]0;stolen\7\194\155\226\128\174\226\129\166\255'
cat >s.lua <<END
world { title = "T$bad", duration = 0.2, gravity = {0, 0, -9.81} }
local n = param("n", 1, "N$bad")
sphere { name = "ball$bad", radius = 0.1, position = {0, 0, 0.3} }
camera { name = "C$bad", position = {0, -5, 2}, look_at = {0, 0, 0.5} }
expect("E$bad", function() return true end)
END
exits 0 s.lua
terminal 100 30
tmux -L "$TERMINAL" pipe-pane "cat >>raw"
enters "clear; LC_ALL=C.UTF-8 $RBSIM console s.h5"
sees 'at the end'
types '?'
types Escape
types q
sees '^ready>'
[ -s raw ] || fail "nothing was sent to the terminal"
LC_ALL=C grep -qa "$(printf '\033\\]0;stolen')" raw && fail "the title of the window was set"
LC_ALL=C grep -qaE "$(printf '\302[\200-\237]|\342\200[\250-\256]|\342\201[\246-\251]|\377')" raw && fail "C1 or a mark of direction reached the terminal"
exit 0
