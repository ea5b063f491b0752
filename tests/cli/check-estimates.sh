#!/bin/sh
# SPDX-License-Identifier: MIT
# Memory and disk that check foretells are within 15 % of what the run then takes, of heaps 10 %; of a small run's memory half a megabyte,
# since how many pages of libraries count as its own changes from start to start.
. tests/cli/functions
case ${RBSIM_MODE:-release} in
release) ;;
*) echo "a build for $RBSIM_MODE takes other memory"; exit 77 ;;
esac
[ -r /proc/self/status ] || { echo "no /proc"; exit 77; }

# within WHAT FORETOLD TAKEN [SLACK [SHARE]]
within()
{
	awk -v a="$2" -v b="$3" -v more="${4:-0}" -v share="${5:-0.15}" 'BEGIN {
		off = a > b ? a - b : b - a
		exit !(b > 0 && (off <= share * b || off <= more))
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
# those that come to rest late, too: scratch that the first steps have left is not the run's
sed 's/0.5 + 0.01/8.5 + 0.01/' rows.lua >high.lua
for scene in "high.lua --param n=2000 --param duration=3 --no-record" "small.lua" "small.lua --duration 5" "rows.lua" "rows.lua --param n=5000 --param duration=2" \
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

# what comes late counts: balls that fall for a second, then lie in a heap
cat >late.lua <<'END'
local n = param("n", 400, "balls")
world { duration = param("duration", 4.0, "s"), gravity = {0, 0, -9.81}, method = "stepped" }
local m = material { friction = 0.4 }
for k = 0, 3 do
	local x, y = ({3, 0, -3, 0})[k + 1], ({0, 3, 0, -3})[k + 1]
	plane { point = {x, y, 0}, normal = {-x, -y, 2}, material = m }
end
for i = 0, n - 1 do sphere { radius = 0.15, position = {0.4 * (i % 7) - 1.2, 0.4 * (i // 7 % 7) - 1.2, 5 + 0.4 * (i // 49)}, material = m } end
on_step(function() print("nobody hears this") end)
END
exits 0 check late.lua --no-record --json
grep -q 'nobody hears' out err && fail "callbacks of a trial are heard"
late=$(value run_seconds)
exits 0 check late.lua --no-record --json --duration 0.3
early=$(value run_seconds)
awk -v a="$early" -v b="$late" 'BEGIN { exit !(a > 0 && b > a) }' || fail "0.3 s take $early s, 4 s take $late s"
# without its end: a run of ages, whose heap takes more than its beginning
exits 0 check late.lua --no-record --json --param n=1000 --duration 1e6
[ "$(value run_at_least)" = true ] || fail "nobody can know how long that takes"
memory=$(value memory_bytes)
exits 0 late.lua --no-record --json --param n=1000 --duration 3 # when all lie there
scene="a heap of 1000" within memory "$memory" "$(value memory_bytes)" 0 0.1
# of what turns, as many points are foretold as heaps of boxes have: where there are fewer, as here, not all of it is taken
sed 's/sphere {.*position = \({[^}]*}\).*/hull { points = {{-0.12, -0.1, -0.1}, {0.14, -0.1, -0.1}, {0, 0.15, -0.1}, {0, 0, 0.15}}, position = \1, material = m } end/' \
	late.lua >turning.lua
exits 0 check turning.lua --no-record --json --param n=1000 --duration 1e6
memory=$(value memory_bytes)
exits 0 turning.lua --no-record --json --param n=1000 --duration 2
scene="a heap of 1000 tetrahedra" within memory "$memory" "$(value memory_bytes)" 0 0.42
# a sweep, for all its points: 9 runs whose bodies and time grow, of which five are tried
cat >grow.lua <<'END'
local n = param("n", 3, "balls")
world { duration = 0.2 * n, gravity = {0, 0, -9.81} }
plane { normal = {0, 0, 1} }
for i = 1, n do sphere { radius = 0.1, position = {i, 0, 1} } end
END
exits 0 sweep grow.lua --param n=2:34:4 --jobs 3 --plan --json -o grow
[ "$(value tried_points) $(value jobs) $(value points)" = "5 3 9" ] || fail "other points are tried"
[ "$(value memory_bytes)" -eq $((3 * $(value run_memory_bytes))) ] || fail "three runs at a time take three times the memory"
disk=$(value disk_bytes)
awk -v a="$(value seconds)" -v b="$(value longest_run_seconds)" 'BEGIN { exit !(a >= b && b > 0) }' || fail "no time is told"
exits 0 sweep grow -q
scene="a sweep" within disk "$disk" "$(cat grow/*.h5 | wc -c)" 0.1 0.1
exits 0 sweep grow.lua --param n=2 --no-record --plan -o bare
says out '^  time +about .* 1 at a time: .*tried: 1 of 1 points'
says out '^  memory +[0-9.]+ MB, a run at most [0-9.]+ MB'
says out '^  disk +nothing is recorded'
