#!/bin/sh
# SPDX-License-Identifier: MIT
# A single contact of bodies that joints hold follows the law of a single contact of free ones: where the joint holds next to no
# mass, or two halves of a body (velocities differed by 6 m/s of 10), and where it leaves one direction only.
. tests/cli/functions

lands()
{
	exits 0 "$TOP/tests/scenes/$1.lua" --no-record --quiet -p e="$2" -p mu="$3" --method "$4" -p bound="$5" ${6+"$6" "$7"}
}

for e in 0 0.6 1; do
	for mu in 0.1 0.4 2; do
		lands welded $e $mu located 1e-7
		lands pendulum_impact $e $mu located 1e-10
		lands pendulum_impact $e $mu located 1e-10 -p slope=1.3
	done
	# steps resolve impacts of what joints hold at their end
	lands welded $e 0.3 stepped 0.02 --time-step 1e-4
	lands pendulum_impact $e 0.3 stepped 1e-6 --time-step 1e-4
done
for throw in 2 3 4; do
	lands welded 0.5 0.2 located 1e-7 -p throw=$throw
	lands welded 0 0.2 located 1e-7 -p throw=$throw
done
lands pendulum_impact 0.5 0.3 located 1e-10 -p turn=0.9
lands pendulum_impact 0.5 0.3 auto 1e-10 -p turn=2.2
# So many joints that they are eliminated: what that takes outlives the inverse mass of the linkage that was found with it (a
# crash, where the arena had grown in between).
for pieces in 3 8 10 12 14 16 20 30 40; do
	lands welded_row 0.5 0.3 located 1e-7 -p pieces=$pieces
done
