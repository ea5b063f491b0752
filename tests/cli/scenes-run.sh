#!/bin/sh
# SPDX-License-Identifier: MIT
# Every shipped scene runs and keeps what it expects. Hopper and tower are small, the heap too in builds that are slow.
set -eu
scenes=$(dirname "$0")/../../scenes
for scene in "$scenes"/*.lua "$scenes"/examples/*.lua; do
	set -- --no-record --no-render --quiet
	case $scene in
	*/heap.lua) [ "${RBSIM_MODE:-release}" = release ] || set -- "$@" --param balls=15 ;;
	*/kapla.lua) set -- "$@" --param floors=3 ;;
	*/hopper.lua) set -- "$@" --param n=30 --param seconds=1 ;;
	esac
	"$RBSIM" "$scene" "$@" || {
		echo "$scene: exit $?"
		exit 1
	}
done
