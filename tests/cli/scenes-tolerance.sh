#!/bin/sh
# SPDX-License-Identifier: MIT
# What is stated is promised: with defaults no frame of a shipped scene overlaps by more than the tolerance of its method, a
# ppm of the smallest size until the first step, 1e-4 of it from then on; and steps cost less than at a ppm, or where few
# contacts are solved to rounding at either, the same up to another way that they go.
. tests/cli/functions
case ${RBSIM_MODE:-release} in
release) ;;
*) echo "a build for $RBSIM_MODE is slow"; exit 77 ;;
esac

# keeps SCENE ARGUMENT...: the frames against what the summary states; what steps have cost goes to `cost`, counted in
# row sweeps, of which a factorization takes some twenty for each of its rows
keeps()
{
	scene=$1
	shift
	exits 0 "$TOP/scenes/$scene.lua" "$@" --threads 1 -o run.h5 --force --no-render --json
	says out '"status":"complete"'
	located=$(value tolerance) stepped=$(value stepped_tolerance)
	cost=$(value row_sweeps) by_steps=$(value stepped)
	exits 0 export run.h5 --to csv --force --quiet
	awk -F , -v scene="$scene" -v located="$located" -v stepped="$stepped" '
		NR == 1 { for (k = 1; k <= NF; k++) at[$k] = k; next }
		{
			steps += $at["stepped"]
			if ($at["max_penetration"] > (steps > 0 ? stepped : located)) {
				print scene ": frame " $1 " overlaps by " $at["max_penetration"]
				bad = 1
			}
		}
		END { exit bad || NR < 3 }' run-frames.csv || fail "$scene: states $located and $stepped m"
	echo "$scene: $located and $stepped m, $cost row sweeps"
}

for scene in gas shapes tumbling_hull; do
	keeps $scene
	[ "$by_steps" = 0 ] || fail "$scene has been stepped"
done
for scene in arch "heap --param balls=20" "hopper --param n=40 --param seconds=1"; do
	# shellcheck disable=SC2086
	keeps $scene
	by_default=$cost
	[ "$by_steps" != 0 ] || fail "$scene has not been stepped"
	awk -v a="$located" -v b="$stepped" 'BEGIN { exit !(b > 50 * a || a == b) }' || fail "$scene: $located and $stepped"
	# the scenes themselves expect what is stated
	# shellcheck disable=SC2086
	keeps $scene --tolerance "$(awk -v s="$stepped" 'BEGIN { printf "%.17g", s / 100 }')"
	awk -v a="$by_default" -v b="$cost" 'BEGIN { exit !(a < 1.1 * b) }' || fail "$scene: $by_default row sweeps, at a ppm $cost"
done

# what sweeps do not end is taken by shorter steps: nothing is held
exits 0 "$TOP/scenes/hopper.lua" --param n=300 --param seconds=1.2 --no-record --no-render --json
[ "$(value held_slip)" = 0 ] || fail "friction is held: $(value held_slip) m"

# one scene, two statements; what is given holds for all frames
exits 0 check "$TOP/scenes/pyramid.lua"
says out 'tolerance  *[0-9.e-]* m until the first step, then [0-9.e-]* m$'
exits 0 check "$TOP/scenes/pyramid.lua" --tolerance 1e-5
says out 'tolerance  *1e-05 m$'
# joints are solved to rounding: they keep a ppm
exits 0 check "$TOP/scenes/trebuchet.lua" --json
[ "$(value tolerance)" = "$(value stepped_tolerance)" ] || fail "joints: $(value tolerance) and $(value stepped_tolerance)"

# a scene can ask for it; auto's is that of steps from the first one on, which the scenes above expect of it
cat >asks.lua <<'END'
world { duration = 0.1, frame_rate = 10, gravity = {0, 0, -9.81} }
for i = 1, 40 do box { size = {0.2, 0.2, 0.2}, position = {0.13 * (i % 5), 0.11 * (i % 7), 0.3 * i}, angular_velocity = {i, 2 * i, 3} } end
plane {}
local before = nil
on_step(function() before = before or penetration_tolerance() end)
expect("before, m", function() return before, BEFORE end)
expect("not less before, m", function() return -before, -BEFORE end)
expect("then, m", function() return penetration_tolerance(), THEN end)
expect("not less then, m", function() return -penetration_tolerance(), -THEN end)
END
asks() # asks BEFORE THEN OPTION...
{
	sed "s/BEFORE/$1/; s/THEN/$2/" asks.lua >asked.lua
	shift 2
	exits 0 asked.lua --no-record "$@"
}
asks 1e-7 1e-7 --method located
asks 1e-5 1e-5 --method stepped
asks 2e-3 2e-3 --method stepped --tolerance 2e-3
