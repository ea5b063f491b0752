#!/bin/sh
# SPDX-License-Identifier: MIT
# Whichever allocation fails in a run that takes commands, it ends with 71 or goes on without what it could not keep or
# answer, and its socket goes with it.
. tests/cli/functions

small_scene 'on_frame(function() end)
local e = param("e", 0.5)' >s.lua
# as in run-out-of-memory.sh
case ${RBSIM_MODE:-release} in tsan) every=6 ;; asan) every=3 ;; *) every=1 ;; esac
first=1
# with a socket a restart that fails would pause the run for somebody who can say play
for way in '' '--listen s'; do
	restart=restart
	[ -z "$way" ] || restart=status
	printf 'status\nbody left\nat 0.03 set e 0.25\nat 0.05 %s\n' $restart >commands
	k=$first fine=0
	first=$((first % every + 1))
	while [ $((fine * every)) -lt 20 ]; do
		# shellcheck disable=SC2086
		RBSIM_FAIL_ALLOCATION=$k timeout -s KILL "$PATIENCE" "$RBSIM" s.lua -q --duration 0.1 --no-record $way --commands commands \
			>out 2>err </dev/null
		got=$?
		[ ! -e s ] || fail "allocation $k: the socket is still there"
		case $got in
		0) fine=$((fine + 1)) ;;
		71) fine=0 && says err 'memory' ;;
		*) fail "$way: allocation $k: exit status $got, wanted 71" ;;
		esac
		k=$((k + every))
		[ $k -lt 2000 ] || fail "no end of allocations"
	done
	[ $k -gt 100 ] || fail "only $k allocations could fail"
	echo "$way: $((k - 21)) allocations, every $every-th failed once"
done
