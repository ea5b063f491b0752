#!/bin/sh
# SPDX-License-Identifier: MIT
# --commands: lines of a file are checked before the run and executed when they are due; standard input is read when asked for.
. tests/cli/functions

small_scene >s.lua
refused()
{
	printf '%b' "$1" >commands
	rm -f r.h5
	exits 66 s.lua -o r.h5 --commands commands
	says err "$2"
	[ ! -e r.h5 ] || fail "'$1': the recording was begun"
}
refused 'status\nfoo\n' "rbsim: commands:2: unknown command 'foo'"
refused '\n# a remark\n\nat 0.1 paus' "commands:4: unknown command 'paus' \(did you mean 'pause'"
refused 'at soon status\n' "commands:1: wanted 'at TIME command'"
refused 'at -1 status\n' "commands:1: wanted 'at TIME command'"
refused 'at' "commands:1: unknown command 'at'"
refused 'at 3 status\n' 'commands:1: 3 s is after the end of the run, 0.5 s'
refused 'seek 1\n' "commands:1: 'seek' needs a console"
refused 'set mu 1\n' "commands:1: the scene has no parameter 'mu'"
for line in pause toggle step 'stop at collision on'; do
	refused "at 0.1 $line\n" "commands:1: '${line%% *}' needs --listen"
done
refused 'sta\0tus\n' 'commands:1: a zero byte'
refused "$(printf '%02000d' 1)\n" 'commands:1: the line is longer than 1024 bytes'
exits 66 s.lua --no-record --commands none
says err "cannot open 'none'"
exits 66 s.lua --no-record --commands .
head -c 2000000 /dev/zero >commands
exits 66 s.lua --no-record --commands commands
exits 64 check s.lua --commands commands

# in order of time; each at the first frame at or after its time
printf 'at 0.25 body left\nstatus\nat 0.1 body left\r\nat 0.5 status\nat 0.1 help seek\nstop at collision off' >commands
exits 0 s.lua --no-record --commands commands -q
grep -E '^ (time|seek)|^ state' out >seen
cat >wanted <<'END'
 state playing
 time 0
 time 0.10000000000000001
 seek TIME|PERCENT%: show the frame at a simulated time in seconds, or at a percentage of the run
 time 0.25
 state playing
 time 0.5
END
cmp -s wanted seen || { diff wanted seen >&2; fail "the commands were executed otherwise"; }
[ "$(grep -c '^ok$' out)" -eq 6 ] || fail "$(grep -c '^ok$' out) answers for six commands"
# with --json standard output is one object
exits 0 s.lua --no-record --commands commands --json
[ "$(wc -l <out)" -eq 1 ] || fail "answers are among the JSON"
says err '^ok$'
# an answer that nobody can be given is told
if [ -w /dev/full ]; then
	"$RBSIM" s.lua --no-record --commands commands -q >/dev/full 2>err
	got=$?
	[ $got -eq 74 ] || fail "standard output is full: exit status $got"
fi

# standard input
printf 'status\nnonsense\nset x 1\n\nbody left' >in
"$RBSIM" s.lua --no-record --commands - -q <in >out 2>err || fail "commands from standard input: exit status $?"
# (what it still can read before the run has ended, which may be nothing)
grep -Eq '^(ok|error|$)' out || [ ! -s out ] || fail "no answers"

pid=
trap 'exec 3>&-; [ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
long_scene >l.lua
mkfifo fifo
"$RBSIM" l.lua -o l.h5 --commands - -q <fifo >out 2>err &
pid=$!
exec 3>fifo
answers()
{
	[ "$(grep -Ec '^(ok|error .*)$' out)" -eq "$1" ]
}
echo pause >&3
until_true answers 1
printf 'sta' >&3
sleep 0.1
printf 'tus\nfoo\n' >&3
until_true answers 3
says out "^error unknown command 'foo'"
printf '%02000d\nhelp quit\n' 1 >&3
until_true answers 5
says out '^error the line is longer than 1024 bytes'
says out '^ quit: '
kill -0 $pid || fail "the run does not stand still"
# its time stands still as well: what it has recorded does not grow
rests()
{
	a=$(wc -c <l.h5)
	sleep 0.7
	[ "$(wc -c <l.h5)" -eq "$a" ]
}
until_true [ -f l.h5 ]
# what was under way when it paused may still be written
rests || rests || rests || fail "a paused run goes on recording"
# the input ends: nobody is left to say play, so the run goes on
exec 3>&-
grows()
{
	[ "$(wc -c <l.h5)" -gt "$a" ]
}
until_true grows
kill -INT $pid
ended 75 "the run"

# without being asked, standard input is left alone
echo quit | "$RBSIM" s.lua --no-record -q || fail "standard input was read"

# the pause is not in the time that the run has taken
echo pause >commands
begun=$(date +%s.%N)
"$RBSIM" s.lua --no-record --listen s --commands commands --json >out 2>err &
pid=$!
stands()
{
	"$RBSIM" ctl s status 2>/dev/null | grep -q '^state paused'
}
until_true stands
sleep 2
"$RBSIM" ctl s play >/dev/null || fail "play was refused"
wait $pid
pid=
awk -v all="$(date +%s.%N)" -v begun="$begun" -v wall="$(value wall_time)" 'BEGIN { exit !(wall + 2 <= all - begun) }' ||
	fail "a run with a pause of two seconds has taken $(value wall_time) s"
