#!/bin/sh
# SPDX-License-Identifier: MIT
# Auto comes to an end where one method does not: a frame that cannot be located is done again by steps, and says so.
. tests/cli/functions

cat >tilted.lua <<'LUA'
world { duration = 0.4, gravity = {0, 0, -9.8} }
plane {}
cylinder { radius = 0.021, length = 0.01, position = {0, 0, 0.5}, orientation = {angle = 3, axis = {1, 0, 0}} }
LUA
timeout 60 "$RBSIM" tilted.lua --no-record --json --quiet >out 2>err </dev/null || fail "auto: exit status $?"
# with other threads to the same bits
hash=$(value state_hash)
exits 0 tilted.lua --no-record --json --quiet --threads 3
[ "$(value state_hash)" = "$hash" ] || fail "other threads, another end"
