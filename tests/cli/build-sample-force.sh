#!/bin/sh
# SPDX-License-Identifier: MIT
# A new force is one file and one line: tools/sample adds one, and every method, the energies, the ledger, the recording and
# `check` have it.
. tests/cli/functions
samples force
says out '^a force: [1-4] files$'
