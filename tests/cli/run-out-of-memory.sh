#!/bin/sh
# SPDX-License-Identifier: MIT
# Whichever allocation fails, the run ends with 71 and a message, and what it leaves behind is no wreck.
. tests/cli/functions

small_scene 'on_frame(function() return body("left").force.z + body("right"):point_acceleration({0.1, 0, 0}).z end)
record { fields = {"+", "acceleration", "force", "torque"} }
expect("the end comes", function() return true end)' >s.lua
# joints alone, which are integrated from the beginning
cat >j.lua <<'END'
world { duration = 0.1, gravity = {0, 0, -9.81} }
local last
for k = 1, 3 do
	local link = sphere { radius = 0.1, mass = 1, position = {k - 0.5, 0, 0}, collides_with = {} }
	joint { kind = "hinge", a = link, b = last, at = {k - 1, 0, 0}, axis = {0, 1, 0} }
	last = link
end
END
# what fails in the end does so by the same ways from all threads: where only they are looked at, every sixth will do; a program
# with a sanitizer tries every third, in each kind of run other ones, which have the reading of the scene in common
case ${RBSIM_MODE:-release} in tsan) every=6 ;; asan) every=3 ;; *) every=1 ;; esac
first=1
# what is left behind is read each time in release; a program with a sanitizer, which is slow to start, reads some
case ${RBSIM_MODE:-release} in release) read_every=1 ;; *) read_every=12 ;; esac
for args in "j.lua --no-record" "s.lua --no-record" "s.lua --no-record --method stepped" "s.lua -o r.h5"; do
	k=$first
	first=$((first % every + 1))
	while :; do
		rm -f r.h5
		# shellcheck disable=SC2086
		RBSIM_FAIL_ALLOCATION=$k "$RBSIM" run $args -q --duration 0.1 >out 2>err </dev/null
		got=$?
		[ $got -eq 0 ] && break
		[ $got -eq 71 ] || fail "$args: allocation $k: exit status $got, wanted 71"
		says err 'memory'
		if [ -e r.h5 ] && [ $((k % read_every)) -lt $every ]; then
			exits 0 info r.h5 --json
			[ "$(value status)" = failed ] || fail "$args: allocation $k: the recording is '$(value status)'"
		fi
		k=$((k + every))
		[ $k -lt 2000 ] || fail "$args: no end of allocations"
	done
	[ $k -gt 20 ] || fail "$args: only $k allocations could fail"
	echo "$args: $((k - 1)) allocations, every $every-th failed once"
done

# however little address space there is: HDF5 ends with SIGSEGV where it gets none
# shellcheck disable=SC3045
if [ "${RBSIM_MODE:-release}" = release ] && (ulimit -v 95000) 2>err; then
	for kib in $(seq 20000 2500 95000); do
		rm -f r.h5
		(
			ulimit -v "$kib"
			exec "$RBSIM" run s.lua -q -o r.h5
		) >out 2>err </dev/null
		got=$?
		case $got in
		0) ;;
		127) says err 'thread-local data: ABORT' ;; # of the C library, when a thread first uses a variable of its own
		69 | 71) [ -s err ] || fail "with $kib KiB of address space: status $got without a word" ;;
		*) fail "with $kib KiB of address space: exit status $got" ;;
		esac
	done
	[ $got -eq 0 ] || fail "a small run does not get by with $kib KiB of address space"
	exits 0 run s.lua -q -o r.h5 --force
fi

# so does what reads a recording
k=1
while :; do
	RBSIM_FAIL_ALLOCATION=$k "$RBSIM" replay r.h5 >out 2>err </dev/null
	got=$?
	[ $got -eq 0 ] && break
	[ $got -eq 71 ] || fail "replay: allocation $k: exit status $got, wanted 71"
	says err 'memory'
	k=$((k + every))
	[ $k -lt 2000 ] || fail "replay: no end of allocations"
done
[ $k -gt 20 ] || fail "replay: only $k allocations could fail"
echo "replay: $((k - 1)) allocations, every $every-th failed once"
