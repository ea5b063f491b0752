#!/bin/sh
# SPDX-License-Identifier: MIT
# Over three nodes of a real Slurm a sweep has the bits of one here: its tasks run on all nodes; one node is lost while it works,
# one task is killed, and what they left is done in the end, with the same bits. The nodes are daemons on this machine.
. tests/cli/functions
. "$TOP/tests/long/slurm"
export SLURM_NODES=3
start_slurm
sinfo -N

cat >s.lua <<'END2'
local e = param("e", 0.5, "restitution")
world { duration = 1, frame_rate = 50, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = e, density = 1000 }
plane { normal = {0, 0, 1}, material = m }
for i = 1, 4 do
	sphere { radius = 0.1, position = {0.25 * i, 0, 0.2 + 0.1 * i + 0.1 * math.random()}, material = m }
end
-- takes its time, which is in no bit of the result
local busy = param("busy", 1, "turns of a loop")
on_frame(function() local x = 0 for i = 1, busy do x = x + i end end)
END2

# same A B: two sweeps have the same points and states
same()
{
	count=0
	for json in "$1"/point-*.json; do
		hash=$(value state_hash "$json")
		[ -n "$hash" ] && [ "$hash" = "$(value state_hash "$2/${json#*/}")" ] || fail "$json: other bits than in $2"
		count=$((count + 1))
	done
	[ $count -eq 12 ] || fail "$1 has $count points"
	for json in "$1"/point-*.json; do
		file=${json%.json}.h5
		exits 0 diff "$file" "$2/${file#*/}"
	done
}

nodes_at_work()
{
	squeue -h -t R -o %N | sort -u
}

all_work()
{
	[ "$(nodes_at_work | wc -l)" -eq 3 ] && [ -s slurm-ed/point-00000.h5 ]
}

exits 0 sweep s.lua -p e=0:0.55:0.05 -o local --trust
exits 0 sweep s.lua -p e=0:0.55:0.05 -p busy=3e6 -o slurm-ed --trust --slurm --tasks 6 --jobs 1 --time 5:00 --partition debug \
	--checkpoint-every 0
job=$(cat out)
says err '12 points to be run, as tasks 0-5'
await 600 all_work || fail "no node works"
echo "at work: $(nodes_at_work | tr '\n' ' ')"

# a node that is lost: Slurm queues its task again, for another node
lost=$(squeue -h -t R -o '%N' | head -n 1)
scontrol update "NodeName=$lost" State=DOWN Reason=test || fail "node $lost cannot be taken away"
# a task of another node that is killed, without a notice
killed=$(squeue -h -t R -o '%N %K' | grep -v "^$lost " | head -n 1 | cut -d ' ' -f 2)
[ -n "$killed" ] || fail "no task works elsewhere"
scancel --signal=KILL --full "${job}_$killed"
wait_for_slurm
echo "lost: node $lost; killed: task $killed"
exits 0 sweep slurm-ed --status --json
left=$((12 - $(value "done")))
[ $left -ge 1 ] || fail "the task that was killed has left nothing to do: $(cat out)"

# what is left is submitted again, and runs on the nodes that are there
scontrol update "NodeName=$lost" State=RESUME 2>/dev/null # unless it came back by itself
await 600 slurm_is_idle || fail "node $lost does not come back"
exits 0 sweep slurm-ed --slurm
says err "$left points? to be run"
wait_for_slurm
exits 0 sweep slurm-ed --status
says out '12 points of s.lua: 12 done'
same local slurm-ed
[ -z "$(find slurm-ed -name '*.checkpoint*')" ] || fail "checkpoints of complete runs"
echo "12 points, $left after what was killed: the same bits"
