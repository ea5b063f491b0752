#!/bin/sh
# SPDX-License-Identifier: MIT
# What --slurm hands to sbatch, with programs of ours in the place of Slurm's; a task of the script runs its share.
. tests/cli/functions

small_scene 'local e = param("e", 0.5, "x")' >s.lua
mkdir bin
cat >bin/sbatch <<'END'
#!/bin/sh
for word in "$@"; do echo "$word"; done >"$OLDPWD_OF_TEST/words"
pwd >"$OLDPWD_OF_TEST/where"
[ ! -e "$OLDPWD_OF_TEST/broken" ] || { printf 'sbatch: error: Batch job submission failed: Invalid account\nand more\n' >&2; exit 1; }
echo "sbatch: a warning" >&2
echo "4711;cluster"
END
cat >bin/scontrol <<'END'
#!/bin/sh
[ "$1" = show ] && echo "MaxArraySize            = ${ARRAY_MAX:-5}"
[ "$1" = requeue ] && echo "$2" >"$OLDPWD_OF_TEST/requeued"
exit 0
END
chmod +x bin/*
OLDPWD_OF_TEST=$PWD
export OLDPWD_OF_TEST
plain=$PATH
PATH=$PWD/bin:$PATH

exits 0 sweep s.lua -p e=0.1:0.9:0.1 -o "a sweep" --slurm --time 1:00:00 --mem 2G --partition 'fast nodes' \
	--slurm-option --account=physics --slurm-option='--comment="two words"' --jobs 2 --threads 3 --checkpoint-every 600
[ "$(cat out)" = 4711 ] || fail "the job's number is '$(cat out)'"
printf '%s\n' --parsable --array=0-4 sweep.sbatch | cmp -s - words || fail "sbatch got $(cat words)"
[ "$(cat where)" = "$PWD/a sweep" ] || fail "sbatch ran in $(cat where)"
for line in --job-name=s.lua --array=0-4 --ntasks=1 --cpus-per-task=6 --time=1:00:00 --mem=2G '--partition="fast nodes"' \
	--signal=B:USR1@60 --requeue --open-mode=append --account=physics '--comment="two words"'; do
	grep -Fqx -- "#SBATCH $line" "a sweep/sweep.sbatch" || fail "no '#SBATCH $line' in $(cat "a sweep/sweep.sbatch")"
done
says "a sweep/sweep.sbatch" '--jobs 2 --threads 3 --checkpoint-every 600 &$'
sh -n "a sweep/sweep.sbatch" || fail "the script is no script"

# a task of it runs its share; every task, all points
run_task()
{
	(cd "a sweep" && SLURM_ARRAY_TASK_ID=$1 SLURM_ARRAY_JOB_ID=4711 sh sweep.sbatch) >out 2>err
}
run_task 1 || fail "task 1: exit status $?"
exits 0 sweep "a sweep" --status
says out '9 points of s.lua: 2 done, 7 missing'
says out '7: .*of 5 tasks --array=0,2-4'
exits 0 sweep "a sweep" --slurm --json
[ "$(value array)" = 0 ] || says out '"array":"0,2-4"'
grep -qx -- --array=0,2-4 words || fail "sbatch got $(cat words)"
for k in 0 2 3 4; do run_task $k || fail "task $k: exit status $?"; done
exits 0 sweep "a sweep" --status
says out '9 points of s.lua: 9 done'

# the notice ahead of the limit: the sweep stops, 75, and the task is queued again; after a cancellation it is not
long_scene >long.lua
exits 0 sweep long.lua -p n=300,301 -o long --slurm --tasks 1
exits 0 sweep long --status
says out 'of 1 task --array=0'
pid=
trap '[ -n "$pid" ] && kill -9 $pid 2>/dev/null' EXIT
for signal in USR1 TERM; do
	rm -f requeued
	(cd long && SLURM_ARRAY_TASK_ID=0 SLURM_ARRAY_JOB_ID=4711 exec sh sweep.sbatch) >out 2>err &
	pid=$!
	until_true [ -s long/point-00000.h5 ]
	sleep 0.3
	kill -$signal $pid
	ended 75 "SIG$signal"
	case $signal in
	USR1) [ "$(cat requeued)" = 4711_0 ] || fail "the task was not queued again" ;;
	TERM) [ ! -e requeued ] || fail "a cancelled task was queued again" ;;
	esac
	rm -f long/point-00000.h5
done

# refusals
exits 64 sweep s.lua -p e=0.1:0.9:0.1 -o "a sweep" --slurm --tasks 6
says err 'more than an array may have here \(5\)'
exits 64 sweep long --slurm --slurm-option account=x
says err "does not begin with '-'"
touch broken
exits 69 sweep long --slurm
says err 'sbatch refused the job: .*Invalid account'
[ "$(wc -l <err)" -eq 1 ] || fail "more than a line of what sbatch said"
rm bin/sbatch bin/scontrol
for program in sbatch scontrol; do
	command -v $program >/dev/null && { PATH=$plain; echo "Slurm is installed: its absence is not tried"; exit 0; }
done
exits 69 sweep long --slurm
says err "there is no 'sbatch'.*long/sweep.sbatch"
