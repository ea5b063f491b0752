#!/bin/sh
# SPDX-License-Identifier: MIT
# rbsim-scene(5): its tables are the program's, its examples run, its mistakes are those that are made.
. tests/cli/functions

"$TOP/tools/check-manual" "$RBSIM" >out 2>&1 || fail "the manual's tables are behind"

# example NUMBER: the text of that block of the manual
example()
{
	awk -v wanted="$1" '/^\.Bd -literal/ { block = int(block) + 1; next } /^\.Ed/ { block += 0.5; next } block == wanted' \
		"$TOP/man/rbsim-scene.5"
}
example 1 >bounce.lua
grep -q 'sphere' bounce.lua || fail "no example in the manual"
exits 0 bounce.lua --no-record --quiet --duration 1 --param e=0.5
says_nothing out
{
	echo 'world { duration = 1 }'
	example 3
} >union.lua
exits 0 check union.lua --no-record
says out '1 union'
{
	echo 'world { duration = 1 }'
	example 4
} >motion.lua
exits 0 check motion.lua --no-record
says out '1 of them driven'

{
	printf '\n\n\n\n\n\n\n\n'
	echo 'sphere { name = "ball", raduis = 1, mass = -1 }'
} >bounce.lua
exits 65 bounce.lua
grep '^bounce.lua:9:' "$TOP/man/rbsim-scene.5" | sort >wanted
grep '^bounce.lua:9:' err | sort >found
cmp -s wanted found || fail "the manual shows other mistakes: $(cat found)"
