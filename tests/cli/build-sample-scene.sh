#!/bin/sh
# SPDX-License-Identifier: MIT
# What changes the public headers, and so is compiled together: tools/sample adds a shape, a kind of joint, a method and a key of
# scenes. The first has mass, contacts by every method, a recording and messages; the second holds bodies by every method, and is
# counted, recorded and checked; the third is chosen by name, goes on from a checkpoint and refuses what it lacks; the fourth
# changes a run, and is checked.
. tests/cli/functions
samples shape joint method key
says out '^a shape: [1-4] files$'
says out '^a joint: [1-4] files$'
says out '^a method: [1-5] files$'
says out '^a key: [1-4] files$'
