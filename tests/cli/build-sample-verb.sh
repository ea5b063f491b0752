#!/bin/sh
# SPDX-License-Identifier: MIT
# A new verb is one file and three lines: tools/sample adds one, and the help, completions and advice have it.
. tests/cli/functions
case ${RBSIM_MODE:-release} in
release | debug) ;;
*) echo "a verb more is the same under sanitizers"; exit 77 ;;
esac
from=$(dirname "$(realpath "$RBSIM")")
[ -d "$from/src" ] || { echo "the program does not stand beside its objects"; exit 77; }
unset RBSIM_CHECK_MEMORY
SAMPLE_FOLDER=$PWD/work "$TOP/tools/sample" "$from" verb >out 2>err || fail "a sample cannot be added"
says out '^a verb: [1-4] files$'
