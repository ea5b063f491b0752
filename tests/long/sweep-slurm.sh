#!/bin/sh
# SPDX-License-Identifier: MIT
# Sweeps through a real Slurm give the bits of local ones: as arrays, with a time limit shorter than the work, after failures.
. tests/cli/functions
. "$TOP/tests/long/slurm"
export SLURM_ARRAY_MAX=4 # so that points have to be grouped
start_slurm

cat >s.lua <<'END'
local e = param("e", 0.5, "restitution")
world { duration = 0.3, gravity = {0, 0, -9.81} }
local m = material { name = "rubber", restitution = e, density = 1000 }
plane { normal = {0, 0, 1}, material = m }
sphere { radius = 0.1, position = {0, 0, 0.2 + 0.1 * math.random()}, material = m }
END

# same A B: two sweeps have the same points and states
same()
{
	for json in "$1"/point-*.json; do
		hash=$(value state_hash "$json")
		[ -n "$hash" ] && [ "$hash" = "$(value state_hash "$2/${json#*/}")" ] || fail "$json: other bits"
	done
}

# ten points in four tasks
exits 0 sweep s.lua -p e=0:0.9:0.1 -o local
exits 0 sweep s.lua -p e=0:0.9:0.1 -o slurm-ed --slurm --time 5:00 --partition debug --slurm-option --comment=sweep
says out '^[0-9]+$'
says err '10 points to be run, as tasks 0-3'
says slurm-ed/sweep.sbatch '^#SBATCH --array=0-3$'
wait_for_slurm 120
exits 0 sweep slurm-ed --status
says out '10 points of s.lua: 10 done'
same local slurm-ed
exits 0 sweep slurm-ed --slurm
says err '0 points to be run'
says_nothing out

# what is lost is submitted again, and nothing else
rm slurm-ed/point-00002.json slurm-ed/point-00006.json
exits 0 sweep slurm-ed --slurm
says err '2 points to be run, as tasks 2'
wait_for_slurm 120
same local slurm-ed

# the limit is shorter than the work: it goes on by itself until all is done
sed 's/duration = 0.3/duration = 0.3, time_step = 1e-3/; $a on_step(function() local x = 0 for i = 1, 5e5 do x = x + i end end)' s.lua >slow.lua
exits 0 sweep slow.lua --trust -p e=0:0.9:0.1 --method classic -o slow-local --jobs 1
took=$(sed -n 's/.*runs in \([0-9.]*\).*/\1/p' err)
exits 0 sweep slow.lua --trust -p e=0:0.9:0.1 --method classic -o slow --slurm --tasks 1 --time 1 \
	--slurm-option --signal=B:USR1@20
wait_for_slurm 1500
exits 0 sweep slow --status
says out '10 points of slow.lua: 10 done'
same slow-local slow
echo "alone $took s; sessions of the task: $(grep -c 'points done' slow/task-0.log)"
[ "$(grep -c 'goes on' slow/task-0.log)" -ge 1 ] || fail "the task was never interrupted: $(cat slow/task-0.log)"

# a cancelled job stops its runs properly and is not queued again
exits 0 sweep slow.lua --trust -p e=0:0.9:0.1 --method classic -o cancelled --slurm --tasks 1 --time 5
until_true [ -f cancelled/point-00000.log ]
scancel "$(cat out)"
wait_for_slurm 120
exits 0 sweep cancelled --status --json
[ "$(value running)" = 0 ] && [ "$(value failed)" = 0 ] || fail "after scancel: $(cat out)"
