#!/bin/sh
# SPDX-License-Identifier: MIT
# The main job: a scene goes in, a recording and a summary come out; nothing is replaced unasked.
. tests/cli/functions

mkdir scenes
small_scene 'expect("there are balls", function() return true end)' >scenes/two.lua
exits 0 scenes/two.lua
[ -f two.h5 ] || fail "no two.h5 in the current folder"
says_nothing out
says err 'frames +31 of 31'
says err 'overlap'
says err 'energy'
says err 'expectations +1 of 1 hold'
says err 'recording +two.h5'

before=$(cksum <two.h5)
exits 73 scenes/two.lua
says err "'two.h5'.*exists.*--force"
[ "$(cksum <two.h5)" = "$before" ] || fail "a recording was touched without --force"
exits 0 scenes/two.lua --force -q
says_nothing out
says_nothing err
exits 0 run scenes/two.lua --output other.h5 --quiet
exits 0 diff two.h5 other.h5
exits 73 scenes/two.lua -o no/such/folder/a.h5
exits 73 scenes/two.lua -o scenes/two.lua --force
says err 'it is the scene'
grep -q 'Two balls' scenes/two.lua || fail "the scene was replaced by its recording"

rm -f two.h5
exits 0 scenes/two.lua --no-record --quiet
[ ! -e two.h5 ] || fail "--no-record has recorded"

small_scene 'record { file = "named.h5" }' >scenes/named.lua
exits 0 scenes/named.lua -q
[ -f named.h5 ] || fail "the scene's record file was not taken"

# what the options put in place of the scene's words
exits 0 scenes/two.lua --no-record --json --duration 0.25 --time-step 0.001 --tolerance 1e-5 --rollback global --seed 9 --threads 1
[ "$(value frames)" = 16 ] || fail "duration: $(value frames) frames"
[ "$(value time_step)" = 0.001 ] || fail "time step"
[ "$(value rollback)" = global ] || fail "rollback"
[ "$(value seed)" = 9 ] || fail "seed"
[ "$(value threads)" = 1 ] || fail "threads"

# who takes the name of a recording that is being written does not do so unnoticed
cat >long.lua <<END
world { duration = 1e5, frame_rate = 60 }
sphere { radius = 0.1, velocity = {1, 0, 0} }
END
"$RBSIM" long.lua -o taken.h5 --quiet 2>first &
first=$!
until_true [ -f taken.h5 ]
exits 73 long.lua --duration 1 -o taken.h5 --force --quiet # no other run takes it
says err "cannot write to 'taken.h5': the run that writes it goes on"
exits 0 long.lua --duration 1 -o stands-in.h5 --quiet
mv stands-in.h5 taken.h5
status=0
kill -INT $first
wait $first || status=$?
[ $status -eq 74 ] || fail "exit $status, wanted 74: the recording was taken away"
# a reader that has opened it without heed of who writes it does not keep /VTKHDF out
if command -v flock >/dev/null; then
	"$RBSIM" long.lua -o locked.h5 2>second &
	second=$!
	until_true [ -f locked.h5 ]
	flock -s locked.h5 sh -c "kill -INT $second; while kill -0 $second 2>/dev/null; do sleep 0.1; done" &
	status=0
	wait $second || status=$?
	wait $!
	[ $status -eq 75 ] || fail "exit $status, wanted 75"
	! grep -q 'complete but for' second || fail "$(cat second)"
	h5ls locked.h5 | grep -q VTKHDF || fail "it was not added"
fi
grep -q "'taken.h5' is lost" first || fail "nobody says that the recording is lost"
exits 0 info taken.h5
