#!/bin/sh
# SPDX-License-Identifier: MIT
# Does `auto` pick the cheaper way? Processor time of a scene by auto over the better of located and stepped, over scenes/ and
# stacks that are let fall. LIMIT (60 s) bounds each run; one that does not end, or is refused, is not the better one.
. "$(dirname "$0")/functions"

# cost METHOD SCENE ARGUMENT...: seconds of the processor, `inf` without an end
cost()
{
	method=$1
	shift
	# shellcheck disable=SC2046
	set -- $(measure 1 timeout "${LIMIT:-60}" "$RBSIM" run "$@" --method "$method" --threads 1 --no-record --no-render --quiet)
	case ${4:-1} in
	0 | 1) echo "$2" ;;
	*) echo inf ;;
	esac
}

# compare NAME SCENE ARGUMENT...
compare()
{
	name=$1
	shift
	auto=$(cost auto "$@") located=$(cost located "$@") stepped=$(cost stepped "$@")
	result "$name" "located" "$located" s
	result "$name" "stepped" "$stepped" s
	result "$name" "auto" "$auto" s
	result "$name" "auto over the better" "$(awk -v a="$auto" -v l="$located" -v s="$stepped" 'BEGIN {
		best = l == "inf" || (s != "inf" && s + 0 < l + 0) ? s : l
		if (a == "inf" || best == "inf") print "unknown"; else printf "%.3g", a / (best > 0.01 ? best : 0.01) }')" "" 1.5
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
	compare "stack of $count let fall" "$BENCH_SCENES/fall.lua" --param count=$count --param rate=240
done
