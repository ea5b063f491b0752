#!/bin/sh
# SPDX-License-Identifier: MIT
# Beads by steps: rates of flow go as the opening to the power 5/2 (Beverloo), walls carry what Janssen says they do, and heights
# and contact numbers of a heap do not depend on the tolerance beyond their spread over seeds. SEEDS=10 heaps, BEADS=2000 in
# each silo.
. tests/cli/functions

SEEDS=${SEEDS:-10} BEADS=${BEADS:-2000}

# found TEXT: the result() of this name in the last run
found()
{
	sed -n 's/.*"'"$1"'":{"value":\([^,}]*\).*/\1/p' out | head -n 1
}

# over four openings; 600 beads run out in 1.6 s
exits 0 "$TOP/scenes/hourglass.lua" --param n="$BEADS" --param seconds="$(awk "BEGIN { print 0.4 + $BEADS / 500 }")" \
	--no-record --no-render --json --quiet
exponent=$(found "exponent of the rate")
echo "exponent of the rate: $exponent"
awk "BEGIN { exit !(($exponent - 2.5) ^ 2 <= 0.125 ^ 2) }" || fail "rates go as the power $exponent of the opening"

# the load saturates: twice the beads press the floor by less than 1.25 of what they did
previous=
for n in 500 1000; do
	exits 0 "$TOP/scenes/silo.lua" --param n=$n --no-record --no-render --json --quiet
	load=$(awk "BEGIN { print $n * $(found "load on the floor over the weight") }")
	echo "load on the floor of $n beads: $load, Janssen's K $(found "Janssen's K")"
	[ -z "$previous" ] || awk "BEGIN { exit !($load < 1.25 * $previous) }" ||
		fail "the floor carries $previous of 500 beads, $load of $n"
	previous=$load
done

# means of the heap at two tolerances differ by less than the spread of one
cat >heap.lua <<'END'
world { title = "A heap", duration = 3, frame_rate = 60, time_step = 1 / 240, gravity = {0, 0, -9.81}, method = "stepped" }
local stone = material { name = "stone", friction = 0.5, restitution = 0 }
plane { normal = {0, 0, 1}, material = stone }
for _, way in ipairs { {1, 0}, {-1, 0}, {0, 1}, {0, -1} } do
	plane { normal = {way[1], way[2], 0}, point = {-3.4 * way[1], -3.4 * way[2], 0}, material = stone }
end
local balls = {}
for k = 0, 215 do
	local function at(i) return 1.1 * (i - 2.5) + 0.09 * (math.random() - 0.5) end
	balls[k + 1] = sphere { radius = 0.5, material = stone, position = {at(k % 6), at(k // 6 % 6), at(k // 36) + 3.3} }
end
result("height", function()
	local sum = 0
	for _, ball in ipairs(balls) do sum = sum + ball.position.z end
	return sum / #balls
end)
result("contacts of a ball", function() -- pairs nearer than a thousandth of a radius
	local count = 0
	for i, a in ipairs(balls) do
		for j = 1, i - 1 do
			if (a.position - balls[j].position):length() < 1.0005 then count = count + 2 end
		end
	end
	return count / #balls
end)
END
for tolerance in 5e-7 5e-5; do
	for seed in $(seq "$SEEDS"); do
		exits 0 heap.lua --seed "$seed" --tolerance $tolerance --no-record --json --quiet
		echo "$(found height) $(found "contacts of a ball")"
	done >"means.$tolerance"
done
for column in 1 2; do
	cat means.5e-7 means.5e-5 | awk -v column=$column -v n="$SEEDS" '
		{ k = NR > n; x = $column; sum[k] += x; square[k] += x * x }
		END {
			for (k = 0; k < 2; k++) { mean[k] = sum[k] / n; spread[k] = sqrt((square[k] - n * mean[k] ^ 2) / (n - 1)) }
			apart = mean[0] > mean[1] ? mean[0] - mean[1] : mean[1] - mean[0]
			printf "%s at 1e-6 r %.5g +- %.2g, at 1e-4 r %.5g +- %.2g\n", column == 1 ? "height" : "contacts", mean[0],
				spread[0], mean[1], spread[1]
			exit !(apart <= (spread[0] > spread[1] ? spread[0] : spread[1]))
		}' || fail "the tolerance shows in column $column"
done
