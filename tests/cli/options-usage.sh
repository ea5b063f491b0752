#!/bin/sh
# SPDX-License-Identifier: MIT
# What the command line understands, what it refuses, and how it says so.
. tests/cli/functions

exits 64
says err "'run' needs SCENE.lua"
exits 0 help
for verb in run check render sweep plot; do
	says out "^  $verb "
	says out "^ *rbsim .*"
done
[ "$(grep -c '^             rbsim ' out)" = "$(grep -c '^  [a-z]' out)" ] || fail "not an example for each verb"
exits 0 help render
says out '^usage: rbsim render'
exits 64 help render check
says err "'help' takes one verb \(got 'check' as well\)"
exits 64 s.lua --checkpoint-every -1
says err "'-1' is not a finite number, 0 or more"
exits 64 help nonsense
says err "'nonsense' is neither a verb nor a scene"
says_nothing out
echo 'world { duration = 0.1 } sphere { radius = 1 }' >fall.lua
exits 64 fall
says err "'fall' is neither a verb nor a scene \(did you mean 'fall.lua'\?\)"
exits 66 info fall.lua
says err "'fall.lua' is not an HDF5 file \(a scene: its run makes a recording\)"
exits 64 --durration 3 s.lua
says err "unknown option '--durration' \(did you mean '--duration'\?\)"
exits 64 render a.h5 --sheed # of its own options, not those of other verbs
says err "unknown option '--sheed' \(did you mean '--speed'\?\)"
says err "see 'rbsim render --help'"
for line in "s.lua" "render s.h5" "export s.h5 --to csv" "sweep s.lua -p e=1" "plot s.h5 energy"; do
	# shellcheck disable=SC2086 # words of a line
	exits 64 $line -o -
	says err "'--output': only 'collect' writes to standard output"
done
[ ! -e ./--bodies.csv ] || fail "a file of the name of an option"
exits 64 chekc s.lua
says err "did you mean 'check'"
exits 64 check s.lua --resume
says err "'--resume' does not belong to 'check'"
exits 64 s.lua --method leaped
says err "'leaped' is not one of: auto, classic, located, stepped"
exits 64 s.lua --duration 1x
says err "'1x' is not a finite number above 0"
exits 64 info a.h5 --force
says err "'--force' does not belong to 'info'"
exits 64 diff a.h5
exits 66 missing.lua
says err "missing.lua"
exits 66 info missing.h5
says err "missing.h5"
exits 66 -- check
says err "'check'"

exits 0 --version
says out '^rbsim [0-9]+\.[0-9]+\.[0-9]+$'
says_nothing err
exits 0 --help
says out '^usage: rbsim'
says out '^Examples:'
says_nothing err
for verb in run check info diff converge verify methods; do
	exits 0 $verb --help
	says out "^usage: rbsim $verb"
done
exits 0 methods
says out 'classic'
exits 0 methods --json
says out '"name":"classic"'
