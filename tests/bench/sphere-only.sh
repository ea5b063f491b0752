#!/bin/sh
# SPDX-License-Identifier: MIT
# Instructions per body-step (valgrind's callgrind) of scenes of spheres alone, beside those of an earlier version: what
# other shapes have made spheres pay. Both versions run the scenes of this one.
# BASE names the earlier version (the last one without convex bodies); PILE_BASE the one for piles, which are stepped: the
# method came with convex bodies. Both are built from git; a version of which git knows nothing is left out.
. "$(dirname "$0")/functions"
BASE=${BASE:-b668c1c}
PILE_BASE=${PILE_BASE:-06a89e0}
MOST=1.02

# build REVISION FOLDER
build()
{
	[ -d "$2" ] && return 0
	git -C "$TOP" cat-file -e "$1^{commit}" 2>/dev/null || return 1
	mkdir "$2"
	git -C "$TOP" archive "$1" | tar -x -C "$2"
	make -C "$2" -j2 >"$2.log" 2>&1
}

# cost PROGRAM LUA ARGUMENTS...: instructions per body-step
cost()
{
	program=$1 lua=$2
	shift 2
	RBSIM_LUA_PATH=$lua valgrind --tool=callgrind --callgrind-out-file=counted "$program" run "$@" --threads 1 --no-record \
		--no-render --trust --json >out 2>err </dev/null || [ $? -eq 1 ] || return 1
	calc "$(sed -n 's/^\(summary\|totals\): //p' counted | head -n 1) / $(value body_steps)"
}

# compare REVISION CASE ARGUMENTS...
compare()
{
	revision=$1 case=$2 folder=$WORK/base-$1
	shift 2
	now=$(cost "$RBSIM" "$TOP/lua" "$@") || { result "$case" instructions failed "a body-step"; return; }
	result "$case" instructions "$now" "a body-step"
	build "$revision" "$folder" || { result "$case" "share of those at $revision" "not built" ""; return; }
	was=$(cost "$folder/build/release/rbsim" "$folder/lua" "$@") || was=
	[ -z "$was" ] || result "$case" "share of those at $revision" "$(calc "$now / $was")" "" $MOST
}

valgrind --tool=none --log-file=/dev/null true >/dev/null 2>&1 || { echo "$BENCH: needs valgrind" >&2; exit 0; }
compare "$BASE" "gas, located" "$BENCH_SCENES/gas.lua" -p n=1000 -p phi=0.1 -p T=0.2 --method located
compare "$BASE" "gas, classic" "$BENCH_SCENES/gas.lua" -p n=1000 -p phi=0.1 -p T=0.05 --method classic
compare "$BASE" "heap, classic" "$SCENES/heap.lua" --method classic --duration 0.3
compare "$BASE" billiard "$SCENES/billiard.lua"
compare "$BASE" cradle "$SCENES/cradle.lua"
for tolerance in 5e-3 5e-4 5e-6; do
	compare "$PILE_BASE" "pile of 64, tolerance $tolerance" "$BENCH_SCENES/pile.lua" -p side=4 -p layers=4 --method stepped \
		--duration 1 --tolerance $tolerance
done
compare "$PILE_BASE" "pile of 400, tolerance 5e-3" "$BENCH_SCENES/pile.lua" -p side=10 -p layers=4 --method stepped \
	--duration 1 --tolerance 5e-3
