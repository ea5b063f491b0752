#!/bin/sh
# SPDX-License-Identifier: MIT
# What it takes to add one more of a kind: tools/sample adds one of each, after the other, and builds and tries them together.
# - A force is one file and one line: every method, the energies, the ledger, the recording and `check` have it.
# - A shape has mass, contacts by every method, a recording and messages.
# - A kind of joint holds bodies by every method, and is counted, recorded and checked.
# - A method is chosen by name, goes on from a checkpoint and refuses what it lacks.
# - A key of scenes changes a run, and is checked.
# - A sink is one file, an option and its start: it gets every frame, with the recorder or alone.
# - A verb is one file and three lines: the help, completions and advice have it.
. tests/cli/functions
samples force shape joint method key sink verb
for kind in force shape joint key sink verb; do says out "^a $kind: [1-4] files\$"; done
says out '^a method: [1-5] files$'
