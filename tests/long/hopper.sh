#!/bin/sh
# SPDX-License-Identifier: MIT
# A thousand bodies of all shapes jam above the hole of a hopper: their groups come to an end, and few steps are taken back.
# Where sweeps of such groups stalled, half of all steps were; where they were given up too soon, or one pair of a heap and what flew
# into it was not solved for, a hundredth.
. tests/cli/functions

exits 0 "$TOP/scenes/hopper.lua" --param n=1000 --param seconds=1.2 --no-record --no-render --json --quiet
awk -v lost="$(value discarded_body_steps)" -v all="$(value body_steps)" 'BEGIN { exit !(lost < 0.005 * all) }' ||
	fail "$(value discarded_body_steps) body-steps are thrown away, $(value body_steps) kept"

# one pair that has met too deep takes back the whole heap: it is looked at again instead, as often as that helps
exits 1 "$TOP/scenes/hopper.lua" --param n=1000 --param seconds=2 --tolerance 4e-4 --no-record --no-render --json --quiet
awk -v lost="$(value discarded_body_steps)" -v all="$(value body_steps)" 'BEGIN { exit !(lost < 0.02 * all) }' ||
	fail "$(value discarded_body_steps) body-steps are thrown away, $(value body_steps) kept"
