#!/bin/sh
# SPDX-License-Identifier: MIT
# Every shipped scene runs and keeps what it expects. Hopper, tower and flows are small. Builds that are slow run the first
# tenths of a second, whatever scenes expect of the end, of the drum with few beads, of the walker no whole step.
set -eu
scenes=$(dirname "$0")/../../scenes
for scene in "$scenes"/*.lua "$scenes"/examples/*.lua; do
	set -- --no-record --no-render --quiet
	case $scene in
	*/kapla.lua) set -- "$@" --param floors=3 ;;
	*/drum.lua) set -- "$@" --param seconds=0.8 ;;
	*/hourglass.lua) set -- "$@" --param n=60 --param seconds=0.6 ;;
	*/silo.lua) set -- "$@" --param n=150 ;;
	*/angle_of_repose.lua) set -- "$@" --param R=0.06 --param seconds=1 ;;
	*/walker.lua) set -- "$@" --param turns=0.15 ;;
	*/hopper.lua) set -- "$@" --param n=30 --param seconds=1 ;;
	esac
	case ${RBSIM_MODE:-release}$scene in
	release*) ;;
	*/drum.lua) set -- "$@" --duration 0.2 --param n=40 ;;
	*/walker.lua) set -- "$@" --duration 0.05 ;;
	*) set -- "$@" --duration 0.2 ;;
	esac
	status=0
	"$RBSIM" "$scene" "$@" || status=$?
	case ${RBSIM_MODE:-release}/$status in
	*/0) ;;
	# the end that a scene expects is not there yet
	asan/1 | asan/65 | tsan/1 | tsan/65) ;;
	*)
		echo "$scene: exit $status"
		exit 1
		;;
	esac
done
