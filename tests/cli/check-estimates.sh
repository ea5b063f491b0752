#!/bin/sh
# SPDX-License-Identifier: MIT
# Memory and disk that check foretells are within 10 % of what the run then takes.
. tests/cli/functions
case ${RBSIM_MODE:-release} in
release) ;;
*) echo "a build for $RBSIM_MODE takes other memory"; exit 77 ;;
esac
[ -r /proc/self/status ] || { echo "no /proc"; exit 77; }

# within WHAT FORETOLD TAKEN
within()
{
	awk -v a="$2" -v b="$3" 'BEGIN { exit !(b > 0 && a / b >= 0.9 && a / b <= 1.1) }' ||
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
	within memory "$memory" "$(value memory_bytes)"
	case $scene in
	*--no-record*) ;;
	*) within disk "$disk" "$(cat ./*.h5 | wc -c)" ;;
	esac
done
