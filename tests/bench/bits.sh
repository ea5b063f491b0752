#!/bin/sh
# SPDX-License-Identifier: MIT
# The same bits with 1, 2 and 3 threads, recording on and off, twice in a row: hash of the last state.
. "$(dirname "$0")/functions"

# bits NAME SCENE [ARGUMENT...]
bits()
{
	name=$1
	shift
	: >hashes
	for threads in 1 2 3; do
		for how in "-o run.h5 --force" "--no-record" "--no-record"; do
			# shellcheck disable=SC2086
			run "$@" --threads $threads $how
			echo "$(value state_hash) $threads $how" >>hashes
			echo "$name: $(value state_hash) with --threads $threads ${how%% *}" >&2
		done
	done
	result "$name" "hash" "$(head -n 1 hashes | cut -d ' ' -f 1)" ""
	result "$name" "different hashes of $(wc -l <hashes) runs" "$(cut -d ' ' -f 1 hashes | sort -u | wc -l)" "" 1
}

bits "gas of 1000" "$SCENES/gas.lua" --param balls=1000 --duration 1
bits "billiard" "$SCENES/billiard.lua"
bits "heap of 100, begun" "$SCENES/heap.lua" --param e=0.5 --duration 0.5
