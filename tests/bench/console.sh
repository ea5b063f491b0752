#!/bin/sh
# SPDX-License-Identifier: MIT
# What a view costs the simulation that is looked at, 30 pictures a second in true colour and 120 x 40 cells through a
# link of 1 MB/s: seconds in which a console watches, between seconds in which it is stopped. What goes through the link;
# what a socket costs that nobody uses; how playback at 60 frames a second keeps time; whether a thousand connections and
# noise leave anything behind.
# WATCH=120 watches longer (40 s), RUNS=9 takes more runs (3), PLAYBACK=60 and NOISE_SECONDS=600 more seconds (20, 10).
# Shares of wall time mean something where the console has a processor of its own.
. "$(dirname "$0")/functions"
command -v python3 >/dev/null || { echo "$BENCH: no python3" >&2; exit 69; }
[ -f "$(dirname "$RBSIM")/rbsim-console.so" ] || { echo "$BENCH: no console was built" >&2; exit 69; }
RUNS=${RUNS:-3}
WATCH=${WATCH:-40}
PLAYBACK=${PLAYBACK:-20}

terminal()
{
	python3 "$TOP/tests/bench/terminal.py" "$@"
}

# some hundred frames in a second of wall time
sed 's#frame_rate = 1 / duration#frame_rate = 1#' "$BENCH_SCENES/gas.lua" >gas.lua
gas="run gas.lua --param n=1000 --threads 1 --no-record --trust -q"
: >alone
: >listening
for _ in $(seq "$RUNS"); do
	# shellcheck disable=SC2086 # words
	{
		terminal none 0 0 --run "$RBSIM" $gas --param T=800 >>alone
		terminal none 0 0 --run "$RBSIM" $gas --param T=800 --listen s >>listening
	}
done
result gas "a socket that nobody uses, processor time of the run" \
	"$(calc "100 * ($(median listening 2) / $(median alone 2) - 1)")" "%"

# shellcheck disable=SC2086 # words
terminal watch 1e6 "$WATCH" s "$RBSIM" attach s --run "$RBSIM" $gas --param T=1e6 --listen s >rows
tail -n 1 rows >last
# each second that was watched, against the one before
grep '^[01] ' rows | awk '$1 == 0 { w = $2; c = $3; f = $4 } $1 == 1 { print 100 * ($2 / w - 1), 100 * ($3 / c - 1), 100 * ($3 - $4) / $3 }' >shares
result gas "watched, processor time of the run" "$(median shares 2)" "%" 3
result gas "watched, of that the socket's thread" "$(median shares 3)" "%" 3
result gas "watched, wall time of the run" "$(median shares 1)" "%" 3
result gas "pictures" "$(awk '{ print $4 / $3 }' last)" "1/s"
result gas "bytes of a picture" "$(awk '{ print $2 / $4 }' last)" "bytes"
result gas "bytes through the link" "$(awk '{ print $2 / $3 }' last)" "bytes/s" 1e6
result gas "processor time of the console for a picture" "$(awk '{ print 1000 * $1 / $4 }' last)" "ms"

"$RBSIM" "$SCENES/bounce.lua" --duration "$((PLAYBACK + 10))" -o bounce.h5 --no-render --trust -q >/dev/null 2>&1 || :
terminal play 1e6 "$PLAYBACK" "$RBSIM" console bounce.h5 --fps 60 >row
result playback "drift" "$(cut -d ' ' -f 7 row)" "ms/s" 1
result playback "99th percentile of lateness" "$(cut -d ' ' -f 6 row)" "ms" 16.7
result playback "mean lateness" "$(cut -d ' ' -f 5 row)" "ms"
result playback "pictures" "$(awk '{ print $4 / $3 }' row)" "1/s"
result playback "bytes of a picture" "$(awk '{ print $2 / $4 }' row)" "bytes"

mkdir noise
if (cd "$TOP" && RBSIM=$RBSIM TMPDIR=$WORK/noise NOISE_SECONDS=${NOISE_SECONDS:-10} sh tests/long/control-noise.sh) >noise.out 2>&1; then
	result noise "memory after the noise, over before" "$(tail -n 1 noise.out | awk '{ print $5 - $2 }')" "kB" 3000
	result noise "frames lost, bits changed" 0 "" 0
else
	tail -n 3 noise.out >&2
	result noise "frames lost, bits changed" "failed" "" 0
fi
