#!/bin/sh
# SPDX-License-Identifier: MIT
# The console draws with the colours that a terminal says it has: direct ones, 256, 16, 8, none; and gives each back.
. tests/cli/functions
. "$TOP/tests/cli/terminal"

cat >s.lua <<'END'
world { duration = 0.1, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = 0.5 }
plane { normal = {0, 0, 1}, material = m, texture = "checker" }
sphere { name = "red", radius = 0.5, position = {-1.2, 0, 0.6}, material = m, color = {1, 0, 0} }
sphere { name = "green", radius = 0.5, position = {0, 0, 0.6}, material = m, color = {0, 1, 0} }
sphere { name = "blue", radius = 0.5, position = {1.2, 0, 0.6}, material = m, color = {0, 0, 1} }
camera { name = "main", position = {0, -5, 2}, look_at = {0, 0, 0.5}, units = {time = "ms"} }
END
exits 0 s.lua

# What the picture's cells are drawn with, each kind of colour once: rgb 256 bright basic
kinds()
{
	tmux -L "$TERMINAL" capture-pane -p -e -N | sed -n 3,20p | tr 'm' '\n' | sed -n 's/.*\[//p' |
		sed 's/[34]8[;:]2[;:].*/rgb/; s/[34]8[;:]5[;:].*/256/; s/\(.*;\)\{0,1\}\(9\|10\)[0-7]$/bright/; s/\(.*;\)\{0,1\}[34][0-7]$/basic/' |
		grep -E '^(rgb|256|bright|basic)$' | sort -u | tr '\n' ' '
}

# colours TERM COLORTERM LOCALE WANTED UNWANTED PATTERN
colours()
{
	infocmp "$1" >/dev/null 2>&1 || { echo "no entry for '$1'" >&2; return; }
	enters "clear; TERM=$1 COLORTERM=$2 LC_ALL=$3 $RBSIM console s.h5"
	sees '^ at the end *t 100.0000 of 100 ms '
	sees "$6"
	found=$(kinds)
	case " $found" in
	*" $4 "*) ;;
	*) fail "TERM=$1 COLORTERM=$2: colours are '$found', wanted '$4'" ;;
	esac
	for kind in $5; do
		case " $found" in *" $kind "*) fail "TERM=$1 COLORTERM=$2: colours are '$found', wanted no '$kind'" ;; esac
	done
	types q
	sees '^ready>'
	given_back
}

terminal 80 24
colours xterm-256color truecolor C.UTF-8 rgb '' '▀{20}'
colours xterm-256color '' C.UTF-8 256 rgb '▀'
colours xterm-256color nonsense C.UTF-8 256 rgb '▀'
colours xterm-16color '' C.UTF-8 bright 'rgb 256' '▀'
colours xterm '' C.UTF-8 basic 'rgb 256 bright' '▀'
colours linux '' C.UTF-8 basic 'rgb 256 bright' '▀'
# without UTF-8 a cell has one colour, and nothing but ASCII stands on the screen
colours xterm-256color '' C 256 rgb '^ at the end'
enters "clear; TERM=xterm-256color COLORTERM= LC_ALL=C $RBSIM console s.h5"
sees '^ at the end'
screen | LC_ALL=C grep -q '[^ -~]' && fail "there is more than ASCII on the screen"
types q
sees '^ready>'

enters "clear; TERM=vt100 COLORTERM= LC_ALL=C $RBSIM console s.h5"
sees '^ at the end'
sees '[@%#*+=:.]{20}'
[ -z "$(kinds)" ] || fail "vt100 has colours: $(kinds)"
types q
sees '^ready>'
given_back

# nothing is written in the picture, where cells would not show it and it would hide the bodies
pictured()
{
	enters "clear; TERM=xterm-256color COLORTERM= LC_ALL=C.UTF-8 $RBSIM console $1.h5"
	sees '^ at the end'
	sees '▀{20}'
	screen | sed -n 2,18p | cut -c 1-120 | sed 's/ *[a-z].*//' >"$1.screen"
	types q
	sees '^ready>'
}
sed 's/units = .*/units = {time = "ms"}, overlay = {"time", "title"}, labels = {"red", "blue"}, text = "text", plots = {"energy"} }/' \
	s.lua >written.lua
exits 0 written.lua
pictured s
pictured written
cmp s.screen written.screen || fail "what a camera writes is in the cells: $(cat written.screen)"
