#!/bin/sh
# SPDX-License-Identifier: MIT
# Every command has the same effect through every way in: rbsim ctl, the bare socket, standard input, a file.
. tests/cli/functions
command -v python3 >/dev/null || { echo "no python3 to speak to a socket with"; exit 77; }

cat >s.lua <<'END'
local e = param("e", 1.0, "restitution", {min = 0, max = 1})
world { duration = 1e6, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = e, density = 1000 }
plane { normal = {0, 0, 1}, material = m }
sphere { name = "the ball", radius = 0.1, position = {0, 0, 1}, material = m }
END
cat >say.py <<'END'
import socket, sys
s = socket.socket(socket.AF_UNIX)
s.connect(sys.argv[1])
f = s.makefile("rw", newline="\n")
f.readline()
f.write(sys.argv[2] + "\n")
f.flush()
for line in f:
    sys.stdout.write(line)
    if not line.startswith(" "):
        break
END
pid=
trap 'exec 3>&-; [ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT

key()
{
	"$RBSIM" ctl s status 2>/dev/null | sed -n "s/^$1 //p"
}
stands()
{
	[ "$(key state)" = paused ]
}
# settled: what was commanded has come about; leaves `status`
settled()
{
	"$RBSIM" ctl s status >status 2>/dev/null && grep -Eq '^state (paused|playing)$' status &&
		{ [ "$line" != restart ] || grep -q "^restarts $((base + 1))$" status; }
}

# answered N: so many lines have been answered on standard output
answered()
{
	[ "$(grep -c '^[a-z]' answers)" -eq "$1" ]
}
restarted()
{
	[ "$(key restarts)" = 1 ]
}

# way COMMAND: a run that stands at its first frame, then the command; its answer and effect go to `seen`
through()
{
	way=$1 line=$2 base=0
	rm -f s in
	mkfifo in
	case $way in
	stdin)
		"$RBSIM" s.lua --no-record --listen s --commands - <in >answers 2>err &
		pid=$!
		exec 3>in
		until_true [ -S s ]
		printf 'pause\nrestart\n' >&3 # from somewhere back to the first frame
		until_true answered 2
		until_true restarted
		base=1
		;;
	file)
		printf 'pause\n%s\n' "$line" >commands
		"$RBSIM" s.lua --no-record --listen s --commands commands >answers 2>err &
		pid=$!
		;;
	*)
		echo pause >commands
		"$RBSIM" s.lua --no-record --listen s --commands commands >answers 2>err &
		pid=$!
		;;
	esac
	# a run that quits at once shows no socket
	[ "$way $line" = 'file quit' ] || until_true [ -S s ]
	[ $way = file ] || until_true stands
	case $way in
	ctl)
		"$RBSIM" ctl s "$line" >answer 2>message && echo ok >>answer
		sed -n 's/^rbsim: /error /p' message >>answer
		;;
	socket) python3 say.py s "$line" | sed 's/^ //' >answer ;;
	stdin)
		n=$(grep -c '^[a-z]' answers)
		echo "$line" >&3
		until_true answered $((n + 1))
		sed '1,2d; s/^ //' answers >answer
		;;
	file) until_true answered 2 && sed '1d; s/^ //' answers >answer ;;
	esac
	if [ "$line" = quit ]; then
		wait $pid
		echo "exit status $?" >effect
		pid=
		[ -e s ] && fail "$way: the socket is still there after quit"
	else
		until_true settled
		# a step is under way for a moment, and so is a restart
		grep -q '^state playing' status && sleep 0.2
		until_true settled
		grep -E '^(state|stop-at-collision|set) ' status >effect
		grep -q '^state paused' status && grep -E '^(frame|time|collisions|kinetic-energy) ' status >>effect
		echo "restarts $(($(sed -n 's/^restarts //p' status) - base))" >>effect
		kill -9 $pid
		wait $pid 2>/dev/null
		pid=
	fi
	exec 3>&-
	# what differs from run to run is not looked at
	grep -Ev '^(wall-time|paused-time|real-time-factor|state|restarts) ' answer >seen
	cat effect >>seen
}

for line in play pause toggle step 'step 30' 'stop at collision on' 'stop at collision off' restart 'set e 0.5' \
	'body "the ball"' status help 'help seek' quit; do
	through ctl "$line"
	mv seen wanted
	[ -s wanted ] || fail "'$line' has no answer"
	for way in socket stdin file; do
		through $way "$line"
		cmp -s wanted seen || { diff wanted seen >&2; fail "'$line' has another effect through $way"; }
	done
	case $line in
	play | toggle) grep -q '^state playing' wanted ;;
	step) grep -q '^frame 1$' wanted ;;
	'step 30') grep -q '^frame 30$' wanted ;;
	'set e 0.5') grep -q '^set e=0.5$' wanted ;;
	restart) grep -q '^restarts 1$' wanted ;;
	*on) grep -q '^stop-at-collision on$' wanted ;;
	quit) grep -q '^exit status 130$' wanted ;;
	esac || fail "'$line': $(cat wanted)"
done

# What a run can't do is refused through every way; in a file before the run.
for line in 'seek 1' 'speed 2' back 'follow x' 'camera a' snapshot 'film on' 'view pause' next previous \
	'set e 2' 'set f 1' 'body nobody' nonsense 'step x'; do
	through ctl "$line"
	mv seen wanted
	grep -q '^error ' wanted || fail "'$line' was not refused"
	for way in socket stdin; do
		through $way "$line"
		cmp -s wanted seen || { diff wanted seen >&2; fail "'$line' is refused otherwise through $way"; }
	done
	case $line in 'body nobody' | 'film on') continue ;; esac # known only when it is asked for
	echo "$line" >commands
	exits 66 s.lua --no-record --commands commands
	says err "commands:1: $(sed -n 's/^error //p' wanted | head -n 1 | cut -c 1-30 | sed 's/[][(]/./g')"
done
