#!/bin/sh
# SPDX-License-Identifier: MIT
# A bar on a terminal, in the width that there is; none where it would not belong.
. tests/cli/functions
script -qec true /dev/null >/dev/null 2>&1 || { echo "no script(1)"; exit 77; }

long_scene >s.lua
seconds=1.5
# on_terminal COLUMNS ENVIRONMENT... -- ARGUMENT...: a run in a terminal that is interrupted after a while
on_terminal()
{
	columns=$1
	shift
	env=
	while [ "$1" != -- ]; do env="$env $1"; shift; done
	shift
	script -qec "stty cols $columns; env $env timeout --foreground -s INT $seconds $RBSIM s.lua --no-record $*" /dev/null \
		</dev/null >out 2>err
	tr '\r' '\n' <out | sed 's/\x1b\[K//' >lines
}

# sees_bar COLUMNS PATTERN: a busy machine comes later to it
sees_bar()
{
	for seconds in 1.5 5 20 60; do
		on_terminal "$1" TERM=xterm --
		grep -Eq "$2" lines && break
	done
	seconds=1.5
	says lines "$2"
}

sees_bar 100 '^ *[0-9]+ % \[=* *\]  .* of [0-9.e+]+ s  .* x real time  .* left$'
says lines 'frames'
sees_bar 30 '^ *[0-9]+ %'
grep -E '^ *[0-9]+ %' lines >bars
[ "$(awk '{ if (length($0) > m) m = length($0) } END { print m }' bars)" -lt 30 ] || fail "a bar is wider than its terminal"
for env in "TERM=dumb --" "TERM=xterm -- --quiet" "TERM=xterm -- --json"; do
	# shellcheck disable=SC2086
	on_terminal 80 $env
	! grep -Eq '[0-9] % \[' lines || fail "a bar with $env"
done

# the expectations are painted on a terminal, unless asked not to
small_scene 'expect("fine", function() return true end)' >small.lua
for case in "0 TERM=xterm NO_COLOR=" "1 TERM=xterm NO_COLOR=1" "1 TERM=dumb NO_COLOR="; do
	script -qec "env ${case#* } $RBSIM small.lua --no-record" /dev/null </dev/null >out 2>err
	grep -q "$(printf '\033\[32m')" out
	[ $? -eq "${case%% *}" ] || fail "colour with ${case#* }"
done

# an encoder that hangs: the line says who waits, the film is given up, the run goes on, and its status tells
command -v ffmpeg >/dev/null || { echo "no ffmpeg"; exit 77; }
cat >hanging <<'END'
#!/bin/sh
case $* in *-encoders*) exec ffmpeg "$@" ;; esac
exec sleep 1000
END
chmod +x hanging
small_scene 'camera { name = "main", position = {2, 2, 1}, look_at = {0, 0, 0}, size = {320, 240}, video = "x.mp4" }' |
	sed 's/duration = 0.5/duration = 20/' >film.lua
script -qec "env TERM=xterm RBSIM_FFMPEG=$PWD/hanging timeout 300 $RBSIM film.lua --film-timeout 20; echo status \$?" /dev/null \
	</dev/null >out 2>err
tr '\r' '\n' <out >lines
says lines "waits for camera 'main'"
says lines "camera 'main': .*hanging' made no progress for 20 s"
says lines '^status 69'
exits 0 info film.h5
says out 'status *complete'
says out ': 1201 frames'
