#!/bin/sh
# SPDX-License-Identifier: MIT
# Convex bodies: do stacks, towers and pyramids stand, is friction the same in all directions, are impacts right? Set
# METHODS to compare methods, QUICK for the small ones only.
. "$(dirname "$0")/functions"
CASES=$SCENES/verify
METHODS=${METHODS:-auto stepped}
"$RBSIM" methods | grep -q '^  stepped' || METHODS=auto

# stand CASE BARRED-EXPECTATION ARGUMENT...: one run that is to stand; a run that fails or takes too long is a result
stand()
{
	name=$1 text=$2 unit=$3
	shift 3
	if timeout "${LIMIT:-120}" "$RBSIM" run "$BENCH_SCENES/stand.lua" --no-record "$@" --json >out 2>err </dev/null || [ $? -eq 1 ]; then
		result "$name" "$text" "$(calc "$(measured "$text")")" "$unit" 1e-6
		result "$name" "time" "$(calc "$(value wall_time)")" s
	else
		result "$name" "$text" "no result: $(tail -n 1 err)" "$unit" 1e-6
	fi
}

for method in $METHODS; do
	for step in 60 240; do
		for count in 2 5 10; do
			for ratio in 1e3 1e4 1e6; do
				stand "$method, stack of $count, top $ratio heavier, 1/$step s" compression m --param count=$count --param ratio=$ratio \
					--time-step "$(awk "BEGIN { printf \"%.17g\", 1 / $step }")" --method "$method"
				[ -z "${QUICK-}" ] || break 2
			done
		done
	done
	stand "$method, tower of 50" "displacement over height" "" --param count=50 --param seconds=60 --method "$method"
	stand "$method, pyramid of 20 rows" "displacement over height" "" --param kind=pyramid --param count=20 --param seconds=60 \
		--method "$method"
	[ -n "${QUICK-}" ] || stand "$method, Kapla, 102 blocks, 600 s" "displacement over height" "" --param kind=kapla --param count=6 \
		--param seconds=600 --time-step 0.01 --method "$method"
done

# stacks that are let fall by a millimetre each, over the tolerance in half edges
for method in $METHODS; do
	for count in 20 50; do
		for rate in 60 240; do
			for tolerance in 1e-6 1e-4 1e-2; do
				name="$method, stack of $count let fall, 1/$rate s, $tolerance r"
				timeout "${LIMIT:-120}" "$RBSIM" run "$BENCH_SCENES/fall.lua" --no-record --param count=$count \
					--param rate=$rate --method "$method" --tolerance "$(calc "0.5 * $tolerance")" \
					--threads 1 --json >out 2>err </dev/null || [ $? -eq 1 ] || continue
				result "$name" "fastest after 2 s" "$(calc "$(measured "fastest after 2 s")")" m/s 0
				result "$name" "top below its place" "$(calc "$(measured "top below its place")")" m \
					"$(calc "0.5 * $tolerance * $count")"
				result "$name" "time for 20 s" "$(calc "$(value wall_time)")" s 1
			done
		done
	done
done

# of CASE TEXT UNIT BAR SCENE ARGUMENT...: what an expectation of a case measures
of()
{
	name=$1 text=$2 unit=$3 bar=$4 scene=$5
	shift 5
	if timeout "${LIMIT:-120}" "$RBSIM" run "$CASES/$scene.lua" --no-record "$@" --json >out 2>err </dev/null || [ $? -eq 1 ]; then
		result "$name" "$text" "$(calc "$(measured "$text")")" "$unit" "$bar"
	else
		result "$name" "$text" "no result: $(tail -n 1 err)" "$unit" "$bar"
	fi
}

for method in $METHODS; do
	for angle in 0 30 60 90; do
		of "$method, SimBenchmark rolling, $angle degrees" "RMS error of velocities over their RMS" "" 1e-9 B03_rolling \
			--param angle=$angle --method "$method"
	done
	of "$method, SimBenchmark 666, 1e-3 s" "overlap of a contact, RMS, radii" "" 1e-6 S17_inelastic_666 --method "$method"
	of "$method, SimBenchmark 666, 1e-3 s" "overlap, mean sum of squares, m^2" "" 1.35e-4 S17_inelastic_666 --method "$method"
done
for slender in 2 4; do
	of "rocking block 1:$slender" "what each impact leaves" "" 1e-6 S23_rocking_block --param slender=$slender
done
of "needle, impact at its tip" "impulse, relative" "" 1e-9 S35_tip_impact --param shape=needle
of "foil, impact at a corner" "impulse, relative" "" 1e-9 S35_tip_impact --param shape=foil
for e in 0 0.5 1; do
	of "flat drop, e = $e" "it does not turn, rad/s" "rad/s" 1e-13 S14_flat_drop --param e=$e
done
of "balanced on an edge, 1e-9 rad beside" "it falls in time, relative" "" 0.01 S22_knife_edge
of "sliding cube, 22.5 degrees" "distance, relative" "" 1e-8 S25_isotropy --param angle=22.5
of "sliding cube, 22.5 degrees" "turned, rad" "rad" 1e-9 S25_isotropy --param angle=22.5
