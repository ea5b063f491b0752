#!/bin/sh
# SPDX-License-Identifier: MIT
# Two hundred small random scenes by steps and by auto, every fourth located, every twentieth also turned, mirrored and with
# other threads. What is known to fail, and why, stands in tests/random/known. The limit of processor time finds what has no
# end: it is eight times what tests/long/random.sh allows, so that it asks for no quick machine.
. tests/cli/functions
command -v python3 >/dev/null || { echo "python3 is not there"; exit 77; }
seeds=200 slack=8
case ${RBSIM_MODE:-release} in
release) ;;
*) seeds=20 slack=200 ;;
esac
python3 "$TOP/tests/random/run.py" --seeds $seeds --methods stepped,auto,located --located-every 4 --copies-every 20 \
	--checks all --slack $slack --param most=4 --param length=2 --known "$TOP/tests/random/known" || exit 1
