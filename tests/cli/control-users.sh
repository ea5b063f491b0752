#!/bin/sh
# SPDX-License-Identifier: MIT
# Processes of other users get nothing from a run, also where the mode of its socket would let them in; root does.
. tests/cli/functions
[ "$(id -u)" = 0 ] || { echo "only root can be several users"; exit 77; }
command -v setpriv >/dev/null || { echo "no setpriv"; exit 77; }

long_scene >s.lua
# other users may not be able to walk to this folder or to the program, but they are in it already
mkdir run
cp "$RBSIM" ./program
chmod 755 . program
chmod 777 run
chmod 644 s.lua
setpriv --reuid=65534 --clear-groups ./program --version >/dev/null 2>&1 || { echo "other users can't run the program here"; exit 77; }
pid=
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
# as USER STATUS ARGUMENT...
as()
{
	user=$1
	wanted=$2
	shift 2
	setpriv --reuid="$user" --clear-groups ./program "$@" >out 2>err </dev/null
	got=$?
	[ $got -eq "$wanted" ] || fail "user $user: rbsim $*: exit status $got, wanted $wanted"
}

# a run of root's
./program s.lua --no-record -q --listen run/s >/dev/null 2>&1 &
pid=$!
until_true [ -S run/s ]
as 0 0 ctl run/s status
as 65534 66 ctl run/s status
says err 'Permission denied'
chmod 666 run/s
as 65534 69 ctl run/s quit
says err "rejects the connection: .*another user"
says_nothing out
as 0 0 ctl run/s status
says out 'state playing'
kill $pid
wait $pid
[ ! -e run/s ] || fail "the socket is still there"

# a run of somebody else's: its own user and root may, a third one may not
setpriv --reuid=65534 --clear-groups ./program s.lua --no-record -q --listen run/s >/dev/null 2>&1 &
pid=$!
until_true [ -S run/s ]
chmod 666 run/s
as 65533 69 ctl run/s pause
says err "rejects the connection"
as 65534 0 ctl run/s status
says out 'state playing'
as 0 0 ctl run/s status
as 65534 0 ctl run/s quit
wait $pid
pid=
[ ! -e run/s ] || fail "the socket is still there"
exit 0
