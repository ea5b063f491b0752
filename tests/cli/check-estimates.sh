#!/bin/sh
# SPDX-License-Identifier: MIT
# Memory and disk that check foretells are within 10 % of what the run then takes; of a small run's memory half a megabyte,
# since how many pages of libraries count as its own changes from start to start.
. tests/cli/functions
case ${RBSIM_MODE:-release} in
release) ;;
*) echo "a build for $RBSIM_MODE takes other memory"; exit 77 ;;
esac
[ -r /proc/self/status ] || { echo "no /proc"; exit 77; }

# within WHAT FORETOLD TAKEN [SLACK]
within()
{
	awk -v a="$2" -v b="$3" -v more="${4:-0}" 'BEGIN {
		off = a > b ? a - b : b - a
		exit !(b > 0 && (off <= 0.1 * b || off <= more))
	}' ||
		fail "$scene: $1 foretold $2, taken $3"
	echo "$scene: $1 foretold $2, taken $3"
}

small_scene >small.lua
cat >rows.lua <<'END'
local n = param("n", 1000, "balls")
local floor = param("floor", true, "a floor to fall on")
world { duration = param("duration", 5.0, "s"), gravity = {0, 0, -9.81} }
if floor then plane { normal = {0, 0, 1} } end
for i = 0, n - 1 do
	sphere { radius = 0.1, position = {0.5 * (i % 100), 0.5 * (i // 100), 0.5 + 0.01 * (i % 7)} }
end
END
for scene in "small.lua" "small.lua --duration 5" "rows.lua" "rows.lua --param n=5000 --param duration=2" \
	"rows.lua --param n=20000 --param duration=0.5 --param floor=false" "small.lua --no-record" \
	"rows.lua --param n=20000 --param duration=0.5 --no-record"; do
	# shellcheck disable=SC2086
	exits 0 check $scene --json
	memory=$(value memory_bytes) disk=$(value disk_bytes)
	rm -f ./*.h5
	# shellcheck disable=SC2086
	exits 0 $scene --json # which reads its largest resident set from the kernel
	within memory "$memory" "$(value memory_bytes)" 524288
	case $scene in
	*--no-record*) ;;
	*) within disk "$disk" "$(cat ./*.h5 | wc -c)" ;;
	esac
done
