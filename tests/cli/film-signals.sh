#!/bin/sh
# SPDX-License-Identifier: MIT
# A signal ends a film soon, however many pictures lie between two frames and whatever ffmpeg does, and what was drawn is kept.
. tests/cli/functions
command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }

pid=
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
small_scene 'camera { name = "main", position = {0, -4, 1}, look_at = {0, 0, 0.2}, size = {64, 48}, samples = 1 }
camera { name = "moving", position = function(t) return {t, -4, 1} end, size = {64, 48}, samples = 1 }' >s.lua
exits 0 s.lua -q

# an ffmpeg that says, by a file, when the first picture has come
cat >watched <<'END'
#!/bin/sh
case "$*" in *-encoders*) exec ffmpeg "$@" ;; esac
head -c $((64 * 48 * 3)) >taken && mv taken first
{ cat first && exec cat; } | ffmpeg "$@"
END
chmod +x watched
export RBSIM_FFMPEG=$PWD/watched

# ends STATUSES SIGNAL ARGUMENT...: gets the signal once its film has begun and `enough` is there, and is given a minute
enough='[ -s first ]'
ends()
{
	wanted=$1 signal=$2
	shift 2
	rm -f first
	"$RBSIM" "$@" >out 2>err </dev/null &
	pid=$!
	until_true sh -c 'find . -name "*.png" -o -name "*film*" | grep -q .'
	# shellcheck disable=SC2086 # words
	until_true $enough
	kill -"$signal" $pid
	for _ in $(seq 600); do
		kill -0 $pid 2>/dev/null || break
		sleep 0.1
	done
	kill -0 $pid 2>/dev/null && fail "rbsim $*: still there a minute after SIG$signal"
	wait $pid
	got=$?
	pid=
	case " $wanted " in *" $got "*) ;; *) fail "rbsim $*: exit status $got after SIG$signal, wanted $wanted" ;; esac
}

for camera in main moving; do
	ends 130 INT render s.h5 --camera $camera --speed 1e-5 -o film.mp4
	says err 'cut short'
	n=$(ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 film.mp4)
	[ "$n" -ge 1 ] || fail "$camera: '$n' pictures"
	rm film.mp4
done
enough='[ -f pictures/00000.png ]'
ends 143 TERM render s.h5 --camera main --speed 1e-5 -o 'pictures/%05d.png'
[ -f pictures/00000.png ] || fail "no picture"
find pictures -name '.*' -type f | grep -q . && fail "half a picture is left"
rm -r pictures

# in a run: the recording is that of what was simulated, the film what was drawn of it; 75 where the run itself was cut, too
small_scene 'camera { name = "main", position = {0, -4, 1}, size = {64, 48}, samples = 1, speed = 1e-5, video = "film.mp4" }' >run.lua
has_frames()
{
	[ -s first ] && "$RBSIM" info run.h5 --json >info 2>/dev/null && [ "$(value frames info)" -gt 1 ]
}
enough=has_frames
ends '130 75' INT run.lua
[ $got -eq 75 ] || says err 'cut short'
exits 0 info run.h5 --json
[ "$(value frames)" -gt 1 ] || fail "$(value frames) frames recorded"
[ -s film.mp4 ] || fail "no film"
rm film.mp4

# an ffmpeg that takes nothing and never ends: a second interrupt ends both
cat >hang <<'END'
#!/bin/sh
case "$*" in *-encoders*) echo ' V....D libx264 x'; exit 0 ;; esac
echo $$ >hang.pid
exec sleep 60
END
chmod +x hang
RBSIM_FFMPEG=$PWD/hang "$RBSIM" render s.h5 --camera main --speed 1e-5 -o film.mp4 >out 2>err </dev/null &
pid=$!
until_true [ -s hang.pid ]
kill -INT $pid
sleep 0.3
kill -INT $pid
ended 130 "a second SIGINT"
until_true sh -c 'ps -o stat= -p "$(cat hang.pid)" | grep -qv Z && exit 1; exit 0'
exit 0
