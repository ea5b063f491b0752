#!/bin/sh
# SPDX-License-Identifier: MIT
# --help of a scene shows its parameters; --param sets them and is checked.
. tests/cli/functions

cat >s.lua <<'END'
local e = param("e", 0.8, "restitution of the ball", {min = 0, max = 1})
local how = param("how", "drop", "how it starts", {choices = {"drop", "throw"}})
local free = param("free", true, "without a floor")
world { title = "Parameters", duration = 0.1 }
material { name = "m", restitution = e }
sphere { radius = 0.1, material = "m", velocity = {how == "throw" and 1 or 0, 0, 0} }
END
exits 0 s.lua --help
says out 'Parameters of s.lua'
says out 'e=0\.8 .*restitution of the ball.*0 to 1'
says out 'how=drop .*how it starts.*one of drop, throw'
says out 'free=true .*without a floor'
says out '^Examples:'
says_nothing err
[ ! -e s.h5 ] || fail "--help has recorded"

exits 0 s.lua --param e=0.5 --param how=throw --no-record
says_nothing out
for wrong in e=2 e=much how=fall nothing=1; do
	"$RBSIM" s.lua --param $wrong --no-record >out 2>err </dev/null
	case $? in 64 | 65) ;; *) fail "--param $wrong was accepted" ;; esac
	says err "${wrong%%=*}"
done
