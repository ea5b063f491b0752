#!/bin/sh
# SPDX-License-Identifier: MIT
# What changes the public headers, and so is compiled together: tools/sample adds a shape, a method and a key of scenes. The first has
# mass, contacts by every method, a recording and messages; the second is chosen by name, goes on from a checkpoint and refuses what
# it lacks; the third changes a run, and is checked.
. tests/cli/functions
samples shape method key
says out '^a shape: [1-4] files$'
says out '^a method: [1-5] files$'
says out '^a key: [1-4] files$'
