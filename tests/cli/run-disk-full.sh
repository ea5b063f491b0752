#!/bin/sh
# SPDX-License-Identifier: MIT
# A file that may grow no more ends the run with 74, and what was written before is readable.
. tests/cli/functions

{ long_scene | sed "s/1e5/1000/"; echo 'record { ledger = false }'; } >s.lua # whose first chunks fill the file
(
	ulimit -f 4000 # of 512 or 1024 bytes
	exec timeout "$PATIENCE" "$RBSIM" s.lua >out 2>err
)
got=$?
[ $got -eq 74 ] || fail "exit status $got, wanted 74"
says err 'rbsim: '
says err 'frames +[0-9]+ of 60001 simulated, [0-9]+ of them in the recording'
told=$(sed -n 's/.*simulated, \([0-9]*\) of them.*/\1/p' err)
exits 0 info s.h5 --json
[ "$(value frames)" -gt 10 ] || fail "$(value frames) frames are readable"
[ "$(value frames)" = "$told" ] || fail "$(value frames) frames are readable, the summary says $told"

# Not even the beginning fits: the message names the file, not what is in it, and the summary no recording that is not there.
for limit in 100 400; do
	(
		ulimit -f $limit
		exec timeout "$PATIENCE" "$RBSIM" s.lua -o little.h5 >out 2>err
	)
	got=$?
	[ $got -eq 73 ] || [ $got -eq 74 ] || fail "exit status $got, wanted 73 or 74"
	says err "cannot (create|write) 'little.h5': File too large"
	[ -e little.h5 ] || ! grep -q 'little.h5, ' err out || fail "a recording that is not there: $(cat err)"
	rm -f little.h5
done

# the thread sanitizer writes a file of its own before the program begins
[ "${RBSIM_MODE:-release}" = tsan ] && exit 0

# Not a byte fits: what it says comes through a pipe, because files may hold nothing. The reason is told, and the file's name.
limited()
{
	said=$(
		ulimit -f 0
		timeout "$PATIENCE" "$RBSIM" "$@" 2>&1
		echo "status $?"
	)
	echo "$said" >err
}
limited s.lua -o little.h5
says err '^status 73'
says err "^rbsim: cannot create 'little.h5': File too large"
for to in csv dump glb; do
	limited export s.h5 --to $to -o x.$to
	says err '^status 74'
	says err "^rbsim: cannot write 'x.*': File too large"
done
