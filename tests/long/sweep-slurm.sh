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
wait_for_slurm
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
wait_for_slurm
same local slurm-ed

# The limit is shorter than a single run: nothing comes to its end but from checkpoints, through requeues. The limit is the
# shortest one, a minute, with a notice 50 seconds ahead of it, but Slurm looks at limits twice a minute only: it comes within 40
# seconds. A run takes 200 seconds of processor time, of this machine, which other programs do not make longer, until it has been
# interrupted twice; then it need not go on so. What keeps the runs busy is not in their bits: the local ones do without.
busy() # busy COUNT FRAME_RATE >SCENE
{
	sed "s/duration = 0.3/duration = 0.3, frame_rate = $2/" s.lua
	cat <<END
on_frame(function()
	local enough = io.open("$PWD/enough")
	if enough then return enough:close() end
	local x = 0
	for i = 1, $1 do x = x + i end
end)
END
}
busy 1e6 200 >probe.lua
times >before
exits 0 sweep probe.lua --trust -p e=0.5 -o probe --jobs 1 --json
times >after
# 60 frames of it have taken this long; it is to be 6000
count=$(awk 'FNR == 2 { split($1, user, "[ms]"); spent[++n] = 60 * user[1] + user[2] }
	END { printf "%.0f", 1e6 * 60 / 6000 * 200 / (spent[2] - spent[1]) }' before after)
busy "$count" 20000 >slow.lua
busy 1 20000 >quick.lua
exits 0 sweep quick.lua --trust -p e=0.2,0.8 -o slow-local
exits 0 sweep slow.lua --trust -p e=0.2,0.8 -o slow --slurm --tasks 1 --jobs 2 --time 1 --checkpoint-every 0 \
	--slurm-option --signal=B:USR1@50
says slow/sweep.sbatch '^"\$rbsim" sweep .* --checkpoint-every 0 &$'
sessions() # sessions COUNT: the task has ended as often
{
	[ -f slow/task-0.log ] && [ "$(grep -c "points done" slow/task-0.log)" -ge "$1" ]
}
await 1500 sessions 2 || fail "the task was not interrupted twice: $(cat slow/task-0.log)"
: >enough
wait_for_slurm
rm enough
exits 0 sweep slow --status
says out '2 points of slow.lua: 2 done'
same slow-local slow
for k in 0 1; do exits 0 diff slow-local/point-0000$k.h5 slow/point-0000$k.h5; done
sessions 3 || fail "the task was over after two sessions: $(cat slow/task-0.log)"
echo "runs of a minute: $(grep -c 'points done' slow/task-0.log) sessions of the task"
[ -z "$(find slow -name '*.checkpoint*')" ] || fail "checkpoints of complete runs"

# a cancelled job stops its runs properly, with checkpoints, and is not queued again
exits 0 sweep slow.lua --trust -p e=0.2,0.8 -o cancelled --slurm --tasks 1 --time 5
await 600 [ -s cancelled/point-00000.h5 ] || fail "the task does not begin"
scancel "$(cat out)"
wait_for_slurm
[ -s cancelled/point-00000.h5.checkpoint ] || fail "no checkpoint after scancel"
exits 0 sweep cancelled --status --json
[ "$(value running)" = 0 ] && [ "$(value failed)" = 0 ] || fail "after scancel: $(cat out)"
