#!/bin/sh
# SPDX-License-Identifier: MIT
# A new force is one file and one line: tools/sample adds one, and every method, the energies, the ledger, the recording and
# `check` have it.
. tests/cli/functions
case ${RBSIM_MODE:-release} in
release | debug) ;;
*) echo "a force more is the same under sanitizers"; exit 77 ;;
esac
from=$(dirname "$(realpath "$RBSIM")")
[ -d "$from/src" ] || { echo "the program does not stand beside its objects"; exit 77; }
unset RBSIM_CHECK_MEMORY
SAMPLE_FOLDER=$PWD/work "$TOP/tools/sample" "$from" force >out 2>err || fail "a sample cannot be added"
says out '^a force: [1-4] files$'
