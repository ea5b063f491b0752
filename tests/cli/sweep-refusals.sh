#!/bin/sh
# SPDX-License-Identifier: MIT
# Sweeps that cannot be are refused before anything runs, and nothing is left behind.
. tests/cli/functions

small_scene 'local e = param("e", 0.5, "x", {min = 0, max = 1}) local n = param("n", 2, "y")' >s.lua

# refused STATUS PATTERN ARGUMENT...
refused()
{
	wanted=$1 pattern=$2
	shift 2
	exits "$wanted" sweep "$@"
	says err "$pattern"
	[ ! -e d ] || fail "rbsim sweep $*: left 'd' behind"
}
refused 64 "needs --output DIR" s.lua -p e=0,1
refused 64 "'e' must be .*\(got '2'\)" s.lua -p e=0,2 -o d
refused 64 "'e' must be .*\(got '1.1'\)" s.lua -p e=0:1.1:0.1 -o d
refused 64 "'n' must be a whole number" s.lua -p n=1:2 --sample latin:3 -o d
refused 64 "no parameter 'f'" s.lua -p f=1 -o d
refused 64 "does not lead from 1 to 0" s.lua -p e=1:0:0.1 -o d
refused 64 "a range without a step" s.lua -p e=0:1 -o d
refused 64 "at most 10000000" s.lua -p e=0:1:0.0001 -p n=1:10000:1 -o d
refused 64 "given twice" s.lua -p e=0 -p e=1 -o d
refused 64 "not latin:N" s.lua -p e=0:1 --sample random:3 -o d
refused 64 "'--task' needs '--tasks'" s.lua -p e=0,1 -o d --task 1
refused 64 "not one of 3 shares" s.lua -p e=0,1 -o d --task 3 --tasks 3
refused 64 "'--tasks' needs" s.lua -p e=0,1 -o d --tasks 3
refused 64 "'--time' needs '--slurm'" s.lua -p e=0,1 -o d --time 1:00
refused 64 "only one of" s.lua -p e=0,1 -o d --status --slurm
refused 66 "nothere.lua" nothere.lua -p e=0,1 -o d
echo 'world { duration = -1 }' >bad.lua
refused 65 "bad.lua:1" bad.lua --seeds 2 -o d

# folders that are not a sweep's
mkdir mine && touch mine/thesis.tex
exits 73 sweep s.lua -p e=0,1 -o mine
says err "holds 'thesis.tex' and no plan"
[ "$(ls mine)" = thesis.tex ] || fail "something was left in the folder"
exits 66 sweep nosuchfolder --status
says err "cannot open 'nosuchfolder': No such file.* \(wanted: a scene, or the folder of a sweep\)"
exits 66 sweep mine
says err "holds no sweep"
touch file
exits 73 sweep s.lua -p e=0,1 -o file
exits 73 sweep s.lua -p e=0,1 -o file/below

# a sweep that goes on is the same one
exits 0 sweep s.lua -p e=0,1 -o d --duration 0.1
for other in "-p e=0,0.5" "-p e=0,1 --seeds 2" "-p e=0,1 --seed 5" "-p e=0,1 --method classic" "-p e=0,1 --no-record"; do
	# shellcheck disable=SC2086 # words
	exits 66 sweep s.lua $other -o d
	says err "is of another sweep"
done
exits 64 sweep d -p e=0,1
says err "'--param' is settled by the plan"
exits 64 sweep d --duration 2
exits 64 sweep d -o e
echo '-- changed' >>s.lua
exits 66 sweep s.lua -p e=0,1 -o d --duration 0.1
says err "'s.lua' has changed"
exits 0 sweep d
sed 's/^1,\([0-9]*\),1$/1,\1,0.9/' d/plan.csv >plan && cp plan d/plan.csv
exits 66 sweep d
says err "is of another sweep"
exits 66 sweep s.lua -p e=0,1 -o d --duration 0.1
sed 's/^# seeds 1/# seeds 7/' plan >d/plan.csv
exits 66 sweep d --status
exits 66 sweep d --task 0 --tasks 1
