#!/bin/sh
# SPDX-License-Identifier: MIT
# The socket's file: private, taken away by every end of the run, a stale one replaced, a live one never taken.
. tests/cli/functions

long_scene >s.lua
pid=
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
listens()
{
	[ -S s ] && "$RBSIM" ctl s status >/dev/null 2>&1
}
start()
{
	"$RBSIM" s.lua --no-record --listen s >out 2>err &
	pid=$!
	until_true listens
}
# ended STATUS: the run ends like that, and its socket with it
ended()
{
	wait $pid
	got=$?
	pid=
	[ $got -eq "$1" ] || fail "exit status $got, wanted $1"
	[ ! -e s ] || fail "the socket is still there"
}

umask 0
start
[ "$(stat -c %a s)" = 600 ] || fail "the socket has mode $(stat -c %a s)"

# a live one is refused, and still serves
exits 73 s.lua --no-record --listen s
says err "cannot make socket 's': a process that runs listens there"
listens || fail "the run has lost its socket"

# without --listen there is no thread for it
"$RBSIM" s.lua --no-record --threads 1 -q >/dev/null 2>&1 &
other=$!
"$RBSIM" s.lua --no-record --threads 1 -q --listen s2 >/dev/null 2>&1 &
more=$!
until_true [ -S s2 ]
has_one_more() # threads are there as soon as the runs have begun
{
	[ "$(ls /proc/$more/task | wc -l)" -eq $(($(ls /proc/$other/task | wc -l) + 1)) ]
}
until_true has_one_more
kill -9 $other
kill $more
wait $more
[ ! -e s2 ] || fail "SIGTERM: the socket is still there"

# every end
kill -INT $pid
ended 130
start
kill -USR1 $pid
ended 143
start
"$RBSIM" ctl s quit >/dev/null || fail "quit was refused"
ended 130
says err "ended by the command 'quit' at"

# paused runs end as well
for signal in INT:130 TERM:143; do
	start
	"$RBSIM" ctl s pause >/dev/null || fail "pause was refused"
	kill -"${signal%:*}" $pid
	ended "${signal#*:}"
done

# a callback that fails
cat >bad.lua <<'END'
world { duration = 1000 }
sphere { radius = 1 }
on_frame(function(t) if t > 0.5 then error("enough") end end)
END
exits 65 bad.lua --no-record --listen s
[ ! -e s ] || fail "after a mistake the socket is still there"

# the second SIGINT, which waits for nothing
busy_scene >busy.lua
"$RBSIM" busy.lua --trust --no-record --listen s >out 2>err &
pid=$!
until_true listens
kill -INT $pid
sleep 0.3
kill -INT $pid
ended 130

# killed: the socket is stale, and the next run takes it
start
kill -9 $pid
wait $pid 2>/dev/null
pid=
[ -S s ] || fail "who has removed the socket of a killed run?"
exits 66 ctl s status
says err "cannot reach a run at 's': no run listens there any more"
start
kill $pid
ended 143

# two that start at once on a stale one: one of them gets it
one_is_left()
{
	kill -0 $pid 2>/dev/null || kill -0 $other 2>/dev/null || fail "neither of two runs has the socket"
	! { kill -0 $pid && kill -0 $other; } 2>/dev/null
}
for _ in 1 2 3 4 5; do
	start
	kill -9 $pid
	wait $pid 2>/dev/null
	"$RBSIM" s.lua --no-record --listen s >out 2>err &
	pid=$!
	"$RBSIM" s.lua --no-record --listen s >out2 2>err2 &
	other=$!
	until_true listens
	until_true one_is_left
	kill -9 $pid $other 2>/dev/null
	wait $pid 2>/dev/null
	first=$?
	wait $other 2>/dev/null
	second=$?
	pid=
	[ $first -eq 73 ] || [ $second -eq 73 ] || fail "exit statuses $first and $second"
done
rm -f s

# what is no socket stays
echo text >s
exits 73 s.lua --no-record --listen s
says err "'s': a file that is not a socket has that name"
[ "$(cat s)" = text ] || fail "the file was changed"
rm s
mkdir s
exits 73 s.lua --no-record --listen s
rmdir s
long=$(printf '%0120d' 1)
exits 73 s.lua --no-record --listen "$long"
says err "has a name of 120 bytes, wanted 1 to 107"
exits 73 s.lua --no-record --listen none/s
exits 66 ctl none status
exits 64 ctl s
says err "'ctl' needs SOCKET COMMAND"
