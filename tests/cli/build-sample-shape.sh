#!/bin/sh
# SPDX-License-Identifier: MIT
# A new shape is one file and two lines: tools/sample-shape adds one, and scenes, unions, mass, contacts by every method, the
# recording, `check`, `info` and messages have it.
. tests/cli/functions
case ${RBSIM_MODE:-release} in
release | debug) ;;
*) echo "a shape more is the same under sanitizers"; exit 77 ;;
esac
from=$(dirname "$(realpath "$RBSIM")")
[ -d "$from/src" ] || { echo "the program does not stand beside its objects"; exit 77; }
unset RBSIM_CHECK_MEMORY
"$TOP/tools/sample-shape" "$from" "$PWD/work" >out 2>err || fail "a sample shape cannot be added"
says out '^a shape: [1-4] files$'
