#!/bin/sh
# SPDX-License-Identifier: MIT
# Error against run time where the exact motion is known: for an error of 1e-3 m, how long the cheapest setting of each
# method takes. CONVERGE_DIR=folder keeps the pictures, which rbsim converge SCENE.lua -o NAME.svg draws.
. "$(dirname "$0")/functions"

# cheapest SCENE METHOD: least wall time of a row of report.csv that reaches the error, and that row's error
cheapest()
{
	awk -F , -v method="$1" -v rollback="$2" '$1 == method && $2 == rollback && $5 == "ok" && $7 <= 1e-3 {
		if (best == "" || $(NF - 3) < best) { best = $(NF - 3); error = $7 } }
		END { if (best == "") print "none -"; else printf "%.4g %.4g", best, error }' report.csv
}
for scene in bounce slide_to_roll slope; do
	"$RBSIM" converge "$SCENES/$scene.lua" --error 1e-3 --budget 20 -o report.csv --force >out
	for kind in "classic selective" "classic global" "located selective"; do
		# shellcheck disable=SC2086 # two words
		found=$(cheapest $kind)
		result "$scene, $kind" "time for an error of 1e-3 m" "${found% *}" s
		result "$scene, $kind" "error at that time" "${found#* }" m
	done
	[ -z "${CONVERGE_DIR-}" ] ||
		"$RBSIM" converge "$SCENES/$scene.lua" --budget 20 -o "$CONVERGE_DIR/$scene.svg" --force >"$CONVERGE_DIR/$scene.txt"
done

# a ball that loses nothing, from 5 m, 10 s: other engines reach 3.9e-3 (ODE) and 2.0e-2 (Box3D) at 10 ms
for step in 0.01 0.001; do
	run "$BENCH_SCENES/elastic.lua" --method stepped --time-step $step --no-record || continue
	result "elastic bounces by steps of $step s" "largest relative energy error" \
		"$(calc "$(found "largest relative energy error")")" "" 3.9e-3
done
