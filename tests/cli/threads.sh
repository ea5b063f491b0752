#!/bin/sh
# SPDX-License-Identifier: MIT
# The threads of a run are told apart by their names: debuggers, `top -H` and `ps -L` show them.
. tests/cli/functions
[ -r /proc/$$/task/$$/comm ] || { echo "no /proc that names threads"; exit 77; }

pid=
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
named()
{
	cat /proc/$pid/task/*/comm 2>/dev/null | sort >names
	for name in $wanted; do
		grep -qx -- "$name" names || return 1
	done
}
# shows NAME...: a run that waits in its midst has threads of these names; $RUN are more options of it
shows()
{
	wanted=$*
	echo "at 0.1 pause" >commands
	# shellcheck disable=SC2086 # words
	"$RBSIM" s.lua --force --listen s --commands commands --threads 2 --method auto $RUN >out 2>err &
	pid=$!
	until_true named
	# the main one alone keeps the program's; sanitizers have threads of their own
	case ${RBSIM_MODE:-release} in
	release | debug) [ "$(grep -cx rbsim names)" -eq 1 ] || fail "threads without a name: $(tr '\n' ' ' <names)" ;;
	esac
	kill -9 $pid
	wait $pid 2>/dev/null
	pid=
	rm -f s
}

small_scene >s.lua
RUN="--checkpoint-every 3600"
shows rbsim rb-worker rb-recorder rb-progress rb-checkpoint rb-server

# cameras have names of their own, of which as much is left as there is room for
[ -f "$(dirname "$RBSIM")/rbsim-film.so" ] && command -v ffmpeg >/dev/null || { echo "films are not tried: not installed"; exit 0; }
small_scene 'camera { name = "seen ~~ from afar", position = {3, 0, 1}, look_at = {0, 0, 0}, size = {64, 48}, png = "p%d.png" }
camera { name = "x", position = {3, 0, 1}, look_at = {0, 0, 0}, size = {64, 48}, video = "x.mp4" }' >s.lua
RUN=--no-record
shows rbsim rb-camera-seen rb-camera-x rb-png rb-video
