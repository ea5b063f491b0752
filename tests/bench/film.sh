#!/bin/sh
# SPDX-License-Identifier: MIT
# Pictures per second of 1280 x 720 pixels: 1,000 textured lit spheres with shadows, as PNG files and as H.264, beside
# what a bare clear, read-back and encoding of the same size reaches; the shares of drawing, reading back, PNG and
# pipe; 100,000 spheres; four cameras at once; and what rendering live costs the simulation of the gas of 1,000.
# PICTURES=300 takes longer films (120); RUNS=5 more repetitions (3), of which the median counts.
#
# What a picture of 1,000 spheres costs, ms of one core (AMD EPYC, llvmpipe of Mesa 22.3, busy machine): all that is
# drawn 60: spheres 20, their edges 15, plane 15 (10 of them four looks into the shadow map), the map 6, clear, sky and
# reading back 4, what is seen at all 3; PNG 19 to 25, H.264 about 20. The bare picture costs 10 in all, since nothing
# in it needs compressing: 60 % of its rate leaves less than what PNG alone takes of a real one. A block of 4 x 4 pixels
# costs llvmpipe 40 ns before its shader does anything, a look into a map 4.5 ns a pixel, which is what is left.
. "$(dirname "$0")/functions"
command -v ffmpeg >/dev/null || { echo "$BENCH: no ffmpeg" >&2; exit 69; }
PICTURES=${PICTURES:-120}
RUNS=${RUNS:-3}

# record NAME N BARE PICTURES
record()
{
	"$RBSIM" "$BENCH_SCENES/film.lua" --param n="$2" --param bare="$3" --param pictures="$4" --no-render --trust -q -o "$1.h5"
}

# rate RECORDING OUTPUT [OPTION...]: median pictures per second of wall time; the last run's JSON stays in out
rate()
{
	recording=$1
	film=$2
	shift 2
	for _ in $(seq "$RUNS"); do
		"$RBSIM" render "$recording.h5" -o "$film" --force --json "$@" >out 2>err || { cat err >&2; exit 1; }
		calc "$(value pictures) / $(value wall_time)"
		echo
	done >rates
	median rates 1
}

# shares CASE: where the time of the film in out went
shares()
{
	for part in draw read png pipe; do
		result "$1" "wall time in $part" "$(calc "100 * $(value ${part}_time) / $(value wall_time)")" "%"
	done
}

record full 1000 0 "$PICTURES"
record bare 1000 1 "$PICTURES"
for kind in png mp4; do
	film=film.mp4
	[ $kind = png ] && film=frames/%05d.png
	ceiling=$(rate bare "$film" --camera camera1)
	result "$kind" "ceiling: clear, read-back, encoding" "$ceiling" "1/s"
	found=$(rate full "$film" --camera camera1)
	result "$kind" "1,000 spheres" "$found" "1/s"
	shares "$kind"
	result "$kind" "share of the ceiling" "$(calc "$found / $ceiling")" "" 0.6 more
done
# the same pictures without drawing: what their encoding alone takes
ffmpeg -v error -i film.mp4 -f rawvideo -pix_fmt rgba raw </dev/null
start=$(date +%s.%N)
ffmpeg -v error -y -f rawvideo -pix_fmt rgba -s 1280x720 -r 30 -i raw -c:v libx264 -preset veryfast -crf 18 -pix_fmt yuv420p again.mp4 </dev/null
encoded=$(calc "$PICTURES / ($(date +%s.%N) - $start)")
result mp4 "encoding alone of the same pictures" "$encoded" "1/s"
result mp4 "share of encoding alone" "$(calc "$found / $encoded")" ""
rm -f raw

record many 100000 0 6
result png "100,000 spheres" "$(rate many 'many/%d.png' --camera camera1)" "1/s" 1 more

# several cameras at once, each to its own pictures
cat >four.lua <<'END'
for k = 1, 4 do
	camera { name = "c" .. k, position = {14, -16 + 4 * k, 10}, look_at = {0, 0, 4}, size = {1280, 720}, fps = 30, png = "c" .. k .. "/%05d.png" }
end
END
for cameras in c1 c1,c2 c1,c2,c3,c4; do
	"$RBSIM" render full.h5 --with four.lua --camera $cameras --force --json >out 2>err || { cat err >&2; exit 1; }
	count=$(echo $cameras | tr ',' '\n' | wc -l)
	result cameras "$count at once, pictures of all" "$(calc "$PICTURES * $count / $(value wall_time)")" "1/s"
done

# the gas of 1,000, alone and filmed while it runs
gas()
{
	"$RBSIM" run "$WORK/gas.lua" --no-record --threads 1 --trust --json "$@" >out 2>err || { cat err >&2; exit 1; }
	value wall_time
}
sed 's#frame_rate = 1 / duration#frame_rate = 30#' "$BENCH_SCENES/gas.lua" >gas.lua
echo 'camera { position = {30, -40, 25}, size = {640, 360}, fps = 30, png = "gas/%05d.png" }' >>gas.lua
alone=$(gas --no-render --param n=1000 --param T=20)
filmed=$(gas --force --param n=1000 --param T=20)
result live "wall time of the gas of 1,000 filmed, over alone" "$(calc "$filmed / $alone")" ""
