#!/bin/sh
# SPDX-License-Identifier: MIT
# What checkpoints of 100,000 bodies cost: how long the run stands still for one, and what one a minute would take of all
# processor time, its writing included. Half of the bodies fly as a gas, half lie on a floor.
. "$(dirname "$0")/functions"

cat >many.lua <<'END'
local n = param("n", 100000, "spheres")
world { duration = 0.4, gravity = {0, 0, -9.81}, frame_rate = 50, time_step = 0.01, seed = 3 }
local m = material { name = "m", density = 1000, friction = 0.3, restitution = 0.5 }
plane { normal = {0, 0, 1}, material = m }
local side = math.ceil((n / 2) ^ 0.5)
for k = 0, n - 1 do
	local i = k // 2
	local place = {0.25 * (i % side), 0.25 * (i // side), k % 2 == 0 and 0.1 or 3 + math.random()}
	sphere { radius = 0.1, position = place, material = m,
		velocity = k % 2 == 0 and {0, 0, 0} or {math.random() - 0.5, math.random() - 0.5, 0} }
end
record { fields = {"position"}, every = 5 }
END

for method in located classic; do
	case="$method, 100,000 bodies"
	rm -f stalls rows.*
	for _ in 1 2 3; do
		for every in 0 0.001; do
			measure 1 "$RBSIM" run many.lua --method $method --threads 1 --checkpoint-every $every -q -o many.h5 --force >>rows.$every
		done
		run many.lua --method $method --threads 1 --checkpoint-every 0.001 -o many.h5 --force
		echo "$(value longest_stall) $(calc "$(value stall_time) / $(value written)")" \
			"$(calc "$(value stall_processor_time) / $(value written)")" >>stalls
	done
	more=$(calc "($(median rows.0.001 2) - $(median rows.0 2)) / $(value written)")
	result "$case" "size of a checkpoint" "$(calc "$(value checkpoint_bytes) / 1e6")" MB
	result "$case" "the run stands still, mean" "$(calc "1e3 * $(median stalls 2)")" ms 50
	result "$case" "the run stands still, longest of $(value written)" "$(calc "1e3 * $(median stalls 1)")" ms 50
	result "$case" "of which it works" "$(calc "1e3 * $(median stalls 3)")" ms
	result "$case" "processor time of a checkpoint" "$(calc "1e3 * $more")" ms
	result "$case" "share of a run with one a minute" "$(calc "100 * $more / 60")" % 0.5
done
