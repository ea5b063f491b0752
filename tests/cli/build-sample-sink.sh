#!/bin/sh
# SPDX-License-Identifier: MIT
# A new sink is one file, an option and its start: tools/sample adds one, and it gets every frame, with the recorder or alone.
. tests/cli/functions
samples sink
says out '^a sink: [1-4] files$'
