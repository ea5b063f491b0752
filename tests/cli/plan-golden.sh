#!/bin/sh
# SPDX-License-Identifier: MIT
# Nothing unneeded runs: features, stages and columns of each tiny scene are those of its golden text
# (tests/scenes/plan/NAME.plan), and scenes that nothing can turn end in the golden state (NAME.hash).
#
# The hashes hold for every compiler and C library: these scenes need no more than + - * / and sqrt, which IEEE 754
# rounds exactly, and -ffp-contract=off keeps them apart. UPDATE_GOLDEN=1 writes the texts anew: only in a
# commit that says why they changed.
. tests/cli/functions

count=0
for scene in "$TOP"/tests/scenes/plan/*.lua; do
	name=$(basename "$scene" .lua)
	exits 0 check "$scene" --no-record
	sed -n '/^features$/,$p' out >plan
	[ -s plan ] || fail "$name: check prints no plan"
	exits 0 "$scene" --no-record --json
	value state_hash >state
	if [ "${UPDATE_GOLDEN:-0}" = 1 ]; then
		cp plan "${scene%.lua}.plan"
		[ ! -f "${scene%.lua}.hash" ] || cp state "${scene%.lua}.hash"
	fi
	diff -u "${scene%.lua}.plan" plan >&2 || fail "$name: another plan than the golden one"
	if [ -f "${scene%.lua}.hash" ]; then
		if grep -q '^  + rotation' plan; then
			fail "$name: bodies can turn, and the sines of two C libraries may differ: no golden hash"
		fi
		diff -u "${scene%.lua}.hash" state >&2 || fail "$name: another last state than the golden one"
	fi
	count=$((count + 1))
done
[ "$count" -ge 6 ] || fail "only $count scenes in tests/scenes/plan"
