#!/bin/sh
# SPDX-License-Identifier: MIT
# Random scenes by the thousand (RANDOM_SEEDS, 2000), up to thirty bodies, by every method, and the table of what was found: runs,
# rises of energy beyond 1e-9, 1e-4 and 1e-2 of its scale, exit status 76, more than 2 s of processor for a second, overlaps,
# differences of bits, the worst of all with its seed. Classic only reports. Every tenth seed is also turned, mirrored and run
# with other threads.
. tests/cli/functions
command -v python3 >/dev/null || { echo "python3 is not there"; exit 77; }
seeds="--first ${RANDOM_FIRST:-1} --seeds ${RANDOM_SEEDS:-2000}"
# shellcheck disable=SC2086 # two options
python3 "$TOP/tests/random/run.py" $seeds --methods located,stepped,auto --copies-every 10 --checks all
status=$?
# what the classic method takes
for what in convex unions driven springs drag fields; do seeds="$seeds --param $what=false"; done
# shellcheck disable=SC2086
python3 "$TOP/tests/random/run.py" $seeds --methods classic | grep -v '^FAIL'
exit $status
