#!/bin/sh
# SPDX-License-Identifier: MIT
# What scenes expect holds for other parameters too, and is bounded for what the default method promises: by the steps of
# the classic one a bounce misses it.
. tests/cli/functions

for run in 'bounce e=0' 'bounce e=0.5' 'bounce e=0.9' 'edge speed=0.3' 'edge speed=10' 'off_center offset=-0.09' \
	'scripted throw=1' 'scripted hand=5' 'slide_to_roll spin=-100' 'slide_to_roll mu=0.05' 'slope angle=0.6' 'slope mu=0' \
	'slope mu=0.1' 'shaken_tower strength=1.02' 'shaken_tower strength=2' 'shaken_tower mu=0.1' 'examples/lowest_heavier tilt=1e-3' \
	'examples/lowest_heavier tilt=3' 'examples/straight_on mu=0.3' 'examples/spun_up alpha=30' 'examples/impact_sticks mu=0.05' \
	'examples/pull_at_the_rim force=1' 'examples/head_on e=0' 'examples/apart towards=true' 'stacked_drop mass=0.1' 'stacked_drop mass=3' 'two_materials ice=0.01' 'billiard speed=20'; do
	exits 0 "$TOP/scenes/${run% *}.lua" --param "${run#* }" --no-record --no-render --quiet
done
# what is located by default holds within the tolerance of steps, too
for run in 'auto 2' 'auto 8' 'stepped 3' 'stepped 6'; do
	exits 0 "$TOP/scenes/tumbling_hull.lua" --method "${run% *}" --param "seed_points=${run#* }" --no-record --no-render --quiet
done
# worked examples run by every method; where steps only come near the answer, what they miss is of their first order
for scene in "$TOP"/scenes/examples/*.lua; do
	for method in located stepped classic; do
		status=0
		case $scene in */spun_up.lua | */lowest_heavier.lua) [ $method = located ] || status=1 ;; esac
		exits $status "$scene" --method $method --no-record --no-render --quiet
	done
done
exits 1 "$TOP/scenes/bounce.lua" --method classic --no-record --no-render
says err 'FAIL bounces end at'
exits 1 "$TOP/scenes/edge.lua" --duration 0.05 --no-record --no-render
