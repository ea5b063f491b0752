#!/bin/sh
# SPDX-License-Identifier: MIT
# What recording 60 frames per second costs a gas of 1,000 and of 10,000: the same run with and without, alternately.
# The recorder has a thread of its own, so wall time is what a user waits for on a free machine, and processor time (of
# all threads) what the machine pays. Files go to TMPDIR and from there to the disk in the system's own time.
. "$(dirname "$0")/functions"

# recording N DURATION PAIRS
recording()
{
	: >pairs
	for _ in $(seq "$3"); do
		measure 1 "$RBSIM" run "$SCENES/gas.lua" --param balls="$1" --duration "$2" --threads 1 --quiet --no-record >without
		rm -f gas.h5 # the run that replaces a file pays for its removal
		measure 1 "$RBSIM" run "$SCENES/gas.lua" --param balls="$1" --duration "$2" --threads 1 --quiet -o gas.h5 >with
		echo "$(cat with) $(cat without)" | awk '{ print $1, $2, $5, $6, $1 / $5, $2 / $6 }' >>pairs
	done
	frames=$(calc "60 * $2 + 1") case="gas of $1, $2 s"
	result "$case" "run without" "$(calc "$(median pairs 3)")" s
	result "$case" "run with" "$(calc "$(median pairs 1)")" s
	result "$case" "processor time per frame of recording" \
		"$(calc "1e6 * ($(median pairs 2) - $(median pairs 4)) / $frames")" us
	result "$case" "recording" "$(calc "$(wc -c <gas.h5) / 1e6 / $frames")" "MB/frame"
	result "$case" "wall time, with over without" "$(calc "$(median pairs 5)")" "" 1.1
	result "$case" "processor time, with over without" "$(calc "$(median pairs 6)")" ""
}

# 10 s is the scene's own duration; the shorter the run, the more of it is loading HDF5 and opening the file
recording 1000 10 11
recording 10000 10 7
