#!/bin/sh
# SPDX-License-Identifier: MIT
# From nothing to the first step, without cameras and recording: time, memory, loaded libraries. Time is that of a
# whole process that makes one step, its end included: more than what is asked for. On a busy machine most of it is
# waiting for a processor, so true(1) stands beside it.
. "$(dirname "$0")/functions"

# start CASE MILLISECONDS MEGABYTES ARGUMENT...
start()
{
	case=$1 ms=$2 mb=$3
	shift 3
	run "$@" # warms the caches, and refuses what does not run
	measure 20 "$RBSIM" run "$@" --quiet >rows
	result "$case" "whole process" "$(calc "1e3 * $(median rows 1)")" ms "$ms"
	result "$case" "its processor time" "$(calc "1e3 * $(median rows 2)")" ms "$ms"
	result "$case" "resident" "$(calc "$(median rows 3) / 1000")" MB "$mb"
}

measure 20 true >rows
result "true(1)" "whole process" "$(calc "1e3 * $(median rows 1)")" ms

start "one ball" 5 16 "$BENCH_SCENES/start.lua" --no-record
start "gas of 1000" "" 16 "$SCENES/gas.lua" --param balls=1000 --no-record --duration 0.004
start "one ball, recorded" "" "" "$BENCH_SCENES/start.lua" -o one.h5 --force

# Everything the loader opens, at the start and later, as the loader itself tells.
libraries()
{
	rm -f loaded.*
	LD_DEBUG=files LD_DEBUG_OUTPUT=$WORK/loaded "$RBSIM" run "$@" --quiet
	sed -n 's/.*calling init: //p' loaded.* | sed 's|.*/||' | sort -u | tr '\n' ' '
}
plain=$(libraries "$BENCH_SCENES/start.lua" --no-record)
recorded=$(libraries "$BENCH_SCENES/start.lua" -o one.h5 --force)
# only if HDF5 shows when it is needed would its absence tell anything
case $recorded in
*hdf5*)
	result "no camera, no recording" "loaded libraries" "$plain" ""
	result "no camera, no recording" "of HDF5 or for rendering" \
		"$(echo "$plain" | tr ' ' '\n' | grep -ciE 'hdf5|libGL|EGL|osmesa|vulkan|llvm|png|libav|sz\.|aec' || true)" "" 0
	;;
*) echo "$BENCH: LD_DEBUG does not tell which libraries are loaded here" >&2 ;;
esac
