#!/bin/sh
# SPDX-License-Identifier: MIT
# Bodies bring the memory that they take: a large scene loads in the sandbox. Other memory has its bound as before.
. tests/cli/functions

cat >many.lua <<'END'
local n = param("n", 300000, "bodies")
world { duration = 0.01 }
for k = 0, n - 1 do sphere { radius = 0.1, position = {k % 100 * 0.3, k // 100 % 100 * 0.3, k // 10000 * 0.3} } end
END
exits 0 many.lua --no-record --quiet
cat many.lua - >table.lua <<'END'
local t = {}
for i = 1, 1e9 do t[i] = {} end
END
exits 65 table.lua --param n=10 --no-record --quiet
says err 'needs more than 256 MiB of memory'
