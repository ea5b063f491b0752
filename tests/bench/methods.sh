#!/bin/sh
# SPDX-License-Identifier: MIT
# Does `auto` pick the cheaper way? Instructions of a scene by auto (processor time where they cannot be counted, as on
# most virtual machines) over the better of located and stepped: over scenes/, stacks that are let fall, and the stacks,
# towers and pyramids of convex.sh. LIMIT (60 s) bounds each run; one that does not end, is refused or fails what the
# scene expects is not the better one. `tests/bench/methods.sh NAME...` compares these only.
. "$(dirname "$0")/functions"
ONLY=" $* "
UNIT=s
perf stat -x , -e instructions:u true 2>&1 | grep -q '^[0-9]' && UNIT=instructions

# cost METHOD SCENE ARGUMENT...: what it takes, `inf` without an end or with another one than expected
cost()
{
	method=$1
	shift
	set -- timeout -k 1 "${LIMIT:-60}" "$RBSIM" run "$@" --method "$method" --threads 1 --no-record --no-render --quiet
	if [ $UNIT = s ]; then
		# shellcheck disable=SC2046 # four numbers
		set -- $(measure 1 "$@")
		took=$2 status=${4:-1}
	else
		status=0
		perf stat -x , -e instructions:u -o counted "$@" >/dev/null 2>&1 </dev/null || status=$?
		took=$(awk -F , '/instructions/ { print $1 }' counted)
	fi
	case $method$status in
	*0 | auto1) echo "$took" ;;
	*) echo inf ;;
	esac
}

# compare NAME SCENE ARGUMENT...
compare()
{
	name=$1
	shift
	[ "$ONLY" = "  " ] || case $ONLY in *" $name "*) ;; *) return 0 ;; esac
	auto=$(cost auto "$@") located=$(cost located "$@") stepped=$(cost stepped "$@")
	result "$name" "located" "$located" $UNIT
	result "$name" "stepped" "$stepped" $UNIT
	result "$name" "auto" "$auto" $UNIT
	result "$name" "auto over the better" "$(awk -v a="$auto" -v l="$located" -v s="$stepped" -v unit=$UNIT 'BEGIN {
		least = unit == "s" ? 0.01 : 3e7
		best = l == "inf" || (s != "inf" && s + 0 < l + 0) ? s : l
		if (a == "inf" || best == "inf") print "unknown"; else printf "%.3g", a / (best > least ? best : least) }')" "" 1.5
}

for scene in "$SCENES"/*.lua; do
	name=$(basename "$scene" .lua)
	set --
	case $name in
	heap) set -- --param balls=60 ;;
	hopper) set -- --param n=60 --param seconds=1 ;;
	kapla) set -- --param floors=3 ;;
	hourglass) set -- --param n=100 --param seconds=0.6 ;;
	silo) set -- --param n=150 ;;
	drum) set -- --param seconds=0.8 ;;
	angle_of_repose) set -- --param R=0.06 ;;
	esac
	compare "$name" "$scene" "$@"
done
for count in 20 50; do
	compare "fall_$count" "$BENCH_SCENES/fall.lua" --param count=$count --param rate=240
done
for count in 2 5 10; do
	for ratio in 1e3 1e4 1e6; do
		compare "stack_${count}_$ratio" "$BENCH_SCENES/stand.lua" --param count=$count --param ratio=$ratio
	done
done
compare tower_50 "$BENCH_SCENES/stand.lua" --param count=50 --param seconds=60
compare pyramid_20 "$BENCH_SCENES/stand.lua" --param kind=pyramid --param count=20 --param seconds=60
