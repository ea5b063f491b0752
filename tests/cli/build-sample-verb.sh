#!/bin/sh
# SPDX-License-Identifier: MIT
# A new verb is one file and three lines: tools/sample adds one, and the help, completions and advice have it.
. tests/cli/functions
samples verb
says out '^a verb: [1-4] files$'
