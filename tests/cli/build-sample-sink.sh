#!/bin/sh
# SPDX-License-Identifier: MIT
# A new sink is one file, an option and its start: tools/sample adds one, and it gets every frame, with the recorder or alone.
. tests/cli/functions
case ${RBSIM_MODE:-release} in
release | debug) ;;
*) echo "a sink more is the same under sanitizers"; exit 77 ;;
esac
from=$(dirname "$(realpath "$RBSIM")")
[ -d "$from/src" ] || { echo "the program does not stand beside its objects"; exit 77; }
unset RBSIM_CHECK_MEMORY
SAMPLE_FOLDER=$PWD/work "$TOP/tools/sample" "$from" sink >out 2>err || fail "a sample cannot be added"
says out '^a sink: [1-4] files$'
