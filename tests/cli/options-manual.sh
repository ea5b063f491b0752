#!/bin/sh
# SPDX-License-Identifier: MIT
# Every example of rbsim(1) and rbsim-sweep(1) runs, in its order.
. tests/cli/functions

cat >bounce.lua <<'END'
local e = param("e", 0.8, "restitution of the ball", {min = 0, max = 1})
world { title = "A bouncing ball", duration = 1, gravity = {0, 0, -9.81} }
local rubber = material { name = "rubber", restitution = e }
plane { normal = {0, 0, 1}, material = rubber }
sphere { name = "ball", radius = 0.1, position = {0, 0, 1}, material = rubber }
END
cp bounce.lua drop.lua
sed -n 's/^\.Dl rbsim //p' "$TOP/man/rbsim.1" "$TOP/man/rbsim-sweep.1" >examples
[ "$(wc -l <examples)" -ge 16 ] || fail "the manual has lost its examples"
# examples first: whoever opens the page sees what to type
for page in rbsim.1 rbsim-sweep.1; do
	[ "$(grep -n '^\.Dl rbsim ' "$TOP/man/$page" | head -n 1 | cut -d : -f 1)" -lt \
		"$(grep -n '^\.Sh DESCRIPTION' "$TOP/man/$page" | cut -d : -f 1)" ] || fail "$page: examples behind the description"
done
while read -r example; do
	sh -c "\"$RBSIM\" $example" >out 2>err </dev/null
	got=$?
	case $example in
	diff*) wanted=1 ;; # two methods
	plot*) command -v gnuplot >/dev/null && wanted=0 || wanted=69 ;;
	*) wanted=0 ;;
	esac
	[ $got -eq $wanted ] || fail "rbsim $example: exit status $got, wanted $wanted"
done <examples
cmp -s again.lua bounce.lua || fail "the scene came out of the recording otherwise"

# statuses and verbs of the manual are those of the program
for status in 0 1 64 65 66 69 70 71 73 74 76; do
	grep -q "^\.It $status\$" "$TOP/man/rbsim.1" || fail "rbsim(1) does not explain exit status $status"
done
for verb in run check info render diff converge verify methods ctl console attach sweep collect plot; do
	grep -q "^\.It Cm $verb\$" "$TOP/man/rbsim.1" || fail "rbsim(1) does not explain $verb"
done
