#!/bin/sh
# SPDX-License-Identifier: MIT
# Random trees of up to six bodies with joints of every kind, loops, limits, ropes, motors, friction, springs and contacts,
# located (tests/random/mechanism.lua): each comes to its end, and the ledger explains where energy went.
# Left out, by seed: 7 35 40, which have no end within 8 s of processor: in 7 contacts of a mechanism chatter, of 35 and 40 it is
# not understood; and 22 and 27, which take longer than others.
. tests/cli/functions
seeds='1 2 3 4 5 6 8 9 10 11 12 13 14 15 16 17 18 19 20 21 23 24 25 26 28 29 30 31 32 33 34 36 37 38 39'
[ "${RBSIM_MODE:-release}" = release ] || seeds='4 8 9 10 14 17 20 33'
for seed in $seeds; do
	exits 0 run "$TOP/tests/random/mechanism.lua" --no-record --json --param seed="$seed" --param most=6
	share=$(sed 's/.*"unexplained_share":\([^,}]*\).*/\1/' out)
	awk -v share="$share" 'BEGIN {exit !(share != "" && share + 0 >= 0 && share + 0 < 1e-12)}' ||
		fail "seed $seed: $share of the energy is unexplained"
done
