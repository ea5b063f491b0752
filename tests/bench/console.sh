#!/bin/sh
# SPDX-License-Identifier: MIT
# What a view costs the simulation that is looked at, 30 pictures a second in true colour and 120 x 40 cells through a
# link of 1 MB/s, beside the same run without a socket and with one that nobody uses; what goes through the link; how a
# minute of playback at 60 frames a second keeps time; whether a thousand connections and noise leave anything behind.
# RUNS=9 takes more runs of each (5), PLAYBACK=60 and NOISE_SECONDS=600 more seconds (20, 10). Shares of wall time mean
# something where the console has a processor of its own.
. "$(dirname "$0")/functions"
command -v python3 >/dev/null || { echo "$BENCH: no python3" >&2; exit 69; }
[ -f "$(dirname "$RBSIM")/rbsim-console.so" ] || { echo "$BENCH: no console was built" >&2; exit 69; }
RUNS=${RUNS:-5}
PLAYBACK=${PLAYBACK:-20}

# terminal LINK SECONDS KEY COMMAND...
terminal()
{
	python3 "$TOP/tests/bench/terminal.py" "$@"
}

sed 's#frame_rate = 1 / duration#frame_rate = 1#' "$BENCH_SCENES/gas.lua" >gas.lua
gas="run gas.lua --param n=1000 --param T=800 --threads 1 --no-record --trust -q"
: >alone
: >listening
: >watched
for _ in $(seq "$RUNS"); do
	# shellcheck disable=SC2086 # words
	{
		terminal 0 0 '' --run "$RBSIM" $gas >>alone
		terminal 0 0 '' --run "$RBSIM" $gas --listen s >>listening
		terminal 1e6 0 '' "$RBSIM" attach s --run "$RBSIM" $gas --listen s >>watched
	}
done
# more NAME FILE COLUMN: by how many percent a median is above that of the run alone
more()
{
	calc "100 * ($(median "$2" "$3") / $(median alone "$3") - 1)"
}
result gas "a socket that nobody uses, processor time of the run" "$(more x listening 2)" "%"
result gas "watched, processor time of the run" "$(more x watched 2)" "%" 3
result gas "watched, wall time of the run" "$(more x watched 1)" "%" 3
awk '{ print $7 / $6, $5 / $7, $5 / $6, 1000 * $4 / $7, 100 * $3 / $2 }' watched >rates
result gas "watched, the socket's thread in the run's processor time" "$(median rates 5)" "%" 3
result gas "pictures" "$(median rates 1)" "1/s"
result gas "bytes of a picture" "$(median rates 2)" "bytes"
result gas "bytes through the link" "$(median rates 3)" "bytes/s" 1e6
result gas "processor time of the console for a picture" "$(median rates 4)" "ms"

"$RBSIM" "$SCENES/bounce.lua" --duration "$((PLAYBACK + 10))" -o bounce.h5 --no-render --trust -q >/dev/null 2>&1 || :
terminal 1e6 "$PLAYBACK" 1 "$RBSIM" console bounce.h5 --fps 60 >row
result playback "drift" "$(cut -d ' ' -f 10 row)" "ms/s" 1
result playback "99th percentile of lateness" "$(cut -d ' ' -f 9 row)" "ms" 16.7
result playback "mean lateness" "$(cut -d ' ' -f 8 row)" "ms"
result playback "pictures" "$(awk '{ print $7 / $6 }' row)" "1/s"
result playback "bytes of a picture" "$(awk '{ print $5 / $7 }' row)" "bytes"

mkdir noise
if (cd "$TOP" && RBSIM=$RBSIM TMPDIR=$WORK/noise NOISE_SECONDS=${NOISE_SECONDS:-10} sh tests/long/control-noise.sh) >noise.out 2>&1; then
	result noise "memory after the noise, over before" "$(tail -n 1 noise.out | awk '{ print $5 - $2 }')" "kB" 1000
	result noise "frames lost, bits changed" 0 "" 0
else
	tail -n 3 noise.out >&2
	result noise "frames lost, bits changed" "failed" "" 0
fi
