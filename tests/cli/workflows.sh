#!/bin/sh
# SPDX-License-Identifier: MIT
# examples/cluster: what Snakemake and Nextflow would run gives the table of `rbsim sweep`; and so do they, where they are.
. tests/cli/functions
case $RBSIM in /*) ;; *) RBSIM=$TOP/$RBSIM ;; esac
mkdir bin
ln -s "$RBSIM" bin/rbsim
PATH=$PWD/bin:$PATH
export PATH RBSIM_MODULE_DIR="${RBSIM%/*}"

small_scene >drop.lua
sed -i '1i local e = param("e", 0.5)' drop.lua
sed -i 's/restitution = 0.5/restitution = e/' drop.lua
exits 0 sweep drop.lua -p e=0.1:0.9:0.1 -o alone --quiet
exits 0 collect alone -o alone.csv --quiet
cut -d, -f1-6 alone.csv >wanted
[ "$(wc -l <wanted)" -eq 10 ] || fail "no table of nine points"

# steps FILE: runs the commands of a workflow in the order plan, tasks, table, with what it would put in
steps()
{
	sed -n 's/.*"\(rbsim sweep [^"]*\|rbsim collect [^"]*\)".*/\1/p' "$1" | sed \
		-e 's/{input}\|${file(params.scene)}/drop.lua/; s/{points}\|${params.points}/e=0.1:0.9:0.1/' \
		-e 's/{output}\|${params.folder}.csv/sweep.csv/; s/$\{0,1\}{folder}/sweep/' \
		-e 's/{wildcards.task}\|${k}/K/; s/{tasks}\|${params.tasks}/3/; s/${task.cpus}/1/' >commands
	[ "$(wc -l <commands)" -eq 3 ] || fail "$1 has other commands than a plan, a task and a table: $(cat commands)"
	for command in ' --plan' ' --task ' '^rbsim collect'; do
		for k in 0 1 2; do
			[ "$command" = ' --task ' ] || [ $k = 0 ] || continue
			grep -e "$command" commands | sed "s/ K / $k /" >one.sh
			sh -eu one.sh >out 2>err || fail "$1: $(cat one.sh)"
		done
	done
}

# same WHO: the table is that of the sweep on its own
same()
{
	cut -d, -f1-6 sweep.csv | diff wanted - >err || fail "$1 makes another table"
	for k in 0 4 8; do exits 0 diff alone/point-0000$k.h5 sweep/point-0000$k.h5; done
	rm -rf sweep sweep.csv sweep.done
}

for file in Snakefile main.nf; do
	steps "$TOP/examples/cluster/$file"
	same "$file"
done
unset RBSIM_MODULE_DIR
if command -v snakemake >/dev/null; then
	snakemake -s "$TOP/examples/cluster/Snakefile" --cores 2 --quiet all >out 2>err || fail "snakemake fails"
	same Snakemake
	echo "snakemake $(snakemake --version): the bits of rbsim sweep"
fi
if command -v nextflow >/dev/null; then
	nextflow run "$TOP/examples/cluster/main.nf" >out 2>err || fail "nextflow fails"
	same Nextflow
	echo "$(nextflow -v): the bits of rbsim sweep"
fi
exit 0
