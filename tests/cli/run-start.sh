#!/bin/sh
# SPDX-License-Identifier: MIT
# A run without a recording is light: at most 16 MB resident, no HDF5 and no rendering library in the process.
. tests/cli/functions
[ -r /proc/self/status ] || { echo "no /proc"; exit 77; }

long_scene >s.lua
"$RBSIM" s.lua --no-record -q &
pid=$!
trap 'kill -9 $pid 2>/dev/null' EXIT
sleep 0.5
cat /proc/$pid/maps >maps || fail "it has ended already"
grep -q '[.]so' maps || fail "no libraries in the map at all"
if grep -Ei 'hdf5|OSMesa|libGL|libpng|curses' maps; then
	fail "libraries that this run does not need"
fi
case ${RBSIM_MODE:-release} in
release | debug)
	kilobytes=$(sed -n 's/^VmHWM:[^0-9]*\([0-9]*\).*/\1/p' /proc/$pid/status)
	[ "$kilobytes" -le 16000 ] || fail "$kilobytes kB resident"
	;;
esac
