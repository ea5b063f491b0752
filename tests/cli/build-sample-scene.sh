#!/bin/sh
# SPDX-License-Identifier: MIT
# What changes the public headers, and so is compiled together: tools/sample adds a shape, a method and a key of scenes. The first has
# mass, contacts by every method, a recording and messages; the second is chosen by name, goes on from a checkpoint and refuses what
# it lacks; the third changes a run, and is checked.
. tests/cli/functions
case ${RBSIM_MODE:-release} in
release | debug) ;;
*) echo "a shape, a method or a key more is the same under sanitizers"; exit 77 ;;
esac
from=$(dirname "$(realpath "$RBSIM")")
[ -d "$from/src" ] || { echo "the program does not stand beside its objects"; exit 77; }
unset RBSIM_CHECK_MEMORY
SAMPLE_FOLDER=$PWD/work "$TOP/tools/sample" "$from" shape method key >out 2>err || fail "a sample cannot be added"
says out '^a shape: [1-4] files$'
says out '^a method: [1-5] files$'
says out '^a key: [1-4] files$'
